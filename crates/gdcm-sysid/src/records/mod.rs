//! From record files' columns to flight records: time, channels, units.
//!
//! | stage | files |
//! |---|---|
//! | a file's columns, from the reader | [`record_table`], `record_identity` |
//! | stamps and their unit | [`time_base`], `stamp_unit`, [`sample_step`] |
//! | several records in a table | [`separation`] |
//! | topics in separate tables (M14.11) | [`topic_tables`], `topic_join`, `topic_names`, `side_by_side_tables` |
//! | channels to read | [`record_channels`], [`channel_list`], `channel_units`, [`dataset_of_records`] |
//! | columns for time and channels | [`layout_proposal`], [`layout_note`], `column_candidates`, `position_columns`, [`column_use`] |
//! | chosen columns, edited by the user | [`record_layout`], `layout_transfer` |
//! | checks | `layout_checks`, `plausible_units`, [`layout_problem`] |
//! | flight record | `layout_samples`, `channel_delay`, [`laid_out_record`] |
//! | separate clocks (M14.11) | `resampling`, [`stamped_channel`], [`common_clock`], [`resampling_error`] |
//! | further information about a record | [`record_copies`], `possible_references`, [`record_guess`], [`spectrogram`] |
//!
//! Samples are multiplied by a factor, and a logging delay is removed by interpolation; they are
//! not filtered or detrended. Only channels with separate clocks, or records with a requested
//! sample rate, are filtered and resampled to a common clock (M14.11), and this is reported.

mod channel_delay;
pub mod channel_list;
mod channel_units;
mod column_candidates;
pub mod column_use;
pub mod common_clock;
pub mod dataset_of_records;
pub mod laid_out_record;
#[cfg(test)]
mod laid_out_tests;
mod layout_checks;
pub mod layout_note;
pub mod layout_problem;
pub mod layout_proposal;
mod layout_samples;
#[cfg(test)]
mod layout_tests;
mod layout_transfer;
mod plausible_units;
mod position_columns;
mod possible_references;
pub mod record_channels;
pub mod record_copies;
pub mod record_guess;
mod record_identity;
pub mod record_layout;
pub mod record_table;
mod resampling;
pub mod resampling_error;
pub mod sample_step;
pub mod separation;
mod side_by_side_tables;
pub mod spectrogram;
mod stamp_unit;
pub mod stamped_channel;
pub mod time_base;
mod topic_join;
mod topic_names;
pub mod topic_tables;

pub use column_use::ColumnUse;
pub use laid_out_record::LaidOutRecord;
pub use layout_problem::LayoutProblem;
pub use layout_proposal::TimeSettings;
pub use record_channels::RecordChannels;
pub use record_copies::leave_out_copies;
pub use record_layout::RecordLayout;
pub use record_table::{ModeSpan, RecordColumn, RecordSource, RecordTable};
pub use topic_tables::with_topics_joined;
