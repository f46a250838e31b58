//! An airspeed within the range of a correction.

/// An airspeed, cut to the range of a correction.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CutAirspeed {
    /// The airspeed \[kt\].
    pub kt: f64,
    /// The same as polynomials take it: (airspeed - mean) / half range.
    pub scaled: f64,
    /// The second variable on its scale from -1 to 1; 0, its middle, where there is none.
    pub second_scaled: f64,
}
