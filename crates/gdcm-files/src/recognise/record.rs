//! Fields under names, wherever they stand: in a struct, in an object, in a file.

use std::cell::OnceCell;
use std::collections::HashMap;

use gdcm_core::assembly::{ChannelLabel, Facts, SAMPLE_TIME_NAMES, direction_of, folded_name};
use gdcm_core::dataset::{GREATEST_CHANNEL_DELAY_S, Timing};
use gdcm_core::units::number;
use nalgebra::{Complex, DMatrix};

use crate::variables::{Array, StructArray, Value, Variable};

/// Parts in which objects of MATLAB and GNU Octave keep what other files have beside the rest.
const INNER_PARTS: [&str; 4] = ["data", "structure", "lti", RESPONSE_PART];
/// Where a model of this program has its measured response.
const RESPONSE_PART: &str = "frequencyresponse";
/// Deepest of these parts inside one another.
const DEEPEST_PART: usize = 3;

/// The first field of each name; made when a record is first asked, for one may have as many fields as a file has bytes.
#[derive(Clone, Debug, Default)]
struct Index<'v> {
    exact: HashMap<&'v str, &'v Value>,
    /// Without case and underscores.
    folded: HashMap<String, &'v Value>,
}

/// Fields that belong together.
#[derive(Clone, Debug, Default)]
pub(crate) struct Record<'v> {
    fields: Vec<(&'v str, &'v Value)>,
    index: OnceCell<Index<'v>>,
    /// The class, where it is an object.
    pub(crate) class: Option<&'v str>,
    /// Whether it is a struct or an object, and not the variables of a file.
    pub(crate) stands_alone: bool,
}

impl<'v> Record<'v> {
    /// The variables of a file.
    pub(crate) fn of_variables(variables: &'v [Variable]) -> Self {
        Self::of_fields(variables.iter().map(|variable| (variable.name.as_str(), &variable.value)))
    }

    /// Values under names that stand beside others.
    pub(crate) fn of_fields(fields: impl Iterator<Item = (&'v str, &'v Value)>) -> Self {
        Self { fields: fields.collect(), ..Self::default() }
    }

    /// One record of a struct array. Of an object also what lies in its inner parts, the `page`-th where they are arrays: objects of
    /// MATLAB keep their numbers in `Data_`.
    pub(crate) fn of_struct(records: &'v StructArray, index: usize, class: Option<&'v str>, page: usize) -> Self {
        let mut fields = fields_of(records, index);
        let holds_response = fields.iter().any(|(name, _)| folded_name(name) == RESPONSE_PART);
        if class.is_some() || holds_response {
            add_inner(&mut fields, page, DEEPEST_PART);
        }
        Self { fields, class, stands_alone: true, ..Self::default() }
    }

    /// Number of models that an object is an array of: each has a record of numbers of its own.
    pub(crate) fn pages(records: &StructArray, index: usize) -> usize {
        let data = fields_of(records, index).into_iter().find(|(name, _)| folded_name(name) == "data");
        match data {
            Some((_, Value::Object(object))) => object.records.shape.iter().product(),
            _ => 1,
        }
    }

    /// The field of the first of these names that there is: as it is written, else without case and underscores.
    pub(crate) fn get(&self, names: &[&str]) -> Option<&'v Value> {
        let exact = names.iter().find_map(|name| self.exact(name));
        let loose = |name: &&str| self.index().folded.get(&folded_name(name)).copied();
        exact.or_else(|| names.iter().find_map(loose))
    }

    /// The field of this very name.
    pub(crate) fn exact(&self, name: &str) -> Option<&'v Value> {
        self.index().exact.get(name).copied()
    }

    fn index(&self) -> &Index<'v> {
        self.index.get_or_init(|| {
            let mut index = Index::default();
            for &(name, value) in &self.fields {
                index.exact.entry(name).or_insert(value);
                index.folded.entry(folded_name(name)).or_insert(value);
            }
            index
        })
    }

    /// Names and values, in order.
    pub(crate) fn fields(&self) -> impl Iterator<Item = (&'v str, &'v Value)> + '_ {
        self.fields.iter().copied()
    }
}

fn fields_of(records: &StructArray, index: usize) -> Vec<(&str, &Value)> {
    let values = records.fields.iter();
    values.filter_map(|(name, values)| Some((name.as_str(), values.get(index)?))).collect()
}

