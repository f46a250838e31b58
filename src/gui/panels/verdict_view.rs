//! Drawing the verdict: counts and words for gain and phase, a caution, and the next steps. Every
//! line has a reserved place.

use egui::{
    Button, CornerRadius, Id, Rect, RichText, Role, Sense, Spinner, Ui, UiBuilder, pos2, vec2,
};

use gdcm_model::number_format::counted;

use super::advice::{Step, export};
use super::result_panel::OLDER;
use super::verdict::{Verdict, VerdictRow};
use crate::gui::commands::command::Command;
use crate::gui::commands::layout::LayoutCommand;
use crate::gui::state::sheet::Sheet;
use crate::gui::state::window_state::State;
use crate::gui::views::view_content;
use crate::gui::widgets::controls::{Asks, hint_left_of, named};
use crate::gui::widgets::elision::{elided, leading_parts, text_width};
use crate::gui::widgets::painted_text::{AT_RIGHT_END, painted_text};
use crate::gui::widgets::palette::{
    BODY_SIZE, Palette, SMALL_SIZE, TITLE_SIZE, body, medium, small,
};

/// Verdict height in wide windows \[pt\], reserved whatever the verdict contains, so that nothing
/// below moves when a step is taken.
const HEIGHT_WIDE: f32 = 128.0;
/// Verdict height in narrow windows \[pt\], reserved likewise.
const HEIGHT_NARROW: f32 = 112.0;
/// Height of the heading line \[pt\].
const HEADS: f32 = 16.0;
/// Height of the step line \[pt\].
const STEPS: f32 = 28.0;
/// Padding at the left, where the edge is coloured \[pt\].
const PAD_LEFT: f32 = 16.0;
/// Padding at the right \[pt\].
const PAD_RIGHT: f32 = 12.0;
/// Gap between two steps \[pt\].
const GAP: f32 = 8.0;

/// Verdict in the window, with its age.
pub(super) struct ShownVerdict {
    pub(super) verdict: Verdict,
    /// Whether the verdict belongs to older settings. Its steps are dimmed and have no effect.
    pub(super) is_older: bool,
    /// Whether the spinner in the heading turns.
    pub(super) spins: bool,
    /// Whether the recommended step is the window's primary button, in the accent colour; not while
    /// the view in front has a primary button.
    pub(super) is_primary: bool,
}

/// Returns the verdict to be displayed: while results are being computed, the verdict on the same
/// condition's previous results, kept in egui's memory, so that the steps do not change twice;
/// otherwise a new verdict, which is kept if the results are up to date.
pub(super) fn shown_verdict(ui: &Ui, state: &State) -> ShownVerdict {
    let id = Id::unique("verdict");
    let now = ui.input(|input| input.time);
    let results = &state.results;
    let condition = state.condition().id();
    let view = state.display.layout.arrangement.view();
    let is_primary = !(view_content(view).has_primary)(state);
    if results.is_waiting() && state.outcome().is_some() {
        let kept: Option<Verdict> = ui.ctx().data(|data| data.get_temp(id));
        if let Some(verdict) = kept
            && verdict.condition == condition
        {
            return ShownVerdict {
                verdict,
                is_older: results.is_stale(now),
                spins: results.spins(now),
                is_primary,
            };
        }
    }
    let verdict = Verdict::new(state);
    if !results.is_behind() {
        ui.ctx()
            .data_mut(|data| data.insert_temp(id, verdict.clone()));
    }
    ShownVerdict {
        verdict,
        is_older: results.is_stale(now),
        spins: results.spins(now),
        is_primary,
    }
}

