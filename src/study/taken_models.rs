//! Identified models taken into a condition in place of those of the dataset's file.

use std::collections::BTreeMap;
use std::sync::Arc;

use crate::dataset::{BundleKind, ConditionId, ConditionRecord, Dataset, Model};

use super::document::{BundleChoice, Study};
use super::edit::EditRefusal;

/// Models identified from flight records, and these.
#[derive(Clone, Debug, PartialEq)]
pub struct TakenModels {
    /// The identified bundle of the condition.
    pub models: Vec<Model>,
    /// The flight records of the condition.
    pub records: Vec<ConditionRecord>,
}

impl TakenModels {
    /// The dataset with these models for the identified bundle of a condition, and these records among its own.
    ///
    /// # Errors
    /// [`EditRefusal::NoCondition`], and [`EditRefusal::Models`] where they cannot be the condition's.
    pub fn put_into(&self, dataset: &Dataset, id: ConditionId) -> Result<Dataset, EditRefusal> {
        let before = dataset.condition(id).ok_or(EditRefusal::NoCondition { condition: id })?;
        let refused = |why: String| EditRefusal::Models { condition: id, why };
        let condition = before.with_identified(self.models.clone(), self.records.clone());
        let condition = condition.map_err(|error| refused(error.to_string()))?;
        dataset.with_condition(condition).map_err(|error| refused(error.to_string()))
    }
}

/// What a study has taken, and the dataset as its file has it.
#[derive(Clone, Debug)]
pub struct Taken {
    file: Arc<Dataset>,
    models: BTreeMap<ConditionId, Arc<TakenModels>>,
}

impl Study {
    /// The dataset as its file has it, whatever was taken since.
    pub fn file_dataset(&self) -> &Arc<Dataset> {
        self.taken.as_ref().map_or(&self.dataset, |taken| &taken.file)
    }

    /// The models taken in place of those of the file, condition by condition.
    pub fn taken_models(&self) -> impl Iterator<Item = (ConditionId, &Arc<TakenModels>)> {
        self.taken.iter().flat_map(|taken| taken.models.iter().map(|(id, models)| (*id, models)))
    }

    /// Takes models into conditions: into all of them, or into none. Decisions about models that are gone go with them.
    pub(super) fn take_models(&mut self, taken: &[(ConditionId, Arc<TakenModels>)]) -> Result<(), EditRefusal> {
        let mut models: BTreeMap<_, _> = self.taken_models().map(|(id, models)| (id, Arc::clone(models))).collect();
        models.extend(taken.iter().cloned());
        self.put_taken(models)
    }

    /// Puts the models of the file back into a condition.
    pub(super) fn return_models(&mut self, condition: ConditionId) -> Result<(), EditRefusal> {
        let models = self.taken_models().filter(|(id, _)| *id != condition);
        self.put_taken(models.map(|(id, models)| (id, Arc::clone(models))).collect())
    }

    fn put_taken(&mut self, models: BTreeMap<ConditionId, Arc<TakenModels>>) -> Result<(), EditRefusal> {
        let file = Arc::clone(self.file_dataset());
        let mut dataset = Arc::clone(&file);
        for (id, taken) in &models {
            dataset = Arc::new(taken.put_into(&dataset, *id)?);
        }
        self.dataset = dataset;
        self.taken = (!models.is_empty()).then_some(Taken { file, models });
        self.forget_absent_models();
        Ok(())
    }

    /// Drops decisions about identified models that the dataset does not have any more, the variants' too.
    fn forget_absent_models(&mut self) {
        let dataset = Arc::clone(&self.dataset);
        let is_there = |id: ConditionId, name: &str| {
            dataset.condition(id).is_some_and(|condition| condition.position(BundleKind::Identified, name).is_some())
        };
        for (id, choice) in &mut self.choices {
            choice.identified.retain(|name| is_there(*id, name));
        }
        for variant in &mut self.variants {
            let mut kept = variant.as_ref().clone();
            for (id, choice) in &mut kept.choices {
                choice.identified.retain(|name| is_there(*id, name));
            }
            if kept != **variant {
                *variant = Arc::new(kept);
            }
        }
    }
}

