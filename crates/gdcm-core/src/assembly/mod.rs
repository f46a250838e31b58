//! From the models of many files to one dataset: what each is, which channel is which, in which unit.
//!
//! ```text
//! files -> found models (io)     -> rows: what names and contents propose, as the rules say it otherwise
//!                                -> channels matched by name, units converted as declared
//!                                -> problems, or the draft of a dataset, which is checked once
//! ```

#[expect(clippy::module_inception, reason = "the room is named by what it makes")]
mod assembly;
mod channel_alias;
mod channel_match;
mod conversion;
mod found_model;
mod merge;
mod pattern;
mod physical_unit;
mod problem;
mod proposal;
mod row;
mod rules;

pub use assembly::{Assembly, Part};
pub use channel_alias::same_channel;
pub use channel_match::{ChannelMatch, ChannelUse};
pub use found_model::{ChannelLabel, Facts, FoundModel};
pub use pattern::{NamePattern, PatternError, standard_patterns};
pub use physical_unit::{Dimension, PhysicalUnit, conversion_factor};
pub use problem::{Problem, ProblemKind};
pub use proposal::proposed_rules;
pub use row::{Row, RowRole};
pub use rules::{ChannelRule, Headings, RowRule, Rules, UnitRule};
