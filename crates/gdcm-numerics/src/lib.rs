//! Fourier transforms and convex programs from other crates, without type parameters.
//!
//! **Question answered:** how are generic algorithms compiled only once?
//!
//! Generic code is recompiled with every crate and test that uses it; in `gdcm-method` and
//! `gdcm-sysid` it made up a quarter of the machine code. This crate compiles it once.
//!
//! ```
//! use gdcm_numerics::FourierPlanner;
//!
//! // A constant signal has only line 0.
//! let transform = FourierPlanner::default().plan(4);
//! let lines = transform.transform(&mut [1.0; 4]).unwrap();
//! assert_eq!((lines[0].re, lines[1].norm()), (4.0, 0.0));
//! ```

mod convex_program;
mod fourier;

pub use clarabel::algebra::CscMatrix;
pub use clarabel::solver::DefaultSettings;
pub use convex_program::convex_program;
pub use fourier::{FourierPlanner, FourierTransform};
