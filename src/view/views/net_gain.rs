//! Net gains against airspeed, and the form of the schedule.

use egui::containers::menu::{MenuButton, MenuConfig};
use egui::{Panel, PopupCloseBehavior, RichText, Role, ScrollArea, Ui, WidgetInfo};
use gdcm_core::correction::{Channel as CorrectedChannel, ChannelCorrection};
use gdcm_core::dataset::{Channel, ConditionId, FlightState, Pair};
use gdcm_core::study::{Analysis, ConditionAnalysis, Edit, ExplainTarget, setting};
use gdcm_core::uncertainty::Scalar;
use gdcm_core::units::s_to_ms;
use gdcm_files::figure::{Classes, is_scheduled, scheduled_samples};
use serde::{Deserialize, Serialize};

use super::channels::{bar_sentences, brackets, dot_bar, gain_bands};
use super::evidence::{coefficient_table, evidence_table, lead_evidence_table, residual_table};
use crate::view::command::Command;
use crate::view::palette::{Palette, SMALL_SIZE};
use crate::view::plot::{Across, Dot, DotShape, GainEvent, GainPanel, Measure, NamedFigure, NetGainScene, net_gain_ui};
use crate::view::settings_panel::{choice_ui, setting_ui};
use crate::view::state::State;
use crate::view::table_view::{Sorting, TableLook, table_ui};

/// The key of the dots is not narrower \[pt\].
const LEAST_KEY: f32 = 120.0;
/// Room \[pt\] in which the controls of this view stand in one line.
pub const NET_GAIN_CONTROLS: f32 = 760.0;

/// What the plots show, the form of the schedule, and the key of the dots, laid out from right to left; behind a button where they
/// have no room.
pub fn net_gain_header_ui(ui: &mut Ui, state: &State, palette: &Palette, commands: &mut Vec<Command>) {
    if ui.available_width() < NET_GAIN_CONTROLS {
        let config = MenuConfig::new().close_behavior(PopupCloseBehavior::CloseOnClickOutside);
        MenuButton::new("Schedule ▾").config(config).ui(ui, |ui| controls_ui(ui, state, palette, commands));
    } else {
        controls_ui(ui, state, palette, commands);
    }
    // A few letters of the key say nothing.
    if ui.available_width() > LEAST_KEY {
        let key = dot_key(state);
        let text = RichText::new(&key).size(SMALL_SIZE).color(palette.dim_text);
        ui.add(egui::Label::new(text).truncate()).on_hover_text(key);
    }
}

fn controls_ui(ui: &mut Ui, state: &State, palette: &Palette, commands: &mut Vec<Command>) {
    schedule_ui(ui, state, palette, commands);
    ui.label(RichText::new("schedule").size(SMALL_SIZE).color(palette.dim_text));
    let mut shown = state.display.show_evidence;
    let hint =
        "What each form of the schedule misses, residuals and coefficients, so that a degree is chosen on evidence";
    if ui.checkbox(&mut shown, "evidence").on_hover_text(hint).changed() {
        commands.push(Command::ShowEvidence(shown));
    }
    bars_switch_ui(ui, state, "error bars", commands);
    pair_set_ui(ui, state, commands);
}

/// The switch of error bars and bands, by this name.
pub(super) fn bars_switch_ui(ui: &mut Ui, state: &State, name: &str, commands: &mut Vec<Command>) {
    let mut shown = !state.display.hide_bars;
    let level = 100.0 * state.study.settings.uncertainty.level;
    let hint = format!(
        "Bars of {level:.0} %: thick for the physics model chosen (identification), thin with not knowing the trim flown. Bands of the \
         schedule: where it may lie, and where another condition would fall"
    );
    if ui.checkbox(&mut shown, name).on_hover_text(hint).changed() {
        commands.push(Command::ShowBars(shown));
    }
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
    if state.display.show_evidence {
        let width = ui.available_width();
        let panel = Panel::right("evidence").resizable(true).default_size(0.36 * width).min_size(120.0);
        panel.show(ui, |ui| evidence_ui(ui, state, palette, commands));
    }
    let scene = NetGainScene { panels: &panels, message: Some(message) };
    let events = net_gain_ui(ui, &scene, &mut state.display.net_gain, palette);
    commands.extend(events.into_iter().filter_map(|event| gain_command(state, event)));
}

