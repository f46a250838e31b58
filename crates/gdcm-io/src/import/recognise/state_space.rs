//! Models given by matrices or transfer functions.

use nalgebra::{Complex, DMatrix};

use gdcm_model::assembly::FoundModel;
use gdcm_model::dataset::limits::MOST_STATES;
use gdcm_model::dataset::model::Provenance;
use gdcm_model::dataset::state_space::Timing;
use gdcm_model::dataset::unchecked_dataset::ModelDraft;
use gdcm_model::units::number;

use super::delays::timing_of;
use super::record::{
    Page, Record, array_of, complex_list_of, facts_of, inputs_of, list_of, matrix_of, origin_of,
    outputs_of, page_of, pages_of, states_of,
};
use crate::files::model_collection::bare_draft;
use crate::formats::variables::{CellArray, Value};

/// Whether fields are a state-space model: the matrices A, B and C with these names, in a struct or
/// an object also in lower case.
pub(super) fn is_state_space(record: &Record<'_>) -> bool {
    let has = |large: &str, small: &str| {
        let value = record
            .peek(large)
            .or_else(|| record.peek(small).filter(|_| record.stands_alone));
        value.and_then(array_of).is_some()
    };
    has("A", "a") && has("B", "b") && has("C", "c")
}

/// Reads the model from the matrices in `record`, or each model of an array: `A(:,:,k)` in MATLAB,
/// `A[k,:,:]` in NumPy.
pub(super) fn state_spaces(
    record: &Record<'_>,
    variable: &str,
    pages_first: bool,
) -> Vec<Result<FoundModel, String>> {
    let get = |large: &str, small: &str| {
        record
            .exact(large)
            .or_else(|| record.exact(small))
            .and_then(array_of)
    };
    let (Some(a), Some(b), Some(c)) = (get("A", "a"), get("B", "b"), get("C", "c")) else {
        return Vec::new();
    };
    if [a, b, c].iter().all(|array| array.shape.len() < 3) {
        return vec![one(record, variable, Page::ONLY, &|name, value| {
            matrix_of(name, value)
        })];
    }
    // The index that counts the models is the one for which the other indices fit together.
    let fits = |first: bool| {
        let (pages, of_a) = pages_of(a, first);
        let (of_pages, of_b) = pages_of(b, first);
        let (pages_of_c, of_c) = pages_of(c, first);
        let is_as_many = |count: usize| count == pages || count == 1;
        of_a[0] == of_a[1]
            && of_b[0] == of_a[0]
            && of_c[1] == of_a[0]
            && is_as_many(of_pages)
            && is_as_many(pages_of_c)
    };
    let first = match (fits(false), fits(true)) {
        (true, true) => pages_first,
        (_, first) => first,
    };
    let count = pages_of(a, first).0;
    let page = |page: usize| {
        let place = if first {
            format!("[{page},:,:]")
        } else {
            format!("(:,:,{})", page + 1)
        };
        one(
            record,
            &format!("{variable}{place}"),
            Page { index: page, count },
            &|name, value| match array_of(value) {
                // A matrix shared by all models.
                Some(array) if array.shape.len() < 3 => page_of(name, array, 0, false),
                Some(array) if page < pages_of(array, first).0 => page_of(name, array, page, first),
                _ => Err(format!(
                    "{name}: expected {count} matrices as in A, found {}",
                    value.words()
                )),
            },
        )
    };
    (0..count).map(page).collect()
}

type MatrixOf<'f> = &'f dyn Fn(&str, &Value) -> Result<DMatrix<f64>, String>;

