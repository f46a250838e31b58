//! Long work that is done beside the live answer.

use std::ops::Deref;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::time::Instant;

use gdcm_method::correction::problem::ProblemError;
use gdcm_method::correction::sensitivity::{Toggle, toggles};
use gdcm_method::correction::{Problem, ProofBudget, Solution};
use gdcm_method::fidelity::{ModeTrack, mode_tracks};
use gdcm_model::dataset::{
    Band, BundleKind, Condition, ConditionId, Dataset, Model, ModelId, Pair, StateSpace,
};
use gdcm_model::executor::Executor;
use gdcm_model::progress::{Cancelled, Progress};
use gdcm_model::response::eigenvalues::{ModesError, modes_of};
use gdcm_model::response::{FrequencyGrid, FrequencyResponse, GainDelay, Mode, PreparedModel};
use gdcm_model::simulation::{FlightRecord, Validation, ValidationSettings, validate};
use gdcm_sysid::identification::identify::identify;
use gdcm_sysid::identification::preparation::segments_of;
use gdcm_sysid::identification::{Identification, IdentificationError, Options, Preparation};
use gdcm_sysid::records::LaidOutRecord;

use super::Study;
use super::analysis::{Analysis, ConditionAnalysis};
use super::condition_responses::ConditionCurves;
use super::condition_stages::solved;
use super::engine::Engine;
use super::execution::in_turn;
use super::fitted_couplings::FittedCouplings;
use super::uncertainty::Uncertainty;

/// A value that several hold, equal to itself alone: two of them are compared without a look at their numbers.
#[derive(Debug)]
pub struct Shared<T: ?Sized>(Arc<T>);

impl<T: ?Sized> Clone for Shared<T> {
    fn clone(&self) -> Self {
        Self(Arc::clone(&self.0))
    }
}

impl<T: ?Sized> PartialEq for Shared<T> {
    fn eq(&self, other: &Self) -> bool {
        Arc::ptr_eq(&self.0, &other.0)
    }
}

impl<T: ?Sized> From<Arc<T>> for Shared<T> {
    fn from(value: Arc<T>) -> Self {
        Self(value)
    }
}

impl<T: ?Sized> Deref for Shared<T> {
    type Target = Arc<T>;

    fn deref(&self) -> &Arc<T> {
        &self.0
    }
}

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
    fn run(
        &self,
        tools: &mut Self::Tools,
        progress: &dyn Progress,
    ) -> Result<Self::Output, Cancelled>;

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
        solved(&self.problem, ProofBudget::default(), progress)
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
        let a = &self.condition;
        let b = condition;
        let same_problems = a.gain_problem == b.gain_problem && a.delay_problem == b.delay_problem;
        same_problems
            && a.gains.objective == b.gains.objective
            && a.delays.objective == b.delays.objective
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
        // The table is a hint, not a result.
        let budget = ProofBudget {
            work: 4_000_000,
            ..ProofBudget::default()
        };
        let ConditionAnalysis {
            gain_problem,
            gains,
            delay_problem,
            delays,
            ..
        } = &self.condition;
        let gains = toggles(gain_problem, gains, budget, &|| progress.cancelled());
        let delays = toggles(delay_problem, delays, budget, &|| progress.cancelled());
        if progress.cancelled() {
            return Err(Cancelled);
        }
        Ok(gains
            .ok()
            .zip(delays.ok())
            .map(|(gains, delays)| Toggles { gains, delays }))
    }
}

/// The responses of every model of one condition, for drawing.
#[derive(Clone, Debug, PartialEq)]
pub struct CurvesJob {
    /// The models.
    pub dataset: Shared<Dataset>,
    /// The condition.
    pub condition: ConditionId,
    /// Band, and the number of frequencies in it.
    pub grid: (Band, usize),
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
#[derive(Clone, Debug, PartialEq)]
pub struct ModesJob {
    /// The condition.
    pub condition: Shared<Condition>,
}

impl Job for ModesJob {
    type Tools = ();
    type Output = Arc<ConditionModes>;

