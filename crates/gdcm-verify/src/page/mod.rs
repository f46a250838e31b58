//! `docs/verification.md`, made from the figures that the tests record.
//!
//! Tests write a JSON line for each comparison ([`figures::Figures::read`]) into the folder that
//! the environment variable `GDCM_EVIDENCE` names. The page shows the figures in
//! `tests/data/verification.json`; new ones replace them only if they differ by more than rounding
//! from machine to machine, so that the page is the same wherever it is made.

pub mod figures;
mod rows;
mod text;

pub use rows::{CoverageRow, EvidenceRow, SECTIONS, Section, coverage_rows, evidence_rows};
pub use text::page_text;
