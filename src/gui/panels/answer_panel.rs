//! Right side of the window, from top to bottom: verdict, result, constraint matrix, card of the
//! focused response, settings line, export.

use egui::{
    Align, Button, CornerRadius, Frame, Layout, Margin, Panel, Rect, RichText, Role, ScrollArea,
    Sense, Ui, pos2, vec2,
};

use gdcm_method::correction::delta::GainSource;
use gdcm_model::units::number;
use gdcm_study::PhaseCorrection;
use gdcm_study::decisions::setting;

use super::advice::{Step, export};
use super::verdict::{Verdict, VerdictRow, band_words};
use super::{matrix_panel, response_card, result_panel, settings_panel};
use crate::gui::commands::command::Command;
use crate::gui::commands::layout::LayoutCommand;
use crate::gui::state::sheet::Sheet;
use crate::gui::state::window_state::State;
use crate::gui::widgets::controls::{
    Asks, chevron, elided, named, named_switch, painted_text, text_width,
};
use crate::gui::widgets::focus::{Region, region_ui, take_escape};
use crate::gui::widgets::palette::{
    BODY_SIZE, Palette, SMALL_SIZE, TITLE_SIZE, body, medium, small,
};

/// Space around everything \[pt\].
const PADDING: f32 = 12.0;
/// Settings line height \[pt\].
const LINE: f32 = 36.0;
/// Height of the export row \[pt\].
const FOOT: f32 = 48.0;
/// Minimum window height that shows the card of the focused response \[pt\].
const LEAST_WITH_CARD: f32 = 860.0;
/// Minimum window height that shows the full result; in lower windows the result takes a single
/// line \[pt\].
const LEAST_WITH_RESULT: f32 = 600.0;

/// Draws verdict, result and matrix, or the open settings, above the export row.
pub fn answer_ui(ui: &mut Ui, state: &State, palette: &Palette, commands: &mut Vec<Command>) {
    let verdict = Verdict::new(state);
    let foot = Frame::new().inner_margin(Margin::ZERO);
    Panel::bottom("export")
        .frame(foot)
        .exact_size(LINE + FOOT)
        .show(ui, |ui| {
            region_ui(ui, Region::Settings, |ui| {
                settings_line_ui(ui, state, palette, commands)
            });
            export_ui(ui, state, &verdict, palette, commands);
        });
    let window = ui.ctx().content_rect().height();
    let frame = Frame::new().inner_margin(Margin {
        left: PADDING as i8,
        right: PADDING as i8,
        top: 8,
        bottom: 4,
    });
    frame.show(ui, |ui| {
        ui.spacing_mut().item_spacing.y = 0.0;
        // The width is fixed here, so that wide content of one part does not widen the next part.
        let width = ui.available_width();
        region_ui(ui, Region::Verdict, |ui| {
            verdict_ui(ui, &verdict, palette, commands)
        });
        ui.add_space(8.0);
        if state.display.layout.settings_open {
            ScrollArea::vertical()
                .id_salt("settings")
                .auto_shrink([false, false])
                .show(ui, |ui| {
                    settings_panel::settings_ui(ui, state, palette, commands);
                });
            return;
        }
        ui.set_max_width(width);
        let is_folded = window < LEAST_WITH_RESULT;
        region_ui(ui, Region::Result, |ui| {
            result_panel::result_ui(ui, state, is_folded, palette, commands)
        });
        ui.add_space(8.0);
        let card = if window >= LEAST_WITH_CARD {
            response_card::CARD_HEIGHT + 12.0
        } else {
            0.0
        };
        matrix_panel::matrix_ui(ui, state, ui.available_height() - card, palette, commands);
        if card > 0.0 {
            ui.add_space(12.0);
            response_card::card_ui(ui, state, palette);
        }
    });
}

