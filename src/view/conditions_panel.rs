//! The list of flight conditions.

use egui::{Color32, Rect, RichText, Sense, Ui, vec2};

use gdcm_core::correction::Unmatched;
use gdcm_core::dataset::{Condition, ConditionId, FlightState};
use gdcm_core::study::Edit;

use super::{
    BODY_SIZE, Command, Palette, Region, Room, SMALL_SIZE, State, TableKind, entries_ui, region_ui, row_text,
    row_text_within, row_ui, table_heading_ui,
};

/// Every condition with speed, altitude, weight and its marks; a click shows it.
pub fn conditions_ui(ui: &mut Ui, state: &State, palette: &Palette, commands: &mut Vec<Command>) {
    region_ui(ui, Region::Conditions, |ui| list_ui(ui, state, palette, commands));
}

fn list_ui(ui: &mut Ui, state: &State, palette: &Palette, commands: &mut Vec<Command>) {
    let conditions = state.dataset().conditions();
    let older = if state.others_are_older() { " · marks of older settings" } else { "" };
    let count = format!("{}{older}", conditions.len());
    table_heading_ui(ui, palette, ("Conditions", &count), TableKind::Conditions, commands);
    column_headings_ui(ui, palette);
    for condition in conditions {
        let id = condition.id();
        let selected = id == state.condition().id();
        let marks = Marks::of(state, id);
        let name = format!("Condition {id}: {}{}", in_words(condition.flight_state()), marks.after_name());
        let (row, response) = row_ui(ui, palette, selected, false, &name);
        let marked_from = marks.paint(ui, row, palette);
        paint_flight_state(
            ui,
            row,
            marked_from,
            condition,
            if marks.left_out { palette.dim_text } else { palette.text },
        );
        if response.clicked() {
            commands.push(Command::SelectCondition(id));
        }
        response.context_menu(|ui| menu_ui(ui, id, &marks, commands));
        response.on_hover_ui(|ui| tooltip_ui(ui, condition, &marks));
    }
}

/// "60 kt, low altitude, high weight".
fn in_words(state: &FlightState) -> String {
    let mut words = format!("{} kt", state.airspeed_kt);
    if let Some(altitude) = &state.altitude {
        words.push_str(&format!(", {altitude} altitude"));
    }
    if let Some(weight) = &state.weight {
        words.push_str(&format!(", {weight} weight"));
    }
    words
}

/// Between a text of one column and the next column \[pt\].
const COLUMN_GAP: f32 = 4.0;
const SPEED: Room = Room { left: 30.0, right: 80.0 - COLUMN_GAP };
const ALTITUDE: Room = Room { left: 80.0, right: 128.0 - COLUMN_GAP };
const WEIGHT: Room = Room { left: 128.0, right: f32::INFINITY };

fn column_headings_ui(ui: &mut Ui, palette: &Palette) {
    let (row, _) = ui.allocate_exact_size(vec2(ui.available_width(), 15.0), Sense::hover());
    for (room, text) in [(SPEED, "speed"), (ALTITUDE, "altitude"), (WEIGHT, "weight")] {
        let room = Room { right: room.right.min(row.width()), ..room };
        row_text_within(ui, row, room, text, SMALL_SIZE, palette.dim_text);
    }
}

/// Speed, altitude and weight, as far as the marks leave room, which begin at `marked_from` \[pt from the row's left edge\].
fn paint_flight_state(ui: &Ui, row: Rect, marked_from: f32, condition: &Condition, color: Color32) {
    let state = condition.flight_state();
    let altitude = state.altitude.clone().or_else(|| state.altitude_ft.map(|feet| format!("{feet} ft")));
    let weight = state.weight.clone().or_else(|| state.mass_kg.map(|mass| format!("{mass} kg")));
    row_text(ui, row, 6.0, &condition.id().to_string(), BODY_SIZE, color);
    let columns = [
        (SPEED, format!("{} kt", state.airspeed_kt)),
        (ALTITUDE, altitude.unwrap_or_else(|| "–".to_owned())),
        (WEIGHT, weight.unwrap_or_else(|| "–".to_owned())),
    ];
    for (room, text) in columns {
        let room = Room { right: room.right.min(marked_from - COLUMN_GAP), ..room };
        row_text_within(ui, row, room, &text, BODY_SIZE, color);
    }
}

