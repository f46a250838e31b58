//! Assembly of many model files into one dataset: roles, channel matches and units.
//!
//! ```text
//! files -> found models (io)     -> rows: what names and contents propose, as the rules say it otherwise
//!                                -> channels matched by name, units converted as declared
//!                                -> problems, or the draft of a dataset, which is checked once
//! ```

#[expect(
    clippy::module_inception,
    reason = "the folder is named for its noun, and so is the file that holds it"
)]
pub mod assembly;
pub mod channel_match;
pub mod declarations;
pub mod found_model;
pub mod physical_unit;
pub mod problem;
pub mod response_name;
pub mod rules;

pub use assembly::Assembly;
pub use declarations::FileScope;
pub use found_model::{ChannelLabel, FoundModel, RowRole, proposed_rules};
pub use physical_unit::PhysicalUnit;
pub use rules::{ChannelRule, Headings, RowRule, Rules, UnitRule};
