//! Long computations beside the live answer.

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
use gdcm_sysid::identification::{Identification, IdentificationError, Options, Preparation};
use gdcm_sysid::records::LaidOutRecord;
use gdcm_sysid::spectra::preparation::segments_of;

use crate::decisions::study::Study;
use crate::results::analysis::{Analysis, ConditionAnalysis};
use crate::stages::condition_responses::ConditionCurves;
use crate::stages::condition_stages::solved;
use crate::stages::engine::Engine;
use crate::stages::execution::in_turn;
use crate::stages::fitted_couplings::FittedCouplings;
use crate::stages::uncertainty::Uncertainty;

/// A shared value compared by identity: two of them are compared without reading their contents.
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

/// A long computation with progress and cancellation, run beside the live answer.
///
/// Two jobs are equal where they have the same output: a running job is cancelled only when no
/// equal job is requested any more.
pub trait Job: Clone + PartialEq + Send + 'static {
    /// Resources kept from one job to the next.
    type Tools;
    /// Result of the job.
    type Output: Send;

    /// Runs the job.
    ///
    /// # Errors
    /// [`Cancelled`] soon after `progress` requests it.
    fn run(
        &self,
        tools: &mut Self::Tools,
        progress: &dyn Progress,
    ) -> Result<Self::Output, Cancelled>;

    /// Returns whether this job, `done` of `total` steps complete, should continue although `newer`
    /// is requested instead: `newer` is faster once this job is complete.
    fn serves(&self, _newer: &Self, _done: usize, _total: usize) -> bool {
        false
    }
}

/// The complete proof of equation (7) for one condition, where the live answer's budget was too
/// small.
#[derive(Clone, Debug, PartialEq)]
pub struct ProofJob {
    pub problem: Arc<Problem>,
}

impl Job for ProofJob {
    type Tools = ();
    type Output = Result<Arc<Solution>, ProblemError>;

    fn run(&self, (): &mut (), progress: &dyn Progress) -> Result<Self::Output, Cancelled> {
        solved(&self.problem, ProofBudget::default(), progress)
    }
}

/// Cost of constraining or releasing each response of one condition.
#[derive(Clone, Debug)]
pub struct TogglesJob {
    pub condition: ConditionAnalysis,
}

impl TogglesJob {
    /// Returns whether the costs apply to this result: they depend on its two problems, and on the
    /// reference objectives.
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
    /// `None` where a problem has no solution.
    type Output = Option<Toggles>;

