//! Conditions in the schedule, and alternative schedules: without a condition, in other forms
//! (M11).
//!
//! The schedule gives the correction as a function of airspeed. A held-out condition is excluded
//! from its fit, so that it can validate it.

use gdcm_method::schedule::delay_scheduling::NOTABLE_DELAY_S;
use gdcm_method::schedule::form_comparison::{FormComparison, compare_forms};
use gdcm_method::schedule::lead_degree_comparison::{LeadDegreeFit, compare_lead_degrees};
use gdcm_method::schedule::{
    DelayScheduling, Schedule, ScheduleError, ScheduleSettings, ScheduledPoint,
};
use gdcm_model::dataset::ConditionId;

use super::analysis::{Analysis, ConditionAnalysis, Outcomes};
use crate::decisions::study::Study;

impl Analysis {
    /// Returns the conditions in the schedule, in the dataset's order: those that are chosen, not
    /// held out, and have a result.
    pub fn scheduled(&self) -> Vec<ConditionId> {
        in_schedule(&self.study, &self.conditions)
            .map(|result| result.condition.id())
            .collect()
    }

    /// Fits the schedule to the chosen conditions except one.
    ///
    /// # Errors
    /// [`ScheduleError`] where the remaining conditions do not admit a schedule.
    pub fn schedule_without(&self, left_out: ConditionId) -> Result<Schedule, ScheduleError> {
        let mut others = self.study.clone();
        if let Some(choice) = others.choices.get_mut(&left_out) {
            choice.scheduled = false;
        }
        let settings = schedule_settings(&others, &self.conditions);
        Schedule::fit(&scheduled_points(&others, &self.conditions), settings)
    }

    /// Compares the schedule's possible forms; lists are in the order of [`Analysis::scheduled`]
    /// (M11). Solves several hundred small least-squares problems.
    ///
    /// # Errors
    /// [`ScheduleError`] where there is no schedule.
    pub fn compare_forms(&self) -> Result<FormComparison, ScheduleError> {
        compare_forms(
            &scheduled_points(&self.study, &self.conditions),
            self.study.settings.schedule,
        )
    }

    /// Compares polynomial degrees for the scheduled signed delays; empty where leads are not
    /// requested (M15.5).
    pub fn compare_lead_degrees(&self) -> Vec<LeadDegreeFit> {
        compare_lead_degrees(
            &scheduled_points(&self.study, &self.conditions),
            self.study.settings.schedule,
        )
    }
}

/// Returns the data to which the schedule is fitted: each scheduled condition's airspeed, second
/// variable, correction and delay bound.
pub(crate) fn scheduled_points<'a>(
    study: &Study,
    outcomes: &'a Outcomes,
) -> Vec<ScheduledPoint<'a>> {
    let second_variable = study.settings.schedule.second;
    in_schedule(study, outcomes)
        .map(|result| {
            let state = result.condition.flight_state();
            ScheduledPoint {
                airspeed_kt: state.airspeed_kt,
                correction: &result.correction,
                delay_upper_s: result.delay_upper_s(),
                second: second_variable.and_then(|variable| variable.value(state)),
            }
        })
        .collect()
}

/// Returns the schedule settings; `DelayScheduling::Automatic` is resolved from the scheduled
/// conditions' results (M11).
pub(crate) fn schedule_settings(study: &Study, outcomes: &Outcomes) -> ScheduleSettings {
    let delays = match study.settings.schedule_delays {
        DelayScheduling::Always => true,
        DelayScheduling::Never => false,
        DelayScheduling::Automatic => in_schedule(study, outcomes).any(has_notable_delay),
    };
    ScheduleSettings {
        delays,
        ..study.settings.schedule
    }
}

/// Returns whether a constrained response has a net delay above half a millisecond.
fn has_notable_delay(result: &ConditionAnalysis) -> bool {
    result
        .held()
        .marked()
        .any(|pair| result.correction.net_delay_s(pair) > NOTABLE_DELAY_S)
}

/// Returns the scheduled conditions' results, in dataset order. Every list of scheduled conditions
/// in this file is derived from this one.
pub(crate) fn in_schedule<'a>(
    study: &Study,
    outcomes: &'a Outcomes,
) -> impl Iterator<Item = &'a ConditionAnalysis> {
    let chosen = study
        .dataset
        .ids()
        .filter(|id| study.choice(*id).is_in_schedule());
    chosen.filter_map(|id| outcomes.get(&id)?.as_ref().ok())
}
