//! Identification of a flight condition from its records, and its models against a record in time, as work beside the live answer.

use std::sync::{Arc, Mutex, PoisonError};
use std::time::Instant;

use crate::dataset::{ConditionId, StateSpace};
use crate::executor::Executor;
use crate::identification::{
    FlightRecord, Identification, IdentificationError, Options, Preparation, Validation, ValidationSettings, identify,
    segments_of, validate,
};
use crate::records::LaidOutRecord;

use super::{Cancelled, Job, Progress};

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
#[derive(Clone, Debug)]
pub struct IdentificationRequest {
    /// The records, in the units of the channels.
    pub records: Arc<[FlightRecord]>,
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
        let used = records.filter_map(|record| Some((record.used_flight()?, record.guess.held_out)));
        let (flights, held_out): (Vec<FlightRecord>, Vec<bool>) =
            used.map(|(flight, held_out)| (flight.as_ref().clone(), held_out)).unzip();
        let held_out: Vec<usize> = (0..flights.len()).filter(|index| held_out[*index]).collect();
        if flights.is_empty() {
            return Err(NothingToIdentify::NoRecord);
        }
        if held_out.len() == flights.len() {
            return Err(NothingToIdentify::AllHeldOut);
        }
        Ok(Self { records: flights.into(), options: Options { held_out, ..Options::new(band, preparation) } })
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

impl PartialEq for IdentificationRequest {
    fn eq(&self, other: &Self) -> bool {
        Arc::ptr_eq(&self.records, &other.records) && self.options == other.options
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
        Self { condition, request, news: Arc::default() }
    }

    /// What it has told so far.
    pub fn told(&self) -> IdentificationNews {
        // A panic while the lock was held leaves news that are still whole.
        self.news.lock().unwrap_or_else(PoisonError::into_inner).clone()
    }
}

impl PartialEq for IdentifyJob {
    fn eq(&self, other: &Self) -> bool {
        self.condition == other.condition && self.request == other.request
    }
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
        what.clone_into(&mut self.news.lock().unwrap_or_else(PoisonError::into_inner).step);
    }

    fn first_model(&self, model: &StateSpace) {
        self.news.lock().unwrap_or_else(PoisonError::into_inner).first_model = Some(Arc::new(model.clone()));
    }
}

impl Job for IdentifyJob {
    /// Who carries out its pieces.
    type Tools = Box<dyn Executor>;
    type Output = Result<Arc<Identification>, IdentificationError>;

    fn run(&self, executor: &mut Self::Tools, progress: &dyn Progress) -> Result<Self::Output, Cancelled> {
        let begin = Instant::now();
        let found = self.request.identify(executor.as_ref(), &Told { progress, news: &self.news });
        let duration_s = Some(begin.elapsed().as_secs_f64());
        self.news.lock().unwrap_or_else(PoisonError::into_inner).duration_s = duration_s;
        match found {
            Err(IdentificationError::Stopped(cancelled)) => Err(cancelled),
            found => Ok(found.map(Arc::new)),
        }
    }
}

/// What a model gives for the inputs of a flight record (M14, section 6).
#[derive(Clone, Debug)]
pub struct SimulationJob {
    /// The record, in the units of the dataset.
    pub record: Arc<FlightRecord>,
    /// How its channels are prepared.
    pub preparation: Preparation,
    /// The model.
    pub model: StateSpace,
}

impl PartialEq for SimulationJob {
    fn eq(&self, other: &Self) -> bool {
        let same_record = Arc::ptr_eq(&self.record, &other.record);
        same_record && self.preparation == other.preparation && self.model == other.model
    }
}

impl Job for SimulationJob {
    /// Who carries out its pieces.
    type Tools = Box<dyn Executor>;
    /// In words why there is none.
    type Output = Result<Arc<Validation>, String>;

    fn run(&self, executor: &mut Self::Tools, progress: &dyn Progress) -> Result<Self::Output, Cancelled> {
        let segments = segments_of(&self.record, &self.preparation);
        if progress.cancelled() {
            return Err(Cancelled);
        }
        let found = segments.map_err(|error| error.to_string()).and_then(|segments| {
            let settings = ValidationSettings::unfiltered();
            validate(&self.model, &segments, &settings, executor.as_ref()).map_err(|error| error.to_string())
        });
        Ok(found.map(Arc::new))
    }
}
