//! Models in files of whatever format: MATLAB, NumPy, JSON, text.
//!
//! ```text
//! bytes -> format, by what they begin with                      (never by the name alone)
//!       -> variables, or a table of columns                     (mat, mat73, npy, text, JSON)
//!       -> models                                               (recognise)
//! folder -> files -> models; matrices in files of their own go together by name: A.csv, B.csv, C.csv, D.csv
//! ```

pub(crate) mod folder;
mod found;

use std::path::Path;

use gdcm_core::assembly::{FoundModel, Headings};
use gdcm_core::dataset::{Dataset, Provenance};
use serde_json::Value as Json;
use sha2::{Digest, Sha256};

use crate::dataset_file::{DatasetOrigin, load_dataset_bytes};
use crate::file_error::FileError;
use crate::location::Outline;
use crate::mat::{self, Subsystem, is_hdf5};
use crate::mat73::{self, FileWrapper, ObjectDecoder};
use crate::model_files::found::{LooseMatrix, matrix_letter, models_of_dataset, models_of_matrices, models_of_table};
use crate::models_file::found_models;
use crate::npy::{read_npy, read_npz};
use crate::recognise::{Recognised, recognise};
use crate::source::{Source, read_bytes};
use crate::text::{TextTable, decode, read_literals, read_matrices, read_table};
use crate::variables::{
    Array, CellArray, ElementKind, MemoryBudget, StructArray, TextArray, Value, Variable, VariableFault,
};

pub use folder::{FolderProgress, read_models, sources_folder};

/// Memory that the variables of one file may take \[bytes\].
const MOST_MEMORY: u64 = 1 << 30;
/// Largest file of models \[bytes\].
const LARGEST_FILE: u64 = 512 << 20;

/// What was found in files.
#[derive(Clone, Debug, Default)]
pub struct FoundModels {
    /// The models, in the order of their files.
    pub models: Vec<FoundModel>,
    /// What could not be taken: files, and what looks like a model in them, each with its place and why.
    pub faults: Vec<String>,
    /// What is no model, in words.
    pub passed_over: Vec<String>,
    /// The tables of columns among the files, with the headings that they were read by.
    pub tables: Headings,
    /// Number of files that were read.
    pub files: usize,
}

/// What one file holds.
#[derive(Default)]
struct FileModels {
    recognised: Recognised,
    /// A matrix that has a file to itself.
    loose: Option<LooseMatrix>,
    /// The headings of a table of columns.
    headings: Option<Vec<String>>,
}

/// The models in the bytes of a file of this name, in no more than `most` bytes of memory for its variables.
pub fn models_of_bytes(bytes: &[u8], name: &str, most: u64) -> Result<FoundModels, FileError> {
    let found = of_bytes(bytes, Path::new(name), (name, None), &MemoryBudget::new(most, &|_| false))?;
    let Recognised { mut models, mut faults, passed_over } = found.recognised;
    let of_matrices = models_of_matrices(found.loose.into_iter().collect());
    models.extend(of_matrices.models);
    faults.extend(of_matrices.faults);
    let tables = found.headings.map(|headings| (name.to_owned(), headings)).into_iter().collect();
    Ok(FoundModels { models, faults, passed_over, tables, files: 1 })
}

/// The models of one file; its name is how the dataset calls it, relative to what was asked for, and its headings are those said of
/// its columns.
fn read_file(
    path: &Path,
    named: (&str, Option<&Vec<String>>),
    stop: &dyn Fn(u64) -> bool,
) -> Result<FileModels, FileError> {
    let bytes = read_bytes(path, LARGEST_FILE)?;
    of_bytes(&bytes, path, named, &MemoryBudget::new(MOST_MEMORY, stop))
}

fn of_bytes(
    bytes: &[u8],
    path: &Path,
    (name, headings): (&str, Option<&Vec<String>>),
    meter: &MemoryBudget<'_>,
) -> Result<FileModels, FileError> {
    let wrong = |fault| FileError::Variables { path: path.to_owned(), fault };
    let mut found = match contents_of(bytes, path, meter)? {
        Contents::Variables { variables, notes } => of_variables(&variables, notes, name),
        Contents::Table(table) => {
            let table = match headings {
                Some(said) => table.with_headings(said).map_err(wrong)?,
                None => *table,
            };
            let recognised = models_of_table(&table, name).map_err(wrong)?;
            FileModels { recognised, headings: Some(table.headings()), ..FileModels::default() }
        }
        Contents::Models(models) => {
            FileModels { recognised: Recognised { models, ..Recognised::default() }, ..FileModels::default() }
        }
        Contents::Dataset(dataset) => {
            let recognised = Recognised { models: models_of_dataset(&dataset, name), ..Recognised::default() };
            FileModels { recognised, ..FileModels::default() }
        }
    };
    let sha256: String = Sha256::digest(bytes).iter().map(|byte| format!("{byte:02x}")).collect();
    for model in &mut found.recognised.models {
        let source = model.draft.source.get_or_insert_with(Provenance::default);
        source.file = Some(name.to_owned());
        source.sha256 = Some(sha256.clone());
        source.note = Some(model.notes.join("; ")).filter(|note| !note.is_empty());
    }
    if let Some(loose) = &mut found.loose {
        loose.sha256 = sha256;
    }
    Ok(found)
}

