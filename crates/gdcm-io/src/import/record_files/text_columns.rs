//! Record columns in text tables.

use gdcm_sysid::records::RecordColumn;
use gdcm_sysid::records::separation::Separation;

use crate::formats::reading_note::ReadingNote;
use crate::formats::recorded_columns::Columns;
use crate::formats::text::sections::sections;
use crate::formats::text::{NumberedText, TextTable, numbered_words, read_table};
use crate::reading_budget::{ReadingBudget, VariableFault};

/// Maximum number of columns whose first line may be data although it reads 1, 2, …
const FEW_COLUMNS: usize = 2;

/// Reads the columns of the table, or the tables, in a text:
///
/// 1. the whole text as a single table;
/// 2. else each section of the text ([`sections`]) as a table. Sections that are no tables or are
///    too short for a record are skipped.
///
/// # Errors
/// A limit that is exceeded ends the reading at once. If neither way yields a table, the fault of
/// the whole text, which describes what the user wrote.
pub(super) fn text_columns(
    text: &str,
    budget: &ReadingBudget<'_>,
) -> Result<Vec<Columns>, VariableFault> {
    // Step 1.
    let first_fault = match whole_text_columns(text, budget) {
        Ok(columns) => return Ok(vec![columns]),
        Err(fault) if is_of_the_text(&fault) => fault,
        Err(fault) => return Err(fault),
    };
    // Step 2.
    let sections = sections(text);
    let count = sections.len();
    if count <= 1 {
        return Err(first_fault);
    }
    let mut found = Vec::new();
    for (index, (line, section)) in sections.into_iter().enumerate() {
        let mut columns = match whole_text_columns(section, budget) {
            Ok(columns) => columns,
            Err(fault) if fault.is_of_the_budget() => return Err(fault),
            Err(_) => continue,
        };
        let rows = columns
            .columns
            .first()
            .map_or(0, |column| column.values.len());
        if rows < Separation::FEWEST {
            continue;
        }
        columns.variable = format!("table {}", index + 1);
        columns
            .notes
            .insert(0, ReadingNote::OneOfTables { count, line });
        found.push(columns);
    }
    if found.is_empty() {
        Err(first_fault)
    } else {
        Ok(found)
    }
}

/// Returns whether a fault is in the text itself, rather than an exceeded budget limit.
fn is_of_the_text(fault: &VariableFault) -> bool {
    matches!(
        fault,
        VariableFault::Line { .. } | VariableFault::Format { .. }
    )
}

/// Reads a text as a single table: as it is, else with words and clock times replaced by numbers.
fn whole_text_columns(text: &str, budget: &ReadingBudget<'_>) -> Result<Columns, VariableFault> {
    let first_fault = match read_table(text, budget) {
        Ok(table) => return Ok(table_columns(table)),
        Err(fault) if is_of_the_text(&fault) => fault,
        Err(fault) => return Err(fault),
    };
    let Some(NumberedText { text, notes }) = numbered_words(text, budget)? else {
        return Err(first_fault);
    };
    // An error in the original text is more useful than one in the converted text.
    let Ok(table) = read_table(&text, budget) else {
        return Err(first_fault);
    };
    let mut columns = table_columns(table);
    columns.notes.extend(notes);
    Ok(columns)
}

/// Returns the columns in a text table; unnamed columns are numbered.
fn table_columns(table: TextTable) -> Columns {
    let named = table.names.is_some();
    let names = table.names.unwrap_or_default();
    let mut notes = table.notes;
    let mut values_of_columns = table.columns;
    if !named {
        remove_numbering(&mut values_of_columns, &mut notes);
    }
    let mut columns = Vec::with_capacity(values_of_columns.len());
    for (index, values) in values_of_columns.into_iter().enumerate() {
        let name = match names.get(index) {
            Some(name) if !name.is_empty() => name.clone(),
            _ => format!("column {}", index + 1),
        };
        columns.push(RecordColumn {
            unit: table.units.get(index).cloned().flatten(),
            ..RecordColumn::new(name, values)
        });
    }
    Columns {
        named,
        notes,
        ..Columns::new(String::new(), columns)
    }
}

/// Removes a first line that numbers the columns (1, 2, 3, …), and adds a note; not in a table with
/// at most [`FEW_COLUMNS`] columns.
fn remove_numbering(columns: &mut [Vec<f64>], notes: &mut Vec<ReadingNote>) {
    let is_numbering = columns
        .iter()
        .enumerate()
        .all(|(index, values)| values.first() == Some(&(index as f64 + 1.0)));
    if !is_numbering || columns.len() <= FEW_COLUMNS {
        return;
    }
    for values in columns {
        values.remove(0);
    }
    notes.push(ReadingNote::ColumnNumbers);
}
