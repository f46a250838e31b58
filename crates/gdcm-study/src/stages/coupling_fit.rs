//! Fits a study's couplings (M16.1, M16.2).
//!
//! ```text
//! 1  each condition's representatives, with the channel delays that are optimal without couplings
//! 2  mean of these delays over the conditions
//! 3  each condition: response of the identified representative without the mean delays and their
//!    leads; its standard deviation, from the model or from its coherence; coherence weights
//! 4  fit to all conditions                                           (`gdcm_method::couplings`)
//! ```
//!
//! Couplings are a mixing of the inputs and a feedback from outputs to inputs, the same for all
//! conditions. Step 1 is `ConditionStages::coupling_source`, step 2 is in `CouplingFitKey::new`.
//! Without step 3 the feedback would imitate a delay (M16.1).

use std::sync::Arc;

use gdcm_method::correction::Channels;
use gdcm_method::correction::lead_design::{LeadDesign, LeadSettings};
use gdcm_method::couplings::problem::{
    CouplingError, CouplingOptions, coherence_deviation, mean_delays_s, response_deviation,
    without_delays_and_leads,
};
use gdcm_method::couplings::{CouplingCondition, CouplingKind, CouplingProblem, fit_couplings};
use gdcm_method::fidelity::CoherenceWeights;
use gdcm_model::dataset::model::{ContentHash, ModelBands};
use gdcm_model::dataset::{BundleKind, Condition, ConditionId, Dynamics, Model, PairTable};
use gdcm_model::executor::Executor;
use gdcm_model::progress::{Cancelled, Progress};
use gdcm_model::response::interpolation::coherence_at;
use gdcm_model::response::{FrequencyGrid, FrequencyResponse};

use super::known_models::GridKey;
use crate::decisions::settings::{PhaseCorrection, Settings};
use crate::decisions::study::Study;
use crate::results::comparison::Comparison;
use crate::results::fitted_couplings::FittedCouplings;

/// The requested couplings, or why there are none.
pub(crate) type CouplingOutcome = Result<Arc<FittedCouplings>, CouplingError>;

/// A condition's input to the coupling fit: its representatives, and its channel delays without
/// couplings.
pub(crate) struct CouplingSource {
    pub(crate) condition: Arc<Condition>,
    pub(crate) comparison: Arc<Comparison>,
    /// The channels' signed delays \[s\] (M9, M15).
    pub(crate) delays_s: Channels<f64>,
    /// Representatives' hashes, physics first.
    pub(crate) contents: [ContentHash; 2],
    /// The physics representative's response.
    pub(crate) physics: Arc<FrequencyResponse>,
    /// The identified representative's response.
    pub(crate) flight: Arc<FrequencyResponse>,
}

impl CouplingSource {
    fn identified(&self) -> &Model {
        &self.condition.bundle(BundleKind::Identified)[self.comparison.identified.model]
    }

    fn airspeed_kt(&self) -> f64 {
        self.condition.flight_state().airspeed_kt
    }

    /// Returns the responses that can be compared in both representatives (M6, M6a).
    fn usable(&self) -> PairTable<bool> {
        self.comparison
            .representative
            .mismatch
            .map(|_, mismatch| mismatch.is_some())
    }
}

/// Inputs from a condition on which the fit depends.
#[derive(Clone, Debug, PartialEq)]
struct ConditionKey {
    id: ConditionId,
    airspeed_kt: f64,
    /// Representatives' hashes, physics first.
    contents: [ContentHash; 2],
    usable: PairTable<bool>,
    bands: Option<Arc<ModelBands>>,
}

/// Averaging assumed for measured responses that do not state it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Averaging {
    averages: Option<f64>,
    /// Window length \[s\].
    window_s: Option<f64>,
    /// Whether the windows overlap by half.
    half_overlap: bool,
}

impl Averaging {
    pub(crate) fn new(settings: &Settings) -> Self {
        Self {
            averages: settings.uncertainty.averages,
            window_s: settings.uncertainty.window_s,
            half_overlap: settings.uncertainty.half_overlap,
        }
    }
}

/// All inputs on which the fit depends. The gain weight and bounds are not among them.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct CouplingFitKey {
    kind: CouplingKind,
    grid: GridKey,
    on_axis: PairTable<bool>,
    airspeed_tolerance_kt: f64,
    lead: Option<LeadSettings>,
    coherence: Option<f64>,
    averaging: Averaging,
    delays_s: Option<Channels<f64>>,
    conditions: Vec<ConditionKey>,
}

