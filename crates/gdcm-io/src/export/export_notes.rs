//! Notes on omissions and approximations in exported files, shared by several formats.
//!
//! The *chosen* conditions are those in the request, by default all. A condition's *own*
//! correction is its own optimum; the schedule is a regression of the optima over airspeed. A
//! *signed delay* is a channel's delay or, if negative, its lead (M15); it is *apart* if it differs
//! so much from those in the other conditions that no schedule can reproduce it. The *price* of
//! leads is the gain that they add above the band, and the frequency above which the model is not
//! valid (M15.6).

use std::collections::BTreeMap;

use gdcm_method::correction::LeadPrice;
use gdcm_method::correction::pade::HIGHEST_PADE_ORDER;
use gdcm_method::schedule::{Schedule, ScheduleCaution};
use gdcm_model::dataset::ConditionId;
use gdcm_study::results::export_note::{ExportNote, SignedDelayApart};
use gdcm_study::{AssessedCorrection, PhaseCorrection};

use super::Export;
use super::exported_model::ExportedModel;

/// Phase error \[deg\] due to approximations, below which a corrected model needs no note: with two
/// decimals it would be 0.00.
const NOTABLE_ERROR_DEG: f64 = 0.005;

impl Export<'_> {
    /// Returns the notes on a file with condition results: conditions not chosen or without a
    /// result; missing error bars, requested couplings or schedule; and the price of scheduled
    /// leads ([`LeadPrice`]).
    pub(super) fn result_notes(&self) -> Vec<ExportNote> {
        let analysis = self.analysis;
        let mut notes = self.choice_notes();
        let chosen = self.request.chosen_conditions(analysis);
        let without_result: Vec<ConditionId> = chosen
            .into_iter()
            .filter(|condition| analysis.condition(*condition).is_none())
            .collect();
        if !without_result.is_empty() {
            notes.push(ExportNote::ConditionsWithoutResult {
                conditions: without_result,
            });
        }
        if analysis.uncertainty.is_none() {
            notes.push(ExportNote::NoErrorBars);
        }
        if let Err(why) = analysis.requested_couplings() {
            notes.push(ExportNote::CouplingsLeftOut { why: why.clone() });
        }
        match &analysis.schedule {
            Ok(schedule) => notes.extend(price_note(schedule.lead_price())),
            Err(why) => notes.push(ExportNote::NoSchedule { why: *why }),
        }
        notes
    }

    /// Returns the notes on a file with the schedule: its delays, the conditions that it does not
    /// use, and the price of its leads; empty without a schedule.
    pub(super) fn schedule_notes(&self) -> Vec<ExportNote> {
        let Ok(schedule) = &self.analysis.schedule else {
            return Vec::new();
        };
        let scheduled = self.analysis.scheduled();
        let mut notes = self.delay_notes(schedule, &scheduled);
        let not_scheduled: Vec<ConditionId> = self
            .analysis
            .study
            .dataset
            .ids()
            .filter(|condition| !scheduled.contains(condition))
            .collect();
        if !not_scheduled.is_empty() {
            notes.push(ExportNote::ConditionsNotScheduled {
                conditions: not_scheduled,
            });
        }
        notes.extend(price_note(schedule.lead_price()));
        notes
    }

    /// Returns a note if conditions are not chosen.
    fn choice_notes(&self) -> Vec<ExportNote> {
        let chosen = self.request.chosen_conditions(self.analysis);
        let not_chosen: Vec<ConditionId> = self
            .analysis
            .study
            .dataset
            .ids()
            .filter(|condition| !chosen.contains(condition))
            .collect();
        if not_chosen.is_empty() {
            return Vec::new();
        }
        vec![ExportNote::ConditionsNotChosen {
            conditions: not_chosen,
        }]
    }

    /// Returns the notes on the scheduled delays and leads:
    ///
    /// - the schedule has none, although the study corrects the phase: the channels that the own
    ///   corrections of `conditions` delay;
    /// - the schedule has some: a note if all are constant;
    /// - in any case, the signed delays that are apart.
    fn delay_notes(&self, schedule: &Schedule, conditions: &[ConditionId]) -> Vec<ExportNote> {
        let analysis = self.analysis;
        let mut notes = Vec::new();
        if !schedule.has_delays() {
            let channels = analysis.delayed_channels(conditions);
            if analysis.study.settings.phase != PhaseCorrection::None && !channels.is_empty() {
                notes.push(ExportNote::DelaysNotScheduled { channels });
            }
        } else if self.has_constant_delays(schedule) {
            notes.push(ExportNote::ConstantDelays {
                is_signed: schedule.leads.is_some(),
            });
        }
        notes.extend(signed_delay_notes(schedule));
        notes
    }

    /// Returns whether no channel's scheduled delay (with leads: signed delay) depends on airspeed.
    /// False without scheduled delays, and if the schedule has a single airspeed, over which
    /// nothing could vary.
    fn has_constant_delays(&self, schedule: &Schedule) -> bool {
        let airspeeds = &schedule.airspeeds;
        if airspeeds.min_kt == airspeeds.max_kt {
            return false;
        }
        let taus_s = match (&schedule.leads, &schedule.delays) {
            (Some(leads), _) => &leads.taus_s,
            (None, Some(delays)) => &delays.taus_s,
            (None, None) => return false,
        };
        taus_s
            .iter()
            .all(|(_, regression)| regression.parameters().len() == 1)
    }
}

