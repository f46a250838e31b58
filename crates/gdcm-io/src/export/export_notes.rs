//! Notes on omissions and approximations in exported files, shared by several formats.
//!
//! A condition's *own* correction is its own optimum; the schedule is a regression of the
//! optima over airspeed. A *signed delay* is a channel's delay or, if negative, its lead (M15).
//! The *price* of leads is the gain that they add above the band, and the frequency above which
//! the model is not valid (M15.6).

use std::collections::BTreeMap;

use gdcm_method::correction::LeadPrice;
use gdcm_method::correction::pade::HIGHEST_PADE_ORDER;
use gdcm_method::schedule::{Schedule, ScheduleCaution};
use gdcm_model::dataset::ConditionId;
use gdcm_study::results::export_note::{ExportNote, SignedDelayApart};
use gdcm_study::{AssessedCorrection, PhaseCorrection};

use super::Export;
use super::exported_model::ExportedModel;

/// Phase error \[deg\] due to approximations, below which a corrected model needs no note.
const NOTABLE_ERROR_DEG: f64 = 0.005;

impl Export<'_> {
    /// Returns the notes on a file with condition results: conditions not chosen or without a
    /// result; missing error bars, requested couplings or schedule; and the price of scheduled
    /// leads ([`LeadPrice`]).
    pub(super) fn result_notes(&self) -> Vec<ExportNote> {
        let analysis = self.analysis;
        let mut notes = self.choice_notes();
        let chosen = self.request.chosen(analysis);
        let failed: Vec<ConditionId> = chosen
            .into_iter()
            .filter(|condition| analysis.condition(*condition).is_none())
            .collect();
        if !failed.is_empty() {
            notes.push(ExportNote::ConditionsWithoutResult { conditions: failed });
        }
        if analysis.uncertainty.is_none() {
            notes.push(ExportNote::NoErrorBars);
        }
        if let Err(why) = analysis.asked_couplings() {
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
        let mut notes = self.delay_notes(schedule, &self.analysis.scheduled());
        let scheduled = self.analysis.scheduled();
        let others: Vec<ConditionId> = self
            .analysis
            .study
            .dataset
            .ids()
            .filter(|condition| !scheduled.contains(condition))
            .collect();
        if !others.is_empty() {
            notes.push(ExportNote::ConditionsNotScheduled { conditions: others });
        }
        notes.extend(price_note(schedule.lead_price()));
        notes
    }

    /// Returns a note if the engineer has left out conditions.
    fn choice_notes(&self) -> Vec<ExportNote> {
        let chosen = self.request.chosen(self.analysis);
        let left_out: Vec<ConditionId> = self
            .analysis
            .study
            .dataset
            .ids()
            .filter(|condition| !chosen.contains(condition))
            .collect();
        if left_out.is_empty() {
            return Vec::new();
        }
        vec![ExportNote::ConditionsNotChosen {
            conditions: left_out,
        }]
    }

    /// Returns the notes on the scheduled delays and leads: if the schedule has none although the
    /// study corrects the phase, the channels that the own corrections of `conditions` delay; if
    /// the schedule has some, whether all are constant; then the signed delays that cannot be
    /// scheduled.
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
    /// False without scheduled delays, and if the schedule has a single airspeed.
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

/// Returns a note on each condition with signed delays that cannot be scheduled; its channels are
/// sorted by their difference from the other conditions, largest first.
fn signed_delay_notes(schedule: &Schedule) -> Vec<ExportNote> {
    let mut by_condition: BTreeMap<ConditionId, Vec<SignedDelayApart>> = BTreeMap::new();
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
            by_condition.entry(*condition).or_default().push(apart);
        }
    }
    let mut notes = Vec::new();
    for (condition, mut channels) in by_condition {
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

/// Returns the notes on a file with corrected models: left-out conditions; delays and lead price,
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