/// What speaks for each form of the schedule; a click on a form takes it.
fn evidence_ui(ui: &mut Ui, state: &mut State, palette: &Palette, commands: &mut Vec<Command>) {
    let mut cached = std::mem::take(&mut state.display.evidence);
    cached.refresh(state);
    let mut sorting = state.display.evidence_sorting;
    let schedule = state.study.settings.schedule;
    ScrollArea::vertical().show(ui, |ui| match cached.found() {
        None => {
            ui.label(RichText::new(state.results.absence()).color(palette.dim_text));
        }
        Some((conditions, evidence)) => {
            let hint = "fit: residuals of the conditions that the schedule is made of; unseen: of each condition under the \
                        schedule that is made without it (root mean square of ln of the net gain)";
            ui.label(RichText::new("Error of each form [% of the net gain]").size(SMALL_SIZE).strong()).on_hover_text(hint);
            let (table, kinds) = evidence_table(state, evidence);
            let look = TableLook { color: &|_, _| None, selected: &|row| kinds.get(row) == Some(&schedule.kind) };
            if let Some(click) = table_ui(ui, &table, &mut sorting, &look, palette, commands)
                && let Some(&kind) = kinds.get(click.row)
            {
                commands.push(setting::SCHEDULE.to(kind).into());
            }
            let plain = TableLook { color: &|_, _| None, selected: &|_| false };
            let leads = lead_evidence_table(state, cached.leads());
            let residuals = residual_table(state, conditions, evidence);
            for table in leads.into_iter().chain(residuals).chain(coefficient_table(state)) {
                ui.label(RichText::new(&table.title).size(SMALL_SIZE).strong());
                table_ui(ui, &table, &mut Sorting::default(), &plain, palette, commands);
            }
        }
    });
    state.display.evidence = cached;
    state.display.evidence_sorting = sorting;
}

/// What a click in a plot over airspeed asks for.
pub(super) fn gain_command(state: &State, event: GainEvent) -> Option<Command> {
    match event {
        GainEvent::ScheduleToggled(condition) => {
            let scheduled = !state.study.choice(condition).scheduled;
            Some(Edit::SetScheduled { condition, scheduled }.into())
        }
        GainEvent::ConditionClicked(condition) => Some(Command::SelectCondition(condition)),
        GainEvent::Asked(figure) => Some(Command::Explain(Some(figure))),
        GainEvent::ConditionHovered(_) => None,
    }
}

/// The form of the schedule. Laid out from right to left.
fn schedule_ui(ui: &mut Ui, state: &State, palette: &Palette, commands: &mut Vec<Command>) {
    let rows = [
        &setting::SCHEDULED_QUANTITY,
        &setting::SCHEDULE,
        &setting::SECOND_VARIABLE,
        &setting::AIRSPEED_TOLERANCE,
        &setting::SCHEDULE_DELAYS,
        &setting::TAU_DEGREE,
    ];
    for setting in rows.into_iter().filter(|setting| (setting.control.applies)(&state.study)) {
        setting_ui(ui, state, setting, palette, commands);
    }
}

/// Which responses the plots of net gain show.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub enum PairSet {
    /// Those held, and those that were held since the window was opened: freeing one does not take its plot away.
    #[default]
    Held,
    /// The response in focus.
    Focused,
    /// The dataset's on-axis responses.
    OnAxis,
    /// Every response.
    All,
    /// Those that the engineer picked.
    Picked,
}

impl PairSet {
    /// Every set, in the order of its list.
    pub const ALL: [Self; 5] = [Self::Held, Self::Focused, Self::OnAxis, Self::All, Self::Picked];

    /// Its name.
    pub fn name(self) -> &'static str {
        match self {
            Self::Held => "held",
            Self::Focused => "in focus",
            Self::OnAxis => "on-axis",
            Self::All => "all",
            Self::Picked => "picked",
        }
    }

    /// What is in it, in a sentence.
    pub fn purpose(self) -> &'static str {
        match self {
            Self::Held => "The responses held, and those held before",
            Self::Focused => "The response chosen in the matrix",
            Self::OnAxis => "The on-axis responses of the dataset",
            Self::All => "Every response that has a gain",
            Self::Picked => "Those picked with the button beside this list",
        }
    }
}

