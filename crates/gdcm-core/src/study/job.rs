//! Long work that is done beside the live answer.

use std::sync::Arc;

use crate::correction::{Problem, ProblemError, ProofBudget, Solution, Toggle, solve, toggles};
use crate::dataset::{Band, BundleKind, Condition, ConditionId, Dataset, Model, ModelId, Pair};
use crate::fidelity::{ModeTrack, mode_tracks};
use crate::response::{FrequencyGrid, FrequencyResponse, GainDelay, Mode, ModesError, PreparedModel, modes_of};

use super::{
    Analysis, Cancelled, ConditionAnalysis, ConditionCurves, Engine, FittedCouplings, Progress, Study, Uncertainty,
    in_turn,
};

/// One piece of long work with progress and cancellation, done beside the live answer.
///
/// Two jobs are equal where they have the same output: a job under way is given up only when no equal one is asked for any more.
pub trait Job: Clone + PartialEq + Send + 'static {
    /// What it works with, kept from one job to the next.
    type Tools;
    /// What it makes.
    type Output: Send;

    /// Does the work.
    ///
    /// # Errors
    /// [`Cancelled`] soon after `progress` says so.
    fn run(&self, tools: &mut Self::Tools, progress: &dyn Progress) -> Result<Self::Output, Cancelled>;

    /// Whether `newer`, which is asked for in its place, is quicker once it is done; `done` of `total` steps are behind. Then it goes on.
    fn serves(&self, _newer: &Self, _done: usize, _total: usize) -> bool {
        false
    }
}

/// The whole proof of equation (7) for one condition, where the live answer's budget did not reach.
#[derive(Clone, Debug, PartialEq)]
pub struct ProofJob {
    /// What the gains are asked to do.
    pub problem: Arc<Problem>,
}

impl Job for ProofJob {
    type Tools = ();
    type Output = Result<Arc<Solution>, ProblemError>;

    fn run(&self, (): &mut (), progress: &dyn Progress) -> Result<Self::Output, Cancelled> {
        match solve(&self.problem, ProofBudget::default(), &|| progress.cancelled()) {
            Err(ProblemError::Stopped) => Err(Cancelled),
            solved => Ok(solved.map(Arc::new)),
        }
    }
}

/// What holding or freeing each response of one condition would cost.
#[derive(Clone, Debug)]
pub struct TogglesJob {
    /// The condition's result.
    pub condition: ConditionAnalysis,
}

impl TogglesJob {
    /// Whether the costs are those of this result: they depend on its two problems, and on the objectives that they are
    /// compared with.
    pub fn is_of(&self, condition: &ConditionAnalysis) -> bool {
        let (a, b) = (&self.condition, condition);
        let same_problems = a.gain_problem == b.gain_problem && a.delay_problem == b.delay_problem;
        same_problems && a.gains.objective == b.gains.objective && a.delays.objective == b.delays.objective
    }
}

impl PartialEq for TogglesJob {
    fn eq(&self, other: &Self) -> bool {
        self.is_of(&other.condition)
    }
}

impl Job for TogglesJob {
    type Tools = ();
    /// None where a problem has no answer.
    type Output = Option<Toggles>;

    fn run(&self, (): &mut (), progress: &dyn Progress) -> Result<Self::Output, Cancelled> {
        let toggles = Toggles::of(&self.condition, &|| progress.cancelled());
        if progress.cancelled() { Err(Cancelled) } else { Ok(toggles) }
    }
}

/// The responses of every model of one condition, for drawing.
#[derive(Clone, Debug)]
pub struct CurvesJob {
    /// The models.
    pub dataset: Arc<Dataset>,
    /// The condition.
    pub condition: ConditionId,
    /// Band, and the number of frequencies in it.
    pub grid: (Band, usize),
}

impl PartialEq for CurvesJob {
    fn eq(&self, other: &Self) -> bool {
        let same_dataset = Arc::ptr_eq(&self.dataset, &other.dataset);
        same_dataset && self.condition == other.condition && self.grid == other.grid
    }
}

impl Job for CurvesJob {
    /// The engine that keeps the models prepared.
    type Tools = Engine;
    /// None of a condition that the dataset does not have.
    type Output = Option<Arc<ConditionCurves>>;

    fn run(&self, engine: &mut Engine, progress: &dyn Progress) -> Result<Self::Output, Cancelled> {
        engine.curves(&self.dataset, self.condition, self.grid, progress)
    }
}

/// The modes of every model of one condition.
#[derive(Clone, Debug)]
pub struct ModesJob {
    /// The condition.
    pub condition: Arc<Condition>,
}

impl PartialEq for ModesJob {
    fn eq(&self, other: &Self) -> bool {
        Arc::ptr_eq(&self.condition, &other.condition)
    }
}

