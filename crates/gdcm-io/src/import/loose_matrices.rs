//! Models whose matrices are in separate files: `nominal_A.csv`, `nominal_B.csv`, ...

use std::collections::BTreeMap;

use gdcm_model::assembly::FoundModel;
use gdcm_model::dataset::model::Provenance;

use super::recognise::recognition_fault::{FoundFault, RecognitionFault};
use super::recognise::{Found, recognise};
use crate::formats::variables::{Value, Variable};
use crate::reading_budget::ReadingBudget;

/// `pages_first` for [`recognise`]: in a NumPy array with three dimensions, the first index selects
/// the matrix.
const PAGES_FIRST: bool = true;

/// A matrix that is the only variable in its file.
pub(super) struct LooseMatrix {
    /// Folder, and file name without the matrix letter; the matrices in a group form a model.
    group: String,
    file: String,
    sha256: String,
    /// The matrix; its letter is the variable name.
    variable: Variable,
}

impl LooseMatrix {
    /// Takes the matrix from a file; `None` unless the only variable is an array and the file name
    /// ends in a matrix letter.
    pub(super) fn from_variables(variables: &[Variable], file: &str, sha256: &str) -> Option<Self> {
        let [variable] = variables else { return None };
        if !matches!(variable.value, Value::Array(_)) {
            return None;
        }
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
            file: file.to_owned(),
            sha256: sha256.to_owned(),
            variable: Variable {
                name: letter.to_string(),
                value: variable.value.clone(),
            },
        })
    }
}

/// Splits a file name without extension into the matrix letter at its end and the part before:
/// "nominal_A" is the matrix A of "nominal". `None` if the name does not end in a matrix letter, or
/// if the letter belongs to a word.
pub(super) fn matrix_letter(stem: &str) -> Option<(char, &str)> {
    let letter = stem.chars().last()?;
    if !matches!(letter, 'A' | 'B' | 'C' | 'D' | 'E') {
        return None;
    }
    let before = &stem[..stem.len() - 1];
    if !before.is_empty() && !before.ends_with(['_', '-', '.', ' ']) {
        return None;
    }
    Some((letter, before.trim_end_matches(['_', '-', '.', ' '])))
}

/// Builds a model from each group of matrices; the group is stated as the model's file.
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

/// Reads a group's matrices as a file with one variable for each. A group without a model and
/// without a fault, such as a lone `A.csv`, is a fault.
fn models_of_group(group: &str, matrices: &[LooseMatrix]) -> Found<FoundModel> {
    let variables: Vec<Variable> = matrices
        .iter()
        .map(|matrix| matrix.variable.clone())
        .collect();
    let mut found = Found::default();
    // No limit is needed: each file was already read within its own budget.
    match recognise(&variables, PAGES_FIRST, &ReadingBudget::new(u64::MAX)) {
        Ok(recognised) => {
            found.items = recognised.items;
            for fault in recognised.faults {
                found.faults.push(FoundFault {
                    files: group.to_owned(),
                    ..fault
                });
            }
        }
        Err(fault) => found.faults.push(FoundFault {
            files: group.to_owned(),
            ..FoundFault::new("", RecognitionFault::Variables(fault))
        }),
    }
    if found.items.is_empty() && found.faults.is_empty() {
        let names: Vec<&str> = matrices.iter().map(|matrix| matrix.file.as_str()).collect();
        found.faults.push(FoundFault {
            files: names.join(", "),
            ..FoundFault::new("", RecognitionFault::MissingMatrices)
        });
    }
    let hashes: Vec<String> = matrices
        .iter()
        .map(|matrix| format!("{} {}", matrix.file, matrix.sha256))
        .collect();
    for model in &mut found.items {
        let source = model.draft.source.get_or_insert_with(Provenance::default);
        source.file = Some(group.to_owned());
        source.note = Some(format!(
            "SHA-256 of the matrix files: {}",
            hashes.join(", ")
        ));
    }
    found
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::formats::variables::Array;

    fn matrix(file: &str, rows: usize, columns: usize) -> LooseMatrix {
        let value = Value::Array(Array::matrix(rows, columns, vec![-1.0; rows * columns]));
        LooseMatrix::from_variables(
            &[Variable {
                name: "x".into(),
                value,
            }],
            file,
            "",
        )
        .unwrap()
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
        let [fault] = found.faults.as_slice() else {
            panic!("{:?}", found.faults)
        };
        assert_eq!(fault.files, "c1/lone_A.csv");
        assert_eq!(fault.fault, RecognitionFault::MissingMatrices);
    }

    #[test]
    fn a_word_that_ends_in_a_letter_is_no_matrix() {
        assert_eq!(matrix_letter("nominal_A"), Some(('A', "nominal")));
        assert_eq!(matrix_letter("B"), Some(('B', "")));
        assert_eq!(matrix_letter("DATA"), None);
        assert_eq!(matrix_letter("roll+5"), None);
    }
}
