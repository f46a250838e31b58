//! Bandwidth `omega_BW` and phase delay `tau_p`, read from the attitude response `Theta` (M17.1).
//!
//! ```text
//! 1  Theta(j omega), with its continuous phase Phi                        (`attitude_response`)
//! 2  omega_180, omega_phase: where Phi falls through -180, -135 deg       (phase_crossing)
//! 3  omega_gain: greatest omega < omega_180 at which |Theta| is 6 dB
//!    above |Theta(omega_180)|                                             (gain_crossing)
//! 4  omega_BW: omega_phase for attitude command,
//!    min(omega_phase, omega_gain) for rate command                        (limiting_margin)
//! 5  tau_p: phase lost from omega_180 to 2 omega_180, over 2 omega_180    (`phase_delay`)
//! ```
//!
//! Standard deviations come from `bandwidth_deviation`. A number read above the band is marked, or
//! refused where [`AboveBand::Refused`] is set.
//!
//! ADS-33E-PRF, "Handling qualities requirements for military rotorcraft", 2000, 3.3.2.1 and figure
//! 4; MIL-DTL-32742.

use serde::{Deserialize, Serialize};

use gdcm_model::dataset::Band;

pub use super::bandwidth_deviation::PairUncertainty;
pub use super::bandwidth_metric::{AboveBand, Metric, NoMetric};
pub use super::phase_delay::PhaseLine;
pub use super::substitution_bar::substitution_bar;

use super::attitude_response::AttitudeResponse;
use super::root_search::root_between;

/// Gain margin at `omega_gain` \[dB\]: a pilot may double the gain.
const GAIN_MARGIN_DB: f64 = 6.0;
/// Phase at `omega_180` \[deg\]: a pilot's loop whose gain is 1 there is neutrally stable.
const NEUTRAL_STABILITY_DEG: f64 = -180.0;
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
    /// Computes bandwidth and phase delay of `attitude`, with standard deviations if those of the
    /// response are available.
    pub fn read(
        attitude: &AttitudeResponse<'_>,
        settings: &BandwidthSettings,
        deviation: Option<PairUncertainty<'_>>,
    ) -> Self {
        let reading = Reading {
            attitude,
            settings,
            deviation,
        };
        // Step 2
        let omega_180 = reading.phase_crossing(NEUTRAL_STABILITY_DEG);
        let omega_phase = reading.phase_crossing(PHASE_MARGIN_DEG);
        // Step 3
        let omega_gain = omega_180.and_then(|omega_180| reading.gain_crossing(omega_180));
        // Step 4
        let margin = reading.limiting_margin(omega_180, omega_phase, omega_gain);
        // Step 5
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

/// A response with the settings by which bandwidth and phase delay are read from it.
struct Reading<'a> {
    attitude: &'a AttitudeResponse<'a>,
    settings: &'a BandwidthSettings,
    deviation: Option<PairUncertainty<'a>>,
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
            .and_then(|uncertainty| uncertainty.phase_crossing_sd(self.attitude, root));
        self.metric(root, [root, root], deviation)
    }

    /// Returns `k` for the grid interval `[k, k + 1]` in which the phase falls through `level`
    /// \[rad\] (step 2): the first from the band's lower end on. If the phase is not above `level`
    /// there, it has fallen through already: then the nearest interval below the band, if any.
    fn falling_interval(&self, level: f64) -> Option<usize> {
        let phase = &self.attitude.phase;
        let band_start = self.attitude.lowest_of_band;
        let last = phase.len() - 1;
        if phase[band_start] <= level {
            let below_band = (0..band_start).rev().find(|&k| falls_at(phase, k, level));
            if below_band.is_some() {
                return below_band;
            }
        }
        (band_start..last).find(|&k| falls_at(phase, k, level))
    }

    /// Returns the reason why the phase does not fall through a level.
    fn missing_crossing(&self, level_deg: f64) -> NoMetric {
        let omega = &self.attitude.omega;
        let band_start = self.attitude.lowest_of_band;
        if self.attitude.phase[band_start] <= level_deg.to_radians() {
            NoMetric::BelowFromStart {
                level_deg,
                from: omega[band_start],
            }
        } else {
            NoMetric::NoCrossing {
                level_deg,
                up_to: omega[omega.len() - 1],
            }
        }
    }

    /// Returns the highest frequency below `omega_180` at which the magnitude exceeds its value at
    /// `omega_180` by 6 dB (step 3).
    fn gain_crossing(&self, omega_180: Metric) -> Result<Metric, NoMetric> {
        let grid = &self.attitude.omega;
        let omega_180 = omega_180.value;
        let no_crossing = NoMetric::NoGainCrossing {
            omega_180,
            down_to: grid[0],
        };
        let magnitude_at_180 = self
            .attitude
            .magnitude_db_at(omega_180)
            .ok_or(no_crossing)?;
        let level = magnitude_at_180 + GAIN_MARGIN_DB;
        // Count of grid points below omega_180.
        let below = grid.partition_point(|omega| *omega < omega_180);
        // The magnitude at omega_180 itself is below the level: the first grid point above the
        // level, counted downwards from omega_180, brackets the crossing.
        let k = (0..below)
            .rev()
            .find(|&k| self.attitude.magnitude_db[k] >= level)
            .ok_or(no_crossing)?;
        let upper = if k + 1 < below {
            grid[k + 1]
        } else {
            omega_180
        };
        let root = root_between([grid[k], upper], |omega| {
            let magnitude = self.attitude.magnitude_db_at(omega)?;
            Some(level - magnitude)
        });
        let deviation = self
            .deviation
            .and_then(|uncertainty| uncertainty.gain_crossing_sd(self.attitude, root, omega_180));
        self.metric(root, [root, omega_180], deviation)
    }

    /// Returns the bandwidth and the margin that sets it (step 4). Without `omega_gain`, a rate
    /// command has the bandwidth `omega_phase` if there is no `omega_180` either, and no gain
    /// margin to find; otherwise none, because it lies below the lowest frequency.
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
        let deviation = self
            .deviation
            .and_then(|uncertainty| uncertainty.phase_delay_sd(from));
        let metric = self.metric(line.phase_delay_s(), [from, to], deviation)?;
        Ok(PhaseDelay { metric, line })
    }
}

/// Returns whether the phase falls through `level` \[rad\] between grid points `k` and `k + 1`.
fn falls_at(phase: &[f64], k: usize, level: f64) -> bool {
    phase[k] > level && phase[k + 1] <= level
}