/// Draws both verdict rows and the steps.
fn verdict_ui(ui: &mut Ui, verdict: &Verdict, palette: &Palette, commands: &mut Vec<Command>) {
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

/// Left edges of count and words in a verdict row \[pt from the row's left edge\].
const COLUMNS: [f32; 2] = [46.0, 106.0];

fn heads_ui(ui: &mut Ui, verdict: &Verdict, palette: &Palette) {
    let (rect, _) = ui.allocate_exact_size(vec2(ui.available_width(), 16.0), Sense::hover());
    let here = format!("condition {}", verdict.condition);
    painted_text(ui, rect, COLUMNS[0], &here, small(), palette.dim_text);
    painted_text(ui, rect, -0.01, "all", small(), palette.dim_text);
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
        COLUMNS[0],
        &VerdictRow::count_text(row.here),
        medium(TITLE_SIZE),
        color,
    );
    let everywhere = VerdictRow::count_text(row.everywhere);
    let all = painted_text(ui, rect, -0.01, &everywhere, body(), palette.dim_text);
    let room = all.left() - rect.left() - COLUMNS[1] - 6.0;
    // If the band does not fit, only "matched" is shown.
    let fits = text_width(ui, &row.words, body()) <= room;
    let words = if fits {
        row.words.as_str()
    } else {
        row.words.split(", ").next().unwrap_or_default()
    };
    let words = elided(ui, words, room, BODY_SIZE);
    painted_text(ui, rect, COLUMNS[1], &words, body(), palette.text);
    response.on_hover_text(row.sentence());
}

fn steps_ui(ui: &mut Ui, verdict: &Verdict, palette: &Palette, commands: &mut Vec<Command>) {
    // Skip the export step: the primary button at the foot of the panel already exports.
    let primary = verdict
        .steps
        .first()
        .filter(|step| step.command != export());
    let mut links: Vec<Step> = verdict.steps.iter().skip(1).cloned().collect();
    links.extend(notes_step(verdict));
    if verdict.caution.is_none() || primary.is_none() {
        let line = StepsLine {
            caution: verdict.caution.as_deref(),
            primary,
            links: &links,
            note: &verdict.note,
        };
        line.ui(ui, palette, commands);
        return;
    }
    // A caution and a pending decision each get their own line.
    let (notes, links): (Vec<Step>, Vec<Step>) = links.into_iter().partition(shows_reasons);
    let caution_line = StepsLine {
        caution: verdict.caution.as_deref(),
        primary: None,
        links: &notes,
        note: "",
    };
    caution_line.ui(ui, palette, commands);
    let decision_line = StepsLine {
        caution: None,
        primary,
        links: &links,
        note: &verdict.note,
    };
    decision_line.ui(ui, palette, commands);
}

/// Returns whether the step opens the sheet of reasons.
fn shows_reasons(step: &Step) -> bool {
    step.command == Command::Layout(LayoutCommand::ShowSheet(Some(Sheet::Reasons)))
}

/// Returns the link to the reasons if no other step leads there.
fn notes_step(verdict: &Verdict) -> Option<Step> {
    if verdict.reasons == 0 || verdict.steps.iter().any(shows_reasons) {
        return None;
    }
    Some(Step {
        label: format!("{} notes", verdict.reasons),
        command: Command::Layout(LayoutCommand::ShowSheet(Some(Sheet::Reasons))),
    })
}

