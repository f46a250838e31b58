//! Adds flight records to their conditions: starts a reading thread, which runs the functions in
//! `record_reading.rs`, and stores the records that it found.
//!
//! A condition's *own* records are those that the dataset lists or that the example contains;
//! *added* records are in files that the engineer adds. *Topics* are a log's tables with clocks of
//! their own, which are resampled to a common clock; the clock depends on the upper end of the
//! identification band.

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
use crate::gui::state::forms::FormKind;
use crate::gui::state::record_change::RecordChange;
use crate::gui::state::records::RecordsFold;
use crate::gui::state::view::View;
use crate::message::Message;

/// Window state when a reading began.
struct ReadingStart {
    /// Upper limit of the identification band \[rad/s\], from which the sample rate of topics is
    /// chosen.
    clock_band_end: Option<f64>,
    /// Files and folders that were added earlier.
    sources: Vec<PathBuf>,
}

impl GdcmApp {
    /// Reads the displayed condition's records once a view that needs them is shown, then the other
    /// conditions' records. In each frame:
    ///
    /// 1. adapt the displayed condition's records to its band, and in the Records view show a
    ///    record that excites the input in focus, unless the engineer has chosen a record;
    /// 2. stop here if no view shows records, if records are being read, or if every condition has
    ///    an entry;
    /// 3. if none of the unread conditions can have records of its own, only create their entries;
    /// 4. otherwise read their records in a thread, which creates the entries when it ends.
    pub(super) fn look_for_records(&mut self) {
        let id = self.state.condition().id();
        // Step 1.
        self.follow_band(id);
        let shown_input = self.state.display.selection.pair.input;
        if self.state.shows_view(View::Records)
            && let Some(records) = self.state.records.conditions.get_mut(&id)
        {
            records.open_on_input(shown_input);
        }
        // Step 2.
        if !self.shows_records() || self.state.records.reading.is_some() {
            return;
        }
        let ids = self.unread_conditions();
        if ids.is_empty() {
            return;
        }
        self.state.records.example = self.files.loaded.origin.example();
        // Step 3.
        let own = self.own_records();
        if !ids.iter().any(|id| own.may_have_records(*id)) {
            for id in ids {
                self.records_of(id);
            }
            return;
        }
        // Step 4.
        let name = match ids.as_slice() {
            [only] => format!("the records of condition {only}"),
            _ => "the records of the other conditions".to_owned(),
        };
        let sources = self.state.records.sources.clone();
        let read_conditions = ids.clone();
        self.read_records_in_thread(name, sources, read_conditions, move |channels, stop| {
            let mut found = ReadRecords::default();
            own.read(&ids, channels, &stop, &mut found)?;
            Ok(found)
        });
    }

    /// Returns the conditions whose own records are to be read next: the displayed one alone, then
    /// all others, which the views *Records* and *Requirements* show too.
    fn unread_conditions(&self) -> Vec<ConditionId> {
        let known = &self.state.records.conditions;
        let shown = self.state.condition().id();
        if !known.contains_key(&shown) {
            return vec![shown];
        }
        let mut unread = Vec::new();
        for id in self.state.study.dataset.ids() {
            if !known.contains_key(&id) {
                unread.push(id);
            }
        }
        unread
    }

    fn shows_records(&self) -> bool {
        let arrangement = &self.state.display.layout.arrangement;
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
        if self.state.forms.shown == Some(FormKind::AddRecords) {
            self.state.forms.shown = None;
            self.state.forms.typed.remove(&FormKind::AddRecords);
        }
        let sources = self.state.records.sources.clone();
        self.state.records.sources.extend(paths.iter().cloned());
        let name = match paths.first() {
            Some(path) => path.display().to_string(),
            None => String::new(),
        };
        let files = AddedFiles {
            paths,
            own: self.own_records(),
            loaded: self.state.records.conditions.keys().copied().collect(),
        };
        self.read_records_in_thread(name, sources, Vec::new(), move |channels, stop| {
            files.read(channels, &SilentProgress(stop))
        });
    }

    /// Reads records in a thread; `sources` are the files and folders that were added earlier,
    /// `read_conditions` the conditions whose own records are read.
    fn read_records_in_thread(
        &mut self,
        name: String,
        sources: Vec<PathBuf>,
        read_conditions: Vec<ConditionId>,
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
        self.state.records.reading = Some(name.clone());
        let reading = self.readers.record_reader.join();
        let number = reading.number;
        let read = move || read(&channels, reading.stop);
        self.in_thread("the reading of records", read, move |app, found| {
            if !app.readers.record_reader.is_newest(number)
                || !Arc::ptr_eq(&dataset, app.state.study.file_dataset())
            {
                return;
            }
            // Another reading may have begun in the meantime.
            if app.state.records.reading.as_ref() == Some(&name) {
                app.state.records.reading = None;
            }
            if let Some(found) = found.and_then(|found| app.value_or_notify(found)) {
                app.take_records(found, start);
            }
            // Create entries, even without records, so that these are not read again.
            for id in read_conditions {
                app.records_of(id);
            }
        });
    }

