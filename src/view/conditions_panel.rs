//! The list of flight conditions.

use egui::{RichText, Ui};

use crate::dataset::{Condition, ConditionId, FlightState};
use crate::study::{Analysis, ConditionAnalysis};

use super::command::Command;
use super::heading::heading_ui;
use super::palette::{BODY_SIZE, Palette, SMALL_SIZE};
use super::region::{Region, region_ui};
use super::row::{row_text, row_ui};
use super::state::State;

/// Every condition with speed, altitude, weight and its marks; a click shows it.
pub fn conditions_ui(ui: &mut Ui, state: &State, palette: &Palette, commands: &mut Vec<Command>) {
    region_ui(ui, Region::Conditions, |ui| list_ui(ui, state, palette, commands));
}

fn list_ui(ui: &mut Ui, state: &State, palette: &Palette, commands: &mut Vec<Command>) {
    let conditions = state.dataset().conditions();
    let older = if state.others_are_older() { " · marks of older settings" } else { "" };
    heading_ui(ui, palette, "Conditions", &format!("{}{older}", conditions.len()));
    for condition in conditions {
        let id = condition.id();
        let selected = id == state.condition().id();
        let marks = Marks::of(state.analysis(), id);
        let name = format!("Condition {id}: {}", in_words(condition.flight_state()));
        let (row, response) = row_ui(ui, palette, selected, false, &name);
        paint_flight_state(ui, row, condition, palette, state.study.choice(id).scheduled);
        marks.paint(ui, row, palette);
        if response.clicked() {
            commands.push(Command::SelectCondition(id));
        }
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

fn paint_flight_state(ui: &Ui, row: egui::Rect, condition: &Condition, palette: &Palette, scheduled: bool) {
    let state = condition.flight_state();
    let color = if scheduled { palette.text } else { palette.dim_text };
    let altitude = state.altitude.clone().or_else(|| state.altitude_ft.map(|feet| format!("{feet} ft")));
    let weight = state.weight.clone().or_else(|| state.mass_kg.map(|mass| format!("{mass} kg")));
    row_text(ui, row, 6.0, &condition.id().to_string(), BODY_SIZE, color);
    row_text(ui, row, 30.0, &format!("{} kt", state.airspeed_kt), BODY_SIZE, color);
    row_text(ui, row, 80.0, altitude.as_deref().unwrap_or("–"), BODY_SIZE, color);
    row_text(ui, row, 118.0, weight.as_deref().unwrap_or("–"), BODY_SIZE, color);
}

/// What the list says about a condition's result.
struct Marks {
    suggested: usize,
    unmatched_gains: usize,
    unmatched_delays: usize,
    failure: Option<String>,
}

impl Marks {
    fn of(analysis: Option<&Analysis>, condition: ConditionId) -> Self {
        let none = Self { suggested: 0, unmatched_gains: 0, unmatched_delays: 0, failure: None };
        match analysis.and_then(|analysis| analysis.conditions.get(&condition)) {
            None => none,
            Some(Err(failure)) => Self { failure: Some(failure.to_string()), ..none },
            Some(Ok(condition)) => Self::of_result(condition),
        }
    }

    fn of_result(condition: &ConditionAnalysis) -> Self {
        Self {
            suggested: condition.suggested().len(),
            unmatched_gains: condition.gains.unmatched.len(),
            unmatched_delays: condition.delays.unmatched.len(),
            failure: None,
        }
    }

    fn paint(&self, ui: &Ui, row: egui::Rect, palette: &Palette) {
        let mut right = -6.0;
        let mut mark = |count: usize, symbol: &str, emphasised: bool| {
            if count > 0 {
                let color = if emphasised { palette.warning } else { palette.dim_text };
                let place = row_text(ui, row, right, &format!("{symbol} {count}"), SMALL_SIZE, color);
                right = place.left() - row.right() - 8.0;
            }
        };
        mark(self.unmatched_delays, "τ", false);
        mark(self.unmatched_gains, "k", true);
        mark(self.suggested, "⚠", true);
        if self.failure.is_some() {
            row_text(ui, row, -6.0, "⚠ no result", SMALL_SIZE, palette.warning);
        }
    }

    fn sentences(&self) -> Vec<String> {
        let mut sentences = Vec::new();
        let mut say = |count: usize, text: String| {
            if count > 0 {
                sentences.push(text);
            }
        };
        say(self.suggested, format!("⚠ {}: physics models suggested as outliers", self.suggested));
        say(self.unmatched_gains, format!("k {}: held gains that could not be matched", self.unmatched_gains));
        say(self.unmatched_delays, format!("τ {}: held delays that could not be matched", self.unmatched_delays));
        sentences.extend(self.failure.clone());
        sentences
    }
}

fn tooltip_ui(ui: &mut Ui, condition: &Condition, marks: &Marks) {
    let state = condition.flight_state();
    ui.label(RichText::new(&state.name).strong());
    let mut figures = vec![format!("{} kt true airspeed", state.airspeed_kt)];
    figures.extend(state.altitude_ft.map(|feet| format!("{feet} ft")));
    figures.extend(state.mass_kg.map(|mass| format!("{mass} kg")));
    ui.label(figures.join(" · "));
    for sentence in marks.sentences() {
        ui.label(sentence);
    }
}
