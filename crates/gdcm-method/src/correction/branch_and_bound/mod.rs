//! Finds the objective's global minimum over the scales that the constrained products leave free,
//! and proves it.
//!
//! Constraining `k_o k_i` fixes the gain logarithms in a connected component `i` of channels up to
//! a common offset, the *scale* `s_i` (M8, proof). With the ground, a last scale that is always 0,
//! the objective is a sum of functions that each depend on a single scale difference:
//!
//! ```text
//! F(s) = constant + sum over terms f(u),   u = s_j - s_i,   i < j
//! f(u) = R1 (e^u - c1)^2 + R2 (e^-u - c2)^2     gains compared as ratios
//! f(u) = W (u - c)^2                            gains compared in dB, and delays
//! ```
//!
//! The weights `R1`, `R2`, `W` and the centres `c1`, `c2`, `c` combine the entries between the two
//! components: `R1`, `c1` those with the input in `j`, `R2`, `c2` those with the input in `i`.
//! `R1 (e^u - c1)^2` is convex where `e^u >= c1 / 2`, likewise the other exponential, and `f` is
//! concave on at most one interval. A *node* is a part of the box `lower <= s <= upper`, given by
//! *difference bounds* `s_j - s_i <= b_ij`. Spatial (interval) branch and bound first *proves* that
//! no lower minimum exists, then *lists* the other local minima within 1 % above the best:
//!
//! ```text
//!  1  best <- local minimum of F from the given start (projected Newton)
//!  2  open <- { the whole box }
//!  3  while the budget lasts, and the lowest open bound is
//!        below aim = (1 - 2e-10) best (proof), then below cutoff = 1.01 best (listing)
//!  4     node <- the open node with the lowest bound
//!        listing: close it if the monotonicity or the convexity test shows that it contains no
//!        minimum other than those found
//!  5     node.bound <- minimum, over the node's box, of a tangent plane to its underestimator
//!        (each term's convex envelope), less the rounding error
//!        if node.bound >= cutoff: close the node
//!  6     best <- local minimum of F from the tangent point, if it may be new and worth listing
//!  7     if node.bound >= aim: close the node if every term is convex over it, or line 4 now
//!        closes it; otherwise keep it for the listing (proof), or branch it (listing)
//!  8     if node.bound < aim: close the node if F is convex over the hull of node and best
//!        (convexity test), and the bound from best's gradient and Hessian is at least aim;
//!        otherwise branch it
//!  9     branch: in the proof, at the difference whose term lies furthest above its envelope;
//!        if there is none, and in the listing: at the ends of concave intervals;
//!        if there are none: at the difference whose term's slope varies most;
//!        if its range is too narrow: close the node
//! 10  lower bound <- lowest bound of all closed and open nodes
//! ```
//!
//! If `best` is below the objective's rounding level, the gap `2e-10` is relative to that level
//! (`search`).
//!
//! | line | file |
//! |---|---|
//! | 1, 6 | `newton`, each step by `active_set` |
//! | 2, 3, 7, 9, 10 | `search`, `open_nodes`, `difference_bounds`, `proof_budget` |
//! | 4 | `node_exclusion` |
//! | 5 | `underestimator`, `envelope`, `convex_bound` |
//! | 8 | `bound_near_minimum`, `node_exclusion`, `convex_bound` |
//!
//! The function `F` is in `objective`, its terms in `term`, `quadratic`, `exponential` and
//! `concave_interval`, its derivatives in `expansion` and `derivatives`.
//!
//! Sources: Hansen and Walster, *Global Optimization Using Interval Analysis* (2004), for
//! branching, monotonicity and convexity tests; Horst and Tuy, *Global Optimization* (1996), for
//! best-first branch and bound and its convergence; McCormick (1976), *Mathematical Programming*
//! 10, for convex envelopes term by term. The tangent plane bounds the convex underestimator
//! wherever Newton's method ends, so that the bound does not require convergence; its rounding
//! error is summed over the terms (`Rounded`).

mod active_set;
mod bound_near_minimum;
mod concave_interval;
mod convex_bound;
mod derivatives;
mod difference_bounds;
pub(crate) mod effort;
mod envelope;
pub(crate) mod expansion;
pub(crate) mod exponential;
pub(crate) mod newton;
mod node_exclusion;
pub(crate) mod objective;
mod open_nodes;
pub mod proof_budget;
pub(crate) mod quadratic;
pub(crate) mod rounded;
pub(crate) mod search;
pub(crate) mod term;
mod underestimator;

#[cfg(test)]
mod tests;
