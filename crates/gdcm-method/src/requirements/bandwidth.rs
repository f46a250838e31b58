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
//! ADS-33E-PRF, "Handling qualities requirements for military rotorcraft", 2000, 3.3.2.1 and figure
//! 4; MIL-DTL-32742.
//!
//! Uncertainty of bandwidth and phase delay (M17.1): to first order from the standard deviations of
//! a response (M14), or from the other models of the bundles (M13).
//!
//! ```text
//! phase crossing:  sd = sd_phase / |d phase / d omega|
//! gain crossing:   sd^2 = (sd_dB(omega_gain)^2 + sd_dB(omega_180)^2 + (m'(omega_180) sd(omega_180))^2) / m'(omega_gain)^2,  m in dB
//! phase delay:     sd = sqrt(sd_phase(omega_180)^2 + sd_phase(2 omega_180)^2) / (2 omega_180)
//! ```
//!
//! Errors at distant frequencies are taken as independent, errors at neighbouring frequencies are
//! not: a phase delay read from the least-squares line also has the deviation of its two ends,
//! because independent errors along the line would make it arbitrarily small with the number of
//! points.

use std::f64::consts::PI;

use serde::{Deserialize, Serialize};

use gdcm_model::dataset::model::ModelBands;
use gdcm_model::dataset::{Band, Pair};
use gdcm_model::response::curve_values::between;
use gdcm_model::response::frequency_response::log_spaced;
use gdcm_model::statistics::mean;
use gdcm_model::units::number;

use super::attitude_response::AttitudeResponse;
use crate::uncertainty::{Bar, IdentificationSource, VarianceComponent};

/// Relative width of the bracket of a crossing at which the search ends.
const ROOT_TOLERANCE: f64 = 1e-12;
/// Margin of `omega_gain` \[dB\].
const GAIN_MARGIN_DB: f64 = 6.0;
/// Phase of `omega_180` \[deg\].
const NEUTRAL_DEG: f64 = -180.0;
/// Phase of `omega_phase` \[deg\]: a margin of 45 deg.
const PHASE_MARGIN_DEG: f64 = -135.0;
/// Points used to judge the phase between `omega_180` and `2 omega_180`.
const LINE_POINTS: usize = 400;
/// Departure \[deg\] from its chord up to which the phase counts as straight.
const STRAIGHT_DEG: f64 = 10.0;

/// Response type of an axis to its inceptor.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum CommandType {
    /// The inceptor commands a rate.
    #[default]
    Rate,
    /// The inceptor commands an attitude (attitude command, attitude hold).
    Attitude,
}

/// Treatment of values that rest on a response above the identified band.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum AboveBand {
    /// Returned, and marked as resting on the model.
    #[default]
    Marked,
    /// Refused: lead filters do not represent the aircraft there (M15).
    Refused,
}

/// Settings of the bandwidth evaluation.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BandwidthSettings {
    pub command: CommandType,
    /// The identified band, or the band of the measured response \[rad/s\].
    pub band: Band,
    /// Treatment of values above it.
    pub above_band: AboveBand,
}

/// A value read from a response, with its uncertainty and the frequencies that it rests on.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Metric {
    /// The value: \[rad/s\] or \[s\].
    pub value: f64,
    /// Standard deviation to first order, from the band of the response (M14); `None` without a
    /// band there.
    pub deviation: Option<f64>,
    /// Lowest and highest frequency \[rad/s\] that the value was read from.
    pub read_at: [f64; 2],
    /// Whether the value rests on the model above the band.
    pub rests_above_band: bool,
    /// Whether the value rests on the model below the band.
    pub rests_below_band: bool,
}

/// Reasons for a missing value.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum NoMetric {
    /// The phase never falls through the level.
    #[error("no crossing of {} deg up to {} rad/s", number(*level_deg), number(*up_to))]
    NoCrossing {
        /// The requested phase \[deg\].
        level_deg: f64,
        /// Highest frequency searched \[rad/s\].
        up_to: f64,
    },
    /// The phase is below the level at the lowest frequency of the band, and never falls through it
    /// below the band.
    #[error("no crossing of {} deg: the phase is below it from {from:.3} rad/s on", number(*level_deg))]
    BelowFromStart {
        /// The requested phase \[deg\].
        level_deg: f64,
        /// Lowest frequency of the band \[rad/s\].
        from: f64,
    },
    /// The magnitude nowhere below `omega_180` exceeds that at `omega_180` by 6 dB.
    #[error("no crossing of 6 dB above the magnitude at {omega_180:.3} rad/s down to {} rad/s", number(*down_to))]
    NoGainCrossing {
        /// Frequency of -180 deg \[rad/s\].
        omega_180: f64,
        /// Lowest frequency searched \[rad/s\].
        down_to: f64,
    },
    /// The response ends before a frequency that the value needs.
    #[error("the response has no value at {needed:.3} rad/s, twice the frequency of -180 deg")]
    ResponseEnds {
        /// `2 omega_180` \[rad/s\].
        needed: f64,
    },
    /// The value rests on lead filters above the band.
    #[error("rests on the leads above the band: {needed:.3} rad/s, beyond {} rad/s", number(*top))]
    AboveBand {
        /// Highest frequency that the value needs \[rad/s\].
        needed: f64,
        /// Upper end of the band, `omega_B` \[rad/s\].
        top: f64,
    },
}

