//! How sure the figures of an analysis are, beside the live answer.

use std::sync::Arc;

use super::analysis::Analysis;
use super::engine::Engine;
use super::job::Job;
use super::progress::{Cancelled, Progress};
use super::uncertainty::Uncertainty;

/// The bars of an analysis, and what follows from them.
#[derive(Clone, Debug)]
pub struct UncertaintyJob {
    /// The analysis.
    pub analysis: Arc<Analysis>,
}

impl PartialEq for UncertaintyJob {
    fn eq(&self, other: &Self) -> bool {
        Arc::ptr_eq(&self.analysis, &other.analysis)
    }
}

impl Job for UncertaintyJob {
    /// An engine that keeps responses and swaps from one analysis to the next.
    type Tools = Engine;
    type Output = Arc<Uncertainty>;

    fn run(&self, engine: &mut Engine, progress: &dyn Progress) -> Result<Self::Output, Cancelled> {
        engine.uncertainty(&self.analysis, progress).map(Arc::new)
    }
}
