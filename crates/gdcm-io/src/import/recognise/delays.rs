//! Sample time and delays of a model, in seconds.

use nalgebra::DMatrix;

use gdcm_model::dataset::state_space::{GREATEST_CHANNEL_DELAY_S, Timing};
use gdcm_model::names::time_name::SAMPLE_TIME_NAMES;
use gdcm_model::units::number;

use super::delay_names::{DelayField, DelayUnit, Delayed};
use super::record::Record;
use super::values::{array_of, first_text_of, list_of, scalar_of};

/// Maximum delay \[s\] that is assumed to be in seconds if its name contains no unit; a larger
/// value may be in milliseconds.
const LONGEST_PLAIN_S: f64 = 1.0;
/// Maximum difference between delays that count as equal \[s\].
const ROUNDING_S: f64 = 1e-9;
/// Remedies in questions about delays.
const WAYS: &str = "call it input_delays_s or output_delays_s (a number for each channel, in s), or rename it if it is not a delay";

/// Sample time and delays of a model, with notes on the conventions that were applied.
pub(super) struct NotedTiming {
    pub(super) timing: Timing,
    pub(super) notes: Vec<String>,
}

/// Reads the sample time and the delays of a model with `outputs` outputs and `inputs` inputs.
///
/// # Errors
/// The question to the user if a field may be a delay, but its signals or its unit are ambiguous:
/// no delay is silently ignored.
pub(super) fn timing_of(
    record: &Record<'_>,
    outputs: usize,
    inputs: usize,
) -> Result<NotedTiming, String> {
    refuse_other_time_units(record)?;
    let mut reading = DelayReading {
        sample_time_s: sample_time_of(record)?,
        is_object: record.class.is_some(),
        outputs,
        inputs,
        input_delays_s: None,
        output_delays_s: None,
        response_delays: None,
        notes: Vec::new(),
    };
    for (level, record) in record.with_outer().enumerate() {
        for field in record.delay_fields() {
            if !field.is_nonzero() {
                continue;
            }
            if level > 0 {
                return Err(format!(
                    "{}: delay without a model; put it beside A, B, C and D, as input_delays_s",
                    field.name
                ));
            }
            reading.add(field)?;
            record.mark_used(field.name);
        }
    }
    Ok(reading.finish())
}

/// Rejects delays given beside a measured response, which already contains all delays. Fields whose
/// names only resemble delays are ignored.
pub(super) fn refuse_delays(record: &Record<'_>) -> Result<(), String> {
    for field in record.delay_fields() {
        if field.meaning.delayed != Delayed::Unclear && field.is_nonzero() {
            return Err(format!(
                "{}: a measured response must contain its delays; include them in it (in MATLAB: \
                sys = absorbDelay(sys)), or remove the field",
                field.name
            ));
        }
    }
    Ok(())
}

/// State of reading the delay fields of a model.
struct DelayReading {
    sample_time_s: Option<f64>,
    /// Whether the model is a MATLAB or GNU Octave object, for which the unit of delays is defined.
    is_object: bool,
    outputs: usize,
    inputs: usize,
    input_delays_s: Option<Vec<f64>>,
    output_delays_s: Option<Vec<f64>>,
    response_delays: Option<SplitDelays>,
    notes: Vec<String>,
}

/// Delays of single responses, split into delays of inputs and of outputs: `tau_oi = tau_o + tau_i`
/// \[s\].
struct SplitDelays {
    inputs: Vec<f64>,
    outputs: Vec<f64>,
}

impl DelayReading {
    fn add(&mut self, field: &DelayField<'_>) -> Result<(), String> {
        let name = field.name;
        match field.meaning.delayed {
            Delayed::Unclear => Err(format!(
                "{name} looks like a delay, but its name gives neither the delayed signals nor the unit: {WAYS}"
            )),
            Delayed::Inside => Err(format!(
                "{name}: internal delays are not supported; approximate them first: sys = pade(sys, 3); in discrete time: sys = absorbDelay(sys)"
            )),
            Delayed::Inputs => {
                let delays = self.channel_delays(field, self.inputs, "input")?;
                store(&mut self.input_delays_s, delays, name)
            }
            Delayed::Outputs => {
                let delays = self.channel_delays(field, self.outputs, "output")?;
                store(&mut self.output_delays_s, delays, name)
            }
            Delayed::Responses if self.response_delays.is_some() => Err(format!(
                "{name}: delays of single responses are given twice; remove one"
            )),
            Delayed::Responses => {
                self.response_delays = Some(self.split_response_delays(field)?);
                Ok(())
            }
        }
    }

