//! From variables to models: contents of a file in any format.
//!
//! A group of fields is a model if it has the customary names: `A`, `B`, `C`, `D`; a response over
//! frequencies; numerators and denominators; zeros, poles and gains. Groups are structs, MATLAB
//! objects, the variables of a file together, and all of these inside structs, cells and arrays.

mod delays;
pub(crate) mod record;
mod state_space;

use std::collections::{BTreeSet, HashMap};
use std::f64::consts::TAU;
use std::rc::Rc;

use gdcm_model::assembly::FoundModel;
use gdcm_model::dataset::limits::MOST_PIECES;
use gdcm_model::dataset::measured_response::Estimate;
use gdcm_model::dataset::model::{Origin, Provenance};
use gdcm_model::dataset::unchecked_dataset::{ModelDraft, ResponseArray, ResponseDraft};
use gdcm_model::units::physical_unit::{Dimension, PhysicalUnit};

use self::delays::{is_delay, refuse_delays};
use self::record::{
    Page, Record, array_of, facts_of, inputs_of, list_of, matrix_of, origin_of, outputs_of,
    texts_of,
};
use self::state_space::{is_state_space, is_transfer_function, state_spaces, transfer_function};
use crate::files::model_collection::bare_draft;
use crate::formats::variables::{Array, StructArray, Value, Variable};
use crate::reading_budget::{ReadingBudget, VariableFault};

/// Deepest nesting of the search.
pub(crate) const DEEPEST: usize = 16;
/// Largest number of models or records in one file.
pub(crate) const MOST_FOUND: usize = 10_000;
/// Largest number of variables listed if nothing is found.
const MOST_TOLD: usize = 20;

/// Work steps for examining a field, which is compared with all known names.
const STEPS: u64 = 64;

/// Results of a search among variables: models or records.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Found<T> {
    /// The models or records; their sources give only the variable.
    pub(crate) items: Vec<T>,
    /// Candidates that cannot be used, with place and reason.
    pub(crate) faults: Vec<String>,
    /// Descriptions of contents that are not candidates.
    pub(crate) ignored: Vec<String>,
    /// Names of unused variables beside and inside the results.
    pub(crate) unused: Vec<String>,
}

impl<T> Default for Found<T> {
    fn default() -> Self {
        Self {
            items: Vec::new(),
            faults: Vec::new(),
            ignored: Vec::new(),
            unused: Vec::new(),
        }
    }
}

/// Recognises the fields of a record, given the name of the variable; `None` if they are not of the
/// kind sought.
type Recognise<'r, T> = &'r dyn Fn(&Record<'_>, &str) -> Option<Vec<Result<T, String>>>;

/// Finds everything that `recognise` accepts among variables: first all variables together, then
/// each variable, from outside in.
pub(crate) fn search<T>(
    variables: &[Variable],
    budget: &ReadingBudget<'_>,
    recognise: Recognise<'_, T>,
) -> Result<Found<T>, VariableFault> {
    let mut search = Search {
        found: Found::default(),
        recognise,
        budget,
    };
    let whole = Rc::new(Record::of_variables(variables));
    search.take(&whole, "")?;
    let is_alone = search.found.items.is_empty() && search.found.faults.is_empty();
    let mut empty = BTreeSet::new();
    for variable in variables {
        if !search.descend(&variable.name, &variable.value, DEEPEST, &whole)? {
            empty.insert(variable.name.as_str());
        }
    }
    let unused = whole.unused().into_iter();
    let unused = unused.filter(|name| empty.contains(name.as_str()) || name.contains('.'));
    let mut found = search.found;
    found.unused.splice(0..0, unused);
    let nothing = found.items.is_empty() && found.faults.is_empty();
    let told = variables
        .iter()
        .filter(|of| nothing || is_alone && matches!(of.value, Value::Array(_)));
    found.ignored.extend(
        told.take(MOST_TOLD)
            .map(|of| format!("{}: {}", of.name, of.value.words())),
    );
    Ok(found)
}

struct Search<'r, T> {
    found: Found<T>,
    recognise: Recognise<'r, T>,
    budget: &'r ReadingBudget<'r>,
}

