//! An identified pole and its standard deviation.

use nalgebra::Complex;

/// An identified pole and its standard deviation.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PoleEstimate {
    /// Pole \[rad/s\].
    pub pole: Complex<f64>,
    /// Standard deviation of the real part \[rad/s\].
    pub sd_re: f64,
    /// Standard deviation of the imaginary part \[rad/s\].
    pub sd_im: f64,
    /// Whether the records determine the pole: it is not slower than the frequency band, and its
    /// standard deviation is at most half its modulus.
    pub determined: bool,
}
