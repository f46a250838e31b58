//! Bandwidth and phase delay, read from an attitude response (M17.1).
//!
//! ```text
//! 1  Theta = H/(j omega) for a rate, H for an attitude; phase continuous, in (-270, 90] deg at the lowest frequency of the band
//! 2  omega_180, omega_phase: the lowest omega from the band's lower end on at which the phase
//!    falls through -180, -135 deg; where the phase is below that level at the band's lowest
//!    frequency: the next crossing below the band; without one, the first within
//! 3  omega_gain: the greatest omega < omega_180 at which |Theta| = 10^(6/20) |Theta(omega_180)|
//! 4  omega_BW = omega_phase for attitude command; min(omega_phase, omega_gain) for rate command; without omega_gain:
//!    omega_phase if there is no omega_180 either, otherwise none, because omega_BW is below the lowest frequency
//! 5  Phi at 400 logarithmic points in omega_180 ... 2 omega_180; its maximum departure from the
//!    line between its ends
//! 6  up to 10 deg: tau_p = -(Phi(2 omega_180) + pi) / (2 omega_180)
//! 7  above: least-squares line through Phi over omega; tau_p = its phase loss from omega_180 to 2 omega_180, over 2 omega_180
//! ```
//!
//! `H` is the response of the output to the input, `Theta` the attitude response, `Phi` its phase,
//! `omega_BW` the bandwidth, `tau_p` the phase delay.
//!
//! ADS-33E-PRF, "Handling qualities requirements for military rotorcraft", 2000, 3.3.2.1 and figure
//! 4; MIL-DTL-32742. `attitude_response` does step 1, `phase_delay` steps 5 to 7; standard
//! deviations come from `bandwidth_deviation`. A number read above the band is marked, or refused
//! where [`AboveBand::Refused`] is set.

use serde::{Deserialize, Serialize};

use gdcm_model::dataset::Band;

pub use super::bandwidth_deviation::PairBand;
pub use super::bandwidth_metric::{AboveBand, Metric, NoMetric};
pub use super::phase_delay::PhaseLine;
pub use super::substitution_bar::substitution_bar;

use super::attitude_response::AttitudeResponse;
use super::root_search::root_between;

/// Gain margin at `omega_gain` \[dB\].
const GAIN_MARGIN_DB: f64 = 6.0;
/// Phase at `omega_180` \[deg\].
const NEUTRAL_DEG: f64 = -180.0;
/// Phase at `omega_phase` \[deg\]: a 45 deg margin.
const PHASE_MARGIN_DEG: f64 = -135.0;

/// How an axis responds to its inceptor.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum CommandType {
    /// The inceptor commands a rate.
    #[default]
    Rate,
    /// The inceptor commands an attitude (attitude command, attitude hold).
    Attitude,
}

/// Response type, band, and how values above the band are treated.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BandwidthSettings {
    pub command: CommandType,
    /// The identified or measured band \[rad/s\].
    pub band: Band,
    pub above_band: AboveBand,
}

/// The margin that sets the bandwidth.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum BandwidthRule {
    /// The 45 deg phase margin.
    Phase,
    /// The 6 dB gain margin, if it occurs at a lower frequency than the phase margin.
    Gain,
    /// The phase margin, because there is no gain margin without `omega_180`: an upper bound on the
    /// bandwidth.
    PhaseGainUnknown,
}

/// Bandwidth and phase delay (M17.1; ADS-33E-PRF 3.3.2.1).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bandwidth {
    /// Frequency at -180 deg \[rad/s\].
    pub omega_180: Result<Metric, NoMetric>,
    /// Frequency at -135 deg \[rad/s\].
    pub omega_phase: Result<Metric, NoMetric>,
    /// Frequency with 6 dB gain margin \[rad/s\].
    pub omega_gain: Result<Metric, NoMetric>,
    /// The bandwidth \[rad/s\].
    pub omega_bw: Result<Metric, NoMetric>,
    /// The margin that sets the bandwidth; `None` without a bandwidth.
    pub rule: Option<BandwidthRule>,
    pub phase_delay_s: Result<Metric, NoMetric>,
    /// Phase data from which the phase delay is computed; `None` without a phase delay.
    pub phase_line: Option<PhaseLine>,
}