fn one(
    record: &Record<'_>,
    variable: &str,
    page: Page,
    matrix: MatrixOf<'_>,
) -> Result<FoundModel, String> {
    let get = |large: &str, small: &str| record.exact(large).or_else(|| record.exact(small));
    let read = |name: &str, small: &str| {
        get(name, small)
            .map(|value| matrix(name, value))
            .transpose()
    };
    let missing = |name: &str| format!("matrix {name} is missing");
    let a = read("A", "a")?.ok_or_else(|| missing("A"))?;
    let b = read("B", "b")?.ok_or_else(|| missing("B"))?;
    let c = read("C", "c")?.ok_or_else(|| missing("C"))?;
    at_most(a.nrows().max(a.ncols()), "states", "A")?;
    at_most(b.ncols(), "inputs", "B")?;
    at_most(c.nrows(), "outputs", "C")?;
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
    let d = if d.len() == 1 && d[0] == 0.0 {
        DMatrix::zeros(c.nrows(), b.ncols())
    } else {
        d
    };
    check_shapes(&a, &b, &c, &d)?;
    let (timing, of_timing) = timing_of(record, c.nrows(), b.ncols())?;
    let mut model = found(record, variable, page, [a, b, c, d], timing)?;
    notes.extend(of_timing);
    model.notes = notes;
    Ok(model)
}

/// Builds the model from its matrices and the labels beside them.
pub(super) fn found(
    record: &Record<'_>,
    variable: &str,
    page: Page,
    [a, b, c, d]: [DMatrix<f64>; 4],
    timing: Timing,
) -> Result<FoundModel, String> {
    let inputs = inputs_of(record, b.ncols())?;
    let outputs = outputs_of(record, c.nrows())?;
    let states = states_of(record, a.nrows());
    let source = Some(variable.to_owned()).filter(|variable| !variable.is_empty());
    Ok(FoundModel {
        draft: ModelDraft {
            matrices: [a, b, c, d].map(Some),
            timing,
            source: Some(Provenance {
                variable: source,
                ..Provenance::default()
            }),
            states,
            ..bare_draft(variable.to_owned(), origin_of(record))
        },
        inputs,
        outputs,
        facts: facts_of(record, page)?,
        notes: Vec::new(),
    })
}

/// Refuses a count above the largest number of states, before matrices of this size are allocated.
fn at_most(count: usize, of: &str, place: &str) -> Result<(), String> {
    match count > MOST_STATES {
        true => Err(format!(
            "{place}: {count} {of}; at most {MOST_STATES} are read"
        )),
        false => Ok(()),
    }
}

fn check_shapes(
    a: &DMatrix<f64>,
    b: &DMatrix<f64>,
    c: &DMatrix<f64>,
    d: &DMatrix<f64>,
) -> Result<(), String> {
    let n = a.nrows();
    if a.ncols() != n {
        return Err(format!(
            "A: expected a square matrix, found {} x {}",
            n,
            a.ncols()
        ));
    }
    let expected = [
        ("B", b, (n, b.ncols())),
        ("C", c, (c.nrows(), n)),
        ("D", d, (c.nrows(), b.ncols())),
    ];
    match expected
        .iter()
        .find(|(_, matrix, shape)| matrix.shape() != *shape)
    {
        Some((name, matrix, (rows, columns))) => Err(format!(
            "{name}: expected {rows} x {columns}, found {} x {}",
            matrix.nrows(),
            matrix.ncols()
        )),
        None => Ok(()),
    }
}

// Descriptor models with a matrix E.

/// Condition number of E above which `E^-1` has lost most digits.
const WORST_CONDITION: f64 = 1e12;

/// Computes `E^-1 A` and `E^-1 B` of `E x' = A x + B u` (M2a).
pub(super) fn solved(
    e: DMatrix<f64>,
    a: DMatrix<f64>,
    b: DMatrix<f64>,
) -> Result<(DMatrix<f64>, DMatrix<f64>), String> {
    let n = a.nrows();
    if e.shape() != (n, n) {
        return Err(format!(
            "E: expected {n} x {n} as A, found {} x {}",
            e.nrows(),
            e.ncols()
        ));
    }
    if e == DMatrix::identity(n, n) {
        return Ok((a, b));
    }
    let singular = e.singular_values();
    let most = singular.max();
    let least = singular.min();
    if least <= 0.0 || most / least > WORST_CONDITION {
        let condition = if least > 0.0 {
            number(most / least)
        } else {
            "infinite".to_owned()
        };
        return Err(format!(
            "E is singular (condition {condition}): the model has no state-space form; export it without E"
        ));
    }
    let factored = e.lu();
    match (factored.solve(&a), factored.solve(&b)) {
        (Some(a), Some(b)) => Ok((a, b)),
        _ => {
            Err("E is singular: the model has no state-space form; export it without E".to_owned())
        }
    }
}