/// Line with a caution, a primary button, links, and a note in the remaining width.
struct StepsLine<'a> {
    caution: Option<&'a str>,
    primary: Option<&'a Step>,
    links: &'a [Step],
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
            let (at_end, links): (Vec<&Step>, Vec<&Step>) = self
                .links
                .iter()
                .partition(|step| step.label.ends_with(" notes"));
            for step in links {
                step_ui(ui, step, false, palette, commands);
            }
            ui.with_layout(Layout::right_to_left(Align::Center), |ui| {
                for step in at_end {
                    step_ui(ui, step, false, palette, commands);
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
            .chain(self.links)
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

/// Draws the settings in a single line; a click unfolds them over matrix and card.
fn settings_line_ui(ui: &mut Ui, state: &State, palette: &Palette, commands: &mut Vec<Command>) {
    let is_open = state.display.layout.settings_open;
    let (rect, response) = ui.allocate_exact_size(vec2(ui.available_width(), LINE), Sense::click());
    ui.painter().hline(
        rect.x_range(),
        rect.top(),
        ui.visuals().widgets.noninteractive.bg_stroke,
    );
    if response.hovered() {
        ui.painter()
            .rect_filled(rect.shrink2(vec2(0.0, 1.0)), 0.0, palette.raised);
    }
    let inner = rect.shrink2(vec2(PADDING, 0.0));
    let title = painted_text(ui, inner, 0.0, "Settings", medium(BODY_SIZE), palette.text);
    let words = settings_words(state);
    let shown = elided(ui, &words, inner.right() - title.right() - 32.0, SMALL_SIZE);
    painted_text(
        ui,
        inner,
        title.right() - inner.left() + 10.0,
        &shown,
        small(),
        palette.dim_text,
    );
    chevron(
        ui,
        pos2(inner.right() - 5.0, inner.center().y),
        is_open,
        palette,
    );
    let response = named_switch(response, Role::Button, is_open, "Settings");
    if response.clicked() || (is_open && take_escape(ui.ctx())) {
        commands.push(LayoutCommand::ShowSettings(!is_open).into());
    }
    let action = if is_open { "Fold" } else { "Open" };
    response.on_hover_text(format!("{words}\n{action} with Ctrl+comma"));
}

/// "α 1 · 0.5–12 rad/s · delays · representatives".
fn settings_words(state: &State) -> String {
    let settings = &state.study.settings;
    let gains = number(settings.alpha_gain);
    let delays = number(settings.alpha_delay);
    let alpha = if gains == delays {
        format!("α {gains}")
    } else {
        format!("α {gains}, {delays}")
    };
    let phase = match settings.phase {
        PhaseCorrection::None => "gains alone",
        PhaseCorrection::Delay => "delays",
        PhaseCorrection::Lead => "leads",
    };
    let mut words = format!("{alpha} · {} · {phase}", band_words(state));
    if settings.gain_source == GainSource::MeanOfPairs || state.display.layout.is_wide {
        words.push_str(" · ");
        words.push_str(&setting::GAIN_SOURCE.text(setting::GAIN_SOURCE.value(settings)));
    }
    words
}

/// Draws the export button, which is always visible, and primary if no other step is left.
fn export_ui(
    ui: &mut Ui,
    state: &State,
    verdict: &Verdict,
    palette: &Palette,
    commands: &mut Vec<Command>,
) {
    let (rect, _) = ui.allocate_exact_size(vec2(ui.available_width(), FOOT), Sense::hover());
    ui.painter().hline(
        rect.x_range(),
        rect.top(),
        ui.visuals().widgets.noninteractive.bg_stroke,
    );
    let inner = rect.shrink2(vec2(PADDING, 10.0));
    let is_ready = state.analysis().is_some();
    let is_primary = verdict
        .steps
        .first()
        .is_some_and(|step| step.command == export());
    let color = if is_primary {
        palette.on_accent()
    } else {
        palette.text
    };
    let button = Button::new(
        RichText::new("Export corrections…")
            .font(medium(BODY_SIZE))
            .color(color),
    );
    let button = if is_primary {
        button.fill(palette.accent)
    } else {
        button
    };
    let place = Rect::from_min_size(inner.min, vec2(140.0, 28.0));
    region_ui(ui, Region::Export, |ui| {
        ui.scope_builder(egui::UiBuilder::new().max_rect(place), |ui| {
            let export_button = ui.add_enabled(is_ready, button.min_size(place.size()));
            let hint = "Write corrections.json, corrections.csv and assessment.csv (Ctrl+E)";
            export_button.on_hover_text(hint).asks(export(), commands);
        });
    });
    let count = state.dataset().conditions().len();
    let noun = if count == 1 {
        "condition"
    } else {
        "conditions"
    };
    let mut content = format!("{count} {noun}");
    let has_schedule = state
        .analysis()
        .is_some_and(|analysis| analysis.schedule.is_ok());
    if has_schedule {
        content.push_str(", schedule");
    }
    painted_text(ui, inner, -0.01, &content, body(), palette.dim_text);
}
