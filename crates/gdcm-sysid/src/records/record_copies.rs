//! Recognises copies among records: if several have the same samples, only the first is used.

use nalgebra::DMatrix;

use gdcm_model::simulation::FlightRecord;

use super::laid_out_record::LaidOutRecord;
use super::layout_problem::LayoutCaution;

/// Excludes each record whose samples repeat an earlier record, with a caution: each measurement
/// counts once, however often and under whatever names it is read. A user decision on a copy that
/// was already reported is kept.
pub fn leave_out_copies(records: &mut [LaidOutRecord]) {
    for index in 1..records.len() {
        let (earlier, rest) = records.split_at_mut(index);
        let record = &mut rest[0];
        let Some(first) = original_of(record, earlier) else {
            continue;
        };
        let caution = LayoutCaution::Copy {
            first: first.table.name.clone(),
        };
        if !record.cautions.contains(&caution) {
            record.used = false;
            record.cautions.push(caution);
        }
    }
}

/// Returns the first used earlier record with the same samples; `None` if `record` is not used.
fn original_of<'r>(
    record: &LaidOutRecord,
    earlier: &'r [LaidOutRecord],
) -> Option<&'r LaidOutRecord> {
    let flight = record.used_flight()?;
    earlier.iter().find(|other| match other.used_flight() {
        Some(other) => is_copy(other, flight),
        None => false,
    })
}

/// Returns whether all samples agree to the last bit; the clocks may differ.
fn is_copy(a: &FlightRecord, b: &FlightRecord) -> bool {
    has_same_bits(&a.inputs, &b.inputs) && has_same_bits(&a.outputs, &b.outputs)
}

fn has_same_bits(a: &DMatrix<f64>, b: &DMatrix<f64>) -> bool {
    a.shape() == b.shape()
        && a.iter()
            .zip(b.iter())
            .all(|(a, b)| a.to_bits() == b.to_bits())
}