fn of_variables(variables: &[Variable], notes: Vec<String>, name: &str) -> FileModels {
    if let Some(loose) = LooseMatrix::of(variables, name) {
        return FileModels { loose: Some(loose), ..FileModels::default() };
    }
    let mut recognised = recognise(variables);
    for model in &mut recognised.models {
        model.notes.extend(notes.iter().cloned());
    }
    FileModels { recognised, ..FileModels::default() }
}

// What a file holds, before anything is recognised in it.

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
    /// Models of this program.
    Models(Vec<FoundModel>),
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
    if let Some(models) = found_models(source.text(), path) {
        return Ok(Contents::Models(models));
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

// What a file is, by what it begins with.

/// The format of a file that may hold models.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FileFormat {
    /// MATLAB up to version 7.
    Mat,
    /// MATLAB 7.3, and HDF5.
    Hdf5,
    /// One array of NumPy.
    Npy,
    /// Several arrays of NumPy, or another zip archive.
    Npz,
    /// JSON, packed or not.
    Json,
    /// MATLAB's language.
    Literals,
    /// Numbers in columns, or a matrix.
    Text,
}

impl FileFormat {
    /// The format of bytes in a file of this name; the name decides only between texts.
    pub fn of(bytes: &[u8], path: &Path) -> Self {
        let extension =
            path.extension().map(|extension| extension.to_string_lossy().to_lowercase()).unwrap_or_default();
        let first = bytes.iter().find(|byte| !byte.is_ascii_whitespace()).copied();
        match bytes {
            [0x93, b'N', b'U', b'M', b'P', b'Y', ..] => Self::Npy,
            [b'P', b'K', 3 | 5, ..] => Self::Npz,
            [0x1f, 0x8b, ..] => Self::Json,
            _ if is_hdf5(bytes) => Self::Hdf5,
            _ if extension == "mat" => Self::Mat,
            _ if is_level_5(bytes) => Self::Mat,
            _ if extension == "json" || first == Some(b'{') => Self::Json,
            _ if extension == "m" => Self::Literals,
            _ => Self::Text,
        }
    }
}

/// The mark of the byte order at the end of the header of levels 5 to 7 ("MAT-File Format", The MathWorks).
fn is_level_5(bytes: &[u8]) -> bool {
    matches!(bytes.get(126..128), Some(b"IM" | b"MI")) && matches!(bytes.get(124..126), Some([0, 1] | [1, 0]))
}

// JSON of any shape as variables.

/// Longest text that is taken as JSON of any shape \[bytes\]: as a tree it takes many times that.
const LONGEST: usize = 32 << 20;

/// The members of a JSON object, or a list under the name "models".
pub(crate) fn variables_of(text: &[u8]) -> Result<Vec<Variable>, VariableFault> {
    if text.len() > LONGEST {
        return Err(VariableFault::TooLarge { variable: String::new(), most_mib: (LONGEST >> 20) as u64 });
    }
    let json: Json = serde_json::from_slice(text).map_err(|error| VariableFault::Line {
        variable: String::new(),
        line: error.line(),
        what: format!("this is not JSON: {error}"),
    })?;
    Ok(match json {
        Json::Object(members) => {
            members.iter().map(|(name, value)| Variable { name: name.clone(), value: value_of(value) }).collect()
        }
        other => vec![Variable { name: "models".to_owned(), value: value_of(&other) }],
    })
}

fn value_of(json: &Json) -> Value {
    match json {
        Json::Null => Value::Array(Array::matrix(0, 0, Vec::new())),
        Json::Bool(flag) => {
            Value::Array(Array { kind: ElementKind::Logical, ..Array::matrix(1, 1, vec![f64::from(u8::from(*flag))]) })
        }
        Json::Number(number) => Value::Array(Array::matrix(1, 1, vec![number.as_f64().unwrap_or(f64::NAN)])),
        Json::String(text) => Value::Text(TextArray { shape: vec![1, 1], texts: vec![text.clone()] }),
        Json::Array(list) => list_of(list),
        Json::Object(members) => {
            let fields = members.iter().map(|(name, value)| (name.clone(), vec![value_of(value)])).collect();
            Value::Struct(StructArray { shape: vec![1, 1], fields })
        }
    }
}

