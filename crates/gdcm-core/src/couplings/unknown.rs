//! The entries of the mixing and of the feedback that are fitted.

use super::CouplingProblem;
use crate::schedule::Airspeeds;

/// One number that is fitted.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Unknown {
    /// Coefficient of `v^power` in `M_to,from`: what of input `from` goes to input `to`.
    Mixing {
        /// The input that takes.
        to: usize,
        /// The input that is taken of.
        from: usize,
        /// Power of the scaled airspeed: 0 off the diagonal.
        power: usize,
    },
    /// `K_input,output`: what of an output goes to an input.
    Feedback {
        /// The input that takes.
        input: usize,
        /// The output that is fed back.
        output: usize,
    },
}

impl Unknown {
    /// What it is without any coupling: M = I, K = 0.
    pub fn uncoupled(self) -> f64 {
        match self {
            Self::Mixing { to, from, power: 0 } if to == from => 1.0,
            _ => 0.0,
        }
    }

    /// Every unknown of a problem, row by row of `M`, then of `K`: the diagonal of `M` is a polynomial of degree
    /// `min(degree, distinct airspeeds - 1)`, everything else a constant (M16.1).
    pub(super) fn all(problem: &CouplingProblem, airspeeds: &Airspeeds, fed_back: &[usize]) -> Vec<Self> {
        let inputs = problem.inputs();
        let degree = problem.options.degree.min(airspeeds.clusters.len().saturating_sub(1));
        let highest = |to: usize, from: usize| if to == from { degree } else { 0 };
        let of_entry = |to, from| (0..=highest(to, from)).map(move |power| Self::Mixing { to, from, power });
        let mixing = (0..inputs).flat_map(|to| (0..inputs).flat_map(move |from| of_entry(to, from)));
        let feedback =
            (0..inputs).flat_map(|input| fed_back.iter().map(move |&output| Self::Feedback { input, output }));
        mixing.chain(feedback).collect()
    }
}
