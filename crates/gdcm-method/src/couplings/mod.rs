//! Couplings and modes that channels cannot reach (M16): an input mixing and an output-to-input
//! feedback, common to all flight conditions, fitted by linear least squares.
//!
//! ```text
//! y = H (u' + K y),  u' = M~ u,  so that  H~ = (I - H K)^-1 H M~
//!
//!  1  for each condition: R' <- L_o^-1 R L_i^-1, the flight response without its channels' delays and leads
//!  2  K <- 0, M <- I
//!  3  repeat five times:
//!  4     S <- (I - H K)^-1,  F <- S H,  H_c <- F M at each condition and frequency
//!  5     q <- s w_gamma / max(|R'|, |H_c| / 2) / (1 + (e s / 10)^2)^(1/4) for each response
//!  6     G, b <- normal matrix and right-hand side for  sum q^2 |S R' - F M - F K R'|^2  in the entries theta of M and K
//!  7     theta <- solution of  (G + rho diag G) theta = b + rho diag G theta_0,  theta_0: M = I, K = 0
//!  8  M~(V) <- M(V) diag(M(V))^-1: the level stays with the channels
//!  9  bars: theta again without each condition;  sd^2 <- (n - 1) / n sum (theta_(-c) - mean)^2,  Student's t(n - 1)
//! 10  H~, its state space, its poles, the smallest singular value of I - K H
//! ```
//!
//! `u` and `y` are inputs and outputs, `H` is the physics response (p x m) and `R` the flight
//! response, `L_i` and `L_o` contain the input and output channels' delays and leads. Couplings
//! that explain flight exactly have `R' = (I - H K)^-1 H M`, which is the same as `R' = H (M + K
//! R')`, linear in `M` and `K`. Multiplied by `S`, with the couplings from the previous pass, its
//! residual is the error in the closed-loop response (step 6). The factors in the weight `q` are
//! defined in `weighted_condition`; `rho` is `CouplingOptions::ridge`; `theta_(-c)` is `theta`
//! fitted without condition c, and n the condition count.
//!
//! | step | file |
//! |---|---|
//! | 1 | `problem`, `flight_data` |
//! | 2, 3 | `unknown`, `fit` |
//! | 4 | `closed_loop` |
//! | 5 | `weighted_condition` |
//! | 6 | `condition_blocks`, `pair_products`, `normal_equations` |
//! | 7 | `normal_equations`, `arrow_system` |
//! | 8 | `coupling_matrices` |
//! | 9 | `jackknife` |
//! | 10 | `coupling_matrices`, `coupled_model`, `pole_shifts`, `loop_margin`, `response_change`; entries in pilot units: `coupling_shares` |
//!
//! Step 9: B. Efron, "The Jackknife, the Bootstrap and Other Resampling Plans", SIAM 1982,
//! chapter 3.
//!
//! Index order: `[output, input]` for responses, `[to, from]` for `M` (input, input) and for `K`
//! (input, output); omega in rad/s.

mod arrow_system;
mod closed_loop;
mod condition_blocks;
pub mod coupled_model;
pub mod coupling_matrices;
pub mod coupling_shares;
mod error;
pub mod fit;
mod flight_data;
pub mod jackknife;
mod loop_margin;
mod normal_equations;
mod pair_products;
mod pole_shifts;
pub mod problem;
pub mod response_change;
mod unknown;
mod unknown_layout;
mod weighted_condition;

#[cfg(test)]
mod tests;

pub use coupled_model::CoupledModelError;
pub use coupling_matrices::CouplingMatrices;
pub use fit::fit_couplings;
pub use jackknife::{CouplingBars, LEAST_CONDITIONS, LeftOutFit};
pub use loop_margin::LoopMargin;
pub use pole_shifts::{PoleShift, PoleShiftError};
pub use problem::{CouplingCondition, CouplingKind, CouplingProblem};
pub use unknown::Unknown;
