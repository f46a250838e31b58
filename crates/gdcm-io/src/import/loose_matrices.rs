//! Models whose matrices are in separate files: `nominal_A.csv`, `nominal_B.csv`, ...
//!
//! 1. Each file with a single array and a matrix letter at the end of its name is a loose matrix.
//! 2. When all files have been read, loose matrices whose file names agree but for the letter form
//!    a group.
//! 3. Each group is recognised as if its matrices were the variables of one file.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use gdcm_model::assembly::FoundModel;
use gdcm_model::dataset::model::Provenance;
use gdcm_model::message_text::sanitized_path;

use super::recognise::recognition_fault::{FoundFault, RecognitionFault};
use super::recognise::{Found, recognise};
use crate::formats::reading_note::{ReadingNote, note_texts};
use crate::formats::variables::{PageIndex, Value, Variable};
use crate::formats::with_file_name;
use crate::reading_budget::ReadingBudget;

/// The matrices of a state-space model, `E x' = A x + B u`, `y = C x + D u`; E only in descriptor
/// form.
pub(super) const MATRIX_LETTERS: [char; 5] = ['A', 'B', 'C', 'D', 'E'];
/// Characters that may separate the matrix letter from the rest of a file name.
const SEPARATORS: [char; 4] = ['_', '-', '.', ' '];

/// A file's path, name and hash. For a file in an archive, the path in the archive and the archive's
/// hash.
#[derive(Clone, Copy)]
pub(super) struct FileIdentity<'f> {
    pub(super) path: &'f Path,
    pub(super) name: &'f str,
    pub(super) sha256: &'f str,
}

/// Variables as read from a file.
#[derive(Clone, Copy)]
pub(super) struct FileVariables<'v> {
    pub(super) variables: &'v [Variable],
    /// Remarks on how the file was read.
    pub(super) notes: &'v [ReadingNote],
    /// Index that selects a matrix in arrays with three dimensions.
    pub(super) page_index: PageIndex,
}

/// A matrix that is the only variable in its file.
pub(super) struct LooseMatrix {
    /// File path without the matrix letter, its separator and the extension:
    ///
    /// ```text
    /// A.csv         ->  .
    /// nom_A.csv     ->  nom
    /// c1/A.csv      ->  c1
    /// c1/nom_A.csv  ->  c1/nom
    /// ```
    ///
    /// The matrices in a group form a model, which rules and messages know by the group's name.
    /// Files such as `nom_A.csv` and `nom/A.csv` therefore share a group; a letter that occurs
    /// twice in a group is a fault.
    group: String,
    path: PathBuf,
    /// Path relative to the folder that is read.
    file: String,
    sha256: String,
    /// The matrix; its letter is the variable name.
    variable: Variable,
    notes: Vec<ReadingNote>,
    /// As in [`FileVariables`].
    page_index: PageIndex,
}

impl LooseMatrix {
    /// Takes the matrix from a file (step 1); `None` unless the only variable is an array and the
    /// file name ends in a matrix letter.
    pub(super) fn from_variables(
        read: FileVariables<'_>,
        identity: FileIdentity<'_>,
    ) -> Option<Self> {
        let [variable] = read.variables else {
            return None;
        };
        if !matches!(variable.value, Value::Array(_)) {
            return None;
        }
        let file = identity.name;
        let (folder, name) = file.rsplit_once('/').unwrap_or(("", file));
        let stem = match name.rsplit_once('.') {
            Some((stem, _)) => stem,
            None => name,
        };
        let (letter, before) = matrix_letter(stem)?;
        let group = match (folder, before) {
            ("", "") => ".".to_owned(),
            ("", before) => before.to_owned(),
            (folder, "") => folder.to_owned(),
            (folder, before) => format!("{folder}/{before}"),
        };
        Some(Self {
            group,
            path: identity.path.to_owned(),
            file: file.to_owned(),
            sha256: identity.sha256.to_owned(),
            variable: Variable {
                name: letter.to_string(),
                value: variable.value.clone(),
            },
            notes: read.notes.to_vec(),
            page_index: read.page_index,
        })
    }
}

/// Splits a file name without extension into the matrix letter at its end and the part before:
/// "nominal_A" is the matrix A of "nominal". `None` if the name does not end in a matrix letter, or
/// if the letter belongs to a word.
pub(super) fn matrix_letter(stem: &str) -> Option<(char, &str)> {
    let letter = stem.chars().last()?;
    if !MATRIX_LETTERS.contains(&letter) {
        return None;
    }
    let before = &stem[..stem.len() - letter.len_utf8()];
    if !before.is_empty() && !before.ends_with(SEPARATORS) {
        return None;
    }
    Some((letter, before.trim_end_matches(SEPARATORS)))
}

