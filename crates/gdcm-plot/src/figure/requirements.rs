//! Requirements: phase delay over bandwidth of every attitude response (M17.1), and models over
//! time, in response to a test input and to a flight record with its tolerance corridors (M17.2).

use gdcm_method::requirements::level_boundary::LevelBoundary;
use gdcm_method::requirements::tolerance::ToleranceCheck;
use gdcm_method::requirements::{LevelBoundaries, RecordCheck, TestInputShape};
use gdcm_model::dataset::{Dataset, Pair};
use gdcm_model::units::{number, s_to_ms};
use gdcm_study::results::condition_answers::{QuantityHistory, RecordHistory, TestAnswers};
use gdcm_study::results::required_bandwidth::BandwidthFinding;
use gdcm_study::results::requirement_role::RequirementRole;
use gdcm_study::results::requirements::Requirements;

use super::axis::{Axis, Range};
use super::drawing::{Color, Dash, Hue, Stroke};
use super::figure::{
    Curve, Dot, DotShape, Dots, Envelope, Figure, Intervals, Mark, MarkId, Panel, Plot,
};
use super::role::Role;

const WAY: Stroke = Stroke::solid(Color::DIM.tint(70), 0.7);
const BAR: Stroke = Stroke::solid(Color::DIM, 0.7);
/// Length and half width of an arrow head, as fractions of the span of the marks in a plot.
const HEAD: [f64; 2] = [0.035, 0.012];
/// Larger than every drawn phase delay \[ms\].
const BEYOND_MS: f64 = 1e4;
const LEVEL: Stroke = Stroke::dashed(Color::of(Hue::Warning), 1.0, Dash::Short);

/// Returns the shape and colour of the model of a role.
fn look(role: RequirementRole) -> (DotShape, Color) {
    match role {
        RequirementRole::Physics => (DotShape::Circle, Color::of(Hue::Perturbed)),
        RequirementRole::Corrected => (DotShape::Square, Color::of(Hue::Corrected)),
        RequirementRole::Scheduled => (DotShape::Triangle, Color::of(Hue::Corrected)),
        RequirementRole::Identified => (DotShape::Diamond, Color::of(Hue::Identified)),
    }
}

/// Returns the place of a response in the plot, bandwidth \[rad/s\] and phase delay \[ms\], if both
/// are defined.
pub fn bandwidth_place(of: &BandwidthFinding) -> Option<[f64; 2]> {
    Some([of.omega_bw_rad_s?, s_to_ms(of.phase_delay_s?)])
}

/// Returns the responses with a bandwidth and a phase delay in some condition.
pub fn bandwidth_pairs(requirements: &Requirements) -> Vec<Pair> {
    let mut pairs: Vec<Pair> = Vec::new();
    for of in requirements
        .bandwidth
        .iter()
        .filter(|of| bandwidth_place(of).is_some())
    {
        if !pairs.contains(&of.pair) {
            pairs.push(of.pair);
        }
    }
    pairs
}

/// Plots phase delay over bandwidth for each attitude response: a mark for each condition and
/// model, an arrow from the physics model to the corrected one, available intervals, and the
/// engineer's levels. Numbers that rest on a model beyond the band are grey.
pub fn requirements_figure(
    requirements: &Requirements,
    dataset: &Dataset,
    levels: &LevelBoundaries,
) -> Figure {
    let plots = bandwidth_pairs(requirements).into_iter().map(|pair| {
        let name = dataset.pair_name(pair);
        let axis = &dataset.outputs()[pair.output].name;
        let x = Axis::linear("bandwidth [rad/s]");
        let y = Axis::linear("phase delay [ms]").including(0.0);
        let panel = Panel::new(x, y)
            .with_all(beyond(levels, axis))
            .with_all(boundaries(levels, axis));
        let panel = panel.with_all(marks(requirements, pair));
        Plot::new(format!("{name}: attitude")).panel(panel)
    });
    let level = 100.0 * requirements.interval_level;
    let caption = format!(
        "Bars: {level:.0} % intervals. Grey: rests on the model beyond the band. Arrows lead from physics to corrected of a condition. \
         These numbers are no qualification."
    );
    Figure::new("Bandwidth and phase delay")
        .caption(caption)
        .columns(2)
        .aspect(0.66)
        .plots(plots)
}

