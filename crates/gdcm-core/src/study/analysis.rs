//! The result of a whole study.

use std::collections::BTreeMap;
use std::sync::Arc;

use crate::dataset::{ConditionId, PairTable};
use crate::schedule::{CostChange, Evidence, LeadEvidence, Schedule, ScheduleError, evidence, lead_evidence};

use super::condition_analysis::{ConditionAnalysis, ConditionFailure};
use super::document::Study;
use super::engine::scheduled_points;
use super::uncertainty::Uncertainty;

/// The nominal model of a condition under the scheduled correction (M12).
#[derive(Clone, Debug, PartialEq)]
pub enum Assessed {
    /// J of every response before and after.
    Nominal(PairTable<Option<CostChange>>),
    /// The condition is left out, and why.
    LeftOut {
        /// The reason in words.
        why: String,
    },
}

/// Everything the analysis says of a study.
#[derive(Clone, Debug, PartialEq)]
pub struct Analysis {
    /// The study that was analysed.
    pub study: Study,
    /// Frequencies of comparison \[rad/s\].
    pub omega: Arc<[f64]>,
    /// Result of each condition.
    pub conditions: BTreeMap<ConditionId, Result<ConditionAnalysis, ConditionFailure>>,
    /// The schedule of the chosen conditions.
    pub schedule: Result<Schedule, ScheduleError>,
    /// Assessment of each condition.
    pub assessment: BTreeMap<ConditionId, Assessed>,
    /// How sure its figures are, once that has been asked for ([`Engine::uncertainty`](super::Engine::uncertainty)).
    pub uncertainty: Option<Arc<Uncertainty>>,
}

impl Analysis {
    /// Result of one condition, where there is one.
    pub fn condition(&self, id: ConditionId) -> Option<&ConditionAnalysis> {
        self.conditions.get(&id)?.as_ref().ok()
    }

    /// The conditions that the schedule is made of, in the dataset's order: the chosen ones that have a result.
    pub fn scheduled(&self) -> Vec<ConditionId> {
        let all = self.study.dataset.conditions().iter().map(|condition| condition.id());
        all.filter(|id| self.study.choice(*id).is_in_schedule() && self.condition(*id).is_some()).collect()
    }

    /// The schedule of the chosen conditions without one of them.
    ///
    /// # Errors
    /// [`ScheduleError`] where there is none.
    pub fn schedule_without(&self, left_out: ConditionId) -> Result<Schedule, ScheduleError> {
        let mut others = self.study.clone();
        if let Some(choice) = others.choices.get_mut(&left_out) {
            choice.scheduled = false;
        }
        Schedule::of(&scheduled_points(&others, &self.conditions), self.study.settings.schedule)
    }

    /// What speaks for each form of the schedule, its lists in the order of [`Analysis::scheduled`] (M11). Some hundred small
    /// least squares problems.
    ///
    /// # Errors
    /// [`ScheduleError`] where there is no schedule.
    pub fn evidence(&self) -> Result<Evidence, ScheduleError> {
        evidence(&scheduled_points(&self.study, &self.conditions), self.study.settings.schedule)
    }

    /// What speaks for each degree of the scheduled signed delays; none where leads are not asked for (M15.5).
    pub fn lead_evidence(&self) -> Vec<LeadEvidence> {
        lead_evidence(&scheduled_points(&self.study, &self.conditions), self.study.settings.schedule)
    }
}
