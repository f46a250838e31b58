//! The Gain-Delay Correction Method: from flight records to identified models (M14).
//!
//! **Question answered:** which linear model describes the flight, and how uncertain is it?
//!
//! | module | contents |
//! |---|---|
//! | [`records`] | from record files' columns to flight records: time, channels, units |
//! | [`spectra`] | preparation, spectra, and the response without a model |
//! | [`subspace`] | models of all orders by CT-PBSID |
//! | [`likelihood`] | the cost, its minimum, and the covariance there |
//! | [`diagnostics`] | doubts about the model, as typed facts |
//! | [`planning`] | the intervals that further sweeps will bring |
//! | [`identification`] | the whole run, from flight records to a model with its uncertainty |
//! | [`options`], [`identification_error`] | settings of the run, and the reasons why it fails |
//!
//! Nothing here touches files, windows or threads. Sections M14.1 to M14.25, cited in the sources,
//! are in `docs/identification.md`; M4, the cost J, is in `docs/method.md`.
//!
//! ```
//! use gdcm_model::dataset::StateSpace;
//! use gdcm_model::executor::Sequential;
//! use gdcm_model::progress::Unobserved;
//! use gdcm_model::simulation::{FirstOrderHold, FlightRecord};
//! use gdcm_sysid::identification::identify::identify;
//! use gdcm_sysid::identification::{Options, Preparation};
//! use nalgebra::{DMatrix, DVector, dmatrix};
//!
//! // A roll axis with a time constant of 0.5 s, swept from 0.5 to 16 rad/s within a minute.
//! let aircraft = StateSpace::new(dmatrix![-2.0], dmatrix![1.0], dmatrix![8.0], dmatrix![0.0])?;
//! let time_s: Vec<f64> = (0..3000).map(|k| 0.02 * f64::from(k)).collect();
//! let growth = 32.0_f64.ln() / 60.0;
//! let inputs = DMatrix::from_fn(3000, 1, |k, _| {
//!     (0.5 / growth * ((growth * time_s[k]).exp() - 1.0)).sin()
//! });
//! let hold = FirstOrderHold::new(&aircraft, 0.02).expect("a finite model");
//! let mut outputs = hold.simulate(&DVector::zeros(1), &inputs);
//! for (k, rate) in outputs.iter_mut().enumerate() {
//!     *rate += 0.05 * (1e4 * (k as f64 + 1.0).sin()).fract(); // noise of the sensor
//! }
//! let record = FlightRecord { name: "sweep".to_owned(), time_s, inputs, outputs };
//!
//! let options = Options::new([1.0, 12.0], Preparation::new(&["LAT"], &["P"]));
//! let found = identify(&[record], &options, &Sequential, &Unobserved)?;
//!
//! let roll = &found.poles[0];
//! assert!((roll.pole.re + 2.0).abs() < 4.0 * roll.sd_re);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

pub mod diagnostics;
#[cfg(test)]
#[path = "../../../tests/support/evidence.rs"]
mod evidence;
pub mod identification;
pub mod identification_error;
pub mod likelihood;
pub mod options;
pub mod planning;
pub mod records;
pub mod spectra;
pub mod subspace;