impl Job for ModesJob {
    type Tools = ();
    type Output = Arc<ConditionModes>;

    fn run(&self, (): &mut (), progress: &dyn Progress) -> Result<Self::Output, Cancelled> {
        ConditionModes::of(&self.condition, progress).map(Arc::new)
    }
}

/// The responses of some models, wherever in the dataset they are, on one grid.
#[derive(Clone, Debug)]
pub struct AcrossJob {
    /// The dataset.
    pub dataset: Arc<Dataset>,
    /// The models; those that the dataset does not have are left out.
    pub models: Vec<ModelId>,
    /// The couplings of those models; none of models as they are.
    pub couplings: Option<Arc<FittedCouplings>>,
    /// Band, and the number of frequencies in it.
    pub grid: (Band, usize),
}

/// Responses of models of several conditions.
#[derive(Clone, Debug, PartialEq)]
pub struct AcrossCurves {
    /// The frequencies.
    pub grid: FrequencyGrid,
    /// Each model with its response.
    pub responses: Vec<(ModelId, Arc<FrequencyResponse>)>,
}

impl AcrossJob {
    /// The model of a role of every condition, as far as there is one.
    pub fn of(dataset: &Arc<Dataset>, analysis: Option<&Analysis>, role: AcrossRole, grid: (Band, usize)) -> Self {
        let models = dataset.conditions().iter().filter_map(|condition| role.model(condition, analysis)).collect();
        let couplings =
            analysis.filter(|_| role == AcrossRole::Corrected).and_then(Analysis::fitted_couplings).cloned();
        Self { dataset: Arc::clone(dataset), models, couplings, grid }
    }
}

impl PartialEq for AcrossJob {
    fn eq(&self, other: &Self) -> bool {
        let key = |of: &Self| (of.models.clone(), of.couplings.clone(), of.grid);
        Arc::ptr_eq(&self.dataset, &other.dataset) && key(self) == key(other)
    }
}

impl Job for AcrossJob {
    type Tools = ();
    type Output = Arc<AcrossCurves>;

    fn run(&self, (): &mut (), progress: &dyn Progress) -> Result<Self::Output, Cancelled> {
        let (band, points) = self.grid;
        let grid = FrequencyGrid::logarithmic(band, points);
        let responses = in_turn(&self.models, progress, |id| {
            let condition = self.dataset.condition(id.condition)?;
            let response = PreparedModel::of(&condition.model(id.bundle, &id.name)?.dynamics).response(&grid);
            let coupled = self
                .couplings
                .as_ref()
                .map(|fitted| fitted.matrices().response(&response, condition.flight_state().airspeed_kt));
            Some((id.clone(), Arc::new(coupled.unwrap_or(response))))
        })?;
        let responses = responses.into_iter().flatten().collect();
        Ok(Arc::new(AcrossCurves { grid, responses }))
    }
}

/// Which model of each condition is laid over the others'.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum AcrossRole {
    /// The physics model at the condition's own trim.
    #[default]
    Nominal,
    /// The physics model that represents its bundle.
    Representative,
    /// The same under the condition's own correction.
    Corrected,
    /// The identified model that represents its bundle.
    Identified,
}

impl AcrossRole {
    /// Every role, in the order of its list.
    pub const ALL: [Self; 4] = [Self::Nominal, Self::Representative, Self::Corrected, Self::Identified];

    /// Its name.
    pub fn name(self) -> &'static str {
        match self {
            Self::Nominal => "nominal",
            Self::Representative => "representative",
            Self::Corrected => "corrected",
            Self::Identified => "identified",
        }
    }

    /// The model that has this role in a condition; none where that takes a result and there is none.
    pub fn model(self, condition: &Condition, analysis: Option<&Analysis>) -> Option<ModelId> {
        let of = |kind: BundleKind, name: &str| ModelId::new(condition.id(), kind, name);
        if self == Self::Nominal {
            return Some(of(BundleKind::Physics, &condition.bundle(BundleKind::Physics)[condition.nominal()].name));
        }
        let result = analysis?.condition(condition.id())?;
        let kind = if self == Self::Identified { BundleKind::Identified } else { BundleKind::Physics };
        Some(of(kind, result.representative_name(kind)))
    }

    /// What is done to its response before it is drawn; none where the response has no correction.
    pub fn correction(self, condition: ConditionId, pair: Pair, analysis: Option<&Analysis>) -> Option<GainDelay> {
        match self {
            Self::Corrected => analysis?.condition(condition)?.correction.on(pair),
            _ => Some(GainDelay::NONE),
        }
    }
}