    /// Returns the delays \[s\] of `count` inputs or outputs; a single number applies to all.
    fn channel_delays(
        &mut self,
        field: &DelayField<'_>,
        count: usize,
        side: &str,
    ) -> Result<Vec<f64>, String> {
        let name = field.name;
        let mut delays = list_of(name, field.value)?;
        if delays.len() == 1 {
            delays = vec![delays[0]; count];
        }
        if delays.len() != count {
            return Err(format!(
                "{name}: expected {count} delays, one for each {side}, found {}",
                delays.len()
            ));
        }
        self.in_seconds(field, &delays)
    }

    /// Splits the delays of single responses (a matrix, outputs x inputs) into delays of inputs and
    /// of outputs, `tau_oi = tau_o + tau_i`. With `f` the output with the smallest delay to input
    /// 0, `tau_f = 0`, hence `tau_i = tau_fi` and `tau_o = tau_o0 - tau_f0`.
    ///
    /// # Errors
    /// The reason if the delays cannot be split within `ROUNDING_S`.
    fn split_response_delays(&mut self, field: &DelayField<'_>) -> Result<SplitDelays, String> {
        let name = field.name;
        if self.outputs == 0 || self.inputs == 0 {
            return Ok(SplitDelays {
                inputs: vec![0.0; self.inputs],
                outputs: vec![0.0; self.outputs],
            });
        }
        let values = self.response_delay_values(field)?;
        let values = self.in_seconds(field, &values)?;
        let delays = DMatrix::from_column_slice(self.outputs, self.inputs, &values);
        let fastest = delays.column(0).imin();
        let inputs: Vec<f64> = delays.row(fastest).iter().copied().collect();
        let outputs: Vec<f64> = delays
            .column(0)
            .iter()
            .map(|delay| delay - inputs[0])
            .collect();
        for output in 0..self.outputs {
            for input in 0..self.inputs {
                let remainder = delays[(output, input)] - outputs[output] - inputs[input];
                if remainder.abs() > ROUNDING_S {
                    return Err(format!(
                        "{name}, output {}, input {}: the delays of single responses are not the sum of an output delay and an input delay; \
                         approximate them first: sys = pade(sys, 3); in discrete time: sys = absorbDelay(sys)",
                        output + 1,
                        input + 1
                    ));
                }
            }
        }
        self.notes
            .push(format!("{name} split into delays of inputs and of outputs"));
        Ok(SplitDelays { inputs, outputs })
    }

    /// Returns the delays of all responses in the unit of the file, output index fastest; a single
    /// number applies to all responses.
    fn response_delay_values(&self, field: &DelayField<'_>) -> Result<Vec<f64>, String> {
        let [outputs, inputs] = [self.outputs, self.inputs];
        let values = list_of(field.name, field.value)?;
        if let [delay] = values.as_slice() {
            return Ok(vec![*delay; outputs * inputs]);
        }
        let has_shape = array_of(field.value).is_some_and(|array| array.shape == [outputs, inputs]);
        let is_row_or_column = (outputs == 1 || inputs == 1) && values.len() == outputs * inputs;
        if has_shape || is_row_or_column {
            return Ok(values);
        }
        Err(format!(
            "{}: expected a delay for each response, {outputs} x {inputs} (outputs x inputs), found {}; {WAYS}",
            field.name,
            field.value.words()
        ))
    }

    /// Converts delays to seconds.
    ///
    /// # Errors
    /// The question to the user if the unit is ambiguous.
    fn in_seconds(&mut self, field: &DelayField<'_>, delays: &[f64]) -> Result<Vec<f64>, String> {
        let name = field.name;
        let factor = self.seconds_per_unit(field, delays)?;
        let delays: Vec<f64> = delays.iter().map(|delay| factor * delay).collect();
        for delay in &delays {
            if !(0.0..=GREATEST_CHANNEL_DELAY_S).contains(delay) {
                return Err(format!(
                    "{name}: expected delays from 0 to {GREATEST_CHANNEL_DELAY_S} s, found {}",
                    number(*delay)
                ));
            }
        }
        Ok(delays)
    }

