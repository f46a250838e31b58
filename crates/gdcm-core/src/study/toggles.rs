//! What holding or freeing each response of a condition would cost.

use crate::correction::{ProofBudget, Toggle, toggles};
use crate::dataset::Pair;

use super::condition_analysis::ConditionAnalysis;

/// How far the proof of one toggle may go: the table is a hint, not a result.
fn budget() -> ProofBudget {
    ProofBudget { work: 4_000_000, ..ProofBudget::default() }
}

/// The cost of every single toggle of a condition.
#[derive(Clone, Debug, PartialEq)]
pub struct Toggles {
    /// Of the gains.
    pub gains: Vec<Toggle>,
    /// Of the delays.
    pub delays: Vec<Toggle>,
}

impl Toggles {
    /// Solves a condition with every response toggled in turn; `None` where `stop` said so first, or a problem has no answer.
    pub fn of(condition: &ConditionAnalysis, stop: &dyn Fn() -> bool) -> Option<Self> {
        let gains = toggles(&condition.gain_problem, &condition.gains, budget(), stop).ok()?;
        let delays = toggles(&condition.delay_problem, &condition.delays, budget(), stop).ok()?;
        (!stop()).then_some(Self { gains, delays })
    }

    /// The toggles of one response: of its gain and of its delay.
    pub fn of_pair(&self, pair: Pair) -> (Option<&Toggle>, Option<&Toggle>) {
        let gain = self.gains.iter().find(|toggle| toggle.pair == pair);
        (gain, self.delays.iter().find(|toggle| toggle.pair == pair))
    }
}
