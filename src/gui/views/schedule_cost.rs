//! Dock page about the schedule for the response in focus: net gain over airspeed, and J before the
//! correction, at each optimum and under the schedule.

use egui::{Ui, vec2};

use gdcm_model::dataset::ConditionId;
use gdcm_plot::figure::Figure;
use gdcm_plot::figure::gains::{GainQuantity, add_previous, quieten};
use gdcm_plot::figure::marks::MarkId;
use gdcm_plot::figure::schedule_cost::schedule_cost_figure;

use super::error_bars::{dim_older_bars, painted_uncertainty};
use super::gain_plots::gain_command;
use crate::gui::commands::command::Command;
use crate::gui::plot::{FigureScene, FigureWords, figure_ui};
use crate::gui::state::view::View;
use crate::gui::state::window_state::State;
use crate::gui::widgets::palette::Palette;

/// Draws net gain and J over airspeed for the response in focus; a click selects a condition.
pub(super) fn schedule_cost_view_ui(
    ui: &mut Ui,
    state: &mut State,
    palette: &Palette,
    commands: &mut Vec<Command>,
) {
    let mut view = state
        .display
        .figures
        .remove(&View::ScheduleCost)
        .unwrap_or_default();
    let pair = state.display.selection.pair;
    let mut figure = Figure::default();
    if let Some(analysis) = state.analysis()
        && let Some(found) = schedule_cost_figure(analysis, painted_uncertainty(state), pair)
    {
        figure = found;
        dim_older_bars(state, &mut figure);
        if let Some(previous) = state.previous_analysis() {
            add_previous(&mut figure, &[GainQuantity::NetGain(pair)], previous);
        }
        let selected = MarkId::Condition(state.condition().id());
        quieten(&mut figure, &selected, false);
        figure = figure.with_ranges();
    }
    let message = match state.analysis() {
        Some(_) => "The response cannot be compared",
        None => state.results.absence(),
    };
    let words = CostWords { state };
    let scene = FigureScene {
        selected: Some(MarkId::Condition(state.condition().id())),
        highlighted: state
            .display
            .selection
            .hovered_condition
            .map(MarkId::Condition),
        ..FigureScene::new(
            "schedule cost",
            &figure,
            vec2(160.0, 100.0),
            message,
            &words,
        )
    };
    view.set_subject(&state.dataset().pair_name(pair));
    for event in figure_ui(ui, &scene, &mut view, palette) {
        commands.extend(gain_command(state, event));
    }
    state.display.figures.insert(View::ScheduleCost, view);
}

/// Returns the page's context: "LON → Q, schedule against the optimum of each condition".
pub(super) fn schedule_cost_words(state: &State) -> String {
    let name = state.dataset().pair_name(state.display.selection.pair);
    format!("{name}, schedule against the optimum of each condition")
}

/// Names for plots and descriptions for dots.
struct CostWords<'a> {
    state: &'a State,
}

impl CostWords<'_> {
    /// Describes a condition: "condition 10, 60 kt".
    fn condition(&self, id: ConditionId) -> Option<String> {
        let condition = self.state.dataset().condition(id)?;
        let airspeed_kt = condition.flight_state().airspeed_kt;
        Some(format!("condition {id}, {airspeed_kt:.0} kt"))
    }
}

impl FigureWords for CostWords<'_> {
    fn plot_name(&self, plot: usize) -> String {
        let name = self
            .state
            .dataset()
            .pair_name(self.state.display.selection.pair);
        match plot {
            0 => format!("Net gain and schedule of {name}"),
            _ => format!("J of {name} with the schedule"),
        }
    }

    /// Describes a dot: the net gain, or J before the correction, at the optimum and under the
    /// schedule.
    fn status_text(&self, plot: usize, id: &MarkId, [_, value]: [f64; 2]) -> Option<String> {
        let MarkId::Condition(id) = *id else {
            return None;
        };
        let condition = self.condition(id)?;
        if plot == 0 {
            return Some(format!("{condition} · net gain {value:.3}"));
        }
        let pair = self.state.display.selection.pair;
        let costs = self.state.analysis()?.response_costs(pair);
        let cost = costs.iter().find(|cost| cost.condition == id)?;
        let scheduled = match cost.scheduled {
            Some(cost) => format!("{:.1}", cost.total()),
            None => "–".to_owned(),
        };
        Some(format!(
            "{condition} · J before {:.1} · optimum {:.1} · schedule {scheduled}",
            cost.before.total(),
            cost.optimum.total()
        ))
    }
}