impl CouplingFitKey {
    pub(crate) fn new(study: &Study, kind: CouplingKind, sources: &[CouplingSource]) -> Self {
        let settings = &study.settings;
        let delays_s: Vec<Channels<f64>> = sources
            .iter()
            .map(|source| source.delays_s.clone())
            .collect();
        Self {
            kind,
            grid: (settings.band, settings.points),
            on_axis: study.dataset.on_axis().clone(),
            airspeed_tolerance_kt: settings.schedule.airspeed_tolerance_kt,
            lead: match settings.phase {
                PhaseCorrection::Lead => Some(settings.lead),
                PhaseCorrection::None | PhaseCorrection::Delay => None,
            },
            coherence: settings.coherence_threshold,
            averaging: Averaging::new(settings),
            delays_s: mean_delays_s(&delays_s),
            conditions: sources
                .iter()
                .map(|source| ConditionKey {
                    id: source.condition.id(),
                    airspeed_kt: source.airspeed_kt(),
                    contents: source.contents,
                    usable: source.usable(),
                    bands: source.identified().bands.clone(),
                })
                .collect(),
        }
    }

    /// Builds the fit problem for these conditions (step 3, M16.1).
    fn problem(
        &self,
        study: &Study,
        grid: &FrequencyGrid,
        sources: &[CouplingSource],
    ) -> CouplingProblem {
        let omega: Arc<[f64]> = grid.omega().into();
        let design = self
            .lead
            .map(|lead| LeadDesign::new(lead, Arc::clone(&omega)));
        let mut conditions = Vec::new();
        for source in sources {
            let dynamics = &source.identified().dynamics;
            let flight = match &self.delays_s {
                Some(delays_s) => {
                    without_delays_and_leads(&source.flight, &omega, delays_s, design.as_ref())
                }
                None => (*source.flight).clone(),
            };
            conditions.push(CouplingCondition {
                id: source.condition.id(),
                airspeed_kt: source.airspeed_kt(),
                physics: Arc::clone(&source.physics),
                flight,
                usable: source.usable(),
                deviation: deviation(study, source.identified(), &omega),
                coherence: CoherenceWeights::of_model(dynamics, &omega, self.coherence),
            });
        }
        CouplingProblem {
            kind: self.kind,
            conditions,
            on_axis: self.on_axis.clone(),
            options: CouplingOptions {
                airspeed_tolerance_kt: self.airspeed_tolerance_kt,
                ..CouplingOptions::default()
            },
            omega,
        }
    }

    /// Fits couplings to these conditions (steps 3 and 4), or returns why there are none.
    ///
    /// # Errors
    /// [`Cancelled`] soon after `progress` requests it.
    pub(crate) fn fit(
        &self,
        study: &Study,
        grid: &FrequencyGrid,
        sources: &[CouplingSource],
        executor: &dyn Executor,
        progress: &dyn Progress,
    ) -> Result<CouplingOutcome, Cancelled> {
        let problem = self.problem(study, grid, sources);
        match fit_couplings(&problem, executor, progress) {
            Err(CouplingError::Cancelled(cancelled)) => Err(cancelled),
            Err(error) => Ok(Err(error)),
            Ok(fit) => Ok(Ok(Arc::new(FittedCouplings { problem, fit }))),
        }
    }
}

/// Returns the standard deviation of `ln H` (M16.2): first from the identified model's standard
/// deviations; else from a measured response's coherence, if coherence is used and the averaging is
/// known; else `None`.
pub(crate) fn deviation(
    study: &Study,
    identified: &Model,
    omega: &[f64],
) -> Option<PairTable<Vec<f64>>> {
    if let Some(bands) = &identified.bands {
        return Some(response_deviation(bands, omega));
    }
    let settings = &study.settings;
    let (Dynamics::Measured(response), Some(_)) =
        (&identified.dynamics, settings.coherence_threshold)
    else {
        return None;
    };
    let estimate = response.estimate();
    let measurement = settings
        .uncertainty
        .measurement(estimate.averages, estimate.window_s)?;
    Some(coherence_deviation(
        &coherence_at(response, omega)?,
        &measurement,
    ))
}
