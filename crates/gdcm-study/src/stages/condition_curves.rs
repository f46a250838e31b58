//! A condition's frequency responses for drawing.
//!
//! Curves extend beyond the comparison band. The physics models are drawn as in the dataset, and
//! *moved* by the physics parameters (M18.5) and *coupled* by mixing and feedback (M16). A
//! *variant* is an alternative set of decisions, whose result is drawn beside the present one.

use std::sync::{Arc, Mutex, PoisonError};

use gdcm_method::correction::lead_price::ABOVE_BAND;
use gdcm_model::dataset::{Band, BundleKind, Condition};
use gdcm_model::response::{FrequencyGrid, FrequencyResponse, PreparedModel};

use super::condition_responses::ConditionResponses;
use crate::decisions::settings::{PhaseCorrection, Settings};
use crate::results::analysis::ConditionAnalysis;
use crate::results::applied_physics::AppliedPhysics;
use crate::results::fitted_couplings::FittedCouplings;

/// Number of frequencies in drawn curves.
pub const CURVE_POINTS: usize = 500;
/// Factor by which the drawn band extends beyond the comparison band at either end.
const DISPLAY_MARGIN: f64 = 1.7;
/// Maximum number of stored coupled responses: the previous and the present representative, for a
/// result and for a variant.
const MOST_STORED: usize = 4;

/// A condition's responses on a grid for drawing.
#[derive(Debug)]
pub struct ConditionCurves {
    /// The condition; the responses are in its model order.
    pub condition: Arc<Condition>,
    pub grid: FrequencyGrid,
    pub physics: Vec<Arc<FrequencyResponse>>,
    pub identified: Vec<Arc<FrequencyResponse>>,
    /// Moved and coupled responses computed for the most recent requests, with their inputs.
    coupled: Mutex<Vec<CoupledCurve>>,
}

/// A physics model's response with the physics parameters and couplings from a result.
#[derive(Debug)]
struct CoupledCurve {
    physics: Option<Arc<AppliedPhysics>>,
    fitted: Option<Arc<FittedCouplings>>,
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

    /// Returns a physics model's response moved by the physics parameters and with the couplings
    /// from `result`, where it has any.
    pub fn with_couplings(
        &self,
        result: &ConditionAnalysis,
        model: usize,
    ) -> Arc<FrequencyResponse> {
        if !result.has_changed_physics() {
            return Arc::clone(&self.physics[model]);
        }
        let physics = result.moved.as_ref().map(|moved| &moved.applied);
        let fitted = result.coupled.as_ref().map(|coupled| &coupled.fitted);
        let mut stored = self.coupled.lock().unwrap_or_else(PoisonError::into_inner);
        let known = stored.iter().find(|curve| {
            curve.model == model
                && are_same(curve.physics.as_ref(), physics)
                && are_same(curve.fitted.as_ref(), fitted)
        });
        if let Some(curve) = known {
            return Arc::clone(&curve.response);
        }
        let uncoupled = match &result.moved {
            None => Arc::clone(&self.physics[model]),
            Some(_) => {
                let moved = &result.condition.bundle(BundleKind::Physics)[model];
                Arc::new(PreparedModel::new(&moved.dynamics).response(&self.grid))
            }
        };
        let response = Arc::new(result.coupled_response(&uncoupled).into_owned());
        stored.truncate(MOST_STORED - 1);
        let curve = CoupledCurve {
            physics: physics.cloned(),
            fitted: fitted.cloned(),
            model,
            response: Arc::clone(&response),
        };
        stored.insert(0, curve);
        response
    }

    /// Returns the responses of a bundle's models, in file order.
    pub fn bundle(&self, kind: BundleKind) -> &[Arc<FrequencyResponse>] {
        kind.pick(&self.physics, &self.identified)
    }
}

/// Returns whether two shared values are the same object, or both are missing.
fn are_same<T>(a: Option<&Arc<T>>, b: Option<&Arc<T>>) -> bool {
    match (a, b) {
        (Some(a), Some(b)) => Arc::ptr_eq(a, b),
        (None, None) => true,
        _ => false,
    }
}

/// Returns the band drawn around a comparison band: it extends by the factor 1.7 on either side.
pub fn display_band(band: Band) -> Band {
    Band::beyond(band.min() / DISPLAY_MARGIN, band.max() * DISPLAY_MARGIN).unwrap_or(band)
}

/// Returns the band for a condition's curves: [`display_band`], extended to ten times the
/// comparison band's upper end where leads are requested, to show their effect (M15.6).
pub fn curves_band(settings: &Settings) -> Band {
    let usual = display_band(settings.band);
    let top = match settings.phase {
        PhaseCorrection::Lead => settings.band.max() * ABOVE_BAND,
        PhaseCorrection::None | PhaseCorrection::Delay => settings.band.max(),
    };
    Band::beyond(usual.min(), usual.max().max(top)).unwrap_or(usual)
}