/// Draws both verdict rows and the steps.
pub(super) fn verdict_ui(
    ui: &mut Ui,
    shown: &ShownVerdict,
    is_wide: bool,
    palette: &Palette,
    commands: &mut Vec<Command>,
) {
    let verdict = &shown.verdict;
    let is_empty = verdict.rows[0].here.is_none() && verdict.caution.is_none();
    let (ground, mark) = if verdict.is_met() {
        (palette.good_ground, palette.good)
    } else if is_empty {
        (palette.raised, palette.line)
    } else {
        (palette.warning_ground, palette.warning)
    };
    let height = if is_wide { HEIGHT_WIDE } else { HEIGHT_NARROW };
    let (area, _) = ui.allocate_exact_size(vec2(ui.available_width(), height), Sense::hover());
    ui.painter()
        .rect_filled(area, CornerRadius::same(8), ground);
    let edge_radius = CornerRadius {
        nw: 8,
        sw: 8,
        ne: 0,
        se: 0,
    };
    ui.painter()
        .rect_filled(area.with_max_x(area.left() + 4.0), edge_radius, mark);
    let places = VerdictPlaces::new(area);
    heads_ui(ui, places.heads, shown, palette);
    for (row, place) in verdict.rows.iter().zip(places.rows) {
        row_ui(ui, place, row, verdict.is_met(), palette);
    }
    ui.scope(|ui| {
        let line = StepsLine::new(verdict, shown.is_primary);
        if shown.is_older {
            // The steps keep the focus but have no effect: others may be recommended in a moment.
            ui.multiply_opacity(OLDER);
            line.ui(ui, places.steps, palette, &mut Vec::new());
        } else {
            line.ui(ui, places.steps, palette, commands);
        }
    });
}

/// Areas of the verdict's lines.
struct VerdictPlaces {
    heads: Rect,
    rows: [Rect; 2],
    steps: Rect,
}

impl VerdictPlaces {
    /// Divides the verdict's area; the spaces between the lines share the remaining height.
    fn new(area: Rect) -> Self {
        let row = if area.height() >= HEIGHT_WIDE {
            24.0
        } else {
            22.0
        };
        let inner = Rect::from_min_max(
            pos2(area.left() + PAD_LEFT, area.top()),
            pos2(area.right() - PAD_RIGHT, area.bottom()),
        );
        let space = (area.height() - HEADS - 2.0 * row - STEPS) / 3.0;
        let heads = line_within(inner, area.top() + 0.75 * space, HEADS);
        let first = line_within(inner, heads.bottom(), row);
        let second = line_within(inner, first.bottom(), row);
        let steps = line_within(inner, second.bottom() + space, STEPS);
        Self {
            heads,
            rows: [first, second],
            steps,
        }
    }
}

/// Returns a line across `inner` with this upper edge and height \[pt\].
fn line_within(inner: Rect, top: f32, height: f32) -> Rect {
    Rect::from_x_y_ranges(inner.x_range(), top..=top + height)
}

/// Left edge of the count in a verdict row \[pt from the row's left edge\].
const COUNT_LEFT: f32 = 46.0;
/// Left edge of the words in a verdict row \[pt from the row's left edge\].
const WORDS_LEFT: f32 = 106.0;

/// Draws the column headings, with the spinner at the left.
fn heads_ui(ui: &mut Ui, rect: Rect, shown: &ShownVerdict, palette: &Palette) {
    let here = format!("condition {}", shown.verdict.condition);
    painted_text(ui, rect, COUNT_LEFT, &here, small(), palette.dim_text);
    painted_text(ui, rect, AT_RIGHT_END, "all", small(), palette.dim_text);
    if shown.spins {
        let place = Rect::from_min_size(rect.left_top() + vec2(0.0, 2.0), vec2(12.0, 12.0));
        ui.put(place, Spinner::new().size(12.0).color(palette.dim_text));
    }
}

fn row_ui(ui: &Ui, rect: Rect, row: &VerdictRow, is_all_met: bool, palette: &Palette) {
    let id = ui.scope_id().with(("verdict", row.name));
    let response = ui.interact(rect, id, Sense::hover());
    named(response, Role::Label, row.sentence());
    painted_text(ui, rect, 0.0, row.name, body(), palette.dim_text);
    let is_missed = row.here.is_some_and(|count| count.matched < count.held);
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
    let words = leading_parts(ui, &row.message.text, room, BODY_SIZE);
    let words = elided(ui, words, room, BODY_SIZE);
    painted_text(ui, rect, WORDS_LEFT, &words, body(), palette.text);
}

