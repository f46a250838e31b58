//! The couplings of a study: their fit (M16.1, M16.2), and a condition's physics models with
//! couplings, the only source of coupled models for exports (M16.3).

use std::borrow::Cow;
use std::sync::Arc;

use gdcm_method::correction::corrected_model::CorrectedModel;
use gdcm_method::correction::leads::{LeadDesign, LeadSettings};
use gdcm_method::correction::{ChannelCorrection, Channels, Pade};
use gdcm_method::couplings::fit::CouplingFit;
use gdcm_method::couplings::problem::{
    CouplingError, CouplingOptions, coherence_deviation, mean_delays_s, response_deviation,
    without_channels,
};
use gdcm_method::couplings::{
    CoupledModelError, CouplingCondition, CouplingKind, CouplingMatrices, CouplingProblem,
    PoleShift, fit_couplings,
};
use gdcm_method::fidelity::CoherenceWeights;
use gdcm_model::dataset::model::{ContentHash, ModelBands};
use gdcm_model::dataset::{
    BundleKind, Condition, ConditionId, Dynamics, Model, PairTable, StateSpace,
};
use gdcm_model::executor::Executor;
use gdcm_model::progress::{Cancelled, Progress};
use gdcm_model::response::curve_values::coherence_at;
use gdcm_model::response::{FrequencyGrid, FrequencyResponse};

use super::comparison::Comparison;
use super::condition_responses::GridKey;
use crate::decisions::settings::PhaseCorrection;
use crate::decisions::study::Study;
use crate::results::analysis::{Analysis, ConditionAnalysis};

/// The couplings of a study.
#[derive(Clone, Debug)]
pub struct FittedCouplings {
    /// Problem of the fit: the representatives of the conditions that are analysed and not held
    /// out.
    pub problem: CouplingProblem,
    pub fit: CouplingFit,
}

impl PartialEq for FittedCouplings {
    /// Two fits with the same numbers have the same effect on every model, whatever their data.
    fn eq(&self, other: &Self) -> bool {
        self.fit == other.fit
    }
}

impl FittedCouplings {
    /// Returns the matrices of mixing and feedback.
    pub fn matrices(&self) -> &CouplingMatrices {
        &self.fit.matrices
    }

    /// Returns whether the couplings were fitted to a condition.
    pub fn is_fitted_to(&self, condition: ConditionId) -> bool {
        self.problem.conditions.iter().any(|of| of.id == condition)
    }
}

/// The requested couplings, or why there are none.
pub(crate) type CouplingOutcome = Result<Arc<FittedCouplings>, CouplingError>;

/// Contribution of one condition to the fit: its representatives, and its channel delays without
/// couplings.
pub(crate) struct CouplingSource {
    pub(crate) condition: Arc<Condition>,
    pub(crate) comparison: Arc<Comparison>,
    /// Signed delays of the channels \[s\] (M9, M15).
    pub(crate) delays_s: Channels<f64>,
    /// Hashes of the physics and of the identified representative.
    pub(crate) contents: [ContentHash; 2],
    /// Response of the physics representative.
    pub(crate) physics: Arc<FrequencyResponse>,
    /// Response of the identified representative.
    pub(crate) flight: Arc<FrequencyResponse>,
}

impl CouplingSource {
    fn identified(&self) -> &Model {
        &self.condition.bundle(BundleKind::Identified)[self.comparison.identified.model]
    }

    fn airspeed_kt(&self) -> f64 {
        self.condition.flight_state().airspeed_kt
    }

    fn usable(&self) -> PairTable<bool> {
        self.comparison
            .representative
            .mismatch
            .map(|_, mismatch| mismatch.is_some())
    }
}

/// Dependencies of a fit in one condition.
#[derive(Clone, Debug, PartialEq)]
struct ConditionKey {
    id: ConditionId,
    airspeed_kt: f64,
    /// Hashes of the physics and of the identified representative.
    contents: [ContentHash; 2],
    usable: PairTable<bool>,
    bands: Option<Arc<ModelBands>>,
}

