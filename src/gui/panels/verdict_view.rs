//! Drawing of the verdict: counts and words for gain and phase, a caution, and the next steps.

use egui::{Align, Button, CornerRadius, Frame, Layout, Margin, RichText, Role, Sense, Ui, vec2};

use gdcm_model::number_format::counted;

use super::advice::{Step, export};
use super::verdict::{Verdict, VerdictRow};
use crate::gui::commands::command::Command;
use crate::gui::commands::layout::LayoutCommand;
use crate::gui::state::sheet::Sheet;
use crate::gui::widgets::controls::{Asks, named};
use crate::gui::widgets::elision::{elided, text_width};
use crate::gui::widgets::painted_text::{AT_RIGHT_END, painted_text};
use crate::gui::widgets::palette::{BODY_SIZE, Palette, TITLE_SIZE, body, medium, small};

/// Draws both verdict rows and the steps.
pub(super) fn verdict_ui(
    ui: &mut Ui,
    verdict: &Verdict,
    palette: &Palette,
    commands: &mut Vec<Command>,
) {
    let is_empty = verdict.rows[0].here.is_none() && verdict.caution.is_none();
    let (ground, mark) = if verdict.is_met() {
        (palette.good_ground, palette.good)
    } else if is_empty {
        (palette.raised, palette.line)
    } else {
        (palette.warning_ground, palette.warning)
    };
    let frame = Frame::new()
        .fill(ground)
        .corner_radius(CornerRadius::same(8))
        .inner_margin(Margin {
            left: 16,
            right: 12,
            top: 6,
            bottom: 8,
        });
    let shown = frame.show(ui, |ui| {
        ui.set_width(ui.available_width());
        heads_ui(ui, verdict, palette);
        for row in &verdict.rows {
            row_ui(ui, row, verdict.is_met(), palette);
        }
        ui.add_space(4.0);
        steps_ui(ui, verdict, palette, commands);
    });
    let edge = shown
        .response
        .rect
        .with_max_x(shown.response.rect.left() + 4.0);
    ui.painter().rect_filled(
        edge,
        CornerRadius {
            nw: 8,
            sw: 8,
            ne: 0,
            se: 0,
        },
        mark,
    );
}

/// Left edge of the count in a verdict row \[pt from the row's left edge\].
const COUNT_LEFT: f32 = 46.0;
/// Left edge of the words in a verdict row \[pt from the row's left edge\].
const WORDS_LEFT: f32 = 106.0;

fn heads_ui(ui: &mut Ui, verdict: &Verdict, palette: &Palette) {
    let (rect, _) = ui.allocate_exact_size(vec2(ui.available_width(), 16.0), Sense::hover());
    let here = format!("condition {}", verdict.condition);
    painted_text(ui, rect, COUNT_LEFT, &here, small(), palette.dim_text);
    painted_text(ui, rect, AT_RIGHT_END, "all", small(), palette.dim_text);
}

fn row_ui(ui: &mut Ui, row: &VerdictRow, is_all_met: bool, palette: &Palette) {
    let (rect, response) = ui.allocate_exact_size(vec2(ui.available_width(), 24.0), Sense::hover());
    named(response.clone(), Role::Label, row.sentence());
    painted_text(ui, rect, 0.0, row.name, body(), palette.dim_text);
    let is_missed = row
        .here
        .is_some_and(|count| count.matched < count.constrained);
    let color = if is_all_met {
        palette.good
    } else if is_missed {
        palette.warning
    } else {
        palette.text
    };
    painted_text(
        ui,
        rect,
        COUNT_LEFT,
        &VerdictRow::count_text(row.here),
        medium(TITLE_SIZE),
        color,
    );
    let everywhere = VerdictRow::count_text(row.everywhere);
    let all = painted_text(
        ui,
        rect,
        AT_RIGHT_END,
        &everywhere,
        body(),
        palette.dim_text,
    );
    let room = all.left() - rect.left() - WORDS_LEFT - 6.0;
    // If the band does not fit, only "matched" is shown.
    let fits = text_width(ui, &row.message.text, body()) <= room;
    let words = if fits {
        row.message.text.as_str()
    } else {
        row.message.text.split(", ").next().unwrap_or_default()
    };
    let words = elided(ui, words, room, BODY_SIZE);
    painted_text(ui, rect, WORDS_LEFT, &words, body(), palette.text);
    response.on_hover_text(row.sentence());
}

