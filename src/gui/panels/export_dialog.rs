//! The export dialog: formats; what is exported, and where to; the files with the first lines of
//! the selected one, above what they omit or approximate. A dry run of the writers, which computes
//! every file without writing any, supplies the texts about omissions; this dialog has none of its
//! own.
//!
//! Wide windows have three columns. In narrow windows, formats and options share a column that
//! scrolls.

mod files;
mod options;

use egui::{
    Align, Button, Context, Frame, Id, Label, Layout, Modal, Rect, RichText, Role, ScrollArea,
    Stroke, Ui, UiBuilder, Vec2, pos2, vec2,
};

use gdcm_model::number_format::counted;

use self::files::{files_ui, notes_ui};
use self::options::{formats_ui, options_ui};
use crate::gui::commands::command::Command;
use crate::gui::commands::file::FileCommand;
use crate::gui::commands::form::FormCommand;
use crate::gui::commands::output::OutputCommand;
use crate::gui::state::window_state::State;
use crate::gui::widgets::controls::{Asks, named};
use crate::gui::widgets::elision::{end_elided, text_width};
use crate::gui::widgets::painted_text::painted_text;
use crate::gui::widgets::palette::{BODY_SIZE, Palette, TITLE_SIZE, body, medium};
use crate::gui::widgets::panel_layout::in_line_ui;

/// Maximum size of the dialog \[pt\].
const LARGEST: Vec2 = vec2(1028.0, 616.0);
/// Minimum distance between the dialog and the window edges, on each side \[pt\].
const MARGIN: f32 = 24.0;
/// Height of the title line \[pt\].
const HEAD: f32 = 45.0;
/// Height of the button line \[pt\].
const FOOT: f32 = 52.0;
/// Height of an error line \[pt\].
const ERROR: f32 = 30.0;
/// Column padding \[pt\].
const PADDING: f32 = 20.0;
/// Width of the column with the formats in a wide dialog \[pt\].
const FORMATS: f32 = 232.0;
/// Width of the column with the options in a wide dialog \[pt\].
const OPTIONS: f32 = 306.0;
/// Width of the common column with formats and options in a narrow dialog \[pt\].
const SHARED: f32 = 330.0;

/// Draws the dialog in front of the window.
pub(super) fn export_dialog_ui(
    ctx: &Context,
    state: &mut State,
    opens: bool,
    palette: &Palette,
    commands: &mut Vec<Command>,
) {
    let room = ctx.content_rect().size() - Vec2::splat(2.0 * MARGIN);
    let size = LARGEST.min(room);
    let frame = Frame::new()
        .fill(palette.panel)
        .stroke(Stroke::new(1.0, palette.line))
        .corner_radius(8.0);
    let modal = Modal::new(Id::unique("export dialog"))
        .frame(frame)
        .show(ctx, |ui| {
            let (whole, _) = ui.allocate_exact_size(size, egui::Sense::hover());
            let head = whole.with_max_y(whole.top() + HEAD);
            head_ui(ui, head, state, palette, commands);
            let foot = whole.with_min_y(whole.bottom() - FOOT);
            foot_ui(ui, foot, state, palette, commands);
            let mut body = Rect::from_min_max(head.left_bottom(), foot.right_top());
            if state.forms.export.error.is_some() {
                let strip = body.with_min_y(body.bottom() - ERROR);
                error_ui(ui, strip, state, palette, commands);
                body.set_bottom(strip.top());
            }
            body_ui(ui, body, state, opens, palette, commands);
        });
    if modal.should_close() {
        commands.push(FormCommand::ShowForm(None).into());
    }
}

/// Draws the columns between title and buttons.
fn body_ui(
    ui: &mut Ui,
    body: Rect,
    state: &mut State,
    opens: bool,
    palette: &Palette,
    commands: &mut Vec<Command>,
) {
    let line = Stroke::new(1.0, palette.line);
    ui.painter().hline(body.x_range(), body.top(), line);
    ui.painter().hline(body.x_range(), body.bottom(), line);
    let is_narrow = !state.display.layout.is_wide;
    let left = if is_narrow { SHARED } else { FORMATS + OPTIONS };
    let lists = body.with_min_x(body.left() + left);
    if is_narrow {
        let shared = body.with_max_x(lists.left());
        column_ui(ui, "formats and options", shared, |ui| {
            formats_ui(ui, state, palette);
            ui.add_space(12.0);
            options_ui(ui, state, opens, palette, commands);
        });
    } else {
        let formats = body.with_max_x(body.left() + FORMATS);
        column_ui(ui, "formats", formats, |ui| formats_ui(ui, state, palette));
        ui.painter().vline(formats.right(), body.y_range(), line);
        let options = Rect::from_x_y_ranges(formats.right()..=lists.left(), body.y_range());
        column_ui(ui, "options", options, |ui| {
            options_ui(ui, state, opens, palette, commands);
        });
    }
    ui.painter().vline(lists.left(), body.y_range(), line);
    let inner = lists.shrink2(vec2(PADDING, 12.0));
    ui.scope_builder(UiBuilder::new().max_rect(inner), |ui| {
        files_ui(ui, state, palette);
        ui.add_space(12.0);
        notes_ui(ui, state, palette, commands);
    });
}

