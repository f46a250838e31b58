//! Faults in a record, found by comparing it with the other records (M14.16).

use std::fmt;

use gdcm_model::dataset::condition::ChannelRemedy;
use gdcm_model::simulation::Signal;

/// A gain this close to -1 is treated as a reversed sign: the factor estimated for a reversed
/// output is not exactly -1, but for example -0.98.
const NEAR_A_SIGN: f64 = 0.3;

/// A fault in a record's outputs or in one channel.
#[derive(Clone, Debug, PartialEq)]
pub enum RecordFault {
    /// Delay common to all outputs \[s\]; negative if they are early.
    OutputsLate(f64),
    /// Delay in a channel \[s\]; negative if it is early.
    Late(Signal, f64),
    /// Factor by which an output has to be multiplied.
    Gain(Signal, f64),
}

impl RecordFault {
    /// Returns the faulty channel, if it is a single channel.
    #[must_use]
    pub fn signal(&self) -> Option<&Signal> {
        match self {
            Self::OutputsLate(_) => None,
            Self::Late(signal, _) | Self::Gain(signal, _) => Some(signal),
        }
    }

    /// Returns the correction for each faulty channel (all `outputs` if they are late together); a
    /// factor near -1 becomes a mere sign change.
    #[must_use]
    pub fn remedies(&self, outputs: &[Signal]) -> Vec<(Signal, ChannelRemedy)> {
        match self {
            Self::OutputsLate(delay_s) => outputs
                .iter()
                .map(|output| (output.clone(), delay_remedy(*delay_s)))
                .collect(),
            Self::Late(signal, delay_s) => vec![(signal.clone(), delay_remedy(*delay_s))],
            Self::Gain(signal, factor) => {
                let is_sign = (factor + 1.0).abs() < NEAR_A_SIGN;
                let remedy = ChannelRemedy {
                    factor: if is_sign { -1.0 } else { *factor },
                    ..ChannelRemedy::NONE
                };
                vec![(signal.clone(), remedy)]
            }
        }
    }

    /// Returns the delay \[s\]; `None` for a wrong gain.
    #[must_use]
    pub fn delay_s(&self) -> Option<f64> {
        match self {
            Self::OutputsLate(delay_s) | Self::Late(_, delay_s) => Some(*delay_s),
            Self::Gain(..) => None,
        }
    }
}

fn delay_remedy(delay_s: f64) -> ChannelRemedy {
    ChannelRemedy {
        delay_s,
        ..ChannelRemedy::NONE
    }
}

impl fmt::Display for RecordFault {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::OutputsLate(delay_s) => {
                write!(f, "all its outputs are logged {}", delay_text(*delay_s))
            }
            Self::Late(signal, delay_s) => {
                write!(f, "{signal} is logged {}", delay_text(*delay_s))
            }
            Self::Gain(signal, factor) if *factor < 0.0 => {
                write!(f, "{signal} has the opposite sign (factor {factor:.2})")
            }
            Self::Gain(signal, factor) => write!(f, "{signal} needs a factor of {factor:.2}"),
        }
    }
}

/// Writes a delay in words, such as `80 ms late`.
fn delay_text(delay_s: f64) -> String {
    let direction = if delay_s < 0.0 { "early" } else { "late" };
    format!("{:.0} ms {direction}", 1e3 * delay_s.abs())
}

/// A record that contradicts others.
#[derive(Clone, Debug, PartialEq)]
pub struct ContradictingRecord {
    /// Record index, from 0.
    pub record: usize,
    pub name: String,
    /// Most likely fault, if this is the wrong record.
    pub fault: Option<RecordFault>,
}
