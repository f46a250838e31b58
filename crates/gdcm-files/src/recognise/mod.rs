//! From variables to models: what a file holds, whatever its format.
//!
//! A group of fields is a model by the names that the field gives them: `A`, `B`, `C`, `D`; a response over frequencies; numerators
//! and denominators; zeros, poles and gains. Groups are structs, objects of MATLAB, the variables of a file beside one another, and
//! all of these inside structs, cells and arrays.

pub(super) mod record;
mod state_space;

use std::collections::HashMap;
use std::f64::consts::TAU;

use gdcm_core::assembly::{Dimension, FoundModel, PhysicalUnit};
use gdcm_core::dataset::{Estimate, ModelDraft, Origin, Provenance, ResponseArray, ResponseDraft};

use crate::models_file::bare_draft;
use crate::recognise::record::{Record, array_of, facts_of, inputs_of, list_of, matrix_of, outputs_of, texts_of};
use crate::recognise::state_space::{is_state_space, is_transfer_function, state_spaces, transfer_function};
use crate::variables::{Array, ReadingBudget, StructArray, Value, Variable, VariableFault};

/// Deepest nesting that is searched.
pub(crate) const DEEPEST: usize = 16;
/// Most models or records of one file.
pub(crate) const MOST_FOUND: usize = 10_000;
/// Most variables that are told where nothing was found.
const MOST_TOLD: usize = 20;

/// Steps of work that looking at a field takes: it is compared with all names that are known.
const STEPS: u64 = 64;

/// What was found among variables: models, or records.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Found<T> {
    /// The models or records; their sources name the variable only.
    pub(crate) items: Vec<T>,
    /// What looks like one but cannot be taken, with its place and why.
    pub(crate) faults: Vec<String>,
    /// What is none, in words.
    pub(crate) ignored: Vec<String>,
}

impl<T> Default for Found<T> {
    fn default() -> Self {
        Self { items: Vec::new(), faults: Vec::new(), ignored: Vec::new() }
    }
}

/// What the fields of a record are, under the name of a variable: nothing where they are none of what is looked for.
type Recognise<'r, T> = &'r dyn Fn(&Record<'_>, &str) -> Option<Vec<Result<T, String>>>;

/// Everything that `recognise` knows among variables: first what they are together, then each by itself, from outside in.
pub(crate) fn search<T>(
    variables: &[Variable],
    budget: &ReadingBudget<'_>,
    recognise: Recognise<'_, T>,
) -> Result<Found<T>, VariableFault> {
    let mut search = Search { found: Found::default(), recognise, budget };
    search.take(&Record::of_variables(variables), "")?;
    let is_alone = search.found.items.is_empty() && search.found.faults.is_empty();
    for variable in variables {
        search.descend(&variable.name, &variable.value, DEEPEST)?;
    }
    let mut found = search.found;
    let nothing = found.items.is_empty() && found.faults.is_empty();
    let told = variables.iter().filter(|of| nothing || is_alone && matches!(of.value, Value::Array(_)));
    found.ignored.extend(told.take(MOST_TOLD).map(|of| format!("{}: {}", of.name, of.value.words())));
    Ok(found)
}

struct Search<'r, T> {
    found: Found<T>,
    recognise: Recognise<'r, T>,
    budget: &'r ReadingBudget<'r>,
}

