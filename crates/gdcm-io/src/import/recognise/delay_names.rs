//! Names of delay fields: which signals a field delays, and in which unit. Names are compared
//! *folded*, that is, without case, marks and blanks: `Input_Delay` becomes `inputdelay`.

use gdcm_model::names::channel_alias::folded_name;

use super::values::{Field, array_of};
use crate::formats::variables::Value;

/// Signals to which a delay applies.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Delayed {
    Inputs,
    Outputs,
    /// Each response, with a matrix of delays, outputs x inputs.
    Responses,
    /// Internal delays, which MATLAB stores for feedback loops.
    Inside,
    /// The name leaves open to which signals the delay applies.
    Unclear,
}

/// A delay's unit, according to the field's name.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum DelayUnit {
    Seconds,
    Milliseconds,
    Samples,
    /// Name without a unit, as in MATLAB: seconds, or samples in discrete time.
    Matlab,
    /// Any other name without a unit.
    Unknown,
}

/// A delay's signals and unit, according to its field name.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct DelayMeaning {
    pub(super) delayed: Delayed,
    pub(super) unit: DelayUnit,
}

/// A field whose name suggests a delay.
#[derive(Clone, Copy, Debug)]
pub(super) struct DelayField<'v> {
    pub(super) name: &'v str,
    pub(super) value: &'v Value,
    pub(super) meaning: DelayMeaning,
}

impl DelayField<'_> {
    /// Returns whether the field may hold a nonzero delay. This is true for structs, cells and
    /// objects, which may hold delays by name, but not for strings, which are remarks.
    pub(super) fn is_nonzero(&self) -> bool {
        match array_of(self.value) {
            Some(array) => array.re.iter().any(|delay| *delay != 0.0),
            None => matches!(
                self.value,
                Value::Struct(_) | Value::Cell(_) | Value::Object(_)
            ),
        }
    }
}

/// Returns the fields whose names suggest a delay.
pub(super) fn delay_fields<'v>(fields: &[Field<'v>]) -> Vec<DelayField<'v>> {
    let mut found = Vec::new();
    for &Field { name, value } in fields {
        match (name, value) {
            // MATLAB objects store all delays in this struct.
            ("Delay", Value::Struct(records)) => {
                for (part, values) in &records.fields {
                    if let Some(value) = values.first() {
                        let meaning = DelayMeaning {
                            delayed: delayed_in_matlab_object(part),
                            unit: DelayUnit::Matlab,
                        };
                        found.push(DelayField {
                            name,
                            value,
                            meaning,
                        });
                    }
                }
            }
            _ => {
                if let Some(meaning) = delay_meaning(name) {
                    found.push(DelayField {
                        name,
                        value,
                        meaning,
                    });
                }
            }
        }
    }
    found
}

/// Returns the signals to which a field in a MATLAB object's struct `Delay` applies.
fn delayed_in_matlab_object(part: &str) -> Delayed {
    match part {
        "Input" => Delayed::Inputs,
        "Output" => Delayed::Outputs,
        "IO" => Delayed::Responses,
        "Internal" => Delayed::Inside,
        _ => Delayed::Unclear,
    }
}

/// Returns whether a name is a delay name, or resembles one.
pub(super) fn is_delay(name: &str) -> bool {
    delay_meaning(name).is_some()
}

/// Returns a field name's meaning; a unit at its end does not count as part of the name. A delay
/// name has MATLAB's unit if it is spelled as in MATLAB, else the unit at its end. A name that only
/// resembles a delay name is `Unclear`; any other name is no delay (`None`).
fn delay_meaning(name: &str) -> Option<DelayMeaning> {
    let (stem, unit) = split_unit(name);
    let folded = folded_name(stem);
    let delayed = match folded.trim_end_matches('s') {
        "inputdelay" => Delayed::Inputs,
        "outputdelay" => Delayed::Outputs,
        "iodelay" | "transportdelay" | "inputoutputdelay" => Delayed::Responses,
        "internaldelay" => Delayed::Inside,
        _ if resembles_delay(&folded) => {
            return Some(DelayMeaning {
                delayed: Delayed::Unclear,
                unit: DelayUnit::Unknown,
            });
        }
        _ => return None,
    };
    let is_matlab = matches!(
        name.trim_end_matches('_'),
        "InputDelay" | "OutputDelay" | "IODelay" | "ioDelay" | "InternalDelay"
    );
    let unit = if is_matlab { DelayUnit::Matlab } else { unit };
    Some(DelayMeaning { delayed, unit })
}

/// Splits a name into its front part and the unit at its end: a separate word (`input_delay_ms`,
/// `InputDelay (s)`), or milliseconds without a mark between (`inputDelayMs`, `inputdelayms`).
fn split_unit(name: &str) -> (&str, DelayUnit) {
    let trimmed = name.trim_end_matches(is_mark);
    if let Some((stem, last)) = trimmed.rsplit_once(is_mark) {
        match last.to_lowercase().as_str() {
            "s" | "sec" | "secs" | "second" | "seconds" => return (stem, DelayUnit::Seconds),
            "ms" | "msec" | "msecs" | "millis" | "milliseconds" => {
                return (stem, DelayUnit::Milliseconds);
            }
            "samples" | "sample" | "steps" => return (stem, DelayUnit::Samples),
            _ => {}
        }
    }
    if let Some(stem) = trimmed.strip_suffix("Ms") {
        return (stem, DelayUnit::Milliseconds);
    }
    if trimmed.ends_with("elayms") {
        return (&trimmed[..trimmed.len() - 2], DelayUnit::Milliseconds);
    }
    (trimmed, DelayUnit::Unknown)
}

/// Returns whether a character separates words in a name.
fn is_mark(letter: char) -> bool {
    !letter.is_alphanumeric()
}

/// Returns whether a folded name resembles a delay name. Returns false for phase and group delays,
/// which are curves over frequency.
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_give_the_delayed_signals_and_the_unit() {
        use DelayUnit::{Matlab, Milliseconds, Samples, Seconds, Unknown};
        use Delayed::{Inputs, Outputs, Responses, Unclear};
        for (name, expected) in [
            ("InputDelay", Some((Inputs, Matlab))),
            ("OutputDelay", Some((Outputs, Matlab))),
            ("InputDelays", Some((Inputs, Unknown))),
            ("InputDelay(s)", Some((Inputs, Seconds))),
            ("input_delay", Some((Inputs, Unknown))),
            ("input_delays_s", Some((Inputs, Seconds))),
            ("input_delay_s", Some((Inputs, Seconds))),
            ("input_delay_ms", Some((Inputs, Milliseconds))),
            ("inputDelayMs", Some((Inputs, Milliseconds))),
            ("output_delays [ms]", Some((Outputs, Milliseconds))),
            ("output_delay_samples", Some((Outputs, Samples))),
            ("ioDelay", Some((Responses, Matlab))),
            ("TransportDelay", Some((Responses, Unknown))),
            ("io_delay_s", Some((Responses, Seconds))),
            ("delay_in", Some((Unclear, Unknown))),
            ("tau", Some((Unclear, Unknown))),
            ("tau_i", Some((Unclear, Unknown))),
            ("tau_ms", Some((Unclear, Unknown))),
            ("Td", Some((Unclear, Unknown))),
            ("delays", Some((Unclear, Unknown))),
            ("time_delay", Some((Unclear, Unknown))),
            ("group_delay", None),
            ("Ts", None),
            ("status", None),
            ("inputs", None),
        ] {
            let expected = expected.map(|(delayed, unit)| DelayMeaning { delayed, unit });
            assert_eq!(delay_meaning(name), expected, "{name}");
        }
    }
}