/// Shades the areas beyond the boundaries, with less bandwidth and more phase delay, the widest
/// first and the narrower ones darker; a boundary that turns back along x is not shaded.
fn beyond(levels: &LevelBoundaries, axis: &str) -> Vec<Envelope> {
    let mut rising: Vec<&LevelBoundary> = levels
        .of_axis(axis)
        .filter(|of| of.points.is_sorted_by(|a, b| a[0] <= b[0]))
        .collect();
    rising.sort_by(|a, b| b.points[0][0].total_cmp(&a.points[0][0]));
    let area = |(index, of): (usize, &LevelBoundary)| {
        let before = [[0.0, 0.0], [of.points[0][0], 0.0]];
        let points = before
            .iter()
            .chain(&of.points)
            .map(|[x, y]| [*x, s_to_ms(*y), BEYOND_MS])
            .collect();
        let color = Color::of(Hue::Warning).tint((12 * (1 + index)).min(48) as u8);
        Envelope {
            name: format!("beyond {}", of.name),
            color,
            edge: None,
            points,
        }
    };
    rising.into_iter().enumerate().map(area).collect()
}

fn boundaries<'a>(levels: &'a LevelBoundaries, axis: &'a str) -> impl Iterator<Item = Mark> + 'a {
    let line = |of: &LevelBoundary| {
        let points = of
            .points
            .iter()
            .map(|[omega, delay_s]| [*omega, s_to_ms(*delay_s)]);
        Curve::through(&of.name, LEVEL, points).key(&of.name).into()
    };
    levels.of_axis(axis).map(line)
}

/// Returns the spans of these places along both axes; at least a thousandth.
pub(super) fn spanned(places: impl Iterator<Item = [f64; 2]> + Clone) -> [f64; 2] {
    [0, 1].map(|axis| {
        let range =
            Range::of(places.clone().map(|place| place[axis])).unwrap_or(Range::new(0.0, 0.0));
        range
            .width()
            .max(1e-3 * range.max.abs())
            .max(f64::MIN_POSITIVE)
    })
}

/// Returns a line between two places with a head in the middle, where no marker hides it; scaled to
/// the spans `spanned`.
pub(super) fn arrow(from: [f64; 2], to: [f64; 2], spanned: [f64; 2]) -> Vec<[f64; 2]> {
    let along = [0, 1].map(|axis| (to[axis] - from[axis]) / spanned[axis]);
    let length = along[0].hypot(along[1]);
    if length < HEAD[0] {
        return vec![from, to];
    }
    let unit = along.map(|part| part / length);
    let at = |ahead: f64, beside: f64| {
        let of_unit = [
            ahead * unit[0] - beside * unit[1],
            ahead * unit[1] + beside * unit[0],
        ];
        [0, 1].map(|axis| from[axis] + spanned[axis] * of_unit[axis])
    };
    let tip = 0.5 * (length + HEAD[0]);
    let wing = |side: f64| at(tip - HEAD[0], side * HEAD[1]);
    vec![
        from,
        at(tip, 0.0),
        wing(1.0),
        at(tip, 0.0),
        wing(-1.0),
        at(tip, 0.0),
        to,
    ]
}

