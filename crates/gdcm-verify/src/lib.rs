//! Compares the program's results with figures from independent code, closed forms and
//! publications.
//!
//! **Question answered:** does this program, on this machine, compute what other programs and closed
//! forms give?
//!
//! [`CHECKS`] lists the comparisons: what is compared, the section of the method (`docs/method.md` and
//! the pages beside it), where the expected values come from, and the tolerance with its reason. [`Verification::new`] runs all
//! comparisons from embedded reference values, within seconds, without files. [`page`] makes
//! `docs/verification.md` from the figures that the tests record.
//!
//! # Example
//!
//! ```
//! use gdcm_verify::CHECKS;
//!
//! let gains = CHECKS.iter().find(|check| check.code == "certified-gains").ok_or("no check")?;
//! assert_eq!(gains.sections, "M8");
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod check;
mod checks;
#[cfg(test)]
#[path = "../../../tests/support/evidence.rs"]
mod evidence;
pub mod page;
mod reference;
mod reference_study;
mod verification;

pub use check::{Check, CheckFault, Found};
pub use checks::CHECKS;
pub use verification::{CheckResult, Verification};
