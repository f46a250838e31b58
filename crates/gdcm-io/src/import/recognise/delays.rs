//! A model's sample time and delays, in seconds.
//!
//! A [`Record`] is a group of fields that may form a model, such as a struct; it marks the fields
//! that are used.

use nalgebra::DMatrix;

use gdcm_model::dataset::channel::ChannelSide;
use gdcm_model::dataset::state_space::{GREATEST_CHANNEL_DELAY_S, Timing};
use gdcm_model::names::time_name::SAMPLE_TIME_NAMES;

use super::delay_names::{DelayField, DelayUnit, Delayed};
use super::recognition_fault::{RecognitionFault, UnclearDelayUnit};
use super::record::Record;
use super::values::{array_of, first_text_of, list_of, scalar_of};
use crate::formats::reading_note::ReadingNote;

/// Maximum delay \[s\] that is assumed to be in seconds if its name contains no unit; a larger
/// value may be in milliseconds.
const LONGEST_PLAIN_S: f64 = 1.0;
/// Maximum difference between delays that count as equal \[s\].
const ROUNDING_S: f64 = 1e-9;

/// A model's sample time and delays, with notes on the conventions that were applied.
pub(super) struct NotedTiming {
    pub(super) timing: Timing,
    pub(super) notes: Vec<ReadingNote>,
}

/// Reads sample time and delays for a model with `outputs` outputs and `inputs` inputs.
///
/// 1. A time unit other than seconds: error.
/// 2. Sample time; continuous time without one.
/// 3. Each nonzero delay field beside the matrices: input, output or response delays, in seconds
///    (`DelayReading::add`). A nonzero delay field in an enclosing record: error.
/// 4. Response delays are split into input and output delays, which are added to those of step 3.
///
/// # Errors
/// An invalid sample time, delays with another count, shape or range, or contradictory ones; and
/// the question to the user if a field may be a delay, but its signals or its unit are ambiguous:
/// no delay is silently ignored.
pub(super) fn timing_of(
    record: &Record<'_>,
    outputs: usize,
    inputs: usize,
) -> Result<NotedTiming, RecognitionFault> {
    // Steps 1 and 2.
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
    // Step 3; level 0 is the record itself.
    for (level, record) in record.with_outer().enumerate() {
        for field in record.delay_fields() {
            if !field.is_nonzero() {
                continue;
            }
            if level > 0 {
                return Err(RecognitionFault::DelayWithoutModel {
                    name: field.name.to_owned(),
                });
            }
            reading.add(field)?;
            record.mark_used(field.name);
        }
    }
    // Step 4.
    Ok(reading.finish())
}

/// Rejects delays given beside a measured response, which already contains all delays. Fields whose
/// names only resemble delays are ignored: nothing is lost if they are delays.
pub(super) fn refuse_delays(record: &Record<'_>) -> Result<(), RecognitionFault> {
    for field in record.delay_fields() {
        if field.meaning.delayed != Delayed::Unclear && field.is_nonzero() {
            return Err(RecognitionFault::DelayOfResponse {
                name: field.name.to_owned(),
            });
        }
    }
    Ok(())
}

/// State while a model's delay fields are read.
struct DelayReading {
    sample_time_s: Option<f64>,
    /// Whether the model is a MATLAB or GNU Octave object, for which the delay unit is defined.
    is_object: bool,
    outputs: usize,
    inputs: usize,
    input_delays_s: Option<Vec<f64>>,
    output_delays_s: Option<Vec<f64>>,
    response_delays: Option<SplitDelays>,
    notes: Vec<ReadingNote>,
}

/// Delays of single responses, split into input and output delays: `tau_oi = tau_o + tau_i` \[s\].
struct SplitDelays {
    inputs: Vec<f64>,
    outputs: Vec<f64>,
}

impl DelayReading {
    /// Reads a delay field. Input and output delays may be given twice if equal, response delays
    /// only once.
    fn add(&mut self, field: &DelayField<'_>) -> Result<(), RecognitionFault> {
        let name = field.name;
        match field.meaning.delayed {
            Delayed::Unclear => Err(RecognitionFault::UnclearDelay {
                name: name.to_owned(),
            }),
            Delayed::Inside => Err(RecognitionFault::InternalDelay {
                name: name.to_owned(),
            }),
            Delayed::Inputs => {
                let delays = self.channel_delays(field, self.inputs, ChannelSide::Input)?;
                store(&mut self.input_delays_s, delays, name)
            }
            Delayed::Outputs => {
                let delays = self.channel_delays(field, self.outputs, ChannelSide::Output)?;
                store(&mut self.output_delays_s, delays, name)
            }
            Delayed::Responses if self.response_delays.is_some() => {
                Err(RecognitionFault::ResponseDelaysTwice {
                    name: name.to_owned(),
                })
            }
            Delayed::Responses => {
                self.response_delays = Some(self.split_response_delays(field)?);
                Ok(())
            }
        }
    }

