//! The study that independent code analysed: the reference dataset with its suggested outliers
//! rejected.

use gdcm_io::{DatasetOrigin, Example, load_dataset_bytes};
use gdcm_model::progress::Unobserved;
use gdcm_study::{Analysis, Edit, Engine, Study};

use crate::check::CheckFault;

/// The example's physics models with three identified models per condition, which were not
/// identified by this program.
const DATASET: &[u8] = include_bytes!("../../../tests/data/reference/example-dataset.json.gz");

/// The reference study; it is analysed when it is first needed.
#[derive(Default)]
pub struct ReferenceStudy {
    analysis: Option<Analysis>,
    engine: Engine,
}

impl ReferenceStudy {
    /// Returns the analysis after the suggested outliers were rejected.
    pub(crate) fn analysis(&mut self) -> Result<Analysis, CheckFault> {
        if let Some(analysis) = &self.analysis {
            return Ok(analysis.clone());
        }
        let origin = DatasetOrigin::EmbeddedExample(Example::Simulated);
        let loaded = load_dataset_bytes(DATASET, origin).map_err(CheckFault::no_result)?;
        let mut study = Study::new(loaded.dataset);
        let first = self
            .engine
            .analyze(&study, &Unobserved)
            .map_err(CheckFault::no_result)?;
        for (condition, result) in &first.conditions {
            if let Ok(result) = result {
                study
                    .apply(&Edit::reject_physics(*condition, &result.suggested()))
                    .map_err(CheckFault::no_result)?;
            }
        }
        let analysis = self
            .engine
            .analyze(&study, &Unobserved)
            .map_err(CheckFault::no_result)?;
        self.analysis = Some(analysis.clone());
        Ok(analysis)
    }

    /// Returns the engine that computed the analysis.
    pub(crate) fn engine(&mut self) -> &mut Engine {
        &mut self.engine
    }
}
