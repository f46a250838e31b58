//! The Gain-Delay Correction Method: an engineer's decisions and their results.
//!
//! **Question answered:** given these settings, rejections and constraints, what is the correction,
//! and why? A *correction* gives each input and output channel of the physics model a gain and, if
//! the phase is corrected, a delay or a lead filter.
//!
//! A [`Study`] contains a dataset and all decisions ([`decisions`]); an [`Engine`] computes its
//! [`Analysis`] in [`stages`], each cached while its inputs stay the same. The [`results`] are
//! typed facts with numbers; [`jobs`] are longer computations in parallel to the interactive
//! analysis. An [`Execution`] (module [`execution`]) runs the pieces of an analysis on one or
//! several threads, reports progress and checks for cancellation. Values in [`shared`] are compared
//! by identity, so that a job's unchanged input is recognised without reading it.
//!
//! Section numbers (M4, M13.2, ...) are those of the pages listed under
//! [Sections M1 to M18](gdcm_method#sections-m1-to-m18).
//!
//! # Example
//!
//! A helicopter with one response, `q = g / (s + 1)` times the stick. The gain of the measured
//! response is larger by a fifth than that of the physics model:
//!
//! ```
//! use gdcm_model::dataset::condition::FlightState;
//! use gdcm_model::dataset::dataset::DatasetHeader;
//! use gdcm_model::dataset::model::Origin;
//! use gdcm_model::dataset::{
//!     Band, Channel, Condition, ConditionId, Dataset, Dynamics, Model, Pair, PairTable, StateSpace,
//! };
//! use gdcm_study::{Engine, Study, Unobserved};
//! use nalgebra::dmatrix;
//!
//! let lag = |g| StateSpace::new(dmatrix![-1.0], dmatrix![g], dmatrix![1.0], dmatrix![0.0]).map(Dynamics::StateSpace);
//! let nominal = Model::new("nominal", Origin::Nominal { perturbation: None }, lag(1.0)?);
//! let flight = Model::new("flight", Origin::Identified { method: None, order: None }, lag(1.2)?);
//! let hover = Condition::new(FlightState::at(ConditionId(1), 0.0), vec![nominal], vec![flight])?;
//! let (inputs, outputs) = (vec![Channel::new("LON", "%")], vec![Channel::new("Q", "deg/s")]);
//! let (on_axis, band) = (PairTable::filled(1, 1, true), Band::new(0.5, 12.0)?);
//! let header = DatasetHeader { name: "one axis".into(), description: String::new(), inputs, outputs, on_axis, band, parameters: Vec::new() };
//! let study = Study::new(Dataset::new(header, vec![hover])?.into());
//! // `Unobserved` ignores progress and never cancels.
//! let analysis = Engine::default().analyze(&study, &Unobserved)?;
//! let correction = &analysis.condition(ConditionId(1)).ok_or("no result")?.correction;
//! assert!((correction.net_gain(Pair::new(0, 0)) - 1.2).abs() < 1e-9);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

pub mod decisions;
pub mod execution;
pub mod jobs;
#[cfg(test)]
mod reference_tests;
pub mod results;
pub mod shared;
pub mod stages;

pub use decisions::edit::Edit;
pub use decisions::physics_settings::PhysicsCorrection;
pub use decisions::settings::{CouplingCorrection, PhaseCorrection};
pub use decisions::study::Study;
pub use execution::Execution;
pub use gdcm_model::progress::{Cancelled, Progress, Unobserved};
pub use jobs::across_role::AcrossRole;
pub use results::analysis::{Analysis, ConditionAnalysis};
pub use results::assessment_table::{AssessedCorrection, AssessmentTable};
pub use stages::engine::Engine;
