//! Undoes and redoes decisions.
//!
//! An undo step stores the whole study before its change. Decisions that *continue* one another,
//! such as positions of a slider being dragged, form a single step. In a *session* (the settings
//! are open in the window) each change of a setting is a step; when the session ends, consecutive
//! steps of the session are merged. Some decisions of the window change state *outside* the study,
//! which the same undo restores.

use std::collections::BTreeSet;
use std::sync::Arc;

use gdcm_model::dataset::Condition;

use super::edit::Edit;
use super::study::Study;

/// Maximum number of undo steps; a snapshot takes a few kilobytes, because models are shared.
const MOST_STEPS: usize = 500;
/// Maximum memory for the models in all undo and redo steps \[bytes\]. Reversed signs, adopted
/// models and reloaded files leave the former models in the earlier steps.
const MOST_BYTES: usize = 48 << 20;
/// Number of datasets that the undo steps may keep in memory whatever their size.
const LEAST_DATASETS: usize = 4;

/// Change that a history step undoes or redoes. `C` describes a change to state outside the study.
#[derive(Clone, Debug, PartialEq)]
pub enum Change<C = ()> {
    Decision(Edit),
    /// Changes to several settings in one session (see [`History::begin_session`]), in order.
    Settings(Vec<Edit>),
    /// A change to state outside the study.
    Outside(C),
    /// The dataset was read again from the file with this name.
    Reload {
        file: String,
    },
}

/// One step that can be undone or redone.
#[derive(Clone, Debug)]
pub struct Step<B = (), C = ()> {
    pub change: Change<C>,
    /// The study before the change in an undo step, after it in a redo step.
    pub study: Study,
    outside: B,
    /// Session in which a setting was changed; see [`History::begin_session`].
    session: Option<u64>,
}

/// Undo history: snapshots of the study, with the changes between them.
///
/// `B` is a snapshot of state outside the study, which some steps change instead of the study
/// ([`History::record_outside`]). Such a step stores the snapshot from before the change; undo and
/// redo exchange it for the present one. All other steps store `B::default()`. `C` describes a
/// change to that state.
#[derive(Clone, Debug)]
pub struct History<B = (), C = ()> {
    undo_steps: Vec<Step<B, C>>,
    redo_steps: Vec<Step<B, C>>,
    /// Redo steps removed by the last decision, which [`History::withdraw`] restores.
    removed_redo_steps: Vec<Step<B, C>>,
    /// The last decision, as long as the next decision may continue it (a slider being dragged).
    continuable: Option<Edit>,
    /// Number of the session in progress.
    session: Option<u64>,
    /// Number of sessions so far.
    sessions: u64,
}

impl<B, C> Default for History<B, C> {
    fn default() -> Self {
        Self {
            undo_steps: Vec::new(),
            redo_steps: Vec::new(),
            removed_redo_steps: Vec::new(),
            continuable: None,
            session: None,
            sessions: 0,
        }
    }
}

impl<C> Change<C> {
    /// Adds a later change to settings. If a setting changes several times, only the last change is
    /// kept.
    fn append(&mut self, later: Self) {
        let mut edits = self.edits();
        for edit in later.edits() {
            edits.retain(|earlier| !edit.continues(earlier));
            edits.push(edit);
        }
        *self = match edits.as_slice() {
            [only] => Self::Decision(only.clone()),
            _ => Self::Settings(edits),
        };
    }

    /// Returns the decisions in the change, in order.
    fn edits(&self) -> Vec<Edit> {
        match self {
            Self::Decision(edit) => vec![edit.clone()],
            Self::Settings(edits) => edits.clone(),
            Self::Outside(_) | Self::Reload { .. } => Vec::new(),
        }
    }
}

/// Removes the last step if it belongs to a session and the study `after` it equals the study
/// before.
fn drop_if_unchanged<B, C>(steps: &mut Vec<Step<B, C>>, session: u64, after: &Study) {
    if let Some(last) = steps.last()
        && last.session == Some(session)
        && last.study == *after
    {
        steps.pop();
    }
}

