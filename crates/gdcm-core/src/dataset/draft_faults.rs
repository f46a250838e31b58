//! Everything that is wrong in a draft, not only the first of it.

use super::band::Band;
use super::condition::Condition;
use super::draft::{Checker, ConditionDraft, DatasetDraft, DraftError, check_count, check_records, on_axis_table};
use super::identity::BundleKind;
use super::limits::{MOST_CHANNELS, MOST_CONDITIONS};
use super::model::Model;
use super::place::Location;

/// More faults than this are not looked for: a file of another kind has one in every model.
const MOST_FAULTS: usize = 1000;

impl DatasetDraft {
    /// Every fault with its place, in the order of the draft; none where it is a dataset. What one fault hides, such as names that
    /// stand twice beside models that are wrong, comes out once that is mended.
    pub fn faults(&self) -> Vec<DraftError> {
        let mut faults: Vec<DraftError> = Vec::new();
        let counts = [
            check_count("inputs", self.inputs.len(), MOST_CHANNELS),
            check_count("outputs", self.outputs.len(), MOST_CHANNELS),
            check_count("conditions", self.conditions.len(), MOST_CONDITIONS),
        ];
        faults.extend(counts.into_iter().filter_map(Result::err));
        let band = Band::new(self.band.0, self.band.1);
        faults.extend(band.err().map(|error| DraftError::new(Location::default(), error)));
        faults.extend(on_axis_table(&self.outputs, &self.inputs, &self.on_axis).err());
        for (index, condition) in self.conditions.iter().enumerate() {
            if faults.len() >= MOST_FAULTS {
                return faults;
            }
            let mut checker = Checker::of(self);
            faults.extend(faults_of_condition(&mut checker, index + 1, condition));
        }
        if faults.is_empty() {
            faults.extend(self.clone().checked().err());
        }
        faults
    }
}

fn faults_of_condition(checker: &mut Checker, position: usize, draft: &ConditionDraft) -> Vec<DraftError> {
    let place = Location::condition(position, draft.flight_state.id.0);
    let mut faults = Vec::new();
    let mut bundle = |kind: BundleKind, drafts: &[super::draft::ModelDraft]| -> Vec<Model> {
        let drafts = drafts.iter().enumerate();
        let checked =
            drafts.map(|(index, draft)| checker.model(place.model(kind, index + 1, &draft.name), kind, draft.clone()));
        let mut models = Vec::new();
        for model in checked {
            match model {
                Ok(model) => models.push(model),
                Err(fault) => faults.push(fault),
            }
        }
        models
    };
    let physics = bundle(BundleKind::Physics, &draft.physics);
    let identified = bundle(BundleKind::Identified, &draft.identified);
    faults.extend(check_records(&place, draft.records.len()).err());
    if faults.is_empty() {
        let condition = Condition::new(draft.flight_state.clone(), physics, identified)
            .and_then(|condition| condition.with_records(draft.records.clone()));
        faults.extend(condition.err().map(|error| DraftError::new(place, error)));
    }
    faults
}