impl<T> Search<'_, T> {
    /// Takes what fields are, if they are known; gives whether they are.
    fn take(&mut self, record: &Record<'_>, variable: &str) -> Result<bool, VariableFault> {
        self.budget.work(STEPS * record.fields().count() as u64, variable)?;
        let Some(items) = (self.recognise)(record, variable) else { return Ok(false) };
        // What is found holds a copy of its numbers.
        for (_, value) in record.fields() {
            if let Value::Array(array) = value {
                self.budget.take(array.len() as u64, 16, variable)?;
            }
        }
        self.found.add(variable, items);
        Ok(true)
    }

    /// Looks in a value, and in what it holds.
    fn descend(&mut self, name: &str, value: &Value, deeper: usize) -> Result<(), VariableFault> {
        self.budget.work(STEPS, name)?;
        if deeper == 0 || self.found.items.len() >= MOST_FOUND {
            return self.fault(format!("{name}: too many values, or values nested too deeply, to look into"));
        }
        match value {
            Value::Struct(records) => self.descend_records(name, records, None, deeper)?,
            Value::Object(object) => self.descend_records(name, &object.records, Some(&object.class), deeper)?,
            Value::Cell(cell) => {
                for (index, value) in cell.values.iter().enumerate() {
                    self.descend(&format!("{name}{{{}}}", index + 1), value, deeper - 1)?;
                }
            }
            Value::Opaque { class, why } => self.fault(format!("{name} ({class}): {why}"))?,
            Value::Array(_) | Value::Text(_) => {}
        }
        Ok(())
    }

    fn fault(&mut self, words: String) -> Result<(), VariableFault> {
        self.budget.take(words.len() as u64 + 128, 1, "")?;
        self.found.faults.push(words);
        Ok(())
    }

    fn descend_records(
        &mut self,
        name: &str,
        records: &StructArray,
        class: Option<&str>,
        deeper: usize,
    ) -> Result<(), VariableFault> {
        let count = if records.fields.is_empty() { 0 } else { records.shape.iter().product::<usize>() };
        for index in 0..count {
            let name = if count == 1 { name.to_owned() } else { format!("{name}({})", index + 1) };
            let pages = Record::pages(records, index);
            let mut is_known = false;
            for page in 0..pages {
                let name = if pages == 1 { name.clone() } else { format!("{name}(:,:,{})", page + 1) };
                is_known |= self.take(&Record::of_struct(records, index, class, page), &name)?;
            }
            let inner = Record::of_struct(records, index, None, 0);
            for (field, value) in inner.fields().filter(|_| !is_known) {
                self.descend(&format!("{name}.{field}"), value, deeper - 1)?;
            }
        }
        Ok(())
    }
}

impl<T> Found<T> {
    fn add(&mut self, variable: &str, items: Vec<Result<T, String>>) {
        let at = if variable.is_empty() { String::new() } else { format!("{variable}: ") };
        for item in items {
            match item {
                Ok(item) => self.items.push(item),
                Err(reason) => self.faults.push(format!("{at}{reason}")),
            }
        }
    }
}

/// Every model among the variables of a file. Where the shapes do not tell which index of an array counts its matrices,
/// `pages_first` does.
pub(crate) fn recognise(
    variables: &[Variable],
    pages_first: bool,
    budget: &ReadingBudget<'_>,
) -> Result<Found<FoundModel>, VariableFault> {
    let model_of = |record: &Record<'_>, variable: &str| model_of(record, variable, pages_first);
    let together = model_of(&Record::of_variables(variables), "").is_some();
    let mut found = search(variables, budget, &model_of)?;
    let suffixed = suffixed(variables, &model_of, budget)?;
    if !together && suffixed.items.len() + suffixed.faults.len() > 0 {
        found.ignored.clear();
    }
    found.items.splice(0..0, suffixed.items);
    found.faults.splice(0..0, suffixed.faults);
    Ok(found)
}

/// The models that fields are, if they are some.
fn model_of(record: &Record<'_>, variable: &str, pages_first: bool) -> Option<Vec<Result<FoundModel, String>>> {
    if is_state_space(record) {
        Some(state_spaces(record, variable, pages_first))
    } else if is_response(record) {
        Some(vec![response(record, variable)])
    } else if is_transfer_function(record) {
        Some(vec![transfer_function(record, variable)])
    } else {
        None
    }
}

