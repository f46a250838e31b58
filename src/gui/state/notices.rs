//! Messages to the engineer in the top bar.
//!
//! A *notice* reports a completed or a failed action. The session's list keeps it; the top bar
//! shows it as a *toast* until its time is over, or until it is dismissed or resolved. A *message
//! bar* is about the program or its files, and remains in the top bar until it is answered. Both
//! are *messages*, numbered together, so that the top bar can show the newest first.

use std::path::PathBuf;

use gdcm_study::decisions::dataset_differences::Difference;

/// Message about the program or its files, shown in the top bar until it is answered.
#[derive(Clone, Debug, PartialEq)]
pub enum MessageBar {
    /// A computation panicked.
    Fault(FaultReport),
    /// Decisions from an earlier window that ended without saving them.
    Recovery(RecoveryOffer),
    /// The dataset's file has changed since it was opened.
    Changed { name: String },
    /// The dataset was read again and has changed.
    Differences {
        name: String,
        /// Differences from the earlier dataset, and decisions that no longer apply.
        differences: Vec<Difference>,
    },
}

/// Report about a panic, with the details to send to the program's authors.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct FaultReport {
    /// The interrupted work, such as "the computation".
    pub work: String,
    /// Origin of the dataset, such as a file.
    pub dataset: String,
    /// Program version.
    pub version: String,
    /// The panic's message and place in the source.
    pub fault: String,
}

/// Offer to restore decisions that were not saved.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct RecoveryOffer {
    /// Index in the window's list of offers (`Recovery::offers`).
    pub number: usize,
    /// Origin of the dataset, such as a file.
    pub dataset: String,
    /// File name under which the study was saved before, if it was.
    pub study: Option<String>,
    /// When the last decision was made, as displayed.
    pub kept_at: String,
}

impl MessageBar {
    /// Returns the stable code, for tests.
    pub fn code(&self) -> &'static str {
        match self {
            Self::Fault(_) => "fault",
            Self::Recovery(_) => "decisions-not-saved",
            Self::Changed { .. } => "dataset-changed-on-disk",
            Self::Differences { .. } => "dataset-reloaded",
        }
    }
}

/// Outcome that a notice reports.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum NoticeKind {
    Done,
    Trouble,
}

/// Remedy that a notice offers, with a button.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum NoticeAction {
    /// Opens a folder in the desktop.
    ShowFolder(PathBuf),
    /// Undoes the last step.
    Undo,
    /// Asks for another path for the study.
    SaveElsewhere,
    /// Asks for another file to open.
    OpenAnother,
    /// Starts the stopped computation again.
    Compute,
}

/// Activity that a notice reports. A success resolves the same activity's failures.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Activity {
    /// A decision about the study.
    Decision,
    Opening,
    Saving,
    Report,
    Export,
    Other,
}

/// Short message about a completed or failed action.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Notice {
    pub kind: NoticeKind,
    /// Stable code, for tests.
    pub code: &'static str,
    pub text: String,
    pub activity: Activity,
    pub action: Option<NoticeAction>,
    /// Time of day: "14:32".
    pub at: String,
    /// Number among the messages of the session, from 0.
    pub number: u64,
}

/// Time \[s\] for which a success is shown.
pub const SHOWN_FOR_S: f64 = 6.0;
/// Maximum number of notices kept in a session.
const MOST_NOTICES: usize = 500;
/// Maximum number of toasts; older notices are in the session's list only.
const MOST_TOASTS: usize = 20;

/// Notice in the top bar.
#[derive(Clone, Debug, PartialEq)]
pub struct Toast {
    pub notice: Notice,
    /// Time \[s\] for which the toast is still shown; with `None`, it is shown until it is
    /// dismissed or resolved.
    pub remaining_s: Option<f64>,
}

/// Message bar with its number among the messages of the session.
#[derive(Clone, Debug, PartialEq)]
struct NumberedBar {
    number: u64,
    bar: MessageBar,
}