// Models given by numerators and denominators, or by zeros, poles and gains.

/// Whether fields are transfer functions.
pub(super) fn is_transfer_function(record: &Record<'_>) -> bool {
    polynomials(record).is_some() || factors(record).is_some()
}

fn polynomials<'v>(record: &Record<'v>) -> Option<(&'v Value, &'v Value)> {
    let numerator = record.find(&["num", "Numerator"])?;
    let denominator = record.find(&["den", "Denominator"])?;
    Some((record.used(numerator), record.used(denominator)))
}

fn factors<'v>(record: &Record<'v>) -> Option<(&'v Value, &'v Value, &'v Value)> {
    let zeros = record.find(&["z", "Zeros"])?;
    let poles = record.find(&["p", "Poles"])?;
    let gains = record.find(&["k", "Gain"])?;
    Some((record.used(zeros), record.used(poles), record.used(gains)))
}

/// A rational transfer function, highest power first; the denominator is monic.
#[derive(Clone, Debug, PartialEq)]
struct Fraction {
    numerator: Vec<f64>,
    denominator: Vec<f64>,
}

impl Fraction {
    /// Creates the fraction without leading zeros and with a monic denominator; refuses an improper
    /// fraction.
    fn new(numerator: &[f64], denominator: &[f64], place: &str) -> Result<Self, String> {
        let strip = |polynomial: &[f64]| -> Vec<f64> {
            let first = polynomial
                .iter()
                .position(|coefficient| *coefficient != 0.0)
                .unwrap_or(polynomial.len());
            polynomial[first..].to_vec()
        };
        at_most(denominator.len().saturating_sub(1), "states", place)?;
        let numerator = strip(numerator);
        let denominator = strip(denominator);
        let Some(&leading) = denominator.first() else {
            return Err(format!("{place}: the denominator is zero"));
        };
        if numerator.len() > denominator.len() {
            return Err(format!(
                "{place}: the numerator is of higher degree than the denominator; such a response has no state-space form"
            ));
        }
        let scaled = |polynomial: Vec<f64>| {
            polynomial
                .into_iter()
                .map(|coefficient| coefficient / leading)
                .collect()
        };
        Ok(Self {
            numerator: scaled(numerator),
            denominator: scaled(denominator),
        })
    }

    fn order(&self) -> usize {
        self.denominator.len() - 1
    }

    /// Returns the numerator, padded with zeros to the length of the denominator.
    fn padded(&self) -> Vec<f64> {
        let mut padded = vec![0.0; self.denominator.len() - self.numerator.len()];
        padded.extend(&self.numerator);
        padded
    }
}

/// Returns the state-space model of the transfer functions in `record`: each response in
/// controllable canonical form, in parallel.
///
/// ```text
/// H(s) = d + (c_1 s^(n-1) + ... + c_n) / (s^n + a_1 s^(n-1) + ... + a_n)
/// A = [-a_1 ... -a_n; I 0],   B = [1; 0; ...; 0],   C = [c_1 ... c_n],   D = d
/// ```
pub(super) fn transfer_function(record: &Record<'_>, variable: &str) -> Result<FoundModel, String> {
    let (fractions, outputs, inputs) = fractions_of(record)?;
    let order: usize = fractions.iter().map(Fraction::order).sum();
    at_most(order, "states", "all responses together")?;
    at_most(inputs.max(outputs), "channels", "transfer functions")?;
    let mut a = DMatrix::zeros(order, order);
    let mut b = DMatrix::zeros(order, inputs);
    let mut c = DMatrix::zeros(outputs, order);
    let mut d = DMatrix::zeros(outputs, inputs);
    let mut start = 0;
    for (index, fraction) in fractions.iter().enumerate() {
        let output = index % outputs;
        let input = index / outputs;
        let n = fraction.order();
        let numerator = fraction.padded();
        d[(output, input)] = numerator[0];
        for state in 0..n {
            a[(start, start + state)] = -fraction.denominator[state + 1];
            c[(output, start + state)] =
                numerator[state + 1] - numerator[0] * fraction.denominator[state + 1];
        }
        for state in 1..n {
            a[(start + state, start + state - 1)] = 1.0;
        }
        if n > 0 {
            b[(start, input)] = 1.0;
        }
        start += n;
    }
    let (timing, of_timing) = timing_of(record, outputs, inputs)?;
    let mut model = found(record, variable, Page::ONLY, [a, b, c, d], timing)?;
    model.notes.extend(of_timing);
    model
        .notes
        .push("transfer functions, each realised by itself".to_owned());
    Ok(model)
}

