//! Responses of single models of several conditions, to be laid over one another.

use std::sync::Arc;

use crate::dataset::{Band, Dataset, ModelId};
use crate::response::{FrequencyGrid, FrequencyResponse, PreparedModel};

use super::across_role::AcrossRole;
use super::analysis::Analysis;
use super::job::Job;
use super::progress::{Cancelled, Progress};

/// The responses of some models, wherever in the dataset they are, on one grid.
#[derive(Clone, Debug)]
pub struct AcrossJob {
    /// The dataset.
    pub dataset: Arc<Dataset>,
    /// The models; those that the dataset does not have are left out.
    pub models: Vec<ModelId>,
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
        Self { dataset: Arc::clone(dataset), models, grid }
    }
}

impl PartialEq for AcrossJob {
    fn eq(&self, other: &Self) -> bool {
        Arc::ptr_eq(&self.dataset, &other.dataset) && (&self.models, self.grid) == (&other.models, other.grid)
    }
}

impl Job for AcrossJob {
    type Tools = ();
    type Output = Arc<AcrossCurves>;

    fn run(&self, (): &mut (), progress: &dyn Progress) -> Result<Self::Output, Cancelled> {
        let (band, points) = self.grid;
        let grid = FrequencyGrid::logarithmic(band, points);
        let mut responses = Vec::with_capacity(self.models.len());
        for (done, id) in self.models.iter().enumerate() {
            if progress.cancelled() {
                return Err(Cancelled);
            }
            let condition = self.dataset.condition(id.condition);
            if let Some(model) = condition.and_then(|condition| condition.model(id.bundle, &id.name)) {
                let response = PreparedModel::of(&model.dynamics).response(&grid);
                responses.push((id.clone(), Arc::new(response)));
            }
            progress.advanced(done + 1, self.models.len());
        }
        Ok(Arc::new(AcrossCurves { grid, responses }))
    }
}
