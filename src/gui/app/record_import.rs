//! Adds flight records to their conditions: starts a reading thread, which runs the functions of
//! `record_reading.rs`, and stores the records that it found.

use std::collections::BTreeMap;
use std::path::PathBuf;
use std::sync::Arc;
use std::sync::atomic::AtomicBool;

use gdcm_io::FileError;
use gdcm_model::dataset::ConditionId;
use gdcm_model::number_format::counted;
use gdcm_sysid::records::{LaidOutRecord, RecordChannels, leave_out_copies};

use super::GdcmApp;
use super::readers::SilentProgress;
use super::record_reading::{AddedFiles, OwnRecords, ReadRecords};
use crate::gui::state::condition_records::{AddedRecord, ConditionRecords};
use crate::gui::state::record_change::RecordChange;
use crate::gui::state::view::View;
use crate::message::Message;

/// State of the window when a reading began.
struct ReadingStart {
    /// Upper limit of the identification band \[rad/s\], from which the sample rate of topics is
    /// chosen.
    clock_band_end: Option<f64>,
    /// Files and folders that were added earlier.
    sources: Vec<PathBuf>,
}

impl GdcmApp {
    /// Reads the records of the displayed condition once a view that needs them is shown, then those
    /// of all conditions if the requirements are shown.
    pub(super) fn look_for_records(&mut self) {
        let id = self.state.condition().id();
        self.follow_band(id);
        let records = &self.state.records;
        if !self.shows_records() || records.reading.is_some() {
            return;
        }
        if records.conditions.contains_key(&id) {
            self.look_for_other_records();
            return;
        }
        self.state.records.example = self.files.loaded.origin.example();
        let own = self.own_records();
        if !own.has_some(id) {
            self.records_of(id);
            return;
        }
        let name = format!("the records of condition {id}");
        let sources = self.state.records.sources.clone();
        self.read_records_in_thread(name, sources, vec![id], move |channels, stop| {
            let mut found = ReadRecords::default();
            own.read(&[id], channels, &stop, &mut found)?;
            Ok(found)
        });
    }

    /// Reads the records of the other conditions if the requirements are shown, which judge all
    /// conditions.
    fn look_for_other_records(&mut self) {
        let arrangement = &self.state.display.layout.arrangement;
        if !arrangement.is_shown(View::Requirements) {
            return;
        }
        let own = self.own_records();
        let mut others: Vec<ConditionId> = self.state.dataset().ids().collect();
        others.retain(|id| !self.state.records.conditions.contains_key(id) && own.has_some(*id));
        if others.is_empty() {
            return;
        }
        let sources = self.state.records.sources.clone();
        let name = format!("the records of {}", counted(others.len(), "condition"));
        let asked = others.clone();
        self.read_records_in_thread(name, sources, others, move |channels, stop| {
            let mut found = ReadRecords::default();
            own.read(&asked, channels, &stop, &mut found)?;
            Ok(found)
        });
    }

    fn shows_records(&self) -> bool {
        let display = &self.state.display;
        let arrangement = &display.layout.arrangement;
        arrangement.is_shown(View::Records) || arrangement.is_shown(View::Requirements)
    }

    /// Returns the source of the conditions' own records.
    fn own_records(&self) -> OwnRecords {
        OwnRecords {
            dataset: Arc::clone(&self.state.study.dataset),
            origin: self.files.loaded.origin.clone(),
        }
    }

    /// Reads records from files and folders, and adds them to their conditions.
    pub(super) fn add_records(&mut self, paths: Vec<PathBuf>) {
        let paths: Vec<PathBuf> = paths
            .into_iter()
            .map(|path| self.files.at_home(path))
            .collect();
        let sources = self.state.records.sources.clone();
        self.state.records.sources.extend(paths.iter().cloned());
        let name = match paths.first() {
            Some(path) => path.display().to_string(),
            None => String::new(),
        };
        let files = AddedFiles {
            paths,
            own: self.own_records(),
            shown: self.state.condition().id(),
            loaded: self.state.records.conditions.keys().copied().collect(),
        };
        self.read_records_in_thread(name, sources, Vec::new(), move |channels, stop| {
            files.read(channels, &SilentProgress(stop))
        });
    }