/// Line with the steps, from left to right: the recommended step, its alternatives, the caution or
/// the note, and at the right end the link to the reasons.
struct StepsLine<'a> {
    recommended: Option<&'a Step>,
    alternatives: Vec<&'a Step>,
    caution: Option<&'a str>,
    note: &'a str,
    /// Step that opens the reasons; if the verdict has none, a link with the number of notes.
    reasons: Option<Step>,
    /// Whether the recommended step is the window's primary button.
    is_primary: bool,
}

impl<'a> StepsLine<'a> {
    /// Sorts the verdict's steps: the first is recommended, unless it exports or shows the reasons;
    /// the step that shows the reasons has its own place, and without one there is a link with the
    /// number of notes, if there are any; the others are alternatives.
    fn new(verdict: &'a Verdict, is_primary: bool) -> Self {
        // Skip the export step: the primary button at the foot of the panel already exports.
        let recommended = verdict
            .steps
            .first()
            .filter(|step| step.command != export() && !shows_reasons(step));
        let mut alternatives = Vec::new();
        for step in verdict.steps.iter().skip(1) {
            if !shows_reasons(step) {
                alternatives.push(step);
            }
        }
        let mut reasons = verdict
            .steps
            .iter()
            .find(|step| shows_reasons(step))
            .cloned();
        if reasons.is_none() && verdict.reasons > 0 {
            reasons = Some(Step::new(
                counted(verdict.reasons, "note"),
                LayoutCommand::ShowSheet(Some(Sheet::Reasons)),
            ));
        }
        Self {
            recommended,
            alternatives,
            caution: verdict.caution_text(),
            note: &verdict.note,
            reasons,
            is_primary,
        }
    }

    /// Draws the line:
    ///
    /// 1. reserve the right end for the link to the reasons;
    /// 2. draw the recommended step at the left, then the alternatives that leave room for the
    ///    caution in its short form;
    /// 3. draw the caution, or without one the note, in the rest;
    /// 4. draw the link to the reasons.
    fn ui(&self, ui: &mut Ui, line: Rect, palette: &Palette, commands: &mut Vec<Command>) {
        let mut left = line.left();
        let mut right = line.right();
        let mut reasons_place = line;
        // Step 1.
        if let Some(step) = &self.reasons {
            reasons_place.min.x = right - text_width(ui, &step.label, body());
            right = reasons_place.left() - GAP;
        }
        // Step 2.
        if let Some(step) = self.recommended {
            let width = text_width(ui, &step.label, medium(BODY_SIZE)) + 24.0;
            let place = Rect::from_min_size(pos2(left, line.top()), vec2(width, STEPS));
            self.recommended_ui(ui, place, step, palette, commands);
            left = place.right() + GAP;
        }
        // An alternative that leaves no room for the caution is omitted: the reasons sheet and the
        // command palette offer it too.
        let needed = match self.caution {
            Some(caution) => text_width(ui, &short_caution(caution), body()),
            None => 0.0,
        };
        for step in &self.alternatives {
            let width = text_width(ui, &step.label, body());
            if left + width + needed > right {
                break;
            }
            let place = Rect::from_min_size(pos2(left, line.top()), vec2(width, STEPS));
            link_ui(ui, place, step, palette, commands);
            left = place.right() + GAP;
        }
        // Step 3.
        let rest = line.with_min_x(left).with_max_x(right);
        if let Some(caution) = self.caution {
            caution_ui(ui, rest, caution, palette);
        } else if !self.note.is_empty() {
            note_ui(ui, rest, self.note, palette);
        }
        // Step 4.
        // Drawn last, so that the keyboard reaches the recommended step first.
        if let Some(step) = &self.reasons {
            link_ui(ui, reasons_place, step, palette, commands);
        }
    }

    /// Draws the recommended step, filled with the accent if it is the primary button.
    fn recommended_ui(
        &self,
        ui: &mut Ui,
        place: Rect,
        step: &Step,
        palette: &Palette,
        commands: &mut Vec<Command>,
    ) {
        let label = RichText::new(&step.label).font(medium(BODY_SIZE));
        let button = if self.is_primary {
            Button::new(label.color(palette.on_accent())).fill(palette.accent)
        } else {
            Button::new(label)
        };
        // The identifier does not depend on the step, so that the next step inherits the focus.
        let builder = UiBuilder::new().id_salt("primary").max_rect(place);
        ui.scope_builder(builder, |ui| {
            ui.put(place, button.min_size(place.size()))
                .asks(step.command.clone(), commands);
        });
    }
}

