//! The physics representative's responses before and after the physics parameters, without their
//! differences in gain and delay from the identified representative's.
//!
//! ```text
//! H G exp(-j omega D),   G = median |H_ref| / |H|,   D = median Delta phi / omega      (eq. (5), (9))
//! ```
//!
//! H is the physics representative, H_ref the identified one, Delta phi the phase by which H leads
//! H_ref. A *shape* is a response's magnitude and phase over frequency. Gains and delays belong to
//! the channel correction; a physics parameter should improve what they cannot.

use std::sync::Arc;

use gdcm_method::fidelity::{CostAverage, Mismatch};
use gdcm_model::dataset::Pair;
use gdcm_model::response::response_shape::ResponseShape;
use gdcm_model::response::{FrequencyResponse, GainDelay};

use super::comparison::Comparison;
use super::without_and_with::WithoutAndWith;

/// A response of both representatives, the physics one without and with the parameters, each with
/// its own G and D.
#[derive(Clone, Debug, PartialEq)]
pub struct ResponseShapes {
    pub pair: Pair,
    /// J after G and D.
    pub cost: WithoutAndWith<f64>,
    /// The identified representative at the comparison's frequencies.
    pub identified: ResponseShape,
    /// The physics representative after G and D; NaN at frequencies that do not count (M4a).
    pub physics: WithoutAndWith<ResponseShape>,
}

/// A condition's two representatives, compared without and with the parameters.
#[derive(Clone, Copy, Debug)]
pub(crate) struct ShapeSources<'a> {
    /// Comparison frequencies \[rad/s\].
    pub(crate) omega: &'a [f64],
    /// The identified representative's response at these frequencies.
    pub(crate) identified: &'a FrequencyResponse,
    pub(crate) without: &'a Comparison,
    pub(crate) with: &'a Comparison,
    pub(crate) average: CostAverage,
}

impl ShapeSources<'_> {
    /// Returns every response that both comparisons cover, the most improved first.
    pub(crate) fn responses(&self) -> Vec<ResponseShapes> {
        let mut responses = Vec::new();
        for (pair, _) in self.without.representative.mismatch.iter() {
            if let Some(response) = self.response(pair) {
                responses.push(response);
            }
        }
        responses.sort_by(|a, b| improvement(b).total_cmp(&improvement(a)));
        responses
    }

    /// Returns a response without and with the parameters; `None` where G and D are undefined in
    /// either.
    fn response(&self, pair: Pair) -> Option<ResponseShapes> {
        let identified = ResponseShape::new(self.identified.curve(pair));
        let without = self.shaped(self.without, pair, &identified)?;
        let with = self.shaped(self.with, pair, &identified)?;
        Some(ResponseShapes {
            pair,
            cost: WithoutAndWith {
                without: without.cost,
                with: with.cost,
            },
            identified,
            physics: WithoutAndWith {
                without: without.shape,
                with: with.shape,
            },
        })
    }

    /// Returns a comparison's physics representative after G and D; `None` where these are
    /// undefined.
    fn shaped(
        &self,
        comparison: &Comparison,
        pair: Pair,
        identified: &ResponseShape,
    ) -> Option<ShapedResponse> {
        let mismatch = comparison.representative.mismatch[pair].as_ref()?;
        let correction = GainDelay::new(
            comparison.delta.gain[pair]?,
            comparison.delta.delay_s[pair]?,
        );
        Some(ShapedResponse {
            cost: mismatch.cost(self.omega, correction, self.average).total(),
            shape: self.shape(mismatch, correction, identified),
        })
    }

    /// Returns the physics response after G and D: the identified response plus what remains of the
    /// difference `physics - identified` (in dB and in phase) after `correction`.
    fn shape(
        &self,
        mismatch: &Mismatch,
        correction: GainDelay,
        identified: &ResponseShape,
    ) -> ResponseShape {
        let omega = mismatch.omega(self.omega);
        let magnitude_db: Vec<f64> = correction
            .magnitudes_db(&mismatch.magnitude_db, omega)
            .collect();
        let phase = mismatch.phase_difference(self.omega);
        let phase_deg = correction
            .phases(&phase, omega)
            .map(f64::to_degrees)
            .collect();
        let points = self.omega.len();
        ResponseShape {
            magnitude_db: sum(
                &identified.magnitude_db,
                &mismatch.on_grid(magnitude_db, points),
            ),
            phase_deg: sum(&identified.phase_deg, &mismatch.on_grid(phase_deg, points)),
        }
    }
}

/// A response after G and D, and its J.
struct ShapedResponse {
    cost: f64,
    shape: ResponseShape,
}

fn improvement(response: &ResponseShapes) -> f64 {
    response.cost.without - response.cost.with
}

fn sum(a: &[f64], b: &[f64]) -> Arc<[f64]> {
    a.iter().zip(b).map(|(a, b)| a + b).collect()
}
