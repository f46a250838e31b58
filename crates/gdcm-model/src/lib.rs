//! The Gain-Delay Correction Method: models, flight conditions and their responses.
//!
//! **Question answered:** what did the engineer load, and how does one model respond?
//!
//! | module | holds |
//! |---|---|
//! | [`dataset`] | channels, models, measured responses, flight conditions; checked once, at construction |
//! | [`response`] | frequency responses, poles, zeros, lead filters |
//! | [`simulation`] | time responses: flight records, and a model simulated against them |
//! | [`assembly`] | from the models of many files to one dataset: names, channels, units |
//! | [`units`] | conversions of units, and numbers in text |
//! | [`executor`], [`progress`] | parallel work, and how far it has come |
//! | [`message_text`], [`whole_number`] | text and whole numbers of files |
//!
//! Nothing here knows of files, windows or threads.
//!
//! ```
//! use gdcm_model::dataset::{Pair, StateSpace};
//! use response::eigenvalues::poles;
//! use nalgebra::dmatrix;
//!
//! // q = 1 / (s + 2) times the stick
//! let lag = StateSpace::new(dmatrix![-2.0], dmatrix![1.0], dmatrix![1.0], dmatrix![0.0])?;
//! assert_eq!(poles(&lag).map(|poles| poles[0].re), Some(-2.0));
//! # let _ = Pair::new(0, 0);
//! # Ok::<(), dataset::state_space::StateSpaceError>(())
//! ```

pub mod assembly;
pub mod dataset;
pub mod executor;
pub mod message_text;
pub mod progress;
pub mod response;
pub mod simulation;
pub mod units;
pub mod whole_number;
