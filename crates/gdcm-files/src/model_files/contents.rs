//! What a file holds, before anything is recognised in it.

use std::path::Path;

use crate::dataset_file::{DatasetOrigin, load_dataset_bytes};
use crate::file_error::FileError;
use crate::mat::{self, Subsystem};
use crate::mat73::{self, FileWrapper, ObjectDecoder};
use crate::npy::{read_npy, read_npz};
use crate::outline::Outline;
use crate::source::Source;
use crate::text::{TextTable, decode, read_literals, read_matrices, read_table};
use crate::variables::{MemoryBudget, Value, Variable, VariableFault};
use gdcm_core::dataset::Dataset;

use super::format::FileFormat;
use super::json_value::variables_of;
use super::loose_matrices::matrix_letter;

/// What a file holds.
pub(crate) enum Contents {
    /// Values under names.
    Variables {
        /// They.
        variables: Vec<Variable>,
        /// How they were read, where that is not plain.
        notes: Vec<String>,
    },
    /// Numbers in columns.
    Table(Box<TextTable>),
    /// A dataset of this program.
    Dataset(Box<Dataset>),
}

/// What the bytes of a file hold.
pub(crate) fn contents_of(bytes: &[u8], path: &Path, meter: &MemoryBudget<'_>) -> Result<Contents, FileError> {
    let wrong = |fault| FileError::Variables { path: path.to_owned(), fault };
    let plain = |variables| Contents::Variables { variables, notes: Vec::new() };
    match FileFormat::of(bytes, path) {
        FileFormat::Mat => mat::read(bytes, meter).map(plain).map_err(wrong),
        FileFormat::Hdf5 => mat73::read_with_objects(bytes, meter, decoder).map(plain).map_err(wrong),
        FileFormat::Npz => read_npz(bytes, meter).map(plain).map_err(wrong),
        FileFormat::Npy => read_npy(bytes, stem(path), meter).map(plain).map_err(wrong),
        FileFormat::Json => json_contents(bytes, path),
        FileFormat::Literals => {
            let text = decode(bytes, meter).map_err(wrong)?.text;
            let literals = read_literals(&text, meter).map_err(wrong)?;
            Ok(Contents::Variables { variables: literals.variables, notes: literals.notes })
        }
        FileFormat::Text => {
            let text = decode(bytes, meter).map_err(wrong)?.text;
            text_contents(&text, path, meter).map_err(wrong)
        }
    }
}

/// The objects of a file of version 7.3, which lie in it as in the files before.
fn decoder(wrapper: FileWrapper) -> Result<Box<ObjectDecoder<'static>>, VariableFault> {
    let subsystem = Subsystem::new(wrapper.cells)?.with_long_words(wrapper.long_words);
    Ok(Box::new(move |reference: &[u32], variable: &str, meter: &MemoryBudget<'_>| -> Result<Value, VariableFault> {
        subsystem.object(reference, variable, meter)
    }))
}

fn json_contents(bytes: &[u8], path: &Path) -> Result<Contents, FileError> {
    let source = Source::of(bytes, path)?;
    if Outline::format_of(source.text()).as_deref() == Some("\"gdcm-dataset\"") {
        let loaded = load_dataset_bytes(bytes, DatasetOrigin::File(path.to_owned()))?;
        return Ok(Contents::Dataset(Box::new(loaded.dataset.as_ref().clone())));
    }
    let variables =
        variables_of(source.text()).map_err(|fault| FileError::Variables { path: path.to_owned(), fault })?;
    Ok(Contents::Variables { variables, notes: Vec::new() })
}

/// A matrix where the file is named as one, matrices under names where there are some, else a table.
fn text_contents(text: &str, path: &Path, meter: &MemoryBudget<'_>) -> Result<Contents, VariableFault> {
    if let Some((letter, _)) = matrix_letter(stem(path)) {
        let variable = crate::text::read_matrix(text, &letter.to_string(), meter)?;
        return Ok(Contents::Variables { variables: vec![variable], notes: Vec::new() });
    }
    let looks_named = text.lines().take(50).any(|line| {
        let line = line.trim().trim_end_matches(['=', ':', '[']).trim_end();
        matches!(line, "A" | "B" | "C" | "D")
    });
    if looks_named && let Ok(matrices) = read_matrices(text, meter) {
        return Ok(Contents::Variables { variables: matrices.variables, notes: matrices.notes });
    }
    read_table(text, meter).map(|table| Contents::Table(Box::new(table)))
}

fn stem(path: &Path) -> &str {
    path.file_stem().and_then(|stem| stem.to_str()).unwrap_or_default()
}