/// The margin that sets the bandwidth.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum BandwidthRule {
    /// The phase margin of 45 deg.
    Phase,
    /// The gain margin of 6 dB, which occurs first.
    Gain,
    /// The phase margin, with an unknown gain margin: an upper bound of the bandwidth.
    PhaseGainUnknown,
}

/// The phase from `omega_180` to `2 omega_180`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PhaseLine {
    /// Largest departure from the line between its ends \[deg\].
    pub departure_deg: f64,
    /// `-(Phi(2 omega_180) + pi) / (2 omega_180)` \[s\].
    pub two_points_s: f64,
    /// Half the negative slope of the least-squares line \[s\].
    pub least_squares_s: f64,
}

impl PhaseLine {
    /// Whether the two points suffice: the departure is at most 10 deg.
    pub fn is_straight(&self) -> bool {
        self.departure_deg <= STRAIGHT_DEG
    }

    /// Returns the phase delay \[s\]: from the two points if the phase is straight, otherwise from
    /// the least-squares line.
    pub fn phase_delay_s(&self) -> f64 {
        if self.is_straight() {
            self.two_points_s
        } else {
            self.least_squares_s
        }
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
    /// The margin that sets the bandwidth; `None` without a bandwidth.
    pub rule: Option<BandwidthRule>,
    /// Phase delay \[s\].
    pub phase_delay_s: Result<Metric, NoMetric>,
    /// The phase data behind it; `None` without a phase delay.
    pub phase_line: Option<PhaseLine>,
}

impl Bandwidth {
    /// Computes bandwidth and phase delay of `attitude`, with standard deviations where its band is
    /// known.
    pub fn of(
        attitude: &AttitudeResponse<'_>,
        settings: &BandwidthSettings,
        deviation: Option<PairBand<'_>>,
    ) -> Self {
        let reading = Reading {
            attitude,
            settings,
            deviation,
        };
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

    /// Whether the gain margin occurs before the phase margin: the standard warns about it for
    /// every response type.
    pub fn is_gain_limited(&self) -> bool {
        matches!((&self.omega_gain, &self.omega_phase), (Ok(gain), Ok(phase)) if gain.value < phase.value)
    }
}

/// A response with the settings of its evaluation.
struct Reading<'a> {
    attitude: &'a AttitudeResponse<'a>,
    settings: &'a BandwidthSettings,
    deviation: Option<PairBand<'a>>,
}

impl Reading<'_> {
    /// Returns the value read from these frequencies, or the reason why it is unavailable.
    fn metric(
        &self,
        value: f64,
        read_at: [f64; 2],
        deviation: Option<f64>,
    ) -> Result<Metric, NoMetric> {
        let band = self.settings.band;
        let [lowest, highest] = read_at;
        let rests_above_band = highest > band.max();
        if rests_above_band && self.settings.above_band == AboveBand::Refused {
            return Err(NoMetric::AboveBand {
                needed: highest,
                top: band.max(),
            });
        }
        let deviation = deviation.filter(|deviation| deviation.is_finite());
        Ok(Metric {
            value,
            deviation,
            read_at,
            rests_above_band,
            rests_below_band: lowest < band.min(),
        })
    }

    /// Returns the frequency at which the phase falls through a level: the lowest in the band,
    /// unless the phase has fallen through below the band and stayed there.
    fn phase_crossing(&self, level_deg: f64) -> Result<Metric, NoMetric> {
        let omega = &self.attitude.omega;
        let phase = &self.attitude.phase;
        let level = level_deg.to_radians();
        let falls = |k: &usize| phase[*k] > level && phase[k + 1] <= level;
        let first = self.attitude.lowest_of_band;
        let last = phase.len() - 1;
        let is_below = phase[first] <= level;
        let below = (0..first).rev().find(|k| is_below && falls(k));
        let Some(k) = below.or_else(|| (first..last).find(falls)) else {
            return Err(if is_below {
                NoMetric::BelowFromStart {
                    level_deg,
                    from: omega[first],
                }
            } else {
                NoMetric::NoCrossing {
                    level_deg,
                    up_to: omega[last],
                }
            });
        };
        let root = root_between([omega[k], omega[k + 1]], |omega| {
            self.attitude.phase_at(omega).map(|phase| level - phase)
        });
        self.metric(
            root,
            [root, root],
            self.deviation
                .and_then(|of| of.of_phase_crossing(self.attitude, root)),
        )
    }

    /// Returns the highest frequency below `omega_180` at which the magnitude exceeds that at
    /// `omega_180` by 6 dB.
    fn gain_crossing(&self, omega_180: Metric) -> Result<Metric, NoMetric> {
        let grid = &self.attitude.omega;
        let top = omega_180.value;
        let none = NoMetric::NoGainCrossing {
            omega_180: top,
            down_to: self.attitude.omega[0],
        };
        let level = self.attitude.magnitude_db_at(top).ok_or(none)? + GAIN_MARGIN_DB;
        let below = grid.partition_point(|omega| *omega < top);
        let is_above = |k: usize| self.attitude.magnitude_db[k] >= level;
        // The magnitude at omega_180 itself is below the level: the first grid point above the
        // level, counted from the top, brackets the crossing.
        let k = (0..below).rev().find(|&k| is_above(k)).ok_or(none)?;
        let upper = if k + 1 < below { grid[k + 1] } else { top };
        let excess = |omega: f64| {
            self.attitude
                .magnitude_db_at(omega)
                .map(|magnitude| level - magnitude)
        };
        let root = root_between([grid[k], upper], excess);
        self.metric(
            root,
            [root, top],
            self.deviation
                .and_then(|of| of.of_gain_crossing(self.attitude, root, top)),
        )
    }

