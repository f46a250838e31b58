//! The plots between the side panels, each with its header: what is drawn, and which commands its events stand for.

mod across;
mod assessment;
mod bode;
mod channels;
mod compare;
mod error;
mod evidence;
mod frequency;
mod net_gain;
mod overview;
mod poles;

pub use across::*;
pub use assessment::*;
pub use bode::*;
pub use channels::*;
pub use compare::*;
pub use error::*;
pub use evidence::*;
pub(in crate::view) use frequency::{bode_options, condition_source};
pub use net_gain::*;
pub use overview::*;
pub use poles::*;
