//! Bandwidth and phase delay of an attitude response (M17.1).
//!
//! ```text
//! 1  Theta = H/(j omega) of a rate, H of an attitude; phase continuous, in (-270, 90] deg at the lowest frequency of the band
//! 2  omega_180, omega_phase: the lowest omega from the band's lower end on at which it falls through -180, -135 deg;
//!    where it is below that at the band's lowest frequency, the next one below the band, and only without one the first within
//! 3  omega_gain: the greatest omega < omega_180 at which |Theta| = 10^(6/20) |Theta(omega_180)|
//! 4  omega_BW = min(omega_phase, omega_gain) of a rate response; omega_phase of attitude command
//! 5  Phi at 400 logarithmic points of omega_180 ... 2 omega_180; its largest departure from the line between its ends
//! 6  up to 10 deg: tau_p = -(Phi(2 omega_180) + pi) / (2 omega_180)
//! 7  above: least-squares line of Phi over omega; tau_p = what it loses from omega_180 to 2 omega_180, over 2 omega_180
//! ```
//!
//! ADS-33E-PRF, "Handling qualities requirements for military rotorcraft", 2000, 3.3.2.1 and figure 4; MIL-DTL-32742.

use std::f64::consts::PI;

use serde::{Deserialize, Serialize};

use super::{AttitudeResponse, ResponseDeviation};
use crate::dataset::Band;
use crate::response::log_spaced;
use crate::units::number;

/// Relative width of the bracket of a crossing at which the search ends.
const ROOT_TOLERANCE: f64 = 1e-12;
/// Margin of `omega_gain` \[dB\].
const GAIN_MARGIN_DB: f64 = 6.0;
/// Phase of `omega_180` \[deg\].
const NEUTRAL_DEG: f64 = -180.0;
/// Phase of `omega_phase` \[deg\]: a margin of 45 deg.
const PHASE_MARGIN_DEG: f64 = -135.0;
/// Points on which the phase between `omega_180` and `2 omega_180` is judged.
const LINE_POINTS: usize = 400;
/// Departure \[deg\] from its chord up to which the phase is straight.
const STRAIGHT_DEG: f64 = 10.0;

/// How an axis answers to its stick.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum CommandType {
    /// The stick commands a rate.
    #[default]
    Rate,
    /// The stick commands an attitude (attitude command, attitude hold).
    Attitude,
}

/// What becomes of numbers that rest on a response above the band that was identified.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum AboveBand {
    /// They are given, and said to rest on the model.
    #[default]
    Marked,
    /// They are refused: lead filters are no model of the aircraft there (M15).
    Refused,
}

/// What a bandwidth is asked with.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BandwidthSettings {
    /// How the axis answers.
    pub command: CommandType,
    /// The identified band, or that of the measured response \[rad/s\].
    pub band: Band,
    /// What becomes of numbers above it.
    pub above_band: AboveBand,
}

/// A number of a response, how sure it is, and what it rests on.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Metric {
    /// The number: \[rad/s\] or \[s\].
    pub value: f64,
    /// Its standard deviation to first order, of the band that the response carries (M14); none where it carries none there.
    pub deviation: Option<f64>,
    /// The lowest and the highest frequency \[rad/s\] that it was read from.
    pub read_at: [f64; 2],
    /// Whether it rests on the model above the band.
    pub rests_above_band: bool,
    /// Whether it rests on the model below the band.
    pub rests_below_band: bool,
}

