//! Commands of the Records view. Edits can be undone.

use std::sync::Arc;

use gdcm_model::dataset::condition::ChannelRemedy;
use gdcm_model::dataset::{ConditionId, Dataset};
use gdcm_model::names::ChannelRule;
use gdcm_model::simulation::Signal;
use gdcm_study::Edit;
use gdcm_sysid::records::{
    LaidOutRecord, RecordChannels, RecordLayout, RecordTable, leave_out_copies,
};

use super::GdcmApp;
use super::dialogs::DialogPurpose;
use crate::gui::commands::records::RecordsCommand;
use crate::gui::commands::selection::SelectionCommand;
use crate::gui::state::condition_records::ConditionRecords;
use crate::gui::state::records::RecordsBefore;
use crate::gui::state::records_page::RecordsPage;

impl GdcmApp {
    /// Carries out a command about flight records.
    pub(super) fn carry_out_records(&mut self, command: RecordsCommand) {
        let condition = self.state.condition().id();
        let records = &mut self.state.records;
        match command {
            RecordsCommand::Add(paths) => self.add_records(paths),
            RecordsCommand::AskDataset => self.ask_record_dataset(),
            RecordsCommand::MakeDataset => self.make_record_dataset(),
            RecordsCommand::AskFiles => self.ask_path(DialogPurpose::RecordFolder, String::new()),
            RecordsCommand::Show(page) => records.page = page,
            RecordsCommand::ChooseParts(chooses) => records.chooses_parts = chooses,
            RecordsCommand::ShowSpectrogram(input) => records.spectrogram = input,
            RecordsCommand::ShowTimeModel(model, true) => {
                records.time_models.insert(model);
            }
            RecordsCommand::ShowTimeModel(model, false) => {
                records.time_models.remove(&model);
            }
            RecordsCommand::Identify => self.identify_conditions(&[condition]),
            RecordsCommand::IdentifyAll => {
                let conditions = records.conditions_in_use();
                self.identify_conditions(&conditions);
            }
            RecordsCommand::Stop => self.stop_identifying(),
            RecordsCommand::Take(offered) => self.take_identified(&[condition], offered),
            RecordsCommand::TakeAll(offered) => {
                let conditions: Vec<ConditionId> = records.conditions.keys().copied().collect();
                self.take_identified(&conditions, offered);
            }
            RecordsCommand::Return => self.decide(&Edit::ReturnModels { condition }),
            RecordsCommand::ShowAdvanced(field) => records.advanced_field = Some(field),
            RecordsCommand::Choose(index) => {
                if let Some(records) = records.conditions.get_mut(&condition) {
                    records.choose(index);
                }
            }
            RecordsCommand::SetLayout(index, layout) => self.set_layout(condition, index, layout),
            RecordsCommand::TakeDatasetUnits => self.take_dataset_units(),
            RecordsCommand::ShowUnclear => self.show_unclear(),
            // Every other command changes the records of the displayed condition; see `apply_edit`.
            edit => self.edit_records(condition, edit),
        }
    }

    /// Applies an edit to the records of a condition; it can be undone.
    fn edit_records(&mut self, condition: ConditionId, command: RecordsCommand) {
        let channels = self.record_channels(condition);
        let before = self.state.records.before([condition]);
        let Some(records) = self.state.records.conditions.get_mut(&condition) else {
            return;
        };
        let label = format!("{} (condition {condition})", edit_label(records, &command));
        match apply_edit(records, command, &channels) {
            Ok(true) => {
                records.changed = true;
                self.record_edited(label, before);
                self.follow_band(condition);
            }
            Ok(false) => {}
            Err(problem) => self.notify_error(problem),
        }
    }

    /// Adds an edit of records to the undo history.
    pub(super) fn record_edited(&mut self, label: String, before: RecordsBefore) {
        let study = self.state.study.clone();
        self.state.history.record_beside(study, label, before);
        self.state.notice = None;
    }

    /// Sets the layout of a record, and changes similar records in the same way.
    fn set_layout(&mut self, condition: ConditionId, index: usize, layout: RecordLayout) {
        let Some(records) = self.state.records.conditions.get(&condition) else {
            return;
        };
        let Some(row) = records.rows.get(index) else {
            return;
        };
        let dataset = Arc::clone(&self.state.study.dataset);
        let change = LayoutChange {
            condition,
            is_named: row.table.entry_of_dataset(&dataset).is_some(),
            table: Arc::clone(&row.table),
            former: row.layout.clone(),
            layout,
            dataset,
        };
        let label = format!("columns of {}", change.table.name);
        self.edit_layouts(label, |id, row| change.layout_for(id, row));
    }

