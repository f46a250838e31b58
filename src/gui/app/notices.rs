//! Notices in the status bar: a completed action, or the reason why it failed.

use std::fmt::Display;

use gdcm_model::message_text::{sanitized, shortened_message};

use super::GdcmApp;
use crate::gui::state::notices::{Notice, NoticeKind};

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
}