    /// Returns a condition's records; creates an entry without records if there is none.
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
            unassigned,
            mut faults,
            read_from,
        } = found;
        if let Some(made) = self.made_of_records() {
            faults.extend(made.left_out.iter().cloned());
        }
        if !faults.is_empty() || !added.is_empty() || !unassigned.is_empty() {
            self.state.records.faults = faults;
        }
        self.state.records.read_from.extend(read_from);
        let own_count: usize = own.values().map(Vec::len).sum();
        self.store_own_records(own, start.clock_band_end);
        if !added.is_empty() || !unassigned.is_empty() {
            self.store_added_records(added, unassigned, start);
        } else if own_count > 0 {
            let text = format!("read {} of the dataset", counted(own_count, "record"));
            self.notify_done(Message::new("records-read", text));
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
            records.changed_since_fit = true;
        }
    }

    /// Adds records to their conditions, or to those without a condition; this can be undone:
    ///
    /// 1. if a record has problems, unfold the columns, where they can be resolved;
    /// 2. add the records condition by condition ([`Self::add_to_condition`]); where this changes a
    ///    condition's records, its identification is outdated, copies are left out, and the common
    ///    clock counts as unknown if older records have another;
    /// 3. add the records without a condition;
    /// 4. record an undo step with what has changed, and report the counts.
    fn store_added_records(
        &mut self,
        added: BTreeMap<ConditionId, Vec<LaidOutRecord>>,
        unassigned: Vec<LaidOutRecord>,
        start: ReadingStart,
    ) {
        // Step 1.
        let has_problems = added
            .values()
            .flatten()
            .chain(&unassigned)
            .any(|row| !row.problems.is_empty());
        if has_problems {
            self.state.records.open_fold = Some(RecordsFold::Columns);
        }
        let mut before = self.state.records.before(added.keys().copied());
        before.sources = Some(start.sources);
        // Step 2.
        let mut counts = AddedCounts::default();
        for (id, rows) in added {
            let is_changed = self.add_to_condition(id, rows, start.clock_band_end, &mut counts);
            if !is_changed {
                before.conditions.remove(&id);
            }
        }
        // Step 3.
        let unassigned_before = self.state.records.unassigned.clone();
        for row in unassigned {
            counts.count_unassigned(self.state.records.add_unassigned(row));
        }
        if counts.unassigned > 0 {
            before.unassigned = Some(unassigned_before);
        }
        // Step 4.
        if !before.conditions.is_empty() || counts.unassigned > 0 {
            let records = counts.new + counts.read_again + counts.unassigned;
            self.record_edited(RecordChange::Add { records }, before);
        }
        self.notify_done(Message::new("records-added", counts.words()));
    }

    /// Adds records, whose topics have the common clock for `clock_band_end` \[rad/s\], to a
    /// condition, and counts them; returns whether the condition's records have changed.
    fn add_to_condition(
        &mut self,
        id: ConditionId,
        rows: Vec<LaidOutRecord>,
        clock_band_end: Option<f64>,
        counts: &mut AddedCounts,
    ) -> bool {
        let read_from = self.state.records.read_from.clone();
        let channels = self.record_channels(id);
        let records = self.records_of(id);
        let all_have_same_clock =
            records.rows.is_empty() || records.clock_band_end == clock_band_end;
        let mut is_changed = false;
        let mut has_new = false;
        for row in rows {
            let outcome = records.add_row(row, &read_from, &channels);
            is_changed |= outcome != AddedRecord::KnownAlready;
            has_new |= outcome == AddedRecord::New;
            counts.count(outcome);
        }
        if has_new {
            counts.conditions += 1;
        }
        if !is_changed {
            return false;
        }
        records.clock_band_end = if all_have_same_clock {
            clock_band_end
        } else {
            None
        };
        leave_out_copies(&mut records.rows);
        // Keeps the displayed index within the rows.
        records.choose(records.chosen);
        records.changed_since_fit = true;
        true
    }
}

/// Counts added records by outcome, and conditions with new records.
#[derive(Default)]
struct AddedCounts {
    new: usize,
    read_again: usize,
    known: usize,
    /// Records without a condition.
    unassigned: usize,
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

    fn count_unassigned(&mut self, is_new: bool) {
        if is_new {
            self.unassigned += 1;
        } else {
            self.known += 1;
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
        if self.unassigned > 0 {
            let records = counted(self.unassigned, "record");
            parts.push(format!(
                "{records} without a condition: choose the condition in the list"
            ));
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
