//! The Gain-Delay Correction Method: models, flight conditions and their responses.
//!
//! **Question answered:** which data did the engineer load, and how does a model respond?
//!
//! | module | holds |
//! |---|---|
//! | [`dataset`] | channels, models, measured responses, flight conditions; checked at construction |
//! | [`response`] | frequency responses, poles, zeros, lead filters |
//! | [`simulation`] | time responses: flight records, and a model simulated against them |
//! | [`statistics`] | mean, median, quantiles |
//! | [`assembly`] | models from many files into one dataset: roles, channels, conversions |
//! | [`names`] | channel aliases and signs, response names, patterns of file names |
//! | [`units`] | physical units and conversions |
//! | [`number_format`] | numbers as text: formats shared by messages, files, plots and the window |
//! | [`executor`], [`progress`] | parallel tasks, progress and cancellation |
//! | [`message_text`], [`whole_number`] | sanitised text, and whole numbers in JSON |
//!
//! The crate depends on no files, windows or threads. Section numbers (M2, M14.6, M18.1, ...) are
//! those of the pages listed in `docs/README.md`: M1 to M12 in `docs/method.md`, M14 in
//! `docs/identification.md`, M15 in `docs/lead.md`, M18 in `docs/physics.md`.
//!
//! ```
//! use gdcm_model::dataset::{Pair, StateSpace};
//! use gdcm_model::response::mode::poles;
//! use nalgebra::dmatrix;
//!
//! // q = 1 / (s + 2) times the stick
//! let lag = StateSpace::new(dmatrix![-2.0], dmatrix![1.0], dmatrix![1.0], dmatrix![0.0])?;
//! assert_eq!(poles(&lag).map(|poles| poles[0].re), Some(-2.0));
//! # let _ = Pair::new(0, 0);
//! # Ok::<(), gdcm_model::dataset::state_space::StateSpaceError>(())
//! ```

pub mod assembly;
pub mod dataset;
pub mod executor;
pub mod message_text;
pub mod names;
pub mod number_format;
pub mod progress;
pub mod response;
pub mod simulation;
pub mod statistics;
pub mod units;
pub mod whole_number;
