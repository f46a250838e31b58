//! From the columns of record files to flight records: time, channels, units.
//!
//! ```text
//! files -> tables of columns (io)   -> several records of one table apart: by a column, or where time restarts
//!                                   -> a layout proposed: time, and a column and a factor for each channel, every choice in words
//!                                   -> problems and cautions of what is chosen, or the flight record
//! ```
//!
//! Samples are those of the file, times a factor, without filtering or detrending. Channels with
//! separate clocks are resampled to a common clock (M14.11), and this is reported.

pub mod laid_out_record;
pub mod layout_problem;
pub mod layout_proposal;
#[cfg(test)]
mod layout_tests;
pub mod record_channels;
pub mod record_layout;
pub mod record_table;
pub mod resampling;
pub mod spectrogram;
pub mod topic_tables;

pub use laid_out_record::{LaidOutRecord, leave_out_copies};
pub use layout_problem::LayoutProblem;
pub use layout_proposal::TimeWish;
pub use record_channels::RecordChannels;
pub use record_layout::{ColumnUse, RecordLayout};
pub use record_table::{ModeSpan, RecordColumn, RecordSource, RecordTable};
pub use topic_tables::with_topics_joined;