    /// Returns the delays \[s\] for `count` inputs or outputs; a single number applies to all.
    fn channel_delays(
        &mut self,
        field: &DelayField<'_>,
        count: usize,
        side: ChannelSide,
    ) -> Result<Vec<f64>, RecognitionFault> {
        let name = field.name;
        let mut delays = list_of(name, field.value)?;
        if delays.len() == 1 {
            delays = vec![delays[0]; count];
        }
        if delays.len() != count {
            return Err(RecognitionFault::DelayCount {
                name: name.to_owned(),
                side,
                expected: count,
                found: delays.len(),
            });
        }
        self.in_seconds(field, &delays)
    }

    /// Splits the delays of single responses (a matrix, outputs x inputs) into input and output
    /// delays, `tau_oi = tau_o + tau_i`. With `f` the output with the smallest delay from input 0,
    /// `tau_f = 0`, hence `tau_i = tau_fi` and `tau_o = tau_o0 - tau_f0`.
    ///
    /// # Errors
    /// The reason if the delays cannot be split within `ROUNDING_S`.
    fn split_response_delays(
        &mut self,
        field: &DelayField<'_>,
    ) -> Result<SplitDelays, RecognitionFault> {
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
                    return Err(RecognitionFault::NotASumOfDelays {
                        name: name.to_owned(),
                        output: output + 1,
                        input: input + 1,
                    });
                }
            }
        }
        self.notes.push(ReadingNote::DelaysSplit {
            name: name.to_owned(),
        });
        Ok(SplitDelays { inputs, outputs })
    }

    /// Returns the delays of all responses in the file's unit, output index fastest; a single
    /// number applies to all responses.
    fn response_delay_values(&self, field: &DelayField<'_>) -> Result<Vec<f64>, RecognitionFault> {
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
        Err(RecognitionFault::ResponseDelayShape {
            name: field.name.to_owned(),
            outputs,
            inputs,
            found: field.value.words(),
        })
    }

    /// Converts delays to seconds.
    ///
    /// # Errors
    /// The question to the user if the unit is ambiguous; the reason if a delay is negative, or
    /// above the maximum for a channel.
    fn in_seconds(
        &mut self,
        field: &DelayField<'_>,
        delays: &[f64],
    ) -> Result<Vec<f64>, RecognitionFault> {
        let name = field.name;
        let factor = self.seconds_per_unit(field, delays)?;
        let delays: Vec<f64> = delays.iter().map(|delay| factor * delay).collect();
        for delay in &delays {
            if !(0.0..=GREATEST_CHANNEL_DELAY_S).contains(delay) {
                return Err(RecognitionFault::DelayRange {
                    name: name.to_owned(),
                    value: *delay,
                });
            }
        }
        Ok(delays)
    }

    /// Returns the factor that converts a field's delays to seconds. Notes the convention if the
    /// name contains no unit.
    ///
    /// - Name with a unit: that unit. Samples require a sample time.
    /// - Name as in MATLAB, discrete time: samples, which must be whole numbers.
    /// - Any other name without a unit, discrete time: ambiguous.
    /// - Name without a unit, continuous time: seconds; outside objects, delays above
    ///   `LONGEST_PLAIN_S` are ambiguous.
    fn seconds_per_unit(
        &mut self,
        field: &DelayField<'_>,
        delays: &[f64],
    ) -> Result<f64, RecognitionFault> {
        let name = field.name;
        match (field.meaning.unit, self.sample_time_s) {
            (DelayUnit::Seconds, _) => Ok(1.0),
            (DelayUnit::Milliseconds, _) => Ok(1e-3),
            (DelayUnit::Samples, None) => {
                Err(question(name, UnclearDelayUnit::SamplesOfContinuousModel))
            }
            (DelayUnit::Samples, Some(sample_time_s)) => Ok(sample_time_s),
            (DelayUnit::Matlab, Some(sample_time_s)) => {
                if delays.iter().any(|delay| delay.fract() != 0.0) {
                    return Err(question(name, UnclearDelayUnit::PartsOfSamples));
                }
                self.note_convention(ReadingNote::DelayInSamples {
                    name: name.to_owned(),
                });
                Ok(sample_time_s)
            }
            (DelayUnit::Unknown, Some(_)) => {
                Err(question(name, UnclearDelayUnit::SecondsOrSamples))
            }
            (DelayUnit::Matlab | DelayUnit::Unknown, None) => {
                let greatest = delays
                    .iter()
                    .fold(0.0_f64, |greatest, delay| greatest.max(*delay));
                if greatest > LONGEST_PLAIN_S && !self.is_object {
                    return Err(question(
                        name,
                        UnclearDelayUnit::SecondsOrMilliseconds { greatest },
                    ));
                }
                self.note_convention(ReadingNote::DelayInSeconds {
                    name: name.to_owned(),
                });
                Ok(1.0)
            }
        }
    }

    /// Notes the convention that was applied to a field, except in objects, for which the unit is
    /// defined.
    fn note_convention(&mut self, note: ReadingNote) {
        if !self.is_object {
            self.notes.push(note);
        }
    }

    /// Adds the split response delays to the input and output delays (step 4).
    fn finish(self) -> NotedTiming {
        let (split_inputs_s, split_outputs_s) = match self.response_delays {
            Some(split) => (Some(split.inputs), Some(split.outputs)),
            None => (None, None),
        };
        NotedTiming {
            timing: Timing {
                sample_time_s: self.sample_time_s,
                input_delays_s: sum(self.input_delays_s, split_inputs_s),
                output_delays_s: sum(self.output_delays_s, split_outputs_s),
            },
            notes: self.notes,
        }
    }
}

