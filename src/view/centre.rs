//! The plots: the focused response above, net gain below, each one of several tabs.

use egui::{Align, Button, DragValue, Layout, Panel, RichText, Role, Ui, WidgetInfo};

use crate::dataset::{Band, Pair};
use crate::schedule::{ScheduleKind, ScheduleSettings, ScheduledQuantity};
use crate::study::{Edit, Setting};

use super::assessment_scene::assessment_panels;
use super::bode_scene::bode_curves;
use super::command::Command;
use super::explanation::channel_names;
use super::net_gain_scene::{channel_panels, dot_key, net_gain_panels};
use super::palette::{Palette, SMALL_SIZE};
use super::plot::{
    AssessmentEvent, AssessmentScene, BodeCurve, BodeEvent, BodeScene, ChannelsScene, CurveId, GainEvent, NetGainScene,
    OverviewCell, OverviewEvent, OverviewScene, assessment_ui, bode_ui, channels_ui, net_gain_ui, overview_ui,
};
use super::region::{Region, region_ui};
use super::settings_panel::choice_ui;
use super::state::{State, Tab};

const TABS: [(&str, Tab); 4] =
    [("Bode", Tab::Bode), ("Overview", Tab::Overview), ("Channels", Tab::Channels), ("Assessment", Tab::Assessment)];

/// Everything between the side panels.
pub fn centre_ui(ui: &mut Ui, state: &mut State, palette: &Palette, commands: &mut Vec<Command>) {
    region_ui(ui, Region::Plots, |ui| plots_ui(ui, state, palette, commands));
}

fn plots_ui(ui: &mut Ui, state: &mut State, palette: &Palette, commands: &mut Vec<Command>) {
    let height = ui.available_height();
    let lower = egui::Frame::new().inner_margin(egui::Margin { top: 4, ..egui::Margin::ZERO });
    Panel::bottom("net gain").frame(lower).resizable(true).default_size(0.34 * height).min_size(150.0).show(ui, |ui| {
        net_gain_header_ui(ui, state, palette, commands);
        net_gain_tab_ui(ui, state, palette, commands);
    });
    header_ui(ui, state, palette, commands);
    match state.display.tab {
        Tab::Bode => bode_tab_ui(ui, state, palette, commands),
        Tab::Overview => overview_tab_ui(ui, state, palette, commands),
        Tab::Channels => channels_tab_ui(ui, state, palette, commands),
        Tab::Assessment => assessment_tab_ui(ui, state, palette, commands),
    }
}

fn tab_ui<T: PartialEq>(ui: &mut Ui, palette: &Palette, text: &str, tab: T, shown: &T) -> Option<T> {
    let selected = tab == *shown;
    let color = if selected { palette.text } else { palette.dim_text };
    let response = ui.add(Button::selectable(selected, RichText::new(text).color(color)));
    response.clicked().then_some(tab)
}

fn header_ui(ui: &mut Ui, state: &State, palette: &Palette, commands: &mut Vec<Command>) {
    ui.horizontal(|ui| {
        for (text, tab) in TABS {
            commands.extend(tab_ui(ui, palette, text, tab, &state.display.tab).map(Command::ShowTab));
        }
        ui.with_layout(Layout::right_to_left(Align::Center), |ui| {
            if ui
                .add(Button::new("Fit").small())
                .on_hover_text("Bring every curve into view (F, or double click)")
                .clicked()
            {
                commands.push(Command::FitPlots);
            }
            if matches!(state.display.tab, Tab::Channels | Tab::Assessment) {
                older_ui(ui, state, palette);
            }
            let condition = state.condition();
            let title = format!(
                "{} · condition {} · {}",
                state.dataset().pair_name(state.display.pair),
                condition.id(),
                condition.flight_state().name
            );
            ui.add(egui::Label::new(RichText::new(title).color(palette.dim_text)).truncate());
        });
    });
}

fn bode_tab_ui(ui: &mut Ui, state: &mut State, palette: &Palette, commands: &mut Vec<Command>) {
    let pair = state.display.pair;
    state.display.drawn = bode_curves(state, pair);
    let band = state.study.settings.band;
    let title = state.dataset().pair_name(state.display.pair);
    let stale = state.results.is_stale(ui.input(|input| input.time));
    let message = state.curves_message();
    let scene = BodeScene {
        pair_title: &title,
        curves: &state.display.drawn,
        band: (band.min(), band.max()),
        unit: state.display.unit,
        stale,
        message,
    };
    let events = bode_ui(ui, &scene, &mut state.display.bode, palette);
    for event in events {
        commands.extend(bode_command(state, event));
    }
    if let Some(CurveId::Model(id)) = state.display.bode.hovered() {
        commands.push(Command::Hover(id.clone()));
    }
}

fn bode_command(state: &State, event: BodeEvent) -> Option<Command> {
    let is_rejected = |id| state.study.is_rejected(id);
    match event {
        BodeEvent::Clicked(CurveId::Model(id)) => {
            Some(if is_rejected(&id) { Edit::Restore(id) } else { Edit::Reject(id) }.into())
        }
        BodeEvent::TakenBack(CurveId::Model(id)) => {
            Some(Command::Forget(if is_rejected(&id) { Edit::Reject(id) } else { Edit::Restore(id) }))
        }
        BodeEvent::Isolated(CurveId::Model(id)) => Some(Command::Isolate(id)),
        BodeEvent::Hovered(_) | BodeEvent::Clicked(_) | BodeEvent::TakenBack(_) | BodeEvent::Isolated(_) => None,
        BodeEvent::BandDragged { min, max } => {
            Band::new(min, max).ok().map(|band| Edit::Set(Setting::Band(band)).into())
        }
        BodeEvent::BandReleased => Some(Command::EndEdit),
    }
}

