//! Recognises models given by matrices: `x' = A x + B u`, `y = C x + D u`, or with `E x'` on the
//! left.
//!
//! A [`Record`] is a group of fields that may form a model, such as a struct; it marks the fields
//! that are used. A *page* is a matrix in an array of several, which belongs to one of as many
//! models.

use nalgebra::DMatrix;

use gdcm_model::assembly::FoundModel;
use gdcm_model::dataset::dataset_draft::ModelDraft;
use gdcm_model::dataset::limits::MOST_STATES;
use gdcm_model::dataset::model::Provenance;
use gdcm_model::dataset::state_space::Timing;

use super::delays::timing_of;
use super::flight_condition::{Page, facts_of, origin_of};
use super::labels::{inputs_of, outputs_of, states_of};
use super::recognition_fault::RecognitionFault;
use super::record::Record;
use super::values::{PagedShape, array_of, matrix_of, page_of};
use crate::files::model_collection::bare_draft;
use crate::formats::reading_note::{ReadingNote, note_texts};
use crate::formats::variables::{Array, PageIndex, Value};

/// Matrix name: a capital letter; in structs and objects, a small letter is accepted too.
#[derive(Clone, Copy)]
struct MatrixName {
    capital: &'static str,
    small: &'static str,
}

impl MatrixName {
    const A: Self = Self::new("A", "a");
    const B: Self = Self::new("B", "b");
    const C: Self = Self::new("C", "c");
    const D: Self = Self::new("D", "d");
    const E: Self = Self::new("E", "e");

    const fn new(capital: &'static str, small: &'static str) -> Self {
        Self { capital, small }
    }

    /// Returns the matrix value in a record and marks it as used; `None` if there is none.
    fn value<'v>(self, record: &Record<'v>) -> Option<&'v Value> {
        let mut value = record.exact(self.capital);
        if value.is_none() && record.is_struct_or_object {
            value = record.exact(self.small);
        }
        value
    }

    fn is_in(self, record: &Record<'_>) -> bool {
        let mut value = record.peek(self.capital);
        if value.is_none() && record.is_struct_or_object {
            value = record.peek(self.small);
        }
        value.and_then(array_of).is_some()
    }
}

/// Returns whether fields form a state-space model, which requires A, B and C.
pub(super) fn is_state_space(record: &Record<'_>) -> bool {
    MatrixName::A.is_in(record) && MatrixName::B.is_in(record) && MatrixName::C.is_in(record)
}

/// Reads the model that the matrices in `record` form, or each model in an array: `A(:,:,k)` in
/// MATLAB, `A[k,:,:]` in NumPy. The first index selects the model if only then the shapes of A, B
/// and C fit, the last index if they do not fit with the first, and `page_index` decides if both
/// fit.
pub(super) fn state_spaces(
    record: &Record<'_>,
    variable: &str,
    page_index: PageIndex,
) -> Vec<Result<FoundModel, RecognitionFault>> {
    let array = |name: MatrixName| name.value(record).and_then(array_of);
    let (Some(a), Some(b), Some(c)) = (
        array(MatrixName::A),
        array(MatrixName::B),
        array(MatrixName::C),
    ) else {
        return Vec::new();
    };
    if [a, b, c].iter().all(|array| array.shape.len() < 3) {
        return vec![state_space(record, variable, Page::ONLY, &matrix_of)];
    }
    let page_index = match (
        shapes_fit(a, b, c, PageIndex::First),
        shapes_fit(a, b, c, PageIndex::Last),
    ) {
        (true, true) => page_index,
        (true, false) => PageIndex::First,
        (false, _) => PageIndex::Last,
    };
    let count = PagedShape::new(a, page_index).pages;
    let mut models = Vec::with_capacity(count);
    for index in 0..count {
        let place = match page_index {
            PageIndex::First => format!("{variable}[{index},:,:]"),
            PageIndex::Last => format!("{variable}(:,:,{})", index + 1),
        };
        let page = Page { index, count };
        let read = |name: &str, value: &Value| matrix_in_page(name, value, page, page_index);
        models.push(state_space(record, &place, page, &read));
    }
    models
}

