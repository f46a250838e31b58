//! Offering what a window lost that ended without saving, and opening it again.

use gdcm_core::message_text::{sanitized, sanitized_path};
use std::time::{Duration, SystemTime};

use egui::Context;
use jiff::Timestamp;
use jiff::tz::TimeZone;

use crate::view::bars::Bar;
use gdcm_files::{LostStudy, Opened, open_study};

use super::autosave::{Kept, Unsaved};
use super::files::ReadFor;
use super::window::GdcmApp;

/// How long a window that ends waits for the disk to take what was decided last.
pub(super) const LAST_WAIT: Duration = Duration::from_secs(2);

impl GdcmApp {
    /// Takes what the thread that keeps decisions has to say.
    pub(super) fn receive_recovery(&mut self) {
        for lost in self.autosave.offers() {
            let sentence = offer_words(&lost, &TimeZone::system());
            self.state.bars.push(Bar::Recovery { offer: self.offers.len(), sentence });
            self.offers.push(Some(lost));
        }
        if let Some(error) = self.autosave.failure() {
            self.trouble(format!("decisions that are not saved cannot be kept safe: {error}"));
        }
    }

    /// Keeps what is not saved, or forgets what is.
    pub(super) fn keep_unsaved(&self) {
        if self.state.unsaved {
            let (study, loaded) = (self.state.study.clone(), self.loaded.clone());
            self.autosave.keep(Unsaved { study, loaded, saved_as: self.saved.path.clone() });
        } else {
            self.autosave.clear();
        }
    }

    /// Opens what was lost; the bar goes once it is open.
    pub(super) fn restore(&mut self, offer: usize, ctx: &Context) {
        if let Some(Some(lost)) = self.offers.get(offer) {
            let path = lost.path().to_owned();
            let read = move || Ok(Opened::Study(open_study(&path)?));
            self.read(ReadFor::Restoring(offer), "decisions that were not saved".to_owned(), read, ctx);
        }
    }

    /// Shows what was lost, not saved still.
    pub(super) fn show_restored(&mut self, offer: usize, opened: Opened, ctx: &Context) {
        let Some(lost) = self.offers.get_mut(offer).and_then(Option::take) else { return };
        let words = format!("restored the decisions of {}", when(lost.kept_at, &TimeZone::system()));
        let saved_as = lost.saved_as.clone();
        self.show(opened);
        self.state.study_name = super::files::study_name(saved_as.as_deref());
        self.saved.path = saved_as;
        self.saved.study = None;
        self.autosave.restored(lost);
        self.close_offer(offer);
        self.look_for_recent(ctx);
        self.study_changed();
        self.done(words);
    }

    pub(super) fn discard(&mut self, offer: usize) {
        if let Some(lost) = self.offers.get_mut(offer).and_then(Option::take) {
            self.autosave.discard(lost);
        }
        self.close_offer(offer);
    }

    fn close_offer(&mut self, closed: usize) {
        self.state.bars.retain(|bar| !matches!(bar, Bar::Recovery { offer, .. } if *offer == closed));
    }
}

/// "Decisions of 14:32 on 21 Nov 2026 for data.json.gz (study mine.gdcm-study.json) were not saved."
fn offer_words(lost: &LostStudy, zone: &TimeZone) -> String {
    let study = lost.saved_as.as_ref().and_then(|path| path.file_name());
    let study = study.map_or(String::new(), |name| format!(" (study {})", sanitized(&name.to_string_lossy())));
    format!("Decisions of {} for {}{study} were not saved.", when(lost.kept_at, zone), sanitized(&lost.dataset))
}

/// "14:32 on 21 Nov 2026", in the given zone.
fn when(at: SystemTime, zone: &TimeZone) -> String {
    let at = Timestamp::try_from(at).unwrap_or(Timestamp::UNIX_EPOCH);
    at.to_zoned(zone.clone()).strftime("%H:%M on %-d %b %Y").to_string()
}

/// What is said on standard error when the window itself fails.
pub(super) fn end_words(fault: &str, kept: &Result<Option<Kept>, String>) -> String {
    let fault = format!("stopped by a fault in its window: {fault}");
    match kept {
        Ok(Some(Kept { path, at })) => {
            let time = when(*at, &TimeZone::system());
            format!("{fault}; your decisions up to {time} are in {}", sanitized_path(path))
        }
        Ok(None) => format!("{fault}; every decision was saved"),
        Err(why) => format!("{fault}; the decisions that were not saved are lost: {why}"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_time_is_that_of_the_clock_on_the_wall() {
        let at = SystemTime::UNIX_EPOCH + Duration::from_secs(1_795_271_520);
        assert_eq!(when(at, &TimeZone::UTC), "14:32 on 21 Nov 2026");
        assert_eq!(when(at, &TimeZone::fixed(jiff::tz::offset(1))), "15:32 on 21 Nov 2026");
    }

    #[test]
    fn the_last_words_name_the_fault_its_place_and_the_recovery_file() {
        let fault = "out of range at src/view/centre.rs:7";
        let kept = Kept { path: "/data/recovery/7-1.gdcm-study.json".into(), at: SystemTime::UNIX_EPOCH };
        let words = end_words(fault, &Ok(Some(kept)));
        assert!(
            words.starts_with("stopped by a fault in its window: out of range at src/view/centre.rs:7;"),
            "{words}"
        );
        assert!(words.ends_with("1970 are in /data/recovery/7-1.gdcm-study.json"), "{words}");
        assert!(end_words(fault, &Ok(None)).ends_with("; every decision was saved"));
    }
}
