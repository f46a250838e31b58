//! Offers to recover unsaved decisions: at the next start, the window offers the decisions from a
//! window that ended without saving them. `autosave.rs` keeps them.
//!
//! A *lost study* is the recovery file of such a window; an *offer* is the message bar about it,
//! with a number by which the engineer's answer finds the lost study. Decisions are *kept* once
//! they are in the recovery file.

use std::path::Path;
use std::sync::{Arc, OnceLock};
use std::time::{Duration, SystemTime};

use jiff::Timestamp;
use jiff::tz::TimeZone;

use gdcm_io::files::recovery_file::LostStudy;
use gdcm_io::{Opened, load_any};
use gdcm_model::message_text::{sanitized, sanitized_path};

use super::GdcmApp;
use super::autosave::{Autosave, Kept, Remains, Task, Unsaved};
use super::document_files::{ReadFor, study_name};
use crate::gui::state::notices::{MessageBar, RecoveryOffer};
use crate::message::Message;

/// Maximum time that a closing window waits for the disk to store the latest decisions.
pub(super) const LAST_WAIT: Duration = Duration::from_secs(2);

/// The recovery thread's handle, and the offers to restore lost studies.
pub(super) struct Recovery {
    pub(super) autosave: Autosave,
    /// Set in the first frame: the code that opened the window reports through it, after a fault,
    /// where the unsaved decisions are.
    pub(super) autosave_once_drawn: Arc<OnceLock<Autosave>>,
    /// Lost studies, indexed by offer number; `None` once restored or discarded.
    pub(super) offers: Vec<Option<LostStudy>>,
}

impl Recovery {
    /// Returns the offer number for the recovery file `path`.
    pub(super) fn offer_of(&self, path: &Path) -> Option<usize> {
        self.offers.iter().position(|offer| match offer {
            Some(lost) => lost.path() == path,
            None => false,
        })
    }
}

impl GdcmApp {
    /// Shows a bar for each lost study, with the offer to restore it.
    pub(super) fn offer(&mut self, lost: Vec<LostStudy>) {
        for lost in lost {
            let number = self.recovery.offers.len();
            let offer = recovery_offer(&lost, number, &TimeZone::system());
            self.state.notices.add_bar(MessageBar::Recovery(offer));
            self.recovery.offers.push(Some(lost));
        }
    }

    /// Has the recovery thread write the unsaved decisions, or delete the recovery file if there
    /// are none.
    pub(super) fn update_recovery_file(&self) {
        if self.state.unsaved {
            let study = self.state.study.clone();
            let loaded = self.files.loaded.clone();
            self.recovery.autosave.keep(Unsaved {
                study,
                loaded,
                saved_as: self.files.saved.path.clone(),
            });
        } else {
            self.recovery.autosave.clear();
        }
    }

    /// Starts reading the decisions in an offer; [`Self::show_restored`] opens them and closes the
    /// offer's message bar.
    pub(super) fn restore(&mut self, offer: usize) {
        if let Some(Some(lost)) = self.recovery.offers.get(offer) {
            let path = lost.path().to_owned();
            self.read(
                ReadFor::Restoring(offer),
                "decisions that were not saved".to_owned(),
                move |budget| load_any(&path, budget),
            );
        }
    }

    /// Shows restored decisions, which are still unsaved, and closes their offer.
    pub(super) fn show_restored(&mut self, offer: usize, opened: Opened) {
        let Some(lost) = self.recovery.offers.get_mut(offer).and_then(Option::take) else {
            return;
        };
        let kept_at = when(lost.kept_at, &TimeZone::system());
        let message = Message::new(
            "decisions-restored",
            format!("restored the decisions of {kept_at}"),
        );
        let saved_as = lost.saved_as.clone();
        self.show(opened);
        self.state.study_name = study_name(saved_as.as_deref());
        self.files.saved.path = saved_as;
        self.files.saved.study = None;
        self.recovery.autosave.send(Task::Restored(lost));
        self.close_offer(offer);
        self.list_open_file_as_recent();
        self.study_changed();
        self.notify_done(message);
    }

    /// Discards lost decisions and their recovery file.
    pub(super) fn discard(&mut self, offer: usize) {
        if let Some(lost) = self.recovery.offers.get_mut(offer).and_then(Option::take) {
            self.recovery.autosave.send(Task::Discard(lost));
        }
        self.close_offer(offer);
    }

    fn close_offer(&mut self, closed: usize) {
        self.state
            .notices
            .close_bars(|bar| matches!(bar, MessageBar::Recovery(offer) if offer.number == closed));
    }
}

/// Describes lost decisions for their offer.
fn recovery_offer(lost: &LostStudy, number: usize, zone: &TimeZone) -> RecoveryOffer {
    let file = lost.saved_as.as_ref().and_then(|path| path.file_name());
    RecoveryOffer {
        number,
        dataset: sanitized(&lost.dataset),
        study: file.map(|name| sanitized(&name.to_string_lossy())),
        kept_at: when(lost.kept_at, zone),
    }
}

/// Formats a time in the given zone: "14:32 on 21 Nov 2026".
fn when(at: SystemTime, zone: &TimeZone) -> String {
    let at = Timestamp::try_from(at).unwrap_or(Timestamp::UNIX_EPOCH);
    at.to_zoned(zone.clone())
        .strftime("%H:%M on %-d %b %Y")
        .to_string()
}

/// Returns the message on standard error after a fault has ended the window; `remains` says which
/// unsaved decisions are kept.
pub(super) fn end_words(fault: &str, remains: &Remains) -> String {
    let fault = format!("a fault in the program closed the window: {fault}");
    match remains {
        Remains::Kept(kept) => format!("{fault}; {}", kept_words(kept)),
        Remains::Saved => format!("{fault}; every decision was saved"),
        Remains::KeptInPart(kept, why) => {
            format!("{fault}; {}, later ones are lost: {why}", kept_words(kept))
        }
        Remains::Lost(why) => format!("{fault}; the decisions that were not saved are lost: {why}"),
    }
}

/// Describes kept decisions: "your decisions up to 14:32 on 21 Nov 2026 are in
/// /data/recovery/7-1.gdcm-study.json".
fn kept_words(kept: &Kept) -> String {
    let time = when(kept.at, &TimeZone::system());
    let path = sanitized_path(&kept.path);
    format!("your decisions up to {time} are in {path}")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_time_is_written_in_its_zone() {
        let at = SystemTime::UNIX_EPOCH + Duration::from_secs(1_795_271_520);
        assert_eq!(when(at, &TimeZone::UTC), "14:32 on 21 Nov 2026");
        assert_eq!(
            when(at, &TimeZone::fixed(jiff::tz::offset(1))),
            "15:32 on 21 Nov 2026"
        );
    }

    #[test]
    fn the_last_message_names_the_fault_its_place_and_the_recovery_file() {
        let fault = "out of range at src/view/centre.rs:7";
        let kept = Kept {
            path: "/data/recovery/7-1.gdcm-study.json".into(),
            at: SystemTime::UNIX_EPOCH,
        };
        let words = end_words(fault, &Remains::Kept(kept));
        assert!(
            words.contains(fault)
                && words.contains(" 1970 ")
                && words.ends_with("/data/recovery/7-1.gdcm-study.json"),
            "{words}"
        );
        assert!(!words.contains("lost"), "{words}");
        let saved = end_words(fault, &Remains::Saved);
        assert!(saved.contains(fault) && !saved.contains("lost"), "{saved}");
    }
}