/// Returns a caution without the words before its colon, such as "⚠ +21 dB above 12 rad/s".
fn short_caution(caution: &str) -> String {
    let short = match caution.split_once(": ") {
        Some((_, short)) => short,
        None => caution,
    };
    format!("⚠ {short}")
}

/// Draws the first text that fits: "⚠ Leads: +21 dB above 12 rad/s"; "⚠ +21 dB above 12 rad/s";
/// "⚠ +21 dB"; else the last with its middle elided.
fn caution_ui(ui: &Ui, place: Rect, caution: &str, palette: &Palette) {
    // The tooltip stays beside the whole panel.
    let panel = ui.max_rect();
    let whole = format!("⚠ {caution}");
    let short = short_caution(caution);
    // A number must not lose its middle: the range is omitted as a whole.
    let shortest = match short.split_once(" above ") {
        Some((value, _)) => value.to_owned(),
        None => short.clone(),
    };
    let fitting = [whole, short, shortest.clone()]
        .into_iter()
        .find(|text| text_width(ui, text, body()) <= place.width());
    let shown = match fitting {
        Some(text) => text,
        None => elided(ui, &shortest, place.width(), BODY_SIZE),
    };
    painted_text(ui, place, 0.0, &shown, body(), palette.warning);
    let id = ui.scope_id().with("caution");
    let response = named(ui.interact(place, id, Sense::hover()), Role::Label, caution);
    if !shown.ends_with(caution) {
        hint_left_of(response, panel, caution);
    }
}

/// Draws a note such as "of 19 models, as a first step"; in a narrow panel, only "of 19 models".
fn note_ui(ui: &Ui, place: Rect, note: &str, palette: &Palette) {
    // The tooltip stays beside the whole panel.
    let panel = ui.max_rect();
    let words = leading_parts(ui, note, place.width(), SMALL_SIZE);
    let shown = elided(ui, words, place.width(), SMALL_SIZE);
    painted_text(ui, place, 0.0, &shown, small(), palette.dim_text);
    let id = ui.scope_id().with("note");
    let response = named(ui.interact(place, id, Sense::hover()), Role::Label, note);
    if shown != note {
        hint_left_of(response, panel, note);
    }
}

fn link_ui(ui: &mut Ui, place: Rect, step: &Step, palette: &Palette, commands: &mut Vec<Command>) {
    let label = RichText::new(&step.label).color(palette.accent);
    let builder = UiBuilder::new().id_salt(&step.label).max_rect(place);
    ui.scope_builder(builder, |ui| {
        ui.spacing_mut().button_padding.x = 0.0;
        let button = Button::new(label).frame(false).min_size(place.size());
        ui.put(place, button).asks(step.command.clone(), commands);
    });
}

/// Returns whether the step opens the reasons sheet.
fn shows_reasons(step: &Step) -> bool {
    step.command == Command::Layout(LayoutCommand::ShowSheet(Some(Sheet::Reasons)))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_lines_fit_into_the_reserved_height_in_order() {
        for height in [HEIGHT_WIDE, HEIGHT_NARROW] {
            let area = Rect::from_min_size(pos2(0.0, 0.0), vec2(320.0, height));
            let places = VerdictPlaces::new(area);
            let lines = [places.heads, places.rows[0], places.rows[1], places.steps];
            for pair in lines.windows(2) {
                assert!(pair[0].bottom() <= pair[1].top() + 0.01, "{pair:?}");
            }
            assert!(area.contains_rect(places.heads));
            assert!(area.bottom() - places.steps.bottom() >= 6.0);
            assert_eq!(places.steps.height(), STEPS);
        }
    }

    #[test]
    fn a_short_caution_keeps_its_number() {
        assert_eq!(
            short_caution("Leads: +21 dB above 12 rad/s"),
            "⚠ +21 dB above 12 rad/s"
        );
        assert_eq!(short_caution("No couplings"), "⚠ No couplings");
    }
}