/// Numbers in lists are an array (row by row), texts in a list an array of texts; anything else is a cell array.
fn list_of(list: &[Json]) -> Value {
    if let Some(texts) = list.iter().map(|item| item.as_str().map(str::to_owned)).collect::<Option<Vec<String>>>()
        && !texts.is_empty()
    {
        return Value::Text(TextArray { shape: vec![1, texts.len()], texts });
    }
    if let Some(array) = numbers_of(list) {
        return Value::Array(array);
    }
    Value::Cell(CellArray { shape: vec![1, list.len()], values: list.iter().map(value_of).collect() })
}

fn numbers_of(list: &[Json]) -> Option<Array> {
    let mut shape = vec![list.len()];
    let mut inner = list;
    while let Some(Json::Array(next)) = inner.first() {
        shape.push(next.len());
        inner = next;
    }
    if shape.len() > 3 {
        return None;
    }
    let mut values = Vec::new();
    flatten(list, &shape, &mut values)?;
    Some(match shape.as_slice() {
        [count] => Array::matrix(1, *count, values),
        _ => Array { shape: shape.clone(), kind: ElementKind::Float, re: column_major(&values, &shape), im: None },
    })
}

/// Appends the numbers of a rectangular list; nothing where it is not one.
fn flatten(list: &[Json], shape: &[usize], values: &mut Vec<f64>) -> Option<()> {
    let (count, rest) = shape.split_first()?;
    if list.len() != *count {
        return None;
    }
    for item in list {
        match (item, rest) {
            (Json::Array(inner), [_, ..]) => flatten(inner, rest, values)?,
            (Json::Number(number), []) => values.push(number.as_f64()?),
            _ => return None,
        }
    }
    Some(())
}

/// From the last index running fastest to the first one running fastest.
fn column_major(values: &[f64], shape: &[usize]) -> Vec<f64> {
    let (rows, columns, pages) = (shape[0], shape[1], shape.get(2).copied().unwrap_or(1));
    let mut turned = Vec::with_capacity(values.len());
    for page in 0..pages {
        for column in 0..columns {
            turned.extend((0..rows).map(|row| values[(row * columns + column) * pages + page]));
        }
    }
    turned
}

#[cfg(test)]
mod format_tests {
    use super::*;

    #[test]
    fn a_file_is_what_it_begins_with_whatever_it_is_called() {
        let of = |bytes: &[u8], name: &str| FileFormat::of(bytes, Path::new(name));
        assert_eq!(of(b"\x93NUMPY\x01\x00", "a.mat"), FileFormat::Npy);
        assert_eq!(of(b"PK\x03\x04", "a.txt"), FileFormat::Npz);
        assert_eq!(of(b"\x89HDF\r\n\x1a\n", "a.mat"), FileFormat::Hdf5);
        assert_eq!(of(b" {\"A\": 1}", "a.txt"), FileFormat::Json);
        assert_eq!(of(b"A = [1 2];", "a.m"), FileFormat::Literals);
        assert_eq!(of(b"1,2\n3,4\n", "a.csv"), FileFormat::Text);
        let header = [&[b'M'; 124][..], &[0, 1, b'I', b'M']].concat();
        assert_eq!(of(&header, "no extension"), FileFormat::Mat);
    }
}

#[cfg(test)]
mod json_value_tests {
    use super::*;

    #[test]
    fn nested_lists_of_numbers_are_arrays_and_ragged_ones_are_not() {
        let of = |text: &str| value_of(&serde_json::from_str(text).unwrap());
        assert_eq!(of("[[1, 2, 3], [4, 5, 6]]"), Value::Array(Array::matrix(2, 3, vec![1.0, 4.0, 2.0, 5.0, 3.0, 6.0])));
        assert!(matches!(of("[[1, 2], [3]]"), Value::Cell(_)));
        let Value::Array(cube) = of("[[[1, 2], [3, 4]]]") else { panic!("an array") };
        assert_eq!((cube.shape, cube.re), (vec![1, 2, 2], vec![1.0, 3.0, 2.0, 4.0]));
        assert!(matches!(of("[\"LON\", \"LAT\"]"), Value::Text(_)));
    }

    #[test]
    fn the_line_of_what_is_no_json_is_named() {
        let error = variables_of(b"{\"A\":\n [1,,2]}").unwrap_err();
        assert!(error.to_string().contains("line 2"), "{error}");
    }
}
