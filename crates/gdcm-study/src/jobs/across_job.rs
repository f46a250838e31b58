//! Job for drawing a response in several conditions. *Across* in names means over several
//! conditions.
//!
//! A [`Job`] is a long computation in parallel to the interactive analysis. Jobs are equal if they
//! have the same output.

use std::sync::Arc;

use gdcm_model::dataset::{Band, BundleKind, Condition, Dataset, ModelId};
use gdcm_model::progress::{Cancelled, Progress};
use gdcm_model::response::{FrequencyGrid, FrequencyResponse, PreparedModel};

use super::across_role::AcrossRole;
use super::job::Job;
use crate::execution::in_turn;
use crate::results::analysis::Analysis;
use crate::results::fitted_couplings::FittedCouplings;
use crate::shared::Shared;

/// Job that computes responses for selected models from any conditions, on a grid.
#[derive(Clone, Debug, PartialEq)]
pub struct AcrossJob {
    pub dataset: Shared<Dataset>,
    /// The dataset with the physics models moved by the physics parameters; the same as `dataset`
    /// if there are none.
    pub moved_dataset: Shared<Dataset>,
    /// The models; models that the dataset does not have are skipped.
    pub models: Vec<ModelId>,
    /// The couplings in the corrected physics models; `None` without couplings.
    pub couplings: Option<Arc<FittedCouplings>>,
    /// Band, and number of frequencies in it.
    pub grid: (Band, usize),
}

/// Model responses from several conditions.
#[derive(Clone, Debug, PartialEq)]
pub struct AcrossCurves {
    pub grid: FrequencyGrid,
    pub responses: Vec<AcrossModel>,
}

/// A model's response in one of several conditions.
#[derive(Clone, Debug, PartialEq)]
pub struct AcrossModel {
    pub model: ModelId,
    pub response: Arc<FrequencyResponse>,
    /// A physics model's response with physics parameters and couplings applied; `None` if neither
    /// is applied, and for an identified model.
    pub coupled: Option<Arc<FrequencyResponse>>,
}

impl AcrossCurves {
    /// Returns a model's response; `None` if it was not computed.
    pub fn model(&self, id: &ModelId) -> Option<&AcrossModel> {
        self.responses.iter().find(|found| found.model == *id)
    }
}

impl AcrossJob {
    /// Creates the job for every role's models in all conditions that have them.
    pub fn for_conditions(
        dataset: &Arc<Dataset>,
        analysis: Option<&Analysis>,
        grid: (Band, usize),
    ) -> Self {
        let mut models = Vec::new();
        for condition in dataset.conditions() {
            for role in AcrossRole::ALL {
                if let Some(model) = role.model(condition, analysis)
                    && !models.contains(&model)
                {
                    models.push(model);
                }
            }
        }
        let couplings = match analysis {
            Some(analysis) => analysis.fitted_couplings().cloned(),
            None => None,
        };
        let moved_dataset = match analysis {
            Some(analysis) => analysis.moved_dataset(),
            None => dataset,
        };
        Self {
            dataset: Arc::clone(dataset).into(),
            moved_dataset: Arc::clone(moved_dataset).into(),
            models,
            couplings,
            grid,
        }
    }

    /// Computes a model's response; `None` if the dataset does not have the model.
    fn response(&self, id: &ModelId, grid: &FrequencyGrid) -> Option<AcrossModel> {
        let condition = self.dataset.condition(id.condition)?;
        let model = condition.model(id.bundle, &id.name)?;
        let response = PreparedModel::new(&model.dynamics).response(grid);
        let response = Arc::new(response);
        Some(AcrossModel {
            coupled: self.response_before_gains(id, condition, &response, grid),
            model: id.clone(),
            response,
        })
    }

    /// Returns a physics model's response after the physics parameters and the couplings, to which
    /// gains and delays apply (M18.5); `None` for an identified model, or if neither changes the
    /// response.
    fn response_before_gains(
        &self,
        id: &ModelId,
        condition: &Condition,
        response: &Arc<FrequencyResponse>,
        grid: &FrequencyGrid,
    ) -> Option<Arc<FrequencyResponse>> {
        if id.bundle != BundleKind::Physics {
            return None;
        }
        let mut changed = None;
        if self.moved_dataset != self.dataset {
            let moved = self.moved_dataset.condition(id.condition)?;
            let model = moved.model(id.bundle, &id.name)?;
            let prepared = PreparedModel::new(&model.dynamics);
            changed = Some(Arc::new(prepared.response(grid)));
        }
        if let Some(fitted) = &self.couplings {
            let airspeed_kt = condition.flight_state().airspeed_kt;
            let plain = changed.as_ref().unwrap_or(response);
            changed = Some(Arc::new(fitted.matrices().response(plain, airspeed_kt)));
        }
        changed
    }
}

impl Job for AcrossJob {
    type Tools = ();
    type Output = Arc<AcrossCurves>;

    fn run(&self, (): &mut (), progress: &dyn Progress) -> Result<Self::Output, Cancelled> {
        let (band, points) = self.grid;
        let grid = FrequencyGrid::logarithmic(band, points);
        let responses = in_turn(&self.models, progress, |id| self.response(id, &grid))?;
        let responses = responses.into_iter().flatten().collect();
        Ok(Arc::new(AcrossCurves { grid, responses }))
    }
}