    /// Returns the factor that converts the delays of a field to seconds. Notes the convention if
    /// the name contains no unit.
    fn seconds_per_unit(&mut self, field: &DelayField<'_>, delays: &[f64]) -> Result<f64, String> {
        let name = field.name;
        match (field.meaning.unit, self.sample_time_s) {
            (DelayUnit::Seconds, _) => Ok(1.0),
            (DelayUnit::Milliseconds, _) => Ok(1e-3),
            (DelayUnit::Samples, None) => Err(question(
                name,
                "in samples, but the model has no sample time",
            )),
            (DelayUnit::Samples, Some(sample_time_s)) => Ok(sample_time_s),
            (DelayUnit::Matlab, Some(sample_time_s)) => {
                if delays.iter().any(|delay| delay.fract() != 0.0) {
                    return Err(question(
                        name,
                        "MATLAB counts the delays of a discrete-time model in samples, but these are not whole numbers",
                    ));
                }
                self.note_convention(
                    name,
                    "is counted in samples, as in MATLAB for discrete time",
                );
                Ok(sample_time_s)
            }
            (DelayUnit::Unknown, Some(_)) => Err(question(
                name,
                "can be seconds or samples of this discrete-time model",
            )),
            (DelayUnit::Matlab | DelayUnit::Unknown, None) => {
                let greatest = delays
                    .iter()
                    .fold(0.0_f64, |greatest, delay| greatest.max(*delay));
                if greatest > LONGEST_PLAIN_S && !self.is_object {
                    return Err(question(
                        name,
                        &format!("{} can be seconds or milliseconds", number(greatest)),
                    ));
                }
                self.note_convention(
                    name,
                    "is assumed to be in s, because its name contains no \
                    unit",
                );
                Ok(1.0)
            }
        }
    }

    /// Notes the convention that was applied to a field, except in objects, for which the unit is
    /// defined.
    fn note_convention(&mut self, name: &str, words: &str) {
        if !self.is_object {
            self.notes.push(format!("{name} {words}"));
        }
    }

    fn finish(self) -> NotedTiming {
        let (more_inputs, more_outputs) = match self.response_delays {
            Some(split) => (Some(split.inputs), Some(split.outputs)),
            None => (None, None),
        };
        NotedTiming {
            timing: Timing {
                sample_time_s: self.sample_time_s,
                input_delays_s: sum(self.input_delays_s, more_inputs),
                output_delays_s: sum(self.output_delays_s, more_outputs),
            },
            notes: self.notes,
        }
    }
}

/// Returns a question about an ambiguous field, with the names that resolve it.
fn question(name: &str, open: &str) -> String {
    format!(
        "{name}: {open}; call it {}_s and give it in s",
        name.trim_end_matches('_')
    )
}

/// Stores the delays of the inputs or outputs; rejects a second list with different delays.
fn store(stored: &mut Option<Vec<f64>>, delays: Vec<f64>, name: &str) -> Result<(), String> {
    if let Some(known) = stored {
        let differs = known
            .iter()
            .zip(&delays)
            .any(|(known, delay)| (known - delay).abs() > ROUNDING_S);
        if differs {
            return Err(format!(
                "{name}: these delays are given twice, with different numbers; remove one"
            ));
        }
    }
    *stored = Some(delays);
    Ok(())
}

/// Adds the delays given for channels and the delays split off from responses; `None` if all are
/// zero.
fn sum(own: Option<Vec<f64>>, more: Option<Vec<f64>>) -> Option<Vec<f64>> {
    let delays: Vec<f64> = match (own, more) {
        (Some(own), Some(more)) => own
            .iter()
            .zip(&more)
            .map(|(delay, added)| delay + added)
            .collect(),
        (own, more) => own.or(more)?,
    };
    if delays.iter().all(|delay| *delay == 0.0) {
        return None;
    }
    Some(delays)
}

/// Reads the sample time \[s\]; `None` (continuous time) if it is missing, zero, or an empty array.
fn sample_time_of(record: &Record<'_>) -> Result<Option<f64>, String> {
    let Some(value) = record.get(&SAMPLE_TIME_NAMES) else {
        return Ok(None);
    };
    match scalar_of(value) {
        Some(0.0) => Ok(None),
        Some(sample_time) if sample_time > 0.0 => Ok(Some(sample_time)),
        Some(sample_time) => Err(format!(
            "the sample time is {}: a discrete-time model without a known sample time cannot be compared; set Ts",
            number(sample_time)
        )),
        None if array_of(value).is_some_and(|array| array.is_empty()) => Ok(None),
        None => Err(format!(
            "the sample time: expected a number, found {}",
            value.words()
        )),
    }
}

/// Rejects a model whose time unit is not seconds, because its frequencies and delays would be
/// wrong.
fn refuse_other_time_units(record: &Record<'_>) -> Result<(), String> {
    let unit = record.get(&["TimeUnit"]).and_then(first_text_of);
    match unit.as_deref() {
        None | Some("" | "s" | "sec" | "second" | "seconds") => Ok(()),
        Some(unit) => Err(format!(
            "its time unit is {unit}; in MATLAB: sys = chgTimeUnit(sys, 'seconds')"
        )),
    }
}
