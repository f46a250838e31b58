//! Identification of a flight condition from its records, as work beside the live answer.

use std::sync::{Arc, Mutex, PoisonError};

use crate::dataset::ConditionId;
use crate::executor::Executor;
use crate::identification::{
    FlightRecord, Identification, IdentificationError, Options, StateSpaceMatrices, Watch, identify,
};

use super::{Cancelled, Job, Progress};

/// Parts into which the work is divided for its progress.
const PARTS: f64 = 1000.0;

/// What an identification under way has told.
#[derive(Clone, Debug, Default)]
pub struct IdentificationNews {
    /// The step under way, in words.
    pub step: String,
    /// The first model, before it is refined.
    pub first_model: Option<Arc<StateSpaceMatrices>>,
}

/// Models of one condition from its flight records.
#[derive(Clone, Debug)]
pub struct IdentifyJob {
    /// The condition.
    pub condition: ConditionId,
    /// Its records, in the units of the dataset.
    pub records: Arc<[FlightRecord]>,
    /// What is asked for.
    pub options: Options,
    /// What is told meanwhile; no part of what is asked for.
    pub news: Arc<Mutex<IdentificationNews>>,
}

impl IdentifyJob {
    /// The job of these records.
    pub fn new(condition: ConditionId, records: Arc<[FlightRecord]>, options: Options) -> Self {
        Self { condition, records, options, news: Arc::default() }
    }

    /// What it has told so far.
    pub fn told(&self) -> IdentificationNews {
        // A panic while the lock was held leaves news that are still whole.
        self.news.lock().unwrap_or_else(PoisonError::into_inner).clone()
    }

    /// The records that models are fitted to.
    pub fn fitted(&self) -> impl Iterator<Item = &FlightRecord> {
        let fitted = self.records.iter().enumerate().filter(|(index, _)| !self.options.held_out.contains(index));
        fitted.map(|(_, record)| record)
    }
}

impl PartialEq for IdentifyJob {
    fn eq(&self, other: &Self) -> bool {
        let same_records = Arc::ptr_eq(&self.records, &other.records);
        same_records && self.condition == other.condition && self.options == other.options
    }
}

/// Hands on what is told, and whether to go on.
struct Bridge<'a> {
    progress: &'a dyn Progress,
    news: &'a Mutex<IdentificationNews>,
}

impl Watch for Bridge<'_> {
    fn progress(&self, done: f64, what: &str) {
        what.clone_into(&mut self.news.lock().unwrap_or_else(PoisonError::into_inner).step);
        self.progress.advanced((done * PARTS) as usize, PARTS as usize);
    }

    fn is_stopped(&self) -> bool {
        self.progress.cancelled()
    }

    fn first_model(&self, model: &StateSpaceMatrices) {
        let model = Some(Arc::new(model.clone()));
        self.news.lock().unwrap_or_else(PoisonError::into_inner).first_model = model;
    }
}

impl Job for IdentifyJob {
    /// Who carries out its pieces.
    type Tools = Box<dyn Executor>;
    type Output = Result<Arc<Identification>, IdentificationError>;

    fn run(&self, executor: &mut Self::Tools, progress: &dyn Progress) -> Result<Self::Output, Cancelled> {
        match identify(&self.records, &self.options, executor.as_ref(), &Bridge { progress, news: &self.news }) {
            Err(IdentificationError::Stopped) => Err(Cancelled),
            found => Ok(found.map(Arc::new)),
        }
    }
}