impl BundleChoice {
    fn retain(&mut self, is_there: impl Fn(&str) -> bool) {
        self.rejected.retain(|name| is_there(name));
        self.reasons.retain(|name, _| is_there(name));
        self.pinned = self.pinned.take().filter(|name| is_there(name));
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::dataset::ModelId;
    use crate::io::embedded_example;
    use crate::study::Edit;

    fn study() -> Study {
        Study::new(embedded_example().unwrap().dataset)
    }

    /// The identified models of condition 1 under other names.
    fn others(study: &Study) -> Arc<TakenModels> {
        let models = study.dataset.conditions()[0].bundle(BundleKind::Identified);
        let renamed = |model: &Model| Model { name: format!("{} again", model.name), ..model.clone() };
        Arc::new(TakenModels { models: models.iter().map(renamed).collect(), records: Vec::new() })
    }

    #[test]
    fn models_are_taken_and_returned_and_decisions_about_absent_ones_go() {
        let mut study = study();
        let before = study.clone();
        let id = ConditionId(1);
        let first = study.dataset.conditions()[0].bundle(BundleKind::Identified)[0].name.clone();
        study.apply(&Edit::Pin(ModelId::new(id, BundleKind::Identified, &first))).unwrap();
        study.apply(&Edit::KeepVariant { name: "pinned".into() }).unwrap();
        let taken = others(&study);
        study.apply(&Edit::TakeModels(vec![(id, Arc::clone(&taken))])).unwrap();
        assert_eq!(study.dataset.condition(id).unwrap().bundle(BundleKind::Identified), taken.models);
        assert_eq!(study.choice(id).identified.pinned, None, "the pinned model is gone");
        assert_eq!(study.variants[0].choices[&id].identified.pinned, None);
        assert!(Arc::ptr_eq(study.file_dataset(), &before.dataset), "the file's dataset is known still");
        study.apply(&Edit::ReturnModels { condition: id }).unwrap();
        assert!(Arc::ptr_eq(&study.dataset, &before.dataset) && study.taken.is_none());
    }

    #[test]
    fn models_of_another_shape_are_refused_and_nothing_is_taken() {
        let mut study = study();
        let before = study.clone();
        let nothing = Arc::new(TakenModels { models: Vec::new(), records: Vec::new() });
        let good = (ConditionId(1), others(&study));
        let refusal = study.apply(&Edit::TakeModels(vec![good, (ConditionId(2), nothing)])).unwrap_err();
        assert!(refusal.to_string().starts_with("condition 2: "), "{refusal}");
        assert_eq!(study, before);
        let absent = study.apply(&Edit::TakeModels(vec![(ConditionId(99), others(&before))])).unwrap_err();
        assert_eq!(absent, EditRefusal::NoCondition { condition: ConditionId(99) });
    }

    #[test]
    fn a_saved_study_and_a_reloaded_dataset_keep_the_models_taken() {
        use crate::io::{open_study, save_study};
        let loaded = embedded_example().unwrap();
        let mut study = Study::new(loaded.dataset.clone());
        let taken = others(&study);
        study.apply(&Edit::TakeModels(vec![(ConditionId(1), Arc::clone(&taken))])).unwrap();
        let pinned = ModelId::new(ConditionId(1), BundleKind::Identified, &taken.models[0].name);
        study.apply(&Edit::Pin(pinned)).unwrap();
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.gdcm-study.json");
        save_study(&study, &loaded, &path).unwrap();
        let opened = open_study(&path).unwrap();
        assert_eq!(opened.study, study);
        assert!(opened.differences.is_empty(), "{:?}", opened.differences);

        let (reloaded, differences) = opened.study.carried_over(embedded_example().unwrap().dataset);
        assert_eq!(reloaded, study, "models, and decisions about them");
        assert!(differences.is_empty(), "{differences:?}");
    }
}
