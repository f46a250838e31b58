//! Figures as files: SVG, PNG, PDF, and their numbers as CSV. The same figure makes the same bytes.

use std::io::{self, Write};
use std::iter::once;
use std::path::Path;

use gdcm_model::message_text::sanitized;
use gdcm_model::units::without_sign_of_zero;
use gdcm_plot::figure::tables::LONG_COLUMNS;
use gdcm_plot::figure::{ColumnWidth, Figure, FigureFormat};
use gdcm_plot::paper::{pdf, svg, write_png};
use gdcm_words::Table;

use crate::file_error::FileError;
use crate::output_set::OutputSet;

/// Returns the format given by a file extension.
///
/// # Errors
/// [`FileError::FigureFormat`] for an unknown extension.
pub fn figure_format(path: &Path) -> Result<FigureFormat, FileError> {
    let extension = path
        .extension()
        .and_then(|extension| extension.to_str())
        .unwrap_or_default()
        .to_lowercase();
    let found = FigureFormat::ALL
        .into_iter()
        .find(|format| format.extension() == extension);
    found.ok_or_else(|| FileError::FigureFormat {
        path: path.to_owned(),
    })
}

/// Writes a figure to a file, in the format of its extension.
///
/// # Errors
/// [`FileError::FigureWithoutNumbers`] if CSV is requested for a figure without numbers; otherwise
/// the error that prevents writing.
pub fn write_figure(
    figure: &Figure,
    width: ColumnWidth,
    path: &Path,
    mut outputs: OutputSet,
) -> Result<(), FileError> {
    let format = figure_format(path)?;
    if format == FigureFormat::Csv && figure.long_rows().next().is_none() {
        return Err(FileError::FigureWithoutNumbers {
            path: path.to_owned(),
            title: figure.title.clone(),
        });
    }
    outputs.add(path, |file| write_as(figure, width, format, file))?;
    outputs.persist()
}

/// Writes a figure in the given format.
pub fn write_as(
    figure: &Figure,
    width: ColumnWidth,
    format: FigureFormat,
    file: &mut dyn Write,
) -> io::Result<()> {
    match format {
        FigureFormat::Svg => file.write_all(svg(&figure.drawing(width)).as_bytes()),
        FigureFormat::Png => write_png(&figure.drawing(width), file),
        FigureFormat::Pdf => file.write_all(&pdf(&figure.drawing(width))?),
        FigureFormat::Csv => write_records(
            file,
            once(LONG_COLUMNS.map(str::to_owned)).chain(figure.long_rows()),
        ),
    }
}

// Comma-separated values (RFC 4180).

/// Writes records of equal length, one per line; each cell is a [`plain`] one.
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
        // Unwrapped, so that a full disk is reported as such.
        let cells = record.into_iter().map(|cell| plain(cell.as_ref()));
        table
            .write_record(cells)
            .map_err(|error| match error.into_kind() {
                csv::ErrorKind::Io(error) => error,
                _ => io::ErrorKind::InvalidData.into(),
            })?;
    }
    table.flush()
}

/// Returns a cell that no spreadsheet takes for a formula, and no terminal for a command: a text
/// that begins with `=`, `+`, `-` or `@` and is not a number is preceded by an apostrophe; control
/// and invisible characters are spelled out. Numbers have the ASCII minus that programs read, and a
/// lone dash marks a missing value. A zero has no sign.
fn plain(cell: &str) -> String {
    let number = cell.replacen('\u{2212}', "-", 1);
    if number.parse::<f64>().is_ok() {
        return without_sign_of_zero(&number).to_owned();
    }
    let is_formula = cell.len() > 1 && cell.starts_with(['=', '+', '-', '@']);
    format!("{}{}", if is_formula { "'" } else { "" }, sanitized(cell))
}

/// Writes tables: a single table as headings and rows; several one after another, each under a line
/// with its title, separated by an empty line.
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

/// Writes tables as CSV: the headings of each, then a line for each row. Existing files are kept or
/// replaced according to `outputs`.
pub fn save_tables(tables: &[Table], path: &Path, mut outputs: OutputSet) -> Result<(), FileError> {
    outputs.add(path, |file| write_tables(file, tables))?;
    outputs.persist()
}

#[cfg(test)]
mod tests {
    use gdcm_plot::figure::axis::Axis;
    use gdcm_plot::figure::drawing::Stroke;
    use gdcm_plot::figure::figure::{Curve, Plot};
    use gdcm_plot::figure::{Color, Panel};

    use super::*;
    use crate::output_set::Existing;

    /// Returns a figure with the curve of a model whose name would turn a terminal red and hide the
    /// text that follows.
    fn named_by_codes() -> Figure {
        let name = "\u{1b}[31mred\u{9b}31m\u{202e}";
        let curve =
            Curve::new(name, Stroke::solid(Color::INK, 1.0), [1.0, 2.0], [3.0, 4.0]).key(name);
        let panel = Panel::new(Axis::linear("x"), Axis::linear("y")).with(curve);
        Figure::new(name)
            .caption(name)
            .plot(Plot::new(name).panel(panel))
    }

    #[test]
    fn codes_in_names_are_spelt_out_on_paper_and_among_the_numbers() {
        for format in [FigureFormat::Svg, FigureFormat::Csv] {
            let mut bytes = Vec::new();
            write_as(&named_by_codes(), ColumnWidth::Single, format, &mut bytes).unwrap();
            let text = String::from_utf8(bytes).unwrap();
            assert!(
                text.contains("\\u{1b}[31mred\\u{9b}31m\\u{202e}"),
                "{format:?}"
            );
            assert!(
                !text
                    .contains(|c: char| (c.is_control() && !"\r\n".contains(c)) || c == '\u{202e}'),
                "{format:?}"
            );
        }
    }

    #[test]
    fn numbers_of_a_figure_that_shows_none_are_refused_and_no_file_is_left() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("empty.csv");
        let panel = Panel::new(Axis::linear("x"), Axis::linear("y"));
        let figure = Figure::new("Error of LON → Q").plot(Plot::new("").panel(panel));
        let refusal = write_figure(
            &figure,
            ColumnWidth::Single,
            &path,
            OutputSet::new(Existing::Keep, Vec::new()),
        )
        .unwrap_err();
        assert!(
            refusal
                .to_string()
                .contains("\"Error of LON → Q\" shows no numbers"),
            "{refusal}"
        );
        assert!(!path.exists());
        let drawn = folder.path().join("empty.svg");
        write_figure(
            &figure,
            ColumnWidth::Single,
            &drawn,
            OutputSet::new(Existing::Keep, Vec::new()),
        )
        .unwrap();
        assert!(drawn.exists());
    }
}

#[cfg(test)]
mod csv_tests {
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
            assert_eq!(plain(cell), written);
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
    fn several_tables_stand_under_their_titles() {
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
