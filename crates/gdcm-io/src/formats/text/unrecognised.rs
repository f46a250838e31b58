//! Tables that are not recognised as frequency responses, and the units that they lack.

use crate::formats::text::response_columns::column_place;
use crate::formats::text::text_table::TextTable;
use crate::reading_budget::VariableFault;
use crate::variable_fault::found_content::FoundContent;
use crate::variable_fault::found_content::MissingUnit;
use crate::variable_fault::found_content::ResponseLack;

/// A column whose unit is not given, with the two units that it may have.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct UnitNotGiven {
    /// Column index, from 0.
    pub column: usize,
    /// The two possible units, as written in a heading.
    pub units: [&'static str; 2],
}

/// Reason why a table is not recognised as a frequency response. If only units are missing,
/// `unsaid` lists them; otherwise it is empty.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Unrecognised {
    pub(crate) fault: VariableFault,
    pub(crate) unsaid: Vec<UnitNotGiven>,
}

/// Returns the error for a table that is not recognised as a frequency response, with a remedy.
pub(super) fn unrecognised(lacking: ResponseLack) -> Unrecognised {
    Unrecognised {
        fault: VariableFault::format(
            "a frequency response in columns",
            FoundContent::NotAResponse { lacking },
        ),
        unsaid: Vec::new(),
    }
}

/// Returns the error that asks for units that are neither given nor evident.
pub(super) fn units_missing(table: &TextTable, unsaid: Vec<UnitNotGiven>) -> Unrecognised {
    let mut missing = Vec::with_capacity(unsaid.len());
    for UnitNotGiven { column, units } in &unsaid {
        missing.push(MissingUnit {
            place: column_place(table, *column),
            units: *units,
        });
    }
    let Unrecognised { fault, .. } = unrecognised(ResponseLack::Units(missing));
    Unrecognised { fault, unsaid }
}
