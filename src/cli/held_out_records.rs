//! Records that are held out for validation (`gdcm identify --hold-out`).

use gdcm_sysid::records::LaidOutRecord;
use gdcm_sysid::records::record_table::shortened_list;

use super::failure::Failure;
use super::option_values::record_part;
use super::record_parts::{WholeRecord, is_called, is_requested_part};

/// Holds out the requested records or parts; `wholes` are the records from which parts were cut. A
/// name that has the form of a part (`A:B`) holds out the part, and any name also the records that
/// it identifies. Without a request, the records whose names mark them as validation are held out.
///
/// # Errors
/// A name holds out no record.
pub(super) fn hold_out(
    names: &[String],
    records: &mut [LaidOutRecord],
    wholes: &[WholeRecord],
) -> Result<(), Failure> {
    if !names.is_empty() {
        for record in records.iter_mut() {
            record.guess.held_out = false;
        }
    }
    for name in names {
        let part = record_part(name).ok();
        let mut is_found = false;
        for record in records.iter_mut() {
            let table = &record.table;
            let is_held_part = match &part {
                Some(part) => table.part_s.is_some() && is_requested_part(table, part, wholes),
                None => false,
            };
            if is_held_part || is_called(table, name) {
                record.guess.held_out = true;
                is_found = true;
            }
        }
        if !is_found {
            let names: Vec<&str> = records
                .iter()
                .map(|record| record.table.name.as_str())
                .collect();
            let reason = format!(
                "no record is called \"{name}\"; records are {}; give the file of the held-out \
                record among the records too",
                shortened_list(&names)
            );
            return Err(Failure::coded_option(
                "--hold-out",
                "unknown-record",
                reason,
            ));
        }
    }
    Ok(())
}
