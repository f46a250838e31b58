//! A study's complete result.
//!
//! In each condition a physics and an identified model, the *representatives* of their bundles, are
//! compared: G and D are the gain and the delay that would match a response (M6), J is the cost of
//! the mismatch (M4). The physics models are first *moved* by the physics parameters (M18.5), if
//! any, then changed by the *couplings* (M16), if any, and last corrected by gains, delays and
//! leads. Functions with `file` in their names refer to the models before all of that.
//!
//! In names, *held* responses are the constrained ones; the *delta* gain and the *delta* delay are
//! the G and the D to which gains and delays are fitted.

use std::collections::BTreeMap;
use std::sync::Arc;

use gdcm_method::correction::{ChannelCorrection, GainBounds, Problem, Solution};
use gdcm_method::couplings::problem::CouplingError;
use gdcm_method::fidelity::Discontinuity;
use gdcm_method::fidelity::discontinuity::PerturbedModel;
use gdcm_method::fidelity::representative::Representative;
use gdcm_method::schedule::{CostChange, Schedule, ScheduleError};
use gdcm_method::uncertainty::Scalar;
use gdcm_model::dataset::{BundleKind, Condition, ConditionId, Dataset, Model, Pair, PairTable};

pub use super::condition_failure::{ConditionFailure, NoResult, NotAssessed};

use super::applied_physics::{AppliedPhysics, MovedCondition};
use super::caution::Caution;
use super::comparison::{BundleMetrics, Comparison};
use super::convention_doubt::ConventionDoubt;
use super::couplings_assessment::CouplingsAssessment;
use super::fitted_couplings::{CoupledCondition, FittedCouplings};
use super::lead_compensation::LeadCompensated;
use super::lead_offer::LeadOffer;
use super::physics_assessment::PhysicsAssessment;
use super::physics_findings::PhysicsFailure;
use super::uncertainty::Uncertainty;
use crate::decisions::requirement_settings::RequirementSettings;
use crate::decisions::study::Study;

/// Each condition's result, or why it has none.
pub(crate) type Outcomes = BTreeMap<ConditionId, Result<ConditionAnalysis, ConditionFailure>>;

/// The nominal model's J by response, before and after the scheduled correction (M12), or why the
/// condition is left out.
pub type Assessed = Result<PairTable<Option<CostChange>>, NotAssessed>;

/// Complete study result: conditions, couplings, schedule, assessment and uncertainty.
#[derive(Clone, Debug, PartialEq)]
pub struct Analysis {
    pub study: Study,
    /// Comparison frequencies \[rad/s\].
    pub omega: Arc<[f64]>,
    /// Each condition's result, or why it has none.
    pub conditions: BTreeMap<ConditionId, Result<ConditionAnalysis, ConditionFailure>>,
    /// Physics parameters and the models moved by them, before couplings, or why there are none;
    /// `None` where none are requested (M18.5).
    pub physics: Option<Result<Arc<AppliedPhysics>, PhysicsFailure>>,
    /// Benefit and cost of the physics parameters, once assessed
    /// ([`Engine::assess_physics`](crate::stages::engine::Engine::assess_physics)).
    pub physics_assessment: Option<Arc<PhysicsAssessment>>,
    /// Couplings applied to every physics model, or why there are none; `None` where none are
    /// requested (M16).
    pub couplings: Option<Result<Arc<FittedCouplings>, CouplingError>>,
    /// Benefit and cost of the couplings, once assessed
    /// ([`Engine::assess_couplings`](crate::stages::engine::Engine::assess_couplings)).
    pub coupling_assessment: Option<Arc<CouplingsAssessment>>,
    /// Channels with an apparent sign or unit difference between the physics and the identified
    /// models; reported before all other cautions.
    pub doubts: Vec<ConventionDoubt>,
    /// Schedule fitted to the conditions in [`Self::scheduled`], or why there is none.
    pub schedule: Result<Schedule, ScheduleError>,
    pub assessment: BTreeMap<ConditionId, Assessed>,
    /// Uncertainty of the values, once computed
    /// ([`Engine::uncertainty`](crate::stages::engine::Engine::uncertainty)).
    pub uncertainty: Option<Arc<Uncertainty>>,
}

impl Analysis {
    /// Returns a condition's result; `None` where it has none.
    pub fn condition(&self, id: ConditionId) -> Option<&ConditionAnalysis> {
        self.conditions.get(&id)?.as_ref().ok()
    }

    /// Returns a condition's result, or why there is none.
    pub(crate) fn result(&self, id: ConditionId) -> Result<&ConditionAnalysis, NoResult> {
        match self.conditions.get(&id) {
            Some(Ok(result)) => Ok(result),
            Some(Err(failure)) => Err(NoResult::Failed(failure.clone())),
            None => Err(NoResult::NotAnalysed),
        }
    }