/// The responses of the plots of net gain, in the order of the matrix.
pub fn net_gain_pairs(state: &State) -> Vec<Pair> {
    let (display, constrained) = (&state.display, &state.study.settings.constrained);
    let is_in = |pair: &Pair| match display.net_gain_pairs {
        PairSet::Held => constrained[*pair] || display.once_held.contains(pair),
        PairSet::Focused => display.pair == *pair,
        PairSet::OnAxis => state.dataset().measuring_pairs()[*pair],
        PairSet::All => true,
        PairSet::Picked => display.picked_pairs.contains(pair),
    };
    constrained.pairs().filter(is_in).collect()
}

/// One panel for each response of the set shown: the net gain of each condition's optimum, and the schedule.
pub fn net_gain_panels(state: &State) -> Vec<GainPanel> {
    let Some(analysis) = state.analysis() else {
        return Vec::new();
    };
    let panel = |pair: Pair| {
        let free = if state.study.settings.constrained[pair] { "" } else { " (free)" };
        let figure = Figure {
            title: format!("{}{free}", state.dataset().pair_name(pair)),
            measure: Measure::Gain,
            of: Box::new(move |correction: &ChannelCorrection| correction.net_gain(pair)),
            bounds: None,
            scalar: Scalar::NetGain(pair),
            asked: Box::new(move |id, _| vec![(format!("Net gain, condition {id}"), ExplainTarget::NetGain(id, pair))]),
        };
        figure.panel(state, analysis, Across::Airspeed)
    };
    net_gain_pairs(state).into_iter().map(panel).collect()
}

/// One panel for each input and one for each output: the channel's gain or delay in each condition's optimum, and the schedule.
pub fn channel_panels(state: &State, measure: Measure, across: Across) -> (Vec<GainPanel>, Vec<GainPanel>) {
    let Some(analysis) = state.analysis() else {
        return (Vec::new(), Vec::new());
    };
    let of_input = |index: usize| -> FigureOf {
        match measure {
            Measure::Gain => Box::new(move |correction| correction.input_gains[index]),
            Measure::Delay => Box::new(move |correction| s_to_ms(correction.delay_s(CorrectedChannel::Input(index)))),
        }
    };
    let of_output = |index: usize| -> FigureOf {
        match measure {
            Measure::Gain => Box::new(move |correction| correction.output_gains[index]),
            Measure::Delay => Box::new(move |correction| s_to_ms(correction.delay_s(CorrectedChannel::Output(index)))),
        }
    };
    let panels = |channels: &[Channel], of: &dyn Fn(usize) -> FigureOf, side: fn(usize) -> CorrectedChannel| {
        let figure = |(index, channel): (usize, &Channel)| {
            let bounds: Option<BoundsOf> = Some(Box::new(move |result| match measure {
                Measure::Gain => [result.gain_bounds().lower, result.gain_bounds().upper],
                Measure::Delay => result.delay_bounds_s().map(s_to_ms),
            }));
            let asked = asked_of_channel(measure, side(index));
            let scalar = match measure {
                Measure::Gain => Scalar::ChannelGain(side(index)),
                Measure::Delay => Scalar::ChannelDelay(side(index)),
            };
            let figure = Figure { title: channel.name.clone(), measure, of: of(index), bounds, scalar, asked };
            figure.panel(state, analysis, across)
        };
        channels.iter().enumerate().map(figure).collect()
    };
    (
        panels(state.dataset().inputs(), &of_input, CorrectedChannel::Input),
        panels(state.dataset().outputs(), &of_output, CorrectedChannel::Output),
    )
}

/// What can be asked of a channel in a condition at its airspeed.
fn asked_of_channel(measure: Measure, channel: CorrectedChannel) -> AskedOf {
    Box::new(move |id, airspeed_kt| match measure {
        Measure::Gain => vec![
            ("Gain".to_owned(), ExplainTarget::Gain(id, channel)),
            ("Bounds of the gains".to_owned(), ExplainTarget::GainBounds(id)),
            ("Scheduled gain".to_owned(), ExplainTarget::ScheduledGain(channel, airspeed_kt)),
        ],
        Measure::Delay => vec![
            ("Delay".to_owned(), ExplainTarget::Delay(id, channel)),
            ("Bound of the delays".to_owned(), ExplainTarget::DelayBound(id)),
        ],
    })
}

