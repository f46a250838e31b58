//! Named physics parameters: which would have to move, and by how much, so that the physics model
//! matches flight in all conditions at once (M18).
//!
//! ```text
//!  1  each run gives the change of A, B, C, D for a step of one parameter: L_k (and Q_k from two runs)
//!  2  z, tau, a, b <- 0
//!  3  H, dH/dz_k <- A(z) = A + sum_k (z_k L_k + z_k^2 Q_k), B(z), C(z), D(z)
//!  4  l <- ln(R / H^),  ln H^_oi = ln H_oi(z) + a_oc + b_ic - j omega (tau_o + tau_i);  q <- weights
//!  5  blocks <- sums of q^2 times products, by condition, output, input and third of the grid
//!  6  a, b eliminated, condition by condition
//!  7  min nu/(N s^2) sum q^2 |y - J x|^2 + sum z^2 + sum (tau/0.05)^2 + sum (a/0.2)^2 + sum (b/0.2)^2,
//!     y = l + J x,  s^2 = max(sum q^2 |l|^2 / (2 sum q^2), 0.01^2);  |z| <= 3;  step <= 1
//!  8  again from 3, until no z moves by more than 1e-3 after three passes, or after 20
//!  9  intervals: the stored equations without each condition, output, input and third
//! 10  scores: conditions left out predicted by each parameter alone, and stepwise
//! 11  how well the data determine each parameter, and which cannot be told apart
//! 12  named parameters and verdict
//! ```
//!
//! `z_k` is parameter k's change divided by its plausible standard deviation, `R` the identified
//! representative, `H` the physics representative; `nu` is how many independent frequencies a
//! response counts as, `N` the number of frequencies in the grid. The prior standard deviations
//! 0.05 s and 0.2 and the 20 passes are defaults (`PhysicsOptions`). The ln gains `a`, `b` belong
//! to a condition, the delays `tau` are common to all; both are left free, so that a calibration
//! error is not blamed on the physics model. Every pass is convex with a single optimum; that the
//! passes converge is not proven.
//!
//! The result is a diagnosis. If the cause is a parameter without runs, another parameter with a
//! similar effect is blamed for it (M18.7).
//!
//! | step | file |
//! |---|---|
//! | data | `offered_parameter`, `run_matching`, `run_refusal`, `problem` |
//! | 1 | `increments`, `matrices` |
//! | 3 | `family`, `resolvent` |
//! | 4 | `weights`, `point` |
//! | 5 | `weighted_condition`, `pair_blocks` |
//! | 6 | `condition_equations` |
//! | 7 | `pass_equations`, `shared_system` |
//! | 2, 8 | `fit` |
//! | 9 | `intervals` |
//! | 10 | `score` |
//! | 11 | `identifiability` |
//! | 12 | `verdict`, `diagnosis` |
//! | models for chosen values (M18.5) | `increments`, `family` |
//!
//! Index order: `[output, input]`; omega in rad/s; delays in s; `z`, half-widths and variances in
//! plausible standard deviations and their squares.

mod condition_equations;
pub mod diagnosis;
mod error;
pub mod family;
pub mod fit;
pub mod identifiability;
pub mod increments;
pub mod intervals;
mod matrices;
pub mod offered_parameter;
mod pair_blocks;
mod pass_equations;
mod point;
pub mod problem;
mod resolvent;
pub mod run_matching;
pub mod run_refusal;
pub mod score;
mod shared_system;
pub mod verdict;
mod weighted_condition;
mod weights;

#[cfg(test)]
mod tests;

pub use diagnosis::{PhysicsDiagnosis, diagnose};
pub use family::ModelFamily;
pub use fit::{PhysicsFit, fit_parameters};
pub use increments::ConditionIncrements;
pub use offered_parameter::OfferedParameter;
pub use problem::{ParameterValue, PhysicsCondition, PhysicsError, PhysicsProblem};
pub use run_matching::{ConditionOmission, MatchedRuns};
pub use run_refusal::{RefusedRun, RunRefusal};
pub use verdict::{Verdict, WhyNotNamed};
