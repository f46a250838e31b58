//! A model against a flight record in time, as work beside the live answer.

use std::sync::Arc;

use crate::executor::Executor;
use crate::identification::{
    FlightRecord, Preparation, StateSpaceMatrices, Validation, ValidationSettings, prepare, validate,
};

use super::{Cancelled, Job, Progress};

/// What a model gives for the inputs of a flight record (M14, section 6).
#[derive(Clone, Debug)]
pub struct SimulationJob {
    /// The record, in the units of the dataset.
    pub record: Arc<FlightRecord>,
    /// How its channels are prepared.
    pub preparation: Preparation,
    /// The model.
    pub model: StateSpaceMatrices,
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
        let prepared = prepare(std::slice::from_ref(self.record.as_ref()), &self.preparation, executor.as_ref());
        if progress.cancelled() {
            return Err(Cancelled);
        }
        let found = prepared.map_err(|error| error.to_string()).and_then(|prepared| {
            let settings = ValidationSettings::unfiltered();
            validate(&self.model, &prepared.pieces, &settings, executor.as_ref()).map_err(|error| error.to_string())
        });
        Ok(found.map(Arc::new))
    }
}
