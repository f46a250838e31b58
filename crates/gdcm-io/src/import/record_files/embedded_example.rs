//! Flight records in the embedded examples.

use gdcm_model::names::standard_patterns;
use gdcm_sysid::records::RecordTable;
use gdcm_sysid::records::record_guess::RecordGuess;

use super::records_of_bytes;
use crate::file_error::FileError;
use crate::files::example::Example;
use crate::reading_budget::ReadingBudget;

/// Returns a condition's records in an example; empty unless the condition is one of
/// [`Example::record_conditions`].
pub fn example_records(example: Example, condition: i64) -> Result<Vec<RecordTable>, FileError> {
    if !example.record_conditions().contains(&condition) {
        return Ok(Vec::new());
    }
    let patterns = standard_patterns();
    // File name in error messages.
    let name = format!("({} records).zip", example.name());
    let found = records_of_bytes(example.records(), &name, &ReadingBudget::default())?;
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
        for condition in Example::Simulated.record_conditions() {
            let records = example_records(Example::Simulated, *condition).unwrap();
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
        assert!(example_records(Example::Simulated, 1).unwrap().is_empty());
    }

    #[test]
    fn each_flight_of_the_real_aircraft_has_a_part_to_fit_and_a_part_held_out() {
        for (condition, expected_rows) in [(1, [3710, 1591]), (2, [8645, 3705])] {
            let records = example_records(Example::RealAircraft, condition).unwrap();
            let mut rows = Vec::new();
            let mut held_out = Vec::new();
            for record in &records {
                rows.push(record.rows());
                held_out.push(RecordGuess::from_table(record, standard_patterns()).held_out);
                assert!(record.columns.len() == 7 && record.named);
            }
            assert_eq!(rows, expected_rows, "74 s, 32 s, 173 s and 74 s at 50 Hz");
            assert_eq!(held_out, [false, true]);
        }
    }
}
