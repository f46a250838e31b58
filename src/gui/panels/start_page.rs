//! Start page, shown without panels: three ways to begin, each named after the engineer's data,
//! and, in a wide window, the open study.

use egui::{
    Align, Align2, Button, Color32, Layout, Rect, RichText, Role, ScrollArea, Sense, Shape, Stroke,
    StrokeKind, Ui, UiBuilder, pos2, vec2,
};

use super::open_study_card::open_study_card_ui;
use super::start_icons::{folder_icon, sheet_icon, wave_icon};
use crate::gui::commands::assembling::AssemblingCommand;
use crate::gui::commands::command::Command;
use crate::gui::commands::file::FileCommand;
use crate::gui::commands::records::RecordsCommand;
use crate::gui::state::window_state::State;
use crate::gui::widgets::controls::{Asks, named};
use crate::gui::widgets::elision::elided;
use crate::gui::widgets::painted_text::painted_text;
use crate::gui::widgets::palette::{
    BODY_SIZE, DISPLAY_SIZE, Palette, SMALL_SIZE, TITLE_SIZE, body, medium, small,
};

/// Width of the column with the ways to begin \[pt\].
const WAYS_WIDTH: f32 = 600.0;
/// Width of the open study's card \[pt\].
const STUDY_WIDTH: f32 = 460.0;
/// Gap between the ways to begin and the open study \[pt\].
const GAP: f32 = 64.0;
/// Maximum page height \[pt\].
const MOST_HEIGHT: f32 = 450.0;
/// Line height in multi-line text \[pt\].
const LINE: f32 = 20.0;
/// Card height for a way to begin \[pt\].
const WAY_HEIGHT: f32 = 72.0;

/// Way to begin, drawn as a card.
struct Way {
    title: &'static str,
    words: &'static str,
    button: &'static str,
    command: Command,
    icon: fn(&Ui, Rect, Color32),
}

/// Returns the ways to begin, the most frequent first.
fn ways() -> [Way; 3] {
    [
        Way {
            title: "I have a dataset or a study",
            words: "Written by this program or a script: .json, .json.gz",
            button: "Open dataset…",
            command: Command::File(FileCommand::AskOpen),
            icon: sheet_icon,
        },
        Way {
            title: "I have model files",
            words: "A folder of linear models: MATLAB, NumPy, JSON or text",
            button: "Import models…",
            command: AssemblingCommand::Open.into(),
            icon: folder_icon,
        },
        Way {
            title: "I have flight records",
            words: "Sweeps as CSV, MATLAB or logs; models are identified here",
            button: "Import records…",
            command: RecordsCommand::AskFiles.into(),
            icon: wave_icon,
        },
    ]
}

/// Draws the start page: on the left the ways to begin, with the recent files or the steps of work;
/// on the right the open study, if there is room.
pub fn start_ui(ui: &mut Ui, state: &mut State, palette: &Palette, commands: &mut Vec<Command>) {
    let area = ui.available_rect_before_wrap().shrink(24.0);
    let both = WAYS_WIDTH + STUDY_WIDTH + GAP;
    let has_both = area.width() >= both;
    let width = if has_both {
        both
    } else {
        WAYS_WIDTH.min(area.width())
    };
    let height = MOST_HEIGHT.min(area.height());
    let page = Rect::from_center_size(area.center(), vec2(width, height));
    let column = page.with_max_x(page.left() + WAYS_WIDTH.min(width));
    ui.scope_builder(UiBuilder::new().max_rect(column), |ui| {
        ScrollArea::vertical()
            .id_salt("start")
            .auto_shrink([false, true])
            .show(ui, |ui| {
                ways_ui(ui, palette, commands);
                ui.add_space(20.0);
                if state.recent.is_empty() {
                    steps_ui(ui, palette)
                } else {
                    recent_ui(ui, state, palette, commands)
                }
            });
    });
    if has_both {
        let card = page.with_min_x(page.right() - STUDY_WIDTH);
        ui.scope_builder(UiBuilder::new().max_rect(card), |ui| {
            open_study_card_ui(ui, state, palette, commands)
        });
    }
    ui.advance_cursor_after_rect(area);
}

fn ways_ui(ui: &mut Ui, palette: &Palette, commands: &mut Vec<Command>) {
    ui.label(RichText::new("Match a physics model to flight").font(medium(DISPLAY_SIZE)));
    ui.label(palette.dim(
        "One gain and one delay per channel, scheduled with airspeed. Gains and delays have error bars.",
    ));
    ui.add_space(16.0);
    for (place, way) in ways().into_iter().enumerate() {
        way_ui(ui, way, place == 0, palette, commands);
        ui.add_space(4.0);
    }
    let (rect, _) = ui.allocate_exact_size(vec2(ui.available_width(), 40.0), Sense::hover());
    let corners = [
        rect.left_top(),
        rect.right_top(),
        rect.right_bottom(),
        rect.left_bottom(),
        rect.left_top(),
    ];
    let stroke = Stroke::new(1.0, palette.line);
    for side in corners.windows(2) {
        ui.painter()
            .extend(Shape::dashed_line(side, stroke, 4.0, 3.0));
    }
    let words = "or drop files, or a folder, anywhere in this window";
    ui.painter().text(
        rect.center(),
        Align2::CENTER_CENTER,
        words,
        body(),
        palette.dim_text,
    );
}

