//! Jobs on flight records: identifying models, simulating a model.
//!
//! A [`Job`] is a long computation in parallel to the interactive analysis; jobs are equal if they
//! have the same output, and `Tools` are kept from one job to the next. A held-out record is
//! excluded from the identification and validates its models (M14.6).

use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::time::Instant;

use gdcm_model::dataset::{ConditionId, StateSpace};
use gdcm_model::executor::Executor;
use gdcm_model::progress::{Cancelled, Progress};
use gdcm_model::simulation::{
    FlightRecord, Validation, ValidationError, ValidationSettings, validate,
};
use gdcm_sysid::identification::identify::identify;
use gdcm_sysid::identification::{Identification, IdentificationError, Options, Preparation};
use gdcm_sysid::planning::flight_plan::FlightPlan;
use gdcm_sysid::planning::flight_planner::FlightPlanner;
use gdcm_sysid::records::LaidOutRecord;
use gdcm_sysid::spectra::preparation::segments_of;
use gdcm_sysid::spectra::preparation_settings::PreparationError;

use super::job::Job;
use crate::shared::Shared;

/// Why no model can be identified.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum NothingToIdentify {
    #[error(
        "there is no record from which to identify models: add records, or mark records as \
        used"
    )]
    NoRecord,
    #[error("every record is held out: leave at least one for the identification")]
    AllHeldOut,
}

impl NothingToIdentify {
    /// Returns the stable code by which scripts and tests distinguish the reasons.
    pub fn code(&self) -> &'static str {
        match self {
            Self::NoRecord => "no-record",
            Self::AllHeldOut => "all-held-out",
        }
    }
}

/// Flight records, and the options for identifying models from them.
#[derive(Clone, Debug, PartialEq)]
pub struct IdentificationRequest {
    /// The records, in the channels' units.
    pub records: Shared<[FlightRecord]>,
    pub options: Options,
}

impl IdentificationRequest {
    /// Builds the request from those `records` that are in use. Records marked as held out are
    /// excluded from the identification and used for validation.
    ///
    /// # Errors
    /// No record is used, or all are held out.
    pub fn from_used<'r>(
        records: impl Iterator<Item = &'r LaidOutRecord>,
        preparation: Preparation,
        band: [f64; 2],
    ) -> Result<Self, NothingToIdentify> {
        let mut flights: Vec<FlightRecord> = Vec::new();
        let mut held_out = Vec::new();
        for record in records {
            let Some(flight) = record.used_flight() else {
                continue;
            };
            // Guessed from the record's name, or set by the user.
            if record.guess.held_out {
                held_out.push(flights.len());
            }
            flights.push(flight.as_ref().clone());
        }
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

    /// Identifies models from the request's records.
    ///
    /// # Errors
    /// As for [`identify`].
    pub fn identify(
        &self,
        executor: &dyn Executor,
        progress: &dyn Progress,
    ) -> Result<Identification, IdentificationError> {
        identify(&self.records, &self.options, executor, progress)
    }
}

/// Intermediate results from a running identification.
#[derive(Clone, Debug, Default)]
pub struct IdentificationNews {
    /// The present step, in words.
    pub step: String,
    /// First model, before refinement.
    pub first_model: Option<Arc<StateSpace>>,
    /// Duration of the run, once it has ended \[s\].
    pub duration_s: Option<f64>,
    /// Predicted intervals after further sweeps, once computed.
    pub next_flight: Option<Arc<FlightPlan>>,
}

/// Job that identifies a condition's models from its flight records.
#[derive(Clone, Debug)]
pub struct IdentifyJob {
    pub condition: ConditionId,
    pub request: IdentificationRequest,
    /// Intermediate results during the run; not part of the request.
    news: Arc<Mutex<IdentificationNews>>,
}

impl IdentifyJob {
    /// Creates the job that identifies the models of `condition`.
    pub fn new(condition: ConditionId, request: IdentificationRequest) -> Self {
        Self {
            condition,
            request,
            news: Arc::default(),
        }
    }

