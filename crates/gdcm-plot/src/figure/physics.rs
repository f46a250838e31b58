//! Named physics parameters: a parameter's value in each condition over airspeed, and the misfit
//! that remains as parameters are added (M18.3, M18.4).
//!
//! A parameter's change is `z` times its plausible standard deviation. The *misfit* in conditions
//! left out is the weighted squared deviation that remains in each condition when parameters and
//! delays come from the other conditions, and only the gains from the condition itself (M18.4).

use gdcm_method::physics::OfferedParameter;
use gdcm_method::physics::diagnosis::{ConditionDiagnosis, ParameterDiagnosis};
use gdcm_method::physics::score::Scores;
use gdcm_method::physics::verdict::LEAST_GAIN;
use gdcm_method::uncertainty::student_quantile;
use gdcm_model::dataset::{Condition, Dataset};
use gdcm_study::results::physics_findings::PhysicsFindings;

use super::axis::{Axis, Range};
use super::condition_classes::Classes;
use super::drawing::{Color, Dash, Hue, Stroke};
use super::figure::{Figure, Panel, Plot};
use super::marks::{Curve, Dot, DotShape, Dots, Envelope, Intervals, MarkId, Rule, Strip};

/// Line at the value found for all conditions together.
const JOINT: Stroke = Stroke::solid(Color::new(Hue::Perturbed), 1.4);
/// Interval about the value found for all conditions together.
const JOINT_INTERVAL: Color = Color::new(Hue::Perturbed).tint(22);
/// One plausible standard deviation on both sides of the nominal value.
const PLAUSIBLE: Color = Color::DIM.tint(12);
/// Line at the parameter's nominal value.
const NOMINAL: Stroke = Stroke::dashed(Color::DIM, 0.8, Dash::Short);
/// Error bar about a value from a single condition.
const BAR: Stroke = Stroke::solid(Color::new(Hue::Perturbed), 0.7);
/// Line through the misfits in the conditions left out.
const LEFT_OUT: Stroke = Stroke::solid(Color::INK, 1.4);
/// Background at steps that hardly lower the misfit in the conditions left out.
const NO_IMPROVEMENT: Color = Color::DIM.tint(10);
/// Margin beyond the slowest and the fastest condition \[kt\].
const AIRSPEED_MARGIN_KT: f64 = 4.0;
/// Factor that converts a ratio to percent.
const PERCENT: f64 = 100.0;

/// Builds the figure for the parameter at index `shown` among the enabled parameters; `None` if
/// there is no such parameter.
pub fn physics_figure(
    findings: &PhysicsFindings,
    dataset: &Dataset,
    level: f64,
    shown: usize,
) -> Option<Figure> {
    let shown_parameter = ShownParameter {
        index: shown,
        parameter: findings.parameters.get(shown)?,
        diagnosis: findings.diagnosis.parameters.get(shown)?,
        conditions: &findings.diagnosis.conditions,
        dataset,
        level,
    };
    let name = &shown_parameter.parameter.name;
    let misfit = if findings.diagnosis.scores.is_some() {
        " Misfit: each condition predicted from the others."
    } else {
        ""
    };
    let mut figure = Figure::new(format!("Physics parameter {name}"))
        .caption(format!(
            "Single conditions: fitted with the condition's gains free, and the other parameters and \
            the delays fixed at the common solution (M18).{misfit}"
        ))
        .columns(2)
        .aspect(0.72)
        .plot(shown_parameter.plot());
    if let Some(scores) = &findings.diagnosis.scores {
        figure = figure.plot(misfit_plot(scores, &findings.parameters));
    }
    Some(figure)
}

/// A parameter in every condition.
struct ShownParameter<'a> {
    /// Index among the enabled parameters.
    index: usize,
    parameter: &'a OfferedParameter,
    diagnosis: &'a ParameterDiagnosis,
    conditions: &'a [ConditionDiagnosis],
    dataset: &'a Dataset,
    /// Confidence level for the intervals.
    level: f64,
}

