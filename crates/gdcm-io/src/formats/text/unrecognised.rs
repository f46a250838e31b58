//! Tables that are not recognised as frequency responses, and the units that they lack.

use crate::formats::text::response_columns::column_place;
use crate::formats::text::text_table::TextTable;
use crate::reading_budget::VariableFault;

/// A column whose unit is not given and may be either of two.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct UnsaidUnit {
    /// Column index, from 0.
    pub column: usize,
    /// The two possible units, as written in a heading.
    pub units: [&'static str; 2],
}

/// Reason why a table is not recognised as a frequency response, and the missing units that would
/// suffice.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Unrecognised {
    pub(crate) fault: VariableFault,
    pub(crate) unsaid: Vec<UnsaidUnit>,
}

/// Returns the error for a table that is not recognised as a frequency response, with a remedy.
pub(super) fn unrecognised(found: &str) -> Unrecognised {
    let found = format!(
        "a table with {found} among its columns; name each column in the first line, with \
        --headings, or under \"headings\" in the rules: \"omega [rad/s]\", \"mag Q/LON [dB]\", \
        \"phase Q/LON [deg]\""
    );
    Unrecognised {
        fault: VariableFault::format("a frequency response in columns", found),
        unsaid: Vec::new(),
    }
}

/// Returns the error that asks for units that are neither given nor evident.
pub(super) fn units_missing(table: &TextTable, unsaid: Vec<UnsaidUnit>) -> Unrecognised {
    let mut questions = Vec::with_capacity(unsaid.len());
    for UnsaidUnit { column, units } in &unsaid {
        let place = column_place(table, *column);
        questions.push(format!("{place} (write [{}] or [{}])", units[0], units[1]));
    }
    let Unrecognised { fault, .. } =
        unrecognised(&format!("no unit of {}", questions.join(", of ")));
    Unrecognised { fault, unsaid }
}
