//! A condition's frequency responses for drawing.

use std::sync::{Arc, Mutex, PoisonError};

use gdcm_method::correction::lead_price::ABOVE_BAND;
use gdcm_model::dataset::{Band, BundleKind, Condition};
use gdcm_model::response::{FrequencyGrid, FrequencyResponse};

use super::condition_responses::ConditionResponses;
use crate::decisions::settings::{PhaseCorrection, Settings};
use crate::results::analysis::ConditionAnalysis;
use crate::results::fitted_couplings::FittedCouplings;

/// A condition's responses on a grid for drawing.
#[derive(Debug)]
pub struct ConditionCurves {
    /// The condition; its models define the order of the responses.
    pub condition: Arc<Condition>,
    pub grid: FrequencyGrid,
    pub physics: Vec<Arc<FrequencyResponse>>,
    pub identified: Vec<Arc<FrequencyResponse>>,
    /// Coupled responses drawn last, with their inputs.
    coupled: Mutex<Vec<CoupledCurve>>,
}

/// A physics model's response with couplings.
#[derive(Debug)]
struct CoupledCurve {
    fitted: Arc<FittedCouplings>,
    model: usize,
    response: Arc<FrequencyResponse>,
}

impl ConditionCurves {
    pub(crate) fn new(
        condition: Arc<Condition>,
        grid: FrequencyGrid,
        responses: ConditionResponses,
    ) -> Self {
        let ConditionResponses {
            physics,
            identified,
            ..
        } = responses;
        Self {
            condition,
            grid,
            physics,
            identified,
            coupled: Mutex::default(),
        }
    }

    /// Returns a physics model's `H~` under a result's couplings; `H` without couplings.
    pub fn with_couplings(
        &self,
        result: &ConditionAnalysis,
        model: usize,
    ) -> Arc<FrequencyResponse> {
        /// A result and a variant, each with its representative now and before.
        const KEPT: usize = 4;
        let Some(coupled) = &result.coupled else {
            return Arc::clone(&self.physics[model]);
        };
        let mut kept = self.coupled.lock().unwrap_or_else(PoisonError::into_inner);
        let known = kept
            .iter()
            .find(|curve| curve.model == model && Arc::ptr_eq(&curve.fitted, &coupled.fitted));
        if let Some(curve) = known {
            return Arc::clone(&curve.response);
        }
        let response = Arc::new(result.coupled_response(&self.physics[model]).into_owned());
        kept.truncate(KEPT - 1);
        let curve = CoupledCurve {
            fitted: Arc::clone(&coupled.fitted),
            model,
            response: Arc::clone(&response),
        };
        kept.insert(0, curve);
        response
    }

    /// Returns a bundle's responses.
    pub fn bundle(&self, kind: BundleKind) -> &[Arc<FrequencyResponse>] {
        kind.pick(&self.physics, &self.identified)
    }
}

/// How many frequencies drawn curves have.
pub const CURVE_POINTS: usize = 500;

/// Returns the band drawn around a comparison band: wider by the factor 1.7 on either side.
pub fn display_band(band: Band) -> Band {
    const MARGIN: f64 = 1.7;
    Band::beyond(band.min() / MARGIN, band.max() * MARGIN).unwrap_or(band)
}

/// Returns the band for a condition's curves: [`display_band`], and up to ten times the band where
/// leads are requested, to show their effect above it (M15.6).
pub fn curves_band(settings: &Settings) -> Band {
    let usual = display_band(settings.band);
    let top = match settings.phase {
        PhaseCorrection::Lead => settings.band.max() * ABOVE_BAND,
        PhaseCorrection::None | PhaseCorrection::Delay => settings.band.max(),
    };
    Band::beyond(usual.min(), usual.max().max(top)).unwrap_or(usual)
}
