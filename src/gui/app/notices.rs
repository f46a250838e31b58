//! Messages to the engineer: notices in the status bar about a completed or failed action, and the
//! bar about a fault in the program.

use gdcm_model::message_text::{sanitized, shortened_message};

use super::GdcmApp;
use super::faults::Fault;
use crate::gui::state::notices::{FaultReport, MessageBar, Notice, NoticeKind};
use crate::message::Message;

impl GdcmApp {
    /// Shows a notice about a completed action.
    pub(super) fn notify_done(&mut self, message: Message) {
        self.notify(NoticeKind::Done, message);
    }

    /// Shows a notice about a failed action.
    pub(super) fn notify_error(&mut self, message: impl Into<Message>) {
        self.notify(NoticeKind::Trouble, message.into());
    }

    fn notify(&mut self, kind: NoticeKind, message: Message) {
        self.state.notice = Some(Notice {
            kind,
            code: message.code,
            text: shortened_message(&sanitized(&message.text)),
        });
    }

    /// Returns the value; shows an error as a notice and returns `None`.
    pub(super) fn value_or_notify<T, E: Into<Message>>(&mut self, made: Result<T, E>) -> Option<T> {
        match made {
            Ok(value) => Some(value),
            Err(error) => {
                self.notify_error(error);
                None
            }
        }
    }

    /// Reports a panic: the interrupted work, that the decisions are kept, and the details to be
    /// sent to the authors.
    pub(super) fn report_fault(&mut self, work: &str, fault: &Fault) {
        let report = FaultReport {
            work: work.to_owned(),
            dataset: self.files.loaded.origin.to_string(),
            version: env!("CARGO_PKG_VERSION"),
            fault: fault.words(),
        };
        self.state
            .message_bars
            .retain(|bar| !matches!(bar, MessageBar::Fault(_)));
        self.state.message_bars.push(MessageBar::Fault(report));
    }
}
