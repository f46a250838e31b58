//! The records of the embedded example.

use crate::file_error::FileError;
use gdcm_core::assembly::standard_patterns;
use gdcm_core::records::{RecordGuess, RecordTable};

use super::{MOST_MEMORY, records_of_bytes};

/// The records of conditions 3 and 10 of the example: simulated sweeps and validation, one CSV each.
const ARCHIVE: &[u8] = include_bytes!("../../../../assets/example-records-3-and-10.zip");
/// What errors call them.
const NAME: &str = "(embedded example records).zip";

/// The conditions of the example whose records are inside the program.
pub const EXAMPLE_RECORD_CONDITIONS: [i64; 2] = [3, 10];

/// The records of a condition of the example: none but of [`EXAMPLE_RECORD_CONDITIONS`].
pub fn example_records(condition: i64) -> Result<Vec<RecordTable>, FileError> {
    if !EXAMPLE_RECORD_CONDITIONS.contains(&condition) {
        return Ok(Vec::new());
    }
    let patterns = standard_patterns();
    let found = records_of_bytes(ARCHIVE, NAME, MOST_MEMORY)?;
    let is_of = |table: &RecordTable| RecordGuess::of(&table.name, &patterns).condition == Some(condition);
    Ok(found.tables.into_iter().filter(is_of).collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn conditions_three_and_ten_have_eight_sweeps_and_one_validation_each() {
        for condition in EXAMPLE_RECORD_CONDITIONS {
            let records = example_records(condition).unwrap();
            let rows: Vec<usize> = records.iter().map(RecordTable::rows).collect();
            assert_eq!(rows, [[3001; 8].as_slice(), &[3301]].concat(), "60 s and 66 s at 50 Hz");
            assert!(records.iter().all(|record| record.columns.len() == 11 && record.named));
        }
        assert!(example_records(1).unwrap().is_empty());
    }
}
