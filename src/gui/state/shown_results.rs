//! Results that the window shows: which computed results are still valid for the displayed study,
//! and how old they may be.
//!
//! [`Results`](super::computed_results::Results) keeps the last output from each kind of job,
//! together with the job. A newer output replaces it only when its job is complete. Until then the
//! methods below return the older output, so that a view does not become empty at each change, but
//! only if it answers the displayed question: each method checks dataset, condition and choices.
//! The settings may be older, except for results that explain others (`toggles`, `uncertainty`,
//! `value_uncertainty`), which must belong to exactly these. Otherwise the methods return `None`.
//!
//! The displayed condition's result arrives before the others (`Results::first`). It is then newer
//! than the analysis; [`State::others_are_older`] says so, and views show a notice.
//!
//! Datasets are compared by pointer: a result belongs to a single dataset even if another is equal.

use std::sync::Arc;

use gdcm_model::dataset::Dataset;
use gdcm_study::decisions::physics_settings::PhysicsCorrection;
use gdcm_study::jobs::across_job::AcrossCurves;
use gdcm_study::jobs::analysis_jobs::Toggles;
use gdcm_study::jobs::curve_jobs::ConditionModes;
use gdcm_study::jobs::requirement_jobs::RecordHistoryJob;
use gdcm_study::jobs::trade_off_job::TradeOff;
use gdcm_study::results::analysis::{ConditionFailure, NoResult};
use gdcm_study::results::assessment_table::AssessmentChoice;
use gdcm_study::results::couplings_assessment::AssessedCouplings;
use gdcm_study::results::physics_assessment::AssessedPhysics;
use gdcm_study::results::physics_findings::PhysicsFindings;
use gdcm_study::results::record_history::{NoRecordHistory, RecordHistory};
use gdcm_study::results::requirements::Requirements;
use gdcm_study::results::test_input_responses::TestAnswers;
use gdcm_study::results::time_histories::TimeHistories;
use gdcm_study::results::uncertainty::Uncertainty;
use gdcm_study::stages::condition_curves::ConditionCurves;
use gdcm_study::{Analysis, AssessmentTable, ConditionAnalysis, CouplingCorrection};

use super::value_uncertainty::ValueUncertainty;
use super::window_state::State;
use crate::message::Message;

impl State {
    /// Returns the newest analysis (the results of all conditions), if it belongs to the displayed
    /// dataset.
    pub fn analysis(&self) -> Option<&Analysis> {
        let analysis = self.results.analysis.as_deref()?;
        if !self.is_shown_dataset(&analysis.study.dataset) {
            return None;
        }
        Some(analysis)
    }

    /// Returns the newest outcome for the displayed condition and dataset: its result, or why it
    /// failed.
    pub fn outcome(&self) -> Option<&Result<ConditionAnalysis, ConditionFailure>> {
        let condition = self.condition().id();
        if let Some(first) = &self.results.first
            && first.condition == condition
            && self.is_shown_dataset(&first.dataset)
        {
            return Some(&first.outcome);
        }
        self.analysis()?.conditions.get(&condition)
    }

    /// Returns the displayed condition's result, if it belongs to the displayed dataset.
    pub fn shown(&self) -> Option<&ConditionAnalysis> {
        self.outcome()?.as_ref().ok()
    }

    /// Returns whether the other conditions' results, and everything derived from them, belong to
    /// older settings than the displayed condition's result. Views display a notice beside such
    /// results.
    pub fn others_are_older(&self) -> bool {
        match &self.results.first {
            Some(first) => {
                self.results.first_is_ahead()
                    && self.is_shown_dataset(&first.dataset)
                    && self.analysis().is_some()
            }
            None => false,
        }
    }

    /// Returns the names of the models that a result suggests as outliers and that are not
    /// rejected.
    pub fn open_suggestions(&self, result: &ConditionAnalysis) -> Vec<String> {
        let rejected = &self.study.choice(result.condition.id()).physics.rejected;
        result
            .suggested()
            .into_iter()
            .filter(|model| !rejected.contains(model))
            .collect()
    }

    /// Returns the cost of toggling the constraint on each response (constraining or releasing it),
    /// if it belongs to the displayed result.
    pub fn toggles(&self) -> Option<&Toggles> {
        let (job, toggles) = self.results.toggles.as_ref()?;
        if !job.is_of(self.shown()?) {
            return None;
        }
        Some(toggles)
    }

    /// Returns the displayed condition's frequency responses; `None` until they are computed.
    pub fn responses(&self) -> Option<&Arc<ConditionCurves>> {
        let (job, responses) = self.results.curves.as_ref()?;
        if job.condition != self.condition().id() || !self.is_shown_dataset(&job.dataset) {
            return None;
        }
        Some(responses)
    }