    /// Returns the bandwidth and the margin that sets it.
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
                let (least, rule) = if gain.value < phase.value {
                    (gain, BandwidthRule::Gain)
                } else {
                    (phase, BandwidthRule::Phase)
                };
                // The comparison with the other margin also used its frequencies.
                let read_at = [phase.read_at[0].min(gain.read_at[0]), gain.read_at[1]];
                (
                    self.metric(least.value, read_at, least.deviation),
                    Some(rule),
                )
            }
            (CommandType::Rate, Ok(phase), Err(why)) => match omega_180 {
                // No 6 dB gain margin exists above the lowest frequency, so the bandwidth lies
                // below it.
                Ok(_) => (Err(why), None),
                Err(_) => (Ok(phase), Some(BandwidthRule::PhaseGainUnknown)),
            },
        };
        (bandwidth, rule.filter(|_| bandwidth.is_ok()))
    }

    /// Returns the phase delay and the phase data behind it.
    fn phase_delay(&self, omega_180: Metric) -> Result<(Metric, PhaseLine), NoMetric> {
        let from = omega_180.value;
        let to = 2.0 * omega_180.value;
        let omega = log_spaced(from, to, LINE_POINTS);
        let phase = self
            .attitude
            .phases_from(-PI, &omega)
            .ok_or(NoMetric::ResponseEnds { needed: to })?;
        let line = PhaseLine {
            departure_deg: chord_departure(&omega, &phase).to_degrees(),
            two_points_s: -(phase[LINE_POINTS - 1] + PI) / to,
            least_squares_s: -0.5 * slope(&omega, &phase),
        };
        let deviation = self.deviation.and_then(|of| of.of_phase_delay(from));
        Ok((
            self.metric(line.phase_delay_s(), [from, to], deviation)?,
            line,
        ))
    }
}

/// Finds the root of `value` between two frequencies, positive at the upper and not at the lower.
///
/// ```text
/// 1  [a, b] brackets the root, a the newest point; c is the point given up last
/// 2  inverse quadratic interpolation through a, b, c where these are monotonic, else the middle
/// 3  no step closer to an end than the tolerance, so that both ends close in
/// ```
///
/// T. R. Chandrupatla, "A new hybrid quadratic/bisection algorithm for finding the zero of a
/// nonlinear function without using derivatives", *Advances in Engineering Software* 28, 1997.
fn root_between([low, high]: [f64; 2], value: impl Fn(f64) -> Option<f64>) -> f64 {
    // A missing value is treated as negative: the root then lies above.
    let sided = |omega: f64| value(omega).filter(|value| !value.is_nan()).unwrap_or(-1.0);
    let mut a = (high, sided(high));
    let mut b = (low, sided(low));
    let mut part = 0.5;
    loop {
        let at = a.0 + part * (b.0 - a.0);
        let new = (at, sided(at));
        let c = if (new.1 > 0.0) == (a.1 > 0.0) {
            a
        } else {
            std::mem::replace(&mut b, a)
        };
        a = new;
        let best = if a.1.abs() < b.1.abs() { a } else { b };
        let least = ROOT_TOLERANCE * best.0 / (b.0 - a.0).abs();
        if least > 0.5 || best.1 == 0.0 || !least.is_finite() {
            return best.0;
        }
        let xi = (a.0 - b.0) / (c.0 - b.0);
        let phi = (a.1 - b.1) / (c.1 - b.1);
        let is_monotonic = phi.powi(2) < xi && (1.0 - phi).powi(2) < 1.0 - xi;
        let quadratic = a.1 / (b.1 - a.1) * c.1 / (b.1 - c.1)
            + (c.0 - a.0) / (b.0 - a.0) * a.1 / (c.1 - a.1) * b.1 / (c.1 - b.1);
        part = if is_monotonic {
            quadratic.clamp(least, 1.0 - least)
        } else {
            0.5
        };
    }
}

/// Returns the largest distance \[rad\] of a phase from the line between its ends.
fn chord_departure(omega: &[f64], phase: &[f64]) -> f64 {
    let last = omega.len() - 1;
    let slope = (phase[last] - phase[0]) / (omega[last] - omega[0]);
    let departure = |(omega_k, phase_k): (&f64, &f64)| {
        (phase_k - phase[0] - slope * (omega_k - omega[0])).abs()
    };
    omega.iter().zip(phase).map(departure).fold(0.0, f64::max)
}

/// Returns the slope \[s\] of the least-squares line of `phase` over `omega`.
fn slope(omega: &[f64], phase: &[f64]) -> f64 {
    let centre = mean(omega);
    let level = mean(phase);
    let product: f64 = omega
        .iter()
        .zip(phase)
        .map(|(omega, phase)| (omega - centre) * (phase - level))
        .sum();
    product
        / omega
            .iter()
            .map(|omega| (omega - centre).powi(2))
            .sum::<f64>()
}

