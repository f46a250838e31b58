//! Flight records of the embedded example.

use gdcm_model::names::standard_patterns;
use gdcm_sysid::records::RecordTable;
use gdcm_sysid::records::record_guess::RecordGuess;

use super::records_of_bytes;
use crate::file_error::FileError;
use crate::reading_budget::ReadingBudget;

/// CSV files with simulated sweeps and a validation record for each of the conditions 3 and 10.
const ARCHIVE: &[u8] = include_bytes!("../../../../../assets/example-records-3-and-10.zip");
/// File name in error messages.
const NAME: &str = "(embedded example records).zip";

/// Conditions of the example for which records are embedded.
pub const EXAMPLE_RECORD_CONDITIONS: [i64; 2] = [3, 10];

/// Returns the records of a condition in the example; empty unless the condition is one of
/// [`EXAMPLE_RECORD_CONDITIONS`].
pub fn example_records(condition: i64) -> Result<Vec<RecordTable>, FileError> {
    if !EXAMPLE_RECORD_CONDITIONS.contains(&condition) {
        return Ok(Vec::new());
    }
    let patterns = standard_patterns();
    let found = records_of_bytes(ARCHIVE, NAME, &ReadingBudget::default())?;
    let mut tables = found.tables;
    tables
        .retain(|table| RecordGuess::from_name(&table.name, patterns).condition == Some(condition));
    Ok(tables)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn conditions_three_and_ten_have_eight_sweeps_and_one_validation_each() {
        for condition in EXAMPLE_RECORD_CONDITIONS {
            let records = example_records(condition).unwrap();
            let rows: Vec<usize> = records.iter().map(RecordTable::rows).collect();
            assert_eq!(
                rows,
                [[3001; 8].as_slice(), &[3301]].concat(),
                "60 s and 66 s at 50 Hz"
            );
            assert!(
                records
                    .iter()
                    .all(|record| record.columns.len() == 11 && record.named)
            );
        }
        assert!(example_records(1).unwrap().is_empty());
    }
}
