//! Sentences about differences between two states of a dataset, and about decisions that no longer
//! apply.

use gdcm_study::decisions::dataset_differences::{Difference, NotApplied};

use crate::edit::carried_decision_text;

/// Describes a difference between a dataset and its earlier state, with which a study was made.
pub fn dataset_difference_text(difference: &Difference) -> String {
    match difference {
        Difference::AnotherFile { expected, found } => format!(
            "the dataset has changed since the study was saved, and the study does not record the \
            earlier contents: expected SHA-256 {expected}, found {found}"
        ),
        Difference::ConditionAdded(id) => format!("condition {id} was added"),
        Difference::ConditionRemoved(id) => format!("condition {id} was removed"),
        Difference::AirspeedChanged {
            condition,
            before_kt,
            now_kt,
        } => format!("condition {condition} is at {now_kt} kt; it was at {before_kt} kt"),
        Difference::ModelAdded(id) => format!("{id} was added"),
        Difference::ModelRemoved(id) => format!("{id} was removed"),
        Difference::ModelChanged(id) => format!("{id} has changed"),
        Difference::NotApplied {
            decision,
            variant,
            why,
        } => {
            let mut name = carried_decision_text(decision);
            if let Some(variant) = variant {
                name.push_str(&format!(" (variant \"{variant}\")"));
            }
            format!(
                "a decision no longer applies: {name} ({})",
                not_applied_text(why)
            )
        }
    }
}

/// Returns why a decision does not apply to a dataset.
fn not_applied_text(why: &NotApplied) -> String {
    match why {
        NotApplied::Refused(refusal) => refusal.to_string(),
        NotApplied::KeptForAnotherDataset => {
            "the dataset has no such output; the decision is kept in the study, for datasets that \
             have it"
                .to_owned()
        }
        NotApplied::NoResponse => "the dataset has no such response".to_owned(),
        NotApplied::NoChannel => "the dataset has no such channel".to_owned(),
    }
}