/// All dependencies of a fit: neither the weight of the gains nor their bounds are among them.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct CouplingFitKey {
    kind: CouplingKind,
    grid: GridKey,
    on_axis: PairTable<bool>,
    airspeed_tolerance_kt: f64,
    lead: Option<LeadSettings>,
    coherence: Option<f64>,
    /// Number and length \[s\] of the averages of measured responses that do not state them, and
    /// whether the windows overlap by half.
    averaging: (Option<f64>, Option<f64>, bool),
    delays_s: Option<Channels<f64>>,
    conditions: Vec<ConditionKey>,
}

impl CouplingFitKey {
    pub(crate) fn of(study: &Study, kind: CouplingKind, sources: &[CouplingSource]) -> Self {
        let settings = &study.settings;
        let averaging = &settings.uncertainty;
        let condition = |of: &CouplingSource| ConditionKey {
            id: of.condition.id(),
            airspeed_kt: of.airspeed_kt(),
            contents: of.contents,
            usable: of.usable(),
            bands: of.identified().bands.clone(),
        };
        Self {
            kind,
            grid: (settings.band, settings.points),
            on_axis: study.dataset.on_axis().clone(),
            airspeed_tolerance_kt: settings.schedule.airspeed_tolerance_kt,
            lead: (settings.phase == PhaseCorrection::Lead).then_some(settings.lead),
            coherence: settings.coherence_threshold,
            averaging: (
                averaging.averages,
                averaging.window_s,
                averaging.half_overlap,
            ),
            delays_s: mean_delays_s(
                &sources
                    .iter()
                    .map(|of| of.delays_s.clone())
                    .collect::<Vec<_>>(),
            ),
            conditions: sources.iter().map(condition).collect(),
        }
    }

    /// Builds the problem of these sources (M16.1).
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
        let condition = |of: &CouplingSource| {
            let dynamics = &of.identified().dynamics;
            let flight = self.delays_s.as_ref().map_or_else(
                || (*of.flight).clone(),
                |delays_s| without_channels(&of.flight, &omega, delays_s, design.as_ref()),
            );
            CouplingCondition {
                id: of.condition.id(),
                airspeed_kt: of.airspeed_kt(),
                physics: Arc::clone(&of.physics),
                flight,
                usable: of.usable(),
                deviation: deviation(study, of.identified(), &omega),
                coherence: CoherenceWeights::of_model(dynamics, &omega, self.coherence),
            }
        };
        CouplingProblem {
            kind: self.kind,
            conditions: sources.iter().map(condition).collect(),
            on_axis: self.on_axis.clone(),
            options: CouplingOptions {
                airspeed_tolerance_kt: self.airspeed_tolerance_kt,
                ..CouplingOptions::default()
            },
            omega,
        }
    }

    /// Fits the couplings of these sources, or returns why there are none.
    pub(crate) fn fit(
        &self,
        study: &Study,
        grid: &FrequencyGrid,
        sources: &[CouplingSource],
        (executor, progress): (&dyn Executor, &dyn Progress),
    ) -> Result<CouplingOutcome, Cancelled> {
        let problem = self.problem(study, grid, sources);
        match fit_couplings(&problem, executor, progress) {
            Err(CouplingError::Cancelled(cancelled)) => Err(cancelled),
            Err(error) => Ok(Err(error)),
            Ok(fit) => Ok(Ok(Arc::new(FittedCouplings { problem, fit }))),
        }
    }
}

