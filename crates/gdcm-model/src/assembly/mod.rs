//! From the models of many files to one dataset: what each is, which channel is which, in which unit.
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
mod assembly;
mod channel_match;
mod declarations;
mod found_model;
mod physical_unit;
mod problem;
mod response_name;
mod rules;

use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;

use serde::{Deserialize, Serialize};

use crate::dataset::{ChannelSide, ConditionRecord, ModelDraft, Origin, ResponseDraft};
use crate::units::number;

pub use assembly::*;
pub use channel_match::*;
pub use declarations::*;
pub use found_model::*;
pub use physical_unit::*;
pub use problem::*;
pub use response_name::*;
pub use rules::*;