/// Half the step of a difference quotient, relative to the frequency.
const HALF_STEP: f64 = 1e-4;

/// The band of one response of an identified model, linear in log omega and undefined outside its
/// frequencies (M14); the source of standard deviations for values read from the response.
#[derive(Clone, Copy, Debug)]
pub struct PairBand<'a> {
    pub bands: &'a ModelBands,
    pub pair: Pair,
}

impl PairBand<'_> {
    /// Returns the standard deviation of the magnitude \[dB\] at `omega` \[rad/s\].
    fn magnitude_db(&self, omega: f64) -> Option<f64> {
        between(
            self.bands.omega(),
            self.bands.sd_db().get(self.pair)?,
            omega,
        )
    }

    /// Returns the standard deviation of the phase \[rad\] at `omega` \[rad/s\].
    fn phase(&self, omega: f64) -> Option<f64> {
        between(
            self.bands.omega(),
            self.bands.sd_deg().get(self.pair)?,
            omega,
        )
        .map(f64::to_radians)
    }

    /// Returns the standard deviation of a frequency \[rad/s\] at which the phase crosses a level.
    fn of_phase_crossing(&self, attitude: &AttitudeResponse<'_>, omega: f64) -> Option<f64> {
        let slope = difference_quotient(omega, |omega| attitude.phase_at(omega))?;
        Some(self.phase(omega)? / slope.abs())
    }

    /// Returns the standard deviation of the frequency \[rad/s\] at which the magnitude exceeds
    /// that at `omega_180` by 6 dB.
    fn of_gain_crossing(
        &self,
        attitude: &AttitudeResponse<'_>,
        omega: f64,
        omega_180: f64,
    ) -> Option<f64> {
        let slope =
            |omega: f64| difference_quotient(omega, |omega| attitude.magnitude_db_at(omega));
        let moved = slope(omega_180)? * self.of_phase_crossing(attitude, omega_180)?;
        let level = self
            .magnitude_db(omega)?
            .hypot(self.magnitude_db(omega_180)?)
            .hypot(moved);
        Some(level / slope(omega)?.abs())
    }

    /// Returns the standard deviation of the phase delay \[s\].
    fn of_phase_delay(&self, omega_180: f64) -> Option<f64> {
        let twice = 2.0 * omega_180;
        Some(self.phase(omega_180)?.hypot(self.phase(twice)?) / twice)
    }
}

fn difference_quotient(omega: f64, value: impl Fn(f64) -> Option<f64>) -> Option<f64> {
    let low = omega * (1.0 - HALF_STEP);
    let high = omega * (1.0 + HALF_STEP);
    let slope = (value(high)? - value(low)?) / (high - low);
    (slope != 0.0).then_some(slope)
}

/// Computes the error bar of a value of the representatives from its values with each other physics
/// model and each other identified model substituted (M13.1, M13.3); `None` entries are swapped
/// pairs without the value. The value is not negative.
pub fn substitution_bar(value: f64, physics: &[Option<f64>], identified: &[Option<f64>]) -> Bar {
    let part = |others: &[Option<f64>]| {
        let changes: Vec<f64> = others.iter().flatten().map(|other| other - value).collect();
        VarianceComponent::of_changes(&changes)
    };
    Bar {
        value,
        trim: part(physics),
        identification: part(identified),
        source: IdentificationSource::Spread,
        left_out: physics
            .iter()
            .chain(identified)
            .filter(|other| other.is_none())
            .count(),
        range: [0.0, f64::INFINITY],
    }
}

#[cfg(test)]
mod tests {
    use nalgebra::{Complex, dmatrix};
    use proptest::prelude::*;

    use gdcm_model::dataset::measured_response::MeasuredResponse;
    use gdcm_model::dataset::state_space::Timing;
    use gdcm_model::dataset::{Channel, Dynamics, PairTable, StateSpace};
    use gdcm_model::response::GainDelay;

    use super::*;
    use crate::requirements::attitude_response::{ResponseAt, SampledModel, search_frequencies};
    use crate::requirements::known_answers::{answers, attitudes, number};
    use crate::requirements::*;

    const ONLY: Pair = Pair {
        output: 0,
        input: 0,
    };

    fn band() -> Band {
        Band::new(0.5, 12.0).unwrap()
    }

    fn settings(command: CommandType) -> BandwidthSettings {
        BandwidthSettings {
            command,
            band: band(),
            above_band: AboveBand::Marked,
        }
    }

    /// Evaluates a rate response, `s` times the given attitude.
    fn of_attitude(
        attitude: impl Fn(Complex<f64>) -> Complex<f64>,
        settings: &BandwidthSettings,
    ) -> Bandwidth {
        let rate = |omega: &[f64]| -> Vec<Complex<f64>> {
            omega
                .iter()
                .map(|omega| Complex::new(0.0, *omega))
                .map(|s| s * attitude(s))
                .collect()
        };
        let frequencies = search_frequencies(settings.band);
        Bandwidth::of(
            &AttitudeResponse::new(&rate, AttitudeOutput::Rate, &frequencies, settings.band)
                .unwrap(),
            settings,
            None,
        )
    }

