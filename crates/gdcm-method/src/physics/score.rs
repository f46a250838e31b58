//! Scores how well each parameter, alone and stepwise, helps to predict conditions left out of the
//! fit (step 10 in `physics`, M18.4).
//!
//! ```text
//! 1  for each condition: z, tau <- the other conditions' equations;  a, b <- its own gains
//! 2  score <- sum over conditions of sum q^2 |y - J x|^2
//! 3  ratio <- score over the score with no parameter
//! 4  alone: each parameter;  stepwise: add the one that lowers the ratio most, until all are in
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

impl Score {
    fn new(per_condition: Vec<f64>, baseline: f64) -> Self {
        Self {
            ratio: per_condition.iter().sum::<f64>() / baseline,
            per_condition,
        }
    }
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
    /// than two conditions, if a condition cannot be predicted, or if there is no misfit to explain.
    pub(super) fn new(equations: &PassEquations, fitted: &[usize]) -> Option<Self> {
        if equations.counting_conditions() < 2 {
            return None;
        }
        let scorer = Scorer::new(equations);
        let without_parameters = scorer.score(&[])?;
        let baseline: f64 = without_parameters.iter().sum();
        if baseline.is_nan() || baseline <= 0.0 {
            return None;
        }
        // Steps 3 and 4
        let mut alone = Vec::with_capacity(fitted.len());
        for index in 0..fitted.len() {
            alone.push(Score::new(scorer.score(&[index])?, baseline).ratio);
        }
        let mut stepwise = vec![ScoreStep {
            added: None,
            score: Score::new(without_parameters, baseline),
        }];
        let mut chosen: Vec<usize> = Vec::with_capacity(fitted.len());
        while chosen.len() < fitted.len() {
            let mut best: Option<(usize, Score)> = None;
            for index in 0..fitted.len() {
                if chosen.contains(&index) {
                    continue;
                }
                chosen.push(index);
                let candidate = scorer.score(&chosen);
                chosen.pop();
                let candidate = Score::new(candidate?, baseline);
                let is_better = match &best {
                    Some((_, best)) => candidate.ratio < best.ratio,
                    None => true,
                };
                if is_better {
                    best = Some((index, candidate));
                }
            }
            let (index, score) = best?;
            chosen.push(index);
            stepwise.push(ScoreStep {
                added: Some(fitted[index]),
                score,
            });
        }
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

/// The equations without each condition.
struct Scorer<'a> {
    equations: &'a PassEquations,
    others: Vec<SharedSystem>,
}

impl<'a> Scorer<'a> {
    fn new(equations: &'a PassEquations) -> Self {
        Self {
            equations,
            others: equations
                .reduced
                .iter()
                .map(|reduced| equations.system.without(reduced))
                .collect(),
        }
    }

    /// Returns each condition's score with these parameters, given by index among the fitted
    /// parameters (steps 1 and 2).
    fn score(&self, parameters: &[usize]) -> Option<Vec<f64>> {
        let equations = self.equations;
        let mut scores = Vec::with_capacity(self.others.len());
        for (index, others) in self.others.iter().enumerate() {
            let x = others.solve_for(parameters)?;
            let condition = &equations.conditions[index];
            let gains = condition.ln_gains(&equations.reduced[index], equations.scale, &x);
            scores.push(condition.squared_error(&x, &gains));
        }
        Some(scores)
    }
}