/// Appends what lies in the inner parts of an object, and in theirs; what stands outside goes first.
fn add_inner<'v>(fields: &mut Vec<(&'v str, &'v Value)>, page: usize, deeper: usize) {
    if deeper == 0 {
        return;
    }
    let parts: Vec<&'v StructArray> = fields
        .iter()
        .filter(|(name, _)| INNER_PARTS.contains(&folded_name(name).as_str()))
        .filter_map(|(_, value)| match value {
            Value::Object(object) => Some(&object.records),
            Value::Struct(records) => Some(records),
            Value::Array(_) | Value::Text(_) | Value::Cell(_) | Value::Opaque { .. } => None,
        })
        .collect();
    for records in parts {
        let mut inner = fields_of(records, page);
        add_inner(&mut inner, 0, deeper - 1);
        fields.append(&mut inner);
    }
}

// Names, units and facts beside the numbers of a model.

const INPUT_NAMES: &[&str] =
    &["InputName", "inputs", "inname", "input_names", "input_labels", "InputLabels", "u_names", "unames", "input"];
const OUTPUT_NAMES: &[&str] = &[
    "OutputName",
    "outputs",
    "outname",
    "output_names",
    "output_labels",
    "OutputLabels",
    "y_names",
    "ynames",
    "output",
];
const INPUT_UNITS: &[&str] = &["InputUnit", "input_units", "InputUnits", "u_units"];
const OUTPUT_UNITS: &[&str] = &["OutputUnit", "output_units", "OutputUnits", "y_units"];
const STATE_NAMES: &[&str] = &["StateName", "stname", "states", "state_names", "state_labels", "x_names", "xnames"];

/// Texts in a value: an array of texts, a cell array of them.
pub(crate) fn texts_of(value: &Value) -> Option<Vec<String>> {
    let trimmed = |text: &String| text.trim().to_owned();
    match value {
        Value::Text(text) => Some(text.texts.iter().map(trimmed).collect()),
        Value::Cell(cell) => {
            cell.values.iter().map(|value| Some(texts_of(value)?.into_iter().next().unwrap_or_default())).collect()
        }
        Value::Array(array) if array.is_empty() => Some(Vec::new()),
        Value::Array(_) | Value::Struct(_) | Value::Object(_) | Value::Opaque { .. } => None,
    }
}

/// The inputs of a model of `count`.
pub(super) fn inputs_of(record: &Record<'_>, count: usize) -> Vec<ChannelLabel> {
    labels(record, INPUT_NAMES, INPUT_UNITS, count)
}

/// The outputs of a model of `count`.
pub(super) fn outputs_of(record: &Record<'_>, count: usize) -> Vec<ChannelLabel> {
    labels(record, OUTPUT_NAMES, OUTPUT_UNITS, count)
}

/// Names of the states, where there are as many as states.
pub(super) fn states_of(record: &Record<'_>, order: usize) -> Vec<String> {
    let names = record.get(STATE_NAMES).and_then(texts_of).unwrap_or_default();
    if names.len() == order && names.iter().all(|name| !name.is_empty()) { names } else { Vec::new() }
}

/// Labels of `count` channels; a list of another length is none.
fn labels(record: &Record<'_>, names: &[&str], units: &[&str], count: usize) -> Vec<ChannelLabel> {
    let list = |keys: &[&str]| record.get(keys).and_then(texts_of).filter(|list| list.len() == count);
    let (names, units) = (list(names), list(units));
    let label = |index: usize| {
        let label = names.as_ref().map(|names| label_of(&names[index])).unwrap_or_default();
        let unit = units.as_ref().map(|units| units[index].clone()).filter(|unit| !unit.is_empty());
        ChannelLabel { unit: unit.or(label.unit), ..label }
    };
    (0..count).map(label).collect()
}

/// A label as engineers write it: "P", "P [deg/s]", "P (deg/s)".
pub(crate) fn label_of(text: &str) -> ChannelLabel {
    let text = text.trim();
    for (open, close) in [('[', ']'), ('(', ')')] {
        if let Some((name, unit)) = text.strip_suffix(close).and_then(|text| text.split_once(open))
            && !name.trim().is_empty()
            && !unit.trim().is_empty()
            && direction_of(unit).is_none()
        {
            return ChannelLabel { name: Some(name.trim().to_owned()), unit: Some(unit.trim().to_owned()) };
        }
    }
    ChannelLabel { name: Some(text.to_owned()).filter(|name| !name.is_empty()), unit: None }
}