impl<B: Default, C> History<B, C> {
    /// Stores `before`, the study before the change by `edit`, which may already be applied. Redo
    /// steps are removed.
    ///
    /// A decision that continues the last one (see [`Edit::continues`]) adds no step until
    /// [`History::seal`].
    pub fn record(&mut self, before: Study, edit: &Edit) {
        let removed = std::mem::take(&mut self.redo_steps);
        if let Some(last) = &self.continuable
            && edit.continues(last)
        {
            // `removed` is empty: only undoing and withdrawing add redo steps, and both end the
            // continuation.
            return;
        }
        self.removed_redo_steps = removed;
        let is_setting = matches!(edit, Edit::Set(..));
        self.push(Step {
            change: Change::Decision(edit.clone()),
            study: before,
            outside: B::default(),
            session: if is_setting { self.session } else { None },
        });
        self.continuable = Some(edit.clone());
    }

    /// Stores a decision that leaves the study unchanged; `before` is the former state outside the
    /// study.
    pub fn record_outside(&mut self, study: Study, change: C, before: B) {
        self.removed_redo_steps = std::mem::take(&mut self.redo_steps);
        self.push(Step {
            change: Change::Outside(change),
            study,
            outside: before,
            session: None,
        });
        self.continuable = None;
    }

    /// Stores `before`, the study with the dataset as it was before a reload of `file`.
    pub fn record_reload(&mut self, before: Study, file: String) {
        self.redo_steps.clear();
        self.push(Step {
            change: Change::Reload { file },
            study: before,
            outside: B::default(),
            session: None,
        });
        self.continuable = None;
    }

    /// Adds an undo step, and removes the oldest steps beyond the limits on number and memory.
    fn push(&mut self, step: Step<B, C>) {
        if self.undo_steps.len() == MOST_STEPS {
            self.undo_steps.remove(0);
        }
        let has_other_models = match self.undo_steps.last() {
            Some(last) => !Arc::ptr_eq(&last.study.dataset, &step.study.dataset),
            None => false,
        };
        self.undo_steps.push(step);
        if has_other_models {
            self.limit_models();
        }
    }

    /// Removes the oldest steps until the models in all steps take at most [`MOST_BYTES`], or as
    /// much as [`LEAST_DATASETS`] datasets like the last one if these are larger.
    fn limit_models(&mut self) {
        let mut most_bytes = MOST_BYTES;
        if let Some(last) = self.undo_steps.last() {
            let mut bytes = 0;
            for condition in last.study.dataset.conditions() {
                bytes += condition.model_bytes();
            }
            most_bytes = most_bytes.max(LEAST_DATASETS * bytes);
        }
        while self.undo_steps.len() > 1 && self.model_bytes() > most_bytes {
            let oldest = Arc::clone(&self.undo_steps[0].study.dataset);
            let steps_of_oldest = self
                .undo_steps
                .iter()
                .take_while(|step| Arc::ptr_eq(&step.study.dataset, &oldest))
                .count();
            self.undo_steps
                .drain(..steps_of_oldest.min(self.undo_steps.len() - 1));
        }
    }

    /// Returns the memory for the models in all steps, each condition counted once \[bytes\].
    pub fn model_bytes(&self) -> usize {
        let mut counted: BTreeSet<*const Condition> = BTreeSet::new();
        let mut bytes = 0;
        for step in self
            .undo_steps
            .iter()
            .chain(&self.redo_steps)
            .chain(&self.removed_redo_steps)
        {
            for dataset in step.study.datasets() {
                for condition in dataset.conditions() {
                    if counted.insert(Arc::as_ptr(condition)) {
                        bytes += condition.model_bytes();
                    }
                }
            }
        }
        bytes
    }

    /// Closes the last decision: no later decision continues it.
    pub fn seal(&mut self) {
        self.continuable = None;
    }

