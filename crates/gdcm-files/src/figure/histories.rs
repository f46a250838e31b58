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

/// An input of a record, then a plot for each quantity that has a tolerance: what was flown with the corridor about it, what each model
/// answers, wide where it is outside. Every window begins anew.
pub fn record_history_figure(history: &RecordHistory, dataset: &Dataset, input: usize) -> Figure {
    let moved = &dataset.inputs()[input];
    let panel = |label: &str| Panel::new(Axis::linear("time [s]"), Axis::linear(label));
    let label = format!("{} [{}]", moved.name, moved.unit);
    let samples: Vec<f64> = history.flight.inputs.column(input).iter().copied().collect();
    let curve = Curve::new(&moved.name, INPUT, history.flight.time_s.clone(), samples);
    let first = Plot::new(&label).panel(panel(&label).with(curve));
    let quantities = history.quantities.iter().filter(|of| !of.models.is_empty()).map(|of| {
        let label = format!("{} [{}]", of.tolerance.quantity, of.unit);
        Plot::new(format!("{}, {}", of.tolerance.quantity, of.tolerance.words()))
            .panel(panel(&label).with_all(marks(of)))
    });
    let held_out = if history.held_out { ", held out" } else { "" };
    let missing: String = history.missing.iter().map(|why| format!(" {why}.")).collect();
    let caption = format!(
        "Windows of at most 10 s, each from an estimated state; attitudes are integrals of rates from the start of each window. Wide: \
         outside the corridor. No qualification: the tests of the table are steps and doublets at given conditions.{missing}"
    );
    let title = format!("Condition {}: {}{held_out}", history.condition, history.record);
    Figure::new(title).caption(caption).columns(2).aspect(0.4).plots(std::iter::once(first).chain(quantities))
}

fn marks(of: &QuantityHistory) -> Vec<Mark> {
    let corrected = of.models.iter().find(|(role, _)| *role == RequirementRole::Corrected);
    let Some((_, about)) = corrected.or(of.models.first()) else { return Vec::new() };
    let time = |window: &ToleranceCheck, n: usize| window.start_s + n as f64 * window.sample_time_s;
    // A gap after each window, which the next one does not go on from.
    let joined = |check: &RecordCheck, value: &dyn Fn(&ToleranceCheck, usize) -> f64| -> (Vec<f64>, Vec<f64>) {
        let windows = check.windows.iter().flat_map(|window| {
            let samples = (0..window.samples()).map(|n| (time(window, n), value(window, n)));
            samples.chain([(time(window, window.samples()), f64::NAN)]).collect::<Vec<_>>()
        });
        windows.unzip()
    };
    let corridor = about.windows.iter().flat_map(|window| {
        let points = (0..window.samples()).map(|n| {
            let (flown, width) = (window.flown[n], window.width[n]);
            [time(window, n), flown - width, flown + width]
        });
        points.chain([[time(window, window.samples()), f64::NAN, f64::NAN]]).collect::<Vec<_>>()
    });
    let corridor = Envelope { name: "corridor".to_owned(), color: CORRIDOR, edge: None, points: corridor.collect() };
    let (x, y) = joined(about, &|window, n| window.flown[n]);
    let flown = Curve::new("flown", FLOWN, x, y).key("flown");
    let models = of.models.iter().rev().flat_map(|(role, check)| {
        let line = line_of(*role);
        let (x, y) = joined(check, &|window, n| window.simulated[n]);
        let all = Curve::new(role.name(), line, x, y).key(role.name());
        let is_outside =
            |window: &ToleranceCheck, n: usize| (window.simulated[n] - window.flown[n]).abs() > window.width[n];
        let outside =
            |window: &ToleranceCheck, n: usize| if is_outside(window, n) { window.simulated[n] } else { f64::NAN };
        let (x, y) = joined(check, &outside);
        let wide = Stroke { width_pt: line.width_pt + OUTSIDE_PT, dash: Dash::Solid, ..line };
        let is_any = y.iter().any(|value| value.is_finite());
        let outside = is_any.then(|| Mark::from(Curve::new(format!("{}, outside", role.name()), wide, x, y)));
        std::iter::once(Mark::from(all)).chain(outside).collect::<Vec<_>>()
    });
    [Mark::from(corridor), Mark::from(flown)].into_iter().chain(models).collect()
}