    fn run(&self, (): &mut (), progress: &dyn Progress) -> Result<Self::Output, Cancelled> {
        // A limited proof: the table is a hint, not a result.
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

/// The frequency responses of every model of one condition, for drawing.
#[derive(Clone, Debug, PartialEq)]
pub struct CurvesJob {
    pub dataset: Shared<Dataset>,
    pub condition: ConditionId,
    /// Band, and the number of frequencies in it.
    pub grid: (Band, usize),
}

impl Job for CurvesJob {
    /// The engine that caches the prepared models.
    type Tools = Engine;
    /// `None` where the dataset does not have the condition.
    type Output = Option<Arc<ConditionCurves>>;

    fn run(&self, engine: &mut Engine, progress: &dyn Progress) -> Result<Self::Output, Cancelled> {
        engine.curves(&self.dataset, self.condition, self.grid, progress)
    }
}

/// The modes of every model of one condition.
#[derive(Clone, Debug, PartialEq)]
pub struct ModesJob {
    pub condition: Shared<Condition>,
}

impl Job for ModesJob {
    type Tools = ();
    type Output = Arc<ConditionModes>;

    fn run(&self, (): &mut (), progress: &dyn Progress) -> Result<Self::Output, Cancelled> {
        ConditionModes::of(&self.condition, progress).map(Arc::new)
    }
}

/// The responses of selected models, from any condition of the dataset, on one grid.
#[derive(Clone, Debug, PartialEq)]
pub struct AcrossJob {
    pub dataset: Shared<Dataset>,
    /// The models; models that the dataset does not have are skipped.
    pub models: Vec<ModelId>,
    /// The couplings put on those models; `None` for models without couplings.
    pub couplings: Option<Arc<FittedCouplings>>,
    /// Band, and the number of frequencies in it.
    pub grid: (Band, usize),
}

/// Responses of models of several conditions.
#[derive(Clone, Debug, PartialEq)]
pub struct AcrossCurves {
    pub grid: FrequencyGrid,
    pub responses: Vec<(ModelId, Arc<FrequencyResponse>)>,
}

impl AcrossJob {
    /// Returns the job for the model of a role in every condition that has one.
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

/// The model of each condition drawn in the overlay of conditions.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum AcrossRole {
    /// The physics model at the condition's own trim.
    #[default]
    Nominal,
    /// The physics model that represents its bundle.
    Representative,
    /// The physics representative under the condition's own correction.
    Corrected,
    /// The identified model that represents its bundle.
    Identified,
}

impl AcrossRole {
    /// Every role, in list order.
    pub const ALL: [Self; 4] = [
        Self::Nominal,
        Self::Representative,
        Self::Corrected,
        Self::Identified,
    ];

    /// Returns the name of the role.
    pub fn name(self) -> &'static str {
        match self {
            Self::Nominal => "nominal",
            Self::Representative => "representative",
            Self::Corrected => "corrected",
            Self::Identified => "identified",
        }
    }

    /// Returns the model with this role in a condition; `None` where the role needs a result and
    /// there is none.
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

    /// Returns the correction applied to its response before drawing; `None` where the response has
    /// no correction.
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

/// Cost of every single toggle of a condition.
#[derive(Clone, Debug, PartialEq)]
pub struct Toggles {
    pub gains: Vec<Toggle>,
    pub delays: Vec<Toggle>,
}

impl Toggles {
    /// Returns the toggles of one response: of its gain and of its delay.
    pub fn of_pair(&self, pair: Pair) -> (Option<&Toggle>, Option<&Toggle>) {
        let gain = self.gains.iter().find(|toggle| toggle.pair == pair);
        (gain, self.delays.iter().find(|toggle| toggle.pair == pair))
    }
}

/// The analysis of a variant ([`Study::of_variant`]), beside the live answer.
#[derive(Clone, Debug)]
pub struct VariantJob {
    pub study: Study,
}

impl PartialEq for VariantJob {
    /// Compares the dataset and the decisions; the reasons of rejections are ignored.
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
    /// An engine that caches the results common to variants: responses and distances, which depend
    /// on no decision but the band.
    type Tools = Engine;
    type Output = Arc<Analysis>;

    fn run(&self, engine: &mut Engine, progress: &dyn Progress) -> Result<Self::Output, Cancelled> {
        engine.analyze(&self.study, progress).map(Arc::new)
    }
}

/// Error bars of an analysis, and the conclusions from them.
#[derive(Clone, Debug, PartialEq)]
pub struct UncertaintyJob {
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

/// The modes of one model; an error for a measured response.
pub type ModelModes = Result<Vec<Mode>, ModesError>;

/// The modes of every model of a condition, in file order.
#[derive(Clone, Debug, PartialEq)]
pub struct ConditionModes {
    /// The condition; it names the models.
    pub condition: Arc<Condition>,
    pub physics: Vec<ModelModes>,
    pub identified: Vec<ModelModes>,
}

impl ConditionModes {
    /// Computes the modes of every model, model by model; each is a step.
    ///
    /// # Errors
    /// [`Cancelled`] between two models, where `progress` requests it.
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

    /// Returns the modes of one bundle.
    pub fn bundle(&self, kind: BundleKind) -> &[ModelModes] {
        kind.pick(&self.physics, &self.identified)
    }

    /// Follows each mode of the model with index `reference` through its bundle. A model without
    /// modes leaves gaps.
    pub fn tracks(&self, kind: BundleKind, reference: usize) -> Vec<ModeTrack> {
        let modes = self
            .bundle(kind)
            .iter()
            .map(|modes| modes.as_deref().unwrap_or_default());
        mode_tracks(&modes.collect::<Vec<&[Mode]>>(), reference)
    }
}

/// Why no model can be identified.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum NothingToIdentify {
    #[error("there is no record to identify from: add some, or use those that are there")]
    NoRecord,
    #[error("every record is held out: at least one has to be left to identify from")]
    AllHeldOut,
}

/// Records, and the options of an identification.
#[derive(Clone, Debug, PartialEq)]
pub struct IdentificationRequest {
    /// The records, in the units of the channels.
    pub records: Shared<[FlightRecord]>,
    pub options: Options,
}

impl IdentificationRequest {
    /// Builds the request from those `records` that are used, with the records held out whose guess
    /// says so.
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
    /// The errors of [`identify`].
    pub fn identify(
        &self,
        executor: &dyn Executor,
        progress: &dyn Progress,
    ) -> Result<Identification, IdentificationError> {
        identify(&self.records, &self.options, executor, progress)
    }
}

/// News from a running identification.
#[derive(Clone, Debug, Default)]
pub struct IdentificationNews {
    /// Description of the present step.
    pub step: String,
    /// First model, before refinement.
    pub first_model: Option<Arc<StateSpace>>,
    /// Duration, once complete \[s\].
    pub duration_s: Option<f64>,
}

/// Identification of one condition's models from its flight records.
#[derive(Clone, Debug)]
pub struct IdentifyJob {
    pub condition: ConditionId,
    pub request: IdentificationRequest,
    /// News during the run; not part of the request.
    news: Arc<Mutex<IdentificationNews>>,
}

impl IdentifyJob {
    /// Creates the job of this request.
    pub fn new(condition: ConditionId, request: IdentificationRequest) -> Self {
        Self {
            condition,
            request,
            news: Arc::default(),
        }
    }

    /// Returns the news so far.
    pub fn told(&self) -> IdentificationNews {
        told(&self.news).clone()
    }
}

impl PartialEq for IdentifyJob {
    fn eq(&self, other: &Self) -> bool {
        self.condition == other.condition && self.request == other.request
    }
}

/// Locks the news; a panic under the lock leaves them intact.
fn told(news: &Mutex<IdentificationNews>) -> MutexGuard<'_, IdentificationNews> {
    news.lock().unwrap_or_else(PoisonError::into_inner)
}

/// Stores the news, and forwards other progress.
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
    /// Executor of the pieces.
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

/// Simulation of a model with the inputs of a flight record (M14, section 6).
#[derive(Clone, Debug, PartialEq)]
pub struct SimulationJob {
    pub record: Shared<FlightRecord>,
    /// Preparation of its channels.
    pub preparation: Preparation,
    pub model: StateSpace,
}

impl Job for SimulationJob {
    /// Executor of the pieces.
    type Tools = Box<dyn Executor>;
    /// Error: the reason in words.
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
