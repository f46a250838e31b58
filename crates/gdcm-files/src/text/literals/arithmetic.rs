//! Arithmetic of constants.

use super::trouble::Trouble;
use crate::variables::{Array, ElementKind, MemoryBudget, Value};

/// Products of matrices take no more multiplications than this: a second's work.
const MOST_PRODUCTS: u64 = 1 << 30;

/// A scalar.
pub(super) fn scalar(re: f64, im: f64) -> Value {
    let im = (im != 0.0).then(|| vec![im]);
    Value::Array(Array { shape: vec![1, 1], kind: ElementKind::Float, re: vec![re], im })
}

/// An array of numbers, or what is there instead.
pub(super) fn numbers(value: Value) -> Result<Array, Trouble> {
    match value {
        Value::Array(array) => Ok(array),
        other => Err(Trouble::new(format!("{} stands where numbers are needed", other.words()))),
    }
}

/// A single real number.
pub(super) fn real(value: &Value) -> Result<f64, Trouble> {
    match value {
        Value::Array(Array { re, im: None, .. }) if re.len() == 1 => Ok(re[0]),
        other => Err(Trouble::new(format!("{} stands where a real number is needed", other.words()))),
    }
}

/// The value of `left operator right`.
pub(super) fn binary(left: Value, operator: &str, right: Value, meter: &MemoryBudget) -> Result<Value, Trouble> {
    let (left, right) = (numbers(left)?, numbers(right)?);
    let single = left.len() == 1 || right.len() == 1;
    let array = match operator {
        "+" => each(&left, &right, meter, |a, b| (a.0 + b.0, a.1 + b.1))?,
        "-" => each(&left, &right, meter, |a, b| (a.0 - b.0, a.1 - b.1))?,
        ".*" => each(&left, &right, meter, times)?,
        "*" if single => each(&left, &right, meter, times)?,
        "*" => product(&left, &right, meter)?,
        "./" => each(&left, &right, meter, over)?,
        "/" if right.len() == 1 => each(&left, &right, meter, over)?,
        ".^" => power(&left, &right, meter)?,
        "^" if left.len() == 1 && right.len() == 1 => power(&left, &right, meter)?,
        _ => return Err(Trouble::new(format!("matrices cannot be combined by \"{operator}\"; write the numbers"))),
    };
    Ok(Value::Array(array))
}

type Complex = (f64, f64);

/// Real numbers stay free of the rounding of complex products.
fn times(a: Complex, b: Complex) -> Complex {
    if a.1 == 0.0 && b.1 == 0.0 { (a.0 * b.0, 0.0) } else { (a.0 * b.0 - a.1 * b.1, a.0 * b.1 + a.1 * b.0) }
}

fn over(a: Complex, b: Complex) -> Complex {
    if b.1 == 0.0 {
        return (a.0 / b.0, if a.1 == 0.0 { 0.0 } else { a.1 / b.0 });
    }
    let (re, im) = times(a, (b.0, -b.1));
    let size = b.0 * b.0 + b.1 * b.1;
    (re / size, im / size)
}

fn at(array: &Array, index: usize) -> Complex {
    let index = if array.len() == 1 { 0 } else { index };
    (array.re[index], array.im.as_ref().map_or(0.0, |im| im[index]))
}

/// Combines arrays element by element; a scalar goes with every element.
fn each(
    left: &Array,
    right: &Array,
    meter: &MemoryBudget,
    combine: impl Fn(Complex, Complex) -> Complex,
) -> Result<Array, Trouble> {
    let shape = if left.len() == 1 { &right.shape } else { &left.shape };
    if left.len() != 1 && right.len() != 1 && left.shape != right.shape {
        let (left, right) = (Value::Array(left.clone()).words(), Value::Array(right.clone()).words());
        return Err(Trouble::new(format!("{left} and {right} do not go together element by element")));
    }
    let count: usize = shape.iter().product();
    meter.take(count as u64, 16, "")?;
    let (re, im): (Vec<f64>, Vec<f64>) = (0..count).map(|i| combine(at(left, i), at(right, i))).unzip();
    Ok(plain(Array { shape: shape.clone(), kind: ElementKind::Float, re, im: Some(im) }))
}

/// An array without imaginary parts where all are zero.
fn plain(mut array: Array) -> Array {
    array.im = array.im.filter(|im| im.iter().any(|&im| im != 0.0));
    array
}

fn power(left: &Array, right: &Array, meter: &MemoryBudget) -> Result<Array, Trouble> {
    let real = left.im.is_none() && right.im.is_none();
    let fractional = right.re.iter().any(|power| power.fract() != 0.0) && left.re.iter().any(|&base| base < 0.0);
    if !real || fractional {
        return Err(Trouble::new("this power is a complex number; write its value"));
    }
    each(left, right, meter, |a, b| (a.0.powf(b.0), 0.0))
}