fn steps_ui(ui: &mut Ui, verdict: &Verdict, palette: &Palette, commands: &mut Vec<Command>) {
    // Skip the export step: the primary button at the foot of the panel already exports.
    let primary = verdict
        .steps
        .first()
        .filter(|step| step.command != export());
    let links: Vec<&Step> = verdict.steps.iter().skip(1).collect();
    let remarks = remarks_step(verdict);
    if verdict.caution.is_none() || primary.is_none() {
        let line = StepsLine {
            caution: verdict.caution_text(),
            primary,
            links,
            remarks: remarks.as_ref(),
            note: &verdict.note,
        };
        line.ui(ui, palette, commands);
        return;
    }
    // A caution and a pending decision each get their own line. The reasons explain the caution.
    let (reasons, others) = links.into_iter().partition(|step| shows_reasons(step));
    let caution_line = StepsLine {
        caution: verdict.caution_text(),
        primary: None,
        links: reasons,
        remarks: remarks.as_ref(),
        note: "",
    };
    caution_line.ui(ui, palette, commands);
    let decision_line = StepsLine {
        caution: None,
        primary,
        links: others,
        remarks: None,
        note: &verdict.note,
    };
    decision_line.ui(ui, palette, commands);
}

/// Line with, from left to right: a caution, a primary button, links, a note in the remaining width,
/// and the link to the remarks.
struct StepsLine<'a> {
    caution: Option<&'a str>,
    primary: Option<&'a Step>,
    links: Vec<&'a Step>,
    /// Link to the remarks.
    remarks: Option<&'a Step>,
    note: &'a str,
}

impl StepsLine<'_> {
    fn ui(&self, ui: &mut Ui, palette: &Palette, commands: &mut Vec<Command>) {
        ui.horizontal(|ui| {
            let has_buttons = self.primary.is_some() || self.caution.is_none();
            ui.set_min_height(if has_buttons { 28.0 } else { 22.0 });
            if let Some(caution) = self.caution {
                self.caution_ui(ui, caution, palette);
            }
            if let Some(step) = self.primary {
                step_ui(ui, step, true, palette, commands);
            }
            for step in &self.links {
                step_ui(ui, step, false, palette, commands);
            }
            ui.with_layout(Layout::right_to_left(Align::Center), |ui| {
                if let Some(remarks) = self.remarks {
                    step_ui(ui, remarks, false, palette, commands);
                }
                if !self.note.is_empty() {
                    ui.with_layout(Layout::left_to_right(Align::Center), |ui| {
                        self.note_ui(ui, palette);
                    });
                }
            });
        });
    }

    /// Draws "⚠ Price: +21 dB above 12 rad/s", without "Price: " in a narrow panel.
    fn caution_ui(&self, ui: &mut Ui, caution: &str, palette: &Palette) {
        let width: f32 = self
            .primary
            .into_iter()
            .chain(self.links.iter().copied())
            .chain(self.remarks)
            .map(|step| text_width(ui, &step.label, body()) + 24.0)
            .sum();
        let room = ui.available_width() - width;
        let whole = format!("⚠ {caution}");
        let short = format!("⚠ {}", caution.strip_prefix("Price: ").unwrap_or(caution));
        let fits = text_width(ui, &whole, body()) <= room;
        let text = palette
            .small_warning(if fits { whole } else { short })
            .size(BODY_SIZE);
        ui.scope(|ui| {
            ui.set_max_width(room);
            ui.add(egui::Label::new(text).truncate())
                .on_hover_text(caution);
        });
    }

    /// Draws "of 19 models, as a first step", or only "of 19 models" in a narrow panel.
    fn note_ui(&self, ui: &mut Ui, palette: &Palette) {
        let fits = text_width(ui, self.note, small()) <= ui.available_width();
        let shown = if fits {
            self.note
        } else {
            self.note.split(", ").next().unwrap_or(self.note)
        };
        ui.add(egui::Label::new(palette.small(shown)).truncate())
            .on_hover_text(self.note);
    }
}

/// Draws a step as a link, or as the only primary button in the window.
fn step_ui(
    ui: &mut Ui,
    step: &Step,
    is_primary: bool,
    palette: &Palette,
    commands: &mut Vec<Command>,
) {
    let label = RichText::new(&step.label);
    let button = if is_primary {
        Button::new(label.font(medium(BODY_SIZE)).color(palette.on_accent())).fill(palette.accent)
    } else {
        Button::new(label.color(palette.accent)).frame(false)
    };
    ui.add(button.min_size(vec2(0.0, 28.0)))
        .asks(step.command.clone(), commands);
}

/// Returns the link to the remarks in the sheet of reasons; `None` if there are none, or if another
/// step opens the sheet.
fn remarks_step(verdict: &Verdict) -> Option<Step> {
    if verdict.reasons == 0 || verdict.steps.iter().any(shows_reasons) {
        return None;
    }
    Some(Step {
        label: counted(verdict.reasons, "note"),
        command: Command::Layout(LayoutCommand::ShowSheet(Some(Sheet::Reasons))),
    })
}

/// Returns whether the step opens the sheet of reasons.
fn shows_reasons(step: &Step) -> bool {
    step.command == Command::Layout(LayoutCommand::ShowSheet(Some(Sheet::Reasons)))
}
