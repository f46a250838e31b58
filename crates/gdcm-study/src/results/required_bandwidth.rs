//! Findings on bandwidth and phase delay (M17.1), in the export format; they are computed by
//! `condition_bandwidths::bandwidth_findings`.
//!
//! Bandwidth is the frequency with 45 deg phase margin (phase -135 deg) or, for a rate response,
//! that with 6 dB gain margin if it is lower; phase delay describes how fast the phase falls beyond
//! -180 deg. A *swap* is a repetition of the analysis with another model of a bundle, for the
//! intervals (M13.1). A metric *rests* above or below the band if it depends on the response there.

use std::collections::BTreeMap;

use serde::{Serialize, Serializer};

use gdcm_method::requirements::attitude_response::AttitudeResponseError;
use gdcm_method::requirements::bandwidth::{Bandwidth, Metric, NoMetric};
use gdcm_method::requirements::level_boundary::AssessedLevel;
use gdcm_method::requirements::{BandwidthRule, LevelBoundaries};
use gdcm_method::uncertainty::student_quantile;
use gdcm_model::dataset::{ConditionId, Pair};

use super::requirement_role::RequirementRole;

/// A model's bandwidth and phase delay in a response.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct BandwidthFinding {
    pub condition: ConditionId,
    /// The condition's true airspeed \[kt\].
    pub airspeed_kt: f64,
    #[serde(skip)]
    pub pair: Pair,
    pub output: String,
    pub input: String,
    pub role: RequirementRole,
    pub model: String,
    /// Bandwidth \[rad/s\].
    pub omega_bw_rad_s: Option<f64>,
    /// Frequency where the phase is -135 deg \[rad/s\].
    pub omega_phase_rad_s: Option<f64>,
    /// Frequency with 6 dB gain margin \[rad/s\].
    pub omega_gain_rad_s: Option<f64>,
    /// Frequency where the phase is -180 deg \[rad/s\].
    pub omega_180_rad_s: Option<f64>,
    pub phase_delay_s: Option<f64>,
    /// The margin that determines the bandwidth.
    pub rule: Option<BandwidthRule>,
    /// Whether the gain margin is reached before the phase margin; the standard warns about this
    /// case.
    pub gain_limited: bool,
    /// Maximum phase deviation from a straight line between `omega_180` and `2 omega_180` \[deg\].
    pub phase_departure_deg: Option<f64>,
    /// Whether the phase delay is computed from a least-squares line because the phase is not
    /// straight.
    pub phase_delay_of_line: bool,
    /// Metrics that depend on the response above the band, where flight has not judged the model.
    pub rests_above_band: Vec<&'static str>,
    /// Metrics that depend on the response below the band, where flight has not judged the model.
    pub rests_below_band: Vec<&'static str>,
    /// Intervals by metric name, where available.
    #[serde(skip_serializing_if = "BTreeMap::is_empty")]
    pub interval: BTreeMap<&'static str, [f64; 2]>,
    /// Number of swaps without a value, by metric name; the interval excludes them.
    #[serde(skip_serializing_if = "BTreeMap::is_empty")]
    pub swaps_left_out: BTreeMap<&'static str, usize>,
    /// Phase \[deg\] at the band's lowest frequency, if it indicates a reversed channel.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub reversed_phase_deg: Option<f64>,
    /// Reasons for absent values by metric name; "interval" for all intervals.
    #[serde(skip_serializing_if = "BTreeMap::is_empty")]
    pub absent: BTreeMap<&'static str, NoBandwidth>,
}

/// Why a bandwidth, a phase delay or an interval is missing.
#[derive(Clone, Debug, PartialEq)]
pub enum NoBandwidth {
    NetGainNotPositive,
    /// The couplings cannot be applied to the physics model, for example because it has no
    /// matrices.
    NotCoupled,
    NoAttitudeResponse(AttitudeResponseError),
    NoMetric(NoMetric),
    /// No interval: no other model from which to compute a spread.
    NoOtherModel,
    /// No interval: the error bars, whose model swaps it uses, have not been computed.
    BarsNotComputed,
    /// No interval: the schedule is not refitted for each model swap.
    ScheduleNotRefitted,
    /// No interval: the identified model's standard deviations do not extend to this frequency.
    DeviationsTooNarrow,
    /// No interval: the measured response has no standard deviations.
    MeasuredWithoutDeviations,
    /// No interval: the identified model has no standard deviations.
    ModelWithoutDeviations,
}

impl NoBandwidth {
    /// Returns the stable code, for programs and tests.
    pub fn code(&self) -> &'static str {
        match self {
            Self::NetGainNotPositive => "net-gain-not-positive",
            Self::NotCoupled => "not-coupled",
            Self::NoAttitudeResponse(_) => "no-attitude-response",
            Self::NoMetric(_) => "no-metric",
            Self::NoOtherModel => "no-other-model",
            Self::BarsNotComputed => "bars-not-computed",
            Self::ScheduleNotRefitted => "schedule-not-refitted",
            Self::DeviationsTooNarrow => "deviations-too-narrow",
            Self::MeasuredWithoutDeviations => "measured-without-deviations",
            Self::ModelWithoutDeviations => "model-without-deviations",
        }
    }
}