impl<T> Search<'_, T> {
    /// Adds the results from the fields of a record; returns whether the fields are recognised.
    fn take(&mut self, record: &Record<'_>, variable: &str) -> Result<bool, VariableFault> {
        self.budget
            .work(STEPS * record.fields().count() as u64, variable)?;
        let Some(items) = (self.recognise)(record, variable) else {
            return Ok(false);
        };
        // Each result holds a copy of its numbers.
        for (_, value) in record.fields() {
            if let Value::Array(array) = value {
                self.budget.take(array.len() as u64, 16, variable)?;
            }
        }
        self.found.add(variable, items);
        Ok(true)
    }

    /// Searches a value and its contents; `outer` is the record with this field. Returns whether
    /// anything was found.
    fn descend<'v>(
        &mut self,
        name: &str,
        value: &'v Value,
        deeper: usize,
        outer: &Rc<Record<'v>>,
    ) -> Result<bool, VariableFault> {
        self.budget.work(STEPS, name)?;
        if deeper == 0 || self.found.items.len() >= MOST_FOUND {
            self.fault(format!(
                "{name}: too many values, or values nested too deeply, to look into"
            ))?;
            return Ok(true);
        }
        match value {
            Value::Struct(records) => self.descend_records(name, records, None, deeper, outer),
            Value::Object(object) => {
                self.descend_records(name, &object.records, Some(&object.class), deeper, outer)
            }
            Value::Cell(cell) => {
                let mut is_any_found = false;
                for (index, value) in cell.values.iter().enumerate() {
                    is_any_found |= self.descend(
                        &format!("{name}{{{}}}", index + 1),
                        value,
                        deeper - 1,
                        outer,
                    )?;
                }
                Ok(is_any_found)
            }
            Value::Opaque { class, why } => {
                self.fault(format!("{name} ({class}): {why}"))?;
                Ok(true)
            }
            Value::Array(_) | Value::Text(_) => Ok(false),
        }
    }

    /// Notes unused variables.
    fn note_unused(&mut self, of: &str, names: &[String]) -> Result<(), VariableFault> {
        for name in names {
            let name = if of.is_empty() {
                name.clone()
            } else {
                format!("{of}.{name}")
            };
            self.budget.take(name.len() as u64 + 64, 1, "")?;
            if self.found.unused.len() < MOST_PIECES {
                self.found.unused.push(name);
            }
        }
        Ok(())
    }

    fn fault(&mut self, words: String) -> Result<(), VariableFault> {
        self.budget.take(words.len() as u64 + 128, 1, "")?;
        self.found.faults.push(words);
        Ok(())
    }

    fn descend_records<'v>(
        &mut self,
        name: &str,
        records: &'v StructArray,
        class: Option<&'v str>,
        deeper: usize,
        outer: &Rc<Record<'v>>,
    ) -> Result<bool, VariableFault> {
        let mut is_any_found = false;
        let count = if records.fields.is_empty() {
            0
        } else {
            records.shape.iter().product::<usize>()
        };
        for index in 0..count {
            let name = if count == 1 {
                name.to_owned()
            } else {
                format!("{name}({})", index + 1)
            };
            let pages = Record::pages(records, index);
            let mut is_known = false;
            for page in 0..pages {
                let name = if pages == 1 {
                    name.clone()
                } else {
                    format!("{name}(:,:,{})", page + 1)
                };
                let record = Record::of_struct(records, index, class, page).inside(outer);
                if self.take(&record, &name)? {
                    is_known = true;
                    self.note_unused(&name, &record.unused())?;
                }
            }
            if is_known {
                is_any_found = true;
                continue;
            }
            let inner = Rc::new(Record::of_struct(records, index, None, 0).inside(outer));
            let mut empty = BTreeSet::new();
            for (field, value) in inner.fields() {
                if !self.descend(&format!("{name}.{field}"), value, deeper - 1, &inner)? {
                    empty.insert(field);
                }
            }
            if empty.len() < inner.fields().count() {
                is_any_found = true;
                let unused = inner.unused().into_iter();
                let unused: Vec<String> = unused
                    .filter(|name| empty.contains(name.as_str()) || name.contains('.'))
                    .collect();
                self.note_unused(&name, &unused)?;
            }
        }
        Ok(is_any_found)
    }
}

impl<T> Found<T> {
    fn add(&mut self, variable: &str, items: Vec<Result<T, String>>) {
        let at = if variable.is_empty() {
            String::new()
        } else {
            format!("{variable}: ")
        };
        for item in items {
            match item {
                Ok(item) => self.items.push(item),
                Err(reason) => self.faults.push(format!("{at}{reason}")),
            }
        }
    }
}

/// Finds every model among the variables of a file. `pages_first` decides which index of an array
/// counts its matrices if the shapes leave it open.
pub(crate) fn recognise(
    variables: &[Variable],
    pages_first: bool,
    budget: &ReadingBudget<'_>,
) -> Result<Found<FoundModel>, VariableFault> {
    let model_of = |record: &Record<'_>, variable: &str| model_of(record, variable, pages_first);
    let mut found = search(variables, budget, &model_of)?;
    let mut used = BTreeSet::new();
    let suffixed = suffixed(variables, &model_of, budget, &mut used)?;
    found.items.splice(0..0, suffixed.items);
    found.faults.splice(0..0, suffixed.faults);
    if found.items.is_empty() && found.faults.is_empty() {
        found.unused.clear();
    } else {
        found.ignored.clear();
        let mut listed = BTreeSet::new();
        let unused = std::mem::take(&mut found.unused).into_iter();
        let unused = unused.filter(|name| !used.contains(name) && !SILENT.contains(&name.as_str()));
        found.unused = unused
            .map(|name| without_indices(&name))
            .filter(|name| listed.insert(name.clone()))
            .collect();
    }
    Ok(found)
}

/// Replaces the indices in a path by colons: "models(3).mass" becomes "models(:).mass".
fn without_indices(name: &str) -> String {
    let mut text = String::with_capacity(name.len());
    let mut is_inside = false;
    for letter in name.chars() {
        match letter {
            '(' | '{' => is_inside = true,
            ')' | '}' => is_inside = false,
            _ => {}
        }
        match letter.is_ascii_digit() && is_inside {
            true if text.ends_with(':') => {}
            true => text.push(':'),
            false => text.push(letter),
        }
    }
    text
}

/// Variables that describe the file, not its models.
const SILENT: [&str; 5] = [
    "format",
    "version",
    "__header__",
    "__version__",
    "__globals__",
];

