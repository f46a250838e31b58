//! Window arrangement: bars at the top and at the foot, side panels, views in the middle, and
//! sheets over the views.

use egui::{CentralPanel, Frame, Margin, Panel, Rect, ScrollArea, Ui, UiBuilder};

use gdcm_model::dataset::BundleKind;

use crate::gui::commands::command::Command;
use crate::gui::commands::layout::LayoutCommand;
use crate::gui::commands::selection::SelectionCommand;
use crate::gui::panels::menu_bar::menu_bar_ui;
use crate::gui::panels::sheet_frame::sheet_ui;
use crate::gui::panels::{
    centre, conditions_panel, derivation_sheet, models_panel, rail, record_conditions, right_panel,
    settings_panel, start_page, status_bar,
};
use crate::gui::state::sheet::Sheet;
use crate::gui::state::view::View;
use crate::gui::state::window_state::State;
use crate::gui::views::assembling::assembling_ui;
use crate::gui::views::physics::parameter_list_ui;
use crate::gui::views::records::{records_panel_ui, records_sheet_ui};
use crate::gui::widgets::palette::Palette;
use crate::gui::widgets::panel_layout::restore_panel_size;

/// Minimum window width \[pt\] for full names and, unless the engineer has chosen otherwise, for
/// the full left panel: a smaller value would leave less room for the plots beside both panels.
const WIDE: f32 = 1400.0;

/// Draws the bars at the top and at the foot, and between them: the model import, if it is open;
/// else the start page, if it is shown; else the side panels, the views, and the open sheet over
/// the views.
pub(super) fn panels_ui(
    ui: &mut Ui,
    state: &mut State,
    palette: &Palette,
    commands: &mut Vec<Command>,
) {
    let bar = Frame::new()
        .fill(palette.panel)
        .inner_margin(Margin::symmetric(12, 0));
    state.display.layout.is_wide = ui.ctx().content_rect().width() >= WIDE;
    let top = Panel::top("menu bar").frame(bar).exact_size(36.0);
    top.show(ui, |ui| menu_bar_ui(ui, state, palette, commands));
    let status = Panel::bottom("status bar").frame(bar).exact_size(24.0);
    status.show(ui, |ui| {
        status_bar::status_bar_ui(ui, state, palette, commands)
    });
    if let Some(import) = &mut state.assembling {
        return assembling_ui(ui, import, palette, commands);
    }
    if state.on_start_page {
        CentralPanel::default()
            .frame(Frame::new())
            .show(ui, |ui| start_page::start_ui(ui, state, palette, commands));
        return;
    }
    left_ui(ui, state, palette, commands);
    right_ui(ui, state, palette, commands);
    let centre = ui.available_rect_before_wrap();
    CentralPanel::default()
        .frame(Frame::new())
        .show(ui, |ui| centre::centre_ui(ui, state, palette, commands));
    sheets_ui(ui, centre, state, palette, commands);
}

/// Maximum height of the condition list, as a share of the left panel's height; the models, records
/// or settings below it have the rest. The list's height depends on the dataset alone, so that it
/// looks the same beside every view.
const CONDITIONS_PART: f32 = 0.365;

/// Draws the left panel: as a narrow rail, with the settings beside it while they are open; or in
/// full, with the condition list above. Below the list are the settings while they are open, else
/// the list that belongs to the view in front: records, physics parameters or, for other views,
/// models.
fn left_ui(ui: &mut Ui, state: &State, palette: &Palette, commands: &mut Vec<Command>) {
    let side = Frame::new().fill(palette.panel);
    let layout = &state.display.layout;
    if !layout.has_left_panel() {
        let frame = side.inner_margin(Margin {
            left: 4,
            right: 2,
            top: 2,
            bottom: 4,
        });
        let panel = Panel::left("rail").frame(frame).exact_size(104.0);
        panel.show(ui, |ui| {
            ScrollArea::vertical()
                .id_salt("rail")
                .auto_shrink(false)
                .show(ui, |ui| {
                    ui.set_width(ui.available_width());
                    rail::rail_ui(ui, state, palette, commands);
                });
        });
        if state.display.layout.settings_open {
            settings_sheet_ui(ui, state, palette, commands);
        }
        return;
    }
    restore_panel_size(ui, "conditions and models");
    let panel = Panel::left("conditions and models")
        .frame(side)
        .default_size(272.0)
        .size_range(240.0..=420.0);
    panel.show(ui, |ui| {
        steady_ui(ui, |ui| {
            let frame = Frame::new().inner_margin(Margin {
                left: 12,
                right: 12,
                top: 4,
                bottom: 0,
            });
            frame.show(ui, |ui| {
                ui.spacing_mut().item_spacing.y = 0.0;
                let view = state.display.layout.arrangement.view();
                let has_records = view == View::Records;
                let most = CONDITIONS_PART * ui.available_height();
                ScrollArea::vertical()
                    .id_salt("conditions")
                    .max_height(most)
                    .auto_shrink([false, true])
                    .show(ui, |ui| {
                        if has_records {
                            record_conditions::record_conditions_ui(ui, state, palette, commands);
                        } else {
                            conditions_panel::conditions_ui(ui, state, palette, commands);
                        }
                    });
                ui.separator();
                if state.display.layout.settings_open {
                    settings_panel::settings_ui(ui, state, palette, commands);
                } else if has_records {
                    records_panel_ui(ui, state, palette, commands);
                } else if view == View::Physics {
                    parameter_list_ui(ui, state, palette, commands);
                } else {
                    models_panel::models_ui(ui, state, palette, commands);
                }
            });
        });
    });
}

