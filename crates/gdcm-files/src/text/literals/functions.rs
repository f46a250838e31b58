//! Functions of constants.

use super::arithmetic::{numbers, real, scalar, transposed};
use super::trouble::Trouble;
use crate::variables::{Array, ElementKind, MemoryBudget, StructArray, Value};

type OfElement = fn(f64) -> f64;

/// Functions of one real number, element by element.
const OF_ELEMENTS: [(&str, OfElement); 14] = [
    ("sqrt", f64::sqrt),
    ("exp", f64::exp),
    ("log", f64::ln),
    ("log10", f64::log10),
    ("sin", f64::sin),
    ("cos", f64::cos),
    ("tan", f64::tan),
    ("asin", f64::asin),
    ("acos", f64::acos),
    ("atan", f64::atan),
    ("abs", f64::abs),
    ("deg2rad", f64::to_radians),
    ("rad2deg", f64::to_degrees),
    ("double", |x| x),
];

/// The value of a name that is no variable.
pub(super) fn constant(name: &str) -> Option<Value> {
    let truth = |value| Value::Array(Array { kind: ElementKind::Logical, ..Array::matrix(1, 1, vec![value]) });
    match name {
        "pi" => Some(scalar(std::f64::consts::PI, 0.0)),
        "inf" | "Inf" => Some(scalar(f64::INFINITY, 0.0)),
        "nan" | "NaN" => Some(scalar(f64::NAN, 0.0)),
        "eps" => Some(scalar(f64::EPSILON, 0.0)),
        "i" | "j" | "I" | "J" => Some(scalar(0.0, 1.0)),
        "true" => Some(truth(1.0)),
        "false" => Some(truth(0.0)),
        _ => None,
    }
}

/// The value of a function.
pub(super) fn call(name: &str, arguments: Vec<Value>, meter: &MemoryBudget) -> Result<Value, Trouble> {
    if let Some((_, function)) = OF_ELEMENTS.iter().find(|(known, _)| *known == name) {
        return of_elements(name, *function, arguments);
    }
    match (name, arguments.as_slice()) {
        ("zeros", _) => filled(&arguments, meter, |_, _| 0.0),
        ("ones", _) => filled(&arguments, meter, |_, _| 1.0),
        ("nan" | "NaN", _) => filled(&arguments, meter, |_, _| f64::NAN),
        ("inf" | "Inf", _) => filled(&arguments, meter, |_, _| f64::INFINITY),
        ("eye", _) => filled(&arguments, meter, |row, column| f64::from(u8::from(row == column))),
        ("diag", [_]) => diagonal(arguments, meter),
        ("transpose", [value]) => transposed(value.clone(), false),
        ("complex", [re, im]) => Ok(scalar(real(re)?, real(im)?)),
        ("linspace", [first, last, count]) => spaced(first, last, count, meter, |x| x),
        ("logspace", [first, last, count]) => spaced(first, last, count, meter, |x| 10_f64.powf(x)),
        ("size" | "numel" | "length" | "rows" | "columns", [value, rest @ ..]) => size(name, value, rest),
        ("string" | "char", [Value::Text(_)]) => arguments.into_iter().next().ok_or_else(|| unknown(name)),
        ("struct", _) => fields(arguments),
        ("ss", _) => state_space(arguments),
        _ => Err(unknown(name)),
    }
}

fn unknown(name: &str) -> Trouble {
    Trouble::new(format!("{name}(…) is not computed here; write its numbers, or save the variables as a .mat file"))
}

fn of_elements(name: &str, function: OfElement, arguments: Vec<Value>) -> Result<Value, Trouble> {
    let [value] = <[Value; 1]>::try_from(arguments).map_err(|_| Trouble::new(format!("{name}(…) takes one value")))?;
    let array = numbers(value)?;
    let re: Vec<f64> = array.re.iter().map(|&x| function(x)).collect();
    let outside = re.iter().zip(&array.re).any(|(y, x)| y.is_nan() && !x.is_nan());
    if array.im.is_some() || outside {
        return Err(Trouble::new(format!("{name}(…) of these numbers is complex; write its value")));
    }
    Ok(Value::Array(Array { kind: ElementKind::Float, re, ..array }))
}

/// A whole number that is no more than memory could hold.
fn count(value: f64) -> Result<usize, Trouble> {
    if value.fract() == 0.0 && value < 1e15 {
        Ok(value.max(0.0) as usize)
    } else {
        Err(Trouble::new(format!("{value} is no number of elements")))
    }
}

fn filled(arguments: &[Value], meter: &MemoryBudget, value: impl Fn(usize, usize) -> f64) -> Result<Value, Trouble> {
    let (rows, columns) = match arguments {
        [] => (1, 1),
        [Value::Array(Array { re, im: None, .. })] if re.len() == 2 => (count(re[0])?, count(re[1])?),
        [side] => (count(real(side)?)?, count(real(side)?)?),
        [rows, columns] => (count(real(rows)?)?, count(real(columns)?)?),
        _ => return Err(Trouble::new("arrays of more than two dimensions are not read; save them as a .mat file")),
    };
    meter.take((rows as u64).saturating_mul(columns as u64), 8, "")?;
    let values = (0..columns).flat_map(|column| (0..rows).map(move |row| (row, column)));
    Ok(Value::Array(Array::matrix(rows, columns, values.map(|(row, column)| value(row, column)).collect())))
}

