//! An airspeed within the range of a correction.

/// An airspeed, cut to the range of a correction.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CutAirspeed {
    /// The airspeed \[kt\].
    pub kt: f64,
    /// The same as polynomials take it: (airspeed - mean) / half range.
    pub scaled: f64,
}
