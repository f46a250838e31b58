//! `docs/verification.md`, made from the figures that the tests record.
//!
//! Tests write a line of JSON for each comparison ([`figures::Figures::read`]) into the folder that
//! the environment variable `GDCM_EVIDENCE` names. The figures in `tests/data/verification.json` are
//! those of the page; new ones replace them only where they differ by more than rounding does from
//! machine to machine, so that the page is the same wherever it is made.

pub mod figures;
mod rows;
mod text;

pub use rows::{CoverageRow, EvidenceRow, SECTIONS, Section, coverage_rows, evidence_rows};
pub use text::page_text;
