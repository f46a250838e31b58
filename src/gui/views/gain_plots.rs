//! Plots of gains and delays over airspeed, shared by the channels and the net gains.

use egui::{Ui, Vec2, vec2};

use gdcm_method::uncertainty::{Bar, Scalar};
use gdcm_model::dataset::Pair;
use gdcm_model::units::s_to_ms;
use gdcm_plot::figure::gains::{Across, GainQuantity};
use gdcm_plot::figure::{Figure, MarkId};
use gdcm_study::Edit;
use gdcm_study::results::uncertainty::Uncertainty;
use gdcm_words::derivation::ExplainTarget;

use crate::gui::commands::command::Command;
use crate::gui::commands::display::DisplayCommand;
use crate::gui::commands::selection::SelectionCommand;
use crate::gui::plot::questions::NamedFigure;
use crate::gui::plot::{FigureEvent, FigureScene, FigureWords};
use crate::gui::state::pair_set::PairSet;
use crate::gui::state::window_state::State;
use crate::gui::widgets::choices::toggle_ui;

/// Least size of a plot \[pt\].
pub const LEAST_PLOT: Vec2 = vec2(122.0, 120.0);

/// Returns the uncertainty of gains and delays, if error bars are shown.
pub fn shown_uncertainty(state: &State) -> Option<&Uncertainty> {
    state
        .uncertainty()
        .filter(|_| !state.display.gains.hide_bars)
        .map(AsRef::as_ref)
}

/// Plots of gains or delays, with their subjects.
pub struct GainPlots<'a> {
    pub state: &'a State,
    /// Plots with a single panel each.
    pub figure: Figure,
    pub quantities: Vec<GainQuantity>,
    pub across: Across,
}

impl GainPlots<'_> {
    pub fn scene<'b>(
        &'b self,
        name: &'static str,
        figure: &'b Figure,
        message: &'b str,
    ) -> FigureScene<'b> {
        FigureScene {
            selected: Some(MarkId::Condition(self.state.condition().id())),
            highlighted: self
                .state
                .display
                .selection
                .hovered_condition
                .map(MarkId::Condition),
            ..FigureScene::new(name, figure, LEAST_PLOT, message, self)
        }
    }
}

impl FigureWords for GainPlots<'_> {
    fn plot(&self, plot: usize) -> String {
        let of = &self.figure.plots[plot];
        let dots: usize = of.panels.iter().map(|panel| panel.dots().count()).sum();
        format!("{}, {dots} conditions", of.title)
    }

    fn dot(&self, plot: usize, id: &MarkId, [_, value]: [f64; 2]) -> Option<String> {
        let MarkId::Condition(id) = id else {
            return None;
        };
        let airspeed_kt = self
            .state
            .dataset()
            .condition(*id)?
            .flight_state()
            .airspeed_kt;
        let value = self.quantities[plot].measure().text(value);
        Some(format!(
            "{}, condition {id}: {value} at {airspeed_kt:.0} kt",
            self.figure.plots[plot].title
        ))
    }

    fn pointed(&self, plot: usize, id: &MarkId, [_, value]: [f64; 2]) -> Option<String> {
        let MarkId::Condition(id) = id else {
            return None;
        };
        let condition = self.state.dataset().condition(*id)?;
        let analysis = self.state.analysis()?;
        let of = self.quantities[plot];
        let airspeed_kt = condition.flight_state().airspeed_kt;
        let text = |value: f64| of.measure().text(value);
        let schedule = of.measure().schedule_of(analysis, self.across);
        let scheduled = schedule
            .map(|schedule| format!("scheduled {}", text(of.of(&schedule.at(airspeed_kt)))));
        let bounds = analysis.condition(*id).and_then(|result| of.bounds(result));
        let choice = analysis.study.choice(*id);
        let state = match (choice.held_out, choice.is_in_schedule()) {
            (true, _) => Some("held out of the schedule, to judge it".to_owned()),
            (false, false) => Some("not in the schedule".to_owned()),
            (false, true) => None,
        };
        let uncertainty = shown_uncertainty(self.state);
        let bar =
            uncertainty.and_then(|of_all| Some((of_all.bar(*id, of.scalar())?, of_all.level)));
        let words = [
            Some(format!("condition {id}, {airspeed_kt:.0} kt")),
            Some(format!("{} {}", self.figure.plots[plot].title, text(value))),
            bar.map(|(bar, level)| bar_words(bar, of.scalar(), level)),
            scheduled,
            bounds.map(|[lower, upper]| format!("bounds {} to {}", text(lower), text(upper))),
            state,
            Some("Ctrl+click: into the schedule, or out of it; right-click: explain".to_owned()),
        ];
        Some(words.into_iter().flatten().collect::<Vec<_>>().join(" · "))
    }

    fn questions(&self, plot: usize, id: &MarkId) -> Vec<NamedFigure> {
        let MarkId::Condition(id) = *id else {
            return Vec::new();
        };
        match self.quantities[plot] {
            GainQuantity::NetGain(pair) => {
                vec![(
                    format!("Net gain, condition {id}"),
                    ExplainTarget::NetGain(id, pair),
                )]
            }
            GainQuantity::Delay(channel) => vec![
                ("Delay".to_owned(), ExplainTarget::Delay(id, channel)),
                (
                    "Bound of the delays".to_owned(),
                    ExplainTarget::DelayBound(id),
                ),
            ],
            GainQuantity::Gain(channel) => {
                let airspeed_kt = self
                    .state
                    .dataset()
                    .condition(id)
                    .map(|of| of.flight_state().airspeed_kt);
                let gain = [
                    ("Gain".to_owned(), ExplainTarget::Gain(id, channel)),
                    (
                        "Bounds of the gains".to_owned(),
                        ExplainTarget::GainBounds(id),
                    ),
                ];
                let scheduled = airspeed_kt.map(|at| {
                    (
                        "Scheduled gain".to_owned(),
                        ExplainTarget::ScheduledGain(channel, at),
                    )
                });
                gain.into_iter().chain(scheduled).collect()
            }
        }
    }
}