/// Why a response lacks a number.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum NoMetric {
    /// The phase falls through the level nowhere.
    #[error("no crossing of {} deg up to {} rad/s", number(*level_deg), number(*up_to))]
    NoCrossing {
        /// The phase that is asked for \[deg\].
        level_deg: f64,
        /// Highest frequency searched \[rad/s\].
        up_to: f64,
    },
    /// The phase is below the level at the lowest frequency of the band, and falls through it nowhere below.
    #[error("no crossing of {} deg: the phase is below it from {from:.3} rad/s on", number(*level_deg))]
    BelowFromStart {
        /// The phase that is asked for \[deg\].
        level_deg: f64,
        /// Lowest frequency of the band \[rad/s\].
        from: f64,
    },
    /// Nowhere below `omega_180` is the magnitude 6 dB above that at `omega_180`.
    #[error("no crossing of 6 dB above the magnitude at {omega_180:.3} rad/s down to {} rad/s", number(*down_to))]
    NoGainCrossing {
        /// Frequency of -180 deg \[rad/s\].
        omega_180: f64,
        /// Lowest frequency searched \[rad/s\].
        down_to: f64,
    },
    /// The response ends before a frequency that the number needs.
    #[error("the response has no value at {needed:.3} rad/s, twice the frequency of -180 deg")]
    ResponseEnds {
        /// `2 omega_180` \[rad/s\].
        needed: f64,
    },
    /// The number rests on lead filters above the band.
    #[error("rests on the leads above the band: {needed:.3} rad/s, beyond {} rad/s", number(*top))]
    AboveBand {
        /// Highest frequency that it needs \[rad/s\].
        needed: f64,
        /// Top of the band, `omega_B` \[rad/s\].
        top: f64,
    },
}

/// Which margin is the bandwidth.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum BandwidthRule {
    /// The phase margin of 45 deg.
    Phase,
    /// The gain margin of 6 dB: it comes first.
    Gain,
    /// The phase margin, the gain margin not being known: the bandwidth is at most this.
    PhaseGainUnknown,
}

/// The phase from `omega_180` to `2 omega_180`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PhaseLine {
    /// Largest departure from the line between its ends \[deg\].
    pub departure_deg: f64,
    /// `-(Phi(2 omega_180) + pi) / (2 omega_180)` \[s\].
    pub two_points_s: f64,
    /// Half the slope of the least-squares line, with its sign changed \[s\].
    pub least_squares_s: f64,
}

impl PhaseLine {
    /// Whether the two points say it all: the departure is at most 10 deg.
    pub fn is_straight(&self) -> bool {
        self.departure_deg <= STRAIGHT_DEG
    }

    /// The phase delay \[s\]: of the two points where the phase is straight, else of the line.
    pub fn phase_delay_s(&self) -> f64 {
        if self.is_straight() { self.two_points_s } else { self.least_squares_s }
    }
}

/// Bandwidth and phase delay of one response (M17.1; ADS-33E-PRF 3.3.2.1).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bandwidth {
    /// Frequency of -180 deg \[rad/s\].
    pub omega_180: Result<Metric, NoMetric>,
    /// Frequency of -135 deg \[rad/s\].
    pub omega_phase: Result<Metric, NoMetric>,
    /// Frequency of 6 dB of gain margin \[rad/s\].
    pub omega_gain: Result<Metric, NoMetric>,
    /// The bandwidth \[rad/s\].
    pub omega_bw: Result<Metric, NoMetric>,
    /// Which margin it is; none where there is no bandwidth.
    pub rule: Option<BandwidthRule>,
    /// Phase delay \[s\].
    pub phase_delay_s: Result<Metric, NoMetric>,
    /// The phase that it was read from; none where there is no phase delay.
    pub phase_line: Option<PhaseLine>,
}

impl Bandwidth {
    /// Bandwidth and phase delay of `attitude`, with standard deviations where it carries some.
    pub fn of(
        attitude: &AttitudeResponse<'_>,
        settings: &BandwidthSettings,
        deviation: Option<&dyn ResponseDeviation>,
    ) -> Self {
        let reading = Reading { attitude, settings, deviation };
        let omega_180 = reading.phase_crossing(NEUTRAL_DEG);
        let omega_phase = reading.phase_crossing(PHASE_MARGIN_DEG);
        let omega_gain = omega_180.and_then(|omega_180| reading.gain_crossing(omega_180));
        let (omega_bw, rule) = reading.bandwidth(omega_phase, omega_gain, omega_180);
        let phase_delay = omega_180.and_then(|omega_180| reading.phase_delay(omega_180));
        Self {
            omega_180,
            omega_phase,
            omega_gain,
            omega_bw,
            rule,
            phase_delay_s: phase_delay.map(|(metric, _)| metric),
            phase_line: phase_delay.ok().map(|(_, line)| line),
        }
    }

    /// Whether the gain margin comes before the phase margin: the standard warns of it, whatever the bandwidth is.
    pub fn is_gain_limited(&self) -> bool {
        matches!((&self.omega_gain, &self.omega_phase), (Ok(gain), Ok(phase)) if gain.value < phase.value)
    }
}