/// Sample time and delays; those of MATLAB's discrete-time models are counted in samples.
pub(super) fn timing_of(record: &Record<'_>, (inputs, outputs): (usize, usize)) -> Result<Timing, String> {
    let sample_time_s = sample_time_of(record)?;
    let delay = match record.get(&["Delay"]) {
        Some(Value::Struct(records)) => Record::of_struct(records, 0, None, 0),
        _ => Record::default(),
    };
    refuse_other_delays(record, &delay)?;
    let in_samples = sample_time_s.filter(|_| record.get(&["input_delays_s", "output_delays_s"]).is_none());
    let delays = |name: &str, value: Option<&Value>, count: usize| -> Result<Option<Vec<f64>>, String> {
        let Some(value) = value else { return Ok(None) };
        let mut delays = list_of(name, value)?;
        if delays.len() == 1 {
            delays = vec![delays[0]; count];
        }
        if delays.is_empty() || delays.iter().all(|delay| *delay == 0.0) {
            return Ok(None);
        }
        delays.iter_mut().for_each(|delay| *delay *= in_samples.unwrap_or(1.0));
        match delays.iter().find(|delay| !(0.0..=GREATEST_CHANNEL_DELAY_S).contains(*delay)) {
            Some(delay) => {
                Err(format!("{name}: expected delays from 0 to {GREATEST_CHANNEL_DELAY_S} s, found {}", number(*delay)))
            }
            None if delays.len() != count => Err(format!("{name}: expected {count} delays, found {}", delays.len())),
            None => Ok(Some(delays)),
        }
    };
    let input = record.get(&["InputDelay", "input_delays_s"]).or_else(|| delay.get(&["Input"]));
    let output = record.get(&["OutputDelay", "output_delays_s"]).or_else(|| delay.get(&["Output"]));
    Ok(Timing {
        sample_time_s,
        input_delays_s: delays("input delays", input, inputs)?,
        output_delays_s: delays("output delays", output, outputs)?,
    })
}

fn sample_time_of(record: &Record<'_>) -> Result<Option<f64>, String> {
    let Some(value) = record.get(&SAMPLE_TIME_NAMES) else { return Ok(None) };
    match scalar_of(value) {
        Some(0.0) => Ok(None),
        Some(sample_time) if sample_time > 0.0 => Ok(Some(sample_time)),
        Some(sample_time) => Err(format!(
            "the sample time is {}: a discrete-time model whose sample time is not said cannot be compared; set Ts",
            number(sample_time)
        )),
        None if array_of(value).is_some_and(|array| array.is_empty()) => Ok(None),
        None => Err(format!("the sample time: expected a number, found {}", value.words())),
    }
}

/// Delays between single channels, and inside the model, are not what a gain and a delay of each channel can have.
fn refuse_other_delays(record: &Record<'_>, delay: &Record<'_>) -> Result<(), String> {
    let found = [
        ("internal", record.get(&["InternalDelay"]).or_else(|| delay.get(&["Internal"]))),
        ("input-output", record.get(&["IODelay"]).or_else(|| delay.get(&["IO"]))),
    ];
    for (kind, value) in found {
        if value.and_then(array_of).is_some_and(|array| array.re.iter().any(|delay| *delay != 0.0)) {
            return Err(format!("{kind} delays cannot be taken; absorb them first: sys = pade(sys, 3)"));
        }
    }
    Ok(())
}

/// What stands beside a model about its flight condition.
pub(super) fn facts_of(record: &Record<'_>) -> Facts {
    let figure = |names: &[&str]| record.get(names).and_then(scalar_of);
    let condition = figure(&["condition", "condition_id", "fc"]).filter(|id| id.fract() == 0.0 && id.abs() < 1e9);
    Facts {
        condition: condition.map(|id| id as i64),
        airspeed_kt: figure(&["airspeed_kt", "V_kt", "airspeed_knots", "speed_kt", "KTAS"]),
        altitude_ft: figure(&["altitude_ft", "alt_ft", "h_ft"]),
        mass_kg: figure(&["mass_kg", "m_kg"]),
        records: Vec::new(),
    }
}

