//! Assembly of many model files into one dataset: roles, channel matches and units.
//!
//! ```text
//! files -> found models (in gdcm-io)
//!       -> rows: role, condition and trim, proposed from contents and names, overridden by the rules
//!       -> parts: channels matched by name, units converted as declared
//!       -> problems, or the draft of a dataset, checked once
//! ```

#[expect(
    clippy::module_inception,
    reason = "the file holds the type after which the folder is named"
)]
pub mod assembly;
mod channel_conversion;
pub mod channel_match;
mod dataset_draft;
pub mod declarations;
pub mod file_scope;
pub mod found_model;
mod measured_parts;
pub mod part;
pub mod problem;
mod problem_search;
mod proposed_rows;
pub mod proposed_rules;
mod question_scope;
pub mod row;
pub mod row_rule;
pub mod rules;
#[cfg(test)]
mod test_models;

pub use assembly::Assembly;
pub use declarations::UnitRule;
pub use file_scope::FileScope;
pub use found_model::{ChannelLabel, FoundModel};
pub use proposed_rules::proposed_rules;
pub use row_rule::RowRule;
pub use rules::{Headings, Rules};
