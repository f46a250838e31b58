//! A condition's flight records, collected from its models' files.

use super::part::Part;
use crate::dataset::condition::ConditionRecord;

/// Returns the distinct flight records listed in the models' files.
///
/// If several files list the same record, the first entry with used intervals is kept, or else the
/// first entry. A different record whose name is already taken is numbered: "name (2)".
pub(super) fn flight_records(parts: &[&Part]) -> Vec<ConditionRecord> {
    let mut records: Vec<ConditionRecord> = Vec::new();
    let mut known: Vec<&ConditionRecord> = Vec::new();
    for record in parts.iter().flat_map(|part| &part.found.facts.records) {
        let place = known.iter().position(|other| is_same_record(other, record));
        if let Some(place) = place {
            if records[place].used_s.is_empty() {
                records[place] = ConditionRecord {
                    name: records[place].name.clone(),
                    ..record.clone()
                };
            }
            continue;
        }
        known.push(record);
        records.push(ConditionRecord {
            name: unused_name(&record.name, &records),
            ..record.clone()
        });
    }
    records
}

fn is_same_record(a: &ConditionRecord, b: &ConditionRecord) -> bool {
    a.name == b.name && a.file == b.file && a.variable == b.variable
}

/// Returns the name, or "name (2)", "name (3)" ... if a record already has it.
fn unused_name(name: &str, records: &[ConditionRecord]) -> String {
    let mut unused = name.to_owned();
    let mut number = 1;
    while records.iter().any(|record| record.name == unused) {
        number += 1;
        unused = format!("{name} ({number})");
    }
    unused
}
