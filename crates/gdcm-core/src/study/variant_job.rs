//! The analysis of decisions other than the present ones.

use std::sync::Arc;

use super::analysis::Analysis;
use super::document::Study;
use super::engine::Engine;
use super::job::Job;
use super::progress::{Cancelled, Progress};

/// The analysis of a variant ([`Study::of_variant`]), beside the live answer.
#[derive(Clone, Debug)]
pub struct VariantJob {
    /// The study with the variant's decisions.
    pub study: Study,
}

impl PartialEq for VariantJob {
    /// The same dataset and the same decisions: the words that they are explained with do not count.
    fn eq(&self, other: &Self) -> bool {
        let (a, b) = (&self.study, &other.study);
        let conditions = || a.dataset.conditions().iter().map(|condition| condition.id());
        Arc::ptr_eq(&a.dataset, &b.dataset)
            && a.settings == b.settings
            && conditions().all(|id| a.choice(id).without_reasons() == b.choice(id).without_reasons())
    }
}

impl Job for VariantJob {
    /// An engine that keeps what variants have in common: responses and distances, which no decision but the band changes.
    type Tools = Engine;
    type Output = Arc<Analysis>;

    fn run(&self, engine: &mut Engine, progress: &dyn Progress) -> Result<Self::Output, Cancelled> {
        engine.analyze(&self.study, progress).map(Arc::new)
    }
}