impl ShownParameter<'_> {
    /// Plots the parameter's change over airspeed: the plausible range, the value found for all
    /// conditions together with its interval, and on top the values from single conditions with
    /// their error bars.
    fn plot(&self) -> Plot {
        let sd = self.parameter.plausible_sd;
        let change = self.diagnosis.z * sd;
        let unit = &self.parameter.unit;
        let name = &self.parameter.name;
        let (slowest, fastest) = self.dataset.airspeed_range_kt();
        let ends = [slowest - AIRSPEED_MARGIN_KT, fastest + AIRSPEED_MARGIN_KT];
        let x = Axis::linear("Airspeed [kt]").showing(Some(Range::new(ends[0], ends[1])));
        let y = Axis::linear(format!("Change of {name} [{unit}]"))
            .including(-sd)
            .including(sd);
        let mut panel = Panel::new(x, y).with(Envelope {
            name: "plausible ± 1 sd".to_owned(),
            color: PLAUSIBLE,
            edge: None,
            points: ends.map(|end| [end, -sd, sd]).to_vec(),
        });
        if let Some(half_width) = self.diagnosis.half_width {
            let half_width = half_width * sd;
            panel = panel.with(Envelope {
                name: format!("{:.0} % interval", PERCENT * self.level),
                color: JOINT_INTERVAL,
                edge: None,
                points: ends
                    .map(|end| [end, change - half_width, change + half_width])
                    .to_vec(),
            });
        }
        panel = panel
            .with(Rule::horizontal(0.0, NOMINAL))
            .with(
                Curve::through("all conditions", JOINT, ends.map(|end| [end, change]))
                    .key("all conditions"),
            )
            .with(self.bars());
        Plot::new(format!("{name}, by condition")).panel(panel.with_all(self.dots()))
    }

    /// Returns the parameter's change as fitted to each single condition, with the half-width of
    /// its interval (Student's t, with one degree of freedom less than conditions, as for the value
    /// found for all conditions together); both in the parameter's unit. Conditions without such a
    /// fit are skipped.
    fn values(&self) -> Vec<PlacedValue<'_>> {
        let mut values = Vec::new();
        let degrees = self.conditions.len().saturating_sub(1).max(1) as f64;
        let quantile = student_quantile(self.level, degrees);
        for diagnosed in self.conditions {
            let (Some(Some(single)), Some(condition)) = (
                diagnosed.z_here.get(self.index),
                self.dataset.condition(diagnosed.id),
            ) else {
                continue;
            };
            values.push(PlacedValue {
                condition,
                change: single.z * self.parameter.plausible_sd,
                half_width: quantile * single.sd * self.parameter.plausible_sd,
            });
        }
        values
    }

    fn bars(&self) -> Intervals {
        let ends = self.values().into_iter().map(|value| {
            [
                value.airspeed_kt(),
                value.change - value.half_width,
                value.change + value.half_width,
            ]
        });
        Intervals {
            name: format!("{:.0} % error bar", PERCENT * self.level),
            stroke: BAR,
            ends: ends.collect(),
        }
    }

    /// Returns a group of dots for each combination of altitude and weight class.
    fn dots(&self) -> Vec<Dots> {
        let classes = Classes::from_dataset(self.dataset);
        let mut groups: Vec<Dots> = Vec::new();
        for value in self.values() {
            let state = value.condition.flight_state();
            let shape = if classes.is_first_altitude(state) {
                DotShape::Circle
            } else {
                DotShape::Diamond
            };
            let filled = classes.is_first_weight(state);
            let dot = Dot {
                x: value.airspeed_kt(),
                y: value.change,
                label: String::new(),
                id: Some(MarkId::Condition(state.id)),
            };
            let own_group = groups
                .iter_mut()
                .find(|group| group.shape == shape && group.filled == filled);
            match own_group {
                Some(group) => group.dots.push(dot),
                None => {
                    let color = Color::new(Hue::Perturbed);
                    let mut group = Dots::new("single condition", shape, color).filled(filled);
                    group.dots.push(dot);
                    groups.push(group);
                }
            }
        }
        groups
    }
}

/// The parameter's change in a single condition, and the half-width of its interval, in the
/// parameter's unit.
struct PlacedValue<'a> {
    condition: &'a Condition,
    change: f64,
    half_width: f64,
}

impl PlacedValue<'_> {
    fn airspeed_kt(&self) -> f64 {
        self.condition.flight_state().airspeed_kt
    }
}

/// Plots the misfit in conditions left out as parameters are added, in percent of the misfit
/// without parameters; the last steps are shaded if they do not lower it noticeably.
fn misfit_plot(scores: &Scores, parameters: &[OfferedParameter]) -> Plot {
    let mut names = Vec::new();
    let mut points = Vec::new();
    for (step, scored) in scores.stepwise.iter().enumerate() {
        names.push(match scored.added {
            Some(parameter) => parameters[parameter].name.clone(),
            None => "none".to_owned(),
        });
        points.push([step as f64, PERCENT * scored.score.ratio]);
    }
    let y = Axis::linear("Misfit, conditions left out [%]").including(PERCENT);
    let mut panel = Panel::new(
        Axis::named("Parameters added, one after the other", names),
        y,
    );
    if let Some(first) = first_step_without_improvement(scores) {
        let end = points.len() as f64 - 0.5;
        panel = panel.with_ground(Strip {
            range: Range::new(first as f64 - 0.5, end),
            color: NO_IMPROVEMENT,
            key: "no improvement".to_owned(),
        });
    }
    let mut dots = Dots::new("conditions left out", DotShape::Circle, Color::INK);
    for [step, percent] in &points {
        dots = dots.dot(*step, *percent, "");
    }
    let curve = Curve::through("conditions left out", LEFT_OUT, points);
    Plot::new("Remaining misfit").panel(panel.with(curve).with(dots))
}

/// Returns the first of the last steps that bring no improvement: each lowers the misfit by less
/// than [`LEAST_GAIN`], the least benefit for which the diagnosis names a parameter. `None` if the
/// last step is an improvement. Step 0, without parameters, is never returned.
fn first_step_without_improvement(scores: &Scores) -> Option<usize> {
    let steps = &scores.stepwise;
    let mut first = steps.len();
    while first > 1 {
        let step = first - 1;
        if steps[step - 1].score.ratio - steps[step].score.ratio >= LEAST_GAIN {
            break;
        }
        first = step;
    }
    if first < steps.len() {
        Some(first)
    } else {
        None
    }
}