    fn run(&self, (): &mut (), progress: &dyn Progress) -> Result<Self::Output, Cancelled> {
        ConditionModes::of(&self.condition, progress).map(Arc::new)
    }
}

/// The responses of some models, wherever in the dataset they are, on one grid.
#[derive(Clone, Debug, PartialEq)]
pub struct AcrossJob {
    /// The dataset.
    pub dataset: Shared<Dataset>,
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
    pub fn of(
        dataset: &Arc<Dataset>,
        analysis: Option<&Analysis>,
        role: AcrossRole,
        grid: (Band, usize),
    ) -> Self {
        let models = dataset
            .conditions()
            .iter()
            .filter_map(|condition| role.model(condition, analysis))
            .collect();
        let couplings = analysis
            .filter(|_| role == AcrossRole::Corrected)
            .and_then(Analysis::fitted_couplings)
            .cloned();
        Self {
            dataset: Arc::clone(dataset).into(),
            models,
            couplings,
            grid,
        }
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
            let response =
                PreparedModel::of(&condition.model(id.bundle, &id.name)?.dynamics).response(&grid);
            let coupled = self.couplings.as_ref().map(|fitted| {
                fitted
                    .matrices()
                    .response(&response, condition.flight_state().airspeed_kt)
            });
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
    pub const ALL: [Self; 4] = [
        Self::Nominal,
        Self::Representative,
        Self::Corrected,
        Self::Identified,
    ];

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
            return Some(of(
                BundleKind::Physics,
                &condition.bundle(BundleKind::Physics)[condition.nominal()].name,
            ));
        }
        let result = analysis?.condition(condition.id())?;
        let kind = if self == Self::Identified {
            BundleKind::Identified
        } else {
            BundleKind::Physics
        };
        Some(of(kind, result.representative_name(kind)))
    }

    /// What is done to its response before it is drawn; none where the response has no correction.
    pub fn correction(
        self,
        condition: ConditionId,
        pair: Pair,
        analysis: Option<&Analysis>,
    ) -> Option<GainDelay> {
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
        let a = &self.study;
        let b = &other.study;
        Arc::ptr_eq(&a.dataset, &b.dataset)
            && a.settings == b.settings
            && a.dataset
                .ids()
                .all(|id| a.choice(id).without_reasons() == b.choice(id).without_reasons())
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
#[derive(Clone, Debug, PartialEq)]
pub struct UncertaintyJob {
    /// The analysis.
    pub analysis: Shared<Analysis>,
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
        let models: Vec<&Model> = BundleKind::BOTH
            .into_iter()
            .flat_map(|kind| condition.bundle(kind))
            .collect();
        let mut physics = in_turn(&models, progress, |model| modes_of(&model.dynamics))?;
        let identified = physics.split_off(condition.bundle(BundleKind::Physics).len());
        Ok(Self {
            condition: Arc::clone(condition),
            physics,
            identified,
        })
    }

    /// The modes of one bundle.
    pub fn bundle(&self, kind: BundleKind) -> &[ModelModes] {
        kind.pick(&self.physics, &self.identified)
    }

    /// Each mode of the model of index `reference` followed through its bundle. A model without modes leaves gaps.
    pub fn tracks(&self, kind: BundleKind, reference: usize) -> Vec<ModeTrack> {
        let modes = self
            .bundle(kind)
            .iter()
            .map(|modes| modes.as_deref().unwrap_or_default());
        mode_tracks(&modes.collect::<Vec<&[Mode]>>(), reference)
    }
}

/// Why there is nothing to identify a model from.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum NothingToIdentify {
    /// No record is used.
    #[error("there is no record to identify from: add some, or use those that are there")]
    NoRecord,
    /// Every record is held out.
    #[error("every record is held out: at least one has to be left to identify from")]
    AllHeldOut,
}

/// Records, and how models are to be identified from them.
#[derive(Clone, Debug, PartialEq)]
pub struct IdentificationRequest {
    /// The records, in the units of the channels.
    pub records: Shared<[FlightRecord]>,
    /// How.
    pub options: Options,
}

impl IdentificationRequest {
    /// The request of those `records` that are used, those held out of the fit that their guess says.
    ///
    /// # Errors
    /// No record is used, or all are held out.
    pub fn of<'r>(
        records: impl Iterator<Item = &'r LaidOutRecord>,
        preparation: Preparation,
        band: [f64; 2],
    ) -> Result<Self, NothingToIdentify> {
        let used =
            records.filter_map(|record| Some((record.used_flight()?, record.guess.held_out)));
        let (flights, held_out): (Vec<FlightRecord>, Vec<bool>) = used
            .map(|(flight, held_out)| (flight.as_ref().clone(), held_out))
            .unzip();
        let held_out: Vec<usize> = (0..flights.len())
            .filter(|index| held_out[*index])
            .collect();
        if flights.is_empty() {
            return Err(NothingToIdentify::NoRecord);
        }
        if held_out.len() == flights.len() {
            return Err(NothingToIdentify::AllHeldOut);
        }
        Ok(Self {
            records: Arc::<[_]>::from(flights).into(),
            options: Options {
                held_out,
                ..Options::new(band, preparation)
            },
        })
    }

    /// Identifies models.
    ///
    /// # Errors
    /// Those of [`identify`].
    pub fn identify(
        &self,
        executor: &dyn Executor,
        progress: &dyn Progress,
    ) -> Result<Identification, IdentificationError> {
        identify(&self.records, &self.options, executor, progress)
    }
}

