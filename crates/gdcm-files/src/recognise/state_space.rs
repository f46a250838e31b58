//! Models by their matrices.

use nalgebra::DMatrix;

use crate::variables::Value;
use gdcm_core::assembly::FoundModel;
use gdcm_core::dataset::{ModelDraft, Origin, Provenance, Timing};

use super::descriptor::solved;
use super::labels::{facts_of, inputs_of, outputs_of, states_of, timing_of};
use super::matrix::{array_of, matrix_of, page_of, slices};
use super::record::Record;

/// Whether fields are those of a state-space model: the matrices A and B, by their very names, large or small.
pub(super) fn is_state_space(record: &Record<'_>) -> bool {
    let has = |large: &str, small: &str| {
        let value = record.exact(large).or_else(|| record.exact(small).filter(|_| record.stands_alone));
        value.and_then(array_of).is_some()
    };
    has("A", "a") && has("B", "b") && has("C", "c")
}

/// The model of the matrices in `record`, or each of an array of them (`A(:,:,k)`).
pub(super) fn state_spaces(record: &Record<'_>, variable: &str) -> Vec<Result<FoundModel, String>> {
    let get = |large: &str, small: &str| record.exact(large).or_else(|| record.exact(small));
    let pages = get("A", "a").and_then(array_of).map_or(1, slices);
    if pages <= 1 {
        return vec![one(record, variable, &|name, value| matrix_of(name, value))];
    }
    let page = |page: usize| {
        let variable =
            if variable.is_empty() { format!("(:,:,{})", page + 1) } else { format!("{variable}(:,:,{})", page + 1) };
        one(record, &variable, &|name, value| match array_of(value) {
            // A matrix that all of them share.
            Some(array) if slices(array) == 1 => page_of(name, array, 0),
            Some(array) if page < slices(array) => page_of(name, array, page),
            _ => Err(format!("{name}: expected {pages} matrices as in A, found {}", value.words())),
        })
    };
    (0..pages).map(page).collect()
}

type MatrixOf<'f> = &'f dyn Fn(&str, &Value) -> Result<DMatrix<f64>, String>;

fn one(record: &Record<'_>, variable: &str, matrix: MatrixOf<'_>) -> Result<FoundModel, String> {
    let get = |large: &str, small: &str| record.exact(large).or_else(|| record.exact(small));
    let read = |name: &str, small: &str| get(name, small).map(|value| matrix(name, value)).transpose();
    let missing = |name: &str| format!("matrix {name} is missing");
    let a = read("A", "a")?.ok_or_else(|| missing("A"))?;
    let b = read("B", "b")?.ok_or_else(|| missing("B"))?;
    let c = read("C", "c")?.ok_or_else(|| missing("C"))?;
    let mut notes = Vec::new();
    let d = match read("D", "d")? {
        Some(d) => d,
        None => {
            notes.push("the file has no D: taken as zero".to_owned());
            DMatrix::zeros(c.nrows(), b.ncols())
        }
    };
    let (a, b) = match read("E", "e")?.filter(|e| !e.is_empty()) {
        Some(e) => solved(e, a, b)?,
        None => (a, b),
    };
    let d = if d.len() == 1 && d[0] == 0.0 { DMatrix::zeros(c.nrows(), b.ncols()) } else { d };
    check_shapes(&a, &b, &c, &d)?;
    let timing = timing_of(record, (b.ncols(), c.nrows()))?;
    let mut model = found(record, variable, [a, b, c, d], timing);
    model.notes = notes;
    Ok(model)
}

/// The model of these matrices, with the labels that stand beside them.
pub(super) fn found(
    record: &Record<'_>,
    variable: &str,
    [a, b, c, d]: [DMatrix<f64>; 4],
    timing: Timing,
) -> FoundModel {
    let (inputs, outputs) = (inputs_of(record, b.ncols()), outputs_of(record, c.nrows()));
    let states = states_of(record, a.nrows());
    let source = Some(variable.to_owned()).filter(|variable| !variable.is_empty());
    FoundModel {
        draft: ModelDraft {
            name: variable.to_owned(),
            origin: origin_of(record),
            matrices: [a, b, c, d].map(Some),
            timing,
            response: None,
            source: Some(Provenance { variable: source, ..Provenance::default() }),
            states,
            bands: None,
        },
        inputs,
        outputs,
        facts: facts_of(record),
        notes: Vec::new(),
    }
}

/// Classes whose objects are identified; of others nothing is known yet.
pub(super) fn origin_of(record: &Record<'_>) -> Origin {
    let identified = record.class.is_some_and(|class| class.starts_with("id"));
    match identified {
        true => Origin::Identified { method: None, order: None },
        false => Origin::Perturbed { perturbation: None },
    }
}

fn check_shapes(a: &DMatrix<f64>, b: &DMatrix<f64>, c: &DMatrix<f64>, d: &DMatrix<f64>) -> Result<(), String> {
    let n = a.nrows();
    let wrong = |name: &str, expected: (usize, usize), found: (usize, usize)| {
        Err(format!("{name}: expected {} x {}, found {} x {}", expected.0, expected.1, found.0, found.1))
    };
    if a.ncols() != n {
        return Err(format!("A: expected a square matrix, found {} x {}", n, a.ncols()));
    }
    if b.nrows() != n {
        return wrong("B", (n, b.ncols()), b.shape());
    }
    if c.ncols() != n {
        return wrong("C", (c.nrows(), n), c.shape());
    }
    if d.shape() != (c.nrows(), b.ncols()) {
        return wrong("D", (c.nrows(), b.ncols()), d.shape());
    }
    Ok(())
}
