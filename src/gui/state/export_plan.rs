//! The export dialog's dry run.
//!
//! 1. When the dialog, the study or the results change, [`State::export_plan_job`] changes.
//! 2. The job computes every file without writing any; its outcome is `ExportForm::plan`.
//! 3. Files are written only from a plan whose job is the requested one.

use gdcm_io::export::export_set::ExportPlan;
use gdcm_model::dataset::BundleKind;
use gdcm_study::decisions::export_choices::ExportChoices;

use super::export_form::ExportPlanJob;
use super::forms::FormKind;
use super::window_state::State;
use crate::message::Message;

impl State {
    /// Returns the dry run that the open export dialog requests; `None` if it is closed, lacks an
    /// input, or waits for results.
    pub fn export_plan_job(&self) -> Option<ExportPlanJob> {
        if self.forms.shown != Some(FormKind::Export) || self.incomplete_results().is_some() {
            return None;
        }
        self.analysis()?;
        let form = &self.forms.export;
        Some(ExportPlanJob {
            analysis: self.results.analysis.clone()?,
            uncertainty: self.uncertainty().cloned(),
            source: form.source.clone()?,
            set: form.export_set().ok()?,
            revision: form.revision,
        })
    }

    /// Returns the outcome of the requested dry run; `None` until it is computed, and while none is
    /// requested.
    pub fn current_export_plan(&self) -> Option<&ExportPlan> {
        let (job, plan) = self.forms.export.plan.as_ref()?;
        if self.export_plan_job().as_ref() == Some(job) {
            Some(plan)
        } else {
            None
        }
    }

    /// Returns why the results for the current decisions are incomplete; `None` if they are
    /// complete.
    pub fn incomplete_results(&self) -> Option<Message> {
        let results = &self.results;
        if results.stopped {
            let text = format!(
                "{}: the computation was stopped; choose Compute first",
                self.after_stop().text
            );
            return Some(Message::new("computation-stopped", text));
        }
        if !results.background.proofs.is_empty() {
            let text = "the gains are still being proven optimal; try again in a moment, or stop \
                the proof";
            return Some(Message::new("proof-running", text));
        }
        if results.analysis.is_some() && !results.is_waiting() {
            return None;
        }
        let text = "the newest results are still being computed; try again in a moment";
        Some(Message::new("computation-running", text))
    }

    /// Returns the distinct airspeeds \[kt\] in the scheduled conditions, increasing.
    pub fn scheduled_airspeeds_kt(&self) -> Vec<f64> {
        let Some(analysis) = self.analysis() else {
            return Vec::new();
        };
        let mut airspeeds_kt = match &analysis.schedule {
            Ok(schedule) => schedule.airspeeds.values_kt.clone(),
            Err(_) => Vec::new(),
        };
        airspeeds_kt.sort_by(f64::total_cmp);
        airspeeds_kt.dedup();
        airspeeds_kt
    }

    /// Returns the names of the physics models, other than the nominal one, that every condition
    /// chosen for the export has.
    pub fn exported_model_names(&self) -> Vec<String> {
        let chosen = self.forms.export.chosen(self.dataset());
        let mut conditions = self
            .dataset()
            .conditions()
            .iter()
            .filter(|condition| chosen.contains(&condition.id()));
        let Some(first) = conditions.next() else {
            return Vec::new();
        };
        let mut names: Vec<String> = first
            .bundle(BundleKind::Physics)
            .iter()
            .map(|model| model.name.clone())
            .collect();
        for condition in conditions {
            names.retain(|name| condition.position(BundleKind::Physics, name).is_some());
        }
        // The nominal model is offered by its role.
        names.retain(|name| name != ExportChoices::NOMINAL);
        names
    }
}