    /// Begins a session: until [`History::end_session`], each change to a setting is a separate
    /// step, which can be undone alone.
    pub fn begin_session(&mut self) {
        self.seal();
        self.sessions += 1;
        self.session = Some(self.sessions);
    }

    /// Ends the session. `now` is the present study.
    ///
    /// 1. Consecutive steps of the session are merged into the first of them.
    /// 2. A merged step is dropped if the study after it equals the study before.
    ///
    /// Other decisions keep their own steps.
    pub fn end_session(&mut self, now: &Study) {
        let Some(session) = self.session.take() else {
            return;
        };
        self.seal();
        let mut merged: Vec<Step<B, C>> = Vec::with_capacity(self.undo_steps.len());
        for step in std::mem::take(&mut self.undo_steps) {
            let is_in_session = step.session == Some(session);
            if let Some(last) = merged.last_mut()
                && is_in_session
                && last.session == Some(session)
            {
                last.change.append(step.change);
                continue;
            }
            drop_if_unchanged(&mut merged, session, &step.study);
            merged.push(step);
        }
        drop_if_unchanged(&mut merged, session, now);
        self.undo_steps = merged;
    }

    /// Undoes the last step and returns the study before it; `None` if there is no step. `now` is
    /// the present study, kept for a redo; `exchange` restores the state outside the study from the
    /// step's snapshot, and returns a snapshot of the present state.
    pub fn undo(&mut self, now: &Study, exchange: impl FnOnce(B) -> B) -> Option<Study> {
        let step = self.undo_steps.pop()?;
        self.continuable = None;
        self.redo_steps.push(Step {
            change: step.change,
            study: now.clone(),
            outside: exchange(step.outside),
            session: step.session,
        });
        Some(step.study)
    }

    /// Withdraws the last decision if it was `edit` and is not sealed, and returns the study before
    /// it; otherwise returns `None`. There is no redo step, and the redo steps that the decision
    /// had removed are available again.
    pub fn withdraw(&mut self, edit: &Edit) -> Option<Study> {
        if self.continuable.as_ref() != Some(edit) {
            return None;
        }
        let step = self.undo_steps.pop()?;
        self.continuable = None;
        self.redo_steps = std::mem::take(&mut self.removed_redo_steps);
        Some(step.study)
    }

    /// Redoes the last undone step and returns the study after it; `None` if there is no such step.
    /// `now` is the present study, kept for an undo; `exchange` is as in [`History::undo`].
    pub fn redo(&mut self, now: &Study, exchange: impl FnOnce(B) -> B) -> Option<Study> {
        let step = self.redo_steps.pop()?;
        self.continuable = None;
        self.undo_steps.push(Step {
            change: step.change,
            study: now.clone(),
            outside: exchange(step.outside),
            session: step.session,
        });
        Some(step.study)
    }

    /// Returns the step that [`History::undo`] would undo.
    pub fn undo_step(&self) -> Option<&Step<B, C>> {
        self.undo_steps.last()
    }

    /// Returns the step that [`History::redo`] would redo.
    pub fn redo_step(&self) -> Option<&Step<B, C>> {
        self.redo_steps.last()
    }
}

#[cfg(test)]
mod tests {
    use super::super::setting_table::{ALPHA_DELAY, ALPHA_GAIN};
    use super::*;
    use crate::decisions::signs::{SignRole, with_reversed_signs};
    use crate::reference_tests::reference_dataset;
    use gdcm_method::correction::Channel;
    use gdcm_model::dataset::{BundleKind, ConditionId, ModelId};
    use std::collections::BTreeMap;
    use std::sync::Arc;