impl Bandwidth {
    /// Computes bandwidth and phase delay of `attitude`, with standard deviations if an uncertainty
    /// band is available.
    pub fn read(
        attitude: &AttitudeResponse<'_>,
        settings: &BandwidthSettings,
        deviation: Option<PairBand<'_>>,
    ) -> Self {
        let reading = Reading {
            attitude,
            settings,
            deviation,
        };
        // Step 2
        let omega_180 = reading.phase_crossing(NEUTRAL_DEG);
        let omega_phase = reading.phase_crossing(PHASE_MARGIN_DEG);
        // Step 3
        let omega_gain = omega_180.and_then(|omega_180| reading.gain_crossing(omega_180));
        // Step 4
        let margin = reading.limiting_margin(omega_180, omega_phase, omega_gain);
        // Steps 5 to 7
        let phase_delay = omega_180.and_then(|omega_180| reading.phase_delay(omega_180));
        Self {
            omega_180,
            omega_phase,
            omega_gain,
            omega_bw: margin.map(|margin| margin.metric),
            rule: margin.ok().map(|margin| margin.rule),
            phase_delay_s: phase_delay.map(|delay| delay.metric),
            phase_line: phase_delay.ok().map(|delay| delay.line),
        }
    }

    /// Returns whether the gain margin occurs at a lower frequency than the phase margin: the
    /// standard warns about this for every response type.
    pub fn is_gain_limited(&self) -> bool {
        match (&self.omega_gain, &self.omega_phase) {
            (Ok(gain), Ok(phase)) => gain.value < phase.value,
            _ => false,
        }
    }
}

/// A response with its evaluation settings.
struct Reading<'a> {
    attitude: &'a AttitudeResponse<'a>,
    settings: &'a BandwidthSettings,
    deviation: Option<PairBand<'a>>,
}

/// The bandwidth with the margin that sets it.
#[derive(Clone, Copy)]
struct LimitingMargin {
    metric: Metric,
    rule: BandwidthRule,
}

/// The phase delay with the phase data from which it is computed.
#[derive(Clone, Copy)]
struct PhaseDelay {
    metric: Metric,
    line: PhaseLine,
}