/// Returns the fractions, first index fastest, and the numbers of outputs and inputs.
fn fractions_of(record: &Record<'_>) -> Result<(Vec<Fraction>, usize, usize), String> {
    if let Some((numerators, denominators)) = polynomials(record) {
        let (numerators, outputs, inputs) = cells(numerators);
        let (denominators, ..) = cells(denominators);
        let fraction = |(index, numerator): (usize, &&Value)| {
            let place = format!("response {}", index + 1);
            // A single denominator may apply to all responses.
            let denominator = denominators
                .get(index)
                .or(denominators.first())
                .ok_or_else(|| format!("{place}: no denominator"))?;
            Fraction::new(
                &list_of("numerator", numerator)?,
                &list_of("denominator", denominator)?,
                &place,
            )
        };
        let fractions = numerators
            .iter()
            .enumerate()
            .map(fraction)
            .collect::<Result<_, _>>()?;
        return Ok((fractions, outputs, inputs));
    }
    let (zeros, poles, gains) = factors(record).ok_or_else(|| "no transfer function".to_owned())?;
    let (zeros, outputs, inputs) = cells(zeros);
    let (poles, ..) = cells(poles);
    let gains = array_of(gains)
        .map(|array| array.re.clone())
        .unwrap_or_default();
    let fraction = |(index, zeros): (usize, &&Value)| {
        let place = format!("response {}", index + 1);
        let poles = poles
            .get(index)
            .ok_or_else(|| format!("{place}: no poles"))?;
        let gain = gains
            .get(index)
            .ok_or_else(|| format!("{place}: no gain"))?;
        let zeros = complex_list_of("zeros", zeros)?;
        let poles = complex_list_of("poles", poles)?;
        at_most(zeros.len().max(poles.len()), "states", &place)?;
        let numerator: Vec<f64> = polynomial(&zeros).iter().map(|term| term * gain).collect();
        Fraction::new(&numerator, &polynomial(&poles), &place)
    };
    let fractions = zeros
        .iter()
        .enumerate()
        .map(fraction)
        .collect::<Result<_, _>>()?;
    Ok((fractions, outputs, inputs))
}

/// Returns the values of a cell array, and its rows and columns; a single value counts as a 1 x 1
/// cell array.
fn cells(value: &Value) -> (Vec<&Value>, usize, usize) {
    match value {
        Value::Cell(CellArray { shape, values }) => {
            let rows = shape.first().copied().unwrap_or(0);
            (
                values.iter().collect(),
                rows,
                shape.get(1).copied().unwrap_or(0),
            )
        }
        other => (vec![other], 1, 1),
    }
}

/// Returns the real polynomial with these roots, highest power first; complex roots come in
/// conjugate pairs.
fn polynomial(roots: &[Complex<f64>]) -> Vec<f64> {
    let mut coefficients = vec![Complex::new(1.0, 0.0)];
    for root in roots {
        coefficients.push(Complex::new(0.0, 0.0));
        for index in (1..coefficients.len()).rev() {
            let before = coefficients[index - 1];
            coefficients[index] -= root * before;
        }
    }
    coefficients
        .iter()
        .map(|coefficient| coefficient.re)
        .collect()
}