/// Returns the models in the fields of a record, if there are any.
fn model_of(
    record: &Record<'_>,
    variable: &str,
    pages_first: bool,
) -> Option<Vec<Result<FoundModel, String>>> {
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

/// Finds models in matrices with common suffixes: `A_nom, B_nom, ...`, `A1, B1, ...`.
fn suffixed(
    variables: &[Variable],
    model_of: Recognise<'_, FoundModel>,
    budget: &ReadingBudget<'_>,
    used: &mut BTreeSet<String>,
) -> Result<Found<FoundModel>, VariableFault> {
    let mut found = Found::default();
    let letters = ["A", "B", "C", "D", "E"];
    // The first of several variables with the same name counts.
    let by_name: HashMap<&str, &Value> = variables
        .iter()
        .rev()
        .map(|of| (of.name.as_str(), &of.value))
        .collect();
    let is_suffix =
        |suffix: &str| !suffix.is_empty() && by_name.contains_key(format!("B{suffix}").as_str());
    let suffixes = variables
        .iter()
        .filter_map(|variable| variable.name.strip_prefix('A'));
    let suffixes: Vec<&str> = suffixes.filter(|suffix| is_suffix(suffix)).collect();
    let delays = delays_with_suffix(variables, &suffixes.iter().copied().collect());
    for suffix in suffixes {
        budget.work(STEPS, "")?;
        let matrix = |letter: &&'static str| {
            let value = *by_name.get(format!("{letter}{suffix}").as_str())?;
            matrix_of(letter, value).is_ok().then_some((*letter, value))
        };
        let matrices: Vec<(&str, &Value)> = letters.iter().filter_map(matrix).collect();
        if matrices.len() >= 3 && is_state_space(&Record::of_fields(matrices.iter().copied())) {
            // Labels beside the matrices apply to all models.
            budget.work(STEPS * variables.len() as u64, "")?;
            let labels = variables
                .iter()
                .filter(|variable| !letters.contains(&variable.name.as_str()));
            let labels = labels.filter_map(|variable| {
                let name = variable.name.as_str();
                match delays.contains(name) {
                    true => Some((
                        name.strip_suffix(suffix).filter(|stem| is_delay(stem))?,
                        &variable.value,
                    )),
                    false => Some((name, &variable.value)),
                }
            });
            let record = Record::of_fields(matrices.iter().copied().chain(labels));
            let record = record.shared();
            let name = suffix.trim_start_matches('_');
            found.add(name, model_of(&record, name).unwrap_or_default());
            for (name, _) in record.fields().filter(|(name, _)| record.is_used(name)) {
                used.insert(name.to_owned());
                used.insert(format!("{name}{suffix}"));
            }
        }
    }
    Ok(found)
}

/// Returns names of delays with the suffix of one model: `InputDelay_nom` beside `A_nom`.
fn delays_with_suffix<'v>(
    variables: &'v [Variable],
    suffixes: &BTreeSet<&str>,
) -> BTreeSet<&'v str> {
    let has_suffix = |name: &str| {
        let mut ends = name.char_indices().map(|(at, _)| name.split_at(at));
        ends.any(|(stem, end)| suffixes.contains(end) && is_delay(stem))
    };
    variables
        .iter()
        .map(|variable| variable.name.as_str())
        .filter(|name| has_suffix(name))
        .collect()
}

// Models given by frequency responses.

/// python-control uses `frdata` and, in earlier versions, `fresp`.
const RESPONSES: &[&str] = &[
    "ResponseData",
    "Response",
    "frdata",
    "fresp",
    "H",
    "G",
    "resp",
    "frf",
];
/// Names for frequencies in rad/s.
const RADIANS: &[&str] = &["omega", "omega_rad_s", "w", "freq_rad_s", "frequency_rad_s"];
/// Names for frequencies in an unspecified unit.
const FREQUENCIES: &[&str] = &["Frequency", "freq", "frequencies", "f"];
const HERTZ: &[&str] = &["f_hz", "freq_hz", "frequency_hz"];
const UNITS: &[&str] = &["FrequencyUnit", "FreqUnits", "Units", "frequency_unit"];
const COHERENCES: &[&str] = &[
    "coherence",
    "coher",
    "coh",
    "gamma2",
    "gamma_squared",
    "Cxy",
];
/// Names that programs use for both γ and γ².
const GAMMAS: &[&str] = &["gamma", "γ"];

/// Whether fields are a frequency response: complex numbers, or real and imaginary parts, with
/// frequencies.
pub(crate) fn is_response(record: &Record<'_>) -> bool {
    let frequencies = record
        .find(RADIANS)
        .or_else(|| record.find(FREQUENCIES))
        .or_else(|| record.find(HERTZ));
    let has_frequencies = frequencies
        .and_then(|(_, value)| array_of(value))
        .is_some_and(|array| array.len() > 1);
    has_frequencies && (complex(record).is_some() || parts(record).is_some())
}

fn complex<'v>(record: &Record<'v>) -> Option<&'v Array> {
    let (name, value) = record.find(RESPONSES)?;
    let array = array_of(value).filter(|array| array.im.is_some())?;
    record.use_field(name);
    Some(array)
}

fn parts<'v>(record: &Record<'v>) -> Option<(&'v Array, &'v Array)> {
    let re = record.find(&["re", "real", "Hre"])?;
    let im = record.find(&["im", "imag", "Him"])?;
    let parts = array_of(re.1).zip(array_of(im.1))?;
    record.use_field(re.0);
    record.use_field(im.0);
    Some(parts)
}

