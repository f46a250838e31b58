//! Models by numerators and denominators, or by zeros, poles and gains.

use nalgebra::{Complex, DMatrix};

use crate::variables::{CellArray, Value};
use gdcm_core::assembly::FoundModel;

use super::labels::timing_of;
use super::matrix::{array_of, complex_list_of, list_of};
use super::record::Record;
use super::state_space::found;

/// Whether fields are those of transfer functions.
pub(super) fn is_transfer_function(record: &Record<'_>) -> bool {
    polynomials(record).is_some() || factors(record).is_some()
}

fn polynomials<'v>(record: &Record<'v>) -> Option<(&'v Value, &'v Value)> {
    let numerator = record.get(&["num", "Numerator"])?;
    Some((numerator, record.get(&["den", "Denominator"])?))
}

fn factors<'v>(record: &Record<'v>) -> Option<(&'v Value, &'v Value, &'v Value)> {
    Some((record.get(&["z", "Zeros"])?, record.get(&["p", "Poles"])?, record.get(&["k", "Gain"])?))
}

/// One response as a fraction of polynomials, highest power first; the denominator begins with 1.
#[derive(Clone, Debug, PartialEq)]
struct Fraction {
    numerator: Vec<f64>,
    denominator: Vec<f64>,
}

impl Fraction {
    /// The fraction in lowest form of leading coefficients; refused where it is not proper.
    fn new(numerator: &[f64], denominator: &[f64], place: &str) -> Result<Self, String> {
        let strip = |polynomial: &[f64]| -> Vec<f64> {
            let first = polynomial.iter().position(|coefficient| *coefficient != 0.0).unwrap_or(polynomial.len());
            polynomial[first..].to_vec()
        };
        let (numerator, denominator) = (strip(numerator), strip(denominator));
        let Some(&leading) = denominator.first() else { return Err(format!("{place}: the denominator is zero")) };
        if numerator.len() > denominator.len() {
            return Err(format!(
                "{place}: the numerator is of higher degree than the denominator; such a response has no state-space form"
            ));
        }
        let scaled = |polynomial: Vec<f64>| polynomial.into_iter().map(|coefficient| coefficient / leading).collect();
        Ok(Self { numerator: scaled(numerator), denominator: scaled(denominator) })
    }

    fn order(&self) -> usize {
        self.denominator.len() - 1
    }

    /// The numerator, filled up with zeros to the length of the denominator.
    fn padded(&self) -> Vec<f64> {
        let mut padded = vec![0.0; self.denominator.len() - self.numerator.len()];
        padded.extend(&self.numerator);
        padded
    }
}

/// The state-space model of the transfer functions in `record`: each response in controllable canonical form, side by side.
///
/// ```text
/// H(s) = d + (c_1 s^(n-1) + ... + c_n) / (s^n + a_1 s^(n-1) + ... + a_n)
/// A = [-a_1 ... -a_n; I 0],   B = [1; 0; ...; 0],   C = [c_1 ... c_n],   D = d
/// ```
pub(super) fn transfer_function(record: &Record<'_>, variable: &str) -> Result<FoundModel, String> {
    let (fractions, outputs, inputs) = fractions_of(record)?;
    let order: usize = fractions.iter().map(Fraction::order).sum();
    let mut a = DMatrix::zeros(order, order);
    let mut b = DMatrix::zeros(order, inputs);
    let mut c = DMatrix::zeros(outputs, order);
    let mut d = DMatrix::zeros(outputs, inputs);
    let mut start = 0;
    for (index, fraction) in fractions.iter().enumerate() {
        let (output, input, n) = (index % outputs, index / outputs, fraction.order());
        let numerator = fraction.padded();
        d[(output, input)] = numerator[0];
        for state in 0..n {
            a[(start, start + state)] = -fraction.denominator[state + 1];
            c[(output, start + state)] = numerator[state + 1] - numerator[0] * fraction.denominator[state + 1];
        }
        for state in 1..n {
            a[(start + state, start + state - 1)] = 1.0;
        }
        if n > 0 {
            b[(start, input)] = 1.0;
        }
        start += n;
    }
    let timing = timing_of(record, (inputs, outputs))?;
    let mut model = found(record, variable, [a, b, c, d], timing);
    model.notes.push("transfer functions, each realised by itself".to_owned());
    Ok(model)
}