    /// Assumes the units of the dataset's channels for columns whose file states none.
    fn take_dataset_units(&mut self) {
        let label = "units of the dataset's channels".to_owned();
        self.edit_layouts(label, |_, row| Some(row.layout.in_units_of_channels()));
    }

    /// Changes record layouts in all conditions; this can be undone. `layout_for` returns `None`
    /// for a record that keeps its layout.
    fn edit_layouts(
        &mut self,
        label: String,
        layout_for: impl Fn(ConditionId, &LaidOutRecord) -> Option<RecordLayout>,
    ) {
        let ids: Vec<ConditionId> = self.state.records.conditions.keys().copied().collect();
        let mut changed = RecordsBefore::default();
        for id in ids {
            let channels = self.record_channels(id);
            let before = self.state.records.conditions.get(&id).cloned();
            let Some(records) = self.state.records.conditions.get_mut(&id) else {
                continue;
            };
            let is_changed =
                change_layouts(&mut records.rows, &channels, |row| layout_for(id, row));
            if is_changed {
                records.changed = true;
                changed.conditions.insert(id, before);
            }
        }
        if !changed.conditions.is_empty() {
            self.record_edited(label, changed);
        }
    }

    /// Shows the first record with missing units, on the Columns page.
    fn show_unclear(&mut self) {
        let Some(id) = self.state.records.open_units().and_then(|open| open.first) else {
            return;
        };
        if let Some(records) = self.state.records.conditions.get_mut(&id) {
            let unclear = records.rows.iter().position(|row| !row.problems.is_empty());
            records.choose(unclear.unwrap_or(records.chosen));
        }
        self.state.records.page = RecordsPage::Columns;
        self.dispatch(SelectionCommand::SelectCondition(id));
    }

    /// Resamples the topics of a condition if its identification band has changed and requires
    /// another sample rate.
    pub(super) fn follow_band(&mut self, condition: ConditionId) {
        let [_, end] = self.identified_band(condition);
        let Some(records) = self.state.records.conditions.get(&condition) else {
            return;
        };
        if records.clock_band_end == Some(end) {
            return;
        }
        let channels = self.record_channels(condition);
        if let Some(records) = self.state.records.conditions.get_mut(&condition) {
            records.follow_band(&channels);
        }
    }

    /// Returns the channels expected in the records of a condition: the channels of the dataset, at
    /// the locations that were given if the dataset was made from records. Topics are resampled as
    /// the identification band requires.
    pub(super) fn record_channels(&self, condition: ConditionId) -> RecordChannels {
        let mut channels = RecordChannels::of_dataset(&self.state.study.dataset);
        let [_, end] = self.identified_band(condition);
        channels.resampling.band_end = Some(end);
        let Some(made) = self.made_of_records() else {
            return channels;
        };
        let specified = [&made.channels.inputs, &made.channels.outputs];
        let specified: Vec<&ChannelRule> = specified.into_iter().flatten().collect();
        for rule in channels.inputs.iter_mut().chain(&mut channels.outputs) {
            if let Some(source) = specified.iter().find(|source| source.name == rule.name) {
                rule.aliases.clone_from(&source.aliases);
                rule.unit_in_files.clone_from(&source.unit_in_files);
            }
        }
        channels
    }
}

/// New layout of a record, also for similar records.
struct LayoutChange {
    /// Condition with the edited record.
    condition: ConditionId,
    /// The edited record.
    table: Arc<RecordTable>,
    former: RecordLayout,
    layout: RecordLayout,
    /// Whether the dataset lists the record.
    is_named: bool,
    dataset: Arc<Dataset>,
}

impl LayoutChange {
    /// Returns the new layout of a record; `None` if it keeps its layout. The layout of records
    /// that the dataset lists is stored there, so a change applies only to listed records of the
    /// same condition, or only to unlisted records.
    fn layout_for(&self, id: ConditionId, row: &LaidOutRecord) -> Option<RecordLayout> {
        if Arc::ptr_eq(&row.table, &self.table) && row.layout == self.former {
            return Some(self.layout.clone());
        }
        let is_named = row.table.entry_of_dataset(&self.dataset).is_some();
        let is_reached = id == self.condition || !self.is_named;
        if !is_reached || is_named != self.is_named {
            return None;
        }
        let change = [&self.former, &self.layout];
        Some(row.layout.following(&row.table, change, &self.table))
    }
}

