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

mod laid_out_record;
mod layout_problem;
mod layout_proposal;
#[cfg(test)]
mod layout_tests;
mod record_channels;
mod record_layout;
mod record_table;
mod resampling;
mod spectrogram;
mod topic_tables;

use std::collections::{BTreeMap, BTreeSet};
use std::sync::Arc;

use nalgebra::DMatrix;

use crate::identification::FlightRecord;
use gdcm_model::assembly::{
    ChannelRule, Dimension, PhysicalUnit, SignedName, conversion_factor, folded_name, same_channel,
    sign_between, standard_patterns, time_name_rank,
};
use gdcm_model::dataset::{Channel, ChannelRemedy, ChannelSide, ConditionRecord, Dataset};
use gdcm_model::units::{number, telling};

pub use self::{
    laid_out_record::*, layout_problem::*, layout_proposal::*, record_channels::*,
    record_layout::*, record_table::*, resampling::*, spectrogram::*, topic_tables::*,
};
