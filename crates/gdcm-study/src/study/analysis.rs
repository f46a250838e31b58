//! The result of a whole study.

use std::collections::BTreeMap;
use std::sync::Arc;

use gdcm_method::correction::problem::ProblemError;
use gdcm_method::correction::{ChannelCorrection, GainBounds, Problem, Solution};
use gdcm_method::couplings::problem::CouplingError;
use gdcm_method::fidelity::Discontinuity;
use gdcm_method::fidelity::distance::Representative;
use gdcm_method::schedule::assessment::{compare_forms, compare_lead_degrees};
use gdcm_method::schedule::{CostChange, FormComparison, LeadDegreeFit, Schedule, ScheduleError};
use gdcm_method::uncertainty::Scalar;
use gdcm_model::dataset::{BundleKind, Condition, ConditionId, Model, Pair, PairTable};

use super::Study;
use super::caution::Caution;
use super::comparison::{BundleMetrics, Comparison};
use super::convention_doubt::ConventionDoubt;
use super::couplings_assessment::CouplingsAssessment;
use super::couplings_words::no_couplings;
use super::engine::{schedule_settings, scheduled_points};
use super::fitted_couplings::{CoupledCondition, FittedCouplings};
use super::lead_compensation::{LeadCompensated, LeadOffer};
use super::remark::Remark;
use super::uncertainty::Uncertainty;

/// J of every response of the nominal model of a condition before and after the scheduled correction (M12), or in words why the
/// condition is left out.
pub type Assessed = Result<PairTable<Option<CostChange>>, String>;

/// Everything the analysis says of a study.
#[derive(Clone, Debug, PartialEq)]
pub struct Analysis {
    /// The study that was analysed.
    pub study: Study,
    /// Frequencies of comparison \[rad/s\].
    pub omega: Arc<[f64]>,
    /// Result of each condition.
    pub conditions: BTreeMap<ConditionId, Result<ConditionAnalysis, ConditionFailure>>,
    /// The couplings that every physics model has gone through, or why there are none; nothing where they are not asked for (M16).
    pub couplings: Option<Result<Arc<FittedCouplings>, CouplingError>>,
    /// What the couplings are worth and what they cost, once that was asked for ([`super::couplings_assessment::CouplingsJob`]).
    pub coupling_assessment: Option<Arc<CouplingsAssessment>>,
    /// Channels that one side seems to have in another sign or unit: what is said first.
    pub doubts: Vec<ConventionDoubt>,
    /// The schedule of the chosen conditions.
    pub schedule: Result<Schedule, ScheduleError>,
    /// Assessment of each condition.
    pub assessment: BTreeMap<ConditionId, Assessed>,
    /// How sure its figures are, once that has been asked for ([`Engine::uncertainty`](super::engine::Engine::uncertainty)).
    pub uncertainty: Option<Arc<Uncertainty>>,
}

impl Analysis {
    /// Result of one condition, where there is one.
    pub fn condition(&self, id: ConditionId) -> Option<&ConditionAnalysis> {
        self.conditions.get(&id)?.as_ref().ok()
    }

    /// The same, or in words why there is none.
    pub(super) fn result(&self, id: ConditionId) -> Result<&ConditionAnalysis, String> {
        let outcome = self.conditions.get(&id).ok_or("it was not analysed")?;
        outcome.as_ref().map_err(ToString::to_string)
    }

    /// The couplings that every physics model has gone through, where there are any.
    pub fn fitted_couplings(&self) -> Option<&Arc<FittedCouplings>> {
        self.couplings.as_ref()?.as_ref().ok()
    }

    /// The couplings of a study that is to have some; none where it asks for none.
    ///
    /// # Errors
    /// Why there are none, in words that name the channels: what would leave without them is not what was asked for.
    pub fn asked_couplings(&self) -> Result<Option<&Arc<FittedCouplings>>, String> {
        let words = |error: &CouplingError| error.words(&self.study.dataset.names_of_channels().0);
        self.couplings
            .as_ref()
            .map(|found| found.as_ref().map_err(words))
            .transpose()
    }

