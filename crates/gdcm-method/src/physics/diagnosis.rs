//! The whole diagnosis: values with intervals, names and verdict, as typed facts (M18.2 to M18.4).
//!
//! A parameter's value `z` is its change divided by the change that the engineer considers
//! plausible, its *plausible standard deviation*, which is also its prior standard deviation. A
//! *score* is the misfit of conditions that are left out of the fit, its *ratio* relative to the
//! score without parameters (`score`). The *stepwise list* adds the parameters one by one, each
//! time the one with which the ratio is lowest. A parameter is *named*, as one that would have to
//! move, if its value differs from zero and helps to predict left-out conditions; the *verdict*
//! states how much all parameters explain together (`verdict`).

use nalgebra::DVector;

use gdcm_model::dataset::ConditionId;
use gdcm_model::executor::Executor;
use gdcm_model::progress::{Portion, Progress, Shares};
use gdcm_model::statistics::median;

use super::fit::{PhysicsFit, SolvedFit, solve};
use super::identifiability::{ACTS_LIKE_CHANNELS, Identifiability, ParameterPair, WeakDirection};
use super::intervals::{Intervals, ValueVariance};
use super::pass_equations::PassEquations;
use super::problem::{PhysicsError, PhysicsProblem};
use super::score::Scores;
use super::verdict::{NamingFacts, Verdict, WhyNotNamed};

/// A condition's misfit, relative to the median over the conditions, above which a caution is
/// raised (M18.5).
pub const NOTABLE_MISFIT: f64 = 1.5;
/// Least information (reciprocal variance) that a condition must have about a parameter, in units
/// of the prior's: the value's standard deviation is then three plausible ones, as large as the
/// range in which values are permitted.
const LEAST_INFORMATION: f64 = 1.0 / 9.0;
/// Share of the progress for the passes; scores and intervals follow.
const PASSES_SHARE: f64 = 0.95;
/// Step name in progress reports.
const SCORING: &str = "intervals of physics parameters";

/// What the diagnosis finds about a parameter.
#[derive(Clone, Debug, PartialEq)]
pub struct ParameterDiagnosis {
    /// Value, in plausible standard deviations.
    pub z: f64,
    /// Interval half-width, in plausible standard deviations; `None` for a value set by hand, and
    /// with fewer than four conditions.
    pub half_width: Option<f64>,
    /// Variance of the value, by source; `None` for a value set by hand.
    pub variance: Option<ValueVariance>,
    /// Score ratio with this parameter alone ([`Scores::alone`]); `None` for a value set by hand,
    /// and without scores.
    pub ratio_alone: Option<f64>,
    /// Step in the stepwise list that adds the parameter, counted from 1; `None` for a value set by
    /// hand, and without scores.
    pub step: Option<usize>,
    /// How much the parameter's step in the stepwise list lowers the ratio; `None` as for `step`.
    pub gain: Option<f64>,
    /// Share of the prior variance that the data remove; `None` for a value set by hand.
    pub learned: Option<f64>,
    /// Share of the parameter's effect that channel gains and delays can take over; `None` for a
    /// value set by hand, or without effect.
    pub channels_can_take: Option<f64>,
    /// The strongest correlation with another fitted parameter, if there is one.
    pub strongest_pair: Option<ParameterPair>,
    /// Why the parameter is not named; `None` for a named parameter.
    pub why_not_named: Option<WhyNotNamed>,
}

impl ParameterDiagnosis {
    /// Returns whether the parameter is named.
    pub fn is_named(&self) -> bool {
        self.why_not_named.is_none()
    }

    /// Returns whether the parameter acts like a channel gain or delay, so that its value rests on
    /// the prior of the channel delays (step 7 in `physics`).
    pub fn acts_like_channels(&self) -> bool {
        self.channels_can_take
            .is_some_and(|share| share > ACTS_LIKE_CHANNELS)
    }
}

/// What the diagnosis finds about a condition.
#[derive(Clone, Debug, PartialEq)]
pub struct ConditionDiagnosis {
    pub id: ConditionId,
    /// Root of `sum q^2 |ln(R / H^)|^2 / (2 sum q^2)`, ln units; `None` without any weight.
    pub misfit: Option<f64>,
    /// All parameter values fitted without this condition, in plausible standard deviations.
    pub z_without: Vec<f64>,
    /// Each parameter's value in this condition; `None` if it is set by hand, or if the condition
    /// does not determine it.
    pub z_here: Vec<Option<ValueHere>>,
}

/// A parameter's value from a single condition, without its prior, with the other parameters and
/// the delays at the solution, and with the condition's gains free: `z = x_k + (g'_k - (S' x)_k) /
/// S'_kk`, where `x` are the parameters and delays at the solution, and `S' x = g'` the condition's
/// equations without its gains (`condition_equations`).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ValueHere {
    /// In plausible standard deviations.
    pub z: f64,
    /// Standard deviation `1 / sqrt(S'_kk)`, in plausible standard deviations.
    pub sd: f64,
}