    /// Returns the intermediate results so far.
    pub fn news(&self) -> IdentificationNews {
        locked(&self.news).clone()
    }
}

impl PartialEq for IdentifyJob {
    fn eq(&self, other: &Self) -> bool {
        self.condition == other.condition && self.request == other.request
    }
}

/// Locks the intermediate results; a panic under the lock leaves them intact.
fn locked(news: &Mutex<IdentificationNews>) -> MutexGuard<'_, IdentificationNews> {
    news.lock().unwrap_or_else(PoisonError::into_inner)
}

/// Stores intermediate results, and forwards other progress.
struct NewsProgress<'a> {
    progress: &'a dyn Progress,
    news: &'a Mutex<IdentificationNews>,
}

impl Progress for NewsProgress<'_> {
    fn cancelled(&self) -> bool {
        self.progress.cancelled()
    }

    fn advanced(&self, done: usize, total: usize) {
        self.progress.advanced(done, total);
    }

    fn step(&self, what: &str) {
        what.clone_into(&mut locked(self.news).step);
    }

    fn first_model(&self, model: &StateSpace) {
        locked(self.news).first_model = Some(Arc::new(model.clone()));
    }
}

impl Job for IdentifyJob {
    type Tools = Box<dyn Executor>;
    type Output = Result<Arc<Identification>, IdentificationError>;

    fn run(
        &self,
        executor: &mut Self::Tools,
        progress: &dyn Progress,
    ) -> Result<Self::Output, Cancelled> {
        let begin = Instant::now();
        let identified = self.request.identify(
            executor.as_ref(),
            &NewsProgress {
                progress,
                news: &self.news,
            },
        );
        locked(&self.news).duration_s = Some(begin.elapsed().as_secs_f64());
        if let Ok(identified) = &identified {
            let plan = next_flight(identified, executor.as_ref());
            locked(&self.news).next_flight = plan.map(Arc::new);
        }
        match identified {
            Err(IdentificationError::Stopped(cancelled)) => Err(cancelled),
            identified => Ok(identified.map(Arc::new)),
        }
    }
}

/// Predicts the intervals after further sweeps of each input ([`FlightPlanner::standard_plan`]);
/// `None` if they cannot be computed.
fn next_flight(identification: &Identification, executor: &dyn Executor) -> Option<FlightPlan> {
    let information = identification.information.as_ref()?;
    FlightPlanner::new(information, executor)?.standard_plan()
}

/// Job that simulates a model with a flight record's inputs (M14.6).
#[derive(Clone, Debug, PartialEq)]
pub struct SimulationJob {
    pub record: Shared<FlightRecord>,
    pub preparation: Preparation,
    pub model: StateSpace,
}

/// Why a model is not simulated with a record.
#[derive(Clone, Debug, PartialEq)]
pub enum SimulationFailure {
    NotPrepared(PreparationError),
    NotSimulated(ValidationError),
}

impl SimulationFailure {
    /// Returns the stable code, for programs and tests.
    pub fn code(&self) -> &'static str {
        match self {
            Self::NotPrepared(_) => "record-not-prepared",
            Self::NotSimulated(_) => "not-simulated",
        }
    }
}

impl Job for SimulationJob {
    type Tools = Box<dyn Executor>;
    type Output = Result<Arc<Validation>, SimulationFailure>;

    fn run(
        &self,
        executor: &mut Self::Tools,
        progress: &dyn Progress,
    ) -> Result<Self::Output, Cancelled> {
        let segments = segments_of(&self.record, &self.preparation);
        if progress.cancelled() {
            return Err(Cancelled);
        }
        let validation = segments
            .map_err(SimulationFailure::NotPrepared)
            .and_then(|segments| {
                let settings = ValidationSettings::unfiltered();
                validate(&self.model, &segments, &settings, executor.as_ref())
                    .map_err(SimulationFailure::NotSimulated)
            });
        Ok(validation.map(Arc::new))
    }
}
