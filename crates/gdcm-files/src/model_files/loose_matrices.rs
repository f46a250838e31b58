//! Matrices that have files to themselves: `A.csv`, `B.csv`, `C.csv` and `D.csv` of a folder, or `nominal_A.npy`, ….

use std::collections::BTreeMap;

use crate::recognise::{Recognised, recognise};
use crate::variables::{Value, Variable};
use gdcm_core::dataset::Provenance;

/// A matrix that has a file to itself.
pub(super) struct LooseMatrix {
    /// The folder and what stands before the letter: matrices of the same are one model.
    pub(super) group: String,
    /// The file.
    pub(super) file: String,
    /// SHA-256 of the file.
    pub(super) sha256: String,
    /// The matrix, under its letter.
    pub(super) variable: Variable,
}

/// The letter of a file that is named as a matrix, and what stands before it: "nominal_A" is A of "nominal".
pub(super) fn matrix_letter(stem: &str) -> Option<(char, &str)> {
    let letter = stem.chars().last().filter(|letter| matches!(letter, 'A' | 'B' | 'C' | 'D' | 'E'))?;
    let before = &stem[..stem.len() - 1];
    let is_apart = before.is_empty() || before.ends_with(['_', '-', '.', ' ']);
    is_apart.then(|| (letter, before.trim_end_matches(['_', '-', '.', ' '])))
}

impl LooseMatrix {
    /// The only variable of a file that is named as a matrix.
    pub(super) fn of(variables: &[Variable], file: &str) -> Option<Self> {
        let [variable] = variables else { return None };
        if !matches!(variable.value, Value::Array(_)) {
            return None;
        }
        let (folder, name) = file.rsplit_once('/').unwrap_or(("", file));
        let stem = name.rsplit_once('.').map_or(name, |(stem, _)| stem);
        let (letter, before) = matrix_letter(stem)?;
        Some(Self {
            group: [folder, before].into_iter().filter(|part| !part.is_empty()).collect::<Vec<_>>().join("/"),
            file: file.to_owned(),
            sha256: String::new(),
            variable: Variable { name: letter.to_string(), value: variable.value.clone() },
        })
    }
}

/// The models that loose matrices make, each group one; its file is the folder, or what stands before the letters.
pub(super) fn models_of(loose: Vec<LooseMatrix>) -> Recognised {
    let mut groups: BTreeMap<String, Vec<LooseMatrix>> = BTreeMap::new();
    for matrix in loose {
        groups.entry(matrix.group.clone()).or_default().push(matrix);
    }
    let mut found = Recognised::default();
    for (group, matrices) in groups {
        let variables: Vec<Variable> = matrices.iter().map(|matrix| matrix.variable.clone()).collect();
        let mut of_group = recognise(&variables);
        let is_model = !of_group.models.is_empty() || !of_group.faults.is_empty();
        for model in &mut of_group.models {
            let source = model.draft.source.get_or_insert_with(Provenance::default);
            source.file = Some(group.clone());
            let hashes = matrices.iter().map(|matrix| format!("{} {}", matrix.file, matrix.sha256));
            source.note = Some(format!("SHA-256 of its files: {}", hashes.collect::<Vec<_>>().join(", ")));
        }
        found.models.append(&mut of_group.models);
        found.faults.extend(of_group.faults.into_iter().map(|fault| format!("{group}: {fault}")));
        if !is_model {
            let names: Vec<&str> = matrices.iter().map(|matrix| matrix.file.as_str()).collect();
            found.faults.push(format!("{}: a model needs A, B and C", names.join(", ")));
        }
    }
    found
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::variables::Array;

    fn matrix(file: &str, rows: usize, columns: usize) -> LooseMatrix {
        let value = Value::Array(Array::matrix(rows, columns, vec![-1.0; rows * columns]));
        LooseMatrix::of(&[Variable { name: "x".into(), value }], file).unwrap()
    }

    #[test]
    fn matrices_of_a_folder_or_of_one_beginning_are_a_model() {
        let files =
            ["c1/A.csv", "c1/B.csv", "c1/C.csv", "c1/nom_A.csv", "c1/nom_B.csv", "c1/nom_C.csv", "c1/lone_A.csv"];
        let found = models_of(files.iter().map(|file| matrix(file, 1, 1)).collect());
        let names: Vec<&str> = found.models.iter().map(|model| model.file()).collect();
        assert_eq!(names, ["c1", "c1/nom"]);
        assert_eq!(found.faults, ["c1/lone_A.csv: a model needs A, B and C"]);
    }

    #[test]
    fn a_word_that_ends_in_a_letter_is_no_matrix() {
        assert_eq!(matrix_letter("nominal_A"), Some(('A', "nominal")));
        assert_eq!(matrix_letter("B"), Some(('B', "")));
        assert_eq!(matrix_letter("DATA"), None);
        assert_eq!(matrix_letter("roll+5"), None);
    }
}