    /// Reads records in a thread; `sources` are the files and folders that were added earlier,
    /// `conditions` those whose own records are read.
    fn read_records_in_thread(
        &mut self,
        name: String,
        sources: Vec<PathBuf>,
        conditions: Vec<ConditionId>,
        read: impl FnOnce(&RecordChannels, Arc<AtomicBool>) -> Result<ReadRecords, FileError>
        + Send
        + 'static,
    ) {
        let channels = self.record_channels(self.state.condition().id());
        let start = ReadingStart {
            clock_band_end: channels.resampling.band_end,
            sources,
        };
        let dataset = Arc::clone(self.state.study.file_dataset());
        self.state.records.reading = Some(name);
        let reading = self.readers.record_reader.join();
        let number = reading.number;
        let read = move || read(&channels, reading.stop);
        self.in_thread("the reading of records", read, move |app, found| {
            if !app.readers.record_reader.is_newest(number)
                || !Arc::ptr_eq(&dataset, app.state.study.file_dataset())
            {
                return;
            }
            app.state.records.reading = None;
            if let Some(found) = found.and_then(|found| app.value_or_notify(found)) {
                app.take_records(found, start);
            }
            // Create entries, even without records, to prevent a repeated search.
            app.records_of(app.state.condition().id());
            for id in conditions {
                app.records_of(id);
            }
        });
    }

    /// Returns the records of a condition, initially none.
    pub(super) fn records_of(&mut self, id: ConditionId) -> &mut ConditionRecords {
        self.state
            .records
            .conditions
            .entry(id)
            .or_insert_with(|| ConditionRecords::new(Vec::new(), &self.state.study.dataset))
    }

    /// Stores the records that were read, and reports faults and counts.
    fn take_records(&mut self, found: ReadRecords, start: ReadingStart) {
        let ReadRecords {
            own,
            added,
            mut faults,
            read_from,
        } = found;
        if let Some(made) = self.made_of_records() {
            faults.extend(made.left_out.iter().cloned());
        }
        self.state.records.faults = faults;
        self.state.records.read_from.extend(read_from);
        let own_count: usize = own.values().map(Vec::len).sum();
        self.store_own_records(own, start.clock_band_end);
        if !added.is_empty() {
            self.store_added_records(added, start);
        } else if own_count > 0 {
            self.notify_done(Message::new("records-read", counted(own_count, "record")));
        }
    }

    /// Stores the conditions' own records, except where records have been loaded in the meantime.
    fn store_own_records(
        &mut self,
        own: BTreeMap<ConditionId, Vec<LaidOutRecord>>,
        clock_band_end: Option<f64>,
    ) {
        for (id, rows) in own {
            if self.state.records.conditions.contains_key(&id) {
                continue;
            }
            let records = self.records_of(id);
            records.rows = rows;
            records.clock_band_end = clock_band_end;
            leave_out_copies(&mut records.rows);
            records.changed = true;
        }
    }

    /// Adds records to their conditions; this can be undone.
    fn store_added_records(
        &mut self,
        added: BTreeMap<ConditionId, Vec<LaidOutRecord>>,
        start: ReadingStart,
    ) {
        let mut before = self.state.records.before(added.keys().copied());
        before.sources = Some(start.sources);
        let mut counts = AddedCounts::default();
        let read_from = self.state.records.read_from.clone();
        for (id, rows) in added {
            let records = self.records_of(id);
            let has_this_clock =
                records.rows.is_empty() || records.clock_band_end == start.clock_band_end;
            let mut is_changed = false;
            for row in rows {
                let outcome = records.add_row(row, &read_from);
                is_changed |= outcome != AddedRecord::KnownAlready;
                counts.count(outcome);
            }
            if !is_changed {
                before.conditions.remove(&id);
                continue;
            }
            records.clock_band_end = if has_this_clock {
                start.clock_band_end
            } else {
                None
            };
            leave_out_copies(&mut records.rows);
            records.choose(records.chosen);
            records.changed = true;
            counts.conditions += 1;
        }
        if !before.conditions.is_empty() {
            let records = counts.new + counts.read_again;
            self.record_edited(RecordChange::Add { records }, before);
        }
        self.notify_done(Message::new("records-added", counts.words()));
    }
}

/// Counts added records by outcome, and conditions with new records.
#[derive(Default)]
struct AddedCounts {
    new: usize,
    read_again: usize,
    known: usize,
    conditions: usize,
}

impl AddedCounts {
    fn count(&mut self, outcome: AddedRecord) {
        match outcome {
            AddedRecord::New => self.new += 1,
            AddedRecord::ReadAgain => self.read_again += 1,
            AddedRecord::KnownAlready => self.known += 1,
        }
    }

    /// Describes the counts: "81 records of 9 conditions added; 18 already loaded".
    fn words(&self) -> String {
        let conditions = if self.conditions > 1 {
            format!(" of {} conditions", self.conditions)
        } else {
            String::new()
        };
        let mut parts = Vec::new();
        if self.new > 0 {
            parts.push(format!("{}{conditions} added", counted(self.new, "record")));
        }
        if self.read_again > 0 {
            parts.push(format!("{} read again", counted(self.read_again, "record")));
        }
        if self.known > 0 && parts.is_empty() {
            let known = counted(self.known, "record");
            parts.push(format!("nothing added: {known} already loaded"));
        } else if self.known > 0 {
            parts.push(format!("{} already loaded", self.known));
        }
        parts.join("; ")
    }
}