// Numbers out of values.

/// The numbers that a value stands for: itself, or the value of a parameter of an identified model.
pub(super) fn array_of(value: &Value) -> Option<&Array> {
    match value {
        Value::Array(array) => Some(array),
        Value::Object(object) => {
            // The polynomials of GNU Octave's transfer functions are objects too.
            let values = ["Value", "Value_", "poly"].iter().find_map(|name| object.records.field(name))?;
            array_of(values.first()?)
        }
        Value::Struct(records) if records.shape.iter().product::<usize>() == 1 => {
            array_of(records.field("Value")?.first()?)
        }
        Value::Text(_) | Value::Cell(_) | Value::Struct(_) | Value::Opaque { .. } => None,
    }
}

/// A real matrix of finite numbers.
pub(super) fn matrix_of(name: &str, value: &Value) -> Result<DMatrix<f64>, String> {
    let array =
        array_of(value).ok_or_else(|| format!("{name}: expected a matrix of numbers, found {}", value.words()))?;
    if array.shape.iter().skip(2).product::<usize>() > 1 {
        return Err(format!("{name}: expected a matrix, found {}", value.words()));
    }
    page_of(name, array, 0, false)
}

/// Number of matrices in an array, and the rows and columns of each; which index counts them, `pages_first` says.
pub(super) fn pages_of(array: &Array, pages_first: bool) -> (usize, [usize; 2]) {
    let side = |axis: usize| array.shape.get(axis).copied().unwrap_or(0);
    match array.shape.len() {
        3 if pages_first => (side(0), [side(1), side(2)]),
        _ => (array.shape.iter().skip(2).product(), [side(0), side(1)]),
    }
}

/// One matrix of an array of matrices.
pub(super) fn page_of(name: &str, array: &Array, page: usize, pages_first: bool) -> Result<DMatrix<f64>, String> {
    let (pages, [rows, columns]) = pages_of(array, pages_first);
    if array.im.as_ref().is_some_and(|im| im.iter().any(|part| *part != 0.0)) {
        return Err(format!("{name}: expected real numbers, found complex ones"));
    }
    let (start, step) = if array.shape.len() == 3 && pages_first { (page, pages) } else { (page * rows * columns, 1) };
    let values: Vec<f64> = array.re.iter().skip(start).step_by(step.max(1)).take(rows * columns).copied().collect();
    // There are sides enough and no numbers where one behind them is 0.
    if values.len() != rows * columns {
        return Err(format!("{name}: expected a matrix, found an array without numbers"));
    }
    if let Some(at) = values.iter().position(|value| !value.is_finite()) {
        let place = if rows == 0 { (0, 0) } else { (at % rows + 1, at / rows + 1) };
        return Err(format!(
            "{name}, row {}, column {}: expected a finite number, found {}",
            place.0, place.1, values[at]
        ));
    }
    Ok(DMatrix::from_column_slice(rows, columns, &values))
}

/// One real finite number.
pub(super) fn scalar_of(value: &Value) -> Option<f64> {
    let array = array_of(value)?;
    match array.re.as_slice() {
        [value] if value.is_finite() => Some(*value),
        _ => None,
    }
}

/// Numbers in a row or a column.
pub(super) fn list_of(name: &str, value: &Value) -> Result<Vec<f64>, String> {
    let array = array_of(value).ok_or_else(|| format!("{name}: expected numbers, found {}", value.words()))?;
    match array.re.iter().position(|value| !value.is_finite()) {
        Some(at) => Err(format!("{name}, entry {}: expected a finite number, found {}", at + 1, number(array.re[at]))),
        None => Ok(array.re.clone()),
    }
}

/// Complex numbers in a row or a column.
pub(super) fn complex_list_of(name: &str, value: &Value) -> Result<Vec<Complex<f64>>, String> {
    let re = list_of(name, value)?;
    let im = array_of(value).and_then(|array| array.im.clone()).unwrap_or_else(|| vec![0.0; re.len()]);
    if im.iter().any(|part| !part.is_finite()) {
        return Err(format!("{name}: expected finite numbers"));
    }
    Ok(re.into_iter().zip(im).map(|(re, im)| Complex::new(re, im)).collect())
}
