//! The Gain-Delay Correction Method: from flight records to identified models (M14).
//!
//! **Question answered:** which linear model does the flight show, and how well is it known?
//!
//! | module | holds |
//! |---|---|
//! | [`records`] | from the columns of record files to flight records: time, channels, units |
//! | [`identification`] | from flight records to models: spectra, CT-PBSID, refinement, validation, cautions |
//!
//! Nothing here knows of files, windows or threads.
//!
//! ```
//! use gdcm_model::response::frequency_response::log_spaced;
//!
//! let omega = log_spaced(0.5, 12.0, 3);
//! assert!((omega[1] - 6.0_f64.sqrt()).abs() < 1e-12);
//! ```

pub mod identification;
pub mod records;
