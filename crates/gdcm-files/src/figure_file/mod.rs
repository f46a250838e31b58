//! Figures as files: SVG, PNG, PDF, and their numbers as CSV. The same figure makes the same bytes.

mod pdf;
mod png;
mod svg;

use std::io::{self, Write};
use std::path::Path;

use crate::figure::{ColumnWidth, Figure, FigureFormat};

use super::csv_table::write_tables;
use super::file_error::FileError;
use super::output_set::OutputSet;

pub(super) use svg::{escaped, inline_svg};

/// The format that the end of a file's name says.
///
/// # Errors
/// [`FileError::FigureFormat`] where it says none of those that there are.
pub fn figure_format(path: &Path) -> Result<FigureFormat, FileError> {
    let extension = path.extension().and_then(|extension| extension.to_str()).unwrap_or_default().to_lowercase();
    let found = FigureFormat::ALL.into_iter().find(|format| format.extension() == extension);
    found.ok_or_else(|| FileError::FigureFormat { path: path.to_owned() })
}

/// Writes a figure to a file, in the format that its name says.
pub fn write_figure(figure: &Figure, width: ColumnWidth, path: &Path, mut outputs: OutputSet) -> Result<(), FileError> {
    let format = figure_format(path)?;
    outputs.add(path, |file| write_as(figure, width, format, file))?;
    outputs.persist()
}

/// Writes a figure in a format.
pub fn write_as(figure: &Figure, width: ColumnWidth, format: FigureFormat, file: &mut dyn Write) -> io::Result<()> {
    match format {
        FigureFormat::Svg => file.write_all(svg::svg(&figure.drawing(width)).as_bytes()),
        FigureFormat::Png => png::write_png(&figure.drawing(width), file),
        FigureFormat::Pdf => file.write_all(&pdf::pdf(&figure.drawing(width))?),
        FigureFormat::Csv => write_tables(file, &figure.tables()),
    }
}
