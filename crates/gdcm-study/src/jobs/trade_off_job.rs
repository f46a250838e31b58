//! Trade-off behind the gain weight α in a condition: how far the output gains are from 1, and how
//! large J remains.
//!
//! α weighs the distance of the output gains from 1 in the objective of eq. (7); J is the mismatch
//! cost that the gains leave (M4).

use std::sync::Arc;

use gdcm_method::correction::problem::ProblemError;
use gdcm_method::correction::{ChannelCorrection, Channels, Problem};
use gdcm_method::fidelity::CostAverage;
use gdcm_method::schedule::assessment::corrected_cost;
use gdcm_model::dataset::ConditionId;
use gdcm_model::progress::{Cancelled, Progress};

use super::job::Job;
use crate::results::analysis::{Analysis, ConditionAnalysis};
use crate::stages::engine::LIVE_PROOF;
use crate::stages::optima::solve_within;

/// Smallest and largest α in the trade-off, as powers of ten; the α slider has the same ends.
const POWERS: [i32; 2] = [-3, 3];
/// Number of α values in each decade.
const STEPS_PER_DECADE: i32 = 4;

/// Job that solves a condition's gain problem for a series of α.
#[derive(Clone, Debug)]
pub struct TradeOffJob {
    condition: ConditionAnalysis,
    /// Frequencies at which models are compared \[rad/s\].
    omega: Arc<[f64]>,
    average: CostAverage,
}

/// Output gains and J over α in a condition.
#[derive(Clone, Debug, PartialEq)]
pub struct TradeOff {
    pub condition: ConditionId,
    /// By increasing α; an α without a solution, or without a response that can be compared, is
    /// left out.
    pub points: Vec<TradeOffPoint>,
}

/// Result for one α.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TradeOffPoint {
    pub alpha: f64,
    /// Root mean square of `ln k` over the outputs.
    pub output_deviation: f64,
    /// Mean J over the responses in the objective that can be compared.
    pub mean_cost: f64,
}

impl TradeOffPoint {
    /// Computes a correction's point; `None` if no response in the objective can be compared.
    pub fn new(
        condition: &ConditionAnalysis,
        correction: &ChannelCorrection,
        omega: &[f64],
        average: CostAverage,
    ) -> Option<Self> {
        let problem = &condition.gain_problem;
        let mismatch = &condition.comparison.representative.mismatch;
        let costs = corrected_cost(mismatch, correction, omega, average);
        let mut sum = 0.0;
        let mut count = 0;
        for pair in problem.fitted.marked() {
            if let Some(cost) = costs[pair] {
                sum += cost.total();
                count += 1;
            }
        }
        if count == 0 {
            return None;
        }
        let outputs = &correction.output_gains;
        let squares: f64 = outputs.iter().map(|gain| gain.ln().powi(2)).sum();
        Some(Self {
            alpha: problem.alpha,
            output_deviation: (squares / outputs.len() as f64).sqrt(),
            mean_cost: sum / f64::from(count),
        })
    }
}

impl TradeOffJob {
    /// Creates the job for a condition in an analysis; `None` without a result.
    pub fn new(analysis: &Analysis, condition: ConditionId) -> Option<Self> {
        Some(Self {
            condition: analysis.condition(condition)?.clone(),
            omega: Arc::clone(&analysis.omega),
            average: analysis.study.settings.cost_average,
        })
    }

    /// Returns the gain problem with α replaced by 1, so that jobs that differ only in α are equal.
    fn problem(&self) -> Problem {
        Problem {
            alpha: 1.0,
            ..(*self.condition.gain_problem).clone()
        }
    }

    /// Returns the correction with these gains, and with the condition's delays or leads.
    fn correction(&self, gains: Channels<f64>) -> ChannelCorrection {
        ChannelCorrection {
            input_gains: gains.inputs,
            output_gains: gains.outputs,
            ..self.condition.correction.clone()
        }
    }
}

impl PartialEq for TradeOffJob {
    /// Compares everything on which the trade-off depends; this excludes the present α.
    fn eq(&self, other: &Self) -> bool {
        let delays = |job: &Self| job.condition.correction.signed_delays_s();
        self.average == other.average
            && self.omega == other.omega
            && self.condition.condition.id() == other.condition.condition.id()
            && self.problem() == other.problem()
            && delays(self) == delays(other)
            && Arc::ptr_eq(&self.condition.comparison, &other.condition.comparison)
    }
}

impl Job for TradeOffJob {
    type Tools = ();
    /// An error if no α has a solution.
    type Output = Result<Arc<TradeOff>, ProblemError>;

    fn run(&self, (): &mut (), progress: &dyn Progress) -> Result<Self::Output, Cancelled> {
        let mut points = Vec::new();
        let mut failure = None;
        for step in POWERS[0] * STEPS_PER_DECADE..=POWERS[1] * STEPS_PER_DECADE {
            let alpha = 10f64.powf(f64::from(step) / f64::from(STEPS_PER_DECADE));
            let problem = Problem {
                alpha,
                ..self.problem()
            };
            // The proof budget of the interactive analysis, whose gains the points are compared
            // with.
            match solve_within(&problem, LIVE_PROOF, progress)? {
                Ok(solution) => {
                    let condition = ConditionAnalysis {
                        gain_problem: Arc::new(problem),
                        ..self.condition.clone()
                    };
                    let correction = self.correction(solution.channels());
                    let point =
                        TradeOffPoint::new(&condition, &correction, &self.omega, self.average);
                    points.extend(point);
                }
                Err(error) => failure = Some(error),
            }
        }
        match (points.is_empty(), failure) {
            (true, Some(error)) => Ok(Err(error)),
            _ => Ok(Ok(Arc::new(TradeOff {
                condition: self.condition.condition.id(),
                points,
            }))),
        }
    }
}
