//! Identifying models from a condition's records: the job, the cautions about its result, and the
//! models to adopt.
//!
//! `ConditionRecords::latest` keeps the latest outcome with its job. `ConditionRecords::changed` is
//! set once records or settings have changed; the cautions about the outcome are then no longer
//! shown.
//!
//! A row is a record or a part of one. Its `guess` says what manoeuvre it is and whether it is held
//! out, from its name or from the engineer; held-out records test the model instead of being
//! fitted. A reference is a recorded signal that excited the loop from outside (M14.15:
//! docs/identification.md).

use std::sync::Arc;

use gdcm_model::dataset::ConditionId;
use gdcm_model::dataset::channel::ChannelSide;
use gdcm_model::names::ChannelRule;
use gdcm_model::simulation::Signal;
use gdcm_study::decisions::adopted_models::{AdoptedModels, AdoptionChoice};
use gdcm_study::jobs::identification_jobs::{IdentificationRequest, IdentifyJob};
use gdcm_sysid::identification::{CautionNote, ChannelPreparation, Identification, Preparation};
use gdcm_sysid::records::{ColumnUse, LaidOutRecord, RecordChannels};

use super::condition_records::ConditionRecords;
use crate::message::Message;
use crate::message_codes::layout_problem_code;

impl ConditionRecords {
    /// Returns the latest identification if it succeeded.
    pub fn identification(&self) -> Option<&Arc<Identification>> {
        self.latest.as_ref()?.outcome.as_ref().ok()
    }

    /// Creates the identification job for the current settings and a band \[rad/s\]; `channels` are
    /// the channels in the records. Recorded references (M14.15) become further inputs, after those
    /// of the dataset.
    ///
    /// # Errors
    /// A message, if no record is used, if all are held out, or if a record lacks a reference or
    /// cannot be used with it.
    pub fn identification_job(
        &self,
        condition: ConditionId,
        band: [f64; 2],
        channels: &RecordChannels,
    ) -> Result<IdentifyJob, Message> {
        let mut preparation = self.preparation();
        for reference in &self.references {
            preparation
                .inputs
                .push(ChannelPreparation::named(reference));
        }
        let mut rows = Vec::new();
        for (_, row) in self.used_rows() {
            rows.push(self.record_with_references(row, channels)?);
        }
        let mut request = IdentificationRequest::from_used(rows.iter(), preparation, band)
            .map_err(|error| Message::new("no-identification", error.to_string()))?;
        request.options.references = self.references.len();
        self.search.set(&mut request.options);
        Ok(IdentifyJob::new(condition, request))
    }

    /// Returns a record with the references as further inputs, after those of the dataset.
    fn record_with_references(
        &self,
        row: &LaidOutRecord,
        channels: &RecordChannels,
    ) -> Result<LaidOutRecord, Message> {
        if self.references.is_empty() {
            return Ok(row.clone());
        }
        let mut layout = row.layout.clone();
        let mut channels = channels.clone();
        for reference in &self.references {
            let Some(column) = row.table.find(reference) else {
                let name = &row.table.name;
                let text = format!(
                    "{name}: no column \"{reference}\", which is chosen as a reference; remove the \
                    reference, or leave the record out"
                );
                return Err(Message::new("no-such-column", text));
            };
            layout.inputs.push(Some(ColumnUse::as_it_is(column)));
            channels.inputs.push(ChannelRule::named(reference));
        }
        let row = LaidOutRecord::new(Arc::clone(&row.table), layout, row.guess.clone(), &channels);
        match row.problems.first() {
            Some(problem) => {
                let text = format!("{}: {problem}", row.table.name);
                Err(Message::new(layout_problem_code(problem), text))
            }
            None => Ok(row),
        }
    }

    /// Returns a channel's preparation, for editing.
    pub fn channel_mut(&mut self, signal: &Signal) -> Option<&mut ChannelPreparation> {
        match signal.role {
            ChannelSide::Input => self.inputs.get_mut(signal.index),
            ChannelSide::Output => self.outputs.get_mut(signal.index),
        }
    }

    /// Returns all channels' preparation.
    pub fn preparation(&self) -> Preparation {
        Preparation {
            inputs: self.inputs.clone(),
            outputs: self.outputs.clone(),
            ..Preparation::new(&[], &[])
        }
    }

    /// Returns the cautions about the identification, each with the rows that it concerns, if any;
    /// none once records or settings have changed.
    pub fn cautions(&self) -> impl Iterator<Item = (Vec<usize>, CautionNote)> {
        let cautions = match self.identification() {
            Some(identification) if !self.changed_since_fit => identification.cautions.as_slice(),
            _ => &[],
        };
        cautions.iter().map(|caution| {
            let note = caution.note();
            (self.rows_named(&note.records), note)
        })
    }

    /// Returns the short forms of the cautions with this code, each after a caution sign.
    pub fn marks(&self, code: &'static str) -> impl Iterator<Item = String> {
        self.cautions()
            .filter(move |(_, note)| note.code == code)
            .map(|(_, note)| format!("⚠ {}", note.mark()))
    }

    /// Returns the indices of the rows with these names; unknown names are skipped.
    fn rows_named(&self, names: &[String]) -> Vec<usize> {
        names
            .iter()
            .filter_map(|name| self.rows.iter().position(|row| row.table.name == *name))
            .collect()
    }

    /// Returns the index of the row that was record number `record`, from 0, in the identification;
    /// valid while the use of the rows has not changed since.
    pub fn row_of_record(&self, record: usize) -> Option<usize> {
        self.used_rows().nth(record).map(|(index, _)| index)
    }

    /// Returns the number, counted from 0, that the record with this name had in the latest
    /// identification, whatever has changed since.
    pub fn record_of_name(&self, name: &str) -> Option<usize> {
        let latest = self.latest.as_ref()?;
        latest
            .job
            .request
            .records
            .iter()
            .position(|record| record.name == name)
    }

    /// Returns χ²/dof for the record with this name in the latest identification, whatever has
    /// changed since; `None` if it was not used.
    pub fn fit_cost(&self, name: &str) -> Option<f64> {
        let number = self.record_of_name(name)?;
        let fits = &self.identification()?.record_fits;
        let fit = fits.iter().find(|fit| fit.record == number)?;
        Some(fit.cost)
    }

    /// Returns the identified models to put into the condition, those that the engineer has chosen,
    /// with entries about the records that they come from; `None` without a successful
    /// identification.
    pub fn adopted(
        &self,
        choice: AdoptionChoice,
        channels: &RecordChannels,
    ) -> Option<Arc<AdoptedModels>> {
        let identification = self.identification()?;
        let mut entries = Vec::new();
        for ((_, row), record_use) in self.used_rows().zip(&identification.record_uses) {
            entries.push(row.entry(record_use, channels));
        }
        Some(Arc::new(AdoptedModels::from_identification(
            identification,
            choice,
            entries,
        )))
    }

    /// Returns these records from the history, to replace the present records. Models identified in
    /// the meantime are kept, but marked as results from other settings; the displayed row remains
    /// too.
    pub(super) fn restored(mut self, present: Option<Self>) -> Self {
        let Some(present) = present else {
            return self;
        };
        if self.latest_job() != present.latest_job() {
            self.changed_since_fit = present.latest.is_some();
            self.latest = present.latest;
        }
        self.choose(present.chosen);
        self.is_chosen = present.is_chosen;
        self.latest_search = present.latest_search;
        self
    }

    /// Returns the latest identification job.
    fn latest_job(&self) -> Option<&IdentifyJob> {
        Some(&self.latest.as_ref()?.job)
    }
}