/// The fractions, first index running fastest, and the numbers of outputs and inputs.
fn fractions_of(record: &Record<'_>) -> Result<(Vec<Fraction>, usize, usize), String> {
    if let Some((numerators, denominators)) = polynomials(record) {
        let (numerators, outputs, inputs) = cells(numerators);
        let (denominators, ..) = cells(denominators);
        let fraction = |(index, numerator): (usize, &&Value)| {
            let place = format!("response {}", index + 1);
            // One denominator may stand for all.
            let denominator =
                denominators.get(index).or(denominators.first()).ok_or_else(|| format!("{place}: no denominator"))?;
            Fraction::new(&list_of("numerator", numerator)?, &list_of("denominator", denominator)?, &place)
        };
        let fractions = numerators.iter().enumerate().map(fraction).collect::<Result<_, _>>()?;
        return Ok((fractions, outputs, inputs));
    }
    let (zeros, poles, gains) = factors(record).ok_or_else(|| "no transfer function".to_owned())?;
    let (zeros, outputs, inputs) = cells(zeros);
    let (poles, ..) = cells(poles);
    let gains = array_of(gains).map(|array| array.re.clone()).unwrap_or_default();
    let fraction = |(index, zeros): (usize, &&Value)| {
        let place = format!("response {}", index + 1);
        let poles = poles.get(index).ok_or_else(|| format!("{place}: no poles"))?;
        let gain = gains.get(index).ok_or_else(|| format!("{place}: no gain"))?;
        let numerator: Vec<f64> =
            polynomial(&complex_list_of("zeros", zeros)?).iter().map(|term| term * gain).collect();
        Fraction::new(&numerator, &polynomial(&complex_list_of("poles", poles)?), &place)
    };
    let fractions = zeros.iter().enumerate().map(fraction).collect::<Result<_, _>>()?;
    Ok((fractions, outputs, inputs))
}

/// The values of a cell array, and its rows and columns; a value by itself is one of one.
fn cells(value: &Value) -> (Vec<&Value>, usize, usize) {
    match value {
        Value::Cell(CellArray { shape, values }) => {
            let rows = shape.first().copied().unwrap_or(0);
            (values.iter().collect(), rows, shape.get(1).copied().unwrap_or(0))
        }
        other => (vec![other], 1, 1),
    }
}

/// The polynomial with these roots, highest power first; conjugate pairs leave it real.
fn polynomial(roots: &[Complex<f64>]) -> Vec<f64> {
    let mut coefficients = vec![Complex::new(1.0, 0.0)];
    for root in roots {
        coefficients.push(Complex::new(0.0, 0.0));
        for index in (1..coefficients.len()).rev() {
            let before = coefficients[index - 1];
            coefficients[index] -= root * before;
        }
    }
    coefficients.iter().map(|coefficient| coefficient.re).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::variables::{Array, Variable};

    fn row(name: &str, values: &[f64]) -> Variable {
        Variable { name: name.into(), value: Value::Array(Array::matrix(1, values.len(), values.to_vec())) }
    }

    fn response(model: &FoundModel, s: Complex<f64>) -> Complex<f64> {
        let [a, b, c, d] =
            model.draft.matrices.clone().map(|matrix| matrix.unwrap().map(|entry| Complex::new(entry, 0.0)));
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
        // A few roundings of numbers of order one.
        assert!((response(&model, s) - expected).norm() < 1e-14);
    }

    #[test]
    fn zeros_poles_and_a_gain_are_the_same_as_their_polynomials() {
        let pair = |name: &str, re: f64, im: f64| {
            let array = Array { im: Some(vec![im, -im]), ..Array::matrix(2, 1, vec![re, re]) };
            Variable { name: name.into(), value: Value::Array(array) }
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
}