/// Returns a question about a field with an ambiguous unit, with the field name that resolves it.
fn question(name: &str, unit: UnclearDelayUnit) -> RecognitionFault {
    RecognitionFault::DelayUnit {
        name: name.to_owned(),
        unit,
    }
}

/// Stores the input or output delays; rejects a second list with different delays.
fn store(
    stored: &mut Option<Vec<f64>>,
    delays: Vec<f64>,
    name: &str,
) -> Result<(), RecognitionFault> {
    if let Some(known) = stored {
        let differs = known
            .iter()
            .zip(&delays)
            .any(|(known, delay)| (known - delay).abs() > ROUNDING_S);
        if differs {
            return Err(RecognitionFault::ContradictoryDelays {
                name: name.to_owned(),
            });
        }
    }
    *stored = Some(delays);
    Ok(())
}

/// Adds the delays given for channels and the delays split off from responses; `None` if all are
/// zero.
fn sum(given: Option<Vec<f64>>, split: Option<Vec<f64>>) -> Option<Vec<f64>> {
    let delays: Vec<f64> = match (given, split) {
        (Some(given), Some(split)) => given
            .iter()
            .zip(&split)
            .map(|(given, split)| given + split)
            .collect(),
        (given, split) => given.or(split)?,
    };
    if delays.iter().all(|delay| *delay == 0.0) {
        return None;
    }
    Some(delays)
}

/// Reads the sample time \[s\]; `None` (continuous time) if it is missing, zero, or an empty array.
fn sample_time_of(record: &Record<'_>) -> Result<Option<f64>, RecognitionFault> {
    let Some(value) = record.get(&SAMPLE_TIME_NAMES) else {
        return Ok(None);
    };
    match scalar_of(value) {
        Some(0.0) => Ok(None),
        Some(sample_time) if sample_time > 0.0 => Ok(Some(sample_time)),
        Some(value) => Err(RecognitionFault::SampleTime { value }),
        None if array_of(value).is_some_and(|array| array.is_empty()) => Ok(None),
        None => Err(RecognitionFault::SampleTimeKind {
            found: value.words(),
        }),
    }
}

/// Rejects a model whose time unit is not seconds, because its frequencies and delays would be
/// wrong.
pub(super) fn refuse_other_time_units(record: &Record<'_>) -> Result<(), RecognitionFault> {
    let unit = record.get(&["TimeUnit"]).and_then(first_text_of);
    match unit.as_deref() {
        None | Some("" | "s" | "sec" | "second" | "seconds") => Ok(()),
        Some(unit) => Err(RecognitionFault::TimeUnit {
            unit: unit.to_owned(),
        }),
    }
}