/// Returns the command of a click in a plot over airspeed.
pub fn gain_command(state: &State, event: FigureEvent) -> Option<Command> {
    match event {
        FigureEvent::Clicked(_, MarkId::Condition(condition), keys) if keys.command => {
            let scheduled = !state.study.choice(condition).scheduled;
            Some(
                Edit::SetScheduled {
                    condition,
                    scheduled,
                }
                .into(),
            )
        }
        FigureEvent::Clicked(_, MarkId::Condition(condition), _) => Some(Command::Selection(
            SelectionCommand::SelectCondition(condition),
        )),
        FigureEvent::Asked(figure) => {
            Some(Command::Selection(SelectionCommand::Explain(Some(figure))))
        }
        FigureEvent::Told(words) => Some(Command::Selection(SelectionCommand::Tell(words))),
        FigureEvent::Pointed(MarkId::Condition(condition)) => Some(Command::Selection(
            SelectionCommand::HoverCondition(condition),
        )),
        FigureEvent::Clicked(..) | FigureEvent::Pointed(_) => None,
    }
}

/// Describes an error bar: "± 3.3 % (90 %): trim 78 %, identification 22 % of the variance".
pub fn bar_words(bar: &Bar, scalar: Scalar, level: f64) -> String {
    let remarks = bar.remarks().join(", ");
    let Some(half) = bar.half_width(level) else {
        return format!("no bar: {remarks}");
    };
    let half = if scalar.is_delay() {
        format!("± {:.1} ms", s_to_ms(half))
    } else {
        format!("± {:.1} %", 100.0 * half)
    };
    let trim = 100.0 * bar.trim_share().unwrap_or_default();
    let mut words = format!(
        "{half} ({:.0} %): trim {trim:.0} %, identification {:.0} % of the variance",
        100.0 * level,
        100.0 - trim
    );
    if !remarks.is_empty() {
        words.push_str(&format!("; {remarks}"));
    }
    if bar.left_out > 0 {
        words.push_str(&format!("; {} swaps without this figure", bar.left_out));
    }
    words
}

/// Draws the switch of error bars and bands.
pub fn bars_switch_ui(
    ui: &mut Ui,
    state: &State,
    names: (&str, &str),
    commands: &mut Vec<Command>,
) {
    let shown = !state.display.gains.hide_bars;
    let level = 100.0 * state.study.settings.uncertainty.level;
    let hint = format!(
        "Bars of {level:.0} %: thick for the physics model chosen (identification), thin with not knowing the trim flown. Bands of the \
         schedule: where it may lie, and where another condition would fall"
    );
    if toggle_ui(ui, names, shown, &hint) {
        commands.push(DisplayCommand::ShowBars(!shown).into());
    }
}

/// Returns the responses of the net-gain plots, in the order of the matrix.
pub fn net_gain_pairs(state: &State) -> Vec<Pair> {
    let display = &state.display;
    let constrained = &state.study.settings.constrained;
    let is_in = |pair: &Pair| match display.gains.net_gain_pairs {
        PairSet::Held => constrained[*pair] || display.gains.once_held.contains(pair),
        PairSet::Focused => display.selection.pair == *pair,
        PairSet::OnAxis => state.dataset().measuring_pairs()[*pair],
        PairSet::All => true,
        PairSet::Picked => display.gains.picked_pairs.contains(pair),
    };
    constrained.pairs().filter(is_in).collect()
}