/// Builds a model from each group of matrices (step 2); the group is stated as the model's file.
pub(super) fn models_of_matrices(loose: Vec<LooseMatrix>) -> Found<FoundModel> {
    let mut groups: BTreeMap<String, Vec<LooseMatrix>> = BTreeMap::new();
    for matrix in loose {
        groups.entry(matrix.group.clone()).or_default().push(matrix);
    }
    let mut found = Found::default();
    for (group, matrices) in groups {
        let in_group = models_of_group(&group, &matrices);
        found.items.extend(in_group.items);
        found.faults.extend(in_group.faults);
    }
    found
}

/// Recognises the models that a group's matrices form (step 3). If recognition finds neither a
/// model nor a fault (a lone `A.csv`), reports missing matrices.
fn models_of_group(group: &str, matrices: &[LooseMatrix]) -> Found<FoundModel> {
    let mut found = Found::default();
    if let Some(fault) = duplicate_matrix(matrices) {
        // The paths of duplicate files name their folders; the group is the same in both.
        let place = match &fault {
            RecognitionFault::DuplicateFile { .. } => "",
            _ => group,
        };
        found.faults.push(group_fault(place, fault));
        return found;
    }
    let variables: Vec<Variable> = matrices
        .iter()
        .map(|matrix| matrix.variable.clone())
        .collect();
    // No limit is needed: each file was already read within its own budget.
    let budget = ReadingBudget::new(u64::MAX);
    match recognise(&variables, page_index(matrices), &budget) {
        Ok(recognised) => {
            found.items = recognised.items;
            for fault in recognised.faults {
                found.faults.push(FoundFault {
                    files: group.to_owned(),
                    ..fault
                });
            }
        }
        Err(fault) => {
            let fault = RecognitionFault::Variables(fault);
            found.faults.push(group_fault(group, fault));
        }
    }
    if found.items.is_empty() && found.faults.is_empty() {
        let names: Vec<&str> = matrices.iter().map(|matrix| matrix.file.as_str()).collect();
        let fault = RecognitionFault::MissingMatrices;
        found.faults.push(group_fault(&names.join(", "), fault));
    }
    for model in &mut found.items {
        add_provenance(model, group, matrices);
    }
    found
}

/// Returns the fault for a letter that occurs twice in a group, such as in `nom_A.csv` and
/// `nom-A.mat`, or in the files `A.csv` of two given folders; only one of these matrices could be
/// used.
fn duplicate_matrix(matrices: &[LooseMatrix]) -> Option<RecognitionFault> {
    for (index, matrix) in matrices.iter().enumerate() {
        let name = &matrix.variable.name;
        let mut before = matrices[..index].iter();
        let Some(first) = before.find(|first| first.variable.name == *name) else {
            continue;
        };
        let name = name.clone();
        return Some(if first.file == matrix.file {
            RecognitionFault::DuplicateFile {
                name,
                paths: [&first.path, &matrix.path].map(|path| sanitized_path(path)),
            }
        } else {
            RecognitionFault::DuplicateMatrix {
                name,
                files: [first.file.clone(), matrix.file.clone()],
            }
        });
    }
    None
}

fn group_fault(files: &str, fault: RecognitionFault) -> FoundFault {
    FoundFault {
        files: files.to_owned(),
        ..FoundFault::new("", fault)
    }
}

/// Returns the index that selects a matrix in a group's arrays with three dimensions: that in the
/// file with A, which determines the number of models.
fn page_index(matrices: &[LooseMatrix]) -> PageIndex {
    match matrices.iter().find(|matrix| matrix.variable.name == "A") {
        Some(a) => a.page_index,
        None => PageIndex::Last,
    }
}

