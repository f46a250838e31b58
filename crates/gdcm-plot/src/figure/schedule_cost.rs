//! Cost of the schedule in a response: the net gain over airspeed, and J before the correction, at
//! each condition's optimum and under the schedule.
//!
//! J is a response's cost, from its differences to the identified reference in magnitude and phase
//! (M4). A condition's *optimum* is its own correction, to which the schedule over airspeed is
//! fitted.

use gdcm_method::fidelity::Cost;
use gdcm_model::dataset::Pair;
use gdcm_study::results::analysis::Analysis;
use gdcm_study::results::response_costs::ResponseCosts;
use gdcm_study::results::uncertainty::Uncertainty;

use super::axis::Axis;
use super::caption_words::{settings_words, used_schedule_words};
use super::drawing::{Color, Hue, Stroke};
use super::figure::{Figure, Panel, Plot};
use super::gain_panel::GainPanel;
use super::gain_quantity::{Across, GainQuantity};
use super::marks::{Dot, DotShape, Dots, Intervals, Mark, MarkId};
use super::role::Role;

/// Line from J before the correction to J under the schedule.
const CHANGE: Stroke = Stroke::solid(Color::DIM, 0.6);
/// Colour for J before the correction.
const BEFORE: Color = Color::DIM;
/// Colour for J at a condition's own optimum.
const OPTIMUM: Color = Color::new(Hue::Corrected);
/// Distance between conditions at the same airspeed, as a share of the airspeed range.
const APART: f64 = 0.034;
/// Minimum airspeed range that the axis shows \[kt\].
const LEAST_RANGE_KT: f64 = 10.0;
/// Size of the marks at J before the correction, relative to the usual dot.
const BEFORE_SIZE: f64 = 0.55;
/// Ratio of plot height to width.
const ASPECT: f64 = 0.62;

/// Plots a response's net gain and J over airspeed; the dots for net gains and for J under the
/// schedule are coloured by airspeed. `None` if the response cannot be compared in any condition.
pub fn schedule_cost_figure(
    analysis: &Analysis,
    uncertainty: Option<&Uncertainty>,
    pair: Pair,
) -> Option<Figure> {
    let costs = analysis.response_costs(pair);
    if costs.is_empty() {
        return None;
    }
    let study = &analysis.study;
    let gains = GainPanel {
        quantity: GainQuantity::NetGain(pair),
        analysis,
        uncertainty,
        across: Across::Airspeed,
    };
    let mut gain_panel = gains.panel("Net gain [-]");
    color_by_airspeed(&mut gain_panel, analysis);
    let mut caption = settings_words(&study.dataset, &study.settings);
    if analysis.schedule.is_ok() {
        let schedule = used_schedule_words(analysis);
        caption.push_str(&format!(" Schedule: {schedule}."));
    }
    let figure = Figure::new(format!(
        "{} · cost of the schedule",
        study.dataset.pair_name(pair)
    ))
    .caption(caption)
    .columns(2)
    .aspect(ASPECT)
    .plots([
        Plot::new("Net gain k").panel(gain_panel),
        Plot::new("J").panel(cost_panel(analysis, &costs)),
    ]);
    Some(figure)
}

/// Splits a panel's dots into groups coloured by airspeed; shape and filling stay.
fn color_by_airspeed(panel: &mut Panel, analysis: &Analysis) {
    let range_kt = analysis.study.dataset.airspeed_range_kt();
    let mut marks = Vec::new();
    for mark in std::mem::take(&mut panel.marks) {
        let Mark::Dots(group) = mark else {
            marks.push(mark);
            continue;
        };
        for dot in &group.dots {
            let step = Role::airspeed_step(dot.x, range_kt);
            marks.push(Mark::Dots(Dots {
                color: Color::new(Hue::OfAirspeed(step)),
                dots: vec![dot.clone()],
                ..group.clone()
            }));
        }
    }
    panel.marks = marks;
}

