//! Delays of a model: fields that hold them, their units, and fields that only look like delays.

use nalgebra::DMatrix;

use gdcm_model::dataset::state_space::{GREATEST_CHANNEL_DELAY_S, Timing};
use gdcm_model::names::channel_alias::folded_name;
use gdcm_model::names::time_name::SAMPLE_TIME_NAMES;
use gdcm_model::units::number;

use super::record::{Field, Record, array_of, list_of, scalar_of, texts_of};
use crate::formats::variables::{Array, Value};

/// Delay [s] without a unit in its name above which milliseconds are as likely as seconds.
const LONGEST_PLAIN_S: f64 = 1.0;
/// Tolerance for delays of single responses as a sum of two delays.
const ROUNDING: f64 = 1e-9;

/// The delayed signals.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Delayed {
    /// Each input.
    Inputs,
    /// Each output.
    Outputs,
    /// Each response: a matrix of outputs by inputs.
    Responses,
    /// Internal delays.
    Inside,
    /// Not given by the name.
    Unclear,
}

/// Unit of a delay, from its name.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum DelayUnit {
    Seconds,
    Milliseconds,
    Samples,
    /// No unit, in MATLAB's spelling: seconds, or samples of a discrete-time model.
    Matlab,
    /// No unit.
    Unsaid,
}

/// A field that looks like a delay.
#[derive(Clone, Copy, Debug)]
pub(crate) struct DelayField<'v> {
    name: &'v str,
    value: &'v Value,
    delayed: Delayed,
    unit: DelayUnit,
}

impl DelayField<'_> {
    /// Whether the field holds anything except zeros.
    fn says_something(&self) -> bool {
        match (self.value, array_of(self.value)) {
            (_, Some(array)) => array.re.iter().any(|delay| *delay != 0.0),
            // A struct or a list of named delays; texts are remarks.
            (Value::Struct(_) | Value::Cell(_) | Value::Object(_), None) => true,
            _ => false,
        }
    }
}

/// Returns the fields that look like delays.
pub(super) fn delay_fields<'v>(fields: &[Field<'v>]) -> Vec<DelayField<'v>> {
    let mut found = Vec::new();
    for &(name, value) in fields {
        if let ("Delay", Value::Struct(records)) = (name, value) {
            // Delays of MATLAB objects.
            for (inner, values) in &records.fields {
                let delayed = match inner.as_str() {
                    "Input" => Delayed::Inputs,
                    "Output" => Delayed::Outputs,
                    "IO" => Delayed::Responses,
                    "Internal" => Delayed::Inside,
                    _ => Delayed::Unclear,
                };
                found.extend(values.first().map(|value| DelayField {
                    name,
                    value,
                    delayed,
                    unit: DelayUnit::Matlab,
                }));
            }
            continue;
        }
        if let Some((delayed, unit)) = meaning(name) {
            found.push(DelayField {
                name,
                value,
                delayed,
                unit,
            });
        }
    }
    found
}

/// Whether a name is or resembles the name of a delay.
pub(super) fn is_delay(name: &str) -> bool {
    meaning(name).is_some()
}

/// Returns the meaning of a delay name.
fn meaning(name: &str) -> Option<(Delayed, DelayUnit)> {
    let (stem, unit) = unit_at_end(name);
    let folded = folded_name(stem);
    let delayed = match folded.trim_end_matches('s') {
        "inputdelay" => Delayed::Inputs,
        "outputdelay" => Delayed::Outputs,
        "iodelay" | "transportdelay" | "inputoutputdelay" => Delayed::Responses,
        "internaldelay" => Delayed::Inside,
        _ => return resembles_delay(&folded).then_some((Delayed::Unclear, DelayUnit::Unsaid)),
    };
    let is_matlab = matches!(
        name.trim_end_matches('_'),
        "InputDelay" | "OutputDelay" | "IODelay" | "ioDelay" | "InternalDelay"
    );
    Some((delayed, if is_matlab { DelayUnit::Matlab } else { unit }))
}

/// Splits a name and its trailing unit: `input_delay_ms`, `InputDelay (s)`, `inputDelayMs`.
fn unit_at_end(name: &str) -> (&str, DelayUnit) {
    let trimmed = name.trim_end_matches(is_mark);
    if let Some((stem, last)) = trimmed.rsplit_once(is_mark) {
        let unit = match last.to_lowercase().as_str() {
            "s" | "sec" | "secs" | "second" | "seconds" => Some(DelayUnit::Seconds),
            "ms" | "msec" | "msecs" | "millis" | "milliseconds" => Some(DelayUnit::Milliseconds),
            "samples" | "sample" | "steps" => Some(DelayUnit::Samples),
            _ => None,
        };
        if let Some(unit) = unit {
            return (stem, unit);
        }
    }
    match trimmed.strip_suffix("Ms").or_else(|| {
        trimmed
            .strip_suffix("elayms")
            .map(|_| &trimmed[..trimmed.len() - 2])
    }) {
        Some(stem) => (stem, DelayUnit::Milliseconds),
        None => (trimmed, DelayUnit::Unsaid),
    }
}