fn marks(requirements: &Requirements, pair: Pair) -> Vec<Mark> {
    let of_pair = || {
        requirements
            .bandwidth
            .iter()
            .filter(move |of| of.pair == pair)
    };
    let of_role = |role: RequirementRole| of_pair().filter(move |of| of.role == role);
    let mut marks: Vec<Mark> = Vec::new();
    let spanned = spanned(of_pair().filter_map(bandwidth_place));
    for from in of_role(RequirementRole::Physics) {
        let to = requirements.bandwidth_of(from.condition, pair, RequirementRole::Corrected);
        if let (Some(from), Some(to)) = (bandwidth_place(from), to.and_then(bandwidth_place)) {
            marks.push(Curve::through("corrected", WAY, arrow(from, to, spanned)).into());
        }
    }
    let delays = of_pair().filter_map(|of| {
        let [low, high] = of.interval.get("phase_delay_s").copied()?;
        Some([bandwidth_place(of)?[0], s_to_ms(low), s_to_ms(high)])
    });
    let ends: Vec<[f64; 3]> = delays.collect();
    if !ends.is_empty() {
        marks.push(
            Intervals {
                name: "interval".to_owned(),
                stroke: BAR,
                ends,
            }
            .into(),
        );
    }
    for of in of_pair() {
        if let (Some([low, high]), Some([_, delay])) =
            (of.interval.get("omega_bw_rad_s"), bandwidth_place(of))
        {
            marks.push(
                Curve::new(
                    "interval of the bandwidth",
                    BAR,
                    [*low, *high],
                    [delay, delay],
                )
                .into(),
            );
        }
    }
    for role in RequirementRole::ALL {
        let (shape, color) = look(role);
        for rests in [false, true] {
            let is_so = |of: &&BandwidthFinding| {
                (of.rests_above("omega_bw_rad_s") || of.rests_above("phase_delay_s")) == rests
            };
            let dot = |of: &BandwidthFinding| {
                let [x, y] = bandwidth_place(of)?;
                let id = Some(MarkId::Condition(of.condition));
                // One number per condition suffices to identify the others.
                let label = if role == RequirementRole::Corrected {
                    of.condition.to_string()
                } else {
                    String::new()
                };
                Some(Dot { x, y, label, id })
            };
            let dots: Vec<Dot> = of_role(role).filter(is_so).filter_map(dot).collect();
            let color = if rests { color.tint(45) } else { color };
            let of_role = Dots::new(role.name(), shape, color).filled(!rests);
            let of_role = if rests {
                of_role
            } else {
                of_role.key(role.name())
            };
            if !dots.is_empty() {
                marks.push(Dots { dots, ..of_role }.into());
            }
        }
    }
    marks
}

const INPUT: Stroke = Stroke::solid(Color::of(Hue::Text), 1.2);

/// Flight data and their corridor.
const FLOWN: Stroke = Stroke::solid(Color::of(Hue::Text), 1.0);
const CORRIDOR: Color = Color::of(Hue::Text).tint(14);
/// Height of the difference from flight, relative to 1 for the record.
const DIFFERENCE_WEIGHT: f64 = 0.55;
/// Additional line width outside the corridor \[pt\].
const OUTSIDE_PT: f64 = 1.8;

/// Returns the line of a model over time: as in a Bode plot, except that the identified line is as
/// thin as the others.
fn line_of(role: RequirementRole) -> Stroke {
    let role = match role {
        RequirementRole::Physics => Role::Representative,
        RequirementRole::Corrected => Role::Corrected,
        RequirementRole::Scheduled => Role::Scheduled,
        RequirementRole::Identified => Role::Identified,
    };
    role.line(false)
}

/// Plots the input, then each output with a curve for each model, over time. The reasons for
/// missing curves are given below.
pub fn test_answers_figure(answers: &TestAnswers, dataset: &Dataset) -> Figure {
    let time_s = answers.time_s();
    let input = &dataset.inputs()[answers.input];
    let plot = |label: String, curves: Vec<Curve>| {
        let panel = Panel::new(
            Axis::linear("time [s]"),
            Axis::linear(&label).including(0.0),
        );
        Plot::new(label).panel(panel.with_all(curves))
    };
    let moved = Curve::new(&input.name, INPUT, time_s.clone(), answers.signal.clone());
    let moved = plot(format!("{} [{}]", input.name, input.unit), vec![moved]);
    let of_output = |(index, output): (usize, &gdcm_model::dataset::Channel)| {
        let models = answers
            .models
            .iter()
            .rev()
            .filter_map(|(role, answer)| Some((*role, answer.as_ref().ok()?)));
        let curves = models.map(|(role, answer)| {
            let values: Vec<f64> = answer.column(index).iter().copied().collect();
            Curve::new(role.name(), line_of(role), time_s.clone(), values).key(role.name())
        });
        plot(
            format!("{} [{}]", output.name, output.unit),
            curves.collect(),
        )
    };
    let outputs = dataset.outputs().iter().enumerate().map(of_output);
    let shape = match answers.test.shape {
        TestInputShape::Step => "step",
        TestInputShape::Doublet => "doublet",
    };
    let size = number(answers.test.size);
    let duration = number(answers.test.duration_s);
    let title = format!(
        "Condition {}: {shape} of {} by {size} {} for {duration} s",
        answers.condition, input.name, input.unit
    );
    let absent = answers.models.iter().filter_map(|(role, answer)| {
        let why = answer.as_ref().err()?;
        Some(format!(" No {} model: {why}.", role.name()))
    });
    let caption = format!(
        "Linear models from rest; there is no flight here.{}",
        absent.collect::<String>()
    );
    Figure::new(title)
        .caption(caption)
        .columns(2)
        .aspect(0.4)
        .plots(std::iter::once(moved).chain(outputs))
}

