//! From record files' columns to flight records: time, channels, units.
//!
//! | stage | files |
//! |---|---|
//! | a file's columns, from the reader | [`record_table`], [`time_base`] |
//! | several records in a table | [`separation`] |
//! | topics with separate clocks (M14.11) | [`topic_tables`], `topic_names`, `side_by_side`, [`topics`] |
//! | channels to read | [`record_channels`], [`channel_list`], [`dataset_of_records`] |
//! | columns for time and channels | [`layout_proposal`], `column_candidates`, [`column_use`] |
//! | checks | `layout_checks`, `plausible_units`, [`layout_problem`] |
//! | flight record | `layout_samples`, `resampling`, [`laid_out_record`] |
//!
//! Samples are read from the file and multiplied by a factor, never filtered or detrended. Channels
//! with separate clocks are resampled to a common clock (M14.11), and this is reported.

pub mod channel_list;
mod column_candidates;
pub mod column_use;
pub mod dataset_of_records;
pub mod laid_out_record;
#[cfg(test)]
mod laid_out_tests;
mod layout_checks;
pub mod layout_problem;
pub mod layout_proposal;
mod layout_samples;
#[cfg(test)]
mod layout_tests;
mod plausible_units;
pub mod record_channels;
pub mod record_guess;
pub mod record_layout;
pub mod record_table;
mod resampling;
pub mod separation;
mod side_by_side;
pub mod spectrogram;
pub mod time_base;
mod topic_names;
pub mod topic_tables;
pub mod topics;

pub use column_use::ColumnUse;
pub use laid_out_record::{LaidOutRecord, leave_out_copies};
pub use layout_problem::LayoutProblem;
pub use layout_proposal::TimeWish;
pub use record_channels::RecordChannels;
pub use record_layout::RecordLayout;
pub use record_table::{ModeSpan, RecordColumn, RecordSource, RecordTable};
pub use topic_tables::with_topics_joined;