/// Reads the measured response in `record`.
pub(crate) fn response(record: &Record<'_>, variable: &str) -> Result<FoundModel, String> {
    refuse_delays(record)?;
    let (omega, hertz) = omega_of(record)?;
    let count = omega.len();
    let (re, im, shape) = match (complex(record), parts(record)) {
        (Some(array), _) => (
            array.re.clone(),
            array.im.clone().unwrap_or_default(),
            &array.shape,
        ),
        (None, Some((re, im))) if re.shape == im.shape => (re.re.clone(), im.re.clone(), &re.shape),
        _ => return Err("real and imaginary parts are of different sizes".to_owned()),
    };
    let (outputs, inputs, steps) = channels(shape, count)?;
    let table = |name: &str, values: &[f64]| -> Result<ResponseArray, String> {
        let values = in_order(values, (outputs, inputs, count), steps);
        match values.iter().position(|value| !value.is_finite()) {
            Some(at) => Err(format!(
                "{name}, frequency {}: expected a finite number",
                at % count + 1
            )),
            None => Ok(ResponseArray {
                shape: [outputs, inputs, count],
                values,
            }),
        }
    };
    let coherence = match record
        .get(COHERENCES)
        .and_then(array_of)
        .filter(|array| !array.is_empty())
    {
        Some(array) if array.len() == re.len() => Some(table("coherence", &array.re)?),
        Some(array) => {
            return Err(format!(
                "coherence: {} numbers for the {} of the response; write one for each output, input and frequency, or leave it out",
                array.len(),
                re.len()
            ));
        }
        None => None,
    };
    if let (None, Some((name, _))) = (&coherence, record.find(GAMMAS)) {
        return Err(format!(
            "{name}: γ or γ² is not said; call γ² gamma2 or coherence, and square γ first"
        ));
    }
    let response = ResponseDraft {
        re: table("response", &re)?,
        im: table("response", &im)?,
        omega,
        coherence,
        valid_bands: None,
        estimate: Estimate::default(),
    };
    let variable = Some(variable.to_owned()).filter(|variable| !variable.is_empty());
    let origin = match origin_of(record) {
        Origin::Identified { method, order } => Origin::Identified { method, order },
        Origin::Nominal { .. } | Origin::Perturbed { .. } => Origin::Identified {
            method: None,
            order: None,
        },
    };
    Ok(FoundModel {
        draft: ModelDraft {
            response: Some(response),
            source: Some(Provenance {
                variable: variable.clone(),
                ..Provenance::default()
            }),
            ..bare_draft(variable.unwrap_or_default(), origin)
        },
        inputs: inputs_of(record, inputs)?,
        outputs: outputs_of(record, outputs)?,
        facts: facts_of(record, Page::ONLY)?,
        notes: hertz
            .then(|| "frequencies in Hz".to_owned())
            .into_iter()
            .collect(),
    })
}

/// Returns the frequencies \[rad/s\], and whether they were in Hz.
fn omega_of(record: &Record<'_>) -> Result<(Vec<f64>, bool), String> {
    let unit = record
        .get(UNITS)
        .and_then(texts_of)
        .and_then(|texts| texts.into_iter().next())
        .unwrap_or_default();
    let of_frequency =
        PhysicalUnit::of(&unit).filter(|unit| unit.dimension == Dimension::Frequency);
    let of_rate = PhysicalUnit::of(&unit).filter(|unit| unit.name.starts_with("rad/"));
    // Objects of MATLAB and python-control use rad/s by default.
    let is_known = record.class.is_some() || record.get(&["frdata", "fresp"]).is_some();
    let (field, is_hertz) = match (
        record.find(RADIANS),
        record.find(FREQUENCIES),
        record.find(HERTZ),
    ) {
        (Some(field), ..) => (field, of_frequency.is_some()),
        (None, Some(_), _) if unit.is_empty() && !is_known => {
            return Err(
                "frequencies: rad/s or Hz is not said; call them omega_rad_s or f_hz, or give \"rad/s\" or \"Hz\" \
                        beside them as frequency_unit"
                    .to_owned(),
            );
        }
        (None, Some(field), _) => (field, of_frequency.is_some()),
        (None, None, Some(field)) => (field, true),
        (None, None, None) => return Err("frequencies are missing".to_owned()),
    };
    let values = list_of("frequencies", record.used(field))?;
    let factor = match (is_hertz, of_rate) {
        (true, _) => TAU * of_frequency.map_or(1.0, |unit| unit.size),
        (false, Some(unit)) => unit.size,
        (false, None)
            if matches!(
                unit.to_lowercase().as_str(),
                "" | "rad" | "rads" | "rad/timeunit"
            ) =>
        {
            1.0
        }
        (false, None) => {
            return Err(format!(
                "frequencies are in \"{}\"; expected rad/s or Hz",
                unit.to_lowercase()
            ));
        }
    };
    Ok((
        values.into_iter().map(|value| value * factor).collect(),
        is_hertz,
    ))
}

/// Finds the numbers of outputs and inputs of an array with `count` frequencies along its last
/// index, or along its first as in NumPy, and the strides of outputs, inputs and frequencies. A
/// single response may be a row or a column.
fn channels(shape: &[usize], count: usize) -> Result<(usize, usize, [usize; 3]), String> {
    match *shape {
        [outputs, inputs, last] if last == count => {
            Ok((outputs, inputs, [1, outputs, outputs * inputs]))
        }
        [first, outputs, inputs] if first == count => {
            Ok((outputs, inputs, [count, count * outputs, 1]))
        }
        [rows, columns] if rows * columns == count => Ok((1, 1, [0, 0, 1])),
        _ => {
            let found = shape
                .iter()
                .map(usize::to_string)
                .collect::<Vec<_>>()
                .join(" x ");
            Err(format!(
                "the response: expected outputs x inputs x {count} frequencies, found {found}"
            ))
        }
    }
}