/// Matrices of several models beside one another: `A_nom, B_nom, ...`, `A1, B1, ...`.
fn suffixed(
    variables: &[Variable],
    model_of: Recognise<'_, FoundModel>,
    budget: &ReadingBudget<'_>,
) -> Result<Found<FoundModel>, VariableFault> {
    let mut found = Found::default();
    let letters = ["A", "B", "C", "D", "E"];
    // Of variables with the same name the first counts.
    let by_name: HashMap<&str, &Value> = variables.iter().rev().map(|of| (of.name.as_str(), &of.value)).collect();
    let suffixes = variables.iter().filter_map(|variable| variable.name.strip_prefix('A'));
    for suffix in suffixes.filter(|suffix| !suffix.is_empty()) {
        budget.work(STEPS, "")?;
        let matrix = |letter: &&'static str| {
            let value = *by_name.get(format!("{letter}{suffix}").as_str())?;
            matrix_of(letter, value).is_ok().then_some((*letter, value))
        };
        let matrices: Vec<(&str, &Value)> = letters.iter().filter_map(matrix).collect();
        if matrices.len() >= 3 && is_state_space(&Record::of_fields(matrices.iter().copied())) {
            // Labels beside them are of all.
            budget.work(STEPS * variables.len() as u64, "")?;
            let labels = variables.iter().filter(|variable| !letters.contains(&variable.name.as_str()));
            let labels = labels.map(|variable| (variable.name.as_str(), &variable.value));
            let record = Record::of_fields(matrices.iter().copied().chain(labels));
            let name = suffix.trim_start_matches('_');
            found.add(name, model_of(&record, name).unwrap_or_default());
        }
    }
    Ok(found)
}

// Models by their responses over frequencies.

/// Those of python-control are `frdata` and, before, `fresp`.
const RESPONSES: &[&str] = &["ResponseData", "Response", "frdata", "fresp", "H", "G", "resp", "frf"];
/// Names of frequencies in rad/s.
const RADIANS: &[&str] = &["omega", "omega_rad_s", "w", "freq_rad_s", "frequency_rad_s"];
/// Names that leave open what the unit is.
const FREQUENCIES: &[&str] = &["Frequency", "freq", "frequencies"];
const HERTZ: &[&str] = &["f_hz", "freq_hz", "frequency_hz", "f"];
const UNITS: &[&str] = &["FrequencyUnit", "FreqUnits", "Units", "frequency_unit"];
const COHERENCES: &[&str] = &["coherence", "coh", "gamma2", "gamma_squared", "Cxy"];

/// Whether fields are those of a frequency response: complex numbers, or real and imaginary parts, beside frequencies.
pub(super) fn is_response(record: &Record<'_>) -> bool {
    let frequencies = record.get(RADIANS).or_else(|| record.get(FREQUENCIES)).or_else(|| record.get(HERTZ));
    let has_frequencies = frequencies.and_then(array_of).is_some_and(|array| array.len() > 1);
    has_frequencies && (complex(record).is_some() || parts(record).is_some())
}

fn complex<'v>(record: &Record<'v>) -> Option<&'v Array> {
    record.get(RESPONSES).and_then(array_of).filter(|array| array.im.is_some())
}

fn parts<'v>(record: &Record<'v>) -> Option<(&'v Array, &'v Array)> {
    let part = |names: &[&str]| record.get(names).and_then(array_of);
    part(&["re", "real", "Hre"]).zip(part(&["im", "imag", "Him"]))
}

