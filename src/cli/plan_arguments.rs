//! Options for `gdcm plan`.

use std::path::PathBuf;

use clap::Args;

use super::channel_values::{ChannelValue, channel_amplitude};
use super::identify_arguments::RecordArguments;
use super::option_values::{PairName, pair_name, positive_number, real_number, whole_number};

/// Flight records, and the sweeps to be planned.
#[derive(Debug, Args)]
pub struct PlanArguments {
    #[command(flatten)]
    pub source: RecordArguments,
    /// Wanted half-width in dB of the 95 % interval of a response at a frequency in rad/s; may be repeated.
    #[arg(long, value_name = "OUTPUT/INPUT@RAD_S=DB", value_parser = target)]
    pub target: Vec<TargetValue>,
    /// Amplitude of the sweeps of an input, in its units [default: that of the flown sweeps]; may be repeated.
    #[arg(long, value_name = "INPUT=X", value_parser = channel_amplitude, allow_hyphen_values = true)]
    pub amplitude: Vec<ChannelValue<f64>>,
    /// Length of a sweep in seconds [default: that of the flown sweeps].
    #[arg(long, value_name = "SECONDS", value_parser = positive_number, allow_negative_numbers = true)]
    pub length: Option<f64>,
    /// Band of the sweeps, in rad/s [default: from half the lower band end to 4/3 times the upper].
    #[arg(
        long,
        num_args = 2,
        value_names = ["LO", "HI"],
        value_parser = real_number,
        allow_negative_numbers = true
    )]
    pub sweep_band: Option<Vec<f64>>,
    /// Maximum number of further sweeps of an input for a target.
    #[arg(long, value_name = "N", value_parser = whole_number::<1, 100>, default_value = "16")]
    pub repeats: usize,
    /// File for the plan with all numbers (JSON).
    #[arg(long, value_name = "FILE")]
    pub out: Option<PathBuf>,
    /// Overwrite an existing file.
    #[arg(long)]
    pub force: bool,
}

/// A wanted interval.
#[derive(Clone, Debug, PartialEq)]
pub struct TargetValue {
    pub pair: PairName,
    /// Frequency \[rad/s\].
    pub omega: f64,
    /// Half-width of the 95 % interval \[dB\].
    pub half_db: f64,
}

/// Parses "Q/LON@1=0.5".
fn target(text: &str) -> Result<TargetValue, String> {
    valid_target(text).ok_or_else(|| {
        format!(
            "expected OUTPUT/INPUT@RAD_S=DB with positive numbers, such as Q/LON@1=0.5; found \
            \"{text}\""
        )
    })
}

fn valid_target(text: &str) -> Option<TargetValue> {
    let (place, half_db) = text.rsplit_once('=')?;
    let (pair, omega) = place.rsplit_once('@')?;
    let half_db = half_db.trim();
    let half_db = half_db.strip_suffix("dB").unwrap_or(half_db);
    Some(TargetValue {
        pair: pair_name(pair.trim()).ok()?,
        omega: positive_number(omega).ok()?,
        half_db: positive_number(half_db).ok()?,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_target_names_a_response_a_frequency_and_an_interval() {
        let expected = TargetValue {
            pair: PairName {
                output: "Q".into(),
                input: "LON".into(),
            },
            omega: 1.5,
            half_db: 0.5,
        };
        for text in ["Q/LON@1.5=0.5", "Q/LON@1.5=0.5dB", "Q/LON @ 1.5 = 0.5 dB"] {
            assert_eq!(target(text), Ok(expected.clone()), "{text}");
        }
        for wrong in [
            "Q/LON@1",
            "Q/LON=0.5",
            "Q@1=0.5",
            "Q/LON@0=0.5",
            "Q/LON@1=-1",
            "Q/LON@x=1",
            "/LON@1=1",
            "Q/LON@1=inf",
        ] {
            assert!(target(wrong).is_err(), "{wrong}");
        }
    }
}