/// Draws a column that scrolls if it is too high.
fn column_ui(ui: &mut Ui, name: &str, place: Rect, add: impl FnOnce(&mut Ui)) {
    let inner = place
        .shrink2(vec2(PADDING, 12.0))
        .with_max_x(place.right() - 8.0);
    ui.scope_builder(UiBuilder::new().max_rect(inner).id_salt(name), |ui| {
        ui.set_clip_rect(place.intersect(ui.clip_rect()));
        ScrollArea::vertical()
            .id_salt(name)
            .auto_shrink(false)
            .show(ui, |ui| {
                ui.set_width(inner.width() - 12.0);
                ui.spacing_mut().item_spacing.y = 4.0;
                add(ui);
            });
    });
}

/// Draws the title, the dataset name, and the button that closes the dialog.
fn head_ui(
    ui: &mut Ui,
    place: Rect,
    state: &State,
    palette: &Palette,
    commands: &mut Vec<Command>,
) {
    let inner = place.shrink2(vec2(PADDING, 0.0));
    let title = painted_text(ui, inner, 0.0, "Export", medium(TITLE_SIZE), palette.text);
    let rest = inner
        .with_min_x(title.right() + 10.0)
        .with_max_x(inner.right() - 32.0);
    let words = format!("corrections of {}", state.dataset().name());
    let words = end_elided(ui, &words, rest.width(), BODY_SIZE);
    painted_text(ui, rest, 0.0, &words, body(), palette.dim_text);
    in_line_ui(ui, inner, true, |ui| {
        let close = ui.add(Button::new("×").frame(false));
        named(close, Role::Button, "Close export").asks(FormCommand::ShowForm(None), commands);
    });
}

/// Draws why the last attempt failed, with a button that saves the study if that is the remedy.
fn error_ui(
    ui: &mut Ui,
    place: Rect,
    state: &mut State,
    palette: &Palette,
    commands: &mut Vec<Command>,
) {
    let Some(error) = &state.forms.export.error else {
        return;
    };
    ui.painter().rect_filled(place, 0.0, palette.warning_ground);
    let inner = place.shrink2(vec2(PADDING, 2.0));
    let needs_saving = error.code == "study-not-saved";
    let text = error.text.clone();
    let mut is_closed = false;
    in_line_ui(ui, inner, true, |ui| {
        let close = ui.add(Button::new("×").frame(false));
        is_closed = named(close, Role::Button, "Close error").clicked();
        if needs_saving {
            ui.button("Save study")
                .asks(FileCommand::SaveStudy, commands);
        }
        ui.with_layout(Layout::left_to_right(Align::Center), |ui| {
            let words = RichText::new(&text).color(palette.warning);
            ui.add(Label::new(words).truncate()).on_hover_text(&text);
        });
    });
    if is_closed {
        state.forms.export.error = None;
    }
}

/// Draws the buttons: copying the equivalent command line, cancelling, exporting.
fn foot_ui(
    ui: &mut Ui,
    place: Rect,
    state: &State,
    palette: &Palette,
    commands: &mut Vec<Command>,
) {
    let inner = place.shrink2(vec2(PADDING, 8.0));
    let form = &state.forms.export;
    let plan = state.current_export_plan();
    let is_possible = plan.is_some_and(|plan| plan.first_fault().is_none());
    let count = match plan {
        Some(plan) => plan.file_count(),
        None => form.choices.formats.len(),
    };
    in_line_ui(ui, inner, true, |ui| {
        ui.spacing_mut().item_spacing.x = 10.0;
        let text = format!("Export {}", counted(count, "file"));
        let color = if is_possible {
            palette.on_accent()
        } else {
            palette.dim_text
        };
        let text = RichText::new(text).font(medium(BODY_SIZE)).color(color);
        let button = Button::new(text).min_size(vec2(104.0, 28.0));
        let button = if is_possible {
            button.fill(palette.accent)
        } else {
            button
        };
        ui.add_enabled(is_possible, button)
            .asks(OutputCommand::Export, commands);
        ui.add(Button::new("Cancel").min_size(vec2(66.0, 28.0)))
            .asks(FormCommand::ShowForm(None), commands);
    });
    let left = inner.with_max_x(inner.left() + 0.6 * inner.width());
    in_line_ui(ui, left, false, |ui| {
        ui.label(palette.dim("Equivalent command line"));
        let text = RichText::new("Copy").color(palette.accent);
        let copy = ui.add_enabled(form.export_set().is_ok(), Button::new(text).frame(false));
        named(copy, Role::Button, "Copy command line")
            .asks(OutputCommand::CopyExportCommand, commands);
    });
}

/// Draws a line over the available width, `height` \[pt\] high, with a dim label at the left and a
/// control at the right.
fn labelled_ui(
    ui: &mut Ui,
    label: &str,
    height: f32,
    palette: &Palette,
    add: impl FnOnce(&mut Ui),
) {
    let width = ui.available_width();
    let (line, _) = ui.allocate_exact_size(vec2(width, height), egui::Sense::hover());
    painted_text(ui, line, 0.0, label, body(), palette.dim_text);
    let label_width = text_width(ui, label, body());
    let rest = Rect::from_min_max(pos2(line.left() + label_width + 8.0, line.top()), line.max);
    in_line_ui(ui, rest, true, add);
}
