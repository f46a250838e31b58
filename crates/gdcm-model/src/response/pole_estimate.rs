//! An identified pole and its standard deviation.

use nalgebra::Complex;

/// Half-width of a pole's interval, in standard deviations: on known aircraft it contains about
/// nine in ten poles, where 2 contain eight (M14.22). The interval is approximate, because in a
/// low-order model a pole may represent several true poles.
pub const POLE_INTERVAL: f64 = 3.0;

/// An identified pole and its standard deviation.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PoleEstimate {
    /// Pole \[rad/s\].
    pub pole: Complex<f64>,
    /// Standard deviation of the real part \[rad/s\].
    pub sd_re: f64,
    /// Standard deviation of the imaginary part \[rad/s\].
    pub sd_im: f64,
    /// Whether the records determine the pole: it is within the frequency band, and
    /// [`POLE_INTERVAL`] standard deviations are at most half its modulus.
    pub determined: bool,
}