/// Returns whether A, B and C have consistent dimensions and model counts if `page_index` selects
/// the model.
fn shapes_fit(a: &Array, b: &Array, c: &Array, page_index: PageIndex) -> bool {
    let a = PagedShape::new(a, page_index);
    let b = PagedShape::new(b, page_index);
    let c = PagedShape::new(c, page_index);
    let counts_fit = [b.pages, c.pages]
        .iter()
        .all(|pages| *pages == a.pages || *pages == 1);
    a.rows == a.columns && b.rows == a.rows && c.columns == a.rows && counts_fit
}

/// Returns a model's matrix from an array; a single matrix applies to all models.
fn matrix_in_page(
    name: &str,
    value: &Value,
    page: Page,
    page_index: PageIndex,
) -> Result<DMatrix<f64>, RecognitionFault> {
    match array_of(value) {
        Some(array) if array.shape.len() < 3 => page_of(name, array, 0, PageIndex::Last),
        Some(array) if page.index < PagedShape::new(array, page_index).pages => {
            page_of(name, array, page.index, page_index)
        }
        _ => Err(RecognitionFault::PageCount {
            name: name.to_owned(),
            expected: page.count,
            found: value.words(),
        }),
    }
}

/// Function that reads a matrix from a value; the string is its name in errors.
type ReadMatrix<'f> = &'f dyn Fn(&str, &Value) -> Result<DMatrix<f64>, RecognitionFault>;

/// Reads a matrix from `record`; `None` if there is none.
fn optional_matrix(
    record: &Record<'_>,
    name: MatrixName,
    read: ReadMatrix<'_>,
) -> Result<Option<DMatrix<f64>>, RecognitionFault> {
    match name.value(record) {
        Some(value) => Ok(Some(read(name.capital, value)?)),
        None => Ok(None),
    }
}

fn required_matrix(
    record: &Record<'_>,
    name: MatrixName,
    read: ReadMatrix<'_>,
) -> Result<DMatrix<f64>, RecognitionFault> {
    match optional_matrix(record, name, read)? {
        Some(matrix) => Ok(matrix),
        None => Err(RecognitionFault::MissingMatrix { name: name.capital }),
    }
}

/// Reads a model.
///
/// 1. A, B and C, with at most `MOST_STATES` rows and columns.
/// 2. D; zero if it is missing or a single zero.
/// 3. E is eliminated, unless it is missing or empty.
/// 4. The shapes of A, B, C and D must fit.
/// 5. Delays and sample time, labels, flight condition and origin, from the fields beside them.
fn state_space(
    record: &Record<'_>,
    variable: &str,
    page: Page,
    read: ReadMatrix<'_>,
) -> Result<FoundModel, RecognitionFault> {
    // Step 1.
    let a = required_matrix(record, MatrixName::A, read)?;
    let b = required_matrix(record, MatrixName::B, read)?;
    let c = required_matrix(record, MatrixName::C, read)?;
    at_most(a.nrows().max(a.ncols()), "states", "A")?;
    at_most(b.ncols(), "inputs", "B")?;
    at_most(c.nrows(), "outputs", "C")?;
    // Step 2.
    let mut notes = Vec::new();
    let mut d = DMatrix::zeros(c.nrows(), b.ncols());
    match optional_matrix(record, MatrixName::D, read)? {
        Some(given) if given.len() == 1 && given[0] == 0.0 => {}
        Some(given) => d = given,
        None => notes.push(ReadingNote::NoD),
    }
    // Step 3.
    let (a, b) = match optional_matrix(record, MatrixName::E, read)? {
        Some(e) if !e.is_empty() => solve_descriptor(e, a, b)?,
        _ => (a, b),
    };
    // Step 4.
    check_shapes(&a, &b, &c, &d)?;
    // Step 5.
    let timing = timing_of(record, c.nrows(), b.ncols())?;
    let mut model = build_model(record, variable, page, [a, b, c, d], timing.timing)?;
    notes.extend(timing.notes);
    model.notes = note_texts(&notes);
    Ok(model)
}

/// Builds a model from the matrices A, B, C, D and the fields beside them.
pub(super) fn build_model(
    record: &Record<'_>,
    variable: &str,
    page: Page,
    matrices: [DMatrix<f64>; 4],
    timing: Timing,
) -> Result<FoundModel, RecognitionFault> {
    let [a, b, c, _] = &matrices;
    let inputs = inputs_of(record, b.ncols())?;
    let outputs = outputs_of(record, c.nrows())?;
    let states = states_of(record, a.nrows());
    Ok(FoundModel {
        draft: ModelDraft {
            matrices: matrices.map(Some),
            timing,
            source: Some(source_of(variable)),
            states,
            ..bare_draft(variable.to_owned(), origin_of(record))
        },
        inputs,
        outputs,
        facts: facts_of(record, page)?,
        notes: Vec::new(),
    })
}

