//! Tables of the confidence intervals predicted after further sweeps.
//!
//! The standard table takes one, two and four *standard sweeps* of each input: sweeps as strong and
//! as long as the strongest flown for that input (`flight_information`).

use gdcm_model::dataset::Pair;

use super::flight_information::StandardSweep;
use super::flight_planner::{FlightPlanner, Repeated, ResponseInterval};

/// Sweep counts for which [`FlightPlanner::standard_plan`] predicts intervals.
pub const TABLE_REPEATS: [usize; 3] = [1, 2, 4];

/// Confidence intervals predicted after further sweeps, for each input.
#[derive(Clone, Debug, PartialEq)]
pub struct FlightPlan {
    pub sweeps: Vec<SweepPlan>,
}

/// Intervals of the responses to an input, after further sweeps of it.
#[derive(Clone, Debug, PartialEq)]
pub struct SweepPlan {
    /// The sweep, planned once (`PlannedSweep::repeats` is 1).
    pub sweep: StandardSweep,
    /// Sweep counts, for which [`PlannedResponse::after`] has an entry each.
    pub repeats: Vec<usize>,
    /// A response for each output.
    pub responses: Vec<PlannedResponse>,
}

/// A response's interval now and after further sweeps.
#[derive(Clone, Debug, PartialEq)]
pub struct PlannedResponse {
    pub pair: Pair,
    /// \[rad/s\].
    pub omega: f64,
    pub now: ResponseInterval,
    /// Interval after each sweep count in [`SweepPlan::repeats`].
    pub after: Vec<ResponseInterval>,
}

impl FlightPlanner<'_> {
    /// Predicts the intervals of all responses to the swept input at `omega` \[rad/s\], for each
    /// sweep count in `repeats`; `None` if the sweep has no lines in the range used, or if an
    /// iteration does not converge.
    #[must_use]
    pub fn sweep_plan(
        &self,
        sweep: StandardSweep,
        repeats: &[usize],
        omega: f64,
    ) -> Option<SweepPlan> {
        let information = self.sweep_information(&sweep.sweep)?;
        let bands = &self.information().bands;
        let input = sweep.sweep.input;
        let mut responses = Vec::with_capacity(bands.sd_db().outputs());
        for output in 0..bands.sd_db().outputs() {
            let pair = Pair { output, input };
            responses.push(PlannedResponse {
                pair,
                omega,
                now: self.interval_now(pair, omega),
                after: Vec::with_capacity(repeats.len()),
            });
        }
        for &times in repeats {
            let after = self.after(&[Repeated {
                information: &information,
                times: times as f64,
            }])?;
            for response in &mut responses {
                let interval = self.interval(&after, response.pair, omega)?;
                response.after.push(interval);
            }
        }
        Some(SweepPlan {
            sweep,
            repeats: repeats.to_vec(),
            responses,
        })
    }

    /// Predicts the mid-band intervals after one, two and four sweeps of each input; `None` under
    /// the conditions of [`Self::sweep_plan`].
    #[must_use]
    pub fn standard_plan(&self) -> Option<FlightPlan> {
        let mut sweeps = Vec::with_capacity(self.information().inputs());
        for sweep in &self.information().standard_sweeps {
            sweeps.push(self.sweep_plan(*sweep, &TABLE_REPEATS, self.middle_omega())?);
        }
        Some(FlightPlan { sweeps })
    }

    /// Returns the middle point of the frequencies at which standard deviations are known
    /// \[rad/s\].
    #[must_use]
    pub fn middle_omega(&self) -> f64 {
        let omega = self.information().bands.omega();
        omega[omega.len() / 2]
    }
}
