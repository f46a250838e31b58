//! Plots of gains and delays over airspeed, shared by channels and net gains.

use egui::{Ui, Vec2, vec2};

use gdcm_method::uncertainty::{Bar, Scalar};
use gdcm_model::dataset::Pair;
use gdcm_model::units::s_to_ms;
use gdcm_plot::figure::gains::{Across, GainQuantity};
use gdcm_plot::figure::{Figure, MarkId};
use gdcm_study::Edit;
use gdcm_study::results::uncertainty::Uncertainty;
use gdcm_words::derivation::ExplainTarget;
use gdcm_words::uncertainty::bar_remark_texts;

use crate::gui::commands::command::Command;
use crate::gui::commands::display::DisplayCommand;
use crate::gui::commands::selection::SelectionCommand;
use crate::gui::plot::questions::NamedFigure;
use crate::gui::plot::{FigureEvent, FigureScene, FigureWords};
use crate::gui::state::pair_set::PairSet;
use crate::gui::state::window_state::State;
use crate::gui::widgets::choices::toggle_ui;

/// Minimum plot size \[pt\].
pub const LEAST_PLOT: Vec2 = vec2(122.0, 120.0);

/// Returns the uncertainty of gains and delays; `None` if error bars are hidden or not available.
pub fn shown_uncertainty(state: &State) -> Option<&Uncertainty> {
    if state.display.gains.hide_bars {
        None
    } else {
        state.uncertainty().map(AsRef::as_ref)
    }
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
    /// Returns the scene, with marks at the displayed condition and at the condition under the
    /// pointer.
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
        let plot = &self.figure.plots[plot];
        let dots: usize = plot.panels.iter().map(|panel| panel.dots().count()).sum();
        format!("{}, {dots} conditions", plot.title)
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
        let quantity = self.quantities[plot];
        let measure = quantity.measure();
        let airspeed_kt = condition.flight_state().airspeed_kt;
        let title = &self.figure.plots[plot].title;
        let mut words = vec![
            format!("condition {id}, {airspeed_kt:.0} kt"),
            format!("{title} {}", measure.text(value)),
        ];
        if let Some(uncertainty) = shown_uncertainty(self.state)
            && let Some(bar) = uncertainty.bar(*id, quantity.scalar())
        {
            words.push(bar_words(bar, quantity.scalar(), uncertainty.level));
        }
        if let Some(schedule) = measure.schedule_of(analysis, self.across) {
            let scheduled = quantity.of(&schedule.at(airspeed_kt));
            words.push(format!("scheduled {}", measure.text(scheduled)));
        }
        if let Some(result) = analysis.condition(*id)
            && let Some([lower, upper]) = quantity.bounds(result)
        {
            words.push(format!(
                "bounds {} to {}",
                measure.text(lower),
                measure.text(upper)
            ));
        }
        let choice = analysis.study.choice(*id);
        if choice.held_out {
            words.push("held out to validate the schedule".to_owned());
        } else if !choice.is_in_schedule() {
            words.push("not in the schedule".to_owned());
        }
        words.push(
            "Ctrl+click: add to or remove from the schedule; right-click: explain".to_owned(),
        );
        Some(words.join(" · "))
    }

    fn questions(&self, plot: usize, id: &MarkId) -> Vec<NamedFigure> {
        let MarkId::Condition(id) = *id else {
            return Vec::new();
        };
        match self.quantities[plot] {
            GainQuantity::NetGain(pair) => vec![(
                format!("Net gain, condition {id}"),
                ExplainTarget::NetGain(id, pair),
            )],
            GainQuantity::Delay(channel) => vec![
                ("Delay".to_owned(), ExplainTarget::Delay(id, channel)),
                (
                    "Bound of the delays".to_owned(),
                    ExplainTarget::DelayBound(id),
                ),
            ],
            GainQuantity::Gain(channel) => {
                let mut questions = vec![
                    ("Gain".to_owned(), ExplainTarget::Gain(id, channel)),
                    (
                        "Bounds of the gains".to_owned(),
                        ExplainTarget::GainBounds(id),
                    ),
                ];
                if let Some(condition) = self.state.dataset().condition(id) {
                    let airspeed_kt = condition.flight_state().airspeed_kt;
                    let target = ExplainTarget::ScheduledGain(channel, airspeed_kt);
                    questions.push(("Scheduled gain".to_owned(), target));
                }
                questions
            }
        }
    }
}

/// Returns the command for an event in a plot over airspeed.
pub fn gain_command(state: &State, event: FigureEvent) -> Option<Command> {
    match event {
        FigureEvent::Clicked(_, MarkId::Condition(condition), keys) => {
            if keys.command {
                let scheduled = !state.study.choice(condition).scheduled;
                let edit = Edit::SetScheduled {
                    condition,
                    scheduled,
                };
                Some(edit.into())
            } else {
                Some(SelectionCommand::SelectCondition(condition).into())
            }
        }
        FigureEvent::Asked(figure) => Some(SelectionCommand::Explain(Some(figure)).into()),
        FigureEvent::Told(words) => Some(SelectionCommand::Tell(words).into()),
        FigureEvent::Pointed(MarkId::Condition(condition)) => {
            Some(SelectionCommand::HoverCondition(condition).into())
        }
        FigureEvent::Clicked(..) | FigureEvent::Pointed(_) => None,
    }
}

/// Describes an error bar: "± 3.3 % (90 %): trim 78 %, identification 22 % of the variance".
pub fn bar_words(bar: &Bar, scalar: Scalar, level: f64) -> String {
    let remarks = bar_remark_texts(bar).join(", ");
    let Some(half) = bar.half_width(level) else {
        return format!("no error bar: {remarks}");
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
        words.push_str(&format!("; undefined in {} substitutions", bar.left_out));
    }
    words
}

/// Draws the switch that shows error bars and bands.
pub fn bars_switch_ui(ui: &mut Ui, state: &State, name: &str, commands: &mut Vec<Command>) {
    let shown = !state.display.gains.hide_bars;
    let level = 100.0 * state.study.settings.uncertainty.level;
    let hint = format!(
        "{level:.0} % error bars. Thick: uncertainty of the identification, for the chosen \
        physics model. Thin: with the unknown trim of the flight. Bands: confidence of the \
        schedule, and prediction for another condition"
    );
    if toggle_ui(ui, ("bars", name), shown, &hint) {
        commands.push(DisplayCommand::ShowBars(!shown).into());
    }
}

/// Returns the responses in the net-gain plots, in matrix order.
pub fn net_gain_pairs(state: &State) -> Vec<Pair> {
    let display = &state.display;
    let constrained = &state.study.settings.constrained;
    let mut pairs = Vec::new();
    for pair in constrained.pairs() {
        let is_shown = match display.gains.net_gain_pairs {
            PairSet::Held => constrained[pair] || display.gains.once_held.contains(&pair),
            PairSet::Focused => display.selection.pair == pair,
            PairSet::OnAxis => state.dataset().measuring_pairs()[pair],
            PairSet::All => true,
            PairSet::Picked => display.gains.picked_pairs.contains(&pair),
        };
        if is_shown {
            pairs.push(pair);
        }
    }
    pairs
}