/// Returns the provenance for a variable; `variable` is empty if the model is the whole file.
pub(super) fn source_of(variable: &str) -> Provenance {
    let variable = if variable.is_empty() {
        None
    } else {
        Some(variable.to_owned())
    };
    Provenance {
        variable,
        ..Provenance::default()
    }
}

/// Rejects a count above the maximum number of states, before matrices of this size are allocated.
pub(super) fn at_most(
    count: usize,
    counted: &'static str,
    place: &str,
) -> Result<(), RecognitionFault> {
    if count > MOST_STATES {
        return Err(RecognitionFault::TooMany {
            place: place.to_owned(),
            count,
            counted,
        });
    }
    Ok(())
}

fn check_shapes(
    a: &DMatrix<f64>,
    b: &DMatrix<f64>,
    c: &DMatrix<f64>,
    d: &DMatrix<f64>,
) -> Result<(), RecognitionFault> {
    let order = a.nrows();
    if a.ncols() != order {
        return Err(RecognitionFault::NotSquare {
            rows: order,
            columns: a.ncols(),
        });
    }
    check_shape("B", b, order, b.ncols())?;
    check_shape("C", c, c.nrows(), order)?;
    check_shape("D", d, c.nrows(), b.ncols())
}

fn check_shape(
    name: &'static str,
    matrix: &DMatrix<f64>,
    rows: usize,
    columns: usize,
) -> Result<(), RecognitionFault> {
    if matrix.shape() == (rows, columns) {
        return Ok(());
    }
    Err(RecognitionFault::MatrixShape {
        name,
        expected: [rows, columns],
        found: [matrix.nrows(), matrix.ncols()],
    })
}

/// Maximum condition number of E; beyond it, solving with E loses most digits.
const WORST_CONDITION: f64 = 1e12;

/// Computes `E^-1 A` and `E^-1 B` for the descriptor model `E x' = A x + B u` (M2a).
///
/// # Errors
/// The reason if E has another shape than A, or its condition number exceeds `WORST_CONDITION`.
fn solve_descriptor(
    e: DMatrix<f64>,
    a: DMatrix<f64>,
    b: DMatrix<f64>,
) -> Result<(DMatrix<f64>, DMatrix<f64>), RecognitionFault> {
    let n = a.nrows();
    if e.shape() != (n, n) {
        return Err(RecognitionFault::DescriptorShape {
            order: n,
            found: [e.nrows(), e.ncols()],
        });
    }
    if e == DMatrix::identity(n, n) {
        return Ok((a, b));
    }
    let singular_values = e.singular_values();
    let greatest = singular_values.max();
    let least = singular_values.min();
    if least <= 0.0 || greatest / least > WORST_CONDITION {
        let condition = if least > 0.0 {
            greatest / least
        } else {
            f64::INFINITY
        };
        return Err(RecognitionFault::SingularDescriptor {
            condition: Some(condition),
        });
    }
    let factored = e.lu();
    match (factored.solve(&a), factored.solve(&b)) {
        (Some(a), Some(b)) => Ok((a, b)),
        _ => Err(RecognitionFault::SingularDescriptor { condition: None }),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_regular_e_is_solved_and_a_singular_one_refused() {
        let matrix = |values: [f64; 4]| DMatrix::from_row_slice(2, 2, &values);
        let b = DMatrix::from_row_slice(2, 1, &[2.0, 4.0]);
        let (a, b) = solve_descriptor(
            matrix([2.0, 0.0, 0.0, 4.0]),
            matrix([2.0, 4.0, 4.0, 8.0]),
            b,
        )
        .unwrap();
        assert_eq!(
            (a, b),
            (
                matrix([1.0, 2.0, 1.0, 2.0]),
                DMatrix::from_row_slice(2, 1, &[1.0, 1.0])
            )
        );
        let b = DMatrix::from_row_slice(2, 1, &[2.0, 4.0]);
        assert!(matches!(
            solve_descriptor(matrix([1.0, 1.0, 1.0, 1.0]), matrix([1.0; 4]), b),
            Err(RecognitionFault::SingularDescriptor { condition: Some(condition) }) if condition > 1e12
        ));
    }
}