/// Draws the settings beside the rail. They take their space from the views, which are laid out
/// once when the settings are opened, so that no value is covered while a slider is dragged.
fn settings_sheet_ui(ui: &mut Ui, state: &State, palette: &Palette, commands: &mut Vec<Command>) {
    let frame = Frame::new().fill(palette.panel).inner_margin(Margin {
        left: 12,
        right: 12,
        top: 4,
        bottom: 0,
    });
    Panel::left("settings beside the rail")
        .frame(frame)
        .resizable(false)
        .exact_size(272.0)
        .show(ui, |ui| {
            settings_panel::settings_ui(ui, state, palette, commands)
        });
}

/// Draws the right panel: verdict, result, matrix, and export.
fn right_ui(ui: &mut Ui, state: &mut State, palette: &Palette, commands: &mut Vec<Command>) {
    // Panel widths are stored by name: with two names, wide and narrow windows keep separate
    // widths.
    let (name, width) = if state.display.layout.is_wide {
        ("answer", 352.0)
    } else {
        ("answer beside the rail", 320.0)
    };
    restore_panel_size(ui, name);
    let panel = Panel::right(name)
        .frame(Frame::new().fill(palette.panel))
        .default_size(width)
        .size_range(300.0..=520.0);
    panel.show(ui, |ui| {
        steady_ui(ui, |ui| {
            right_panel::right_panel_ui(ui, state, palette, commands)
        })
    });
}

/// Draws content within the available space without growing it, so that a panel keeps its dragged
/// width.
fn steady_ui(ui: &mut Ui, add: impl FnOnce(&mut Ui)) {
    let room = ui.available_rect_before_wrap();
    let mut content = ui.new_child(UiBuilder::new().max_rect(room).layout(*ui.layout()));
    content.set_clip_rect(room.intersect(ui.clip_rect()));
    add(&mut content);
    ui.advance_cursor_after_rect(room);
}

/// Draws the open sheet over the views: first a derivation, else another sheet. The reasons are not
/// among them: they are drawn below the verdict.
fn sheets_ui(ui: &Ui, centre: Rect, state: &State, palette: &Palette, commands: &mut Vec<Command>) {
    let sheet = if state.display.selection.explained.is_some() {
        Sheet::Derivation
    } else if let Some(sheet) = state.display.layout.sheet
        && sheet != Sheet::Reasons
    {
        sheet
    } else {
        return;
    };
    let is_closed = sheet_ui(ui, centre, sheet, palette, |ui| match sheet {
        Sheet::Derivation => derivation_sheet::derivation_sheet_ui(ui, state, palette, commands),
        // Drawn below the verdict.
        Sheet::Reasons => {}
        Sheet::Records => records_sheet_ui(ui, state, palette, commands),
        Sheet::Models => {
            models_panel::bundle_sheet_ui(ui, state, BundleKind::Physics, palette, commands)
        }
        Sheet::Identified => {
            models_panel::bundle_sheet_ui(ui, state, BundleKind::Identified, palette, commands)
        }
    });
    // A click outside closes the sheet, unless it asks for another value's derivation.
    let asks = commands
        .iter()
        .any(|command| matches!(command, Command::Selection(SelectionCommand::Explain(_))));
    if is_closed && !asks {
        let close = if sheet == Sheet::Derivation {
            Command::Selection(SelectionCommand::Explain(None))
        } else {
            Command::Layout(LayoutCommand::ShowSheet(None))
        };
        commands.push(close);
    }
}
