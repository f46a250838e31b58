//! Identification from flight records: starts and stops the jobs, and puts the models into the
//! study.
//!
//! The method is in docs/identification.md. An identification finds several models for a condition;
//! the engineer chooses which of them replace the identified models in the study
//! ([`AdoptionChoice`]). `records.running` are the running and the waiting jobs.

use std::sync::Arc;

use gdcm_model::dataset::ConditionId;
use gdcm_model::number_format::counted;
use gdcm_study::Edit;
use gdcm_study::decisions::adopted_models::{AdoptedModels, AdoptionChoice};
use gdcm_study::jobs::identification_jobs::IdentifyJob;
use gdcm_sysid::identification::{Identification, IdentificationError};

use super::GdcmApp;
use crate::gui::state::condition_records::EndedIdentification;
use crate::gui::state::notices::{Activity, NoticeAction};
use crate::message::Message;

impl GdcmApp {
    /// Requests identification in these conditions; replaces waiting and running jobs for the same
    /// conditions. If requests are refused, reports the last refusal.
    pub(super) fn identify_conditions(&mut self, conditions: &[ConditionId]) {
        if self.state.records.jobs.is_empty() {
            self.state.records.requested_count = 0;
        }
        let mut refusal = None;
        for id in conditions {
            self.follow_band(*id);
            let band = self.state.identified_band(*id);
            let channels = self.record_channels(*id);
            let Some(records) = self.state.records.conditions.get(id) else {
                continue;
            };
            match records.identification_job(*id, band, &channels) {
                Ok(job) => self.state.records.request_job(job),
                Err(problem) => {
                    let text = format!("condition {id}: {}", problem.text);
                    refusal = Some(Message::new(problem.code, text));
                }
            }
        }
        if let Some(refusal) = refusal {
            self.notify_error(refusal);
        }
    }

    /// Stops running and waiting identification jobs; they can be started again.
    pub(super) fn stop_identifying(&mut self) {
        let unfinished = std::mem::take(&mut self.state.records.jobs).len();
        let requested = self.state.records.requested_count;
        if requested > 1 && unfinished > 0 {
            let finished = requested.saturating_sub(unfinished);
            let text = format!("stopped identifying after {finished} of {requested} conditions");
            self.notify_done(Message::new("identification-stopped", text));
        }
    }

    /// Stores an identification's outcome, unless it was stopped or replaced in the meantime.
    pub(super) fn identified(
        &mut self,
        job: IdentifyJob,
        outcome: Result<Arc<Identification>, IdentificationError>,
    ) {
        if !self.state.records.jobs.contains(&job) {
            return;
        }
        self.state.records.jobs.retain(|other| *other != job);
        let requested = self.state.records.requested_count;
        if self.state.records.jobs.is_empty() && requested > 1 {
            let text = format!("identification finished for {requested} conditions");
            self.notify_done(Message::new("identification-finished", text));
        }
        if let Some(records) = self.state.records.conditions.get_mut(&job.condition) {
            records.changed_since_fit = false;
            records.latest = Some(EndedIdentification { job, outcome });
        }
    }

    /// Puts the models that were identified in these conditions into the study, where they replace
    /// the earlier identified models.
    pub(super) fn adopt_identified(&mut self, conditions: &[ConditionId], choice: AdoptionChoice) {
        let adopted = self.adopted_models(conditions, choice);
        if adopted.is_empty() {
            return self.notify_error(Message::new(
                "nothing-identified",
                "nothing has been identified yet; choose Identify first",
            ));
        }
        let models: usize = adopted
            .iter()
            .map(|(_, adopted)| adopted.models.len())
            .sum();
        let names: Vec<String> = adopted.iter().map(|(id, _)| id.to_string()).collect();
        let before = self.state.study.clone();
        self.decide(&Edit::AdoptModels(adopted));
        if self.state.study != before {
            let models = counted(models, "model");
            let conditions = if names.len() == 1 {
                "condition"
            } else {
                "conditions"
            };
            let names = names.join(", ");
            let text = format!("now in use: {models} in {conditions} {names}");
            let message = Message::new("models-adopted", text);
            self.notify_done_with(Activity::Other, message, Some(NoticeAction::Undo));
        }
    }

    /// Returns the identified models by condition; conditions without any are omitted.
    fn adopted_models(
        &self,
        conditions: &[ConditionId],
        choice: AdoptionChoice,
    ) -> Vec<(ConditionId, Arc<AdoptedModels>)> {
        let mut adopted = Vec::new();
        for id in conditions {
            let Some(records) = self.state.records.conditions.get(id) else {
                continue;
            };
            if let Some(models) = records.adopted(choice, &self.record_channels(*id)) {
                adopted.push((*id, models));
            }
        }
        adopted
    }
}