/// The cost of every single toggle of a condition.
#[derive(Clone, Debug, PartialEq)]
pub struct Toggles {
    /// Of the gains.
    pub gains: Vec<Toggle>,
    /// Of the delays.
    pub delays: Vec<Toggle>,
}

impl Toggles {
    /// Solves a condition with every response toggled in turn; `None` where `stop` said so first, or a problem has no answer.
    pub fn of(condition: &ConditionAnalysis, stop: &dyn Fn() -> bool) -> Option<Self> {
        // The table is a hint, not a result.
        let budget = ProofBudget { work: 4_000_000, ..ProofBudget::default() };
        let gains = toggles(&condition.gain_problem, &condition.gains, budget, stop).ok()?;
        let delays = toggles(&condition.delay_problem, &condition.delays, budget, stop).ok()?;
        (!stop()).then_some(Self { gains, delays })
    }

    /// The toggles of one response: of its gain and of its delay.
    pub fn of_pair(&self, pair: Pair) -> (Option<&Toggle>, Option<&Toggle>) {
        let gain = self.gains.iter().find(|toggle| toggle.pair == pair);
        (gain, self.delays.iter().find(|toggle| toggle.pair == pair))
    }
}

/// The analysis of a variant ([`Study::of_variant`]), beside the live answer.
#[derive(Clone, Debug)]
pub struct VariantJob {
    /// The study with the variant's decisions.
    pub study: Study,
}

impl PartialEq for VariantJob {
    /// The same dataset and the same decisions: the words that they are explained with do not count.
    fn eq(&self, other: &Self) -> bool {
        let (a, b) = (&self.study, &other.study);
        let conditions = || a.dataset.conditions().iter().map(|condition| condition.id());
        Arc::ptr_eq(&a.dataset, &b.dataset)
            && a.settings == b.settings
            && conditions().all(|id| a.choice(id).without_reasons() == b.choice(id).without_reasons())
    }
}

impl Job for VariantJob {
    /// An engine that keeps what variants have in common: responses and distances, which no decision but the band changes.
    type Tools = Engine;
    type Output = Arc<Analysis>;

    fn run(&self, engine: &mut Engine, progress: &dyn Progress) -> Result<Self::Output, Cancelled> {
        engine.analyze(&self.study, progress).map(Arc::new)
    }
}

/// The bars of an analysis, and what follows from them.
#[derive(Clone, Debug)]
pub struct UncertaintyJob {
    /// The analysis.
    pub analysis: Arc<Analysis>,
}

impl PartialEq for UncertaintyJob {
    fn eq(&self, other: &Self) -> bool {
        Arc::ptr_eq(&self.analysis, &other.analysis)
    }
}

impl Job for UncertaintyJob {
    /// An engine that keeps responses and substitutions from one analysis to the next.
    type Tools = Engine;
    type Output = Arc<Uncertainty>;

    fn run(&self, engine: &mut Engine, progress: &dyn Progress) -> Result<Self::Output, Cancelled> {
        engine.uncertainty(&self.analysis, progress).map(Arc::new)
    }
}

/// The modes of one model; none of a measured response.
pub type ModelModes = Result<Vec<Mode>, ModesError>;

/// The modes of every model of a condition, in file order.
#[derive(Clone, Debug, PartialEq)]
pub struct ConditionModes {
    /// The condition: it names the models.
    pub condition: Arc<Condition>,
    /// Modes of the physics models.
    pub physics: Vec<ModelModes>,
    /// Modes of the identified models.
    pub identified: Vec<ModelModes>,
}

impl ConditionModes {
    /// The modes of every model, model by model; each is a step.
    ///
    /// # Errors
    /// [`Cancelled`] between two models, where `progress` says so.
    pub fn of(condition: &Arc<Condition>, progress: &dyn Progress) -> Result<Self, Cancelled> {
        let models: Vec<&Model> = BundleKind::BOTH.into_iter().flat_map(|kind| condition.bundle(kind)).collect();
        let mut physics = in_turn(&models, progress, |model| modes_of(&model.dynamics))?;
        let identified = physics.split_off(condition.bundle(BundleKind::Physics).len());
        Ok(Self { condition: Arc::clone(condition), physics, identified })
    }

    /// The modes of one bundle.
    pub fn bundle(&self, kind: BundleKind) -> &[ModelModes] {
        match kind {
            BundleKind::Physics => &self.physics,
            BundleKind::Identified => &self.identified,
        }
    }

    /// Each mode of the model of index `reference` followed through its bundle. A model without modes leaves gaps.
    pub fn tracks(&self, kind: BundleKind, reference: usize) -> Vec<ModeTrack> {
        let modes = self.bundle(kind).iter().map(|modes| modes.as_deref().unwrap_or_default());
        mode_tracks(&modes.collect::<Vec<&[Mode]>>(), reference)
    }
}
