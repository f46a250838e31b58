//! Interaction with gain and delay plots: names for plots and dots, status text, derivations, and
//! commands.
//!
//! `channels` and `net_gain` build the figures and draw them; each dot is a quantity's value in a
//! condition: a channel's gain or delay, or a response's net gain, which is its output's gain times
//! its input's gain.

use egui::{Vec2, vec2};

use gdcm_model::dataset::ConditionId;
use gdcm_model::number_format::counted;
use gdcm_plot::figure::Figure;
use gdcm_plot::figure::gains::{Across, GainQuantity};
use gdcm_plot::figure::marks::MarkId;
use gdcm_study::{Analysis, Edit};
use gdcm_words::derivation::ExplainTarget;

use super::error_bars::{error_bar_words, shown_uncertainty};
use crate::gui::commands::command::Command;
use crate::gui::commands::selection::SelectionCommand;
use crate::gui::plot::derivation_menu::Question;
use crate::gui::plot::{FigureEvent, FigureScene, FigureWords};
use crate::gui::state::window_state::State;

/// Minimum plot size \[pt\].
pub const LEAST_PLOT: Vec2 = vec2(100.0, 84.0);

/// Gain or delay plots, with their quantities.
pub struct GainPlots<'a> {
    pub state: &'a State,
    /// Plots with a single panel each.
    pub figure: Figure,
    /// Quantity on each plot's vertical axis.
    pub quantities: Vec<GainQuantity>,
    /// Quantity on every plot's horizontal axis.
    pub across: Across,
}

impl GainPlots<'_> {
    /// Returns the scene with all plots or a sequence of them, with marks at the displayed
    /// condition and at the condition under the pointer.
    ///
    /// `figure` contains the plots in `self.figure` from the index `first_plot` on.
    pub fn scene<'b>(
        &'b self,
        name: &'static str,
        figure: &'b Figure,
        first_plot: usize,
        message: &'b str,
    ) -> FigureScene<'b> {
        let hovered = self.state.display.selection.hovered_condition;
        FigureScene {
            selected: Some(MarkId::Condition(self.state.condition().id())),
            highlighted: hovered.map(MarkId::Condition),
            first_plot,
            ..FigureScene::new(name, figure, LEAST_PLOT, message, self)
        }
    }

    fn airspeed_kt(&self, condition: ConditionId) -> Option<f64> {
        let condition = self.state.dataset().condition(condition)?;
        Some(condition.flight_state().airspeed_kt)
    }
}

