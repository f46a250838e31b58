//! Undo and redo: the studies before and after each decision.

use super::document::Study;
use super::edit::Edit;

/// Steps kept; a snapshot is a few kilobytes, for the models are shared.
const MOST_STEPS: usize = 500;

#[derive(Clone, Debug)]
struct Step {
    label: String,
    study: Study,
}

/// What undo and redo go back over: whole studies, each with the label of the decision between it and the next.
#[derive(Clone, Debug, Default)]
pub struct History {
    past: Vec<Step>,
    future: Vec<Step>,
    /// What the last decision took from the future.
    lost: Vec<Step>,
    /// The last decision, while the next may still be a part of it (a slider being dragged).
    open: Option<Edit>,
}

impl History {
    /// Keeps `before`, the study that `edit` is about to change (or has just changed).
    ///
    /// A decision that continues the last one (see [`Edit::continues`]) adds no step until [`History::seal`].
    pub fn record(&mut self, before: Study, edit: &Edit) {
        let lost = std::mem::take(&mut self.future);
        if self.open.as_ref().is_some_and(|open| edit.continues(open)) {
            return;
        }
        self.lost = lost;
        self.push(Step { label: edit.label(&before), study: before });
        self.open = Some(edit.clone());
    }

    /// Keeps `before`, the study of the dataset as it was before it was read again.
    pub fn record_reload(&mut self, before: Study, label: String) {
        self.future.clear();
        self.push(Step { label, study: before });
        self.open = None;
    }

    fn push(&mut self, step: Step) {
        if self.past.len() == MOST_STEPS {
            self.past.remove(0);
        }
        self.past.push(step);
    }

    /// Ends the decision being taken: the slider was let go.
    pub fn seal(&mut self) {
        self.open = None;
    }

    /// The study before the last decision, given the study as it is now.
    pub fn undo(&mut self, now: &Study) -> Option<Study> {
        let step = self.past.pop()?;
        self.open = None;
        self.future.push(Step { label: step.label, study: now.clone() });
        Some(step.study)
    }

    /// The study before the last decision, as if that had never been taken, where it was `edit`: it cannot be brought back,
    /// and those that it took from the future can again.
    pub fn forget(&mut self, edit: &Edit) -> Option<Study> {
        if self.open.as_ref() != Some(edit) {
            return None;
        }
        let step = self.past.pop()?;
        self.open = None;
        self.future = std::mem::take(&mut self.lost);
        Some(step.study)
    }

    /// The study after the last decision taken back, given the study as it is now.
    pub fn redo(&mut self, now: &Study) -> Option<Study> {
        let step = self.future.pop()?;
        self.open = None;
        self.past.push(Step { label: step.label, study: now.clone() });
        Some(step.study)
    }

    /// What [`History::undo`] would take back, in a few words.
    pub fn undo_label(&self) -> Option<&str> {
        self.past.last().map(|step| step.label.as_str())
    }

    /// What [`History::redo`] would bring back, in a few words.
    pub fn redo_label(&self) -> Option<&str> {
        self.future.last().map(|step| step.label.as_str())
    }
}
