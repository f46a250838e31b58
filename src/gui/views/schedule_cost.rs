//! Schedule-cost view of the response in focus, with two plots over airspeed: the net gain with the
//! schedule; and J before the correction, at each condition's optimum and under the schedule.
//!
//! J is the cost of the difference between a model's response and the identified one (M4:
//! docs/method.md). The *optimum* is a condition's own correction; the schedule over airspeed is
//! fitted to the optima.

use egui::{Ui, vec2};

use gdcm_model::dataset::{ConditionId, Pair};
use gdcm_plot::figure::Figure;
use gdcm_plot::figure::gains::GainQuantity;
use gdcm_plot::figure::gains_on_screen::{add_previous, label_selected_only};
use gdcm_plot::figure::marks::MarkId;
use gdcm_plot::figure::schedule_cost::schedule_cost_figure;

use super::error_bars::{dim_older_bars, painted_uncertainty};
use super::gain_plots::gain_command;
use super::model_error::error_message;
use crate::gui::commands::command::Command;
use crate::gui::plot::{FigureScene, FigureWords, figure_ui};
use crate::gui::state::view::View;
use crate::gui::state::window_state::State;
use crate::gui::widgets::palette::Palette;

/// Index of the net-gain plot; the other plot shows J.
const NET_GAIN_PLOT: usize = 0;
/// Whether significant differences are marked: not here, only in the net-gain view.
const SHOWS_DIFFERENCES: bool = false;

/// Draws net gain and J over airspeed for the response in focus; a click selects a condition.
pub(super) fn schedule_cost_view_ui(
    ui: &mut Ui,
    state: &mut State,
    palette: &Palette,
    commands: &mut Vec<Command>,
) {
    let pair = state.display.selection.pair;
    let figure = cost_figure(state, pair);
    let message = match state.analysis() {
        Some(_) => error_message(state, pair),
        None => state.results.absence().to_owned(),
    };
    // The scene borrows the state: take the view out while the figure is drawn.
    let mut view = state
        .display
        .figures
        .remove(&View::ScheduleCost)
        .unwrap_or_default();
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
            &message,
            &words,
        )
    };
    view.fit_if_subject_changed(&state.dataset().pair_name(pair));
    for event in figure_ui(ui, &scene, &mut view, palette) {
        commands.extend(gain_command(state, event));
    }
    state.display.figures.insert(View::ScheduleCost, view);
}

/// Builds the figure; empty without an analysis, or if the response cannot be compared in any
/// condition.
///
/// 1. Plots of the net gain, with error bars if they are shown, and of J.
/// 2. Dims error bars from earlier settings.
/// 3. Adds the previous analysis in grey, behind the net gains only: J has no previous marks.
/// 4. Rings the dot of the displayed condition, and removes the other labels and all brackets.
/// 5. Stores the axis ranges, which must include the marks added before.
fn cost_figure(state: &State, pair: Pair) -> Figure {
    let Some(analysis) = state.analysis() else {
        return Figure::default();
    };
    // Step 1.
    let uncertainty = painted_uncertainty(state);
    let Some(mut figure) = schedule_cost_figure(analysis, uncertainty, pair) else {
        return Figure::default();
    };
    // Step 2.
    dim_older_bars(state, &mut figure);
    // Step 3.
    if let Some(previous) = state.previous_analysis() {
        add_previous(&mut figure, &[GainQuantity::NetGain(pair)], previous);
    }
    // Step 4.
    let selected = MarkId::Condition(state.condition().id());
    label_selected_only(&mut figure, &selected, SHOWS_DIFFERENCES);
    // Step 5.
    figure.with_ranges()
}

/// Returns the text beside the title: "LON → Q, schedule against the optimum of each condition".
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
            NET_GAIN_PLOT => format!("Net gain and schedule of {name}"),
            _ => format!("J of {name} with the schedule"),
        }
    }

    /// Describes a dot: in the plot of the net gain its value; in the plot of J, whichever of its
    /// dots is pointed at, J before the correction, at the optimum and under the schedule.
    fn status_text(&self, plot: usize, id: &MarkId, [_, value]: [f64; 2]) -> Option<String> {
        let MarkId::Condition(id) = *id else {
            return None;
        };
        let condition = self.condition(id)?;
        if plot == NET_GAIN_PLOT {
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