/// Returns a note on each condition with signed delays apart from those in the other conditions;
/// its channels are sorted by this difference, largest first.
fn signed_delay_notes(schedule: &Schedule) -> Vec<ExportNote> {
    let mut apart_by_condition: BTreeMap<ConditionId, Vec<SignedDelayApart>> = BTreeMap::new();
    for caution in &schedule.cautions {
        if let ScheduleCaution::SignedDelayApart {
            channel,
            condition,
            tau_s,
            elsewhere_s,
        } = caution
        {
            let apart = SignedDelayApart {
                channel: *channel,
                tau_s: *tau_s,
                elsewhere_s: *elsewhere_s,
            };
            apart_by_condition
                .entry(*condition)
                .or_default()
                .push(apart);
        }
    }
    let mut notes = Vec::new();
    for (condition, mut channels) in apart_by_condition {
        channels.sort_by(|a, b| {
            let difference_a = (a.tau_s - a.elsewhere_s).abs();
            let difference_b = (b.tau_s - b.elsewhere_s).abs();
            difference_b.total_cmp(&difference_a)
        });
        notes.push(ExportNote::SignedDelaysNotScheduled {
            condition,
            channels,
        });
    }
    notes
}

/// Returns the notes on a file with corrected models: conditions not chosen; delays and lead price,
/// from the schedule if it corrects the models, else only the price, from the models; and the
/// accuracy of the worst model if its error is notable.
pub(super) fn model_notes(export: &Export<'_>, models: &[ExportedModel]) -> Vec<ExportNote> {
    let mut notes = export.choice_notes();
    let conditions: Vec<ConditionId> = models.iter().map(|model| model.condition).collect();
    let is_scheduled = export.request.correction != AssessedCorrection::Own;
    match &export.analysis.schedule {
        Ok(schedule) if is_scheduled => {
            notes.extend(export.delay_notes(schedule, &conditions));
            notes.extend(price_note(schedule.lead_price()));
        }
        _ => notes.extend(price_note(greatest_price(models))),
    }
    let mut worst: Option<&ExportedModel> = None;
    for model in models {
        let error_deg = model.approximation_error_deg;
        if worst.is_none_or(|found| error_deg > found.approximation_error_deg) {
            worst = Some(model);
        }
    }
    if let Some(worst) = worst
        && worst.approximation_error_deg >= NOTABLE_ERROR_DEG
    {
        notes.push(accuracy_note(worst));
    }
    notes
}

/// Returns the note on a model's phase error; for Padé approximants, the next higher order is the
/// remedy, up to the highest.
fn accuracy_note(model: &ExportedModel) -> ExportNote {
    let error_deg = model.approximation_error_deg;
    let band_top_rad_s = model.band_top_rad_s;
    if model.pade_order == 0 {
        return ExportNote::TustinError {
            error_deg,
            band_top_rad_s,
        };
    }
    let next = model.pade_order + 1;
    ExportNote::PadeError {
        order: model.pade_order,
        error_deg,
        band_top_rad_s,
        remedy: if next <= HIGHEST_PADE_ORDER {
            Some(next)
        } else {
            None
        },
    }
}

fn price_note(price: Option<LeadPrice>) -> Option<ExportNote> {
    let price = price?;
    Some(ExportNote::NotValidAbove { price })
}

/// Returns the price with each channel's maximum gain over the models; `None` without lead filters.
fn greatest_price(models: &[ExportedModel]) -> Option<LeadPrice> {
    let mut greatest: Option<LeadPrice> = None;
    for model in models {
        let Some(described) = &model.price else {
            continue;
        };
        greatest = Some(match greatest {
            Some(price) => price.or_more(&described.price),
            None => described.price.clone(),
        });
    }
    greatest
}
