//! The scales that the held products leave free, and the least objective over them.
//!
//! Holding `k_o k_i` ties the logarithms of a connected piece of channels together up to one *scale* (M8, structure). Every
//! term of the objective then depends on the difference of two scales, or of one scale and the ground (scale 0), which makes the
//! objective a sum of functions of one variable: a *landscape* of *links*. Gains and delays share it.
//!
//! Entries compared as ratios that share two scales add up to one *well* `R (e^u - c)^2`: convex where `e^u >= c / 2`. Two wells
//! facing each other are concave on one interval at most. A *region* bounds every difference of scales; over it each link is
//! convex or has a convex envelope, whose sum, the *relaxation*, is minimised by a *descent*.
//!
//! The lower bound of a region is the relaxation's tangent plane at the point reached, not its least value, so that it holds
//! however far the descent came. It is lowered by a bound on its rounding: each well carries `n + 8` roundings of its `n` terms
//! (relative to the terms, not to their difference), values and slopes sum these, and a slope's is multiplied by the width of
//! the region. Next to a minimum, where that product would be all that is left of the gap, the curvature bounds it instead.

mod bound;
mod descent;
mod envelope;
mod found;
mod landscape;
mod link;
mod model;
mod open;
mod parabolas;
mod region;
mod relaxation;
mod search;
mod settle;
mod sum;
mod terrain;
mod well;

pub(crate) use descent::Descent;
pub(crate) use found::{Effort, Found, PROOF};
pub(crate) use landscape::Landscape;
pub(crate) use link::{Link, Shape};
pub(crate) use parabolas::{Entry, parabolas};
pub(crate) use search::search;
pub(crate) use settle::settle;
pub(crate) use sum::Sum;
pub(crate) use well::{Gather, product_roundings};
