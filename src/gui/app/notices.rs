//! Messages to the engineer: toasts in the top bar about a completed or failed action, and the bar
//! about a fault in the program.

use std::io;
use std::path::{Path, PathBuf};
use std::process::Command as Process;
use std::time::Duration;

use jiff::Zoned;

use gdcm_model::message_text::{sanitized, shortened_message};

use super::GdcmApp;
use super::faults::Fault;
use crate::gui::state::notices::{
    Activity, FaultReport, MessageBar, Notice, NoticeAction, NoticeKind,
};
use crate::message::Message;

/// Minimum pause before the repaint in which a toast disappears \[s\]; a shorter one would draw a
/// frame without a visible difference.
const LEAST_PAUSE_S: f64 = 0.02;

impl GdcmApp {
    /// Shows a toast about a completed action.
    pub(super) fn notify_done(&mut self, message: Message) {
        self.notify(NoticeKind::Done, Activity::Other, message, None);
    }

    /// Shows a toast about a completed activity, with an optional next action; resolves its earlier
    /// failures.
    pub(super) fn notify_done_with(
        &mut self,
        activity: Activity,
        message: Message,
        action: Option<NoticeAction>,
    ) {
        self.notify(NoticeKind::Done, activity, message, action);
    }

    /// Shows a toast about written files, with a button that opens the folder of `path`.
    pub(super) fn notify_written_to(&mut self, activity: Activity, message: Message, path: &Path) {
        let folder = path.parent().map(Path::to_owned);
        self.notify_done_with(activity, message, folder.map(NoticeAction::ShowFolder));
    }

    /// Shows a toast about a failed action.
    pub(super) fn notify_error(&mut self, message: impl Into<Message>) {
        self.notify_error_of(Activity::Other, message, None);
    }

    /// Shows a toast about a failed activity, with its remedy; after a stopped computation, this is
    /// always *Compute*.
    pub(super) fn notify_error_of(
        &mut self,
        activity: Activity,
        message: impl Into<Message>,
        remedy: Option<NoticeAction>,
    ) {
        let message = message.into();
        let remedy = match message.code {
            "computation-stopped" => Some(NoticeAction::Compute),
            _ => remedy,
        };
        self.notify(NoticeKind::Trouble, activity, message, remedy);
    }

    fn notify(
        &mut self,
        kind: NoticeKind,
        activity: Activity,
        message: Message,
        action: Option<NoticeAction>,
    ) {
        self.state.notices.add(Notice {
            kind,
            code: message.code,
            text: shortened_message(&sanitized(&message.text)),
            activity,
            action,
            at: Zoned::now().strftime("%H:%M").to_string(),
            // `Notices::add` gives the notice its number.
            number: 0,
        });
        self.ctx.request_repaint();
    }

    /// Removes the toasts whose time is over, and has the window drawn again when the next one
    /// disappears.
    pub(super) fn pass_time_of_toasts(&mut self) {
        let now_s = self.now();
        if let Some(next_s) = self.state.notices.pass_time(now_s) {
            self.ctx
                .request_repaint_after(Duration::from_secs_f64(next_s.max(LEAST_PAUSE_S)));
        }
    }

    /// Opens a folder in the desktop's file manager, in a thread.
    pub(super) fn show_folder(&self, folder: PathBuf) {
        let show = move || show_in_desktop(&folder);
        self.in_thread("the file manager", show, |app, shown| {
            if let Some(Err(error)) = shown {
                let text = format!("the file manager could not start: {error}");
                app.notify_error(Message::new("no-file-manager", text));
            }
        });
    }

    /// Returns the value; shows an error as a toast and returns `None`.
    pub(super) fn value_or_notify<T, E: Into<Message>>(&mut self, made: Result<T, E>) -> Option<T> {
        match made {
            Ok(value) => Some(value),
            Err(error) => {
                self.notify_error(error);
                None
            }
        }
    }

    /// Reports a panic in a bar, which replaces an earlier one: the interrupted work, that the
    /// decisions are kept, and the details to be sent to the authors.
    pub(super) fn report_fault(&mut self, work: &str, fault: &Fault) {
        let report = FaultReport {
            work: work.to_owned(),
            dataset: self.files.loaded.origin.to_string(),
            version: gdcm_io::software::version(),
            fault: fault.words(),
        };
        let notices = &mut self.state.notices;
        notices.close_bars(|bar| matches!(bar, MessageBar::Fault(_)));
        notices.add_bar(MessageBar::Fault(report));
    }
}

/// Opens a folder with the program that the desktop uses for folders.
fn show_in_desktop(folder: &Path) -> io::Result<()> {
    let program = if cfg!(target_os = "windows") {
        "explorer"
    } else if cfg!(target_os = "macos") {
        "open"
    } else {
        "xdg-open"
    };
    let status = Process::new(program).arg(folder).status()?;
    // The Windows file manager reports a failure even if it has shown the folder.
    if status.success() || cfg!(target_os = "windows") {
        Ok(())
    } else {
        Err(io::Error::other(format!("{program}: {status}")))
    }
}
