//! What the engineer loads: channels, models, flight conditions; checked once, at construction (M1).

mod channel;
mod condition;
#[expect(clippy::module_inception, reason = "the room is named by what it holds")]
mod dataset;
pub mod limits;
mod location;
mod measured_response;
mod model;
mod state_space;
mod unchecked_dataset;

pub use channel::*;
pub use condition::*;
pub use dataset::*;
pub use location::*;
pub use measured_response::*;
pub use model::*;
pub use state_space::*;
pub use unchecked_dataset::*;