/// The measured response in `record`.
pub(super) fn response(record: &Record<'_>, variable: &str) -> Result<FoundModel, String> {
    let (omega, hertz) = omega_of(record)?;
    let count = omega.len();
    let (re, im, shape) = match (complex(record), parts(record)) {
        (Some(array), _) => (array.re.clone(), array.im.clone().unwrap_or_default(), &array.shape),
        (None, Some((re, im))) if re.shape == im.shape => (re.re.clone(), im.re.clone(), &re.shape),
        _ => return Err("real and imaginary parts are of different sizes".to_owned()),
    };
    let (outputs, inputs, steps) = channels(shape, count)?;
    let table = |name: &str, values: &[f64]| -> Result<ResponseArray, String> {
        let values = in_order(values, (outputs, inputs, count), steps);
        match values.iter().position(|value| !value.is_finite()) {
            Some(at) => Err(format!("{name}, frequency {}: expected a finite number", at % count + 1)),
            None => Ok(ResponseArray { shape: [outputs, inputs, count], values }),
        }
    };
    let coherence = record.get(COHERENCES).and_then(array_of).filter(|array| array.len() == re.len());
    let coherence = coherence.map(|array| table("coherence", &array.re)).transpose()?;
    let response = ResponseDraft {
        re: table("response", &re)?,
        im: table("response", &im)?,
        omega,
        coherence,
        valid_bands: None,
        estimate: Estimate::default(),
    };
    let variable = Some(variable.to_owned()).filter(|variable| !variable.is_empty());
    Ok(FoundModel {
        draft: ModelDraft {
            response: Some(response),
            source: Some(Provenance { variable: variable.clone(), ..Provenance::default() }),
            ..bare_draft(variable.unwrap_or_default(), Origin::Identified { method: None, order: None })
        },
        inputs: inputs_of(record, inputs),
        outputs: outputs_of(record, outputs),
        facts: facts_of(record),
        notes: hertz.then(|| "frequencies in Hz".to_owned()).into_iter().collect(),
    })
}

/// Frequencies \[rad/s\], and whether they stood in Hz.
fn omega_of(record: &Record<'_>) -> Result<(Vec<f64>, bool), String> {
    let unit = record.get(UNITS).and_then(texts_of).and_then(|texts| texts.into_iter().next()).unwrap_or_default();
    let of_frequency = PhysicalUnit::of(&unit).filter(|unit| unit.dimension == Dimension::Frequency);
    let of_rate = PhysicalUnit::of(&unit).filter(|unit| unit.name.starts_with("rad/"));
    // MATLAB's objects and python-control's are in rad/s where they do not say.
    let is_known = record.class.is_some() || record.get(&["frdata", "fresp"]).is_some();
    let (value, is_hertz) = match (record.get(RADIANS), record.get(FREQUENCIES), record.get(HERTZ)) {
        (Some(value), ..) => (value, of_frequency.is_some()),
        (None, Some(_), _) if unit.is_empty() && !is_known => {
            return Err(
                "frequencies: rad/s or Hz is not said; call them omega_rad_s or f_hz, or give \"rad/s\" or \"Hz\" \
                        beside them as frequency_unit"
                    .to_owned(),
            );
        }
        (None, Some(value), _) => (value, of_frequency.is_some()),
        (None, None, Some(value)) => (value, true),
        (None, None, None) => return Err("frequencies are missing".to_owned()),
    };
    let values = list_of("frequencies", value)?;
    let factor = match (is_hertz, of_rate) {
        (true, _) => TAU * of_frequency.map_or(1.0, |unit| unit.size),
        (false, Some(unit)) => unit.size,
        (false, None) if matches!(unit.to_lowercase().as_str(), "" | "rad" | "rads" | "rad/timeunit") => 1.0,
        (false, None) => {
            return Err(format!("frequencies are in \"{}\"; expected rad/s or Hz", unit.to_lowercase()));
        }
    };
    Ok((values.into_iter().map(|value| value * factor).collect(), is_hertz))
}

/// Outputs and inputs of an array that runs over `count` frequencies with its last index, or as some of NumPy with its first; and how
/// far apart the elements of the next output, input and frequency are. A single response may lie in a row or a column.
fn channels(shape: &[usize], count: usize) -> Result<(usize, usize, [usize; 3]), String> {
    match *shape {
        [outputs, inputs, last] if last == count => Ok((outputs, inputs, [1, outputs, outputs * inputs])),
        [first, outputs, inputs] if first == count => Ok((outputs, inputs, [count, count * outputs, 1])),
        [rows, columns] if rows * columns == count => Ok((1, 1, [0, 0, 1])),
        _ => {
            let found = shape.iter().map(usize::to_string).collect::<Vec<_>>().join(" x ");
            Err(format!("the response: expected outputs x inputs x {count} frequencies, found {found}"))
        }
    }
}

