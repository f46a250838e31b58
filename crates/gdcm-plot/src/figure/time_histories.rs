//! Models over time: their responses to a test input, and to a flight record with its tolerance
//! corridors (M17.2).
//!
//! An *error* is the simulated value minus the flight data, a *corridor* the flight data plus and
//! minus a tolerance. A *window* is a part of the record that is simulated from an initial state of
//! its own. The *answer* of a model is its response to the test input.

use gdcm_method::requirements::tolerance_check::ToleranceCheck;
use gdcm_method::requirements::{RecordCheck, TestInputShape};
use gdcm_model::dataset::Dataset;
use gdcm_model::units::number;
use gdcm_study::results::record_history::{QuantityHistory, RecordHistory};
use gdcm_study::results::requirement_role::RequirementRole;
use gdcm_study::results::test_input_responses::TestAnswers;
use gdcm_words::missing_results::{no_test_answer_text, not_in_history_text};
use gdcm_words::time_histories::tolerance_text;

use super::axis::Axis;
use super::drawing::{Color, Hue, Stroke};
use super::figure::{Figure, Panel, Plot};
use super::marks::{Curve, Envelope, Mark};
use super::role::Role;

const INPUT: Stroke = Stroke::solid(Color::new(Hue::Text), 1.2);
/// Line style for the flight data.
const FLIGHT: Stroke = Stroke::solid(Color::new(Hue::Text), 1.3);
/// Fill colour of the corridor around the flight data: the tolerance on either side.
const CORRIDOR: Color = Color::new(Hue::Text).tint(10);
/// Height of the panel with the error; the panel with the record has height 1.
const ERROR_WEIGHT: f64 = 0.55;
/// Height of the panel with the input, above a single quantity's record with height 1.
const INPUT_WEIGHT: f64 = 0.36;
/// Line width for a model's curve \[pt\]: thin, so that all models and the flight data can be told
/// apart.
const MODEL_PT: f64 = 1.2;
/// Line width for the parts of a model's curve outside the corridor \[pt\].
const OUTSIDE_PT: f64 = 1.8;
/// Ratio of plot height to width.
const ASPECT: f64 = 0.4;

/// Returns a model's line style over time: as in a Bode plot, but thin.
fn model_line(role: RequirementRole) -> Stroke {
    let role = match role {
        RequirementRole::Physics => Role::Representative,
        RequirementRole::Corrected => Role::Corrected,
        RequirementRole::Scheduled => Role::Scheduled,
        RequirementRole::Identified => Role::Identified,
    };
    Stroke {
        width_pt: MODEL_PT,
        ..role.line(false)
    }
}

fn empty_panel(label: &str) -> Panel {
    Panel::new(Axis::linear("time [s]"), Axis::linear(label))
}

/// Plots a test input over time, then each output with a curve for each model. The caption gives
/// the reasons for missing curves.
pub fn test_answers_figure(answers: &TestAnswers, dataset: &Dataset) -> Figure {
    let time_s = answers.time_s();
    let input = &dataset.inputs()[answers.input];
    let stick = Curve::new(&input.name, INPUT, time_s.clone(), answers.signal.clone());
    let mut plots = vec![test_plot(&input.name, &input.unit, vec![stick])];
    for (index, output) in dataset.outputs().iter().enumerate() {
        let curves = test_curves(answers, &time_s, index);
        plots.push(test_plot(&output.name, &output.unit, curves));
    }
    let mut caption = "Linear models, starting at rest; no flight data.".to_owned();
    for (role, answer) in &answers.models {
        if let Err(why) = answer {
            let why = no_test_answer_text(why);
            caption.push_str(&format!(" No {} model: {why}.", role.name()));
        }
    }
    Figure::new(test_title(answers, dataset))
        .caption(caption)
        .columns(2)
        .aspect(ASPECT)
        .plots(plots)
}

/// Returns `Condition 10: doublet of LON by 1 in for 2 s`.
fn test_title(answers: &TestAnswers, dataset: &Dataset) -> String {
    let input = &dataset.inputs()[answers.input];
    let shape = match answers.test.shape {
        TestInputShape::Step => "step",
        TestInputShape::Doublet => "doublet",
    };
    format!(
        "Condition {}: {shape} of {} by {} {} for {} s",
        answers.condition,
        input.name,
        number(answers.test.size),
        input.unit,
        number(answers.test.duration_s)
    )
}

