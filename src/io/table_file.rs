//! A table as comma-separated values.

use std::io::ErrorKind;
use std::path::Path;

use crate::study::Table;

use super::file_error::FileError;
use super::output_set::OutputSet;

/// Writes a table as CSV: the headings, then a line for each row. What exists already is kept or replaced as `outputs` says.
pub fn save_table(table: &Table, path: &Path, mut outputs: OutputSet) -> Result<(), FileError> {
    outputs.add(path, |file| {
        let mut writer = csv::Writer::from_writer(file);
        for record in std::iter::once(&table.columns).chain(&table.rows) {
            // Unpacked, so that a full disk is told as one.
            writer.write_record(record).map_err(|error| match error.into_kind() {
                csv::ErrorKind::Io(error) => error,
                _ => ErrorKind::InvalidData.into(),
            })?;
        }
        writer.flush()
    })?;
    outputs.persist()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::io::Existing;

    #[test]
    fn a_table_is_written_with_its_headings_and_a_comma_in_a_cell_stays_in_it() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("table.csv");
        let mut table = Table::new("t", ["name", "G [-]"]);
        table.row(["LON → Q, held", "1.25"]);
        save_table(&table, &path, OutputSet::new(Existing::Keep, Vec::new())).unwrap();
        assert_eq!(std::fs::read_to_string(&path).unwrap(), "name,G [-]\n\"LON → Q, held\",1.25\n");
        let again = save_table(&table, &path, OutputSet::new(Existing::Keep, Vec::new()));
        assert!(matches!(again, Err(FileError::Exists { .. })));
    }
}