fn is_mark(letter: char) -> bool {
    !letter.is_alphanumeric()
}

/// Whether a folded name may hold delays, besides the names with a known meaning. Phase and group
/// delays are curves over frequency.
fn resembles_delay(folded: &str) -> bool {
    const NAMES: [&str; 14] = [
        "tau",
        "taui",
        "tauo",
        "tauin",
        "tauout",
        "tauu",
        "tauy",
        "td",
        "tdin",
        "tdout",
        "tdel",
        "deadtime",
        "latency",
        "transportlag",
    ];
    let is_curve = folded.starts_with("group") || folded.starts_with("phase");
    NAMES.contains(&folded) || (folded.contains("delay") && !is_curve)
}

/// Names for delays, suggested in questions.
const WAYS: &str = "call it input_delays_s or output_delays_s (one number for each channel, in s), or otherwise if it is no delay";

/// Returns sample time and delays of a model, with notes on the conventions applied.
///
/// # Errors
/// A possible delay whose signals or unit are ambiguous: it becomes a question and is never
/// dropped.
pub(super) fn timing_of(
    record: &Record<'_>,
    outputs: usize,
    inputs: usize,
) -> Result<(Timing, Vec<String>), String> {
    refuse_other_time_units(record)?;
    let mut reading = DelayReading {
        sample_time_s: sample_time_of(record)?,
        is_object: record.class.is_some(),
        outputs,
        inputs,
        of_inputs: None,
        of_outputs: None,
        of_responses: None,
        notes: Vec::new(),
    };
    for (level, record) in record.with_outer().enumerate() {
        for field in record.delay_fields() {
            if !field.says_something() {
                continue;
            }
            if level > 0 {
                return Err(format!(
                    "{}: a delay beside no model; put it beside A, B, C and D, as input_delays_s",
                    field.name
                ));
            }
            reading.take(field)?;
            record.use_field(field.name);
        }
    }
    reading.timing()
}

/// Refuses delays beside a measured response, which already contains them; ignores fields that only
/// resemble delays.
pub(super) fn refuse_delays(record: &Record<'_>) -> Result<(), String> {
    let mut known = record
        .delay_fields()
        .iter()
        .filter(|field| field.delayed != Delayed::Unclear);
    match known.find(|field| field.says_something()) {
        Some(field) => Err(format!(
            "{}: a measured response has its delays in it; multiply it by them (in MATLAB: sys = absorbDelay(sys)), or remove the field",
            field.name
        )),
        None => Ok(()),
    }
}

/// Delays of one model during reading.
struct DelayReading {
    sample_time_s: Option<f64>,
    is_object: bool,
    outputs: usize,
    inputs: usize,
    of_inputs: Option<Vec<f64>>,
    of_outputs: Option<Vec<f64>>,
    of_responses: Option<SplitDelays>,
    notes: Vec<String>,
}

/// Delays of single responses as sums, `tau_oi = tau_o + tau_i` [s].
struct SplitDelays {
    inputs: Vec<f64>,
    outputs: Vec<f64>,
}

impl DelayReading {
    fn take(&mut self, field: &DelayField<'_>) -> Result<(), String> {
        let name = field.name;
        match field.delayed {
            Delayed::Unclear => Err(format!(
                "{name} looks like a delay, and its name leaves open of what and in which unit: {WAYS}"
            )),
            Delayed::Inside => Err(format!(
                "{name}: internal delays cannot be taken; absorb them first: sys = pade(sys, 3)"
            )),
            Delayed::Inputs => {
                let delays = self.of_channels(field, self.inputs, "input")?;
                keep(&mut self.of_inputs, delays, name)
            }
            Delayed::Outputs => {
                let delays = self.of_channels(field, self.outputs, "output")?;
                keep(&mut self.of_outputs, delays, name)
            }
            Delayed::Responses if self.of_responses.is_some() => Err(format!(
                "{name}: delays of single responses are given twice; remove one"
            )),
            Delayed::Responses => {
                self.of_responses = Some(self.of_responses(field)?);
                Ok(())
            }
        }
    }

