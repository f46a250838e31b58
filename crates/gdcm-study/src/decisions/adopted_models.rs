//! Models identified from flight records that a condition adopts instead of the models in its file.
//!
//! An identification proposes a first model by CT-PBSID, a subspace method, and *refines* it by
//! minimising a frequency-domain cost; the response itself is also measured without a model. The
//! bundle has models with neighbouring orders and models fitted without one record each (M14).

use gdcm_model::dataset::condition::{ConditionError, ConditionRecord};
use gdcm_model::dataset::model::Origin;
use gdcm_model::dataset::{BundleKind, ConditionId, Dataset, Dynamics, Model};
use gdcm_sysid::identification::Identification;

use super::edit_refusal::EditRefusal;

/// Selection among the models from an identification.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct AdoptionChoice {
    /// Whether to adopt the refined model, the models with neighbouring orders, and those fitted
    /// without one record each (M14.5).
    pub refined: bool,
    /// Whether to adopt the CT-PBSID model without refinement.
    pub unrefined: bool,
    /// Whether to adopt the measured response itself, with its coherence (M4a).
    pub measured: bool,
}

impl AdoptionChoice {
    /// The refined model, the models with neighbouring orders, and those fitted without one record
    /// each (M14.5).
    pub const REFINED: Self = Self {
        refined: true,
        unrefined: false,
        measured: false,
    };
    /// The models in [`Self::REFINED`], and the CT-PBSID model without refinement.
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

/// Models identified from flight records, together with these records.
#[derive(Clone, Debug, PartialEq)]
pub struct AdoptedModels {
    pub models: Vec<Model>,
    pub records: Vec<ConditionRecord>,
}

impl AdoptedModels {
    /// Collects the chosen models from an identification with `records`, in this order: the refined
    /// model and its bundle, the unrefined model, the measured response (omitted if `found` has
    /// none).
    pub fn from_identification(
        found: &Identification,
        choice: AdoptionChoice,
        records: Vec<ConditionRecord>,
    ) -> Self {
        let mut models = Vec::new();
        if choice.refined {
            models.push(found.refined.clone());
            models.extend_from_slice(&found.bundle);
        }
        if choice.unrefined {
            models.push(found.unrefined.clone());
        }
        if choice.measured
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

    /// Returns the dataset in which these models are a condition's identified bundle; the records
    /// are added to the condition's records.
    ///
    /// # Errors
    /// [`EditRefusal::NoCondition`], and [`EditRefusal::Models`] if there are no models or they do
    /// not fit the condition.
    pub fn put_into(&self, dataset: &Dataset, id: ConditionId) -> Result<Dataset, EditRefusal> {
        let before = dataset
            .condition(id)
            .ok_or(EditRefusal::NoCondition { condition: id })?;
        // A condition may have no identified models, but an empty model list must not replace the
        // existing bundle.
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