fn net_gain_header_ui(ui: &mut Ui, state: &State, palette: &Palette, commands: &mut Vec<Command>) {
    ui.horizontal(|ui| {
        ui.label(RichText::new("Net gain").strong());
        older_ui(ui, state, palette);
        ui.with_layout(Layout::right_to_left(Align::Center), |ui| {
            let small = |text: String| RichText::new(text).size(SMALL_SIZE).color(palette.dim_text);
            commands.extend(schedule_ui(ui, state.study.settings.schedule));
            ui.label(small("schedule".to_owned()));
            ui.add(egui::Label::new(small(dot_key(state))).truncate());
        });
    });
}

/// Says that what stands beside is of older settings than the result of the condition shown.
fn older_ui(ui: &mut Ui, state: &State, palette: &Palette) {
    if state.others_are_older() {
        let text = RichText::new("of older settings").size(SMALL_SIZE).color(palette.warning);
        ui.label(text).on_hover_text("The condition shown is computed anew already; the others are on their way");
    }
}

/// The form of the schedule; the edit where it was changed. Laid out from right to left.
fn schedule_ui(ui: &mut Ui, settings: ScheduleSettings) -> Option<Command> {
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
    let tolerance = DragValue::new(&mut chosen.airspeed_tolerance_kt).range(0.0..=100.0).speed(0.1).suffix(" kt");
    let tolerance = ui.add(tolerance);
    tolerance.widget_info(|| WidgetInfo::labeled(Role::SpinButton, true, "Airspeed tolerance"));
    tolerance.on_hover_text("Airspeeds this close to the next one [kt] count as one, for the table and for the degree");
    (chosen != settings).then(|| Edit::Set(Setting::Schedule(chosen)).into())
}

fn net_gain_tab_ui(ui: &mut Ui, state: &mut State, palette: &Palette, commands: &mut Vec<Command>) {
    let panels = net_gain_panels(state);
    let message = if state.analysis().is_none() {
        state.results.absence()
    } else {
        "No response is held: hold one in the matrix"
    };
    let scene = NetGainScene { panels: &panels, message: Some(message) };
    let events = net_gain_ui(ui, &scene, &mut state.display.net_gain, palette);
    commands.extend(events.into_iter().filter_map(gain_command));
}

fn channels_tab_ui(ui: &mut Ui, state: &mut State, palette: &Palette, commands: &mut Vec<Command>) {
    let (inputs, outputs) = channel_panels(state);
    let scene = ChannelsScene { inputs: &inputs, outputs: &outputs, message: Some(state.results.absence()) };
    let events = channels_ui(ui, &scene, &mut state.display.channels, palette);
    commands.extend(events.into_iter().filter_map(gain_command));
}

fn overview_tab_ui(ui: &mut Ui, state: &mut State, palette: &Palette, commands: &mut Vec<Command>) {
    let pairs: Vec<Pair> = state.dataset().on_axis().pairs().collect();
    let curves: Vec<Vec<BodeCurve>> = pairs.iter().map(|&pair| bode_curves(state, pair)).collect();
    let cells: Vec<OverviewCell<'_>> = pairs
        .iter()
        .zip(&curves)
        .map(|(&pair, curves)| OverviewCell {
            pair,
            curves,
            constrained: state.study.settings.constrained[pair],
            selected: pair == state.display.pair,
            note: cost_note(state, pair),
        })
        .collect();
    let (inputs, outputs) = channel_names(state);
    let band = state.study.settings.band;
    let scene = OverviewScene {
        inputs: &inputs,
        outputs: &outputs,
        cells: &cells,
        band: (band.min(), band.max()),
        message: Some(state.results.absence()),
    };
    for OverviewEvent::PairClicked(pair) in overview_ui(ui, &scene, &mut state.display.overview, palette) {
        commands.push(Command::FocusPair(pair));
        commands.push(Command::ShowTab(Tab::Bode));
    }
}

/// "J 75→61".
fn cost_note(state: &State, pair: Pair) -> String {
    let cost = state.shown().and_then(|shown| shown.cost[pair]);
    cost.map_or(String::new(), |cost| format!("J {:.0}→{:.0}", cost.uncorrected.total(), cost.corrected.total()))
}

fn assessment_tab_ui(ui: &mut Ui, state: &mut State, palette: &Palette, commands: &mut Vec<Command>) {
    let (pairs, panels) = assessment_panels(state);
    let scene = AssessmentScene { panels: &panels, message: Some(state.results.absence()) };
    let events = assessment_ui(ui, &scene, &mut state.display.assessment, palette);
    for AssessmentEvent::BarClicked { panel, condition } in events {
        commands.push(Command::SelectCondition(condition));
        commands.extend(pairs.get(panel).map(|&pair| Command::FocusPair(pair)));
    }
}

fn gain_command(event: GainEvent) -> Option<Command> {
    match event {
        GainEvent::ConditionClicked(condition) => Some(Command::SelectCondition(condition)),
        GainEvent::ConditionHovered(_) => None,
    }
}