    /// Returns one delay [s] for each channel of a side.
    fn of_channels(
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

    /// Splits delays of single responses into input delays and output delays.
    fn of_responses(&mut self, field: &DelayField<'_>) -> Result<SplitDelays, String> {
        let name = field.name;
        let p = self.outputs;
        let m = self.inputs;
        if p == 0 || m == 0 {
            return Ok(SplitDelays {
                inputs: vec![0.0; m],
                outputs: vec![0.0; p],
            });
        }
        let values = list_of(name, field.value)?;
        let shape = array_of(field.value)
            .map(|array: &Array| array.shape.clone())
            .unwrap_or_default();
        let is_row_or_column = (p == 1 || m == 1) && values.len() == p * m;
        let values = match values.as_slice() {
            [one] => vec![*one; p * m],
            _ if shape == [p, m] || is_row_or_column => values,
            _ => {
                return Err(format!(
                    "{name}: expected a delay for each response, {p} x {m} (outputs x inputs), found {}; {WAYS}",
                    field.value.words()
                ));
            }
        };
        let values = self.in_seconds(field, &values)?;
        let table = DMatrix::from_column_slice(p, m, &values);
        // The output with the smallest delay gets zero delay.
        let first = table.column(0).imin();
        let inputs: Vec<f64> = table.row(first).iter().copied().collect();
        let outputs: Vec<f64> = table
            .column(0)
            .iter()
            .map(|delay| delay - inputs[0])
            .collect();
        for output in 0..p {
            for input in 0..m {
                if (table[(output, input)] - outputs[output] - inputs[input]).abs() > ROUNDING {
                    return Err(format!(
                        "{name}, output {}, input {}: the delays of single responses are not the sum of a delay of each output and one of \
                         each input, which a model of the dataset can have; absorb them first: sys = pade(sys, 3)",
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

    /// Converts delays to seconds, if their unit is known.
    fn in_seconds(&mut self, field: &DelayField<'_>, delays: &[f64]) -> Result<Vec<f64>, String> {
        let name = field.name;
        let greatest = delays
            .iter()
            .fold(0.0_f64, |greatest, delay| greatest.max(*delay));
        let are_whole = delays.iter().all(|delay| delay.fract() == 0.0);
        let factor = match (field.unit, self.sample_time_s) {
            (DelayUnit::Seconds, _) => 1.0,
            (DelayUnit::Milliseconds, _) => 1e-3,
            (DelayUnit::Samples, None) => {
                return Err(question(
                    name,
                    "in samples of a model that has no sample time",
                ));
            }
            (DelayUnit::Samples, Some(sample_time_s)) => sample_time_s,
            (DelayUnit::Matlab, Some(_)) if !are_whole => {
                let open = "MATLAB counts the delays of a discrete-time model in samples, and these are no whole numbers";
                return Err(question(name, open));
            }
            (DelayUnit::Matlab, Some(sample_time_s)) => {
                self.note_convention(name, "counted in samples, as MATLAB does in discrete time");
                sample_time_s
            }
            (DelayUnit::Unsaid, Some(_)) => {
                return Err(question(
                    name,
                    "seconds or samples of this discrete-time model are not said",
                ));
            }
            (DelayUnit::Matlab | DelayUnit::Unsaid, None)
                if greatest > LONGEST_PLAIN_S && !self.is_object =>
            {
                return Err(question(
                    name,
                    &format!(
                        "{} can be seconds or milliseconds, which is not said",
                        number(greatest)
                    ),
                ));
            }
            (DelayUnit::Matlab | DelayUnit::Unsaid, None) => {
                self.note_convention(name, "taken to be in s, as its name says no unit");
                1.0
            }
        };
        let delays: Vec<f64> = delays.iter().map(|delay| factor * delay).collect();
        match delays
            .iter()
            .find(|delay| !(0.0..=GREATEST_CHANNEL_DELAY_S).contains(*delay))
        {
            Some(delay) => Err(format!(
                "{name}: expected delays from 0 to {GREATEST_CHANNEL_DELAY_S} s, found {}",
                number(*delay)
            )),
            None => Ok(delays),
        }
    }

    /// Notes an applied convention; for objects the meaning is defined, not a convention.
    fn note_convention(&mut self, name: &str, words: &str) {
        if !self.is_object {
            self.notes.push(format!("{name} {words}"));
        }
    }

    fn timing(self) -> Result<(Timing, Vec<String>), String> {
        let (more_inputs, more_outputs) = match self.of_responses {
            Some(SplitDelays { inputs, outputs }) => (Some(inputs), Some(outputs)),
            None => (None, None),
        };
        let timing = Timing {
            sample_time_s: self.sample_time_s,
            input_delays_s: sum(self.of_inputs, more_inputs),
            output_delays_s: sum(self.of_outputs, more_outputs),
        };
        Ok((timing, self.notes))
    }
}

/// Formulates an ambiguity, and the name that resolves it.
fn question(name: &str, open: &str) -> String {
    format!(
        "{name}: {open}; call it {}_s and give it in s",
        name.trim_end_matches('_')
    )
}

/// Stores the delays of a side; refuses a second list with other delays.
fn keep(kept: &mut Option<Vec<f64>>, delays: Vec<f64>, name: &str) -> Result<(), String> {
    match kept {
        Some(known)
            if known
                .iter()
                .zip(&delays)
                .any(|(one, other)| (one - other).abs() > ROUNDING) =>
        {
            Err(format!(
                "{name}: these delays are given a second time, with other numbers; remove one"
            ))
        }
        _ => {
            *kept = Some(delays);
            Ok(())
        }
    }
}

/// Adds the channel delays of a side and those from single responses; none if all are zero.
fn sum(own: Option<Vec<f64>>, more: Option<Vec<f64>>) -> Option<Vec<f64>> {
    let delays = match (own, more) {
        (Some(own), Some(more)) => own
            .iter()
            .zip(&more)
            .map(|(one, other)| one + other)
            .collect(),
        (own, more) => own.or(more)?,
    };
    Some(delays).filter(|delays: &Vec<f64>| delays.iter().any(|delay| *delay != 0.0))
}

fn sample_time_of(record: &Record<'_>) -> Result<Option<f64>, String> {
    let Some(value) = record.get(&SAMPLE_TIME_NAMES) else {
        return Ok(None);
    };
    match scalar_of(value) {
        Some(0.0) => Ok(None),
        Some(sample_time) if sample_time > 0.0 => Ok(Some(sample_time)),
        Some(sample_time) => Err(format!(
            "the sample time is {}: a discrete-time model whose sample time is not said cannot be compared; set Ts",
            number(sample_time)
        )),
        None if array_of(value).is_some_and(|array| array.is_empty()) => Ok(None),
        None => Err(format!(
            "the sample time: expected a number, found {}",
            value.words()
        )),
    }
}

/// Refuses a model whose time unit is not seconds, as its frequencies and delays would be wrong.
fn refuse_other_time_units(record: &Record<'_>) -> Result<(), String> {
    let Some(texts) = record.get(&["TimeUnit"]).and_then(texts_of) else {
        return Ok(());
    };
    match texts.first().map(String::as_str) {
        None | Some("" | "s" | "sec" | "second" | "seconds") => Ok(()),
        Some(unit) => Err(format!(
            "its time is in {unit}; in MATLAB: sys = chgTimeUnit(sys, 'seconds')"
        )),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_say_what_is_delayed_and_in_which_unit() {
        use DelayUnit::{Matlab, Milliseconds, Samples, Seconds, Unsaid};
        use Delayed::{Inputs, Outputs, Responses, Unclear};
        for (name, expected) in [
            ("InputDelay", Some((Inputs, Matlab))),
            ("OutputDelay", Some((Outputs, Matlab))),
            ("InputDelays", Some((Inputs, Unsaid))),
            ("InputDelay(s)", Some((Inputs, Seconds))),
            ("input_delay", Some((Inputs, Unsaid))),
            ("input_delays_s", Some((Inputs, Seconds))),
            ("input_delay_s", Some((Inputs, Seconds))),
            ("input_delay_ms", Some((Inputs, Milliseconds))),
            ("inputDelayMs", Some((Inputs, Milliseconds))),
            ("output_delays [ms]", Some((Outputs, Milliseconds))),
            ("output_delay_samples", Some((Outputs, Samples))),
            ("ioDelay", Some((Responses, Matlab))),
            ("TransportDelay", Some((Responses, Unsaid))),
            ("io_delay_s", Some((Responses, Seconds))),
            ("delay_in", Some((Unclear, Unsaid))),
            ("tau", Some((Unclear, Unsaid))),
            ("tau_i", Some((Unclear, Unsaid))),
            ("tau_ms", Some((Unclear, Unsaid))),
            ("Td", Some((Unclear, Unsaid))),
            ("delays", Some((Unclear, Unsaid))),
            ("time_delay", Some((Unclear, Unsaid))),
            ("group_delay", None),
            ("Ts", None),
            ("status", None),
            ("inputs", None),
        ] {
            assert_eq!(meaning(name), expected, "{name}");
        }
    }
}