    fn value(metric: Result<Metric, NoMetric>) -> f64 {
        metric.unwrap().value
    }

    #[test]
    fn bandwidths_and_phase_delays_are_the_known_ones() {
        let answers = answers();
        for (case, attitude) in answers["bandwidth"]
            .as_array()
            .unwrap()
            .iter()
            .zip(attitudes())
        {
            let found = of_attitude(attitude, &settings(CommandType::Rate));
            let line = found.phase_line.unwrap();
            for (found, name) in [
                (value(found.omega_180), "omega_180"),
                (value(found.omega_phase), "omega_phase"),
                (value(found.omega_gain), "omega_gain"),
                (value(found.omega_bw), "bandwidth_rate"),
                (line.two_points_s, "phase_delay_two_points_s"),
                (line.least_squares_s, "phase_delay_line_s"),
                (line.departure_deg, "departure_deg"),
            ] {
                let expected = number(case, name);
                assert!(
                    (found - expected).abs() < 1e-9 * expected,
                    "{} {name}: {found} {expected}",
                    case["name"]
                );
            }
            let by_line = number(case, "departure_deg") > 10.0;
            assert_eq!(
                (line.is_straight(), value(found.phase_delay_s)),
                (
                    !by_line,
                    if by_line {
                        line.least_squares_s
                    } else {
                        line.two_points_s
                    }
                )
            );
            let gain_first = number(case, "omega_gain") < number(case, "omega_phase");
            assert_eq!(found.is_gain_limited(), gain_first);
            assert_eq!(
                found.rule,
                Some(if gain_first {
                    BandwidthRule::Gain
                } else {
                    BandwidthRule::Phase
                })
            );
        }
    }

    #[test]
    fn the_gain_margin_rules_where_it_comes_first_and_never_of_attitude_command() {
        let [_, light, ..] = attitudes();
        let [rate, attitude] = [CommandType::Rate, CommandType::Attitude]
            .map(|command| of_attitude(light, &settings(command)));
        assert_eq!(rate.omega_bw.unwrap().value, rate.omega_gain.unwrap().value);
        assert_eq!(
            (attitude.omega_bw, attitude.rule),
            (attitude.omega_phase, Some(BandwidthRule::Phase))
        );
        assert!(
            attitude.is_gain_limited(),
            "the standard warns of it whatever the bandwidth is"
        );
    }

    #[test]
    fn an_attitude_is_taken_as_it_is_and_a_rate_over_s() {
        let unit = |unit: &str| AttitudeOutput::of(&Channel::new("P", unit));
        assert_eq!(
            [unit("deg/s"), unit("rad/s"), unit("deg"), unit("rad")],
            [
                Ok(AttitudeOutput::Rate),
                Ok(AttitudeOutput::Rate),
                Ok(AttitudeOutput::Attitude),
                Ok(AttitudeOutput::Attitude),
            ]
        );
        assert!(
            unit("rpm").is_err(),
            "a rotor speed is no rate of the fuselage"
        );
        let acceleration = AttitudeOutput::of(&Channel::new("NZ", "m/s^2"))
            .unwrap_err()
            .to_string();
        assert_eq!(
            acceleration,
            "\"NZ\" in \"m/s^2\" has no bandwidth: it is neither a rate (deg/s, rad/s) nor an attitude (deg, rad)"
        );

        let [attitude, ..] = attitudes();
        let at = |omega: &[f64]| {
            omega
                .iter()
                .map(|omega| attitude(Complex::new(0.0, *omega)))
                .collect()
        };
        let response = AttitudeResponse::new(
            &at,
            AttitudeOutput::Attitude,
            &search_frequencies(band()),
            band(),
        )
        .unwrap();
        let found = Bandwidth::of(&response, &settings(CommandType::Rate), None);
        assert!(
            (value(found.omega_bw)
                - value(of_attitude(attitude, &settings(CommandType::Rate)).omega_bw))
            .abs()
                < 1e-10
        );
    }

    #[test]
    fn a_phase_that_never_falls_through_has_no_crossing_and_says_up_to_where() {
        let found = of_attitude(|s| 1.0 / (s * (s + 1.0)), &settings(CommandType::Rate));
        assert_eq!(
            found.omega_180.unwrap_err().to_string(),
            "no crossing of -180 deg up to 48 rad/s"
        );
        assert_eq!(
            (
                found.phase_delay_s.is_err(),
                found.omega_gain.is_err(),
                found.phase_line
            ),
            (true, true, None)
        );
        assert!(
            (value(found.omega_bw) - 1.0).abs() < 1e-10,
            "45 deg of margin at the pole"
        );
        assert_eq!(found.rule, Some(BandwidthRule::PhaseGainUnknown));
        let late = of_attitude(
            |s| (-0.05 * s).exp() / (s * s),
            &settings(CommandType::Rate),
        );
        assert_eq!(
            late.omega_phase.unwrap_err().to_string(),
            "no crossing of -135 deg: the phase is below it from 0.500 rad/s on"
        );
        assert_eq!((late.omega_bw.is_err(), late.rule), (true, None));
    }

