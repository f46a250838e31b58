//! Finds out how to reach a wanted interval: by more, longer or stronger sweeps, or by a narrower
//! band.
//!
//! A *target* is the wanted half-width \[dB\] of a response's 95 % interval at a frequency. Each of
//! four ways is examined alone, and the least amount that reaches the target is found by bisection
//! (`least_number`):
//!
//! ```text
//! more      sweeps like the given one, up to a given number
//! longer    one sweep of 5 s, 10 s, ... 300 s
//! stronger  one sweep with 0.05, 0.1, ... 3 times the amplitude; information grows with its square
//! narrower  sweeps from half to twice the target's frequency, up to the same number
//! ```

use gdcm_model::dataset::Pair;

use super::flight_information::StandardSweep;
use super::flight_planner::{FlightPlanner, Repeated, ResponseInterval, SweepInformation};
use super::least_number::{Least, least_number};
use super::planned_sweep::PlannedSweep;

/// Step in the sweep length \[s\].
const LENGTH_STEP_S: f64 = 5.0;
/// Longest sweep that is considered \[s\].
const LONGEST_S: f64 = 300.0;
/// Step in the amplitude, relative to the given sweep's.
const AMPLITUDE_STEP: f64 = 0.05;
/// Largest amplitude, relative to the given sweep's: beyond, the aircraft's response is not linear.
const LARGEST_AMPLITUDE: f64 = 3.0;
/// Ratio of the narrow band's upper end to the wanted frequency, and of that to its lower end.
const NARROW: f64 = 2.0;

/// A response's wanted interval at a frequency.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct IntervalTarget {
    pub pair: Pair,
    /// \[rad/s\].
    pub omega: f64,
    /// Half-width of the magnitude's 95 % interval \[dB\].
    pub half_db: f64,
}

/// The amount, such as a sweep length, that a target needs.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Need<T> {
    /// The minimum amount that reaches the target, and the half-width with it \[dB\].
    Least { amount: T, half_db: f64 },
    /// The largest amount considered, which does not reach the target, and the half-width with it
    /// \[dB\].
    NotWithin { most: T, half_db: f64 },
}

/// Ways to reach a target with sweeps like `sweep`: more, longer, stronger, or over a narrower
/// band.
#[derive(Clone, Debug, PartialEq)]
pub struct TargetPlan {
    pub target: IntervalTarget,
    /// The sweep of the response's input, planned once (`PlannedSweep::repeats` is 1).
    pub sweep: StandardSweep,
    pub now: ResponseInterval,
    /// Interval after infinitely many flights.
    pub limit: ResponseInterval,
    /// `None` if the interval is narrow enough now.
    pub ways: Option<TargetWays>,
}

/// How many, how long or how strong sweeps reach a target.
#[derive(Clone, Debug, PartialEq)]
pub struct TargetWays {
    pub repeats: Need<usize>,
    /// Length, for a single sweep \[s\].
    pub length_s: Need<f64>,
    /// Amplitude, for a single sweep, in the input's unit.
    pub amplitude: Need<f64>,
    /// Narrow band \[rad/s\], from half to twice the target frequency, within the lines used.
    pub narrow_band: [f64; 2],
    /// Number of sweeps over the narrow band.
    pub narrow_repeats: Need<usize>,
}

