//! Models identified from flight records that a condition adopts instead of those of its file.

use gdcm_model::dataset::condition::{ConditionError, ConditionRecord};
use gdcm_model::dataset::model::Origin;
use gdcm_model::dataset::{BundleKind, ConditionId, Dataset, Dynamics, Model};
use gdcm_sysid::identification::Identification;

use super::edit_refusal::EditRefusal;

/// Selection of an identification's models.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct OfferedModels {
    /// The refined model, its neighbours in order, and the models without each record (M14, section
    /// 5).
    pub refined: bool,
    /// CT-PBSID without refinement.
    pub unrefined: bool,
    /// The measured response itself, with its coherence (M4a).
    pub measured: bool,
}

impl OfferedModels {
    /// The bundle that M14 passes to M5.
    pub const REFINED: Self = Self {
        refined: true,
        unrefined: false,
        measured: false,
    };
    /// The bundle that M14 passes to M5, and CT-PBSID without refinement.
    pub const WITH_UNREFINED: Self = Self {
        refined: true,
        unrefined: true,
        measured: false,
    };
    /// The measured response alone.
    pub const MEASURED: Self = Self {
        refined: false,
        unrefined: false,
        measured: true,
    };
}

/// Models identified from flight records, and the records.
#[derive(Clone, Debug, PartialEq)]
pub struct AdoptedModels {
    pub models: Vec<Model>,
    pub records: Vec<ConditionRecord>,
}

impl AdoptedModels {
    /// Returns the selectable models of an identification from `records`, the recommended model
    /// first.
    pub fn of(
        found: &Identification,
        offered: OfferedModels,
        records: Vec<ConditionRecord>,
    ) -> Self {
        let mut models = Vec::new();
        if offered.refined {
            models.push(found.refined.clone());
            models.extend_from_slice(&found.bundle);
        }
        if offered.unrefined {
            models.push(found.unrefined.clone());
        }
        if offered.measured
            && let Some(response) = found.measured.measured()
        {
            let origin = Origin::Identified {
                method: Some("local polynomial method".to_owned()),
                order: None,
            };
            models.push(Model {
                source: found.unrefined.source.clone(),
                ..Model::new("measured", origin, Dynamics::Measured(response))
            });
        }
        Self { models, records }
    }

    /// Returns the dataset with these models as the identified bundle of a condition, and these
    /// records added to the condition's.
    ///
    /// # Errors
    /// [`EditRefusal::NoCondition`], and [`EditRefusal::Models`] where the models do not fit the
    /// condition.
    pub fn put_into(&self, dataset: &Dataset, id: ConditionId) -> Result<Dataset, EditRefusal> {
        let before = dataset
            .condition(id)
            .ok_or(EditRefusal::NoCondition { condition: id })?;
        // A condition without identified models is valid, but an empty set of models replaces
        // nothing.
        if self.models.is_empty() {
            let error = ConditionError::EmptyBundle(BundleKind::Identified);
            return Err(refused(id, &error));
        }
        let condition = before
            .with_identified(self.models.clone(), self.records.clone())
            .map_err(|error| refused(id, &error))?;
        dataset
            .with_condition(condition)
            .map_err(|error| refused(id, &error))
    }
}

fn refused(condition: ConditionId, error: &dyn std::error::Error) -> EditRefusal {
    EditRefusal::Models {
        condition,
        why: error.to_string(),
    }
}
