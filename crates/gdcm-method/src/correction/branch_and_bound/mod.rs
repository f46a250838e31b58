//! Global minimum of the objective over the scales that the constrained products leave free, with a
//! proof.
//!
//! Constraining `k_o k_i` fixes the logarithms in a connected component of channels up to a common
//! offset, the *scale* `s` (M8, structure). With the ground, whose scale is always 0, the objective
//! is a sum of functions, each of a single difference of scales:
//!
//! ```text
//! F(s) = c + sum over terms f_t(s_j - s_i),     f_t(u) = R1 (e^u - c1)^2 + R2 (e^-u - c2)^2   or   w (u - c)^2
//! ```
//!
//! Each exponential is convex where `e^u >= c / 2`, and a term is concave on at most one interval.
//! A *node* is a part of the box, given by *difference bounds* `s_j - s_i <= b_ij`. Spatial
//! (interval) branch and bound:
//!
//! ```text
//!  1  best <- local minimum of F from the given start (projected Newton)
//!  2  open <- { the whole box }
//!  3  while the lowest open bound < (1 - 2e-10) best (proof), then < 1.01 best (listing),
//!     and the budget lasts
//!  4     node <- the open node with the lowest bound;  listing: close it if the monotonicity or
//!        convexity test shows that it contains no minimum other than those found
//!  5     node.bound <- tangent plane to its underestimator (each term's convex envelope) at the minimum of the underestimator,
//!        less the rounding error
//!  6     best <- local minimum of F from there, if it may be a new one worth listing
//!  7     if node.bound >= 1.01 best, close it; if node.bound >= best, keep it only for the listing
//!  8     if F is convex over the hull of node and best (convexity test), close it with the bound from best's gradient and Hessian
//!  9     branch: at the difference whose term lies furthest above its envelope, or at the end of a concave interval
//! 10  lower bound <- lowest bound of all closed and open nodes
//! ```
//!
//! Sources: Hansen and Walster, *Global Optimization Using Interval Analysis* (2004), for
//! branching, monotonicity and convexity tests; Horst and Tuy, *Global Optimization* (1996), for
//! best-first branch and bound and its convergence; McCormick (1976), *Mathematical Programming*
//! 10, for convex envelopes term by term. The tangent plane bounds the convex underestimator
//! wherever Newton's method ends, so that the bound does not require convergence; its rounding
//! error is summed over the terms (`Rounded`).

mod derivatives;
mod difference_bounds;
pub(crate) mod effort;
mod envelope;
pub(crate) mod exponential;
pub(crate) mod newton;
mod node_exclusion;
pub(crate) mod objective;
mod open_nodes;
pub(crate) mod quadratic;
pub(crate) mod rounded;
pub mod search;
pub(crate) mod term;
mod underestimator;

#[cfg(test)]
mod tests;