    /// What has to be said of the couplings: why there are none, or what they mean, are worth and cost, as far as that was asked for.
    pub fn coupling_remarks(&self) -> Vec<Remark> {
        match (self.asked_couplings(), &self.coupling_assessment) {
            (Err(why), _) => vec![no_couplings(&why)],
            (Ok(Some(_)), Some(assessment)) => assessment.remarks(&self.study.dataset),
            _ => Vec::new(),
        }
    }

    /// The conditions that the schedule is made of, in the dataset's order: the chosen ones that have a result.
    pub fn scheduled(&self) -> Vec<ConditionId> {
        self.study
            .dataset
            .ids()
            .filter(|id| self.study.choice(*id).is_in_schedule() && self.condition(*id).is_some())
            .collect()
    }

    /// The schedule of the chosen conditions without one of them.
    ///
    /// # Errors
    /// [`ScheduleError`] where there is none.
    pub fn schedule_without(&self, left_out: ConditionId) -> Result<Schedule, ScheduleError> {
        let mut others = self.study.clone();
        if let Some(choice) = others.choices.get_mut(&left_out) {
            choice.scheduled = false;
        }
        let settings = schedule_settings(&others, &self.conditions);
        Schedule::of(&scheduled_points(&others, &self.conditions), settings)
    }

    /// What speaks for each form of the schedule, its lists in the order of [`Analysis::scheduled`] (M11). Some hundred small
    /// least squares problems.
    ///
    /// # Errors
    /// [`ScheduleError`] where there is no schedule.
    pub fn compare_forms(&self) -> Result<FormComparison, ScheduleError> {
        compare_forms(
            &scheduled_points(&self.study, &self.conditions),
            self.study.settings.schedule,
        )
    }

    /// What speaks for each degree of the scheduled signed delays; none where leads are not asked for (M15.5).
    pub fn compare_lead_degrees(&self) -> Vec<LeadDegreeFit> {
        compare_lead_degrees(
            &scheduled_points(&self.study, &self.conditions),
            self.study.settings.schedule,
        )
    }
}

/// Everything the analysis says of one condition.
#[derive(Clone, Debug, PartialEq)]
pub struct ConditionAnalysis {
    /// The condition that was analysed: it names the models that the figures below are in the order of.
    pub condition: Arc<Condition>,
    /// Distances and discontinuity ratios of the bundles.
    pub figures: Arc<BundleMetrics>,
    /// What the couplings have changed; none without couplings.
    pub coupled: Option<CoupledCondition>,
    /// Representatives, G and D, of physics models with couplings where there are any (M16.3).
    pub comparison: Arc<Comparison>,
    /// What the gains were asked to do.
    pub gain_problem: Arc<Problem>,
    /// What the delays, or the signed delays, were asked to do.
    pub delay_problem: Arc<Problem>,
    /// Optimal gains, eq. (7).
    pub gains: Arc<Solution>,
    /// Optimal delays, eq. (11), or signed delays, M15.4.
    pub delays: Arc<Solution>,
    /// What the leads leave, where leads are asked for (M15.5).
    pub compensated: Option<Arc<LeadCompensated>>,
    /// What leads would buy, where all held responses want lead and leads are not asked for.
    pub offer: Option<LeadOffer>,
    /// Both as one correction.
    pub correction: ChannelCorrection,
    /// J of the physics representative before and after this correction.
    pub cost: Arc<PairTable<Option<CostChange>>>,
    /// Channels that seem to have another sign or unit here.
    pub doubts: Vec<ConventionDoubt>,
    /// What the engineer has to know about the result.
    pub cautions: Vec<Caution>,
}

impl ConditionAnalysis {
    /// The comparison of the models as they are: before the couplings, where there are any.
    pub fn before_couplings(&self) -> &Comparison {
        self.coupled
            .as_ref()
            .map_or(&self.comparison, |coupled| &coupled.before)
    }

    /// Responses held: the constrained ones that are defined.
    pub fn held(&self) -> &PairTable<bool> {
        &self.gain_problem.constrained
    }

    /// G of a response as the gains were asked for it: of what the leads leave, where there are any.
    pub fn wanted_gain(&self, pair: Pair) -> Option<f64> {
        self.gain_problem.delta[pair]
    }

    /// D of a response as the delays were asked for it \[s\]: of eq. (9), or of M15.2.
    pub fn wanted_delay_s(&self, pair: Pair) -> Option<f64> {
        self.delay_problem.delta[pair]
    }