    /// Returns the same analysis with other requirement settings.
    pub fn with_requirements(&self, settings: &Arc<RequirementSettings>) -> Self {
        let mut analysis = self.clone();
        analysis.study.requirements = Arc::clone(settings);
        analysis
    }

    /// Returns the physics parameters applied to the physics models; `None` where there are none.
    pub fn applied_physics(&self) -> Option<&Arc<AppliedPhysics>> {
        self.physics.as_ref()?.as_ref().ok()
    }

    /// Returns the physics parameters that the study requests; `None` where it requests none.
    ///
    /// # Errors
    /// [`PhysicsFailure`] if they are unavailable: an export without them would not match the
    /// request.
    pub fn requested_physics(&self) -> Result<Option<&Arc<AppliedPhysics>>, &PhysicsFailure> {
        match &self.physics {
            None => Ok(None),
            Some(Ok(applied)) => Ok(Some(applied)),
            Some(Err(failure)) => Err(failure),
        }
    }

    /// Returns the dataset whose physics models are compared and corrected: with the models moved
    /// by the physics parameters, or the study's dataset without parameters.
    pub fn moved_dataset(&self) -> &Arc<Dataset> {
        match self.applied_physics() {
            Some(applied) => &applied.dataset,
            None => &self.study.dataset,
        }
    }

    /// Returns the couplings applied to every physics model; `None` where there are none.
    pub fn fitted_couplings(&self) -> Option<&Arc<FittedCouplings>> {
        self.couplings.as_ref()?.as_ref().ok()
    }

    /// Returns the couplings that the study requests; `None` where it requests none.
    ///
    /// # Errors
    /// [`CouplingError`] if the requested couplings are unavailable: an export without them would
    /// not match the request.
    pub fn requested_couplings(&self) -> Result<Option<&Arc<FittedCouplings>>, &CouplingError> {
        match &self.couplings {
            None => Ok(None),
            Some(Ok(fitted)) => Ok(Some(fitted)),
            Some(Err(error)) => Err(error),
        }
    }
}

/// Analysed condition: model comparison, optimal gains and delays, cautions.
#[derive(Clone, Debug, PartialEq)]
pub struct ConditionAnalysis {
    /// The analysed condition, its physics models moved by the physics parameters where there are
    /// any; its model order applies to all results below.
    pub condition: Arc<Condition>,
    /// Distances within the bundles, and discontinuity ratios.
    pub bundle_metrics: Arc<BundleMetrics>,
    /// The condition and its comparison before its physics models are moved; `None` if they are not
    /// moved.
    pub moved: Option<MovedCondition>,
    /// The couplings, and the comparison without them; `None` without couplings.
    pub coupled: Option<CoupledCondition>,
    /// Representatives, G and D, with the couplings on the physics models where there are any
    /// (M16.3).
    pub comparison: Arc<Comparison>,
    /// Optimisation problem for the gains, eq. (7).
    pub gain_problem: Arc<Problem>,
    /// Optimisation problem for the delays, eq. (11), or for signed delays if requested (M15.4).
    pub delay_problem: Arc<Problem>,
    /// Optimal gains, eq. (7).
    pub gains: Arc<Solution>,
    /// Optimal delays, eq. (11), or signed delays, M15.4.
    pub delays: Arc<Solution>,
    /// Difference that remains after the leads, where leads are requested (M15.5).
    pub compensated: Option<Arc<LeadCompensated>>,
    /// Benefit of leads, offered where all constrained responses need lead and leads are not
    /// requested; `None` where J would not fall by more than a tenth.
    pub offer: Option<LeadOffer>,
    /// Gains and delays as one correction.
    pub correction: ChannelCorrection,
    /// The physics representative's J before and after this correction.
    pub cost: Arc<PairTable<Option<CostChange>>>,
    /// Channels with an apparent sign or unit difference in this condition.
    pub doubts: Vec<ConventionDoubt>,
    pub cautions: Vec<Caution>,
}

impl ConditionAnalysis {
    /// Returns the model comparison without couplings; [`Self::comparison`] if there are none.
    pub fn before_couplings(&self) -> &Comparison {
        match &self.coupled {
            Some(coupled) => &coupled.before,
            None => &self.comparison,
        }
    }

    /// Returns the model comparison as in the dataset, without physics parameters and couplings.
    pub fn file_comparison(&self) -> &Comparison {
        match &self.moved {
            Some(moved) => &moved.before,
            None => self.before_couplings(),
        }
    }

    /// Returns whether physics parameters or couplings change the physics models before the gains
    /// and delays.
    pub fn has_changed_physics(&self) -> bool {
        self.moved.is_some() || self.coupled.is_some()
    }

    /// Returns the condition as in the dataset.
    pub fn file_condition(&self) -> &Arc<Condition> {
        match &self.moved {
            Some(moved) => &moved.file,
            None => &self.condition,
        }
    }

