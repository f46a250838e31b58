//! Notes on the use of a record that are not cautions.

use gdcm_sysid::spectra::record_use::RecordUse;

/// Describes the inputs at their limit, which are used as logged.
pub fn input_limit_texts(used: &RecordUse) -> Vec<String> {
    let mut texts = Vec::new();
    for (signal, percent) in &used.inputs_at_limit {
        texts.push(format!(
            "{}: {signal} is at its limit for {percent:.1} % of the record and is used as logged",
            used.record
        ));
    }
    texts
}
