//! Net gains against airspeed, and the form of the schedule.

use egui::{RichText, Role, Ui, WidgetInfo};

use crate::schedule::{ScheduleKind, ScheduleSettings, ScheduledQuantity};
use crate::study::{Edit, Setting};
use crate::view::command::Command;
use crate::view::net_gain_scene::{PairSet, dot_key, net_gain_panels};
use crate::view::number_field::NumberField;
use crate::view::palette::{Palette, SMALL_SIZE};
use crate::view::plot::{GainEvent, NetGainScene, net_gain_ui};
use crate::view::settings_panel::choice_ui;
use crate::view::state::State;

/// Widest airspeed tolerance \[kt\].
const WIDEST_TOLERANCE_KT: f64 = 100.0;

/// The form of the schedule and the key of the dots, laid out from right to left.
pub fn net_gain_header_ui(ui: &mut Ui, state: &State, palette: &Palette, commands: &mut Vec<Command>) {
    let small = |text: String| RichText::new(text).size(SMALL_SIZE).color(palette.dim_text);
    schedule_ui(ui, state.study.settings.schedule, commands);
    ui.label(small("schedule".to_owned()));
    pair_set_ui(ui, state, commands);
    let key = dot_key(state);
    ui.add(egui::Label::new(small(key.clone())).truncate()).on_hover_text(key);
}

/// Which responses are shown. Laid out from right to left.
fn pair_set_ui(ui: &mut Ui, state: &State, commands: &mut Vec<Command>) {
    let pair = state.display.pair;
    if state.display.net_gain_pairs == PairSet::Picked {
        let picked = state.display.picked_pairs.contains(&pair);
        let (text, verb) = if picked { ("−", "Let go") } else { ("+", "Pick") };
        let name = format!("{verb} {}", state.dataset().pair_name(pair));
        let button = ui.small_button(text);
        button.widget_info(|| WidgetInfo::labeled(Role::Button, true, &name));
        if button.on_hover_text(format!("{name}, the response in focus")).clicked() {
            commands.push(Command::PickPair(pair));
        }
    }
    let mut chosen = state.display.net_gain_pairs;
    let sets = PairSet::ALL.map(|set| (set, set.name(), set.purpose()));
    choice_ui(ui, "Responses of the net-gain plots", &mut chosen, &sets);
    if chosen != state.display.net_gain_pairs {
        commands.push(Command::ShowNetGains(chosen));
    }
}

/// Net gain of the responses chosen against airspeed.
pub fn net_gain_view_ui(ui: &mut Ui, state: &mut State, palette: &Palette, commands: &mut Vec<Command>) {
    let panels = net_gain_panels(state);
    let message = if state.analysis().is_none() {
        state.results.absence()
    } else {
        match state.display.net_gain_pairs {
            PairSet::Picked => "No response is picked: choose one in the matrix, then + above",
            _ => "No response is held: hold one in the matrix",
        }
    };
    let scene = NetGainScene { panels: &panels, message: Some(message) };
    let events = net_gain_ui(ui, &scene, &mut state.display.net_gain, palette);
    commands.extend(events.into_iter().filter_map(|event| gain_command(state, event)));
}

/// What a click in a plot over airspeed asks for.
pub(super) fn gain_command(state: &State, event: GainEvent) -> Option<Command> {
    match event {
        GainEvent::ScheduleToggled(condition) => {
            let scheduled = !state.study.choice(condition).scheduled;
            Some(Edit::SetScheduled { condition, scheduled }.into())
        }
        GainEvent::ConditionClicked(condition) => Some(Command::SelectCondition(condition)),
        GainEvent::ConditionHovered(_) => None,
    }
}

/// The form of the schedule. Laid out from right to left.
fn schedule_ui(ui: &mut Ui, settings: ScheduleSettings, commands: &mut Vec<Command>) {
    let mut chosen = settings;
    choice_ui(
        ui,
        "Scheduled quantity",
        &mut chosen.quantity,
        &[
            (ScheduledQuantity::LnGain, "of ln k", "The product of regressions is the regression of the product"),
            (ScheduledQuantity::Gain, "of k", "Regresses the gain itself"),
        ],
    );
    let polynomial = |degree| ScheduleKind::Polynomial { degree };
    choice_ui(
        ui,
        "Schedule",
        &mut chosen.kind,
        &[
            (polynomial(0), "constant", "Polynomial of degree 0 in airspeed"),
            (polynomial(1), "degree 1", "Polynomial of degree 1 in airspeed"),
            (polynomial(2), "degree 2", "Polynomial of degree 2 in airspeed"),
            (polynomial(3), "degree 3", "Polynomial of degree 3 in airspeed"),
            (ScheduleKind::Table, "table", "Mean of each cluster of airspeeds, linear between"),
        ],
    );
    let tolerance = NumberField {
        name: "Airspeed tolerance",
        hint: "Airspeeds this close to the next one [kt] count as one, for the table and for the degree",
        unit: "kt",
        shows_unit: true,
        range: 0.0..=WIDEST_TOLERANCE_KT,
        is_whole: false,
        step: 0.1,
        width: 0.0,
        text: |airspeed_kt| format!("{airspeed_kt:.1}"),
    };
    let entered = tolerance.ui(ui, chosen.airspeed_tolerance_kt);
    chosen.airspeed_tolerance_kt = entered.value.unwrap_or(chosen.airspeed_tolerance_kt);
    if chosen != settings {
        commands.push(Edit::Set(Setting::Schedule(chosen)).into());
    }
    commands.extend(entered.refusal.map(Command::Refuse));
    if entered.is_ended {
        commands.push(Command::EndEdit);
    }
}
