//! Scores how well each parameter, alone and stepwise, helps to predict conditions left out of the
//! fit (step 10 in `physics`, M18.4).
//!
//! ```text
//! for a set of parameters:
//! 1  for each condition: z, tau <- the other conditions' equations;  a, b <- its own equations
//! 2  score <- sum over conditions of sum q^2 |y - J x|^2
//! 3  ratio <- score over the score with no parameter
//!
//! 4  sets: each parameter alone;  stepwise, add the parameter that lowers the ratio most,
//!    until all are in
//! ```
//!
//! `z` are the parameter values, `tau` the channel delays, common to all conditions; `a`, `b` are a
//! condition's channel ln gains. `y - J x` are the residuals of the linearised fit, `q` their
//! weights.

use super::pass_equations::PassEquations;
use super::shared_system::SharedSystem;

/// Score for a set of parameters.
#[derive(Clone, Debug, PartialEq)]
pub struct Score {
    /// `sum q^2 |y - J x|^2` for each condition, predicted from the others.
    pub per_condition: Vec<f64>,
    /// Sum over the conditions, divided by the same sum without any parameter.
    pub ratio: f64,
}

/// A step in the stepwise list.
#[derive(Clone, Debug, PartialEq)]
pub struct ScoreStep {
    /// The added parameter; `None` for the score with no parameter.
    pub added: Option<usize>,
    pub score: Score,
}

/// Scores for the fitted parameters.
#[derive(Clone, Debug, PartialEq)]
pub struct Scores {
    /// Ratio with each parameter alone, ordered as the fitted parameters.
    pub alone: Vec<f64>,
    /// The list, from the score with no parameter to the score with all. `added` is an index among
    /// the problem's parameters.
    pub stepwise: Vec<ScoreStep>,
}

impl Scores {
    /// Computes the scores; `fitted` are the fitted parameters' indices. Returns `None` for fewer
    /// than two conditions, if a condition cannot be predicted, or if there is no misfit to
    /// explain.
    pub(super) fn new(equations: &PassEquations, fitted: &[usize]) -> Option<Self> {
        if equations.count_conditions_with_data() < 2 {
            return None;
        }
        let scorer = Scorer::new(equations)?;
        // Step 4
        let mut alone = Vec::with_capacity(fitted.len());
        for index in 0..fitted.len() {
            alone.push(scorer.score(&[index])?.ratio);
        }
        let stepwise = scorer.stepwise(fitted)?;
        Some(Self { alone, stepwise })
    }

    /// Returns 1 minus the least ratio in the stepwise list: the share of left-out conditions'
    /// misfit that the parameters explain.
    pub fn explained(&self) -> f64 {
        let least = self
            .stepwise
            .iter()
            .map(|step| step.score.ratio)
            .fold(f64::INFINITY, f64::min);
        1.0 - least
    }

    /// Returns the step at which a parameter is added, counted from 1; `None` if it is not fitted.
    pub fn step_of(&self, parameter: usize) -> Option<usize> {
        self.stepwise
            .iter()
            .position(|step| step.added == Some(parameter))
    }

    /// Returns by how much the step that adds a parameter lowers the ratio; `None` if it is not
    /// fitted.
    pub fn gain_of(&self, parameter: usize) -> Option<f64> {
        let step = self.step_of(parameter)?;
        let before = self.stepwise.get(step.checked_sub(1)?)?;
        Some(before.score.ratio - self.stepwise[step].score.ratio)
    }
}

/// The equations, and the score with no parameter, to which others are compared. Parameters are
/// given by index among the fitted parameters.
struct Scorer<'a> {
    equations: &'a PassEquations,
    /// For each condition, the equations summed over the other conditions.
    others: Vec<SharedSystem>,
    score_without_parameters: f64,
}

impl<'a> Scorer<'a> {
    /// Computes the score with no parameter; `None` if a condition cannot be predicted, or if this
    /// score is zero.
    fn new(equations: &'a PassEquations) -> Option<Self> {
        let others: Vec<SharedSystem> = equations
            .reduced
            .iter()
            .map(|reduced| equations.system.without(reduced))
            .collect();
        let score_without_parameters: f64 = squared_errors(equations, &others, &[])?.iter().sum();
        if score_without_parameters > 0.0 {
            Some(Self {
                equations,
                others,
                score_without_parameters,
            })
        } else {
            None
        }
    }

    /// Adds the parameters one by one, each time the one with the lowest ratio (step 4); `fitted`
    /// are the fitted parameters' indices.
    fn stepwise(&self, fitted: &[usize]) -> Option<Vec<ScoreStep>> {
        let mut steps = vec![ScoreStep {
            added: None,
            score: self.score(&[])?,
        }];
        let mut chosen: Vec<usize> = Vec::with_capacity(fitted.len());
        while chosen.len() < fitted.len() {
            let best = self.best_addition(&chosen, fitted.len())?;
            chosen.push(best.index);
            steps.push(ScoreStep {
                added: Some(fitted[best.index]),
                score: best.score,
            });
        }
        Some(steps)
    }

    /// Finds the parameter whose addition to `chosen` gives the lowest ratio, the first if several
    /// are equal; `count` is the number of fitted parameters.
    fn best_addition(&self, chosen: &[usize], count: usize) -> Option<Addition> {
        let mut best: Option<Addition> = None;
        for index in 0..count {
            if chosen.contains(&index) {
                continue;
            }
            let mut parameters = chosen.to_vec();
            parameters.push(index);
            let score = self.score(&parameters)?;
            let is_better = match &best {
                Some(best) => score.ratio < best.score.ratio,
                None => true,
            };
            if is_better {
                best = Some(Addition { index, score });
            }
        }
        best
    }

    /// Returns the score with these parameters (steps 1 to 3).
    fn score(&self, parameters: &[usize]) -> Option<Score> {
        let per_condition = squared_errors(self.equations, &self.others, parameters)?;
        Some(Score {
            ratio: per_condition.iter().sum::<f64>() / self.score_without_parameters,
            per_condition,
        })
    }
}

/// Returns each condition's `sum q^2 |y - J x|^2`, predicted from the others with these parameters
/// (steps 1 and 2); `others` has the equations summed over the other conditions.
fn squared_errors(
    equations: &PassEquations,
    others: &[SharedSystem],
    parameters: &[usize],
) -> Option<Vec<f64>> {
    let mut squared_errors = Vec::with_capacity(others.len());
    for (index, others) in others.iter().enumerate() {
        let x = others.solve_for(parameters)?;
        let condition = &equations.conditions[index];
        let gains = condition.ln_gains(&equations.reduced[index], equations.scale, &x);
        squared_errors.push(condition.squared_error(&x, &gains));
    }
    Some(squared_errors)
}

/// A parameter added to others, and the score with all of them.
struct Addition {
    /// Index among the fitted parameters.
    index: usize,
    score: Score,
}