/// Plots an input of a record, then each quantity with a tolerance: flight data with their corridor
/// and the response of each model, above the difference between model and flight, both thick
/// outside the corridor. Every window starts anew.
pub fn record_history_figure(history: &RecordHistory, dataset: &Dataset, input: usize) -> Figure {
    let moved = &dataset.inputs()[input];
    let panel = |label: &str| Panel::new(Axis::linear("time [s]"), Axis::linear(label));
    let label = format!("{} [{}]", moved.name, moved.unit);
    let samples: Vec<f64> = history
        .flight
        .inputs
        .column(input)
        .iter()
        .copied()
        .collect();
    let curve = Curve::new(&moved.name, INPUT, history.flight.time_s.clone(), samples);
    let first = Plot::new(&label).panel(panel(&label).with(curve));
    let quantities = history
        .quantities
        .iter()
        .filter(|of| !of.models.is_empty())
        .map(|of| {
            let label = format!("{} [{}]", of.tolerance.quantity, of.unit);
            let less = format!("less flight [{}]", of.unit);
            Plot::new(format!(
                "{}, {}",
                of.tolerance.quantity,
                of.tolerance.words()
            ))
            .panel(panel(&label).with_all(history_marks(of, Shown::AsItIs)))
            .panel(
                panel(&less)
                    .with_all(history_marks(of, Shown::LessFlight))
                    .weight(DIFFERENCE_WEIGHT),
            )
        });
    let held_out = if history.held_out { ", held out" } else { "" };
    let missing: String = history
        .missing
        .iter()
        .map(|why| format!(" {why}."))
        .collect();
    let caption = format!(
        "Windows of at most 10 s, each from an estimated state; attitudes are integrals of rates from the start of each window. Below: \
         less flight. Wide: outside the corridor. No qualification: the tests of the table are steps and doublets at given conditions.{missing}"
    );
    let title = format!(
        "Condition {}: {}{held_out}",
        history.condition, history.record
    );
    Figure::new(title)
        .caption(caption)
        .columns(2)
        .aspect(0.4)
        .plots(std::iter::once(first).chain(quantities))
}

/// Drawn quantity of a record.
#[derive(Clone, Copy, PartialEq)]
enum Shown {
    AsItIs,
    LessFlight,
}

impl Shown {
    /// Returns a value at a sample of a window.
    fn of(self, value: f64, window: &ToleranceCheck, n: usize) -> f64 {
        if self == Self::LessFlight {
            value - window.flown[n]
        } else {
            value
        }
    }
}

/// Iterates over the samples of a record with their times \[s\], and a gap after each window,
/// because windows are separate.
fn samples(check: &RecordCheck) -> impl Iterator<Item = (f64, Option<(&ToleranceCheck, usize)>)> {
    let time = |window: &ToleranceCheck, n: usize| window.start_s + n as f64 * window.sample_time_s;
    check.windows.iter().flat_map(move |window| {
        let all = (0..window.samples()).map(move |n| (time(window, n), Some((window, n))));
        all.chain([(time(window, window.samples()), None)])
    })
}

/// Returns a value at each sample over time.
fn values(check: &RecordCheck, value: impl Fn(&ToleranceCheck, usize) -> f64) -> Vec<[f64; 2]> {
    samples(check)
        .map(|(time, at)| [time, at.map_or(f64::NAN, |(window, n)| value(window, n))])
        .collect()
}