/// Builds the panel for J: in each condition a line from J before the correction to J under the
/// schedule, and J at the optimum.
fn cost_panel(analysis: &Analysis, costs: &[ResponseCosts]) -> Panel {
    let range_kt = analysis.study.dataset.airspeed_range_kt();
    let mut changes = Vec::new();
    let mut before = Dots {
        size: BEFORE_SIZE,
        ..Dots::new("before", DotShape::Square, BEFORE).key("before")
    };
    let mut optimum = Dots::new("optimum", DotShape::Circle, OPTIMUM)
        .filled(false)
        .key("optimum");
    let mut scheduled = Vec::new();
    for (cost, x) in costs.iter().zip(places(costs, range_kt)) {
        before.dots.push(cost_dot(cost, x, cost.before));
        optimum.dots.push(cost_dot(cost, x, cost.optimum));
        if let Some(found) = cost.scheduled {
            changes.push([x, found.total(), cost.before.total()]);
            let step = Role::airspeed_step(cost.airspeed_kt, range_kt);
            let color = Color::new(Hue::OfAirspeed(step));
            let mut dots = Dots::new("schedule", DotShape::Circle, color).key("schedule");
            dots.dots.push(Dot {
                label: cost.condition.to_string(),
                ..cost_dot(cost, x, found)
            });
            scheduled.push(dots);
        }
    }
    let mut panel = Panel::new(
        Axis::linear("Airspeed [kt]").at_least(LEAST_RANGE_KT),
        Axis::linear("J [-]").including(0.0).at_least(5.0),
    );
    if !changes.is_empty() {
        panel = panel.with(Intervals {
            name: "change due to the schedule".to_owned(),
            stroke: CHANGE,
            ends: changes,
        });
    }
    panel.with(before).with(optimum).with_all(scheduled)
}

/// Returns a dot without a label at a condition's J.
fn cost_dot(costs: &ResponseCosts, x: f64, cost: Cost) -> Dot {
    Dot {
        x,
        y: cost.total(),
        label: String::new(),
        id: Some(MarkId::Condition(costs.condition)),
    }
}

/// Returns each condition's horizontal place \[kt\]: its airspeed, with conditions at the same
/// airspeed beside one another.
fn places(costs: &[ResponseCosts], range_kt: (f64, f64)) -> Vec<f64> {
    let apart_kt = APART * (range_kt.1 - range_kt.0).max(LEAST_RANGE_KT);
    let mut places = Vec::new();
    for (index, cost) in costs.iter().enumerate() {
        // The conditions at an airspeed lie symmetrically about it, in the order of the list.
        let before = count_at(&costs[..index], cost.airspeed_kt);
        let count = count_at(costs, cost.airspeed_kt);
        places.push(cost.airspeed_kt + apart_kt * (before - 0.5 * (count - 1.0)));
    }
    places
}

/// Counts the conditions at an airspeed.
fn count_at(costs: &[ResponseCosts], airspeed_kt: f64) -> f64 {
    let same = costs.iter().filter(|cost| cost.airspeed_kt == airspeed_kt);
    same.count() as f64
}

#[cfg(test)]
mod tests {
    use gdcm_model::dataset::ConditionId;

    use super::*;

    #[test]
    fn conditions_at_one_airspeed_stand_beside_one_another() {
        let cost = Cost {
            magnitude: 0.0,
            phase: 0.0,
        };
        let costs = [60.0, 90.0, 60.0].map(|airspeed_kt| ResponseCosts {
            condition: ConditionId(1),
            airspeed_kt,
            before: cost,
            optimum: cost,
            scheduled: None,
        });
        let found = places(&costs, (60.0, 160.0));
        // 3.4 % of 100 kt apart, about their airspeed.
        for (place, expected) in found.into_iter().zip([58.3, 90.0, 61.7]) {
            assert!((place - expected).abs() < 1e-9, "{place}");
        }
    }
}
