//! Figures as files: SVG, PNG, PDF, and their data as CSV, with a row for each point. The bytes
//! depend only on the figure and its width.

use std::io::{self, Write};
use std::iter::once;
use std::path::Path;

use gdcm_plot::figure::tables::LONG_COLUMNS;
use gdcm_plot::figure::{ColumnWidth, Figure, FigureFormat};
use gdcm_plot::paper::{pdf, svg, write_png};

use crate::csv_text::write_records;
use crate::file_error::FileError;
use crate::output_set::OutputSet;

/// Returns the figure format that a file extension selects.
///
/// # Errors
/// [`FileError::FigureFormat`] for an unknown extension.
pub fn figure_format(path: &Path) -> Result<FigureFormat, FileError> {
    let extension = path
        .extension()
        .and_then(|extension| extension.to_str())
        .unwrap_or_default()
        .to_lowercase();
    for format in FigureFormat::ALL {
        if format.extension() == extension {
            return Ok(format);
        }
    }
    Err(FileError::FigureFormat {
        path: path.to_owned(),
    })
}

/// Writes a figure to a file; the file extension selects the format.
///
/// # Errors
/// [`FileError::FigureFormat`] for an unknown extension, [`FileError::FigureWithoutNumbers`] if CSV
/// is requested for a figure without data; otherwise the error that prevents writing.
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

/// Writes a figure in the format `format`, whatever the file extension. CSV follows RFC 4180.
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

#[cfg(test)]
mod tests {
    use gdcm_plot::figure::axis::Axis;
    use gdcm_plot::figure::drawing::Stroke;
    use gdcm_plot::figure::figure::{Curve, Plot};
    use gdcm_plot::figure::{Color, Panel};

    use super::*;
    use crate::output_set::Existing;

    /// Returns a figure with a curve whose name contains control codes: a terminal would show it in
    /// red and hide the text that follows.
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
            matches!(
                &refusal,
                FileError::FigureWithoutNumbers { title, .. } if title == "Error of LON → Q"
            ),
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
