//! Models over time: what they answer to a test input, and to a flight record within the corridors about it (M17.2).

use gdcm_core::dataset::Dataset;
use gdcm_core::requirements::{RecordCheck, TestInputShape, ToleranceCheck};
use gdcm_core::study::{QuantityHistory, RecordHistory, RequirementRole, TestAnswers};
use gdcm_core::units::number;

use super::axis::Axis;
use super::drawing::{Color, Dash, Hue, Stroke};
use super::figure::{Figure, Panel, Plot};
use super::mark::{Curve, Envelope, Mark};
use super::role::Role;

const INPUT: Stroke = Stroke::solid(Color::of(Hue::Text), 1.2);

/// What was flown, and the corridor about it.
const FLOWN: Stroke = Stroke::solid(Color::of(Hue::Text), 1.0);
const CORRIDOR: Color = Color::of(Hue::Text).tint(14);
/// Height of the difference from flight, where that of the record is 1.
const DIFFERENCE_WEIGHT: f64 = 0.55;
/// How much wider a line is outside the corridor \[pt\].
const OUTSIDE_PT: f64 = 1.8;

/// The line of a model over time: as in Bode, the identified one as thin as the others.
fn line_of(role: RequirementRole) -> Stroke {
    let role = match role {
        RequirementRole::Physics => Role::Representative,
        RequirementRole::Corrected => Role::Corrected,
        RequirementRole::Scheduled => Role::Scheduled,
        RequirementRole::Identified => Role::Identified,
    };
    role.line(false)
}

/// The input, then a plot for each output with a curve for each model, over time. Why a model has no curve stands below.
pub fn test_answers_figure(answers: &TestAnswers, dataset: &Dataset) -> Figure {
    let time_s = answers.time_s();
    let input = &dataset.inputs()[answers.input];
    let plot = |label: String, curves: Vec<Curve>| {
        let panel = Panel::new(Axis::linear("time [s]"), Axis::linear(&label).including(0.0));
        Plot::new(label).panel(panel.with_all(curves))
    };
    let moved = Curve::new(&input.name, INPUT, time_s.clone(), answers.signal.clone());
    let moved = plot(format!("{} [{}]", input.name, input.unit), vec![moved]);
    let of_output = |(index, output): (usize, &gdcm_core::dataset::Channel)| {
        let models = answers.models.iter().rev().filter_map(|(role, answer)| Some((*role, answer.as_ref().ok()?)));
        let curves = models.map(|(role, answer)| {
            let values: Vec<f64> = answer.column(index).iter().copied().collect();
            Curve::new(role.name(), line_of(role), time_s.clone(), values).key(role.name())
        });
        plot(format!("{} [{}]", output.name, output.unit), curves.collect())
    };
    let outputs = dataset.outputs().iter().enumerate().map(of_output);
    let shape = match answers.test.shape {
        TestInputShape::Step => "step",
        TestInputShape::Doublet => "doublet",
    };
    let (size, duration) = (number(answers.test.size), number(answers.test.duration_s));
    let title =
        format!("Condition {}: {shape} of {} by {size} {} for {duration} s", answers.condition, input.name, input.unit);
    let absent = answers.models.iter().filter_map(|(role, answer)| {
        let why = answer.as_ref().err()?;
        Some(format!(" No {} model: {why}.", role.name()))
    });
    let caption = format!("Linear models from rest; there is no flight here.{}", absent.collect::<String>());
    Figure::new(title).caption(caption).columns(2).aspect(0.4).plots(std::iter::once(moved).chain(outputs))
}