    #[test]
    fn slow_modes_below_the_band_move_neither_branch_nor_crossings() {
        // An unstable phugoid of 0.2 rad/s turns the phase by a turn below the band, and a nearby
        // pair of zeros turns it back.
        let [.., short] = attitudes();
        let turned =
            |s: Complex<f64>| short(s) * (s * s + 0.1 * s + 0.03) / (s * s - 0.04 * s + 0.04);
        let rate = settings(CommandType::Rate);
        let plain = of_attitude(short, &rate);
        let found = of_attitude(turned, &rate);
        assert!((value(found.omega_180) / value(plain.omega_180) - 1.0).abs() < 0.1);
        assert!((value(found.omega_bw) / value(plain.omega_bw) - 1.0).abs() < 0.2);
        // A phase that dips through -135 deg only below the band has its crossing within the band.
        let dips =
            |s: Complex<f64>| short(s) * (s * s + 0.001 * s + 0.04) / (s * s + 0.001 * s + 0.0225);
        assert!(value(of_attitude(dips, &settings(CommandType::Rate)).omega_phase) > 1.9);
        // A slow aircraft crosses below the band and stays below the level.
        let slow = of_attitude(|s| 1.0 / (s * (s + 0.2)), &settings(CommandType::Rate));
        let omega_phase = slow.omega_phase.unwrap();
        assert!((omega_phase.value - 0.2).abs() < 1e-10 && omega_phase.rests_below_band);
        // The same if a lightly damped pair of zeros and poles near 1.5 rad/s lifts the phase for a
        // while, so that it falls through once more.
        let lifted = |s: Complex<f64>| {
            (s * s + 0.002 * s + 1.96) / (s * s + 0.002 * s + 2.56) / (s * (s + 0.2))
        };
        let again = value(of_attitude(lifted, &settings(CommandType::Rate)).omega_phase);
        assert!(
            (again - 0.2).abs() < 1e-3,
            "{again}: the fall below the band comes first"
        );
    }

    #[test]
    fn a_stick_that_counts_the_other_way_round_is_suspected() {
        let [.., short] = attitudes();
        let phase_deg = |sign: f64| {
            let at = |omega: &[f64]| {
                omega
                    .iter()
                    .map(|omega| sign * short(Complex::new(0.0, *omega)))
                    .collect()
            };
            let response = AttitudeResponse::new(
                &at,
                AttitudeOutput::Attitude,
                &search_frequencies(band()),
                band(),
            );
            response.unwrap().reversed_phase_deg()
        };
        assert_eq!(phase_deg(1.0), None);
        assert!((phase_deg(-1.0).unwrap() - 79.0).abs() < 2.0);
    }

    #[test]
    fn a_magnitude_that_is_nowhere_6_db_higher_has_no_gain_margin_and_no_bandwidth() {
        // A flat magnitude: only the delay turns the phase.
        let delay = |s: Complex<f64>| (-0.2 * s).exp();
        let found = of_attitude(delay, &settings(CommandType::Rate));
        assert!(matches!(
            found.omega_bw,
            Err(NoMetric::NoGainCrossing { .. })
        ));
        assert!(
            found
                .omega_gain
                .unwrap_err()
                .to_string()
                .ends_with("down to 0.125 rad/s")
        );
        let commanded = of_attitude(delay, &settings(CommandType::Attitude));
        // -135 deg with a delay of 0.2 s.
        assert!((value(commanded.omega_bw) - 0.75 * PI / 0.2).abs() < 1e-9);
    }

    #[test]
    fn what_lies_above_the_band_is_said_to_rest_on_the_model_or_refused_with_leads() {
        // omega_180 is 8 rad/s: 16 is above the band.
        let attitude = |s: Complex<f64>| (-PI / 16.0 * s).exp() / s;
        let marked = of_attitude(attitude, &settings(CommandType::Rate));
        assert!(
            (value(marked.omega_180) - 8.0).abs() < 1e-9
                && !marked.omega_180.unwrap().rests_above_band
        );
        assert!(
            marked.phase_delay_s.unwrap().rests_above_band
                && !marked.omega_bw.unwrap().rests_above_band
        );
        let refused = BandwidthSettings {
            above_band: AboveBand::Refused,
            ..settings(CommandType::Rate)
        };
        let led = of_attitude(attitude, &refused);
        assert_eq!((led.omega_bw, led.phase_line), (marked.omega_bw, None));
        let words = led.phase_delay_s.unwrap_err().to_string();
        assert_eq!(
            words,
            "rests on the leads above the band: 16.000 rad/s, beyond 12 rad/s"
        );
        // omega_180 is 15.7 rad/s: the gain margin rests on the model, and so does the bandwidth.
        let fast = |s: Complex<f64>| (-0.1 * s).exp() / s;
        assert!(
            of_attitude(fast, &settings(CommandType::Rate))
                .omega_bw
                .unwrap()
                .rests_above_band
        );
        let led = of_attitude(fast, &refused);
        assert_eq!(
            (led.rule, led.omega_bw),
            (Some(BandwidthRule::PhaseGainUnknown), led.omega_phase)
        );
    }