/// Adds the notes on reading each file to a model, and states the group as its file, with all notes
/// and the hashes of the matrix files.
fn add_provenance(model: &mut FoundModel, group: &str, matrices: &[LooseMatrix]) {
    let mut hashes = Vec::with_capacity(matrices.len());
    for matrix in matrices {
        let notes = note_texts(&matrix.notes);
        model.notes.extend(with_file_name(&matrix.file, notes));
        hashes.push(format!("{} {}", matrix.file, matrix.sha256));
    }
    let mut notes = model.notes.clone();
    notes.push(format!(
        "SHA-256 of the matrix files: {}",
        hashes.join(", ")
    ));
    let source = model.draft.source.get_or_insert_with(Provenance::default);
    source.file = Some(group.to_owned());
    source.note = Some(notes.join("; "));
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::formats::variables::Array;

    fn loose(file: &str, array: Array, page_index: PageIndex) -> LooseMatrix {
        let variables = [Variable {
            name: "x".into(),
            value: Value::Array(array),
        }];
        let read = FileVariables {
            variables: &variables,
            notes: &[],
            page_index,
        };
        let identity = FileIdentity {
            path: Path::new(file),
            name: file.rsplit_once(':').map_or(file, |(_, name)| name),
            sha256: "",
        };
        LooseMatrix::from_variables(read, identity).unwrap()
    }

    fn matrix(file: &str, rows: usize, columns: usize) -> LooseMatrix {
        let array = Array::matrix(rows, columns, vec![-1.0; rows * columns]);
        loose(file, array, PageIndex::Last)
    }

    fn only_fault(found: &Found<FoundModel>) -> &FoundFault {
        let [fault] = found.faults.as_slice() else {
            panic!("{:?}", found.faults)
        };
        fault
    }

    #[test]
    fn matrices_in_a_folder_or_with_a_common_prefix_are_a_model() {
        let files = [
            "c1/A.csv",
            "c1/B.csv",
            "c1/C.csv",
            "c1/nom_A.csv",
            "c1/nom_B.csv",
            "c1/nom_C.csv",
            "c1/lone_A.csv",
        ];
        let found = models_of_matrices(files.iter().map(|file| matrix(file, 1, 1)).collect());
        let names: Vec<&str> = found.items.iter().map(|model| model.file()).collect();
        assert_eq!(names, ["c1", "c1/nom"]);
        let fault = only_fault(&found);
        assert_eq!(fault.files, "c1/lone_A.csv");
        assert_eq!(fault.fault, RecognitionFault::MissingMatrices);
    }

    #[test]
    fn groups_are_named_by_path() {
        for (file, group) in [
            ("A.csv", "."),
            ("nom_A.csv", "nom"),
            ("c1/A.csv", "c1"),
            ("c1/nom_A.csv", "c1/nom"),
        ] {
            assert_eq!(matrix(file, 1, 1).group, group, "{file}");
        }
    }

    #[test]
    fn a_matrix_that_is_given_twice_is_a_fault() {
        let files = [
            "c1/nom/A.csv",
            "c1/nom/B.csv",
            "c1/nom/C.csv",
            "c1/nom_A.csv",
        ];
        let found = models_of_matrices(files.iter().map(|file| matrix(file, 1, 1)).collect());
        assert!(found.items.is_empty());
        let fault = only_fault(&found);
        assert_eq!(fault.files, "c1/nom");
        assert_eq!(
            fault.fault,
            RecognitionFault::DuplicateMatrix {
                name: "A".to_owned(),
                files: ["c1/nom/A.csv".to_owned(), "c1/nom_A.csv".to_owned()],
            }
        );
    }

    #[test]
    fn a_file_of_the_same_name_in_two_given_folders_is_named_by_its_path() {
        // The part before the colon is the given folder.
        let files = ["c1/:A.csv", "c1/:B.csv", "c1/:C.csv", "c2/:A.csv"];
        let found = models_of_matrices(files.iter().map(|file| matrix(file, 1, 1)).collect());
        assert!(found.items.is_empty());
        assert_eq!(only_fault(&found).files, "");
        assert_eq!(
            only_fault(&found).fault,
            RecognitionFault::DuplicateFile {
                name: "A".to_owned(),
                paths: ["c1/:A.csv".to_owned(), "c2/:A.csv".to_owned()],
            }
        );
    }

    #[test]
    fn the_format_decides_which_index_selects_the_model() {
        // In column order, both as A(:,:,k) and as A[k,:,:].
        let cube = Array {
            shape: vec![2, 2, 2],
            ..Array::matrix(2, 4, (1..=8).map(f64::from).collect())
        };
        for (page_index, expected) in [
            (PageIndex::Last, [1.0, 2.0, 3.0, 4.0]),
            (PageIndex::First, [1.0, 3.0, 5.0, 7.0]),
        ] {
            let found = models_of_matrices(vec![
                loose("A.mat", cube.clone(), page_index),
                matrix("B.csv", 2, 1),
                matrix("C.csv", 1, 2),
            ]);
            assert_eq!(found.items.len(), 2, "{:?}", found.faults);
            let a = found.items[0].draft.matrices[0].as_ref().unwrap();
            assert_eq!(a.as_slice(), expected);
        }
    }

    #[test]
    fn notes_on_reading_the_files_are_kept() {
        let mut files = vec![
            matrix("nom_A.m", 1, 1),
            matrix("nom_B.m", 1, 1),
            matrix("nom_C.m", 1, 1),
        ];
        files[1].notes.push(ReadingNote::Truncated);
        let found = models_of_matrices(files);
        let note = format!("nom_B.m: {}", ReadingNote::Truncated);
        assert!(found.items[0].notes.contains(&note));
        let source = found.items[0].draft.source.as_ref().unwrap();
        assert!(source.note.as_ref().unwrap().contains(&note));
    }

    #[test]
    fn a_word_that_ends_in_a_letter_is_no_matrix() {
        assert_eq!(matrix_letter("nominal_A"), Some(('A', "nominal")));
        assert_eq!(matrix_letter("B"), Some(('B', "")));
        assert_eq!(matrix_letter("DATA"), None);
        assert_eq!(matrix_letter("roll+5"), None);
    }
}
