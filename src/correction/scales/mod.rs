//! The scales that the held products leave free, and the least objective over them.
//!
//! Holding `k_o k_i` ties the logarithms of a connected piece of channels together up to one *scale* (M8, structure). Every
//! term of the objective then depends on the difference of two scales, or of one scale and the ground (scale 0), which makes the
//! objective a sum of functions of one variable: a *landscape* of *links*. Gains and delays share it.

mod descent;
mod landscape;
mod link;
mod model;
mod parabolas;
mod region;
mod relaxation;
mod search;
mod settle;
mod well;

pub(crate) use descent::Descent;
pub(crate) use landscape::Landscape;
pub(crate) use link::{Link, Shape};
pub(crate) use parabolas::{Entry, parabolas};
pub(crate) use search::{Effort, Found, PROOF, search};
pub(crate) use settle::settle;
pub(crate) use well::Gather;
