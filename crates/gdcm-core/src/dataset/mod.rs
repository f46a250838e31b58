//! What the engineer loads: channels, models, flight conditions; checked once, at construction (M1).

mod band;
mod channel;
mod condition;
mod condition_record;
mod content;
#[expect(clippy::module_inception, reason = "the folder is named for its noun, and so is the file that holds it")]
mod dataset;
mod draft;
mod draft_faults;
mod identity;
pub mod limits;
mod measured_response;
mod model;
mod model_bands;
mod pair;
mod place;
mod state_space;
mod timing;

pub use band::{Band, BandError, GREATEST_OMEGA, LEAST_OMEGA};
pub use channel::Channel;
pub use condition::{Condition, ConditionError, FlightState};
pub use condition_record::{ConditionRecord, RecordKind};
pub use content::ContentHash;
pub use dataset::{Dataset, DatasetError, DatasetHeader};
pub use draft::{
    BandsDraft, ConditionDraft, DatasetDraft, DraftError, DraftFault, ModelDraft, ResponseArray, ResponseDraft, Warning,
};
pub use identity::{BundleKind, ConditionId, ModelId};
pub use measured_response::{Estimate, MeasuredResponse, MeasuredResponseError};
pub use model::{Dynamics, Model, Origin, Provenance};
pub use model_bands::ModelBands;
pub use pair::{Pair, PairTable};
pub use place::{ConditionPlace, Location, ModelPlace};
pub use state_space::{StateSpace, StateSpaceError};
pub use timing::{GREATEST_CHANNEL_DELAY_S, Timing, TimingError};
