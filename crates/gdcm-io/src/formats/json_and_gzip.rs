//! Importer for JSON and gzip-compressed files.
//!
//! JSON is read as a dataset or as models if its member "format" names a format of this program,
//! otherwise as variables. Any other gzip-compressed content is passed to the importer for its
//! format.

use std::path::Path;

use crate::file_error::FileError;
use crate::file_reading::{Source, text_of, without_mark};
use crate::files::dataset_file::{DatasetOrigin, dataset_from};
use crate::files::model_collection::found_models;
use crate::formats::json_values::read_variables;
use crate::formats::{Contents, Importer, importer_of};
use crate::gzip::GZIP_MAGIC;
use crate::json_outline::Outline;
use crate::reading_budget::ReadingBudget;

/// Importer for JSON, and for any gzip-compressed file.
pub(crate) const JSON: Importer = Importer {
    name: "JSON",
    endings: &["json", "gz"],
    recognises: |bytes, ending| {
        bytes.starts_with(&GZIP_MAGIC)
            || ending == "json"
            || bytes.trim_ascii_start().first() == Some(&b'{')
    },
    read: read_json,
};

/// Reads JSON as a dataset or as models if its member "format" names one of these (as models only
/// if `found_models` accepts them), otherwise as variables; passes on gzip-compressed content that
/// does not begin like JSON.
fn read_json(bytes: &[u8], path: &Path, budget: &ReadingBudget<'_>) -> Result<Contents, FileError> {
    let text = text_of(bytes, path, budget)?;
    let text = without_mark(&text);
    let is_packed = bytes.starts_with(&GZIP_MAGIC);
    if is_packed && !matches!(text.trim_ascii_start().first(), Some(b'{' | b'[')) {
        return read_unpacked(text, path, budget);
    }
    let format = Outline::format_of(text, budget);
    budget
        .work(text.len() as u64, "")
        .map_err(|fault| FileError::variables(path, fault))?;
    match format.as_deref() {
        Some("\"gdcm-dataset\"") => {
            // Pass on the bytes as stored: `Source::from_bytes` hashes and, if necessary,
            // decompresses them.
            let source = Source::from_bytes(bytes, path, budget)?;
            let loaded = dataset_from(&source, DatasetOrigin::File(path.to_owned()), budget)?;
            let dataset = loaded.dataset.as_ref().clone();
            return Ok(Contents::Dataset(Box::new(dataset), loaded.cautions));
        }
        Some("\"gdcm-models\"" | "\"gdcm-identified\"") => {
            if let Some((models, unknown)) = found_models(text, path, budget) {
                return Ok(Contents::Models(models, unknown));
            }
        }
        _ => {}
    }
    Contents::row_major(read_variables(text, budget), path)
}

/// Reads decompressed content that does not begin like a JSON object or list, in the format given
/// by the content and by the file name without ".gz".
fn read_unpacked(
    text: &[u8],
    path: &Path,
    budget: &ReadingBudget<'_>,
) -> Result<Contents, FileError> {
    let importer = importer_of(text, &path.with_extension(""));
    if importer.name == JSON.name {
        Contents::row_major(read_variables(text, budget), path)
    } else {
        (importer.read)(text, path, budget)
    }
}