    /// Whether the delays were asked for the D of M15.2, which leads always are, and not for that of eq. (9).
    pub fn asks_band_delays(&self) -> bool {
        let asked = &self.delay_problem.delta;
        let delta = &self.comparison.delta;
        *asked == delta.band_delay_s && *asked != delta.delay_s
    }

    /// The value of which [`Self::wanted_delay_s`] is one: its bar stands beside it (M13).
    pub fn wanted_delay(&self, pair: Pair) -> Scalar {
        let is_median = self.delay_problem.delta[pair] == self.comparison.delta.delay_s[pair];
        if is_median {
            Scalar::Delay(pair)
        } else {
            Scalar::BandDelay(pair)
        }
    }

    /// Bounds of every channel gain.
    pub fn gain_bounds(&self) -> GainBounds {
        self.gain_problem.bounds
    }

    /// Least and greatest delay of every channel \[s\]; leads are negative (M15.4).
    pub fn delay_bounds_s(&self) -> [f64; 2] {
        // Adding zero turns minus zero into zero.
        [
            self.delay_problem.bounds.lower + 0.0,
            self.delay_problem.bounds.upper,
        ]
    }

    /// Upper bound of every channel delay \[s\].
    pub fn delay_upper_s(&self) -> f64 {
        self.delay_problem.bounds.upper
    }

    /// Names of the physics models suggested as outliers, whatever is rejected.
    pub fn suggested(&self) -> Vec<String> {
        let suggested = self
            .figures
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

    /// The representative of a bundle, with the scores of its models in the order of [`ConditionAnalysis::condition`].
    pub fn representative(&self, kind: BundleKind) -> &Representative {
        kind.pick(&self.comparison.physics, &self.comparison.identified)
    }

    /// The model that represents a bundle.
    pub fn representative_model(&self, kind: BundleKind) -> &Model {
        &self.condition.bundle(kind)[self.representative(kind).model]
    }

    /// Its name.
    pub fn representative_name(&self, kind: BundleKind) -> &str {
        &self.representative_model(kind).name
    }

    /// Mean distance of a model to the other kept ones, where it has one.
    pub fn score(&self, kind: BundleKind, name: &str) -> Option<f64> {
        self.representative(kind).scores[self.condition.position(kind, name)?]
    }

    /// Discontinuity ratio of a physics model, where it has one.
    pub fn discontinuity_ratio(&self, name: &str) -> Option<f64> {
        let ratios = &self.figures.discontinuity.as_ref().ok()?.ratios;
        ratios[self.condition.position(BundleKind::Physics, name)?]
    }
}

/// Why a condition has no result.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum ConditionFailure {
    /// The condition has no identified model.
    #[error(
        "no identified models yet, so there is no reference to compare the physics models with; identify them from the condition's \
         flight records (gdcm identify RECORDS --into DATASET, or Identify from records in the window), or add identified models"
    )]
    NoReference,
    /// The two representatives share no response that both have over the whole band.
    #[error(
        "no response of \"{physics}\" can be compared with \"{identified}\" over the whole band: each is zero, not finite or out of \
         the range of gains somewhere; choose another representative, or another band{because}"
    )]
    NothingToCompare {
        /// Name of the physics representative.
        physics: String,
        /// Name of the identified representative.
        identified: String,
        /// What is known of the models' responses, each after "; ".
        because: String,
    },
    /// Every model kept is set aside (M5b).
    #[error(
        "no {bundle} model is left to compare: each one kept lacks a measuring response that another model of the bundle \
         has; restore one that has them all, or narrow the band"
    )]
    AllSetAside {
        /// Which.
        bundle: BundleKind,
    },
    /// The gains could not be computed.
    #[error("the gains could not be computed: {0}")]
    Gains(ProblemError),
    /// The delays could not be computed.
    #[error("the delays could not be computed: {0}")]
    Delays(ProblemError),
}

impl ConditionFailure {
    /// Stable name of the reason, for programs and tests.
    pub fn code(&self) -> &'static str {
        match self {
            Self::NoReference => "no-reference",
            Self::NothingToCompare { .. } => "nothing-to-compare",
            Self::AllSetAside { .. } => "all-set-aside",
            Self::Gains(_) => "gains-not-computed",
            Self::Delays(_) => "delays-not-computed",
        }
    }
}