impl FlightPlanner<'_> {
    /// Finds out how to reach a target, with at most `most_repeats` sweeps; `None` if the sweep has
    /// no lines in the range used, or if an iteration does not converge. The target's response must
    /// exist.
    #[must_use]
    pub fn target_plan(
        &self,
        target: IntervalTarget,
        sweep: StandardSweep,
        most_repeats: usize,
    ) -> Option<TargetPlan> {
        let now = self.interval_now(target.pair, target.omega);
        let ways = if now.half_db <= target.half_db {
            None
        } else {
            Some(self.ways(target, &sweep.sweep, most_repeats)?)
        };
        Some(TargetPlan {
            target,
            sweep,
            now,
            limit: self.interval_limit(target.pair, target.omega),
            ways,
        })
    }

    fn ways(
        &self,
        target: IntervalTarget,
        sweep: &PlannedSweep,
        most_repeats: usize,
    ) -> Option<TargetWays> {
        let information = self.sweep_information(sweep)?;
        let narrow = PlannedSweep {
            band: self.narrow_band(target.omega, sweep.length_s),
            ..*sweep
        };
        Some(TargetWays {
            repeats: self.needed_repeats(target, &information, most_repeats)?,
            length_s: self.needed_length(target, sweep)?,
            amplitude: self.needed_amplitude(target, sweep, &information)?,
            narrow_band: narrow.band,
            narrow_repeats: self.needed_repeats(
                target,
                &self.sweep_information(&narrow)?,
                most_repeats,
            )?,
        })
    }

    /// Returns the band from half to twice a frequency, within the lines used \[rad/s\].
    fn narrow_band(&self, omega: f64, length_s: f64) -> [f64; 2] {
        let [lowest, highest] = self.information().sweep_band(length_s);
        let first = (omega / NARROW).clamp(lowest, highest / NARROW);
        [first, (omega * NARROW).clamp(NARROW * first, highest)]
    }

    /// Predicts the target response's half-width \[dB\] after `times` sweeps.
    fn half_db(
        &self,
        target: IntervalTarget,
        information: &SweepInformation,
        times: f64,
    ) -> Option<f64> {
        let after = self.after(&[Repeated { information, times }])?;
        let interval = self.interval(&after, target.pair, target.omega)?;
        Some(interval.half_db)
    }

    fn needed_repeats(
        &self,
        target: IntervalTarget,
        information: &SweepInformation,
        most: usize,
    ) -> Option<Need<usize>> {
        let least = least_number(most, |repeats| {
            let half_db = self.half_db(target, information, repeats as f64)?;
            Some(half_db <= target.half_db)
        })?;
        Some(match least {
            Least::Number(amount) => Need::Least {
                amount,
                half_db: self.half_db(target, information, amount as f64)?,
            },
            Least::NotWithin => Need::NotWithin {
                most,
                half_db: self.half_db(target, information, most as f64)?,
            },
        })
    }

    fn needed_amplitude(
        &self,
        target: IntervalTarget,
        sweep: &PlannedSweep,
        information: &SweepInformation,
    ) -> Option<Need<f64>> {
        let most = (LARGEST_AMPLITUDE / AMPLITUDE_STEP).round() as usize;
        // Information grows with the amplitude squared.
        let power = |steps: usize| (steps as f64 * AMPLITUDE_STEP).powi(2);
        let least = least_number(most, |steps| {
            Some(self.half_db(target, information, power(steps))? <= target.half_db)
        })?;
        Some(match least {
            Least::Number(steps) => Need::Least {
                amount: steps as f64 * AMPLITUDE_STEP * sweep.amplitude,
                half_db: self.half_db(target, information, power(steps))?,
            },
            Least::NotWithin => Need::NotWithin {
                most: LARGEST_AMPLITUDE * sweep.amplitude,
                half_db: self.half_db(target, information, power(most))?,
            },
        })
    }

    fn needed_length(&self, target: IntervalTarget, sweep: &PlannedSweep) -> Option<Need<f64>> {
        let most = (LONGEST_S / LENGTH_STEP_S).round() as usize;
        let least = least_number(most, |steps| {
            Some(self.half_db_of_length(target, sweep, steps)? <= target.half_db)
        })?;
        Some(match least {
            Least::Number(steps) => Need::Least {
                amount: steps as f64 * LENGTH_STEP_S,
                half_db: self.half_db_of_length(target, sweep, steps)?,
            },
            Least::NotWithin => Need::NotWithin {
                most: LONGEST_S,
                half_db: self.half_db_of_length(target, sweep, most)?,
            },
        })
    }

    /// Predicts the target response's half-width \[dB\] after a sweep that lasts `steps` length
    /// steps; a sweep too short for a line changes nothing.
    fn half_db_of_length(
        &self,
        target: IntervalTarget,
        sweep: &PlannedSweep,
        steps: usize,
    ) -> Option<f64> {
        let longer = self
            .information()
            .with_length(sweep, steps as f64 * LENGTH_STEP_S);
        match self.sweep_information(&longer) {
            Some(information) => self.half_db(target, &information, 1.0),
            None => Some(self.interval_now(target.pair, target.omega).half_db),
        }
    }
}
