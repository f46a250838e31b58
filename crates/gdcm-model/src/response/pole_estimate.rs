//! An identified pole with its standard deviation.

use nalgebra::Complex;

/// A pole with its uncertainty.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PoleEstimate {
    /// The pole \[rad/s\].
    pub pole: Complex<f64>,
    /// Standard deviation of its real part \[rad/s\].
    pub sd_re: f64,
    /// Standard deviation of its imaginary part \[rad/s\].
    pub sd_im: f64,
    /// Whether the records determine it: not below the band, and with a standard deviation of at
    /// most half its modulus.
    pub determined: bool,
}
