//! The transmission zeros of one response in every model of a condition.

use std::sync::Arc;

use crate::dataset::{BundleKind, Condition, Dynamics, Pair};
use crate::response::{TransmissionZeros, ZerosError, transmission_zeros};

use super::job::Job;
use super::progress::{Cancelled, Progress};

/// The zeros of one model; none of a measured response, which has no states.
pub type ModelZeros = Option<Result<TransmissionZeros, ZerosError>>;

/// The transmission zeros of one response in every model of a condition, in file order.
#[derive(Clone, Debug, PartialEq)]
pub struct ConditionZeros {
    /// The condition: it names the models.
    pub condition: Arc<Condition>,
    /// The response.
    pub pair: Pair,
    /// Zeros of the physics models.
    pub physics: Vec<ModelZeros>,
    /// Zeros of the identified models.
    pub identified: Vec<ModelZeros>,
}

impl ConditionZeros {
    /// The zeros of one bundle.
    pub fn bundle(&self, kind: BundleKind) -> &[ModelZeros] {
        match kind {
            BundleKind::Physics => &self.physics,
            BundleKind::Identified => &self.identified,
        }
    }
}

/// The transmission zeros of one response in every model of a condition: some milliseconds for each.
#[derive(Clone, Debug)]
pub struct ZerosJob {
    /// The condition.
    pub condition: Arc<Condition>,
    /// The response.
    pub pair: Pair,
}

impl PartialEq for ZerosJob {
    fn eq(&self, other: &Self) -> bool {
        Arc::ptr_eq(&self.condition, &other.condition) && self.pair == other.pair
    }
}

impl Job for ZerosJob {
    type Tools = ();
    type Output = Arc<ConditionZeros>;

    fn run(&self, (): &mut (), progress: &dyn Progress) -> Result<Self::Output, Cancelled> {
        let total = BundleKind::BOTH.into_iter().map(|kind| self.condition.bundle(kind).len()).sum();
        let mut done = 0;
        let mut of_bundle = |kind| {
            let mut found = Vec::with_capacity(self.condition.bundle(kind).len());
            for model in self.condition.bundle(kind) {
                if progress.cancelled() {
                    return Err(Cancelled);
                }
                found.push(match &model.dynamics {
                    Dynamics::StateSpace(model) => Some(transmission_zeros(model, self.pair)),
                    Dynamics::Measured(_) => None,
                });
                done += 1;
                progress.advanced(done, total);
            }
            Ok(found)
        };
        let (physics, identified) = (of_bundle(BundleKind::Physics)?, of_bundle(BundleKind::Identified)?);
        Ok(Arc::new(ConditionZeros { condition: Arc::clone(&self.condition), pair: self.pair, physics, identified }))
    }
}
