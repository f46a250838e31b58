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
        let mut study = self.clone();
        let gone = self.dataset.conditions().iter().filter(|old| dataset.condition(old.id()).is_none());
        let differences = gone.map(|old| Difference(format!("condition {} is gone", old.id()))).collect();
        study.dataset = dataset;
        (study, differences)
    }
}
