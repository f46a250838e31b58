//! Marks in the conditions list: open tasks, role in the schedule.
//!
//! Open tasks are suggested outliers (physics models that the analysis proposes to reject; M5:
//! docs/method.md) and held (constrained) responses whose gain or delay is not matched. A condition
//! left out of the schedule does not enter its fit; a held-out condition validates the schedule
//! instead.

use egui::{Rect, RichText, Stroke, Ui};

use gdcm_model::dataset::{Condition, ConditionId};
use gdcm_model::number_format::counted;
use gdcm_study::Edit;
use gdcm_words::caution::failure_text;

use crate::gui::commands::command::Command;
use crate::gui::state::window_state::State;
use crate::gui::widgets::controls::entries_ui;
use crate::gui::widgets::painted_text::painted_text;
use crate::gui::widgets::palette::{BODY_SIZE, Palette, medium, small};

/// Open tasks in a condition, and its role in the schedule.
pub(super) struct Marks {
    pub(super) condition: ConditionId,
    /// Number of models suggested as outliers and not rejected.
    suggested: usize,
    /// Number of constrained gains that are not matched.
    unmatched_gains: usize,
    /// Number of constrained delays that are not matched although a decision could match them.
    /// Delays that need lead do not count while leads are not requested.
    unmatched_delays: usize,
    /// Whether the unmatched delays include those that need lead.
    counts_leads: bool,
    pub(super) left_out: bool,
    held_out: bool,
    /// Reason for a missing result.
    failure: Option<String>,
}

impl Marks {
    pub(super) fn new(state: &State, condition: ConditionId) -> Self {
        let choice = state.study.choice(condition);
        let mut marks = Self {
            condition,
            suggested: 0,
            unmatched_gains: 0,
            unmatched_delays: 0,
            counts_leads: false,
            left_out: !choice.scheduled,
            held_out: choice.held_out,
            failure: None,
        };
        match state
            .analysis()
            .and_then(|analysis| analysis.conditions.get(&condition))
        {
            None => {}
            Some(Err(failure)) => marks.failure = Some(failure_text(failure, state.dataset())),
            Some(Ok(result)) => {
                marks.suggested = state.open_suggestions(result).len();
                marks.unmatched_gains = result.gains.unmatched.len();
                let has_leads = result.has_leads();
                marks.counts_leads = has_leads;
                for missed in &result.delays.unmatched {
                    // A negative D needs phase lead.
                    let needs_lead = missed.delta < 0.0;
                    if has_leads || !needs_lead {
                        marks.unmatched_delays += 1;
                    }
                }
            }
        }
        marks
    }

    /// Returns the suffix that follows the flight state in the row's accessible name.
    pub(super) fn after_name(&self) -> &'static str {
        if self.held_out {
            ", held out"
        } else if self.left_out {
            ", left out of the schedule"
        } else {
            ""
        }
    }

    /// Paints ⚠ for open tasks or a missing result, a stroke through a condition left out of the
    /// schedule, and an accent bar beside a held-out condition.
    pub(super) fn paint(&self, ui: &Ui, row: Rect, palette: &Palette) {
        if self.failure.is_some()
            || self.suggested + self.unmatched_gains + self.unmatched_delays > 0
        {
            painted_text(ui, row, -4.0, "⚠", small(), palette.warning);
        }
        if self.held_out {
            ui.painter().vline(
                row.left() + 1.0,
                row.shrink(3.0).y_range(),
                Stroke::new(2.0, palette.accent),
            );
        } else if self.left_out {
            ui.painter().hline(
                row.left() + 4.0..=row.left() + 22.0,
                row.center().y,
                Stroke::new(1.0, palette.quiet_text),
            );
        }
    }

    /// Draws the condition's context menu.
    pub(super) fn menu_ui(&self, ui: &mut Ui, commands: &mut Vec<Command>) {
        let condition = self.condition;
        let hold_out = if self.held_out {
            "Stop holding out"
        } else {
            "Hold out to validate the schedule"
        };
        let schedule = if self.left_out {
            "Include in the schedule"
        } else {
            "Leave out of the schedule"
        };
        let entries = [
            (
                hold_out,
                Edit::SetHeldOut {
                    condition,
                    held_out: !self.held_out,
                },
            ),
            (
                schedule,
                Edit::SetScheduled {
                    condition,
                    scheduled: self.left_out,
                },
            ),
        ];
        entries_ui(
            ui,
            entries.map(|(text, edit)| (format!("{text}: condition {condition}"), edit.into())),
            commands,
        );
    }

    /// Draws the flight state and at most three sentences: open tasks, role in the schedule, reason
    /// for a missing result.
    pub(super) fn tooltip_ui(&self, ui: &mut Ui, condition: &Condition, palette: &Palette) {
        let state = condition.flight_state();
        ui.label(
            RichText::new(&state.name)
                .font(medium(BODY_SIZE))
                .color(palette.text),
        );
        let mut values = vec![format!("{} kt true airspeed", state.airspeed_kt)];
        values.extend(state.altitude_ft.map(|feet| format!("{feet} ft")));
        values.extend(state.mass_kg.map(|mass| format!("{mass} kg")));
        ui.label(values.join(" · "));
        let tasks = self.open_tasks();
        if !tasks.is_empty() {
            ui.label(tasks.join("; "));
        }
        if self.held_out {
            ui.label(
                "Held out: analysed, but used only to validate the schedule; right-click to \
                stop holding out",
            );
        } else if self.left_out {
            ui.label("Left out of the schedule; right-click to include");
        }
        if let Some(failure) = &self.failure {
            ui.label(failure);
        }
    }

    /// Describes open tasks, such as "3 models suggested as outliers, not rejected".
    fn open_tasks(&self) -> Vec<String> {
        let mut tasks = Vec::new();
        match self.suggested {
            0 => {}
            1 => tasks.push("1 model suggested as an outlier, not rejected".to_owned()),
            count => tasks.push(format!(
                "{count} models suggested as outliers, not rejected"
            )),
        }
        if self.unmatched_gains > 0 {
            let gains = counted(self.unmatched_gains, "held gain");
            tasks.push(format!("{gains} not matched"));
        }
        if self.unmatched_delays > 0 {
            let delays = counted(self.unmatched_delays, "held delay");
            tasks.push(if self.counts_leads {
                format!("{delays} not matched")
            } else {
                format!("{delays} not matched (not counting those that need lead)")
            });
        }
        tasks
    }
}