impl FigureWords for GainPlots<'_> {
    fn plot_name(&self, plot: usize) -> String {
        let plot = &self.figure.plots[plot];
        let dots: usize = plot.panels.iter().map(|panel| panel.dots().count()).sum();
        format!("{}, {}", plot.title, counted(dots, "condition"))
    }

    fn dot_name(&self, plot: usize, id: &MarkId, [_, value]: [f64; 2]) -> Option<String> {
        let MarkId::Condition(id) = id else {
            return None;
        };
        let airspeed_kt = self.airspeed_kt(*id)?;
        let value = self.quantities[plot].measure().text(value);
        let title = &self.figure.plots[plot].title;
        Some(format!(
            "{title}, condition {id}: {value} at {airspeed_kt:.0} kt"
        ))
    }

    /// Describes a dot: condition, value, error bar, scheduled value, bounds, use in the schedule,
    /// and the effect of clicks.
    fn status_text(&self, plot: usize, id: &MarkId, [_, value]: [f64; 2]) -> Option<String> {
        let MarkId::Condition(id) = id else {
            return None;
        };
        let dot = PointedDot {
            state: self.state,
            analysis: self.state.analysis()?,
            condition: *id,
            airspeed_kt: self.airspeed_kt(*id)?,
            quantity: self.quantities[plot],
        };
        let title = &self.figure.plots[plot].title;
        let mut words = vec![
            format!("condition {id}, {:.0} kt", dot.airspeed_kt),
            format!("{title} {}", dot.quantity.measure().text(value)),
        ];
        words.extend(dot.error_bar_words());
        words.extend(dot.scheduled_words(self.across));
        words.extend(dot.bounds_words());
        words.extend(dot.schedule_use().map(str::to_owned));
        words.push(
            "Ctrl+click: add to or remove from the schedule; right-click: explain".to_owned(),
        );
        Some(words.join(" · "))
    }

    fn questions(&self, plot: usize, id: &MarkId) -> Vec<Question> {
        let MarkId::Condition(id) = *id else {
            return Vec::new();
        };
        match self.quantities[plot] {
            GainQuantity::NetGain(pair) => vec![Question::new(
                format!("Net gain, condition {id}"),
                ExplainTarget::NetGain(id, pair),
            )],
            GainQuantity::Delay(channel) => vec![
                Question::new("Delay", ExplainTarget::Delay(id, channel)),
                Question::new("Bound of the delays", ExplainTarget::DelayBound(id)),
            ],
            GainQuantity::Gain(channel) => {
                let mut questions = vec![
                    Question::new("Gain", ExplainTarget::Gain(id, channel)),
                    Question::new("Bounds of the gains", ExplainTarget::GainBounds(id)),
                ];
                if let Some(airspeed_kt) = self.airspeed_kt(id) {
                    let target = ExplainTarget::ScheduledGain(channel, airspeed_kt);
                    questions.push(Question::new("Scheduled gain", target));
                }
                questions
            }
        }
    }
}

/// Dot under the pointer: a quantity in a condition.
struct PointedDot<'a> {
    state: &'a State,
    analysis: &'a Analysis,
    condition: ConditionId,
    airspeed_kt: f64,
    quantity: GainQuantity,
}

impl PointedDot<'_> {
    /// Describes the error bar; `None` if error bars are hidden or not available.
    fn error_bar_words(&self) -> Option<String> {
        let uncertainty = shown_uncertainty(self.state)?;
        let scalar = self.quantity.scalar();
        let bar = uncertainty.bar(self.condition, scalar)?;
        Some(error_bar_words(bar, scalar, uncertainty.level))
    }

    /// Returns the scheduled value; `None` if no schedule is drawn.
    fn scheduled_words(&self, across: Across) -> Option<String> {
        let measure = self.quantity.measure();
        let schedule = measure.schedule_of(self.analysis, across)?;
        let scheduled = self.quantity.value_in(&schedule.at(self.airspeed_kt));
        Some(format!("scheduled {}", measure.text(scheduled)))
    }

    /// Returns the search bounds; `None` for net gains, which have no bounds, or if the condition
    /// has no result.
    fn bounds_words(&self) -> Option<String> {
        let measure = self.quantity.measure();
        let result = self.analysis.condition(self.condition)?;
        let [lower, upper] = self.quantity.bounds(result)?;
        Some(format!(
            "bounds {} to {}",
            measure.text(lower),
            measure.text(upper)
        ))
    }

    /// Describes how the condition is used unless the schedule is fitted to it.
    fn schedule_use(&self) -> Option<&'static str> {
        let choice = self.analysis.study.choice(self.condition);
        if choice.held_out {
            Some("held out to validate the schedule")
        } else if !choice.is_in_schedule() {
            Some("not in the schedule")
        } else {
            None
        }
    }
}

/// Returns the command for an event in a gain or delay plot: a click on a dot selects its
/// condition, with Ctrl it adds the condition to the schedule or removes it.
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
        FigureEvent::ExplanationRequested(target) => {
            Some(SelectionCommand::Explain(Some(target)).into())
        }
        FigureEvent::StatusText(words) => Some(SelectionCommand::ShowStatus(words).into()),
        FigureEvent::Pointed(MarkId::Condition(condition)) => {
            Some(SelectionCommand::HoverCondition(condition).into())
        }
        FigureEvent::Clicked(..) | FigureEvent::Pointed(_) => None,
    }
}