    /// Returns the message shown when curves are missing or being recomputed.
    pub fn curves_message(&self) -> Option<&'static str> {
        let results = &self.results;
        if results.is_behind() {
            Some(results.absence())
        } else if self.responses().is_some() {
            None
        } else if results.background.stopped {
            Some("stopped; choose Compute")
        } else {
            Some("computing …")
        }
    }

    /// Returns every model's modes in the displayed condition; `None` until they are computed.
    pub fn modes(&self) -> Option<&Arc<ConditionModes>> {
        let (job, modes) = self.results.modes.as_ref()?;
        if !Arc::ptr_eq(&job.condition, self.condition()) {
            return None;
        }
        Some(modes)
    }

    /// Returns the models' responses in each condition; until they are ready, those for older
    /// settings.
    pub fn across(&self) -> Option<&Arc<AcrossCurves>> {
        let (job, curves) = self.results.across.as_ref()?;
        if !self.is_shown_dataset(&job.dataset) {
            return None;
        }
        Some(curves)
    }

    /// Returns the requested assessment; until it is ready, that from an older analysis of the same
    /// dataset.
    pub fn assessment(&self) -> Option<&Arc<AssessmentTable>> {
        let (job, table) = self.results.assessment.as_ref()?;
        if !self.is_shown_dataset(&job.analysis.study.dataset)
            || job.choice != self.assessment_choice()
        {
            return None;
        }
        Some(table)
    }

    /// Returns the model, the correction and the average for which the assessment is computed.
    pub fn assessment_choice(&self) -> AssessmentChoice {
        let assessed = &self.display.judging.assessed;
        AssessmentChoice {
            model: assessed.model,
            correction: assessed.correction,
            average: assessed.average.unwrap_or(self.study.settings.cost_average),
        }
    }

    /// Returns the requirements; until they are ready, those from an older analysis of the same
    /// dataset.
    pub fn requirements(&self) -> Option<&Arc<Requirements>> {
        let (job, requirements) = self.results.requirements.as_ref()?;
        if !self.is_shown_dataset(&job.analysis.study.dataset) {
            return None;
        }
        Some(requirements)
    }

    /// Returns the models' responses to the test input in the displayed condition, or the reason
    /// why there are none. Until they are ready, returns the responses from an older analysis in
    /// the same condition.
    pub fn test_answers(&self) -> Option<&Result<Arc<TestAnswers>, NoResult>> {
        let (job, answers) = self.results.test_answers.as_ref()?;
        if !self.is_shown_dataset(&job.analysis.study.dataset)
            || job.condition != self.condition().id()
            || job.input != self.display.selection.pair.input
        {
            return None;
        }
        Some(answers)
    }

    /// Returns the comparison of a job's record with the tolerances, or the reason why it cannot be
    /// compared; until it is ready, the comparison from an older analysis.
    pub fn record_history(
        &self,
        job: &RecordHistoryJob,
    ) -> Option<&Result<Arc<RecordHistory>, NoRecordHistory>> {
        let (latest_job, history) = self.results.record_history.as_ref()?;
        if latest_job.condition != job.condition || latest_job.record != job.record {
            return None;
        }
        Some(history)
    }

    /// Returns the models' responses to the held-out records; until they are ready, those from an
    /// older analysis with the same records.
    pub fn time_histories(&self) -> Option<&Arc<TimeHistories>> {
        let (job, histories) = self.results.time_histories.as_ref()?;
        if job.records != self.records.held_out_records() {
            return None;
        }
        Some(histories)
    }

    /// Returns the benefit of the couplings, whether or not they are in use; until it is ready,
    /// that under older settings.
    pub fn couplings(&self) -> Option<&AssessedCouplings> {
        let (job, assessed) = self.results.couplings.as_ref()?;
        if !self.is_shown_dataset(&job.study.dataset) || job.couplings != self.assessed_couplings()
        {
            return None;
        }
        Some(assessed)
    }

    /// Returns the couplings that the study requests. If it requests none, returns mixing and
    /// feedback, whose possible benefit is then assessed.
    pub fn assessed_couplings(&self) -> CouplingCorrection {
        match self.study.settings.couplings {
            CouplingCorrection::None => CouplingCorrection::MixingAndFeedback,
            requested => requested,
        }
    }

    /// Returns the diagnosis with the physics parameters and their benefit, whether or not they are
    /// applied; until it is ready, that under older settings. The inner `None` means that the study
    /// selects no parameters.
    pub fn physics(&self) -> Option<&Option<AssessedPhysics>> {
        let (job, assessed) = self.results.physics.as_ref()?;
        if !self.is_shown_dataset(&job.study.dataset) || job.physics != self.assessed_physics() {
            return None;
        }
        Some(assessed)
    }

    /// Returns the physics parameters that the study applies. If it applies none, returns the named
    /// ones, whose possible benefit is then assessed.
    pub fn assessed_physics(&self) -> PhysicsCorrection {
        match self.study.settings.physics {
            PhysicsCorrection::Off => PhysicsCorrection::Named,
            requested => requested,
        }
    }

    /// Returns the selected parameter's index among those that are on; without a selection, the
    /// index of the first in the ranking.
    pub fn selected_parameter(&self, findings: &PhysicsFindings) -> usize {
        let name = self.display.physics.selected.as_deref();
        findings.selected(name).unwrap_or(0)
    }

    /// Returns the uncertainty of the newest analysis; `None` until its job is complete.
    pub fn uncertainty(&self) -> Option<&Arc<Uncertainty>> {
        let (job, uncertainty) = self.results.uncertainty.as_ref()?;
        let newest = self.results.analysis.as_ref()?;
        if !Arc::ptr_eq(&job.analysis, newest) || !self.is_shown_dataset(&newest.study.dataset) {
            return None;
        }
        Some(uncertainty)
    }

    /// Returns the uncertainty in the displayed condition's values; empty until it is computed, or
    /// if it belongs to older settings.
    pub fn value_uncertainty(&self) -> ValueUncertainty<'_> {
        let uncertainty = if self.others_are_older() {
            None
        } else {
            self.uncertainty()
        };
        ValueUncertainty {
            condition: self.condition().id(),
            uncertainty: uncertainty.map(AsRef::as_ref),
        }
    }

    /// Returns the uncertainty to paint in the displayed condition: until it is computed for the
    /// present settings, that for earlier settings, which is dimmed.
    pub fn painted_uncertainty(&self) -> ValueUncertainty<'_> {
        let current = self.value_uncertainty();
        if current.uncertainty.is_some() {
            return current;
        }
        ValueUncertainty {
            uncertainty: self.older_uncertainty(),
            ..current
        }
    }

    /// Returns the newest uncertainty if a change has made it older than the results; `None`
    /// otherwise.
    pub fn older_uncertainty(&self) -> Option<&Uncertainty> {
        let (job, uncertainty) = self.results.uncertainty.as_ref()?;
        let is_current = self.uncertainty().is_some() && !self.others_are_older();
        if is_current || !self.is_shown_dataset(&job.analysis.study.dataset) {
            return None;
        }
        Some(uncertainty)
    }

    /// Returns the trade-off over α in the displayed condition; until it is ready, that for other
    /// settings.
    pub fn trade_off(&self) -> Option<&TradeOff> {
        let (_, trade_off) = self.results.trade_off.as_ref()?;
        let trade_off = trade_off.as_ref().ok()?;
        if trade_off.condition != self.condition().id() {
            return None;
        }
        Some(trade_off)
    }

    /// Returns the newest analysis with the uncertainty computed so far; used by exported files and
    /// derivations.
    pub fn analysis_with_error_bars(&self) -> Option<Analysis> {
        let analysis = self.analysis()?.clone();
        Some(Analysis {
            uncertainty: self.uncertainty().cloned(),
            ..analysis
        })
    }

    /// Returns whether a result's optimality proof is still running.
    pub fn is_proving(&self, shown: &ConditionAnalysis) -> bool {
        self.results.background.proofs.contains(&shown.gain_problem)
    }

    /// Returns the message shown after a computation was stopped: results are outdated, or there
    /// are none.
    pub fn after_stop(&self) -> Message {
        match self.analysis() {
            Some(_) => Message::new("older-results", "the results are older than the settings"),
            None => Message::new("no-results", "there are no results yet"),
        }
    }

    /// Returns whether a result belongs to the displayed dataset.
    fn is_shown_dataset(&self, dataset: &Arc<Dataset>) -> bool {
        Arc::ptr_eq(dataset, &self.study.dataset)
    }
}

#[cfg(test)]
mod tests {
    use gdcm_io::embedded_example;
    use gdcm_model::progress::Unobserved;
    use gdcm_study::{Engine, Study};

    use super::*;

    #[test]
    fn after_a_stop_the_results_of_this_dataset_stay() {
        let study = Study::new(embedded_example().unwrap().dataset);
        let mut state = State::new(study.clone(), String::new(), Vec::new());
        assert_eq!(state.after_stop().code, "no-results");
        state.results.analysis = Some(Arc::new(
            Engine::default().analyze(&study, &Unobserved).unwrap(),
        ));
        assert_eq!(state.after_stop().code, "older-results");
        let other = Study::new(embedded_example().unwrap().dataset);
        state.study = other;
        assert_eq!(
            state.after_stop().code,
            "no-results",
            "no results of the displayed dataset"
        );
    }
}
