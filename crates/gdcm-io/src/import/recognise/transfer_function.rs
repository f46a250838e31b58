//! Recognises models given by transfer functions: numerators and denominators, or zeros, poles and
//! gains.

use nalgebra::{Complex, DMatrix};

use gdcm_model::assembly::FoundModel;

use super::delays::timing_of;
use super::flight_condition::Page;
use super::recognition_fault::RecognitionFault;
use super::record::Record;
use super::state_space::{at_most, build_model};
use super::values::{array_of, complex_list_of, list_of};
use crate::formats::reading_note::{ReadingNote, note_texts};
use crate::formats::variables::Value;

/// Returns whether fields form transfer functions; marks these fields as used.
pub(super) fn is_transfer_function(record: &Record<'_>) -> bool {
    Polynomials::find(record).is_some() || Factors::find(record).is_some()
}

/// Returns the state-space model of the transfer functions in `record`: the responses, each in
/// controllable canonical form, in parallel.
///
/// ```text
/// H(s) = d + (c_1 s^(n-1) + ... + c_n) / (s^n + a_1 s^(n-1) + ... + a_n)
/// A = [-a_1 ... -a_n; I 0],   B = [1; 0; ...; 0],   C = [c_1 ... c_n],   D = d
/// ```
///
/// For a numerator `b_0 s^n + ... + b_n`, `d = b_0` and `c_k = b_k - b_0 a_k`. The states of one
/// response follow those of another; `B` and `C` connect them to their input and their output.
pub(super) fn transfer_function(
    record: &Record<'_>,
    variable: &str,
) -> Result<FoundModel, RecognitionFault> {
    let FractionTable {
        fractions,
        outputs,
        inputs,
    } = fractions_of(record)?;
    let order: usize = fractions.iter().map(Fraction::order).sum();
    at_most(order, "states", "all responses together")?;
    at_most(inputs.max(outputs), "channels", "transfer functions")?;
    let mut a = DMatrix::zeros(order, order);
    let mut b = DMatrix::zeros(order, inputs);
    let mut c = DMatrix::zeros(outputs, order);
    let mut d = DMatrix::zeros(outputs, inputs);
    // Index of the current response's first state, from 0.
    let mut start = 0;
    // A response's index counts the outputs first, then the inputs.
    for (index, fraction) in fractions.iter().enumerate() {
        let output = index % outputs;
        let input = index / outputs;
        let n = fraction.order();
        let numerator = fraction.padded_numerator();
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
    let timing = timing_of(record, outputs, inputs)?;
    let mut model = build_model(record, variable, Page::ONLY, [a, b, c, d], timing.timing)?;
    model.notes.extend(note_texts(&timing.notes));
    model.notes.push(ReadingNote::TransferFunctions.to_string());
    Ok(model)
}

fn fractions_of(record: &Record<'_>) -> Result<FractionTable, RecognitionFault> {
    if let Some(polynomials) = Polynomials::find(record) {
        return polynomials.fractions();
    }
    match Factors::find(record) {
        Some(factors) => factors.fractions(),
        None => Err(RecognitionFault::NoTransferFunction),
    }
}

/// Fields that give transfer functions as polynomials.
struct Polynomials<'v> {
    numerators: &'v Value,
    denominators: &'v Value,
}

impl<'v> Polynomials<'v> {
    fn find(record: &Record<'v>) -> Option<Self> {
        let numerators = record.find(&["num", "Numerator"])?;
        let denominators = record.find(&["den", "Denominator"])?;
        Some(Self {
            numerators: record.take(numerators),
            denominators: record.take(denominators),
        })
    }

    /// Returns the transfer functions; the first denominator applies to responses without a
    /// denominator.
    fn fractions(&self) -> Result<FractionTable, RecognitionFault> {
        let numerators = CellTable::new(self.numerators);
        let denominators = CellTable::new(self.denominators).cells;
        let mut fractions = Vec::with_capacity(numerators.cells.len());
        for (index, numerator) in numerators.cells.iter().enumerate() {
            let place = format!("response {}", index + 1);
            let Some(denominator) = denominators.get(index).or(denominators.first()) else {
                return Err(RecognitionFault::ResponseWithout {
                    response: index + 1,
                    part: "denominator",
                });
            };
            fractions.push(Fraction::new(
                &list_of("numerator", numerator)?,
                &list_of("denominator", denominator)?,
                &place,
            )?);
        }
        Ok(FractionTable {
            fractions,
            outputs: numerators.rows,
            inputs: numerators.columns,
        })
    }
}

/// Fields that give transfer functions as zeros, poles and gains.
struct Factors<'v> {
    zeros: &'v Value,
    poles: &'v Value,
    gains: &'v Value,
}

impl<'v> Factors<'v> {
    fn find(record: &Record<'v>) -> Option<Self> {
        let zeros = record.find(&["z", "Zeros"])?;
        let poles = record.find(&["p", "Poles"])?;
        let gains = record.find(&["k", "Gain"])?;
        Some(Self {
            zeros: record.take(zeros),
            poles: record.take(poles),
            gains: record.take(gains),
        })
    }

