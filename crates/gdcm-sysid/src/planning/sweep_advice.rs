//! Advises which sweeps to fly for responses that are not identified: those whose standard
//! deviation exceeds 3 dB in the middle of the band (M14.5).
//!
//! For each input with such responses, the advice is the least number of standard sweeps
//! (`flight_information`) after which the widest of their intervals is narrow enough.

use gdcm_model::dataset::Pair;

use super::flight_information::StandardSweep;
use super::flight_planner::{FlightPlanner, Repeated, ResponseInterval, SweepInformation};
use super::least_number::{Least, least_number};
use super::planned_sweep::PlannedSweep;

/// Maximum number of sweeps that are advised for an input.
const MOST_ADVISED: usize = 8;

/// How many times an input must be swept to identify those responses to it that are not identified
/// yet; 8 if that is not enough.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SweepAdvice {
    /// The sweep, with the advised count in `repeats`.
    pub sweep: StandardSweep,
    /// The response with the widest interval after the advised sweeps.
    pub pair: Pair,
    /// \[rad/s\].
    pub omega: f64,
    pub now: ResponseInterval,
    pub then: ResponseInterval,
    /// Whether the advised sweeps identify all responses to the input.
    pub is_enough: bool,
}

impl FlightPlanner<'_> {
    /// Returns advice for each input with responses among `pairs`; they are identified once their
    /// mid-band 95 % interval is at most `limit_db` on each side (1.96 times 3 dB for the limit of
    /// 3 dB on the standard deviation). `None` if a prediction fails ([`Self::sweep_plan`]).
    #[must_use]
    pub fn advice(&self, pairs: &[Pair], limit_db: f64) -> Option<Vec<SweepAdvice>> {
        let mut advice = Vec::new();
        for standard in &self.information().standard_sweeps {
            let mut own: Vec<Pair> = pairs.to_vec();
            own.retain(|pair| pair.input == standard.sweep.input);
            if !own.is_empty() {
                advice.push(self.advice_for_input(*standard, &own, limit_db)?);
            }
        }
        Some(advice)
    }

    fn advice_for_input(
        &self,
        standard: StandardSweep,
        pairs: &[Pair],
        limit_db: f64,
    ) -> Option<SweepAdvice> {
        let information = self.sweep_information(&standard.sweep)?;
        // By bisection: an interval does not widen with more sweeps.
        let least = least_number(MOST_ADVISED, |repeats| {
            let widest = self.widest(&information, repeats, pairs)?;
            Some(widest.then.half_db <= limit_db)
        })?;
        let repeats = match least {
            Least::Number(repeats) => repeats,
            Least::NotWithin => MOST_ADVISED,
        };
        let widest = self.widest(&information, repeats, pairs)?;
        Some(SweepAdvice {
            sweep: StandardSweep {
                sweep: PlannedSweep {
                    repeats,
                    ..standard.sweep
                },
                ..standard
            },
            pair: widest.pair,
            omega: self.middle_omega(),
            now: self.interval_now(widest.pair, self.middle_omega()),
            then: widest.then,
            is_enough: least != Least::NotWithin,
        })
    }

    /// Returns the response with the widest interval after `repeats` sweeps; `None` without
    /// responses, or if a prediction fails.
    fn widest(
        &self,
        information: &SweepInformation,
        repeats: usize,
        pairs: &[Pair],
    ) -> Option<WidestResponse> {
        let after = self.after(&[Repeated {
            information,
            times: repeats as f64,
        }])?;
        let mut widest: Option<WidestResponse> = None;
        for &pair in pairs {
            let then = self.interval(&after, pair, self.middle_omega())?;
            if widest.is_none_or(|other| then.half_db > other.then.half_db) {
                widest = Some(WidestResponse { pair, then });
            }
        }
        widest
    }
}

/// The response with the widest interval after further sweeps.
#[derive(Clone, Copy)]
struct WidestResponse {
    pair: Pair,
    then: ResponseInterval,
}