/// Returns the standard deviation of `ln H` from the bands of an identified model, or from its
/// coherence where that is used (M16.2).
fn deviation(study: &Study, identified: &Model, omega: &[f64]) -> Option<PairTable<Vec<f64>>> {
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

/// Changes that the couplings make in a condition.
#[derive(Clone, Debug, PartialEq)]
pub struct CoupledCondition {
    /// Comparison of the models without couplings, which selects the representatives.
    pub before: Arc<Comparison>,
    pub fitted: Arc<FittedCouplings>,
}

impl ConditionAnalysis {
    fn airspeed_kt(&self) -> f64 {
        self.condition.flight_state().airspeed_kt
    }

    /// Returns `H~ = (I - H K)^-1 H M~` of a response of one of its physics models; the response
    /// itself without couplings.
    #[must_use]
    pub fn coupled_response<'a>(
        &self,
        physics: &'a FrequencyResponse,
    ) -> Cow<'a, FrequencyResponse> {
        match &self.coupled {
            None => Cow::Borrowed(physics),
            Some(coupled) => Cow::Owned(
                coupled
                    .fitted
                    .matrices()
                    .response(physics, self.airspeed_kt()),
            ),
        }
    }

    /// Returns how the couplings move the poles of the physics representative; `None` without
    /// couplings, or where it has no poles.
    #[must_use]
    pub fn pole_shifts(&self) -> Vec<PoleShift> {
        let representative = self.representative_model(BundleKind::Physics).state_space();
        let shifts = self
            .coupled
            .as_ref()
            .zip(representative)
            .map(|(coupled, of)| {
                coupled
                    .fitted
                    .matrices()
                    .pole_shifts(of, self.airspeed_kt(), Pade::default())
                    .unwrap_or_default()
            });
        shifts.unwrap_or_default()
    }

    /// Returns the matrices of one of its physics models with the couplings; the model itself
    /// without couplings. Delays of its own channels, which lie inside the loop, become states:
    /// `pade` approximants, or whole samples.
    ///
    /// # Errors
    /// [`CoupledModelError`] where the loop through the feed-through is singular or
    /// ill-conditioned.
    pub fn coupled_model<'a>(
        &self,
        physics: &'a StateSpace,
        pade: Pade,
    ) -> Result<Cow<'a, StateSpace>, CoupledModelError> {
        coupled_model(
            self.coupled.as_ref().map(|coupled| &coupled.fitted),
            physics,
            self.airspeed_kt(),
            pade,
        )
    }

    /// Returns `M_O H~ M_I`: a physics model with the couplings, then with a correction of its
    /// channels.
    ///
    /// # Errors
    /// As [`ConditionAnalysis::coupled_model`], and where the correction's delays or leads cannot
    /// become states.
    pub fn corrected_model(
        &self,
        physics: &StateSpace,
        correction: &ChannelCorrection,
        pade: Pade,
    ) -> Result<CorrectedModel, CoupledModelError> {
        let coupled = self.coupled_model(physics, pade)?;
        Ok(CorrectedModel::new(&coupled, correction, pade)?)
    }
}

/// Returns a physics model with the couplings in its matrices; the model itself without couplings.
fn coupled_model<'a>(
    fitted: Option<&Arc<FittedCouplings>>,
    physics: &'a StateSpace,
    airspeed_kt: f64,
    pade: Pade,
) -> Result<Cow<'a, StateSpace>, CoupledModelError> {
    match fitted {
        None => Ok(Cow::Borrowed(physics)),
        Some(fitted) => fitted
            .matrices()
            .model(physics, airspeed_kt, pade)
            .map(Cow::Owned),
    }
}

impl Analysis {
    /// Returns `M_O H~ M_I` of a physics model of any condition, also of a condition without a
    /// result.
    ///
    /// # Errors
    /// As [`ConditionAnalysis::corrected_model`].
    pub fn corrected_model(
        &self,
        condition: &Condition,
        physics: &StateSpace,
        correction: &ChannelCorrection,
        pade: Pade,
    ) -> Result<CorrectedModel, CoupledModelError> {
        let airspeed_kt = condition.flight_state().airspeed_kt;
        let coupled = coupled_model(self.fitted_couplings(), physics, airspeed_kt, pade)?;
        Ok(CorrectedModel::new(&coupled, correction, pade)?)
    }
}
