//! Tables of responses as JSON: a list of rows, one per output, with a value for each input.

use serde_json::Value;

use gdcm_model::dataset::{Pair, PairTable};

/// Returns a table as a list of rows, one per output. Missing values become null, and so do
/// non-finite values, which JSON cannot represent.
pub(super) fn rows<T>(table: &PairTable<Option<T>>, figure: impl Fn(&T) -> f64) -> Value {
    rows_of(table.outputs(), table.inputs(), |pair| {
        table[pair].as_ref().map(&figure).into()
    })
}

/// Returns the entries of a table as a list of rows, one per output.
pub(super) fn rows_of(outputs: usize, inputs: usize, entry: impl Fn(Pair) -> Value) -> Value {
    let mut rows = Vec::with_capacity(outputs);
    for output in 0..outputs {
        let mut row = Vec::with_capacity(inputs);
        for input in 0..inputs {
            row.push(entry(Pair { output, input }));
        }
        rows.push(Value::Array(row));
    }
    Value::Array(rows)
}
