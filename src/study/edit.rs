//! Every decision the engineer can take about a study, and the only code that carries one out.

use crate::dataset::{BundleKind, ModelId};
use crate::units::number;

use super::document::Study;
use super::setting::Setting;

/// One decision about a study.
#[derive(Clone, Debug, PartialEq)]
pub enum Edit {
    /// Take a model out of its bundle.
    Reject(ModelId),
    /// Put a rejected model back.
    Restore(ModelId),
    /// Reject all of these models of one condition's physics bundle.
    RejectAll {
        /// Index of the condition.
        condition: usize,
        /// Indices of the models.
        models: Vec<usize>,
    },
    /// Put every rejected model of a condition back, in both bundles.
    RestoreAll {
        /// Index of the condition.
        condition: usize,
    },
    /// Let a model represent its bundle, whatever the medoid is.
    Pin(ModelId),
    /// Let the medoid represent a bundle again.
    Unpin {
        /// Index of the condition.
        condition: usize,
        /// Which bundle.
        bundle: BundleKind,
    },
    /// Take a condition into the schedule, or leave it out.
    SetScheduled {
        /// Index of the condition.
        condition: usize,
        /// Whether it enters the schedule.
        scheduled: bool,
    },
    /// Hold exactly the dataset's on-axis responses.
    ConstrainOnAxis,
    /// Change a setting of the whole study.
    Set(Setting),
}

/// Why a decision was not carried out; the study is unchanged.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum EditRefusal {
    /// The last model of a bundle cannot be rejected.
    #[error("condition {condition}: \"{model}\" is the last model kept in its bundle; at least one must stay")]
    LastModel {
        /// The condition's id.
        condition: i64,
        /// The model's name.
        model: String,
    },
    /// A rejected model cannot represent its bundle.
    #[error("condition {condition}: \"{model}\" is rejected; restore it before pinning it")]
    PinRejected {
        /// The condition's id.
        condition: i64,
        /// The model's name.
        model: String,
    },
    /// A setting lies outside its range.
    #[error("{setting}: expected {expected}, found {}", number(*found))]
    OutOfRange {
        /// The setting's name.
        setting: &'static str,
        /// Its range.
        expected: String,
        /// The value given.
        found: f64,
    },
    /// The condition, model or response does not exist in this dataset.
    #[error("this dataset has no such {what}")]
    NoSuch {
        /// "condition", "model" or "response".
        what: &'static str,
    },
}

impl Edit {
    /// The decision in a few words, for the undo list: "reject nominal (condition 10)".
    pub fn label(&self, study: &Study) -> String {
        let dataset = &study.dataset;
        let id_of = |condition: &usize| dataset.conditions()[*condition].id();
        let name_of = |id: &ModelId| format!("{} (condition {})", dataset.model(*id).name, id_of(&id.condition));
        match self {
            Edit::Reject(id) => format!("reject {}", name_of(id)),
            Edit::Restore(id) => format!("restore {}", name_of(id)),
            Edit::RejectAll { condition, models } => {
                format!("reject {} suggested (condition {})", models.len(), id_of(condition))
            }
            Edit::RestoreAll { condition } => format!("restore all (condition {})", id_of(condition)),
            Edit::Pin(id) => format!("pin {}", name_of(id)),
            Edit::Unpin { condition, .. } => format!("unpin (condition {})", id_of(condition)),
            Edit::SetScheduled { condition, scheduled: true } => format!("schedule condition {}", id_of(condition)),
            Edit::SetScheduled { condition, .. } => format!("leave condition {} out", id_of(condition)),
            Edit::ConstrainOnAxis => "hold the on-axis responses".to_owned(),
            Edit::Set(setting) => setting.label(dataset),
        }
    }

    /// Whether two decisions in a row are one to the engineer: two positions of the same slider.
    pub fn continues(&self, earlier: &Edit) -> bool {
        match (self, earlier) {
            (Edit::Set(later), Edit::Set(earlier)) => later.continues(earlier),
            _ => false,
        }
    }
}

impl Study {
    /// Carries out one decision, or refuses it and leaves the study as it was.
    pub fn apply(&mut self, edit: &Edit) -> Result<(), EditRefusal> {
        match edit {
            Edit::Reject(id) => return self.reject(*id),
            Edit::RejectAll { condition, models } => return self.reject_all(*condition, models),
            Edit::Pin(id) => return self.pin(*id),
            Edit::Restore(id) => {
                self.check_model(*id)?;
                self.choices[id.condition].bundle_mut(id.bundle).rejected.remove(&id.model);
            }
            Edit::RestoreAll { condition } => {
                self.check_condition(*condition)?;
                self.choices[*condition].physics.rejected.clear();
                self.choices[*condition].identified.rejected.clear();
            }
            Edit::Unpin { condition, bundle } => {
                self.check_condition(*condition)?;
                self.choices[*condition].bundle_mut(*bundle).pinned = None;
            }
            Edit::SetScheduled { condition, scheduled } => {
                self.check_condition(*condition)?;
                self.choices[*condition].scheduled = *scheduled;
            }
            Edit::ConstrainOnAxis => self.settings.constrained = self.dataset.on_axis().clone(),
            Edit::Set(setting) => return self.settings.apply(setting),
        }
        Ok(())
    }

    fn check_condition(&self, condition: usize) -> Result<(), EditRefusal> {
        if condition < self.choices.len() { Ok(()) } else { Err(EditRefusal::NoSuch { what: "condition" }) }
    }

    fn check_model(&self, id: ModelId) -> Result<(), EditRefusal> {
        self.check_condition(id.condition)?;
        let models = self.dataset.conditions()[id.condition].bundle(id.bundle);
        if id.model < models.len() { Ok(()) } else { Err(EditRefusal::NoSuch { what: "model" }) }
    }

    fn reject(&mut self, id: ModelId) -> Result<(), EditRefusal> {
        self.check_model(id)?;
        let condition = &self.dataset.conditions()[id.condition];
        let models = condition.bundle(id.bundle);
        let choice = self.choices[id.condition].bundle_mut(id.bundle);
        if !choice.rejected.contains(&id.model) && choice.rejected.len() + 1 == models.len() {
            return Err(EditRefusal::LastModel { condition: condition.id(), model: models[id.model].name.clone() });
        }
        choice.rejected.insert(id.model);
        if choice.pinned == Some(id.model) {
            choice.pinned = None;
        }
        Ok(())
    }

    fn reject_all(&mut self, condition: usize, models: &[usize]) -> Result<(), EditRefusal> {
        let mut trial = self.clone();
        for &model in models {
            trial.reject(ModelId { condition, bundle: BundleKind::Physics, model })?;
        }
        *self = trial;
        Ok(())
    }

    fn pin(&mut self, id: ModelId) -> Result<(), EditRefusal> {
        self.check_model(id)?;
        if self.is_rejected(id) {
            let condition = self.dataset.conditions()[id.condition].id();
            return Err(EditRefusal::PinRejected { condition, model: self.dataset.model(id).name.clone() });
        }
        self.choices[id.condition].bundle_mut(id.bundle).pinned = Some(id.model);
        Ok(())
    }
}