    fn fractions(&self) -> Result<FractionTable, RecognitionFault> {
        let zeros = CellTable::new(self.zeros);
        let poles = CellTable::new(self.poles).cells;
        let gains = match array_of(self.gains) {
            Some(array) => array.re.as_slice(),
            None => &[],
        };
        let mut fractions = Vec::with_capacity(zeros.cells.len());
        for (index, zeros) in zeros.cells.iter().enumerate() {
            let place = format!("response {}", index + 1);
            let Some(poles) = poles.get(index) else {
                return Err(RecognitionFault::ResponseWithout {
                    response: index + 1,
                    part: "poles",
                });
            };
            let Some(gain) = gains.get(index) else {
                return Err(RecognitionFault::ResponseWithout {
                    response: index + 1,
                    part: "gain",
                });
            };
            let zeros = complex_list_of("zeros", zeros)?;
            let poles = complex_list_of("poles", poles)?;
            at_most(zeros.len().max(poles.len()), "states", &place)?;
            let numerator: Vec<f64> = polynomial(&zeros).iter().map(|term| term * gain).collect();
            fractions.push(Fraction::new(&numerator, &polynomial(&poles), &place)?);
        }
        Ok(FractionTable {
            fractions,
            outputs: zeros.rows,
            inputs: zeros.columns,
        })
    }
}

/// A rational transfer function with a monic denominator; coefficients are in descending powers.
#[derive(Clone, Debug, PartialEq)]
struct Fraction {
    numerator: Vec<f64>,
    denominator: Vec<f64>,
}

impl Fraction {
    /// Creates a transfer function; removes leading zeros and makes the denominator monic.
    ///
    /// # Errors
    /// The reason if the denominator is zero, the numerator's degree exceeds the denominator's, or
    /// there are too many poles.
    fn new(numerator: &[f64], denominator: &[f64], place: &str) -> Result<Self, RecognitionFault> {
        at_most(denominator.len().saturating_sub(1), "states", place)?;
        let numerator = without_leading_zeros(numerator);
        let denominator = without_leading_zeros(denominator);
        let Some(&leading) = denominator.first() else {
            return Err(RecognitionFault::ZeroDenominator {
                place: place.to_owned(),
            });
        };
        if numerator.len() > denominator.len() {
            return Err(RecognitionFault::Improper {
                place: place.to_owned(),
            });
        }
        Ok(Self {
            numerator: numerator.iter().map(|term| term / leading).collect(),
            denominator: denominator.iter().map(|term| term / leading).collect(),
        })
    }

    fn order(&self) -> usize {
        self.denominator.len() - 1
    }

    /// Returns the numerator with leading zeros, so that it is as long as the denominator.
    fn padded_numerator(&self) -> Vec<f64> {
        let mut padded = vec![0.0; self.denominator.len() - self.numerator.len()];
        padded.extend(&self.numerator);
        padded
    }
}

fn without_leading_zeros(polynomial: &[f64]) -> &[f64] {
    match polynomial.iter().position(|term| *term != 0.0) {
        Some(first) => &polynomial[first..],
        None => &[],
    }
}

/// Transfer functions of all responses, with the output index fastest.
struct FractionTable {
    fractions: Vec<Fraction>,
    outputs: usize,
    inputs: usize,
}

/// Cells of a cell array in column-major order. Any other value counts as a 1 x 1 cell array.
struct CellTable<'v> {
    cells: Vec<&'v Value>,
    rows: usize,
    columns: usize,
}

impl<'v> CellTable<'v> {
    fn new(value: &'v Value) -> Self {
        match value {
            Value::Cell(cell) => Self {
                cells: cell.values.iter().collect(),
                rows: cell.shape.first().copied().unwrap_or(0),
                columns: cell.shape.get(1).copied().unwrap_or(0),
            },
            other => Self {
                cells: vec![other],
                rows: 1,
                columns: 1,
            },
        }
    }
}

/// Returns the coefficients of the real polynomial with these roots, in descending powers; complex
/// roots must come in conjugate pairs.
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
mod tests {
    use super::*;
    use crate::formats::variables::{Array, PageIndex, Variable};
    use crate::import::recognise::state_space::state_spaces;

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
        let model = transfer_function(&Record::from_variables(&variables), "g").unwrap();
        let s = Complex::new(0.3, 1.7);
        let expected = (s * s * 2.0 + s * 3.0 + 4.0) / (s * s * 2.0 + s * 5.0 + 7.0);
        // The tolerance allows a few rounding errors in numbers of magnitude 1.
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
        let model = transfer_function(&Record::from_variables(&variables), "").unwrap();
        let s = Complex::new(0.0, 2.5);
        let expected = (s + 3.0) * 5.0 / (s * s + s * 2.0 + 5.0);
        assert!((response(&model, s) - expected).norm() < 1e-14);
    }

    #[test]
    fn an_improper_fraction_is_refused() {
        let variables = [row("num", &[1.0, 0.0, 0.0]), row("den", &[1.0, 1.0])];
        let fault = transfer_function(&Record::from_variables(&variables), "").unwrap_err();
        let place = "response 1".to_owned();
        assert_eq!(fault, RecognitionFault::Improper { place });
    }

    #[test]
    fn more_states_than_a_dataset_holds_are_refused_before_there_is_a_matrix_of_them() {
        let long = vec![1.0; 30_000];
        let roots = [row("z", &[]), row("p", &long), row("k", &[1.0])];
        for variables in [&[row("num", &[1.0]), row("den", &long)][..], &roots] {
            let fault = transfer_function(&Record::from_variables(variables), "").unwrap_err();
            assert!(
                matches!(
                    &fault,
                    RecognitionFault::TooMany {
                        counted: "states",
                        ..
                    }
                ),
                "{fault:?}"
            );
        }
        let column = Variable {
            name: "C".into(),
            value: Value::Array(Array::matrix(30_000, 1, long.clone())),
        };
        let variables = [row("A", &[-1.0]), row("B", &long), column];
        let fault = state_spaces(&Record::from_variables(&variables), "", PageIndex::Last)
            .remove(0)
            .unwrap_err();
        let too_many = RecognitionFault::TooMany {
            place: "B".to_owned(),
            count: 30_000,
            counted: "inputs",
        };
        assert_eq!(fault, too_many);
    }
}
