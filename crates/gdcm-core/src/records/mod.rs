//! From the columns of record files to flight records: time, channels, units.
//!
//! ```text
//! files -> tables of columns (io)   -> several records of one table apart: by a column, or where time restarts
//!                                   -> a layout proposed: time, and a column and a factor for each channel, every choice in words
//!                                   -> problems and cautions of what is chosen, or the flight record
//! ```
//!
//! Nothing is resampled, filtered or taken off here: samples are the file's, times a factor.

mod layout_problem;
mod layout_proposal;
#[cfg(test)]
mod layout_tests;
mod plausibility;
mod record_channels;
mod record_guess;
mod record_layout;
mod record_table;
mod separation;
mod time_base;

pub use layout_problem::{LayoutCaution, LayoutProblem};
pub use layout_proposal::{LayoutProposal, TimeWish};
pub use record_channels::RecordChannels;
pub use record_guess::RecordGuess;
pub use record_layout::{ColumnUse, RecordLayout};
pub use record_table::{ColumnSide, RecordColumn, RecordSource, RecordTable};
pub use separation::Separation;
pub use time_base::TimeBase;