/// What an identification under way has told.
#[derive(Clone, Debug, Default)]
pub struct IdentificationNews {
    /// The step under way, in words.
    pub step: String,
    /// The first model, before it is refined.
    pub first_model: Option<Arc<StateSpace>>,
    /// How long it took, once it is done \[s\].
    pub duration_s: Option<f64>,
}

/// Models of one condition from its flight records.
#[derive(Clone, Debug)]
pub struct IdentifyJob {
    /// The condition.
    pub condition: ConditionId,
    /// What is asked for.
    pub request: IdentificationRequest,
    /// What is told meanwhile; no part of what is asked for.
    news: Arc<Mutex<IdentificationNews>>,
}

impl IdentifyJob {
    /// The job of this request.
    pub fn new(condition: ConditionId, request: IdentificationRequest) -> Self {
        Self {
            condition,
            request,
            news: Arc::default(),
        }
    }

    /// What it has told so far.
    pub fn told(&self) -> IdentificationNews {
        told(&self.news).clone()
    }
}

impl PartialEq for IdentifyJob {
    fn eq(&self, other: &Self) -> bool {
        self.condition == other.condition && self.request == other.request
    }
}

/// The news; a panic while they were locked leaves them whole.
fn told(news: &Mutex<IdentificationNews>) -> MutexGuard<'_, IdentificationNews> {
    news.lock().unwrap_or_else(PoisonError::into_inner)
}

/// Keeps the news, and hands on the rest.
struct Told<'a> {
    progress: &'a dyn Progress,
    news: &'a Mutex<IdentificationNews>,
}

impl Progress for Told<'_> {
    fn cancelled(&self) -> bool {
        self.progress.cancelled()
    }

    fn advanced(&self, done: usize, total: usize) {
        self.progress.advanced(done, total);
    }

    fn step(&self, what: &str) {
        what.clone_into(&mut told(self.news).step);
    }

    fn first_model(&self, model: &StateSpace) {
        told(self.news).first_model = Some(Arc::new(model.clone()));
    }
}

impl Job for IdentifyJob {
    /// Who carries out its pieces.
    type Tools = Box<dyn Executor>;
    type Output = Result<Arc<Identification>, IdentificationError>;

    fn run(
        &self,
        executor: &mut Self::Tools,
        progress: &dyn Progress,
    ) -> Result<Self::Output, Cancelled> {
        let begin = Instant::now();
        let found = self.request.identify(
            executor.as_ref(),
            &Told {
                progress,
                news: &self.news,
            },
        );
        told(&self.news).duration_s = Some(begin.elapsed().as_secs_f64());
        match found {
            Err(IdentificationError::Stopped(cancelled)) => Err(cancelled),
            found => Ok(found.map(Arc::new)),
        }
    }
}

/// What a model gives for the inputs of a flight record (M14, section 6).
#[derive(Clone, Debug, PartialEq)]
pub struct SimulationJob {
    /// The record, in the units of the dataset.
    pub record: Shared<FlightRecord>,
    /// How its channels are prepared.
    pub preparation: Preparation,
    /// The model.
    pub model: StateSpace,
}

impl Job for SimulationJob {
    /// Who carries out its pieces.
    type Tools = Box<dyn Executor>;
    /// In words why there is none.
    type Output = Result<Arc<Validation>, String>;

    fn run(
        &self,
        executor: &mut Self::Tools,
        progress: &dyn Progress,
    ) -> Result<Self::Output, Cancelled> {
        let segments = segments_of(&self.record, &self.preparation);
        if progress.cancelled() {
            return Err(Cancelled);
        }
        let found = segments
            .map_err(|error| error.to_string())
            .and_then(|segments| {
                let settings = ValidationSettings::unfiltered();
                validate(&self.model, &segments, &settings, executor.as_ref())
                    .map_err(|error| error.to_string())
            });
        Ok(found.map(Arc::new))
    }
}
