//! Messages to the engineer: notices in the status bar about a completed or failed action, and the
//! bar about a fault in the program.

use std::fmt::Display;

use gdcm_model::message_text::{sanitized, shortened_message};

use super::GdcmApp;
use super::faults::Fault;
use crate::gui::state::notices::{MessageBar, Notice, NoticeKind};

impl GdcmApp {
    /// Shows a notice about a completed action.
    pub(super) fn notify_done(&mut self, text: String) {
        self.state.notice = Some(Notice {
            kind: NoticeKind::Done,
            text: shortened_message(&sanitized(&text)),
        });
    }

    /// Shows a notice about a failed action.
    pub(super) fn notify_error(&mut self, text: String) {
        self.state.notice = Some(Notice {
            kind: NoticeKind::Trouble,
            text: shortened_message(&sanitized(&text)),
        });
    }

    /// Returns the value; shows an error as a notice and returns `None`.
    pub(super) fn value_or_notify<T, E: Display>(&mut self, made: Result<T, E>) -> Option<T> {
        match made {
            Ok(value) => Some(value),
            Err(error) => {
                self.notify_error(error.to_string());
                None
            }
        }
    }

    /// Reports a panic: the interrupted work, that the decisions are kept, and the details to be
    /// sent to the authors.
    pub(super) fn report_fault(&mut self, work: &str, fault: &Fault) {
        let sentence = format!(
            "A fault in the program ended {work}; your decisions are kept and can be saved: please send this message, the \
             saved study and the dataset {} to the program's authors (gdcm {}: {}).",
            self.files.loaded.origin,
            env!("CARGO_PKG_VERSION"),
            fault.words(),
        );
        self.state
            .message_bars
            .retain(|bar| !matches!(bar, MessageBar::Fault { .. }));
        self.state.message_bars.push(MessageBar::Fault { sentence });
    }
}