/// Message that the top bar shows or lists.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum TopMessage<'a> {
    Toast(&'a Toast),
    Bar(&'a MessageBar),
}

/// Notices of the session, and the toasts and message bars in the top bar.
#[derive(Debug, Default)]
pub struct Notices {
    /// The session's list, oldest first.
    kept: Vec<Notice>,
    /// Toasts in the top bar, oldest first.
    toasts: Vec<Toast>,
    /// Message bars that are not answered yet, oldest first.
    bars: Vec<NumberedBar>,
    /// Whether the list of toasts and bars below the newest message is open.
    pub is_list_open: bool,
    /// Whether the pointer is on the newest message or on the list, which pauses the toasts'
    /// timers.
    pub is_held: bool,
    /// When [`Self::pass_time`] was last called \[s, window clock\].
    timed_at_s: f64,
    next_number: u64,
}

impl Notices {
    /// Adds a notice, and shows it. If it is a success, it resolves the same activity's failures.
    pub fn add(&mut self, mut notice: Notice) {
        notice.number = self.next_number;
        self.next_number += 1;
        let remaining_s = match notice.kind {
            NoticeKind::Done => {
                self.resolve(notice.activity);
                Some(SHOWN_FOR_S)
            }
            NoticeKind::Trouble => None,
        };
        self.kept.push(notice.clone());
        if self.kept.len() > MOST_NOTICES {
            self.kept.remove(0);
        }
        self.toasts.push(Toast {
            notice,
            remaining_s,
        });
        if self.toasts.len() > MOST_TOASTS {
            self.toasts.remove(0);
        }
    }

    /// Removes an activity's failures from the top bar; those under [`Activity::Other`] remain
    /// until they are dismissed.
    pub fn resolve(&mut self, activity: Activity) {
        if activity == Activity::Other {
            return;
        }
        self.toasts.retain(|toast| {
            toast.notice.kind == NoticeKind::Done || toast.notice.activity != activity
        });
    }

    /// Removes what a new decision makes obsolete: refused decisions, and offers to undo an earlier
    /// one.
    pub fn drop_obsolete_toasts(&mut self) {
        self.resolve(Activity::Decision);
        self.toasts
            .retain(|toast| toast.notice.action != Some(NoticeAction::Undo));
    }

    /// Removes a toast from the top bar; its notice remains in the session's list.
    pub fn dismiss(&mut self, number: u64) {
        self.toasts.retain(|toast| toast.notice.number != number);
        self.close_empty_list();
    }

    /// Shows a message bar.
    pub fn add_bar(&mut self, bar: MessageBar) {
        let number = self.next_number;
        self.next_number += 1;
        self.bars.push(NumberedBar { number, bar });
    }

    /// Removes the message bars for which `is_closed` is true.
    pub fn close_bars(&mut self, is_closed: impl Fn(&MessageBar) -> bool) {
        self.bars.retain(|shown| !is_closed(&shown.bar));
        self.close_empty_list();
    }

    /// Closes the list if there is no message bar and at most one toast, which needs no list.
    fn close_empty_list(&mut self) {
        if self.bars.is_empty() && self.toasts.len() < 2 {
            self.is_list_open = false;
        }
    }

    /// Removes all toasts from the top bar; message bars remain until they are answered.
    pub fn dismiss_all(&mut self) {
        self.toasts.clear();
        self.is_list_open = false;
    }

    /// Advances the toasts' timers to `now_s` \[s, window clock\] unless the pointer is on a
    /// message or the list is open; removes toasts whose time is over. Returns the time \[s\] until
    /// the next one disappears; `None` if none has a timer.
    pub fn pass_time(&mut self, now_s: f64) -> Option<f64> {
        let passed_s = (now_s - self.timed_at_s).max(0.0);
        self.timed_at_s = now_s;
        let is_held = std::mem::take(&mut self.is_held) || self.is_list_open;
        let mut next_s: Option<f64> = None;
        for toast in &mut self.toasts {
            let Some(remaining_s) = &mut toast.remaining_s else {
                continue;
            };
            if !is_held {
                *remaining_s -= passed_s;
            }
            next_s = Some(next_s.map_or(*remaining_s, |next_s| next_s.min(*remaining_s)));
        }
        self.toasts.retain(|toast| {
            toast
                .remaining_s
                .is_none_or(|remaining_s| remaining_s > 0.0)
        });
        self.close_empty_list();
        next_s
    }

    /// Returns the toasts, newest first.
    pub fn toasts(&self) -> impl Iterator<Item = &Toast> {
        self.toasts.iter().rev()
    }

    /// Returns the message bars, oldest first.
    pub fn bars(&self) -> impl Iterator<Item = &MessageBar> {
        self.bars.iter().map(|shown| &shown.bar)
    }

    /// Returns the toasts and the message bars, newest first.
    pub fn shown(&self) -> Vec<TopMessage<'_>> {
        let mut numbered = Vec::new();
        for toast in &self.toasts {
            numbered.push((toast.notice.number, TopMessage::Toast(toast)));
        }
        for shown in &self.bars {
            numbered.push((shown.number, TopMessage::Bar(&shown.bar)));
        }
        numbered.sort_by_key(|(number, _)| std::cmp::Reverse(*number));
        numbered.into_iter().map(|(_, message)| message).collect()
    }

    /// Returns the newest notice, whether or not it is still shown.
    pub fn newest(&self) -> Option<&Notice> {
        self.kept.last()
    }

    /// Returns the session's notices, oldest first.
    pub fn kept(&self) -> &[Notice] {
        &self.kept
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn notice(kind: NoticeKind, activity: Activity, code: &'static str) -> Notice {
        Notice {
            kind,
            code,
            text: code.to_owned(),
            activity,
            action: None,
            at: String::new(),
            number: 0,
        }
    }

    fn shown(notices: &Notices) -> Vec<&'static str> {
        notices.toasts().map(|toast| toast.notice.code).collect()
    }

    #[test]
    fn a_success_disappears_after_its_time_unless_it_is_held_and_a_failure_stays() {
        let mut notices = Notices::default();
        notices.pass_time(100.0);
        notices.add(notice(NoticeKind::Trouble, Activity::Other, "failed"));
        notices.add(notice(NoticeKind::Done, Activity::Other, "done"));
        notices.pass_time(100.0 + 0.9 * SHOWN_FOR_S);
        assert_eq!(shown(&notices), ["done", "failed"]);
        notices.is_held = true;
        notices.pass_time(100.0 + 5.0 * SHOWN_FOR_S);
        assert_eq!(shown(&notices), ["done", "failed"], "held by the pointer");
        notices.pass_time(100.0 + 5.2 * SHOWN_FOR_S);
        assert_eq!(shown(&notices), ["failed"]);
        notices.pass_time(1e6);
        assert_eq!(shown(&notices), ["failed"]);
        let codes: Vec<&str> = notices.kept().iter().map(|message| message.code).collect();
        assert_eq!(codes, ["failed", "done"], "the session keeps both");
    }

    #[test]
    fn a_success_resolves_the_failures_of_its_activity() {
        let mut notices = Notices::default();
        notices.add(notice(NoticeKind::Trouble, Activity::Saving, "not-saved"));
        notices.add(notice(NoticeKind::Trouble, Activity::Opening, "not-opened"));
        notices.add(notice(NoticeKind::Done, Activity::Saving, "saved"));
        assert_eq!(shown(&notices), ["saved", "not-opened"]);
    }

    #[test]
    fn a_decision_removes_refusals_and_offers_to_undo() {
        let mut notices = Notices::default();
        notices.add(notice(NoticeKind::Trouble, Activity::Decision, "refused"));
        let adopted = Notice {
            action: Some(NoticeAction::Undo),
            ..notice(NoticeKind::Done, Activity::Other, "adopted")
        };
        notices.add(adopted);
        notices.drop_obsolete_toasts();
        assert_eq!(shown(&notices), [""; 0]);
        assert_eq!(notices.kept().len(), 2);
    }

    #[test]
    fn a_bar_stays_until_it_is_answered_and_is_listed_in_order_with_the_toasts() {
        let changed = MessageBar::Changed {
            name: "data.json".to_owned(),
        };
        let mut notices = Notices::default();
        notices.pass_time(0.0);
        notices.add(notice(NoticeKind::Trouble, Activity::Saving, "not-saved"));
        notices.add_bar(changed.clone());
        notices.add(notice(NoticeKind::Done, Activity::Other, "done"));
        let codes = |notices: &Notices| -> Vec<&'static str> {
            let shown = notices.shown();
            let mut codes = Vec::new();
            for message in shown {
                codes.push(match message {
                    TopMessage::Toast(toast) => toast.notice.code,
                    TopMessage::Bar(bar) => bar.code(),
                });
            }
            codes
        };
        let all = ["done", "dataset-changed-on-disk", "not-saved"];
        assert_eq!(codes(&notices), all);
        notices.is_list_open = true;
        notices.dismiss_all();
        assert_eq!(codes(&notices), ["dataset-changed-on-disk"]);
        notices.is_list_open = true;
        notices.close_bars(|bar| *bar == changed);
        assert_eq!(codes(&notices), [""; 0]);
        assert!(!notices.is_list_open, "nothing is left to list");
    }

    #[test]
    fn the_messages_of_a_long_session_are_bounded() {
        let mut notices = Notices::default();
        for _ in 0..2 * MOST_NOTICES {
            notices.add(notice(NoticeKind::Trouble, Activity::Other, "again"));
        }
        assert_eq!(notices.kept().len(), MOST_NOTICES);
        assert_eq!(notices.toasts().count(), MOST_TOASTS);
    }
}
