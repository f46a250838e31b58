//! An identified pole with its standard deviation.

use nalgebra::Complex;

/// A pole with its uncertainty.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PoleEstimate {
    /// The pole \[rad/s\].
    pub pole: Complex<f64>,
    /// Standard deviation of the real part \[rad/s\].
    pub sd_re: f64,
    /// Standard deviation of the imaginary part \[rad/s\].
    pub sd_im: f64,
    /// Whether the records determine the pole: it does not lie below the band, and its standard
    /// deviation is at most half its modulus.
    pub determined: bool,
}