impl Reading<'_> {
    /// Returns the value read from these frequencies (the lowest and the highest); refuses it if it
    /// is read above the band and the settings say so. A deviation that is not finite becomes
    /// `None`.
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
        Ok(Metric {
            value,
            deviation: deviation.filter(|deviation| deviation.is_finite()),
            read_at,
            rests_above_band,
            rests_below_band: lowest < band.min(),
        })
    }

    /// Returns the frequency at which the phase falls through a level.
    fn phase_crossing(&self, level_deg: f64) -> Result<Metric, NoMetric> {
        let level = level_deg.to_radians();
        let omega = &self.attitude.omega;
        let Some(k) = self.falling_interval(level) else {
            return Err(self.missing_crossing(level_deg));
        };
        let root = root_between([omega[k], omega[k + 1]], |omega| {
            self.attitude.phase_at(omega).map(|phase| level - phase)
        });
        let deviation = self
            .deviation
            .and_then(|band| band.phase_crossing_sd(self.attitude, root));
        self.metric(root, [root, root], deviation)
    }

    /// Returns `k` for the grid interval `[k, k + 1]` in which the phase falls through `level`
    /// \[rad\]: the lowest from the band's lower end on; but if the phase there is not above
    /// `level`, the next interval below the band, if any.
    fn falling_interval(&self, level: f64) -> Option<usize> {
        let phase = &self.attitude.phase;
        let first = self.attitude.lowest_of_band;
        let last = phase.len() - 1;
        if phase[first] <= level {
            let below_band = (0..first).rev().find(|&k| falls_at(phase, k, level));
            if below_band.is_some() {
                return below_band;
            }
        }
        (first..last).find(|&k| falls_at(phase, k, level))
    }

    /// Returns the reason why the phase does not fall through a level.
    fn missing_crossing(&self, level_deg: f64) -> NoMetric {
        let omega = &self.attitude.omega;
        let first = self.attitude.lowest_of_band;
        if self.attitude.phase[first] <= level_deg.to_radians() {
            NoMetric::BelowFromStart {
                level_deg,
                from: omega[first],
            }
        } else {
            NoMetric::NoCrossing {
                level_deg,
                up_to: omega[omega.len() - 1],
            }
        }
    }

    /// Returns the highest frequency below `omega_180` at which the magnitude exceeds its value at
    /// `omega_180` by 6 dB.
    fn gain_crossing(&self, omega_180: Metric) -> Result<Metric, NoMetric> {
        let grid = &self.attitude.omega;
        let top = omega_180.value;
        let none = NoMetric::NoGainCrossing {
            omega_180: top,
            down_to: grid[0],
        };
        let level = self.attitude.magnitude_db_at(top).ok_or(none)? + GAIN_MARGIN_DB;
        let below = grid.partition_point(|omega| *omega < top);
        // The magnitude at omega_180 itself is below the level: the first grid point above the
        // level, counted from the top, brackets the crossing.
        let k = (0..below)
            .rev()
            .find(|&k| self.attitude.magnitude_db[k] >= level)
            .ok_or(none)?;
        let upper = if k + 1 < below { grid[k + 1] } else { top };
        let root = root_between([grid[k], upper], |omega| {
            let magnitude = self.attitude.magnitude_db_at(omega)?;
            Some(level - magnitude)
        });
        let deviation = self
            .deviation
            .and_then(|band| band.gain_crossing_sd(self.attitude, root, top));
        self.metric(root, [root, top], deviation)
    }

    /// Returns the bandwidth and the margin that sets it (step 4).
    fn limiting_margin(
        &self,
        omega_180: Result<Metric, NoMetric>,
        phase: Result<Metric, NoMetric>,
        gain: Result<Metric, NoMetric>,
    ) -> Result<LimitingMargin, NoMetric> {
        let phase = phase?;
        if self.settings.command == CommandType::Attitude {
            return Ok(LimitingMargin {
                metric: phase,
                rule: BandwidthRule::Phase,
            });
        }
        match gain {
            Ok(gain) => self.lower_margin(phase, gain),
            // No 6 dB gain margin exists above the lowest frequency, so the bandwidth lies below
            // it.
            Err(reason) if omega_180.is_ok() => Err(reason),
            Err(_) => Ok(LimitingMargin {
                metric: phase,
                rule: BandwidthRule::PhaseGainUnknown,
            }),
        }
    }

    /// Returns the lower of `omega_phase` and `omega_gain` (step 4). Its `read_at` covers the
    /// frequencies from which either was read, because the choice depends on both.
    fn lower_margin(&self, phase: Metric, gain: Metric) -> Result<LimitingMargin, NoMetric> {
        let rule = if gain.value < phase.value {
            BandwidthRule::Gain
        } else {
            BandwidthRule::Phase
        };
        let lower = if rule == BandwidthRule::Gain {
            gain
        } else {
            phase
        };
        let read_at = [phase.read_at[0].min(gain.read_at[0]), gain.read_at[1]];
        let metric = self.metric(lower.value, read_at, lower.deviation)?;
        Ok(LimitingMargin { metric, rule })
    }

    /// Returns the phase delay, and the phase data from which it is computed.
    fn phase_delay(&self, omega_180: Metric) -> Result<PhaseDelay, NoMetric> {
        let from = omega_180.value;
        let to = 2.0 * omega_180.value;
        let Some(line) = PhaseLine::read(self.attitude, from) else {
            return Err(NoMetric::ResponseEnds { needed: to });
        };
        let deviation = self.deviation.and_then(|band| band.phase_delay_sd(from));
        let metric = self.metric(line.phase_delay_s(), [from, to], deviation)?;
        Ok(PhaseDelay { metric, line })
    }
}

/// Returns whether the phase falls through `level` \[rad\] between grid points `k` and `k + 1`.
fn falls_at(phase: &[f64], k: usize, level: f64) -> bool {
    phase[k] > level && phase[k + 1] <= level
}
