//! STAND-IN: the decisions of a study, carried over to another dataset.

use std::fmt;
use std::sync::Arc;

use crate::dataset::Dataset;

use super::document::Study;

/// STAND-IN: one thing that is different.
#[derive(Clone, Debug, PartialEq)]
pub struct Difference(String);

impl fmt::Display for Difference {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.write_str(&self.0)
    }
}

impl Study {
    /// STAND-IN: this study of another dataset.
    pub fn carried_over(&self, dataset: Arc<Dataset>) -> (Study, Vec<Difference>) {
        let mut study = Study::new(dataset);
        let mut differences = Vec::new();
        if study.settings.constrained.outputs() == self.settings.constrained.outputs()
            && study.settings.constrained.inputs() == self.settings.constrained.inputs()
        {
            study.settings = self.settings.clone();
        }
        for (new, condition) in study.choices.iter_mut().zip(study.dataset.conditions()) {
            let old = self.dataset.conditions().iter().position(|old| old.id() == condition.id());
            match old {
                Some(old)
                    if self.dataset.conditions()[old].bundle(crate::dataset::BundleKind::Physics).len()
                        == condition.bundle(crate::dataset::BundleKind::Physics).len() =>
                {
                    *new = self.choices[old].clone();
                }
                _ => differences.push(Difference(format!("condition {} is changed", condition.id()))),
            }
        }
        (study, differences)
    }
}