    #[test]
    fn the_models_of_undo_steps_take_a_limited_space() {
        let dataset = Arc::new(reference_dataset());
        let mut bytes = 0;
        for condition in dataset.conditions() {
            bytes += condition.model_bytes();
        }
        assert!(bytes > 1 << 20, "the models count: {bytes}");
        let signs = BTreeMap::from([(Channel::Input(0), SignRole::All)]);
        let mut history: History = History::default();
        let steps = 2 * MOST_BYTES / bytes;
        for _ in 0..steps {
            let other = with_reversed_signs(&dataset, &signs).unwrap();
            history.record(Study::new(other), &Edit::ConstrainOnAxis);
            history.seal();
        }
        assert!(history.model_bytes() <= MOST_BYTES.max(LEAST_DATASETS * bytes));
        assert!(history.undo_steps.len() >= LEAST_DATASETS);
        assert!(
            history.undo_steps.len() < steps,
            "{} of {steps}",
            history.undo_steps.len()
        );
        let now = Study::new(dataset);
        assert!(history.undo(&now, |outside| outside).is_some());
    }

    #[test]
    fn steps_with_the_same_models_are_limited_in_number_only() {
        let study = Study::new(Arc::new(reference_dataset()));
        let mut history: History = History::default();
        for _ in 0..MOST_STEPS + 10 {
            history.record(study.clone(), &Edit::ConstrainOnAxis);
            history.seal();
        }
        assert_eq!(history.undo_steps.len(), MOST_STEPS);
    }

    struct Editor {
        study: Study,
        history: History,
    }

    impl Editor {
        fn new() -> Self {
            Self {
                study: Study::new(Arc::new(reference_dataset())),
                history: History::default(),
            }
        }

        fn decide(&mut self, edit: Edit) {
            let before = self.study.clone();
            self.study.apply(&edit).unwrap();
            self.history.record(before, &edit);
        }

        fn undo(&mut self) {
            self.study = self.history.undo(&self.study, |()| ()).unwrap();
        }

        fn changes(&self) -> Vec<Change> {
            let steps = self.history.undo_steps.iter();
            steps.map(|step| step.change.clone()).collect()
        }
    }

    fn nominal() -> ModelId {
        ModelId::new(ConditionId(10), BundleKind::Physics, "nominal")
    }

    #[test]
    fn the_changes_of_a_session_become_one_step() {
        let mut editor = Editor::new();
        let before = editor.study.clone();
        editor.history.begin_session();
        editor.decide(ALPHA_GAIN.to(2.0));
        editor.decide(ALPHA_DELAY.to(3.0));
        editor.decide(ALPHA_GAIN.to(4.0));
        assert_eq!(
            editor.history.undo_steps.len(),
            3,
            "each can be undone alone"
        );
        editor.history.end_session(&editor.study);
        let merged = Change::Settings(vec![ALPHA_DELAY.to(3.0), ALPHA_GAIN.to(4.0)]);
        assert_eq!(editor.changes(), [merged]);
        let after = editor.study.clone();
        editor.undo();
        assert_eq!(editor.study, before);
        editor.study = editor.history.redo(&editor.study, |()| ()).unwrap();
        assert_eq!(editor.study, after);
    }

    #[test]
    fn a_session_that_changes_nothing_leaves_no_step() {
        let mut editor = Editor::new();
        editor.history.begin_session();
        editor.decide(ALPHA_GAIN.to(2.0));
        editor.history.seal();
        editor.decide(ALPHA_GAIN.to(1.0));
        editor.history.end_session(&editor.study);
        assert_eq!(editor.changes(), []);
    }

    #[test]
    fn other_decisions_within_a_session_keep_their_steps() {
        let mut editor = Editor::new();
        editor.history.begin_session();
        editor.decide(ALPHA_GAIN.to(2.0));
        editor.decide(Edit::Reject(nominal()));
        editor.decide(ALPHA_GAIN.to(3.0));
        editor.history.end_session(&editor.study);
        editor.decide(ALPHA_GAIN.to(5.0));
        assert_eq!(
            editor.changes(),
            [
                Change::Decision(ALPHA_GAIN.to(2.0)),
                Change::Decision(Edit::Reject(nominal())),
                Change::Decision(ALPHA_GAIN.to(3.0)),
                Change::Decision(ALPHA_GAIN.to(5.0)),
            ]
        );
    }
}
