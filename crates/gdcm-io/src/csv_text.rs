//! Tables as comma-separated values (RFC 4180). A [`Table`] holds only strings; its headings
//! contain the units.

use std::io;
use std::io::Write;
use std::path::Path;

use gdcm_model::message_text::sanitized;
use gdcm_model::units::without_sign_of_zero;
use gdcm_words::table::Table;

use crate::file_error::FileError;
use crate::output_set::OutputSet;

/// Writes equally long records, one per line; each cell passes through [`safe_cell`].
pub(crate) fn write_records<R>(
    file: &mut dyn Write,
    records: impl Iterator<Item = R>,
) -> io::Result<()>
where
    R: IntoIterator,
    R::Item: AsRef<str>,
{
    let mut table = csv::Writer::from_writer(file);
    for record in records {
        let cells = record.into_iter().map(|cell| safe_cell(cell.as_ref()));
        table.write_record(cells).map_err(io_error)?;
    }
    table.flush()
}

/// Returns the system error inside a CSV writer's error, so that causes such as a full disk are
/// reported as such.
fn io_error(error: csv::Error) -> io::Error {
    match error.into_kind() {
        csv::ErrorKind::Io(error) => error,
        _ => io::ErrorKind::InvalidData.into(),
    }
}

/// Returns a cell that no spreadsheet interprets as a formula, and no terminal as a command.
///
/// A string that begins with `=`, `+`, `-` or `@` and is not a number is preceded by an apostrophe;
/// control characters and invisible characters become escape sequences. Numbers have the ASCII
/// minus, and zero has no sign. A lone dash, which marks a missing value, is unchanged.
pub(crate) fn safe_cell(cell: &str) -> String {
    let number = cell.replacen('\u{2212}', "-", 1);
    if number.parse::<f64>().is_ok() {
        return without_sign_of_zero(&number).to_owned();
    }
    let is_formula = cell.len() > 1 && cell.starts_with(['=', '+', '-', '@']);
    if is_formula {
        format!("'{}", sanitized(cell))
    } else {
        sanitized(cell)
    }
}

/// Writes tables: a single table as headings and rows; several tables one after another, each under
/// a line with its title, separated by an empty line.
pub(crate) fn write_tables(file: &mut dyn Write, tables: &[Table]) -> io::Result<()> {
    for (index, table) in tables.iter().enumerate() {
        if tables.len() > 1 {
            if index > 0 {
                file.write_all(b"\n")?;
            }
            write_records(file, std::iter::once([&table.title]))?;
        }
        write_records(file, std::iter::once(&table.columns).chain(&table.rows))?;
    }
    Ok(())
}

/// Returns tables as comma-separated values, for the clipboard.
pub fn csv_text(tables: &[Table]) -> String {
    let mut text = Vec::new();
    // Writing to a vector cannot fail.
    let _ = write_tables(&mut text, tables);
    String::from_utf8_lossy(&text).into_owned()
}

/// Writes tables as CSV. `outputs` determines whether an existing file is kept or replaced.
pub fn save_tables(tables: &[Table], path: &Path, mut outputs: OutputSet) -> Result<(), FileError> {
    outputs.add(path, |file| write_tables(file, tables))?;
    outputs.persist()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::output_set::Existing;

    fn table(title: &str) -> Table {
        let mut table = Table::new(title, ["model", "J [-]"]);
        table.row(["V+5kt, again", "1.5"]);
        table
    }

    #[test]
    fn one_table_is_headings_and_rows() {
        assert_eq!(
            csv_text(&[table("left out")]),
            "model,J [-]\n\"V+5kt, again\",1.5\n"
        );
    }

    #[test]
    fn no_cell_is_a_formula_or_a_command_and_numbers_stay() {
        for (cell, written) in [
            ("=cmd|' /C calc'!A0", "'=cmd|' /C calc'!A0"),
            ("@SUM(1+1)", "'@SUM(1+1)"),
            ("-roll", "'-roll"),
            ("+5 kt", "'+5 kt"),
            ("-1.5e-3", "-1.5e-3"),
            ("+2", "+2"),
            ("\u{2212}2.5", "-2.5"),
            ("-", "-"),
            ("\u{1b}]0;evil\u{7}", "\\u{1b}]0;evil\\u{7}"),
            ("\t=1", "\\t=1"),
            ("Δφ – 5", "Δφ – 5"),
        ] {
            assert_eq!(safe_cell(cell), written);
        }
        let mut table = Table::new("=title", ["=1+1"]);
        table.row(["@x"]);
        assert_eq!(
            csv_text(&[table.clone(), table])
                .lines()
                .filter(|line| line.starts_with('\''))
                .count(),
            6
        );
    }

    #[test]
    fn several_tables_are_written_under_their_titles() {
        let text = csv_text(&[table("first, of two"), table("second")]);
        let lines: Vec<&str> = text.lines().collect();
        assert_eq!(lines[0], "\"first, of two\"");
        assert_eq!(lines[3..6], ["", "second", "model,J [-]"]);
    }

    #[test]
    fn a_table_is_written_whole_and_over_nothing_that_is_there() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("table.csv");
        save_tables(
            &[table("")],
            &path,
            OutputSet::new(Existing::Keep, Vec::new()),
        )
        .unwrap();
        assert_eq!(
            std::fs::read_to_string(&path).unwrap(),
            "model,J [-]\n\"V+5kt, again\",1.5\n"
        );
        let again = save_tables(
            &[table("")],
            &path,
            OutputSet::new(Existing::Keep, Vec::new()),
        );
        assert!(matches!(again, Err(FileError::Exists { .. })));
    }
}