/// An input of a record, then a plot for each quantity that has a tolerance: what was flown with the corridor about it and what each model
/// answers, above what it answers less flight, both wide where it is outside. Every window begins anew.
pub fn record_history_figure(history: &RecordHistory, dataset: &Dataset, input: usize) -> Figure {
    let moved = &dataset.inputs()[input];
    let panel = |label: &str| Panel::new(Axis::linear("time [s]"), Axis::linear(label));
    let label = format!("{} [{}]", moved.name, moved.unit);
    let samples: Vec<f64> = history.flight.inputs.column(input).iter().copied().collect();
    let curve = Curve::new(&moved.name, INPUT, history.flight.time_s.clone(), samples);
    let first = Plot::new(&label).panel(panel(&label).with(curve));
    let quantities = history.quantities.iter().filter(|of| !of.models.is_empty()).map(|of| {
        let label = format!("{} [{}]", of.tolerance.quantity, of.unit);
        let less = format!("less flight [{}]", of.unit);
        Plot::new(format!("{}, {}", of.tolerance.quantity, of.tolerance.words()))
            .panel(panel(&label).with_all(marks(of, Shown::AsItIs)))
            .panel(panel(&less).with_all(marks(of, Shown::LessFlight)).weight(DIFFERENCE_WEIGHT))
    });
    let held_out = if history.held_out { ", held out" } else { "" };
    let missing: String = history.missing.iter().map(|why| format!(" {why}.")).collect();
    let caption = format!(
        "Windows of at most 10 s, each from an estimated state; attitudes are integrals of rates from the start of each window. Below: \
         less flight. Wide: outside the corridor. No qualification: the tests of the table are steps and doublets at given conditions.{missing}"
    );
    let title = format!("Condition {}: {}{held_out}", history.condition, history.record);
    Figure::new(title).caption(caption).columns(2).aspect(0.4).plots(std::iter::once(first).chain(quantities))
}

/// What of a record is drawn.
#[derive(Clone, Copy, PartialEq)]
enum Shown {
    AsItIs,
    LessFlight,
}

impl Shown {
    /// A value at a sample of a window.
    fn of(self, value: f64, window: &ToleranceCheck, n: usize) -> f64 {
        if self == Self::LessFlight { value - window.flown[n] } else { value }
    }
}

/// Every sample of a record with its time \[s\], and a gap after each window, which the next one does not go on from.
fn samples(check: &RecordCheck) -> impl Iterator<Item = (f64, Option<(&ToleranceCheck, usize)>)> {
    let time = |window: &ToleranceCheck, n: usize| window.start_s + n as f64 * window.sample_time_s;
    check.windows.iter().flat_map(move |window| {
        let all = (0..window.samples()).map(move |n| (time(window, n), Some((window, n))));
        all.chain([(time(window, window.samples()), None)])
    })
}

/// A value at each sample over time.
fn curve(check: &RecordCheck, value: impl Fn(&ToleranceCheck, usize) -> f64) -> (Vec<f64>, Vec<f64>) {
    samples(check).map(|(time, at)| (time, at.map_or(f64::NAN, |(window, n)| value(window, n)))).unzip()
}

fn marks(of: &QuantityHistory, shown: Shown) -> Vec<Mark> {
    let corrected = of.models.iter().find(|(role, _)| *role == RequirementRole::Corrected);
    let Some((_, about)) = corrected.or(of.models.first()) else { return Vec::new() };
    let corridor = samples(about).map(|(time, at)| match at {
        Some((window, n)) => {
            let (flown, width) = (shown.of(window.flown[n], window, n), window.width[n]);
            [time, flown - width, flown + width]
        }
        None => [time, f64::NAN, f64::NAN],
    });
    let corridor = Envelope { name: "corridor".to_owned(), color: CORRIDOR, edge: None, points: corridor.collect() };
    let (x, y) = curve(about, |window, n| shown.of(window.flown[n], window, n));
    let flown = (shown == Shown::AsItIs).then(|| Mark::from(Curve::new("flown", FLOWN, x, y).key("flown")));
    let models = of.models.iter().rev().flat_map(|(role, check)| {
        let line = line_of(*role);
        let (x, y) = curve(check, |window, n| shown.of(window.simulated[n], window, n));
        let all = Curve::new(role.name(), line, x, y).key(role.name());
        let is_outside =
            |window: &ToleranceCheck, n: usize| (window.simulated[n] - window.flown[n]).abs() > window.width[n];
        let (x, y) = curve(check, |window, n| match is_outside(window, n) {
            true => shown.of(window.simulated[n], window, n),
            false => f64::NAN,
        });
        let wide = Stroke { width_pt: line.width_pt + OUTSIDE_PT, dash: Dash::Solid, ..line };
        let is_any = y.iter().any(|value| value.is_finite());
        let outside = is_any.then(|| Mark::from(Curve::new(format!("{}, outside", role.name()), wide, x, y)));
        std::iter::once(Mark::from(all)).chain(outside).collect::<Vec<_>>()
    });
    std::iter::once(Mark::from(corridor)).chain(flown).chain(models).collect()
}