    /// Returns the constrained responses for which G and D are defined.
    pub fn held(&self) -> &PairTable<bool> {
        &self.gain_problem.constrained
    }

    /// Returns the G used in the gain problem: G after the leads, where there are any.
    pub fn delta_gain(&self, pair: Pair) -> Option<f64> {
        self.gain_problem.delta[pair]
    }

    /// Returns the D used in the delay problem \[s\], by eq. (9) or M15.2.
    pub fn delta_delay_s(&self, pair: Pair) -> Option<f64> {
        self.delay_problem.delta[pair]
    }

    /// Returns whether the delays are fitted to D by M15.2, as leads always are, instead of eq.
    /// (9); `false` if both definitions give the same D in every response.
    pub fn fits_band_delays(&self) -> bool {
        let fitted = &self.delay_problem.delta;
        let delta = &self.comparison.delta;
        *fitted == delta.band_delay_s && *fitted != delta.delay_s
    }

    /// Returns the scalar by which the error bar (M13) of [`Self::delta_delay_s`] is found.
    pub fn delta_delay_scalar(&self, pair: Pair) -> Scalar {
        if self.delay_problem.delta[pair] == self.comparison.delta.delay_s[pair] {
            Scalar::Delay(pair)
        } else {
            Scalar::BandDelay(pair)
        }
    }

    /// Returns whether leads are in use: whether they are requested.
    pub fn has_leads(&self) -> bool {
        self.compensated.is_some()
    }

    /// Returns the bounds on every channel gain.
    pub fn gain_bounds(&self) -> GainBounds {
        self.gain_problem.bounds
    }

    /// Returns each channel's minimum and maximum delay \[s\]; leads are negative (M15.4).
    pub fn delay_bounds_s(&self) -> [f64; 2] {
        // Adding zero turns -0.0 into 0.0.
        [
            self.delay_problem.bounds.lower + 0.0,
            self.delay_problem.bounds.upper,
        ]
    }

    /// Returns the upper bound on every channel delay \[s\].
    pub fn delay_upper_s(&self) -> f64 {
        self.delay_problem.bounds.upper
    }

    /// Names the physics models suggested as outliers, including rejected models; empty without
    /// discontinuity ratios.
    pub fn suggested(&self) -> Vec<String> {
        let suggested = self
            .bundle_metrics
            .discontinuity
            .as_ref()
            .map(Discontinuity::suggested)
            .unwrap_or_default();
        let models = self.condition.bundle(BundleKind::Physics);
        suggested
            .into_iter()
            .map(|index| models[index].name.clone())
            .collect()
    }

    /// Returns a bundle's representative, with all models' scores in the order of the bundle in
    /// [`ConditionAnalysis::condition`].
    pub fn representative(&self, kind: BundleKind) -> &Representative {
        kind.pick(&self.comparison.physics, &self.comparison.identified)
    }

    /// Returns the model that represents a bundle.
    pub fn representative_model(&self, kind: BundleKind) -> &Model {
        &self.condition.bundle(kind)[self.representative(kind).model]
    }

    /// Returns the name of a bundle's representative.
    pub fn representative_name(&self, kind: BundleKind) -> &str {
        &self.representative_model(kind).name
    }

    /// Returns a model's mean distance to the other kept models; `None` for a model that is
    /// rejected or set aside.
    pub fn score(&self, kind: BundleKind, name: &str) -> Option<f64> {
        self.representative(kind).scores[self.condition.position(kind, name)?]
    }

    /// Returns a model's distances from the other kept models, whose mean is its score; `None` if
    /// the score is not defined.
    pub fn score_distances(&self, kind: BundleKind, name: &str) -> Option<Vec<f64>> {
        self.score(kind, name)?;
        let model = self.condition.position(kind, name)?;
        let distance = self.bundle_metrics.bundle(kind);
        Some(self.representative(kind).score_distances(distance, model))
    }

    /// Returns a physics model's discontinuity ratio, if defined.
    pub fn discontinuity_ratio(&self, name: &str) -> Option<f64> {
        let ratios = &self.bundle_metrics.discontinuity.as_ref().ok()?.ratios;
        ratios[self.condition.position(BundleKind::Physics, name)?]
    }

    /// Returns a physics model's distance ratios `r_ab` to the other models, whose median is its
    /// discontinuity ratio; `None` if there are no discontinuity ratios.
    pub fn pair_ratios(&self, name: &str) -> Option<Vec<f64>> {
        let fit = self.bundle_metrics.discontinuity.as_ref().ok()?;
        let model = self.condition.position(BundleKind::Physics, name)?;
        let bundle: Vec<PerturbedModel<'_>> = self
            .condition
            .bundle(BundleKind::Physics)
            .iter()
            .map(|model| PerturbedModel {
                name: &model.name,
                perturbation: model.perturbation(),
            })
            .collect();
        Some(fit.pair_ratios(&self.bundle_metrics.physics, &bundle, model))
    }
}
