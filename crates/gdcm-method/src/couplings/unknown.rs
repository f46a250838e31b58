//! The unknowns in the coupling fit (M16.1).

use super::problem::CouplingProblem;
use crate::schedule::Airspeeds;

/// A fitted coefficient in mixing or feedback.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Unknown {
    /// Coefficient of `v^power` in `M_to,from`: the share that input `to` receives from input
    /// `from`.
    Mixing {
        to: usize,
        from: usize,
        /// Power of the scaled airspeed: 0 off the diagonal.
        power: usize,
    },
    /// `K_input,output`: feedback from an output to an input.
    Feedback { input: usize, output: usize },
}

impl Unknown {
    /// Returns the value without any coupling: M = I, K = 0.
    pub fn uncoupled(self) -> f64 {
        match self {
            Self::Mixing { to, from, power: 0 } if to == from => 1.0,
            _ => 0.0,
        }
    }

    /// Lists a problem's unknowns: `M` row by row, then `K`. The diagonal of `M` is a polynomial of
    /// degree `min(degree, distinct airspeeds - 1)`, everything else is constant (M16.1).
    pub(super) fn list(
        problem: &CouplingProblem,
        airspeeds: &Airspeeds,
        fed_back: &[usize],
    ) -> Vec<Self> {
        let inputs = problem.inputs();
        let degree = airspeeds.attainable_degree(problem.options.degree);
        let mut unknowns = Vec::new();
        for to in 0..inputs {
            for from in 0..inputs {
                let highest = if to == from { degree } else { 0 };
                unknowns.extend((0..=highest).map(|power| Self::Mixing { to, from, power }));
            }
        }
        for input in 0..inputs {
            unknowns.extend(
                fed_back
                    .iter()
                    .map(|&output| Self::Feedback { input, output }),
            );
        }
        unknowns
    }
}