fn history_marks(of: &QuantityHistory, shown: Shown) -> Vec<Mark> {
    let corrected = of
        .models
        .iter()
        .find(|(role, _)| *role == RequirementRole::Corrected);
    let Some((_, about)) = corrected.or(of.models.first()) else {
        return Vec::new();
    };
    let corridor = samples(about).map(|(time, at)| match at {
        Some((window, n)) => {
            let flown = shown.of(window.flown[n], window, n);
            let width = window.width[n];
            [time, flown - width, flown + width]
        }
        None => [time, f64::NAN, f64::NAN],
    });
    let corridor = Envelope {
        name: "corridor".to_owned(),
        color: CORRIDOR,
        edge: None,
        points: corridor.collect(),
    };
    let flown = values(about, |window, n| shown.of(window.flown[n], window, n));
    let flown = (shown == Shown::AsItIs)
        .then(|| Mark::from(Curve::through("flown", FLOWN, flown).key("flown")));
    let models = of.models.iter().rev().flat_map(|(role, check)| {
        let line = line_of(*role);
        let all = values(check, |window, n| shown.of(window.simulated[n], window, n));
        let all = Curve::through(role.name(), line, all).key(role.name());
        let is_outside = |window: &ToleranceCheck, n: usize| {
            (window.simulated[n] - window.flown[n]).abs() > window.width[n]
        };
        let outside = values(check, |window, n| match is_outside(window, n) {
            true => shown.of(window.simulated[n], window, n),
            false => f64::NAN,
        });
        let wide = Stroke {
            width_pt: line.width_pt + OUTSIDE_PT,
            dash: Dash::Solid,
            ..line
        };
        let is_any = outside.iter().any(|[_, value]| value.is_finite());
        let outside = is_any.then(|| {
            Mark::from(Curve::through(
                format!("{}, outside", role.name()),
                wide,
                outside,
            ))
        });
        std::iter::once(Mark::from(all))
            .chain(outside)
            .collect::<Vec<_>>()
    });
    std::iter::once(Mark::from(corridor))
        .chain(flown)
        .chain(models)
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_arrow_ends_where_it_leads_and_its_head_points_there() {
        // As fractions of the span from the origin to the far corner.
        let points = arrow([1.0, 10.0], [3.0, 10.0], [2.0, 100.0]);
        assert_eq!(
            (points[0], points[6], points.len()),
            ([1.0, 10.0], [3.0, 10.0], 7)
        );
        let tip = points[1];
        let wings = [points[2], points[4]];
        for wing in wings {
            assert!(
                wing[0] < tip[0] && ((tip[0] - wing[0]) / 2.0 - HEAD[0]).abs() < 1e-12,
                "{wing:?}"
            );
            assert!(
                ((wing[1] - tip[1]).abs() / 100.0 - HEAD[1]).abs() < 1e-12,
                "{wing:?}"
            );
        }
        assert_eq!(
            arrow([1.0, 10.0], [1.001, 10.0], [2.0, 100.0]).len(),
            2,
            "too short for a head"
        );
        assert_eq!(spanned([[1.0, 5.0], [3.0, 5.0]].into_iter()), [2.0, 5e-3]);
    }

    #[test]
    fn what_lies_beyond_a_level_is_shaded_and_beyond_the_next_one_darker() {
        let text = r#"[{"name": "Level 2", "axis": "P", "points": [[1, 0], [1, 0.2], [1.5, 0.3]]},
                       {"name": "Level 1", "axis": "P", "points": [[2, 0], [2.5, 0.2]]},
                       {"name": "back", "axis": "P", "points": [[2, 0], [1.5, 0.2]]},
                       {"name": "other", "axis": "Q", "points": [[2, 0], [2.5, 0.2]]}]"#;
        let levels: LevelBoundaries = serde_json::from_str(text).unwrap();
        let areas = beyond(&levels, "P");
        let names: Vec<&str> = areas.iter().map(|of| of.name.as_str()).collect();
        assert_eq!(
            names,
            ["beyond Level 1", "beyond Level 2"],
            "the wider lies below; a line that turns back has no side"
        );
        assert!(areas[0].color.percent < areas[1].color.percent);
        let lower: Vec<[f64; 2]> = areas[1].points.iter().map(|of| [of[0], of[1]]).collect();
        assert_eq!(
            lower,
            [
                [0.0, 0.0],
                [1.0, 0.0],
                [1.0, 0.0],
                [1.0, 200.0],
                [1.5, 300.0]
            ]
        );
    }
}
