//! A record's identity: its entry in a dataset, and whether two tables are the same record.

use gdcm_model::dataset::condition::ConditionRecord;
use gdcm_model::dataset::{ConditionId, Dataset};

use super::record_table::{RecordColumn, RecordTable};

impl RecordTable {
    /// Returns the record's dataset entry, and its condition. The entry names the same variable in
    /// a file with the same name, or the same record in an archive with another name. Entries for a
    /// part of a record do not count.
    pub fn entry_of_dataset<'d>(
        &self,
        dataset: &'d Dataset,
    ) -> Option<(ConditionId, &'d ConditionRecord)> {
        let source = &self.source;
        for condition in dataset.conditions() {
            for entry in condition.records() {
                let same_file = file_name(&entry.file) == file_name(&source.file);
                let same_name = entry.variable.is_some() && entry.name == self.name;
                if (same_file || same_name)
                    && entry.variable == source.variable
                    && entry.part_s.is_none()
                {
                    return Some((condition.id(), entry));
                }
            }
        }
        None
    }

    /// Returns whether both are the same part of the same record: the same variable in a file with
    /// equal name and content, or equal columns under the same name. A table with equal samples
    /// under another name is a copy ([`leave_out_copies`](super::leave_out_copies)).
    pub fn is_same_record(&self, other: &Self) -> bool {
        let is_same_file = self.source.sha256 == other.source.sha256
            && !self.source.sha256.is_empty()
            && file_name(&self.source.file) == file_name(&other.source.file);
        let is_same_source = is_same_file && self.source.variable == other.source.variable;
        let is_same_content = self.name == other.name && self.has_same_columns(other);
        self.part_s == other.part_s && (is_same_source || is_same_content)
    }

    fn has_same_columns(&self, other: &Self) -> bool {
        self.columns.len() == other.columns.len()
            && self
                .columns
                .iter()
                .zip(&other.columns)
                .all(|(column, other)| is_same_column(column, other))
    }
}

/// Returns whether name, unit and samples are equal; samples are compared bit for bit.
fn is_same_column(column: &RecordColumn, other: &RecordColumn) -> bool {
    let bits = column.values.iter().map(|value| value.to_bits());
    let other_bits = other.values.iter().map(|value| value.to_bits());
    column.name == other.name && column.unit == other.unit && bits.eq(other_bits)
}

/// Returns a path's last component.
fn file_name(path: &str) -> &str {
    path.rsplit('/').next().unwrap_or(path)
}