/// From elements so far apart to the last index running fastest.
fn in_order(values: &[f64], (outputs, inputs, count): (usize, usize, usize), steps: [usize; 3]) -> Vec<f64> {
    let mut ordered = Vec::with_capacity(values.len());
    for output in 0..outputs {
        for input in 0..inputs {
            ordered.extend((0..count).map(|k| values[output * steps[0] + input * steps[1] + k * steps[2]]));
        }
    }
    ordered
}

#[cfg(test)]
mod tests {
    use crate::variables::{Array, CellArray, ElementKind, Object, TextArray};

    use super::*;

    fn numbers(rows: usize, columns: usize, values: &[f64]) -> Value {
        Value::Array(Array::matrix(rows, columns, values.to_vec()))
    }

    fn variable(name: &str, value: Value) -> Variable {
        Variable { name: name.to_owned(), value }
    }

    fn record(fields: Vec<(&str, Value)>) -> StructArray {
        let fields = fields.into_iter().map(|(name, value)| (name.to_owned(), vec![value])).collect();
        StructArray { shape: vec![1, 1], fields }
    }

    fn model(gain: f64) -> Vec<(&'static str, Value)> {
        let scalar = |value: f64| numbers(1, 1, &[value]);
        vec![("A", scalar(-1.0)), ("B", scalar(gain)), ("C", scalar(1.0)), ("D", scalar(0.0))]
    }

    fn recognise(variables: &[Variable]) -> Found<FoundModel> {
        super::recognise(variables, false, &ReadingBudget::new(1 << 20)).unwrap()
    }

    fn gains(found: &Found<FoundModel>) -> Vec<(String, f64)> {
        let gain =
            |model: &FoundModel| (model.variable().to_owned(), model.draft.matrices[1].as_ref().unwrap()[(0, 0)]);
        found.items.iter().map(gain).collect()
    }

    #[test]
    fn models_are_found_in_structs_in_cells_in_struct_arrays_and_beside_one_another() {
        let of_two = StructArray {
            shape: vec![1, 2],
            fields: [("A", -1.0), ("B", 3.0), ("C", 1.0), ("D", 0.0)]
                .map(|(name, value)| (name.to_owned(), vec![numbers(1, 1, &[value]), numbers(1, 1, &[value])]))
                .into(),
        };
        let in_cell = CellArray { shape: vec![1, 1], values: vec![Value::Struct(record(model(2.0)))] };
        let nested = record(vec![("sys", Value::Struct(record(model(1.0)))), ("all", Value::Cell(in_cell))]);
        let found = recognise(&[variable("c1", Value::Struct(nested)), variable("more", Value::Struct(of_two))]);
        let expected = [("c1.sys", 1.0), ("c1.all{1}", 2.0), ("more(1)", 3.0), ("more(2)", 3.0)];
        assert_eq!(gains(&found), expected.map(|(name, gain)| (name.to_owned(), gain)));
        let loose: Vec<Variable> = model(4.0).into_iter().map(|(name, value)| variable(name, value)).collect();
        assert_eq!(gains(&recognise(&loose)), [(String::new(), 4.0)]);
        let suffixed: Vec<Variable> =
            model(5.0).into_iter().map(|(name, value)| variable(&format!("{name}_nom"), value)).collect();
        assert_eq!(gains(&recognise(&suffixed)), [("nom".to_owned(), 5.0)]);
    }