fn way_ui(ui: &mut Ui, way: Way, is_primary: bool, palette: &Palette, commands: &mut Vec<Command>) {
    let (rect, _) = ui.allocate_exact_size(vec2(ui.available_width(), WAY_HEIGHT), Sense::hover());
    ui.painter().rect(
        rect,
        8.0,
        palette.panel,
        Stroke::new(1.0, palette.line),
        StrokeKind::Inside,
    );
    let icon = Rect::from_center_size(pos2(rect.left() + 30.0, rect.center().y), vec2(22.0, 22.0));
    (way.icon)(
        ui,
        icon,
        if is_primary {
            palette.accent
        } else {
            palette.dim_text
        },
    );
    let text = rect.with_min_x(rect.left() + 58.0);
    let upper = text
        .with_max_y(rect.center().y + 2.0)
        .with_min_y(rect.top() + 12.0);
    let lower = text
        .with_min_y(rect.center().y)
        .with_max_y(rect.bottom() - 12.0);
    painted_text(ui, upper, 0.0, way.title, medium(TITLE_SIZE), palette.text);
    painted_text(ui, lower, 0.0, way.words, body(), palette.dim_text);
    let place = Rect::from_center_size(
        pos2(rect.right() - 84.0, rect.center().y),
        vec2(132.0, 28.0),
    );
    let color = if is_primary {
        palette.on_accent()
    } else {
        palette.text
    };
    let button = Button::new(
        RichText::new(way.button)
            .font(medium(BODY_SIZE))
            .color(color),
    )
    .min_size(place.size());
    let button = if is_primary {
        button.fill(palette.accent)
    } else {
        button
    };
    ui.put(place, button).asks(way.command, commands);
    ui.advance_cursor_after_rect(rect);
}

/// Draws the three steps of work, shown while there are no recent files.
fn steps_ui(ui: &mut Ui, palette: &Palette) {
    let steps = [
        (
            "1  Judge",
            "which physics models disagree with their bundle",
        ),
        (
            "2  Match",
            "gains and delays that match chosen responses to flight",
        ),
        (
            "3  Schedule",
            "one correction over airspeed, with its error bars",
        ),
    ];
    ui.columns(3, |columns| {
        for (ui, (title, words)) in columns.iter_mut().zip(steps) {
            let (line, _) = ui.allocate_exact_size(vec2(ui.available_width(), 6.0), Sense::hover());
            ui.painter()
                .hline(line.x_range(), line.top(), Stroke::new(2.0, palette.line));
            ui.label(RichText::new(title).font(medium(BODY_SIZE)));
            ui.with_layout(Layout::top_down(Align::Min), |ui| {
                ui.label(palette.dim(words).line_height(Some(LINE)))
            });
        }
    });
}

/// Draws the newest recent files; missing files cannot be opened.
fn recent_ui(ui: &mut Ui, state: &State, palette: &Palette, commands: &mut Vec<Command>) {
    const SHOWN: usize = 5;
    ui.label(RichText::new("Open again").font(medium(BODY_SIZE)));
    for file in state.recent.iter().take(SHOWN) {
        let (row, response) =
            ui.allocate_exact_size(vec2(ui.available_width(), 22.0), Sense::click());
        let is_pointed = !file.missing && (response.hovered() || response.has_focus());
        if is_pointed {
            ui.painter().rect_filled(row, 4.0, palette.raised);
        }
        let color = if file.missing {
            palette.quiet_text
        } else {
            palette.accent
        };
        let name = painted_text(ui, row, 4.0, &file.name, body(), color);
        let folder = if file.missing {
            format!("{}, missing", file.folder)
        } else {
            file.folder.clone()
        };
        let room = row.right() - name.right() - 16.0;
        let folder = elided(ui, &folder, room, SMALL_SIZE);
        painted_text(
            ui,
            row,
            name.right() - row.left() + 10.0,
            &folder,
            small(),
            palette.dim_text,
        );
        let response = named(
            response,
            Role::Button,
            format!("Open again: {} in {}", file.name, file.folder),
        );
        if response.clicked() && !file.missing {
            commands.push(FileCommand::Open(file.path.clone()).into());
        }
    }
}
