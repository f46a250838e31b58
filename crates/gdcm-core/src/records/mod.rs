//! From the columns of record files to flight records: time, channels, units.
//!
//! ```text
//! files -> tables of columns (io)   -> several records of one table apart: by a column, or where time restarts
//!                                   -> a layout proposed: time, and a column and a factor for each channel, every choice in words
//!                                   -> problems and cautions of what is chosen, or the flight record
//! ```
//!
//! Samples are the file's, times a factor; nothing is filtered or taken off. Where the channels have clocks of their own, they are
//! brought to one (M14.11), and that is said.

mod channel_list;
mod laid_out_record;
mod layout_problem;
mod layout_proposal;
#[cfg(test)]
mod layout_tests;
mod record_dataset;
mod record_layout;
mod record_table;
mod resampling;
mod sample_units;
mod spectrogram;
mod time_base;
mod topic_tables;

use crate::dataset::ChannelSide;

pub use self::{
    channel_list::*, laid_out_record::*, layout_problem::*, layout_proposal::*, record_dataset::*, record_layout::*,
    record_table::*, resampling::*, spectrogram::*, time_base::*, topic_tables::*,
};