#[cfg(test)]
mod descriptor_tests {
    use super::*;

    #[test]
    fn a_regular_e_is_solved_and_a_singular_one_refused() {
        let matrix = |values: [f64; 4]| DMatrix::from_row_slice(2, 2, &values);
        let b = DMatrix::from_row_slice(2, 1, &[2.0, 4.0]);
        let (a, b) = solved(
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
        assert!(
            solved(matrix([1.0, 1.0, 1.0, 1.0]), matrix([1.0; 4]), b)
                .unwrap_err()
                .contains("singular")
        );
    }
}

#[cfg(test)]
mod transfer_function_tests {
    use super::*;
    use crate::formats::variables::{Array, Variable};

    fn row(name: &str, values: &[f64]) -> Variable {
        Variable {
            name: name.into(),
            value: Value::Array(Array::matrix(1, values.len(), values.to_vec())),
        }
    }

    fn response(model: &FoundModel, s: Complex<f64>) -> Complex<f64> {
        let [a, b, c, d] = model
            .draft
            .matrices
            .clone()
            .map(|matrix| matrix.unwrap().map(|entry| Complex::new(entry, 0.0)));
        let n = a.nrows();
        let inner = (DMatrix::identity(n, n) * s - a).lu().solve(&b).unwrap();
        (c * inner + d)[(0, 0)]
    }

    #[test]
    fn a_fraction_has_the_response_of_its_polynomials() {
        let variables = [row("num", &[2.0, 3.0, 4.0]), row("den", &[2.0, 5.0, 7.0])];
        let model = transfer_function(&Record::of_variables(&variables), "g").unwrap();
        let s = Complex::new(0.3, 1.7);
        let expected = (s * s * 2.0 + s * 3.0 + 4.0) / (s * s * 2.0 + s * 5.0 + 7.0);
        // A few rounding errors for numbers of order 1.
        assert!((response(&model, s) - expected).norm() < 1e-14);
    }

    #[test]
    fn zeros_poles_and_a_gain_are_the_same_as_their_polynomials() {
        let pair = |name: &str, re: f64, im: f64| {
            let array = Array {
                im: Some(vec![im, -im]),
                ..Array::matrix(2, 1, vec![re, re])
            };
            Variable {
                name: name.into(),
                value: Value::Array(array),
            }
        };
        let variables = [row("z", &[-3.0]), pair("p", -1.0, 2.0), row("k", &[5.0])];
        let model = transfer_function(&Record::of_variables(&variables), "").unwrap();
        let s = Complex::new(0.0, 2.5);
        let expected = (s + 3.0) * 5.0 / (s * s + s * 2.0 + 5.0);
        assert!((response(&model, s) - expected).norm() < 1e-14);
    }

    #[test]
    fn an_improper_fraction_is_refused() {
        let variables = [row("num", &[1.0, 0.0, 0.0]), row("den", &[1.0, 1.0])];
        let error = transfer_function(&Record::of_variables(&variables), "").unwrap_err();
        assert!(error.contains("higher degree"), "{error}");
    }

    #[test]
    fn more_states_than_a_dataset_holds_are_refused_before_there_is_a_matrix_of_them() {
        let long = vec![1.0; 30_000];
        let roots = [row("z", &[]), row("p", &long), row("k", &[1.0])];
        for variables in [&[row("num", &[1.0]), row("den", &long)][..], &roots] {
            let error = transfer_function(&Record::of_variables(variables), "").unwrap_err();
            assert!(error.contains("states; at most 1000 are read"), "{error}");
        }
        let column = Variable {
            name: "C".into(),
            value: Value::Array(Array::matrix(30_000, 1, long.clone())),
        };
        let variables = [row("A", &[-1.0]), row("B", &long), column];
        let error = state_spaces(&Record::of_variables(&variables), "", false)
            .remove(0)
            .unwrap_err();
        assert!(error.contains("B: 30000 inputs"), "{error}");
    }
}