/// A response, and what is asked of it.
struct Reading<'a> {
    attitude: &'a AttitudeResponse<'a>,
    settings: &'a BandwidthSettings,
    deviation: Option<&'a dyn ResponseDeviation>,
}

impl Reading<'_> {
    /// A number read from these frequencies, or why there is none.
    fn metric(&self, value: f64, read_at: [f64; 2], deviation: Option<f64>) -> Result<Metric, NoMetric> {
        let (band, [lowest, highest]) = (self.settings.band, read_at);
        let rests_above_band = highest > band.max();
        if rests_above_band && self.settings.above_band == AboveBand::Refused {
            return Err(NoMetric::AboveBand { needed: highest, top: band.max() });
        }
        let deviation = deviation.filter(|deviation| deviation.is_finite());
        Ok(Metric { value, deviation, read_at, rests_above_band, rests_below_band: lowest < band.min() })
    }

    /// The frequency at which the phase falls through a level: of the band the lowest, unless it has fallen through below and stayed there.
    fn phase_crossing(&self, level_deg: f64) -> Result<Metric, NoMetric> {
        let (omega, phase, level) = (self.attitude.omega(), self.attitude.phase(), level_deg.to_radians());
        let falls = |k: &usize| phase[*k] > level && phase[k + 1] <= level;
        let (first, last) = (self.attitude.lowest_of_band(), phase.len() - 1);
        let is_below = phase[first] <= level;
        let below = (0..first).rev().find(|k| is_below && falls(k));
        let Some(k) = below.or_else(|| (first..last).find(falls)) else {
            return Err(if is_below {
                NoMetric::BelowFromStart { level_deg, from: omega[first] }
            } else {
                NoMetric::NoCrossing { level_deg, up_to: omega[last] }
            });
        };
        let root =
            root_between([omega[k], omega[k + 1]], |omega| self.attitude.phase_at(omega).map(|phase| level - phase));
        self.metric(root, [root, root], self.deviation.and_then(|of| of.of_phase_crossing(self.attitude, root)))
    }

    /// The greatest frequency below `omega_180` at which the magnitude is 6 dB above that at `omega_180`.
    fn gain_crossing(&self, omega_180: Metric) -> Result<Metric, NoMetric> {
        let (grid, top) = (self.attitude.omega(), omega_180.value);
        let none = NoMetric::NoGainCrossing { omega_180: top, down_to: self.attitude.range()[0] };
        let level = self.attitude.magnitude_db_at(top).ok_or(none)? + GAIN_MARGIN_DB;
        let below = grid.partition_point(|omega| *omega < top);
        let is_above = |k: usize| self.attitude.magnitude_db()[k] >= level;
        // The magnitude at omega_180 itself is below the level: the first grid point above it, from the top, brackets the crossing.
        let k = (0..below).rev().find(|&k| is_above(k)).ok_or(none)?;
        let upper = if k + 1 < below { grid[k + 1] } else { top };
        let excess = |omega: f64| self.attitude.magnitude_db_at(omega).map(|magnitude| level - magnitude);
        let root = root_between([grid[k], upper], excess);
        self.metric(root, [root, top], self.deviation.and_then(|of| of.of_gain_crossing(self.attitude, root, top)))
    }

    /// The bandwidth, and which margin it is.
    fn bandwidth(
        &self,
        phase: Result<Metric, NoMetric>,
        gain: Result<Metric, NoMetric>,
        omega_180: Result<Metric, NoMetric>,
    ) -> (Result<Metric, NoMetric>, Option<BandwidthRule>) {
        let (bandwidth, rule) = match (self.settings.command, phase, gain) {
            (_, Err(why), _) => (Err(why), None),
            (CommandType::Attitude, phase, _) => (phase, Some(BandwidthRule::Phase)),
            (CommandType::Rate, Ok(phase), Ok(gain)) => {
                let (least, rule) =
                    if gain.value < phase.value { (gain, BandwidthRule::Gain) } else { (phase, BandwidthRule::Phase) };
                // That the other margin comes later was read from its frequencies too.
                let read_at = [phase.read_at[0].min(gain.read_at[0]), gain.read_at[1]];
                (self.metric(least.value, read_at, least.deviation), Some(rule))
            }
            (CommandType::Rate, Ok(phase), Err(why)) => match omega_180 {
                // The gain margin is 6 dB nowhere above the lowest frequency, so the bandwidth lies below it.
                Ok(_) => (Err(why), None),
                Err(_) => (Ok(phase), Some(BandwidthRule::PhaseGainUnknown)),
            },
        };
        (bandwidth, rule.filter(|_| bandwidth.is_ok()))
    }

    /// The phase delay, and the phase that it is read from.
    fn phase_delay(&self, omega_180: Metric) -> Result<(Metric, PhaseLine), NoMetric> {
        let (from, to) = (omega_180.value, 2.0 * omega_180.value);
        let omega = log_spaced(from, to, LINE_POINTS);
        let phase = self.attitude.phases_from(-PI, &omega).ok_or(NoMetric::ResponseEnds { needed: to })?;
        let line = PhaseLine {
            departure_deg: chord_departure(&omega, &phase).to_degrees(),
            two_points_s: -(phase[LINE_POINTS - 1] + PI) / to,
            least_squares_s: -0.5 * slope(&omega, &phase),
        };
        let deviation = self.deviation.and_then(|of| of.of_phase_delay(from));
        Ok((self.metric(line.phase_delay_s(), [from, to], deviation)?, line))
    }
}

