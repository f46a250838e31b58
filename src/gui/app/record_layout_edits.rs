//! Edits to record layouts, which assign columns to channels. An edit to one record also changes
//! similar records, in all conditions. A *listed* record is one that the dataset names, with its
//! condition. A record is *usable* if its layout has no problems.

use std::sync::Arc;

use gdcm_model::dataset::{ConditionId, Dataset};
use gdcm_sysid::records::{
    LaidOutRecord, RecordChannels, RecordLayout, RecordTable, leave_out_copies,
};

use super::GdcmApp;
use crate::gui::state::record_change::RecordChange;
use crate::gui::state::records::RecordsSnapshot;

impl GdcmApp {
    /// Sets a record's layout, and changes similar records in the same way.
    pub(super) fn set_layout(
        &mut self,
        condition: ConditionId,
        index: usize,
        layout: RecordLayout,
    ) {
        let Some(records) = self.state.records.conditions.get(&condition) else {
            return;
        };
        let Some(row) = records.rows.get(index) else {
            return;
        };
        let dataset = Arc::clone(&self.state.study.dataset);
        let change = LayoutChange {
            is_listed: row.table.entry_of_dataset(&dataset).is_some(),
            table: Arc::clone(&row.table),
            former_layout: row.layout.clone(),
            new_layout: layout.assuming_units_of_channels(),
            dataset,
        };
        let columns = RecordChange::Columns {
            record: change.table.name.clone(),
        };
        self.edit_layouts(columns, |row| change.layout_for(row));
    }

    /// Confirms the assumed units in all conditions' records.
    pub(super) fn confirm_units(&mut self) {
        self.edit_layouts(RecordChange::DatasetUnits, |row| {
            Some(row.layout.in_units_of_channels())
        });
    }

    /// Changes record layouts in all conditions; this can be undone. `layout_for` returns `None`
    /// for a record that keeps its layout.
    fn edit_layouts(
        &mut self,
        change: RecordChange,
        layout_for: impl Fn(&LaidOutRecord) -> Option<RecordLayout>,
    ) {
        let ids: Vec<ConditionId> = self.state.records.conditions.keys().copied().collect();
        let mut changed = RecordsSnapshot::default();
        for id in ids {
            let channels = self.record_channels(id);
            let before = self.state.records.conditions.get(&id).cloned();
            let Some(records) = self.state.records.conditions.get_mut(&id) else {
                continue;
            };
            let is_changed = change_layouts(&mut records.rows, &channels, &layout_for);
            if is_changed {
                records.changed_since_fit = true;
                changed.conditions.insert(id, before);
            }
        }
        let channels = self.record_channels(self.state.condition().id());
        let unassigned = self.state.records.unassigned.clone();
        if change_layouts(&mut self.state.records.unassigned, &channels, &layout_for) {
            changed.unassigned = Some(unassigned);
        }
        if !changed.conditions.is_empty() || changed.unassigned.is_some() {
            self.record_edited(change, changed);
        }
    }
}

/// New layout for a record and for similar records.
struct LayoutChange {
    /// The edited record.
    table: Arc<RecordTable>,
    former_layout: RecordLayout,
    new_layout: RecordLayout,
    /// Whether the dataset lists the record.
    is_listed: bool,
    dataset: Arc<Dataset>,
}

impl LayoutChange {
    /// Returns a record's new layout, by the first rule that applies:
    ///
    /// 1. the edited record itself: the layout as edited;
    /// 2. the dataset lists only one of the two records: `None`, because listed records are in the
    ///    dataset's units;
    /// 3. otherwise: the record's own layout with the same changes, as far as columns are alike.
    fn layout_for(&self, row: &LaidOutRecord) -> Option<RecordLayout> {
        // Rule 1.
        if Arc::ptr_eq(&row.table, &self.table) && row.layout == self.former_layout {
            return Some(self.new_layout.clone());
        }
        // Rule 2.
        if row.table.entry_of_dataset(&self.dataset).is_some() != self.is_listed {
            return None;
        }
        // Rule 3.
        let change = [&self.former_layout, &self.new_layout];
        Some(row.layout.following(&row.table, change, &self.table))
    }
}

/// Changes the layouts of `rows`; returns whether a layout has changed. Records that become usable
/// may turn out to be copies of others, which are then left out.
fn change_layouts(
    rows: &mut [LaidOutRecord],
    channels: &RecordChannels,
    layout_for: impl Fn(&LaidOutRecord) -> Option<RecordLayout>,
) -> bool {
    let mut is_changed = false;
    let mut has_newly_usable = false;
    for row in &mut *rows {
        let Some(layout) = layout_for(row) else {
            continue;
        };
        if layout == row.layout {
            continue;
        }
        let was_usable = row.flight.is_some();
        *row = row.laid_out(layout, channels);
        is_changed = true;
        has_newly_usable |= !was_usable && row.flight.is_some();
    }
    if has_newly_usable {
        leave_out_copies(rows);
    }
    is_changed
}