/// Reorders elements with these strides so that the last index is fastest.
fn in_order(
    values: &[f64],
    (outputs, inputs, count): (usize, usize, usize),
    steps: [usize; 3],
) -> Vec<f64> {
    let mut ordered = Vec::with_capacity(values.len());
    for output in 0..outputs {
        for input in 0..inputs {
            ordered.extend(
                (0..count).map(|k| values[output * steps[0] + input * steps[1] + k * steps[2]]),
            );
        }
    }
    ordered
}

#[cfg(test)]
mod tests {
    use gdcm_model::assembly::ChannelLabel;

    use super::*;
    use crate::formats::variables::{Array, CellArray, ElementKind, Object, TextArray};

    fn numbers(rows: usize, columns: usize, values: &[f64]) -> Value {
        Value::Array(Array::matrix(rows, columns, values.to_vec()))
    }

    fn variable(name: &str, value: Value) -> Variable {
        Variable {
            name: name.to_owned(),
            value,
        }
    }

    fn record(fields: Vec<(&str, Value)>) -> StructArray {
        let fields = fields
            .into_iter()
            .map(|(name, value)| (name.to_owned(), vec![value]))
            .collect();
        StructArray {
            shape: vec![1, 1],
            fields,
        }
    }

    fn model(gain: f64) -> Vec<(&'static str, Value)> {
        let scalar = |value: f64| numbers(1, 1, &[value]);
        vec![
            ("A", scalar(-1.0)),
            ("B", scalar(gain)),
            ("C", scalar(1.0)),
            ("D", scalar(0.0)),
        ]
    }

    fn recognise(variables: &[Variable]) -> Found<FoundModel> {
        super::recognise(variables, false, &ReadingBudget::new(1 << 20)).unwrap()
    }

    fn gains(found: &Found<FoundModel>) -> Vec<(String, f64)> {
        let gain = |model: &FoundModel| {
            (
                model.variable().to_owned(),
                model.draft.matrices[1].as_ref().unwrap()[(0, 0)],
            )
        };
        found.items.iter().map(gain).collect()
    }

    #[test]
    fn models_are_found_in_structs_in_cells_in_struct_arrays_and_beside_one_another() {
        let of_two = StructArray {
            shape: vec![1, 2],
            fields: [("A", -1.0), ("B", 3.0), ("C", 1.0), ("D", 0.0)]
                .map(|(name, value)| {
                    (
                        name.to_owned(),
                        vec![numbers(1, 1, &[value]), numbers(1, 1, &[value])],
                    )
                })
                .into(),
        };
        let in_cell = CellArray {
            shape: vec![1, 1],
            values: vec![Value::Struct(record(model(2.0)))],
        };
        let nested = record(vec![
            ("sys", Value::Struct(record(model(1.0)))),
            ("all", Value::Cell(in_cell)),
        ]);
        let found = recognise(&[
            variable("c1", Value::Struct(nested)),
            variable("more", Value::Struct(of_two)),
        ]);
        let expected = [
            ("c1.sys", 1.0),
            ("c1.all{1}", 2.0),
            ("more(1)", 3.0),
            ("more(2)", 3.0),
        ];
        assert_eq!(
            gains(&found),
            expected.map(|(name, gain)| (name.to_owned(), gain))
        );
        let loose: Vec<Variable> = model(4.0)
            .into_iter()
            .map(|(name, value)| variable(name, value))
            .collect();
        assert_eq!(gains(&recognise(&loose)), [(String::new(), 4.0)]);
        let suffixed: Vec<Variable> = model(5.0)
            .into_iter()
            .map(|(name, value)| variable(&format!("{name}_nom"), value))
            .collect();
        assert_eq!(gains(&recognise(&suffixed)), [("nom".to_owned(), 5.0)]);
    }

    #[test]
    fn matrices_behind_one_another_are_models_and_share_what_there_is_once() {
        let pages = Array {
            shape: vec![1, 1, 2],
            kind: ElementKind::Float,
            re: vec![7.0, 8.0],
            im: None,
        };
        let a = Array {
            shape: vec![1, 1, 2],
            kind: ElementKind::Float,
            re: vec![-1.0, -2.0],
            im: None,
        };
        let mut fields = model(0.0);
        (fields[0].1, fields[1].1) = (Value::Array(a), Value::Array(pages));
        let found = recognise(&[variable("sys", Value::Struct(record(fields)))]);
        assert_eq!(
            gains(&found),
            [
                ("sys(:,:,1)".to_owned(), 7.0),
                ("sys(:,:,2)".to_owned(), 8.0)
            ]
        );
    }

    #[test]
    fn an_object_of_matlab_keeps_its_numbers_inside_and_its_names_outside() {
        let text = |text: &str| {
            Value::Text(TextArray {
                shape: vec![1, 1],
                texts: vec![text.to_owned()],
            })
        };
        let lower = model(6.0)
            .into_iter()
            .map(|(name, value)| (name.to_lowercase(), vec![value]));
        let ts = ("Ts".to_owned(), vec![numbers(1, 1, &[0.5])]);
        let data = StructArray {
            shape: vec![1, 1],
            fields: lower.chain([ts]).collect(),
        };
        let data = Object {
            class: "ltipack.ssdata".to_owned(),
            records: data,
        };
        let names = CellArray {
            shape: vec![1, 1],
            values: vec![text("LAT")],
        };
        let fields = vec![
            ("InputName_", Value::Cell(names)),
            ("Data_", Value::Object(data)),
        ];
        let found = recognise(&[variable(
            "s",
            Value::Object(Object {
                class: "ss".to_owned(),
                records: record(fields),
            }),
        )]);
        assert_eq!(gains(&found), [("s".to_owned(), 6.0)]);
        assert_eq!(found.items[0].inputs[0].name.as_deref(), Some("LAT"));
        assert_eq!(found.items[0].draft.timing.sample_time_s, Some(0.5));
    }