    #[test]
    fn matrices_behind_one_another_are_models_and_share_what_there_is_once() {
        let pages = Array { shape: vec![1, 1, 2], kind: ElementKind::Float, re: vec![7.0, 8.0], im: None };
        let a = Array { shape: vec![1, 1, 2], kind: ElementKind::Float, re: vec![-1.0, -2.0], im: None };
        let mut fields = model(0.0);
        (fields[0].1, fields[1].1) = (Value::Array(a), Value::Array(pages));
        let found = recognise(&[variable("sys", Value::Struct(record(fields)))]);
        assert_eq!(gains(&found), [("sys(:,:,1)".to_owned(), 7.0), ("sys(:,:,2)".to_owned(), 8.0)]);
    }

    #[test]
    fn an_object_of_matlab_keeps_its_numbers_inside_and_its_names_outside() {
        let text = |text: &str| Value::Text(TextArray { shape: vec![1, 1], texts: vec![text.to_owned()] });
        let lower = model(6.0).into_iter().map(|(name, value)| (name.to_lowercase(), vec![value]));
        let ts = ("Ts".to_owned(), vec![numbers(1, 1, &[0.5])]);
        let data = StructArray { shape: vec![1, 1], fields: lower.chain([ts]).collect() };
        let data = Object { class: "ltipack.ssdata".to_owned(), records: data };
        let names = CellArray { shape: vec![1, 1], values: vec![text("LAT")] };
        let fields = vec![("InputName_", Value::Cell(names)), ("Data_", Value::Object(data))];
        let found =
            recognise(&[variable("s", Value::Object(Object { class: "ss".to_owned(), records: record(fields) }))]);
        assert_eq!(gains(&found), [("s".to_owned(), 6.0)]);
        assert_eq!(found.items[0].inputs[0].name.as_deref(), Some("LAT"));
        assert_eq!(found.items[0].draft.timing.sample_time_s, Some(0.5));
    }

    #[test]
    fn what_looks_like_a_model_and_is_none_is_named_with_its_place() {
        let of = |change: fn(&mut Vec<(&'static str, Value)>)| {
            let mut fields = model(1.0);
            change(&mut fields);
            recognise(&[variable("sys", Value::Struct(record(fields)))]).faults.join("; ")
        };
        assert_eq!(of(|fields| fields[1].1 = numbers(2, 1, &[1.0, 1.0])), "sys: B: expected 1 x 1, found 2 x 1");
        let not_finite = of(|fields| fields[0].1 = numbers(1, 1, &[f64::NAN]));
        assert_eq!(not_finite, "sys: A, row 1, column 1: expected a finite number, found NaN");
        assert!(of(|fields| fields.push(("Ts", numbers(1, 1, &[-1.0])))).contains("set Ts"));
        assert!(of(|fields| fields.push(("InternalDelay", numbers(1, 1, &[0.1])))).contains("absorb"));
        let opaque = Value::Opaque { class: "ss".to_owned(), why: "write A, B, C, D".to_owned() };
        assert_eq!(recognise(&[variable("x", opaque)]).faults, ["x (ss): write A, B, C, D"]);
    }

    #[test]
    fn a_response_of_several_channels_is_put_in_order() {
        // Two outputs, one input, three frequencies: the first index runs fastest.
        let response = Array {
            shape: vec![2, 1, 3],
            kind: ElementKind::Float,
            re: vec![1.0, 10.0, 2.0, 20.0, 3.0, 30.0],
            im: Some(vec![0.0; 6]),
        };
        let text = Value::Text(TextArray { shape: vec![1, 1], texts: vec!["Hz".to_owned()] });
        let fields = vec![
            ("ResponseData", Value::Array(response)),
            ("Frequency", numbers(1, 3, &[1.0, 2.0, 3.0])),
            ("FrequencyUnit", text),
        ];
        let found = recognise(&[variable("h", Value::Struct(record(fields)))]);
        let response = found.items[0].draft.response.as_ref().unwrap();
        assert_eq!(response.re.values, [1.0, 2.0, 3.0, 10.0, 20.0, 30.0]);
        assert_eq!(response.omega[0], std::f64::consts::TAU);
    }
}