/// The root of `value` between two frequencies, positive at the upper and not at the lower.
///
/// ```text
/// 1  [a, b] brackets the root, a the newest point; c is the point given up last
/// 2  inverse quadratic interpolation through a, b, c where these are monotonic, else the middle
/// 3  no step closer to an end than the tolerance, so that both ends close in
/// ```
///
/// T. R. Chandrupatla, "A new hybrid quadratic/bisection algorithm for finding the zero of a nonlinear function without using
/// derivatives", *Advances in Engineering Software* 28, 1997.
fn root_between([low, high]: [f64; 2], value: impl Fn(f64) -> Option<f64>) -> f64 {
    // Where there is no value, the root is taken to lie above.
    let sided = |omega: f64| value(omega).filter(|value| !value.is_nan()).unwrap_or(-1.0);
    let (mut a, mut b) = ((high, sided(high)), (low, sided(low)));
    let mut part = 0.5;
    loop {
        let at = a.0 + part * (b.0 - a.0);
        let new = (at, sided(at));
        let c = if (new.1 > 0.0) == (a.1 > 0.0) { a } else { std::mem::replace(&mut b, a) };
        a = new;
        let best = if a.1.abs() < b.1.abs() { a } else { b };
        let least = ROOT_TOLERANCE * best.0 / (b.0 - a.0).abs();
        if least > 0.5 || best.1 == 0.0 || !least.is_finite() {
            return best.0;
        }
        let (xi, phi) = ((a.0 - b.0) / (c.0 - b.0), (a.1 - b.1) / (c.1 - b.1));
        let is_monotonic = phi.powi(2) < xi && (1.0 - phi).powi(2) < 1.0 - xi;
        let quadratic =
            a.1 / (b.1 - a.1) * c.1 / (b.1 - c.1) + (c.0 - a.0) / (b.0 - a.0) * a.1 / (c.1 - a.1) * b.1 / (c.1 - b.1);
        part = if is_monotonic { quadratic.clamp(least, 1.0 - least) } else { 0.5 };
    }
}

/// The largest distance \[rad\] of a phase from the line between its ends.
fn chord_departure(omega: &[f64], phase: &[f64]) -> f64 {
    let last = omega.len() - 1;
    let slope = (phase[last] - phase[0]) / (omega[last] - omega[0]);
    let departure = |(omega_k, phase_k): (&f64, &f64)| (phase_k - phase[0] - slope * (omega_k - omega[0])).abs();
    omega.iter().zip(phase).map(departure).fold(0.0, f64::max)
}

/// The slope \[s\] of the least-squares line of `phase` over `omega`.
fn slope(omega: &[f64], phase: &[f64]) -> f64 {
    let mean = |values: &[f64]| values.iter().sum::<f64>() / values.len() as f64;
    let (centre, level) = (mean(omega), mean(phase));
    let product: f64 = omega.iter().zip(phase).map(|(omega, phase)| (omega - centre) * (phase - level)).sum();
    product / omega.iter().map(|omega| (omega - centre).powi(2)).sum::<f64>()
}