/// A figure of a correction.
type FigureOf = Box<dyn Fn(&ChannelCorrection) -> f64>;
/// Between which values it was looked for.
type BoundsOf = Box<dyn Fn(&ConditionAnalysis) -> [f64; 2]>;

/// What can be asked about in a condition at an airspeed \[kt\].
type AskedOf = Box<dyn Fn(ConditionId, f64) -> Vec<NamedFigure>>;

/// A figure of every condition's correction, and of the schedule.
struct Figure {
    title: String,
    measure: Measure,
    of: FigureOf,
    bounds: Option<BoundsOf>,
    /// The same, as bars know it.
    scalar: Scalar,
    asked: AskedOf,
}

impl Figure {
    fn panel(self, state: &State, analysis: &Analysis, across: Across) -> GainPanel {
        let classes = Classes::of(state.dataset());
        let uncertainty = state.uncertainty().filter(|_| !state.display.hide_bars).map(|of| of.as_ref());
        let place = |index: usize, flight_state: &FlightState| match across {
            Across::Airspeed => flight_state.airspeed_kt,
            Across::Conditions => index as f64,
        };
        let dots = state.dataset().conditions().iter().enumerate().filter_map(|(index, condition)| {
            let id = condition.id();
            let result = analysis.condition(id)?;
            let flight_state = condition.flight_state();
            Some(Dot {
                condition: id,
                label: id.to_string(),
                x: place(index, flight_state),
                airspeed_kt: flight_state.airspeed_kt,
                value: (self.of)(&result.correction),
                bounds: self.bounds.as_ref().map(|bounds| bounds(result)),
                bar: uncertainty.and_then(|of| dot_bar(of.bar(id, self.scalar)?, self.scalar, of.level)),
                shape: if classes.is_first_altitude(flight_state) { DotShape::Circle } else { DotShape::Diamond },
                filled: classes.is_first_weight(flight_state),
                selected: id == state.condition().id(),
                chosen: analysis.study.choice(id).is_in_schedule(),
                held_out: analysis.study.choice(id).held_out,
                detail: flight_state.name.clone(),
                sentences: uncertainty.map_or_else(Vec::new, |of| bar_sentences(of, self.scalar, id)),
                figures: (self.asked)(id, flight_state.airspeed_kt),
            })
        });
        let schedule = analysis.schedule.as_ref().ok().filter(|schedule| is_scheduled(schedule, self.measure, across));
        let bands = schedule.zip(uncertainty).map(|(schedule, of)| gain_bands(schedule, of, self.scalar, &self.of));
        let schedule = schedule.map(|schedule| scheduled_samples(schedule, &self.of)).unwrap_or_default();
        let dots: Vec<Dot> = dots.collect();
        let brackets = match across {
            Across::Airspeed => uncertainty.map_or_else(Vec::new, |of| brackets(of, self.scalar, &dots)),
            Across::Conditions => Vec::new(),
        };
        let (title, measure, bands) = (self.title, self.measure, bands.unwrap_or_default());
        GainPanel { title, measure, across, dots, schedule, bands, brackets }
    }
}

/// What shapes and fills of the dots mean: "altitude ● low ◆ high · weight filled low, open high", where the dataset has classes; and
/// where numbers are that have no room.
pub fn dot_key(state: &State) -> String {
    let classes = Classes::of(state.dataset());
    let mut words = Vec::new();
    if let Some((first, others)) = classes.altitudes.split_first() {
        let others = if others.is_empty() { String::new() } else { format!(" ◆ {}", others.join(", ")) };
        words.push(format!("altitude ● {first}{others}"));
    }
    if let Some((first, others)) = classes.weights.split_first() {
        let others = if others.is_empty() { String::new() } else { format!(", open {}", others.join(", ")) };
        words.push(format!("weight filled {first}{others}"));
    }
    if state.display.net_gain.leaves_numbers_out() {
        words.push("number without room: point at the dot".to_owned());
    }
    words.join(" · ")
}
