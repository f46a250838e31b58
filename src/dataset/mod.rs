//! What the engineer loads: channels, models, flight conditions; checked once, at construction (M1).

mod band;
mod channel;
mod condition;
#[expect(clippy::module_inception, reason = "the folder is named for its noun, and so is the file that holds it")]
mod dataset;
mod measured_response;
mod model;
mod pair;
mod state_space;

pub use band::{Band, BandError};
pub use channel::{Channel, MOST_CHANNELS};
pub use condition::{BundleKind, Condition, ConditionError, FlightState, ModelId};
pub use dataset::{Dataset, DatasetError, DatasetHeader};
pub use measured_response::{MeasuredResponse, MeasuredResponseError};
pub use model::{Dynamics, Model, Origin};
pub use pair::{Pair, PairTable};
pub use state_space::{StateSpace, StateSpaceError};