/// A square matrix with these numbers on its diagonal, or the diagonal of a matrix.
fn diagonal(arguments: Vec<Value>, meter: &MemoryBudget) -> Result<Value, Trouble> {
    let mut found = Vec::with_capacity(1);
    for value in arguments {
        found.push(numbers(value)?);
    }
    let [array] = <[Array; 1]>::try_from(found).map_err(|_| unknown("diag"))?;
    if array.im.is_some() {
        return Err(Trouble::new("diag(…) of complex numbers is not computed here; write the matrix"));
    }
    let (rows, columns) = (array.shape[0], array.shape[1]);
    if rows != 1 && columns != 1 {
        let values: Vec<f64> = (0..rows.min(columns)).map(|index| array.re[index * rows + index]).collect();
        return Ok(Value::Array(Array::matrix(values.len(), 1, values)));
    }
    let side = array.len();
    meter.take((side as u64).saturating_mul(side as u64), 8, "diag")?;
    let mut values = vec![0.0; side * side];
    for (index, value) in array.re.iter().enumerate() {
        values[index * side + index] = *value;
    }
    Ok(Value::Array(Array::matrix(side, side, values)))
}

fn spaced(
    first: &Value,
    last: &Value,
    number: &Value,
    meter: &MemoryBudget,
    function: OfElement,
) -> Result<Value, Trouble> {
    let (first, last, number) = (real(first)?, real(last)?, count(real(number)?)?);
    meter.take(number as u64, 8, "")?;
    let at = |index: usize| {
        let end = index + 1 == number;
        if end { last } else { first + (last - first) * index as f64 / (number - 1) as f64 }
    };
    Ok(Value::Array(Array::matrix(1, number, (0..number).map(|index| function(at(index))).collect())))
}

fn size(name: &str, value: &Value, rest: &[Value]) -> Result<Value, Trouble> {
    let shape = match value {
        Value::Array(array) => &array.shape,
        Value::Cell(cell) => &cell.shape,
        other => return Err(Trouble::new(format!("the size of {} is not known here; write it", other.words()))),
    };
    let (rows, columns) = (shape[0] as f64, shape[1] as f64);
    match (name, rest) {
        ("size", []) => Ok(Value::Array(Array::matrix(1, 2, vec![rows, columns]))),
        ("size", [dimension]) if real(dimension)? == 1.0 => Ok(scalar(rows, 0.0)),
        ("size", [dimension]) if real(dimension)? == 2.0 => Ok(scalar(columns, 0.0)),
        ("rows", []) => Ok(scalar(rows, 0.0)),
        ("columns", []) => Ok(scalar(columns, 0.0)),
        ("numel", []) => Ok(scalar(rows * columns, 0.0)),
        ("length", []) => Ok(scalar(if rows * columns == 0.0 { 0.0 } else { rows.max(columns) }, 0.0)),
        _ => Err(unknown(name)),
    }
}

/// Names and values in turn as the fields of one record.
fn fields(arguments: Vec<Value>) -> Result<Value, Trouble> {
    let mut fields: Vec<(String, Vec<Value>)> = Vec::with_capacity(arguments.len() / 2);
    let mut rest = arguments.into_iter();
    while let Some(name) = rest.next() {
        let (Value::Text(name), Some(value)) = (name, rest.next()) else {
            return Err(Trouble::new("names and values must stand in turn: struct('A',A,'B',B)"));
        };
        if matches!(value, Value::Cell(_)) {
            return Err(Trouble::new("struct(…) of cells is an array of records; write s.name = {…} instead"));
        }
        let name = name.texts.concat();
        fields.retain(|(known, _)| *known != name);
        fields.push((name, vec![value]));
    }
    Ok(record(fields))
}

/// One record.
pub(super) fn record(fields: Vec<(String, Vec<Value>)>) -> Value {
    Value::Struct(StructArray { shape: vec![1, 1], fields })
}

/// A model as a record with the fields A, B, C, D and Ts \[s\] (0 in continuous time), and what is said by name and value.
fn state_space(arguments: Vec<Value>) -> Result<Value, Trouble> {
    let mut rest = arguments.into_iter().peekable();
    let mut fields = Vec::with_capacity(5);
    for name in ["A", "B", "C", "D"] {
        let array = rest.next().map(numbers).transpose()?;
        let array = array.ok_or_else(|| Trouble::new("ss(…) needs the four matrices A, B, C and D"))?;
        fields.push((name.to_owned(), vec![Value::Array(array)]));
    }
    let step = match rest.peek() {
        None | Some(Value::Text(_)) => 0.0,
        Some(value) => real(value)?,
    };
    if !matches!(rest.peek(), None | Some(Value::Text(_))) {
        rest.next();
    }
    fields.push(("Ts".to_owned(), vec![scalar(step, 0.0)]));
    while let Some(name) = rest.next() {
        let (Value::Text(name), Some(value)) = (name, rest.next()) else {
            return Err(Trouble::new("names and values must stand in turn: ss(A,B,C,D,'InputName',{'LAT'})"));
        };
        fields.push((name.texts.concat(), vec![value]));
    }
    Ok(record(fields))
}