    #[test]
    fn a_measurement_is_never_extrapolated() {
        let [.., short] = attitudes();
        let found = |to: f64| {
            let omega = log_spaced(0.5, to, 60);
            let values: Vec<Complex<f64>> = omega
                .iter()
                .map(|omega| Complex::new(0.0, *omega))
                .map(|s| s * short(s))
                .collect();
            let table = |part: fn(&Complex<f64>) -> f64| {
                PairTable::filled(1, 1, values.iter().map(part).collect::<Vec<f64>>())
            };
            let measured = MeasuredResponse::new(
                omega,
                &table(|value| value.re),
                &table(|value| value.im),
                None,
            )
            .unwrap();
            let omega = measured.omega().to_vec();
            let model = SampledModel::of(&Dynamics::Measured(measured), band());
            let response = model.exact(ONLY, GainDelay::NONE);
            let attitude =
                AttitudeResponse::new(&response, AttitudeOutput::Rate, &omega, band()).unwrap();
            Bandwidth::of(&attitude, &settings(CommandType::Rate), None)
        };
        // omega_180 is 3.79 rad/s.
        let whole = found(12.0);
        assert!(
            (value(whole.omega_180) / 3.7928490126513252 - 1.0).abs() < 1e-3,
            "as far as 60 points tell it"
        );
        assert!((value(whole.phase_delay_s) / 0.12206651443391653 - 1.0).abs() < 1e-2);
        let part = found(6.0);
        let words = part.phase_delay_s.unwrap_err().to_string();
        assert!(
            words.starts_with("the response has no value at 7.5"),
            "{words}"
        );
        let less = found(3.0);
        assert_eq!(
            less.omega_180.unwrap_err().to_string(),
            "no crossing of -180 deg up to 3 rad/s"
        );
        assert_eq!(
            (less.rule, less.omega_bw),
            (Some(BandwidthRule::PhaseGainUnknown), less.omega_phase)
        );
    }

    #[test]
    fn a_response_that_is_nowhere_is_refused() {
        let nothing = |omega: &[f64]| vec![Complex::new(0.0, 0.0); omega.len()];
        let refused = AttitudeResponse::new(
            &nothing,
            AttitudeOutput::Rate,
            &search_frequencies(band()),
            band(),
        )
        .err()
        .unwrap();
        assert_eq!(
            refused.to_string(),
            "there is no response between 0.125 and 48 rad/s"
        );
        assert!(AttitudeResponse::new(&nothing, AttitudeOutput::Rate, &[], band()).is_err());
    }

