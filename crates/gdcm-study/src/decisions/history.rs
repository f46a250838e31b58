//! Undo and redo of decisions.

use super::edit::Edit;
use super::study::Study;

/// Maximum number of undo steps; a snapshot takes a few kilobytes, because models are shared.
const MOST_STEPS: usize = 500;

/// One decision that can be undone or redone.
#[derive(Clone, Debug)]
struct Step<B> {
    label: String,
    study: Study,
    beside: B,
}

/// Undo history: snapshots of the study, with the labels of the decisions between them.
///
/// `B` is state outside the study that a step changes as well. A step stores its value before the
/// decision; undo and redo exchange the stored value and the present value. Decisions that only
/// change the study use `B::default()`.
#[derive(Clone, Debug)]
pub struct History<B = ()> {
    past: Vec<Step<B>>,
    future: Vec<Step<B>>,
    /// Redo steps removed by the last decision.
    lost: Vec<Step<B>>,
    /// The last decision, as long as the next decision may continue it (a slider being dragged).
    open: Option<Edit>,
}

impl<B> Default for History<B> {
    fn default() -> Self {
        Self {
            past: Vec::new(),
            future: Vec::new(),
            lost: Vec::new(),
            open: None,
        }
    }
}

impl<B: Default> History<B> {
    /// Stores `before`, the study before the change by `edit`, which may already be applied.
    ///
    /// A decision that continues the last one (see [`Edit::continues`]) adds no step until
    /// [`History::seal`].
    pub fn record(&mut self, before: Study, edit: &Edit) {
        let lost = std::mem::take(&mut self.future);
        if self.open.as_ref().is_some_and(|open| edit.continues(open)) {
            return;
        }
        self.lost = lost;
        self.push(Step {
            label: edit.label(&before),
            study: before,
            beside: B::default(),
        });
        self.open = Some(edit.clone());
    }

    /// Stores a decision that leaves the study unchanged; `before` is the former value of the state
    /// outside the study.
    pub fn record_beside(&mut self, study: Study, label: String, before: B) {
        self.lost = std::mem::take(&mut self.future);
        self.push(Step {
            label,
            study,
            beside: before,
        });
        self.open = None;
    }

    /// Stores `before`, the study with the dataset as it was before a reload.
    pub fn record_reload(&mut self, before: Study, label: String) {
        self.future.clear();
        self.push(Step {
            label,
            study: before,
            beside: B::default(),
        });
        self.open = None;
    }

    fn push(&mut self, step: Step<B>) {
        if self.past.len() == MOST_STEPS {
            self.past.remove(0);
        }
        self.past.push(step);
    }

    /// Closes the last decision: no later decision continues it.
    pub fn seal(&mut self) {
        self.open = None;
    }

    /// Returns the study before the last decision. `now` is the present study; `exchange` restores
    /// the state outside the study, and returns the value that it had.
    pub fn undo(&mut self, now: &Study, exchange: impl FnOnce(B) -> B) -> Option<Study> {
        let step = self.past.pop()?;
        self.open = None;
        self.future.push(Step {
            label: step.label,
            study: now.clone(),
            beside: exchange(step.beside),
        });
        Some(step.study)
    }

    /// Returns the study before the last decision if that was `edit`. The decision is removed
    /// without a redo step, and the redo steps that it had removed are available again.
    pub fn forget(&mut self, edit: &Edit) -> Option<Study> {
        if self.open.as_ref() != Some(edit) {
            return None;
        }
        let step = self.past.pop()?;
        self.open = None;
        self.future = std::mem::take(&mut self.lost);
        Some(step.study)
    }

    /// Returns the study after the last undone decision. `now` is the present study; `exchange` is
    /// as in [`History::undo`].
    pub fn redo(&mut self, now: &Study, exchange: impl FnOnce(B) -> B) -> Option<Study> {
        let step = self.future.pop()?;
        self.open = None;
        self.past.push(Step {
            label: step.label,
            study: now.clone(),
            beside: exchange(step.beside),
        });
        Some(step.study)
    }

    /// Returns the label of the decision that [`History::undo`] would undo.
    pub fn undo_label(&self) -> Option<&str> {
        self.past.last().map(|step| step.label.as_str())
    }

    /// Returns the label of the decision that [`History::redo`] would redo.
    pub fn redo_label(&self) -> Option<&str> {
        self.future.last().map(|step| step.label.as_str())
    }
}