/// The diagnosis: which parameters would have to move, and by how much.
#[derive(Clone, Debug, PartialEq)]
pub struct PhysicsDiagnosis {
    pub fit: PhysicsFit,
    /// One entry per parameter, ordered as in the problem.
    pub parameters: Vec<ParameterDiagnosis>,
    /// One entry per condition, ordered as in the problem.
    pub conditions: Vec<ConditionDiagnosis>,
    /// `None` with fewer than two conditions, if a condition cannot be predicted, or if there is no
    /// misfit to explain.
    pub scores: Option<Scores>,
    /// `None` with fewer than four conditions, or without scores.
    pub verdict: Option<Verdict>,
    /// Root mean square deviation between the other identified models and their representatives, ln
    /// units; `None` without other models.
    pub spread: Option<f64>,
    /// Pairs of parameters that cannot be told apart, see
    /// [`INSEPARABLE`](super::identifiability::INSEPARABLE).
    pub pairs: Vec<ParameterPair>,
    pub identifiability: Identifiability,
}

impl PhysicsDiagnosis {
    /// Returns the share of left-out conditions' misfit that the parameters explain; `None` without
    /// scores.
    pub fn explained(&self) -> Option<f64> {
        Some(self.scores.as_ref()?.explained())
    }

    /// Returns the named parameters' indices.
    pub fn named(&self) -> Vec<usize> {
        let mut named = Vec::new();
        for (index, parameter) in self.parameters.iter().enumerate() {
            if parameter.is_named() {
                named.push(index);
            }
        }
        named
    }

    /// Returns the parameter combination about which the data say least, if that is less than the
    /// prior.
    pub fn weak_direction(&self) -> Option<&WeakDirection> {
        self.identifiability.weak_direction.as_ref()
    }

    /// Returns the conditions whose misfit is more than 1.5 times the median over the conditions.
    pub fn poorly_fitted(&self) -> Vec<ConditionId> {
        let mut misfits: Vec<f64> = self
            .conditions
            .iter()
            .filter_map(|condition| condition.misfit)
            .collect();
        if misfits.is_empty() {
            return Vec::new();
        }
        let limit = NOTABLE_MISFIT * median(&mut misfits);
        let mut poor = Vec::new();
        for condition in &self.conditions {
            if condition.misfit.is_some_and(|misfit| misfit > limit) {
                poor.push(condition.id);
            }
        }
        poor
    }
}

/// Fits the parameters, and derives intervals, scores, names and the verdict.
///
/// ```text
/// 1  fit, with the normal equations at its solution
/// 2  how well the data determine each parameter
/// 3  intervals                                      none with fewer than four conditions
/// 4  scores                                         none with fewer than two conditions
/// 5  verdict, from the share explained, the misfit
///    and the spread between identified models       none without intervals or scores
/// 6  names, one parameter at a time (`NamingFacts`); each condition's misfit and values
/// ```
///
/// # Errors
/// [`PhysicsError`], as from [`fit_parameters`](super::fit_parameters).
pub fn diagnose(
    problem: &PhysicsProblem,
    executor: &dyn Executor,
    progress: &dyn Progress,
) -> Result<PhysicsDiagnosis, PhysicsError> {
    let shares = Shares::new(progress);
    let portion = Portion::new(&shares, PASSES_SHARE, SCORING);
    // Step 1
    let SolvedFit { fit, equations } = solve(problem, executor, &portion)?;
    portion.finish()?;
    // Step 2
    let identifiability = Identifiability::new(&equations)?;
    // Step 3
    let intervals = Intervals::new(&equations, &identifiability.inverse, problem.options.level)?;
    shares.next(PASSES_SHARE, SCORING)?;
    // Step 4
    let scores = Scores::new(&equations, &fit.fitted);
    shares.next(1.0, SCORING)?;
    let explained = scores.as_ref().map(Scores::explained);
    let spread = equations.spread();
    // Step 5
    let verdict = match explained {
        Some(explained) if !intervals.half_widths.is_empty() => {
            Some(Verdict::new(explained, fit.misfit, spread))
        }
        _ => None,
    };
    // Step 6
    let findings = Findings {
        problem,
        fit: &fit,
        equations: &equations,
        identifiability: &identifiability,
        intervals: &intervals,
        scores: scores.as_ref(),
    };
    Ok(PhysicsDiagnosis {
        parameters: findings.parameters(),
        conditions: findings.conditions(),
        pairs: identifiability.pairs(&fit.fitted),
        fit,
        scores,
        verdict,
        spread,
        identifiability,
    })
}