    #[test]
    fn a_model_and_its_correction_are_taken_exactly() {
        // 5 / (s + 3) is the rate of the third known answer without its servo; the 60 ms of delay
        // come from the correction and the model.
        let lag =
            StateSpace::new(dmatrix![-3.0], dmatrix![5.0], dmatrix![1.0], dmatrix![0.0]).unwrap();
        let timing = Timing {
            input_delays_s: Some(vec![0.02]),
            ..Timing::default()
        };
        let model = SampledModel::of(&Dynamics::StateSpace(lag.timed(timing).unwrap()), band());
        let correction = GainDelay::new(1.7, 0.04);
        let of = |response: &ResponseAt<'_>| {
            let attitude = AttitudeResponse::new(
                response,
                AttitudeOutput::Rate,
                &search_frequencies(band()),
                band(),
            );
            Bandwidth::of(&attitude.unwrap(), &settings(CommandType::Rate), None)
        };
        let found = of(&model.exact(ONLY, correction));
        let near = of(&model.interpolated(ONLY, correction));
        let error = AttitudeOutput::of(&Channel::new("NZ", "g")).unwrap_err();
        assert!(error.to_string().contains("has no bandwidth"));
        let expected = of_attitude(
            |s| 5.0 * (-0.06 * s).exp() / (s * (s + 3.0)),
            &settings(CommandType::Rate),
        );
        for (found, expected) in [
            (found.omega_bw, expected.omega_bw),
            (found.omega_180, expected.omega_180),
            (found.omega_gain, expected.omega_gain),
            (found.phase_delay_s, expected.phase_delay_s),
        ] {
            assert!((value(found) / value(expected) - 1.0).abs() < 1e-10);
        }
        for (near, exact) in [
            (near.omega_bw, found.omega_bw),
            (near.omega_gain, found.omega_gain),
            (near.phase_delay_s, found.phase_delay_s),
        ] {
            // Four points 1.5 % apart: the fourth power of that, times the phase of the delay.
            let apart = (value(near) / value(exact) - 1.0).abs();
            assert!(apart > 0.0 && apart < 1e-7, "{apart}");
        }
    }

    #[test]
    fn deviations_are_those_of_moving_the_response() {
        let [.., short] = attitudes();
        let sd_deg = 0.3;
        let sd_db = 0.05;
        // The phase is uncertain only around omega_180, the magnitude only around omega_gain.
        let frequencies = log_spaced(0.1, 48.0, 400);
        let bands = |sd_db: f64, sd_deg: f64| {
            let table = |value: f64| PairTable::filled(1, 1, vec![value; frequencies.len()]);
            ModelBands::new(frequencies.clone(), table(sd_db), table(sd_deg)).unwrap()
        };
        let rate = |turn_deg: f64| {
            move |omega: &[f64]| -> Vec<Complex<f64>> {
                let turn = Complex::from_polar(1.0, turn_deg.to_radians());
                omega
                    .iter()
                    .map(|omega| Complex::new(0.0, *omega))
                    .map(|s| s * short(s) * turn)
                    .collect()
            }
        };
        let of = |turn_deg: f64, bands: &ModelBands| {
            let at = rate(turn_deg);
            let response = AttitudeResponse::new(
                &at,
                AttitudeOutput::Rate,
                &search_frequencies(band()),
                band(),
            )
            .unwrap();
            Bandwidth::of(
                &response,
                &settings(CommandType::Rate),
                Some(PairBand { bands, pair: ONLY }),
            )
        };
        let phase_only = bands(0.0, sd_deg);
        let low = of(-sd_deg, &phase_only);
        let middle = of(0.0, &phase_only);
        let high = of(sd_deg, &phase_only);
        let half = |metric: fn(&Bandwidth) -> Result<Metric, NoMetric>| {
            0.5 * (value(metric(&high)) - value(metric(&low))).abs()
        };
        for metric in [
            |of: &Bandwidth| of.omega_180,
            |of| of.omega_phase,
            |of| of.omega_gain,
        ] as [fn(&Bandwidth) -> _; 3]
        {
            let deviation = metric(&middle).unwrap().deviation.unwrap();
            // First order: the remainder is the curvature of the phase over 0.3 deg.
            assert!(
                (deviation / half(metric) - 1.0).abs() < 1e-2,
                "{deviation} {}",
                half(metric)
            );
        }
        let twice = 2.0 * value(middle.omega_180);
        let expected = 2.0_f64.sqrt() * sd_deg.to_radians() / twice;
        assert!((middle.phase_delay_s.unwrap().deviation.unwrap() / expected - 1.0).abs() < 1e-12);
        let magnitude_only = of(0.0, &bands(sd_db, 0.0));
        assert_eq!(magnitude_only.omega_180.unwrap().deviation, Some(0.0));
        // At 2.4 rad/s |Theta| falls by about 20 dB a decade and more: 0.05 sqrt(2) dB are below a
        // hundredth of the frequency.
        let deviation = magnitude_only.omega_gain.unwrap().deviation.unwrap();
        assert!(
            deviation > 0.0 && deviation < 0.01 * value(magnitude_only.omega_gain),
            "{deviation}"
        );
    }

    #[test]
    fn a_band_that_ends_before_a_crossing_gives_no_deviation_there() {
        let [.., short] = attitudes();
        let table = || PairTable::filled(1, 1, vec![0.1, 0.1]);
        let bands = ModelBands::new(vec![0.5, 5.0], table(), table()).unwrap();
        let rate = |omega: &[f64]| -> Vec<Complex<f64>> {
            omega
                .iter()
                .map(|omega| Complex::new(0.0, *omega))
                .map(|s| s * short(s))
                .collect()
        };
        let response = AttitudeResponse::new(
            &rate,
            AttitudeOutput::Rate,
            &search_frequencies(band()),
            band(),
        )
        .unwrap();
        let found = Bandwidth::of(
            &response,
            &settings(CommandType::Rate),
            Some(PairBand {
                bands: &bands,
                pair: ONLY,
            }),
        );
        assert!(
            found.omega_180.unwrap().deviation.is_some()
                && found.phase_delay_s.unwrap().deviation.is_none()
        );
    }

    #[test]
    fn the_bar_of_substitutions_holds_their_spread_and_counts_what_is_missing() {
        let bar = substitution_bar(2.0, &[Some(2.3), Some(1.6), None], &[]);
        assert_eq!((bar.left_out, bar.identification), (1, None));
        assert!((bar.variance() - (0.09 + 0.16) / 2.0).abs() < 1e-15);
        assert!(bar.interval(0.9).unwrap()[0] >= 0.0);
    }

    proptest! {
        #[test]
        fn scaling_the_gain_changes_no_bandwidth(gain in 1e-3_f64..1e3, case in 0_usize..4) {
            let attitude = attitudes()[case];
            let plain = of_attitude(attitude, &settings(CommandType::Rate));
            let scaled = of_attitude(|s| gain * attitude(s), &settings(CommandType::Rate));
            for (plain, scaled) in [
                (plain.omega_180, scaled.omega_180),
                (plain.omega_phase, scaled.omega_phase),
                (plain.omega_gain, scaled.omega_gain),
                (plain.phase_delay_s, scaled.phase_delay_s),
            ] {
                prop_assert!((value(plain) / value(scaled) - 1.0).abs() < 1e-10);
            }
        }

        #[test]
        fn a_pure_delay_adds_exactly_half_of_itself_to_the_phase_delay_of_a_straight_phase(
            delay_s in 0.04_f64..0.3, more_s in 0.0_f64..0.3,
        ) {
            // 1/s and a delay: the phase is straight. It loses pi/2 up to omega_180 and as much
            // again up to twice that.
            let of = |delay_s: f64| of_attitude(move |s| (-delay_s * s).exp() / s, &settings(CommandType::Rate));
            let less = of(delay_s);
            let more = of(delay_s + more_s);
            prop_assert!(less.phase_line.unwrap().is_straight() && less.phase_line.unwrap().departure_deg < 1e-9);
            for (found, delay_s) in [(less, delay_s), (more, delay_s + more_s)] {
                prop_assert!((value(found.phase_delay_s) - 0.5 * delay_s).abs() < 1e-10);
                let line = found.phase_line.unwrap();
                prop_assert!((line.two_points_s - line.least_squares_s).abs() < 1e-10);
            }
        }
    }
}