fn test_plot(name: &str, unit: &str, curves: Vec<Curve>) -> Plot {
    let label = format!("{name} [{unit}]");
    let mut panel = empty_panel(&label);
    panel.y = panel.y.including(0.0);
    Plot::new(label).panel(panel.with_all(curves))
}

/// Returns an output's curves, one for each model, the first model on top.
fn test_curves(answers: &TestAnswers, time_s: &[f64], output: usize) -> Vec<Curve> {
    let mut curves = Vec::new();
    for (role, answer) in answers.models.iter().rev() {
        if let Ok(answer) = answer {
            let values: Vec<f64> = answer.column(output).iter().copied().collect();
            let curve = Curve::new(role.name(), model_line(*role), time_s, values);
            curves.push(curve.key(role.name()));
        }
    }
    curves
}

/// Plots one recorded input, then each quantity with a tolerance that a model simulates: the flight
/// data with their corridor and each model's response; below, the errors. Curves are thick where
/// they are outside the corridor. The simulation restarts at each window.
pub fn record_history_figure(history: &RecordHistory, dataset: &Dataset, input: usize) -> Figure {
    let mut plots = vec![record_input_plot(history, dataset, input)];
    for quantity in &history.quantities {
        if !quantity.models.is_empty() {
            plots.push(quantity_plot(quantity));
        }
    }
    let held_out = if history.held_out { ", held out" } else { "" };
    let missing: String = history
        .missing
        .iter()
        .map(|why| format!(" {}.", not_in_history_text(why)))
        .collect();
    let caption = format!(
        "Windows of at most 10 s, each starting from an estimated state; attitudes are integrals \
        of rates from the start of each window. Error: simulated minus flight. Thick lines: \
        outside the corridor. This is not a qualification: the tests in the table of tolerances \
        are steps and doublets at specified conditions.{missing}"
    );
    let title = format!(
        "Condition {}: {}{held_out}",
        history.condition, history.record
    );
    Figure::new(title)
        .caption(caption)
        .columns(2)
        .aspect(ASPECT)
        .plots(plots)
}

/// Plots a single quantity from a record: the input with index `input`, the quantity with its
/// corridor, and the errors, below one another over the same time.
pub fn quantity_figure(
    history: &RecordHistory,
    quantity: &QuantityHistory,
    dataset: &Dataset,
    input: usize,
) -> Figure {
    let output = &dataset.outputs()[quantity.output].name;
    let label = format!("{output} [{}]", quantity.unit);
    let record = empty_panel(&label).with_all(history_marks(quantity, Shown::Values));
    let error_label = format!("error [{}]", quantity.unit);
    let error = empty_panel(&error_label).with_all(history_marks(quantity, Shown::Error));
    let plot = Plot::new("")
        .panel(record_input_panel(history, dataset, input).weight(INPUT_WEIGHT))
        .panel(record)
        .panel(error.weight(ERROR_WEIGHT));
    let title = format!("{}: {}", history.record, quantity.tolerance.quantity);
    Figure::new(title).aspect(ASPECT).plots([plot])
}

fn record_input_panel(history: &RecordHistory, dataset: &Dataset, input: usize) -> Panel {
    let channel = &dataset.inputs()[input];
    let label = format!("{} [{}]", channel.name, channel.unit);
    let flight = &history.flight;
    let samples: Vec<f64> = flight.inputs.column(input).iter().copied().collect();
    let curve = Curve::new(&channel.name, INPUT, flight.time_s.clone(), samples);
    empty_panel(&label).with(curve)
}

fn record_input_plot(history: &RecordHistory, dataset: &Dataset, input: usize) -> Plot {
    let panel = record_input_panel(history, dataset, input);
    Plot::new(panel.y.label.clone()).panel(panel)
}

/// Plots a quantity's flight data and the models' responses, and below the errors.
fn quantity_plot(history: &QuantityHistory) -> Plot {
    let tolerance = &history.tolerance;
    let label = format!("{} [{}]", tolerance.quantity, history.unit);
    let error_label = format!("error [{}]", history.unit);
    let record = empty_panel(&label).with_all(history_marks(history, Shown::Values));
    let error = empty_panel(&error_label).with_all(history_marks(history, Shown::Error));
    let title = format!("{}, {}", tolerance.quantity, tolerance_text(tolerance));
    Plot::new(title)
        .panel(record)
        .panel(error.weight(ERROR_WEIGHT))
}