/// Writes the code, which the export replaces by a sentence.
impl Serialize for NoBandwidth {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.serialize_str(self.code())
    }
}

/// Export names of the values that [`metrics`] returns, in its order.
pub(super) const METRICS: [&str; 5] = [
    "omega_bw_rad_s",
    "omega_phase_rad_s",
    "omega_gain_rad_s",
    "omega_180_rad_s",
    "phase_delay_s",
];

/// Export name of the maximum phase deviation from a straight line.
const DEPARTURE: &str = "phase_departure_deg";

/// A response's metric values, in the order of [`METRICS`].
pub(super) type MetricValues = [Option<f64>; 5];

/// Returns a response's metrics, in the order of [`METRICS`].
pub(super) fn metrics(bandwidth: &Bandwidth) -> [Result<Metric, NoMetric>; 5] {
    [
        bandwidth.omega_bw,
        bandwidth.omega_phase,
        bandwidth.omega_gain,
        bandwidth.omega_180,
        bandwidth.phase_delay_s,
    ]
}

/// Returns a response's metric values, in the order of [`METRICS`].
pub(super) fn metric_values(bandwidth: &Bandwidth) -> MetricValues {
    metrics(bandwidth).map(|metric| Some(metric.ok()?.value))
}

impl BandwidthFinding {
    /// Returns the metrics and the maximum phase deviation, with their export names.
    pub fn quantities(&self) -> [(&'static str, Option<f64>); 6] {
        let [omega_bw, omega_phase, omega_gain, omega_180, phase_delay] = METRICS;
        [
            (omega_bw, self.omega_bw_rad_s),
            (omega_phase, self.omega_phase_rad_s),
            (omega_gain, self.omega_gain_rad_s),
            (omega_180, self.omega_180_rad_s),
            (phase_delay, self.phase_delay_s),
            (DEPARTURE, self.phase_departure_deg),
        ]
    }

    /// Returns the level that bandwidth and phase delay meet; `None` if either is missing, or if no
    /// boundary gives levels for the output.
    pub fn level(&self, levels: &LevelBoundaries) -> Option<AssessedLevel> {
        levels.level(&self.output, self.omega_bw_rad_s?, self.phase_delay_s?)
    }

    /// Returns whether a metric depends on the response above the band.
    pub fn rests_above(&self, name: &str) -> bool {
        self.rests_above_band.contains(&name)
    }

    /// Returns whether a metric depends on the response below the band.
    pub fn rests_below(&self, name: &str) -> bool {
        self.rests_below_band.contains(&name)
    }

    /// Stores a response's metrics, and the reasons for those that are missing.
    pub(super) fn store(&mut self, bandwidth: &Bandwidth) {
        let [omega_bw, omega_phase, omega_gain, omega_180, phase_delay] = metric_values(bandwidth);
        self.omega_bw_rad_s = omega_bw;
        self.omega_phase_rad_s = omega_phase;
        self.omega_gain_rad_s = omega_gain;
        self.omega_180_rad_s = omega_180;
        self.phase_delay_s = phase_delay;
        self.rule = bandwidth.rule;
        self.gain_limited = bandwidth.is_gain_limited();
        // Without a phase delay (for example because leads invalidate it), the line from which it
        // would be computed is not stored.
        if let (Some(line), Some(_)) = (bandwidth.phase_line, phase_delay) {
            self.phase_departure_deg = Some(line.departure_deg);
            self.phase_delay_of_line = !line.is_straight();
        }
        for (name, metric) in METRICS.into_iter().zip(metrics(bandwidth)) {
            match metric {
                Ok(metric) => {
                    if metric.rests_above_band {
                        self.rests_above_band.push(name);
                    }
                    if metric.rests_below_band {
                        self.rests_below_band.push(name);
                    }
                }
                Err(why) => {
                    self.absent.insert(name, NoBandwidth::NoMetric(why));
                }
            }
        }
        if let Err(why) = bandwidth.phase_delay_s {
            self.absent.insert(DEPARTURE, NoBandwidth::NoMetric(why));
        }
    }

    /// Adds intervals from standard deviations, by the normal distribution; the lower end is at
    /// least zero.
    pub(super) fn add_deviation_intervals(&mut self, bandwidth: &Bandwidth, level: f64) {
        let factor = student_quantile(level, f64::INFINITY);
        for (name, metric) in METRICS.into_iter().zip(metrics(bandwidth)) {
            if let Ok(Metric {
                value,
                deviation: Some(deviation),
                ..
            }) = metric
            {
                let half = factor * deviation;
                self.interval
                    .insert(name, [(value - half).max(0.0), value + half]);
            }
        }
    }
}