/// Changes the layouts of `rows`; returns whether a layout has changed. Records that become
/// readable may turn out to be copies of others, which are then left out.
fn change_layouts(
    rows: &mut [LaidOutRecord],
    channels: &RecordChannels,
    layout_for: impl Fn(&LaidOutRecord) -> Option<RecordLayout>,
) -> bool {
    let mut is_changed = false;
    let mut is_any_clear_now = false;
    for row in &mut *rows {
        let Some(layout) = layout_for(row) else {
            continue;
        };
        if layout == row.layout {
            continue;
        }
        let was_clear = row.flight.is_some();
        *row = row.laid_out(layout, channels);
        is_changed = true;
        is_any_clear_now |= !was_clear && row.flight.is_some();
    }
    if is_any_clear_now {
        leave_out_copies(rows);
    }
    is_changed
}

/// Returns the label of an edit in the undo history.
fn edit_label(records: &ConditionRecords, command: &RecordsCommand) -> String {
    match command {
        RecordsCommand::SetKind(index, kind) => {
            format!("{} is a {}", record_name(records, *index), kind.word())
        }
        RecordsCommand::SetUsed(index, true) => format!("use {}", record_name(records, *index)),
        RecordsCommand::SetUsed(index, false) => {
            format!("leave {} out", record_name(records, *index))
        }
        RecordsCommand::SetHeldOut(index, true) => {
            format!("hold {} out", record_name(records, *index))
        }
        RecordsCommand::SetHeldOut(index, false) => format!("fit {}", record_name(records, *index)),
        RecordsCommand::SetDelay(signal, _) => format!("time skew of {}", signal.name),
        RecordsCommand::SetRemedies(index, _) => {
            format!("correct {}", record_name(records, *index))
        }
        RecordsCommand::SetHold(signal, _) => format!("hold of {}", signal.name),
        RecordsCommand::SetBand(_) => "identification band".to_owned(),
        RecordsCommand::SetSearch(_) => "identification search settings".to_owned(),
        RecordsCommand::SetReferences(_) => "references".to_owned(),
        RecordsCommand::AddPart(index, _) => format!("part of {}", record_name(records, *index)),
        RecordsCommand::RemovePart(index) => format!("remove {}", record_name(records, *index)),
        _ => "records".to_owned(),
    }
}

fn record_name(records: &ConditionRecords, index: usize) -> &str {
    match records.rows.get(index) {
        Some(row) => &row.table.name,
        None => "a record",
    }
}

/// Applies an edit to the records of a condition; returns false if the command is no such edit.
///
/// # Errors
/// A message, if the edit is impossible.
fn apply_edit(
    records: &mut ConditionRecords,
    command: RecordsCommand,
    channels: &RecordChannels,
) -> Result<bool, String> {
    match command {
        RecordsCommand::SetUsed(index, used) => return Ok(records.set_used(index, used)),
        RecordsCommand::AddPart(index, part_s) => records.add_part(index, part_s, channels)?,
        RecordsCommand::RemovePart(index) => return Ok(records.remove_part(index)),
        RecordsCommand::SetKind(index, kind) => {
            if let Some(row) = records.rows.get_mut(index) {
                row.guess.kind = kind;
            }
        }
        RecordsCommand::SetHeldOut(index, held_out) => {
            if let Some(row) = records.rows.get_mut(index) {
                row.guess.held_out = held_out;
            }
        }
        RecordsCommand::SetDelay(signal, delay_s) => {
            if let Some(channel) = records.channel_mut(&signal) {
                channel.delay_s = delay_s;
            }
        }
        RecordsCommand::SetRemedies(index, remedies) => {
            if let Some(row) = records.rows.get_mut(index) {
                set_remedies(row, &remedies, channels);
            }
        }
        RecordsCommand::SetHold(signal, hold) => {
            if let Some(channel) = records.channel_mut(&signal) {
                channel.hold = hold;
            }
        }
        RecordsCommand::SetBand(band) => records.band = band,
        RecordsCommand::SetSearch(search) => records.search = search,
        RecordsCommand::SetReferences(references) => records.references = references,
        _ => return Ok(false),
    }
    Ok(true)
}

/// Sets the delays and factors of channels in a single record.
fn set_remedies(
    row: &mut LaidOutRecord,
    remedies: &[(Signal, ChannelRemedy)],
    channels: &RecordChannels,
) {
    let mut layout = row.layout.clone();
    for (signal, remedy) in remedies {
        if let Some(column) = layout.channel_mut(signal.role, signal.index) {
            column.remedy = *remedy;
        }
    }
    *row = row.laid_out(layout, channels);
}
