//! The engineer's data: channels, models and flight conditions, checked once at construction (M1).

pub mod band;
pub mod channel;
mod channel_remedy;
pub mod condition;
mod condition_record;
mod content_hash;
#[expect(
    clippy::module_inception,
    reason = "the file holds the type after which the folder is named"
)]
pub mod dataset;
pub mod dataset_draft;
mod draft_checks;
pub mod draft_fault;
mod dynamics;
mod flight_state;
pub mod limits;
pub mod location;
pub mod measured_response;
pub mod model;
mod model_draft_checks;
mod model_id;
mod pair_table;
pub mod physics_parameter;
mod provenance;
pub mod state_space;
mod timing;
mod uncertainty_bands;

pub use band::Band;
pub use channel::Channel;
pub use condition::Condition;
pub use dataset::Dataset;
pub use dynamics::Dynamics;
pub use model::Model;
pub use model_id::{BundleKind, ConditionId, ModelId};
pub use pair_table::{Pair, PairTable};
pub use physics_parameter::{MovedModel, PhysicsParameter};
pub use state_space::StateSpace;