fn product(left: &Array, right: &Array, meter: &MemoryBudget) -> Result<Array, Trouble> {
    let (rows, inner, columns) = (left.shape[0], left.shape[1], right.shape[1]);
    if inner != right.shape[0] {
        let (left, right) = (Value::Array(left.clone()).words(), Value::Array(right.clone()).words());
        return Err(Trouble::new(format!("{left} cannot be multiplied by {right}")));
    }
    let size = rows as u64 * columns as u64;
    if size.saturating_mul(inner as u64) > MOST_PRODUCTS {
        return Err(Trouble::new("this product is too large; write its numbers"));
    }
    meter.take(size, 16, "")?;
    let (mut re, mut im) = (vec![0.0; rows * columns], vec![0.0; rows * columns]);
    for column in 0..columns {
        meter.take(0, 1, "")?;
        for k in 0..inner {
            let factor = (right.re[column * inner + k], right.im.as_ref().map_or(0.0, |im| im[column * inner + k]));
            for row in 0..rows {
                let index = k * rows + row;
                let (a, b) = times((left.re[index], left.im.as_ref().map_or(0.0, |im| im[index])), factor);
                re[column * rows + row] += a;
                im[column * rows + row] += b;
            }
        }
    }
    Ok(plain(Array { shape: vec![rows, columns], kind: ElementKind::Float, re, im: Some(im) }))
}

/// Rows and columns exchanged; `conjugate` as the quote does it.
pub(super) fn transposed(value: Value, conjugate: bool) -> Result<Value, Trouble> {
    let order = |rows: usize, columns: usize| (0..rows).flat_map(move |r| (0..columns).map(move |c| c * rows + r));
    match value {
        Value::Array(Array { shape, kind, re, im }) => {
            let (rows, columns) = (shape[0], shape[1]);
            let sign = if conjugate { -1.0 } else { 1.0 };
            let im = im.map(|im| order(rows, columns).map(|index| sign * im[index]).collect());
            let re = order(rows, columns).map(|index| re[index]).collect();
            Ok(Value::Array(Array { shape: vec![columns, rows], kind, re, im }))
        }
        Value::Cell(mut cell) if cell.shape.contains(&1) => {
            cell.shape.reverse();
            Ok(Value::Cell(cell))
        }
        other => Err(Trouble::new(format!("{} cannot be transposed; write it the other way round", other.words()))),
    }
}

/// The numbers from `first` to `last` in steps.
pub(super) fn range(first: &Value, step: &Value, last: &Value, meter: &MemoryBudget) -> Result<Value, Trouble> {
    let (first, step, last) = (real(first)?, real(step)?, real(last)?);
    let steps = (last - first) / step;
    if !steps.is_finite() {
        return Err(Trouble::new("this range has no end; write its numbers"));
    }
    // As many steps as fit, with room for the rounding of their division.
    let count = (steps * (1.0 + 1e-15) + 1e-10).floor();
    let count = if count < 0.0 { 0 } else { count as u64 + 1 };
    meter.take(count, 8, "")?;
    let values: Vec<f64> = (0..count).map(|index| first + index as f64 * step).collect();
    Ok(Value::Array(Array::matrix(1, values.len(), values)))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn matrix(rows: usize, columns: usize, values: &[f64]) -> Value {
        Value::Array(Array::matrix(rows, columns, values.to_vec()))
    }

    fn combine(left: Value, operator: &str, right: Value) -> Result<Value, Trouble> {
        binary(left, operator, right, &MemoryBudget::new(1 << 20, &|_| false))
    }

    #[test]
    fn matrices_are_multiplied_and_scaled() {
        let a = matrix(2, 2, &[1.0, 3.0, 2.0, 4.0]);
        assert_eq!(combine(a.clone(), "*", matrix(2, 1, &[1.0, 1.0])).unwrap(), matrix(2, 1, &[3.0, 7.0]));
        assert_eq!(combine(scalar(2.0, 0.0), "*", a.clone()).unwrap(), matrix(2, 2, &[2.0, 6.0, 4.0, 8.0]));
        assert!(combine(a, "*", matrix(1, 2, &[1.0, 1.0])).is_err());
    }

    #[test]
    fn complex_numbers_multiply_and_divide() {
        assert_eq!(combine(scalar(1.0, 2.0), "*", scalar(3.0, -1.0)).unwrap(), scalar(5.0, 5.0));
        assert_eq!(combine(scalar(5.0, 5.0), "/", scalar(3.0, -1.0)).unwrap(), scalar(1.0, 2.0));
        assert_eq!(transposed(scalar(1.0, 2.0), true).unwrap(), scalar(1.0, -2.0));
    }

    #[test]
    fn ranges_include_their_end_despite_rounding() {
        let meter = MemoryBudget::new(1 << 20, &|_| false);
        let of = |first, step, last| range(&scalar(first, 0.0), &scalar(step, 0.0), &scalar(last, 0.0), &meter);
        assert_eq!(numbers(of(0.0, 0.1, 0.3).unwrap()).unwrap().len(), 4);
        assert_eq!(of(3.0, 1.0, 1.0).unwrap(), matrix(1, 0, &[]));
        assert!(of(0.0, 0.0, 1.0).is_err());
        assert!(matches!(of(0.0, 1.0, 1e18), Err(Trouble::Fault(_))));
    }
}
