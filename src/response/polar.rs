//! A frequency response as magnitude and phase, the form in which models are compared.

use crate::dataset::PairTable;
use crate::units::ratio_to_db;

use super::frequency_response::FrequencyResponse;

/// One response as `N` magnitudes \[dB\] and `N` principal phases \[rad\]; all finite.
#[derive(Clone, Debug, PartialEq)]
pub struct PolarCurve {
    /// `20 log10 |H|`.
    pub magnitude_db: Vec<f64>,
    /// `arg H` in (-pi, pi].
    pub phase: Vec<f64>,
}

/// Every response of a model as magnitude and phase.
///
/// An entry is `None` where the response is zero or not finite at some frequency (a structurally zero response, a pole on the
/// imaginary axis, measured data that does not reach): there it has no G, no D and no J (M6).
#[derive(Clone, Debug, PartialEq)]
pub struct PolarResponse {
    curves: PairTable<Option<PolarCurve>>,
}

impl PolarResponse {
    /// Magnitude and phase of every response.
    pub fn of(response: &FrequencyResponse) -> Self {
        let curves = response.values().map(|_, values| {
            let magnitude_db: Vec<f64> = values.iter().map(|value| ratio_to_db(value.norm())).collect();
            let phase: Vec<f64> = values.iter().map(|value| value.arg()).collect();
            let finite = magnitude_db.iter().chain(&phase).all(|value| value.is_finite());
            finite.then_some(PolarCurve { magnitude_db, phase })
        });
        Self { curves }
    }

    /// The curves, `[output, input]`.
    pub fn curves(&self) -> &PairTable<Option<PolarCurve>> {
        &self.curves
    }
}
