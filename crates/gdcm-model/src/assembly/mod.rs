//! Assembles many model files into one dataset: roles, channel matches and units.
//!
//! ```text
//! files -> found models (in gdcm-io)
//!       -> rows (row.rs): role, condition and trim, proposed from contents and names (proposed_rows.rs),
//!          overridden by the rules (rules.rs)
//!       -> parts (part.rs): channels matched by name (channel_match.rs), units converted as declared
//!       -> problems (problem_search.rs), or the draft of a dataset (assembled_draft.rs), checked once
//! ```

mod assembled_draft;
mod assembled_models;
mod assembled_records;
#[expect(
    clippy::module_inception,
    reason = "the file holds the type after which the folder is named"
)]
pub mod assembly;
mod channel_conversion;
pub mod channel_match;
pub mod channel_note;
mod condition_numbers;
pub mod declarations;
pub mod file_scope;
pub mod found_model;
mod indexed_part;
pub mod labels_from_name;
mod measured_parts;
mod name_contradictions;
mod name_likeness;
pub mod part;
mod path_pattern;
pub mod position_caution;
pub mod problem;
pub mod problem_lines;
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