fn menu_ui(ui: &mut Ui, condition: ConditionId, marks: &Marks, commands: &mut Vec<Command>) {
    let hold_out = if marks.held_out { "No longer hold out" } else { "Hold out, to judge the schedule" };
    let schedule = if marks.left_out { "Include in the schedule" } else { "Leave out of the schedule" };
    let entries = [
        (hold_out, Edit::SetHeldOut { condition, held_out: !marks.held_out }),
        (schedule, Edit::SetScheduled { condition, scheduled: marks.left_out }),
    ];
    entries_ui(ui, entries.map(|(text, edit)| (format!("{text}: condition {condition}"), edit.into())), commands);
}

/// What the list says about a condition: what is still to do there.
struct Marks {
    /// Models that are suggested as outliers and not rejected.
    suggested: usize,
    /// Held gains that are not matched.
    unmatched_gains: usize,
    /// Held delays that are not matched, though a decision could match them: not those that need lead where leads are not asked for.
    unmatched_delays: usize,
    left_out: bool,
    held_out: bool,
    failure: Option<String>,
}

impl Marks {
    fn of(state: &State, condition: ConditionId) -> Self {
        let choice = state.study.choice(condition);
        let mut marks = Self {
            suggested: 0,
            unmatched_gains: 0,
            unmatched_delays: 0,
            left_out: !choice.scheduled,
            held_out: choice.held_out,
            failure: None,
        };
        match state.analysis().and_then(|analysis| analysis.conditions.get(&condition)) {
            None => {}
            Some(Err(failure)) => marks.failure = Some(failure.to_string()),
            Some(Ok(result)) => {
                marks.suggested = state.open_suggestions(result).len();
                marks.unmatched_gains = result.gains.unmatched.len();
                let is_open = |missed: &&Unmatched| result.compensated.is_some() || missed.delta >= 0.0;
                marks.unmatched_delays = result.delays.unmatched.iter().filter(is_open).count();
            }
        }
        marks
    }

    /// What the accessible name of the row says after the flight state.
    fn after_name(&self) -> &'static str {
        match (self.held_out, self.left_out) {
            (true, _) => ", held out",
            (false, true) => ", left out of the schedule",
            (false, false) => "",
        }
    }

    /// Paints the marks from the right; returns where they begin \[pt from the row's left edge\].
    fn paint(&self, ui: &Ui, row: Rect, palette: &Palette) -> f32 {
        let mut right = -6.0;
        let mut mark = |text: String, color: Color32| {
            let place = row_text(ui, row, right, &text, SMALL_SIZE, color);
            right = place.left() - row.right() - 8.0;
        };
        if self.failure.is_some() {
            mark("⚠ no result".to_owned(), palette.warning);
        }
        for (count, symbol) in [(self.unmatched_delays, "τ"), (self.unmatched_gains, "k"), (self.suggested, "⚠")] {
            if count > 0 {
                mark(format!("{symbol} {count}"), palette.warning);
            }
        }
        if self.held_out {
            mark("held out".to_owned(), palette.accent);
        } else if self.left_out {
            mark("left out".to_owned(), palette.dim_text);
        }
        row.width() + right + 8.0
    }

    fn sentences(&self) -> Vec<String> {
        let counted = [
            ("⚠", self.suggested, "physics models suggested as outliers, not rejected"),
            ("k", self.unmatched_gains, "held gains that could not be matched"),
            ("τ", self.unmatched_delays, "held delays that could not be matched, besides those that need lead"),
        ];
        let counted = counted.into_iter().filter(|(_, count, _)| *count > 0);
        let counted = counted.map(|(symbol, count, words)| format!("{symbol} {count}: {words}"));
        let held_out = "Held out: analysed, and the schedule is judged by it; right-click ends that";
        let left_out = "Left out of the schedule; right-click includes it";
        let states = [(self.held_out, held_out), (self.left_out, left_out)];
        let states = states.into_iter().filter(|(is_so, _)| *is_so).map(|(_, words)| words.to_owned());
        counted.chain(states).chain(self.failure.clone()).collect()
    }
}

fn tooltip_ui(ui: &mut Ui, condition: &Condition, marks: &Marks) {
    let state = condition.flight_state();
    ui.label(RichText::new(&state.name).strong());
    let mut values = vec![format!("{} kt true airspeed", state.airspeed_kt)];
    values.extend(state.altitude_ft.map(|feet| format!("{feet} ft")));
    values.extend(state.mass_kg.map(|mass| format!("{mass} kg")));
    ui.label(values.join(" · "));
    for sentence in marks.sentences() {
        ui.label(sentence);
    }
}