    #[test]
    fn what_looks_like_a_model_and_is_none_is_named_with_its_place() {
        let of = |change: fn(&mut Vec<(&'static str, Value)>)| {
            let mut fields = model(1.0);
            change(&mut fields);
            recognise(&[variable("sys", Value::Struct(record(fields)))])
                .faults
                .join("; ")
        };
        assert_eq!(
            of(|fields| fields[1].1 = numbers(2, 1, &[1.0, 1.0])),
            "sys: B: expected 1 x 1, found 2 x 1"
        );
        let not_finite = of(|fields| fields[0].1 = numbers(1, 1, &[f64::NAN]));
        assert_eq!(
            not_finite,
            "sys: A, row 1, column 1: expected a finite number, found NaN"
        );
        assert!(of(|fields| fields.push(("Ts", numbers(1, 1, &[-1.0])))).contains("set Ts"));
        assert!(
            of(|fields| fields.push(("InternalDelay", numbers(1, 1, &[0.1])))).contains("absorb")
        );
        let opaque = Value::Opaque {
            class: "ss".to_owned(),
            why: "write A, B, C, D".to_owned(),
        };
        assert_eq!(
            recognise(&[variable("x", opaque)]).faults,
            ["x (ss): write A, B, C, D"]
        );
    }

    fn json(text: &str) -> Found<FoundModel> {
        let found = crate::import::model_files::models_of_bytes(
            text.as_bytes(),
            "c1_90kt/m.json",
            &ReadingBudget::new(1 << 24),
        )
        .unwrap();
        let unused = found.unused.into_values().flatten().collect();
        Found {
            items: found.models,
            faults: found.faults,
            ignored: found.ignored,
            unused,
        }
    }

    /// Two inputs and two outputs beside further members.
    fn beside(members: &str) -> Found<FoundModel> {
        json(&format!(
            r#"{{"A": [[-1, 0], [0, -2]], "B": [[1, 0], [0, 2]], "C": [[1, 0], [0, 1]], "D": [[0, 0], [0, 0]], {members}}}"#
        ))
    }

    fn delays(found: &Found<FoundModel>) -> [Option<Vec<f64>>; 2] {
        assert_eq!(found.faults, Vec::<String>::new());
        let timing = &found.items[0].draft.timing;
        [
            timing.input_delays_s.clone(),
            timing.output_delays_s.clone(),
        ]
    }

    #[test]
    fn delays_are_read_under_every_name_that_says_whose_they_are_and_in_which_unit() {
        for member in [
            r#""InputDelay": [0.03, 0.05]"#,
            r#""InputDelays": [0.03, 0.05]"#,
            r#""InputDelay(s)": [0.03, 0.05]"#,
            r#""input_delay": [0.03, 0.05]"#,
            r#""input_delays": [0.03, 0.05]"#,
            r#""input_delay_s": [0.03, 0.05]"#,
            r#""input_delays_s": [0.03, 0.05]"#,
            r#""input_delay_ms": [30, 50]"#,
            r#""input_delays_ms": [30, 50]"#,
            r#""ioDelay": [[0.03, 0.05], [0.03, 0.05]]"#,
        ] {
            let [inputs, outputs] = delays(&beside(member));
            let inputs = inputs.unwrap_or_else(|| panic!("{member}"));
            let differs = inputs
                .iter()
                .zip([0.03, 0.05])
                .any(|(found, expected)| (found - expected).abs() > 1e-15);
            assert!(
                !differs && outputs.is_none_or(|outputs| outputs == [0.0, 0.0]),
                "{member}: {inputs:?}"
            );
        }
        let [inputs, outputs] = delays(&beside(
            r#""TransportDelay": [[0.03, 0.05], [0.04, 0.06]], "InputDelay": 0.01"#,
        ));
        let near = |found: Option<Vec<f64>>, expected: [f64; 2]| {
            found
                .unwrap()
                .iter()
                .zip(expected)
                .all(|(found, expected)| (found - expected).abs() < 1e-15)
        };
        assert!(
            near(inputs, [0.04, 0.06]) && near(outputs, [0.0, 0.01]),
            "split, and added to those of the inputs"
        );
        let noted = beside(r#""input_delays": [0.03, 0.05]"#)
            .items
            .remove(0)
            .notes;
        assert!(
            noted
                .iter()
                .any(|note| note.contains("input_delays taken to be in s")),
            "{noted:?}"
        );
        assert_eq!(
            delays(&beside(r#""tau": [0, 0], "delays": []"#)),
            [None, None],
            "zeros ask for nothing"
        );
    }

    #[test]
    fn what_resembles_a_delay_and_leaves_something_open_is_asked_about() {
        for (member, question) in [
            (r#""tau": 0.03"#, "tau looks like a delay"),
            (r#""tau_i": [0.03, 0.05]"#, "tau_i looks like a delay"),
            (r#""tau_ms": 30"#, "tau_ms looks like a delay"),
            (r#""Td": 0.03"#, "Td looks like a delay"),
            (r#""delay_in": [0.03, 0.05]"#, "delay_in looks like a delay"),
            (r#""delays": {"LON": 0.03}"#, "delays looks like a delay"),
            (r#""time_delay": 0.03"#, "time_delay looks like a delay"),
            (
                r#""input_delay": [30, 50]"#,
                "50 can be seconds or milliseconds",
            ),
            (
                r#""input_delay": [0.02, 0.04], "Ts": 0.02"#,
                "seconds or samples",
            ),
            (
                r#""InputDelay": [0.02, 0.05], "Ts": 0.02"#,
                "no whole numbers",
            ),
            (
                r#""ioDelay": [[0.03, 0.05], [0.03, 0.06]]"#,
                "are not the sum",
            ),
            (
                r#""TransportDelay": [0.03, 0.05, 0.07]"#,
                "2 x 2 (outputs x inputs)",
            ),
            (
                r#""input_delays_s": [0.03, 0.05, 0.07]"#,
                "expected 2 delays",
            ),
            (
                r#""InputDelay": [0.03, 0.05], "input_delays_ms": [30, 40]"#,
                "a second time",
            ),
            (r#""TimeUnit": "milliseconds""#, "chgTimeUnit"),
        ] {
            let found = beside(member);
            assert!(found.items.is_empty(), "{member}: never dropped");
            assert!(
                found.faults[0].contains(question),
                "{member}: {:?}",
                found.faults
            );
        }
        let outside = json(
            r#"{"sys": {"A": [[-1]], "B": [[1]], "C": [[1]], "D": [[0]]}, "input_delays_s": 0.03}"#,
        );
        assert!(
            outside.items.is_empty() && outside.faults[0].contains("beside no model"),
            "{:?}",
            outside.faults
        );
        let model = r#""A": [[-1]], "B": [[1]], "C": [[1]], "D": [[0]]"#;
        let own = json(&format!(
            r#"{{"format": "gdcm-models", "version": 1, "models": [{{"name": "m", {model}, "input_delay_ms": [30]}}]}}"#
        ));
        assert_eq!(
            delays(&own),
            [Some(vec![0.03]), None],
            "a file of this program made by hand"
        );
    }

    #[test]
    fn each_of_several_models_beside_one_another_has_its_own_delays() {
        let mut variables = Vec::new();
        for (suffix, delay) in [("_nom", 0.03), ("_pert", 0.05)] {
            for (name, value) in model(1.0) {
                variables.push(variable(&format!("{name}{suffix}"), value));
            }
            variables.push(variable(
                &format!("InputDelay{suffix}"),
                numbers(1, 1, &[delay]),
            ));
        }
        let found = recognise(&variables);
        assert_eq!(found.faults, Vec::<String>::new());
        let delays: Vec<Option<Vec<f64>>> = found
            .items
            .iter()
            .map(|model| model.draft.timing.input_delays_s.clone())
            .collect();
        assert_eq!(delays, [Some(vec![0.03]), Some(vec![0.05])]);
        assert_eq!(found.unused, Vec::<String>::new());
    }

    #[test]
    fn what_is_not_used_is_listed_once_for_a_file() {
        let found = beside(
            r#""Q": [[1]], "author": "me", "trim": {"airspeed_kt": 90, "theta_deg": 3}, "airspeed_kt": 90"#,
        );
        assert_eq!(found.unused, ["Q", "author", "trim.theta_deg"]);
        assert_eq!(
            found.items[0].draft.source.as_ref().unwrap().unused,
            found.unused
        );
        let model = r#"{"A": [[-1]], "B": [[1]], "C": [[1]], "D": [[0]], "torque": 7}"#;
        let several = json(&format!(
            r#"{{"models": [{model}, {model}], "more": [1, 2]}}"#
        ));
        assert_eq!(several.unused, ["more", "models{:}.torque"]);
        let listed: Vec<usize> = several
            .items
            .iter()
            .map(|model| model.draft.source.as_ref().unwrap().unused.len())
            .collect();
        assert_eq!(listed, [2, 0], "by the first model of the file");
    }

    #[test]
    fn channels_are_objects_with_a_name_and_a_unit_too_and_a_wrong_number_of_them_is_refused() {
        let label = |name: &str, unit: &str| ChannelLabel {
            name: Some(name.into()),
            unit: Some(unit.into()),
        };
        let members = r#""inputs": [{"name": "delta_ped", "unit": "in"}, {"name": "delta_lat", "unit": "in"}],
            "outputs": [{"name": "R", "unit": "rad/s"}, {"name": "P", "unit": "rad/s"}]"#;
        let found = beside(members);
        assert_eq!(
            found.items[0].inputs,
            [label("delta_ped", "in"), label("delta_lat", "in")],
            "{:?}",
            found.faults
        );
        assert_eq!(
            found.items[0].outputs,
            [label("R", "rad/s"), label("P", "rad/s")]
        );
        let own = json(&format!(
            r#"{{"format": "gdcm-models", "version": 1, "models": [{{"name": "m", "A": [[-1]], "B": [[1, 2]], "C": [[1], [2]],
                "D": [[0, 0], [0, 0]], {members}}}]}}"#
        ));
        assert_eq!(
            own.items[0].inputs,
            [label("delta_ped", "in"), label("delta_lat", "in")],
            "{:?}",
            own.faults
        );
        let around = json(&format!(
            r#"{{"sys": {{"A": [[-1]], "B": [[1, 2]], "C": [[1], [2]], "D": [[0, 0], [0, 0]]}}, {members}}}"#
        ));
        assert_eq!(
            around.items[0].inputs,
            [label("delta_ped", "in"), label("delta_lat", "in")],
            "{:?}",
            around.faults
        );
        for wrong in [
            r#""inputs": ["LON"]"#,
            r#""inputs": {"LON": "in", "LAT": "in"}"#,
            r#""inputs": ["LON", 3]"#,
        ] {
            let found = beside(wrong);
            assert!(
                found.items.is_empty() && found.faults[0].contains("inputs"),
                "{wrong}: {:?}",
                found.faults
            );
        }
    }

    #[test]
    fn what_stands_beside_a_model_about_its_condition_is_used_and_contradictions_are_refused() {
        let found = beside(
            r#""airspeed_kt": 70, "name": "bank", "perturbation": {"roll_deg": 5}, "mass_kg": 6600"#,
        );
        let model = &found.items[0];
        assert_eq!(
            (model.facts.airspeed_kt, model.facts.mass_kg),
            (Some(70.0), Some(6600.0))
        );
        assert_eq!(model.facts.name.as_deref(), Some("bank"));
        let perturbation = [("roll_deg".to_owned(), 5.0)].into();
        assert_eq!(
            model.draft.origin,
            Origin::Perturbed {
                perturbation: Some(perturbation)
            }
        );
        let model = r#"{"A": [[-1]], "B": [[1]], "C": [[1]], "D": [[0]]}"#;
        let around = json(&format!(
            r#"{{"airspeed_kt": 70, "role": "nominal", "sys": {model}}}"#
        ));
        assert_eq!(around.items[0].facts.airspeed_kt, Some(70.0));
        assert_eq!(
            around.items[0].draft.origin,
            Origin::Nominal { perturbation: None }
        );
        let differing = json(
            r#"{"airspeed_kt": 70, "sys": {"A": [[-1]], "B": [[1]], "C": [[1]], "D": [[0]], "airspeed_kt": 90}}"#,
        );
        assert!(
            differing.faults[0].contains("90 and 70 are said of one model"),
            "{:?}",
            differing.faults
        );
    }

    #[test]
    fn a_stack_and_a_struct_array_say_the_airspeed_of_each_model() {
        let stack = json(
            r#"{"A": [[[-1]], [[-2]], [[-3]]], "B": [[1]], "C": [[1]], "D": [[0]], "airspeed_kt": [60, 80, 100]}"#,
        );
        let airspeeds = |found: &Found<FoundModel>| -> Vec<Option<f64>> {
            found
                .items
                .iter()
                .map(|model| model.facts.airspeed_kt)
                .collect()
        };
        assert_eq!(
            airspeeds(&stack),
            [Some(60.0), Some(80.0), Some(100.0)],
            "{:?}",
            stack.faults
        );
        let assembly = gdcm_model::assembly::Assembly::new(
            stack.items,
            gdcm_model::assembly::Rules::default(),
        );
        let conditions: Vec<Option<i64>> = assembly
            .parts()
            .iter()
            .map(|part| part.row.condition)
            .collect();
        assert_eq!(conditions, [Some(1); 3], "the folder says a number");
        let short = json(
            r#"{"A": [[[-1]], [[-2]], [[-3]]], "B": [[1]], "C": [[1]], "airspeed_kt": [60, 80]}"#,
        );
        assert!(
            short.items.is_empty() && short.faults[0].contains("2 numbers for 3 models"),
            "{:?}",
            short.faults
        );
    }

    #[test]
    fn gamma_a_bare_f_and_coherence_of_another_size_are_asked_about_beside_a_response() {
        let of = |members: &str| {
            let found = json(&format!(
                r#"{{"re": [1, 2, 3], "im": [0, 1, 2], {members}}}"#
            ));
            (found.items.len(), found.faults.join("; "))
        };
        assert_eq!(
            of(r#""w": [1, 2, 3], "COHER": [1, 0.9, 0.8]"#),
            (1, String::new())
        );
        assert!(
            of(r#""w": [1, 2, 3], "gamma": [1, 0.9, 0.8]"#)
                .1
                .contains("γ or γ² is not said")
        );
        assert!(
            of(r#""w": [1, 2, 3], "coherence": [1, 0.9]"#)
                .1
                .contains("2 numbers for the 3")
        );
        assert!(
            of(r#""f": [1, 2, 3]"#)
                .1
                .contains("rad/s or Hz is not said")
        );
        assert!(
            of(r#""f": [1, 2, 3], "frequency_unit": "rps""#)
                .1
                .contains("expected rad/s or Hz")
        );
        assert_eq!(
            of(r#""f": [1, 2, 3], "frequency_unit": "Hz""#),
            (1, String::new())
        );
        assert!(
            of(r#""w": [1, 2, 3], "InputDelay": 0.03"#)
                .1
                .contains("has its delays in it")
        );
    }

    #[test]
    fn a_response_of_several_channels_is_put_in_order() {
        // Two outputs, one input, three frequencies: the first index is fastest.
        let response = Array {
            shape: vec![2, 1, 3],
            kind: ElementKind::Float,
            re: vec![1.0, 10.0, 2.0, 20.0, 3.0, 30.0],
            im: Some(vec![0.0; 6]),
        };
        let text = Value::Text(TextArray {
            shape: vec![1, 1],
            texts: vec!["Hz".to_owned()],
        });
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