/// Values that a panel shows for a quantity.
#[derive(Clone, Copy, PartialEq)]
enum Shown {
    /// Values as recorded or simulated.
    Values,
    /// Error: difference from the flight data at the same sample.
    Error,
}

/// A sample in a window of the record.
#[derive(Clone, Copy)]
struct Sample<'a> {
    window: &'a ToleranceCheck,
    index: usize,
}

impl Sample<'_> {
    /// Returns the flight data at the sample.
    fn flight(self, shown: Shown) -> f64 {
        self.presented(self.window.flown[self.index], shown)
    }

    fn simulated(self, shown: Shown) -> f64 {
        self.presented(self.window.simulated[self.index], shown)
    }

    /// Returns the simulated value outside the corridor, NaN inside.
    fn outside(self, shown: Shown) -> f64 {
        let error = self.window.simulated[self.index] - self.window.flown[self.index];
        if error.abs() > self.half_width() {
            self.simulated(shown)
        } else {
            f64::NAN
        }
    }

    /// Returns the corridor's half-width at the sample.
    fn half_width(self) -> f64 {
        self.window.width[self.index]
    }

    /// Returns the recorded or simulated `value` at the sample as shown.
    fn presented(self, value: f64, shown: Shown) -> f64 {
        match shown {
            Shown::Values => value,
            Shown::Error => value - self.window.flown[self.index],
        }
    }
}

/// A time in a record \[s\], with its sample. Each window is followed by a time without a sample,
/// which leaves a gap in the curve.
struct Instant<'a> {
    time_s: f64,
    sample: Option<Sample<'a>>,
}

/// Returns the times in all windows, in order.
fn instants(check: &RecordCheck) -> Vec<Instant<'_>> {
    let mut instants = Vec::new();
    for window in &check.windows {
        let count = window.samples();
        for index in 0..=count {
            let sample = if index < count {
                Some(Sample { window, index })
            } else {
                None
            };
            instants.push(Instant {
                time_s: window.start_s + index as f64 * window.sample_time_s,
                sample,
            });
        }
    }
    instants
}

/// Returns the points `[time, value]` in all windows.
fn values(check: &RecordCheck, value: impl Fn(Sample<'_>) -> f64) -> Vec<[f64; 2]> {
    let mut values = Vec::new();
    for instant in instants(check) {
        let value = match instant.sample {
            Some(sample) => value(sample),
            None => f64::NAN,
        };
        values.push([instant.time_s, value]);
    }
    values
}

/// Draws the corridor, each model with its parts outside the corridor and, unless errors are shown,
/// the flight data. Corridor and flight data are taken from the check of the corrected model
/// or, without it, of the first model.
fn history_marks(history: &QuantityHistory, shown: Shown) -> Vec<Mark> {
    let corrected = history
        .models
        .iter()
        .find(|(role, _)| *role == RequirementRole::Corrected);
    let Some((_, flight_check)) = corrected.or(history.models.first()) else {
        return Vec::new();
    };
    let mut marks = vec![Mark::from(corridor(flight_check, shown))];
    for (role, check) in history.models.iter().rev() {
        let line = model_line(*role);
        let simulated = values(check, |sample| sample.simulated(shown));
        let curve = Curve::through(role.name(), line, simulated);
        marks.push(curve.key(role.name()).into());
        let outside = values(check, |sample| sample.outside(shown));
        if outside.iter().any(|[_, value]| value.is_finite()) {
            let wide = Stroke::solid(line.color, OUTSIDE_PT);
            let name = format!("{}, outside", role.name());
            marks.push(Curve::through(name, wide, outside).into());
        }
    }
    // The flight data lie on top.
    if shown == Shown::Values {
        let flight = values(flight_check, |sample| sample.flight(shown));
        marks.push(Curve::through("flown", FLIGHT, flight).key("flown").into());
    }
    marks
}

fn corridor(check: &RecordCheck, shown: Shown) -> Envelope {
    let mut points = Vec::new();
    for Instant { time_s, sample } in instants(check) {
        points.push(match sample {
            Some(sample) => {
                let flight = sample.flight(shown);
                [
                    time_s,
                    flight - sample.half_width(),
                    flight + sample.half_width(),
                ]
            }
            None => [time_s, f64::NAN, f64::NAN],
        });
    }
    Envelope {
        name: "corridor".to_owned(),
        color: CORRIDOR,
        edge: None,
        points,
    }
}
