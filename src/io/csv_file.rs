//! Tables as comma-separated values (RFC 4180).

use std::path::Path;

use super::file_error::FileError;
use super::whole_file::write_whole;

/// Writes a header and rows.
pub(super) fn write_csv<const COLUMNS: usize>(
    path: &Path,
    header: &[&str; COLUMNS],
    rows: impl Iterator<Item = [String; COLUMNS]>,
) -> Result<(), FileError> {
    write_whole(path, |file| {
        let mut table = csv::Writer::from_writer(file);
        table.write_record(header)?;
        for row in rows {
            table.write_record(&row)?;
        }
        table.flush()
    })
}

/// A figure to the last digit; an empty cell where there is none, or none that is finite.
pub(super) fn cell(figure: Option<f64>) -> String {
    // Debug writes an exponent where Display would write hundreds of zeros.
    figure.filter(|figure| figure.is_finite()).map(|figure| format!("{figure:?}")).unwrap_or_default()
}