/// Fit, intervals and scores, from which the diagnosis for parameters and conditions is put
/// together (step 6).
struct Findings<'a> {
    problem: &'a PhysicsProblem,
    fit: &'a PhysicsFit,
    equations: &'a PassEquations,
    identifiability: &'a Identifiability,
    intervals: &'a Intervals,
    scores: Option<&'a Scores>,
}

impl Findings<'_> {
    /// Returns the diagnosis for each parameter.
    fn parameters(&self) -> Vec<ParameterDiagnosis> {
        let mut parameters = Vec::with_capacity(self.fit.z.len());
        for (parameter, &z) in self.fit.z.iter().enumerate() {
            let fitted_index = self
                .fit
                .fitted
                .iter()
                .position(|&fitted| fitted == parameter);
            parameters.push(match fitted_index {
                Some(fitted_index) => self.fitted_parameter(parameter, fitted_index),
                None => ParameterDiagnosis {
                    z,
                    half_width: None,
                    variance: None,
                    ratio_alone: None,
                    step: None,
                    gain: None,
                    learned: None,
                    channels_can_take: None,
                    strongest_pair: None,
                    why_not_named: Some(WhyNotNamed::Held),
                },
            });
        }
        parameters
    }

    /// Returns the diagnosis for a fitted parameter. `parameter` is its index among all parameters,
    /// `fitted_index` its index among the fitted ones.
    fn fitted_parameter(&self, parameter: usize, fitted_index: usize) -> ParameterDiagnosis {
        let identifiability = self.identifiability;
        let learned = identifiability.learned[fitted_index];
        let facts = NamingFacts {
            conditions: self.equations.count_conditions_with_data(),
            explained: self.scores.map(Scores::explained),
            z: self.fit.z[parameter],
            half_width: self.intervals.half_widths.get(fitted_index).copied(),
            learned,
            gain: self.scores.and_then(|scores| scores.gain_of(parameter)),
        };
        ParameterDiagnosis {
            z: facts.z,
            half_width: facts.half_width,
            variance: Some(self.intervals.variances[fitted_index]),
            ratio_alone: self.scores.map(|scores| scores.alone[fitted_index]),
            step: self.scores.and_then(|scores| scores.step_of(parameter)),
            gain: facts.gain,
            learned: Some(learned),
            channels_can_take: identifiability.channels_can_take[fitted_index],
            strongest_pair: identifiability.strongest_pair(fitted_index, &self.fit.fitted),
            why_not_named: facts.why_not_named(),
        }
    }

    /// Returns a parameter's value from a single condition by the formula of [`ValueHere`];
    /// `fitted_index` is its index among the fitted parameters. `None` if the condition has too
    /// little information about it.
    fn value_here(&self, condition: usize, fitted_index: usize) -> Option<ValueHere> {
        let reduced = &self.equations.reduced[condition];
        let information = reduced.matrix[(fitted_index, fitted_index)];
        if information.is_nan() || information <= LEAST_INFORMATION {
            return None;
        }
        let x = self.shared_values();
        let row = reduced.matrix.row(fitted_index).transpose();
        let residual = reduced.right[fitted_index] - row.dot(&x);
        Some(ValueHere {
            z: x[fitted_index] + residual / information,
            sd: information.sqrt().recip(),
        })
    }

    /// Returns the shared unknowns at the solution: fitted parameters, output delays, input delays.
    fn shared_values(&self) -> DVector<f64> {
        let fitted = self
            .fit
            .fitted
            .iter()
            .map(|&parameter| self.fit.z[parameter]);
        let delays = &self.fit.delays_s;
        let values: Vec<f64> = fitted
            .chain(delays.outputs.iter().copied())
            .chain(delays.inputs.iter().copied())
            .collect();
        DVector::from_vec(values)
    }

    /// Returns the diagnosis for each condition.
    fn conditions(&self) -> Vec<ConditionDiagnosis> {
        let mut conditions = Vec::with_capacity(self.problem.conditions.len());
        for (place, condition) in self.problem.conditions.iter().enumerate() {
            let mut z_without = self.problem.initial_values();
            let without = &self.intervals.without_condition[place];
            for (&parameter, &z) in self.fit.fitted.iter().zip(without) {
                z_without[parameter] = z;
            }
            let mut z_here = vec![None; z_without.len()];
            for (fitted_index, &parameter) in self.fit.fitted.iter().enumerate() {
                z_here[parameter] = self.value_here(place, fitted_index);
            }
            conditions.push(ConditionDiagnosis {
                id: condition.id,
                misfit: self.equations.blocks[place].sums().misfit(),
                z_without,
                z_here,
            });
        }
        conditions
    }
}
