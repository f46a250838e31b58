//! Named fields in a struct, an object or a file.

use std::cell::{OnceCell, RefCell};
use std::collections::{BTreeMap, BTreeSet, HashMap};
use std::rc::Rc;

use nalgebra::{Complex, DMatrix};

use gdcm_model::assembly::ChannelLabel;
use gdcm_model::assembly::found_model::Facts;
use gdcm_model::dataset::channel::ChannelSide;
use gdcm_model::dataset::model::Origin;
use gdcm_model::names::RowRole;
use gdcm_model::names::channel_alias::folded_name;
use gdcm_model::names::signed_name::parse_direction;
use gdcm_model::units::number;

use super::delays::{DelayField, delay_fields};
use crate::formats::variables::{Array, StructArray, Value, Variable};

/// Inner parts in which objects of MATLAB and GNU Octave store fields that other files store
/// directly.
const INNER_PARTS: [&str; 4] = ["data", "structure", "lti", RESPONSE_PART];
/// Field of this program's models that holds the measured response.
const RESPONSE_PART: &str = "frequencyresponse";
/// Deepest nesting of inner parts.
const DEEPEST_PART: usize = 3;

/// The first field of each name; built on the first query, as a record may have as many fields as a
/// file has bytes.
#[derive(Clone, Debug, Default)]
struct Index<'v> {
    exact: HashMap<&'v str, Field<'v>>,
    /// Without case and underscores.
    folded: HashMap<String, Field<'v>>,
}

/// A named value.
pub(crate) type Field<'v> = (&'v str, &'v Value);

/// Fields that belong together.
#[derive(Clone, Debug, Default)]
pub(crate) struct Record<'v> {
    fields: Vec<Field<'v>>,
    index: OnceCell<Index<'v>>,
    /// Names of the used fields; `unused_inside` lists unused fields of the structs among them.
    used: RefCell<BTreeSet<&'v str>>,
    unused_inside: RefCell<Vec<String>>,
    delays: OnceCell<Vec<DelayField<'v>>>,
    /// The enclosing record, whose statements apply to every model inside.
    outer: Option<Rc<Record<'v>>>,
    /// Whether the fields belong to several models.
    is_shared: bool,
    /// The class of an object.
    pub(crate) class: Option<&'v str>,
    /// Whether the record is a struct or an object, not the variables of a file.
    pub(crate) stands_alone: bool,
}

impl<'v> Record<'v> {
    /// Creates a record from the variables of a file.
    pub(crate) fn of_variables(variables: &'v [Variable]) -> Self {
        Self::of_fields(
            variables
                .iter()
                .map(|variable| (variable.name.as_str(), &variable.value)),
        )
    }

    /// Creates a record from named values beside other values.
    pub(crate) fn of_fields(fields: impl Iterator<Item = (&'v str, &'v Value)>) -> Self {
        Self {
            fields: fields.collect(),
            ..Self::default()
        }
    }

    /// Creates a record from one element of a struct array, including the inner parts of an object
    /// (page `page` where they are arrays): MATLAB objects keep their numbers in `Data_`.
    pub(crate) fn of_struct(
        records: &'v StructArray,
        index: usize,
        class: Option<&'v str>,
        page: usize,
    ) -> Self {
        let mut fields = fields_of(records, index);
        let holds_response = fields
            .iter()
            .any(|(name, _)| folded_name(name) == RESPONSE_PART);
        if class.is_some() || holds_response {
            add_inner(&mut fields, page, DEEPEST_PART);
        }
        Self {
            fields,
            class,
            stands_alone: true,
            ..Self::default()
        }
    }

    /// Places the record inside another record.
    pub(super) fn inside(self, outer: &Rc<Record<'v>>) -> Self {
        Self {
            outer: Some(Rc::clone(outer)),
            ..self
        }
    }

    /// Marks the fields as shared by several models.
    pub(super) fn shared(self) -> Self {
        Self {
            is_shared: true,
            ..self
        }
    }

    /// Returns the number of models in an object array, in which each model has a record of
    /// numbers.
    pub(crate) fn pages(records: &StructArray, index: usize) -> usize {
        let data = fields_of(records, index)
            .into_iter()
            .find(|(name, _)| folded_name(name) == "data");
        match data {
            Some((_, Value::Object(object))) => object.records.shape.iter().product(),
            _ => 1,
        }
    }

    /// Returns the first existing field with one of these names and marks it as used: exact names
    /// first, then names without case and underscores.
    pub(crate) fn get(&self, names: &[&str]) -> Option<&'v Value> {
        let (name, value) = self.find(names)?;
        self.use_field(name);
        Some(value)
    }

    /// Finds the same field with its name, without marking it as used.
    pub(crate) fn find(&self, names: &[&str]) -> Option<Field<'v>> {
        let exact = names.iter().find_map(|name| self.index().exact.get(name));
        let loose = |name: &&str| self.index().folded.get(&folded_name(name));
        exact.or_else(|| names.iter().find_map(loose)).copied()
    }

    /// Returns the field with exactly this name and marks it as used.
    pub(crate) fn exact(&self, name: &str) -> Option<&'v Value> {
        let (name, value) = *self.index().exact.get(name)?;
        self.use_field(name);
        Some(value)
    }

    /// Returns the field with exactly this name, without marking it as used.
    pub(super) fn peek(&self, name: &str) -> Option<&'v Value> {
        self.index().exact.get(name).map(|(_, value)| *value)
    }

    /// Returns the value of a field and marks it as used.
    pub(super) fn used(&self, (name, value): Field<'v>) -> &'v Value {
        self.use_field(name);
        value
    }

    /// Marks a field as used.
    pub(super) fn use_field(&self, name: &'v str) {
        self.used.borrow_mut().insert(name);
    }

    /// Whether a field was used.
    pub(super) fn is_used(&self, name: &str) -> bool {
        self.used.borrow().contains(name)
    }

    /// Notes fields of a struct as unused: "trim.theta_deg".
    fn note_unused_inside(&self, names: impl Iterator<Item = String>) {
        let mut unused = self.unused_inside.borrow_mut();
        for name in names {
            if !unused.contains(&name) {
                unused.push(name);
            }
        }
    }

    /// Returns the names of the unused fields; none for objects, which store much internal data.
    pub(super) fn unused(&self) -> Vec<String> {
        if self.class.is_some() {
            return Vec::new();
        }
        let unused = self
            .fields
            .iter()
            .filter(|(name, _)| !self.is_used(name))
            .map(|(name, _)| (*name).to_owned());
        unused
            .chain(self.unused_inside.borrow().iter().cloned())
            .collect()
    }

    /// Returns the fields that look like delays.
    pub(super) fn delay_fields(&self) -> &[DelayField<'v>] {
        self.delays.get_or_init(|| delay_fields(&self.fields))
    }

    /// Returns this record and the enclosing records, from inside out.
    pub(super) fn with_outer(&self) -> impl Iterator<Item = &Record<'v>> {
        std::iter::successors(Some(self), |record| record.outer.as_deref())
    }

    fn index(&self) -> &Index<'v> {
        self.index.get_or_init(|| {
            let mut index = Index::default();
            for &(name, value) in &self.fields {
                index.exact.entry(name).or_insert((name, value));
                index
                    .folded
                    .entry(folded_name(name))
                    .or_insert((name, value));
            }
            index
        })
    }

    /// Returns names and values, in order.
    pub(crate) fn fields(&self) -> impl Iterator<Item = (&'v str, &'v Value)> + '_ {
        self.fields.iter().copied()
    }
}

fn fields_of(records: &StructArray, index: usize) -> Vec<(&str, &Value)> {
    let values = records.fields.iter();
    values
        .filter_map(|(name, values)| Some((name.as_str(), values.get(index)?)))
        .collect()
}

/// Appends the fields of an object's inner parts, recursively; outer fields come first.
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

// Names, units and flight conditions that accompany a model.

const INPUT_NAMES: &[&str] = &[
    "InputName",
    "inputs",
    "inname",
    "input_names",
    "input_labels",
    "InputLabels",
    "u_names",
    "unames",
    "input",
];
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
const STATE_NAMES: &[&str] = &[
    "StateName",
    "stname",
    "states",
    "state_names",
    "state_labels",
    "x_names",
    "xnames",
];

/// Returns the texts in a value: an array of texts, or a cell array of them.
pub(crate) fn texts_of(value: &Value) -> Option<Vec<String>> {
    let trimmed = |text: &String| text.trim().to_owned();
    match value {
        Value::Text(text) => Some(text.texts.iter().map(trimmed).collect()),
        Value::Cell(cell) => cell
            .values
            .iter()
            .map(|value| Some(texts_of(value)?.into_iter().next().unwrap_or_default()))
            .collect(),
        Value::Array(array) if array.is_empty() => Some(Vec::new()),
        Value::Array(_) | Value::Struct(_) | Value::Object(_) | Value::Opaque { .. } => None,
    }
}

/// Returns the labels of the `count` inputs of a model.
pub(super) fn inputs_of(record: &Record<'_>, count: usize) -> Result<Vec<ChannelLabel>, String> {
    labels(record, ChannelSide::Input, count)
}

/// Returns the labels of the `count` outputs of a model.
pub(super) fn outputs_of(record: &Record<'_>, count: usize) -> Result<Vec<ChannelLabel>, String> {
    labels(record, ChannelSide::Output, count)
}

/// Returns the names of the states, if there is a name for each state.
pub(super) fn states_of(record: &Record<'_>, order: usize) -> Vec<String> {
    let names = record
        .get(STATE_NAMES)
        .and_then(texts_of)
        .unwrap_or_default();
    if names.len() == order && names.iter().all(|name| !name.is_empty()) {
        names
    } else {
        Vec::new()
    }
}

/// Returns the labels of the `count` channels of a side: those beside the model, or fitting ones
/// from the enclosing record.
///
/// # Errors
/// A list beside the model with another number of channels, or an unordered list: channels are
/// never assigned by position.
fn labels(
    record: &Record<'_>,
    side: ChannelSide,
    count: usize,
) -> Result<Vec<ChannelLabel>, String> {
    let names = list_of_labels(record, side.of(INPUT_NAMES, OUTPUT_NAMES), side, count)?;
    let units = list_of_labels(record, side.of(INPUT_UNITS, OUTPUT_UNITS), side, count)?;
    let names = names.unwrap_or_else(|| vec![String::new(); count]);
    let mut labels: Vec<ChannelLabel> = names.iter().map(|name| label_of(name)).collect();
    for (label, unit) in labels.iter_mut().zip(units.into_iter().flatten()) {
        if !unit.is_empty() {
            label.unit = Some(unit);
        }
    }
    Ok(labels)
}

/// Returns the list of names, or of units, under the first existing key in a record or its
/// enclosing records; empty for missing entries.
fn list_of_labels(
    record: &Record<'_>,
    keys: &[&str],
    side: ChannelSide,
    count: usize,
) -> Result<Option<Vec<String>>, String> {
    for (level, record) in record.with_outer().enumerate() {
        let Some((name, value)) = record.find(keys) else {
            continue;
        };
        let Some(mut texts) = label_texts(name, value)? else {
            continue;
        };
        if count > 1 && texts.len() == 1 && texts[0].split(',').count() == count {
            texts = texts[0]
                .split(',')
                .map(|text| text.trim().to_owned())
                .collect();
        }
        if texts.iter().all(String::is_empty) {
            record.use_field(name);
        } else if texts.len() == count {
            record.use_field(name);
            return Ok(Some(texts));
        } else if level == 0 {
            return Err(format!(
                "{name}: {} entries for the {count} {side}s of the model; write one for each, in the order of the matrices",
                texts.len()
            ));
        }
    }
    Ok(None)
}

/// Fields with the name of a channel object.
const LABEL_NAMES: &[&str] = &["name", "label", "id", "channel"];
const LABEL_UNITS: &[&str] = &["unit", "units"];

/// Returns the labels in a value as texts: texts, or objects with a name and a unit, such as the
/// channels of a dataset; nothing for numbers.
fn label_texts(field: &str, value: &Value) -> Result<Option<Vec<String>>, String> {
    if let Some(texts) = texts_of(value) {
        return Ok(Some(texts));
    }
    let mut records: Vec<(&StructArray, usize)> = Vec::new();
    match value {
        Value::Struct(of) => {
            records.extend((0..of.shape.iter().product()).map(|index| (of, index)))
        }
        Value::Cell(cell)
            if cell
                .values
                .iter()
                .all(|value| matches!(value, Value::Array(_))) =>
        {
            return Ok(None);
        }
        Value::Cell(cell) => {
            for value in &cell.values {
                let Value::Struct(of) = value else {
                    return Err(format!(
                        "{field}: expected the names of channels, found {}",
                        value.words()
                    ));
                };
                records.push((of, 0));
            }
        }
        Value::Array(_) | Value::Text(_) | Value::Object(_) | Value::Opaque { .. } => {
            return Ok(None);
        }
    }
    let label = |(records, index): (&StructArray, usize)| {
        let record = Record::of_struct(records, index, None, 0);
        let text = |keys: &[&str]| {
            record
                .get(keys)
                .and_then(texts_of)
                .and_then(|texts| texts.into_iter().next())
        };
        let name = text(LABEL_NAMES)?;
        let unit = text(LABEL_UNITS).unwrap_or_default();
        Some(if unit.is_empty() || label_of(&name).unit.is_some() {
            name
        } else {
            format!("{name} [{unit}]")
        })
    };
    match records.into_iter().map(label).collect::<Option<Vec<_>>>() {
        Some(labels) => Ok(Some(labels)),
        None => Err(format!(
            "{field}: its channels have no order or no names; write a list of names, or of {{\"name\": …, \"unit\": …}}, in the \
             order of the matrices"
        )),
    }
}

/// Parses a label: "P", "P [deg/s]", "P (deg/s)".
pub(crate) fn label_of(text: &str) -> ChannelLabel {
    let text = text.trim();
    for (open, close) in [('[', ']'), ('(', ')')] {
        if let Some((name, unit)) = text
            .strip_suffix(close)
            .and_then(|text| text.split_once(open))
            && !name.trim().is_empty()
            && !unit.trim().is_empty()
            && parse_direction(unit).is_none()
        {
            return ChannelLabel {
                name: Some(name.trim().to_owned()),
                unit: Some(unit.trim().to_owned()),
            };
        }
    }
    ChannelLabel {
        name: Some(text.to_owned()).filter(|name| !name.is_empty()),
        unit: None,
    }
}

/// Position of a model in an array of models, for reading its flight condition from lists; index 0
/// of 1 for a single model.
#[derive(Clone, Copy, Debug)]
pub(super) struct Page {
    /// Counted from 0.
    pub(super) index: usize,
    pub(super) count: usize,
}

impl Page {
    /// Page of a single model.
    pub(super) const ONLY: Self = Self { index: 0, count: 1 };
}

const CONDITIONS: &[&str] = &["condition", "condition_id", "fc"];
const AIRSPEEDS: &[&str] = &["airspeed_kt", "V_kt", "airspeed_knots", "speed_kt", "KTAS"];
const ALTITUDES: &[&str] = &["altitude_ft", "alt_ft", "h_ft"];
const MASSES: &[&str] = &["mass_kg", "m_kg"];
/// Structs with the flight condition.
const FACTS: [&[&str]; 4] = [
    &["trim"],
    &["flight_condition"],
    &["flight_state"],
    &["condition"],
];
/// Struct of trim offsets, by coordinate.
const OFFSETS: &[&str] = &["perturbation", "trim_offset", "trim_offsets"];
/// Prefix of a single offset: `by_roll_deg`.
const OFFSET: &str = "by_";

/// Returns the flight condition given beside a model and in its enclosing records.
///
/// # Errors
/// A list whose length differs from the number of models, and a number that contradicts an
/// enclosing record.
pub(super) fn facts_of(record: &Record<'_>, page: Page) -> Result<Facts, String> {
    let condition =
        fact(record, CONDITIONS, page)?.filter(|id| id.fract() == 0.0 && id.abs() < 1e9);
    Ok(Facts {
        condition: condition.map(|id| id as i64),
        airspeed_kt: fact(record, AIRSPEEDS, page)?,
        altitude_ft: fact(record, ALTITUDES, page)?,
        mass_kg: fact(record, MASSES, page)?,
        name: name_beside(record, page),
        ..Facts::default()
    })
}

/// Returns a number of the flight condition, given beside a model or in an enclosing record.
fn fact(record: &Record<'_>, names: &[&str], page: Page) -> Result<Option<f64>, String> {
    let mut known: Option<f64> = None;
    for (level, record) in record.with_outer().enumerate() {
        let page = if level == 0 { page } else { Page::ONLY };
        for value in [figure(record, names, page)?, figure_inside(record, names)?]
            .into_iter()
            .flatten()
        {
            match known {
                Some(known) if known != value => {
                    return Err(format!(
                        "{}: {} and {} are said of one model; correct one",
                        names[0],
                        number(known),
                        number(value)
                    ));
                }
                _ => known = Some(value),
            }
        }
    }
    Ok(known)
}

/// Returns the number in a field, or the entry of the page in a list.
fn figure(record: &Record<'_>, names: &[&str], page: Page) -> Result<Option<f64>, String> {
    let Some((name, value)) = record.find(names) else {
        return Ok(None);
    };
    let Some(array) = array_of(value) else {
        return Ok(None);
    };
    let value = match array.re.as_slice() {
        [value] => *value,
        values if page.count > 1 && values.len() == page.count => values[page.index],
        [] => return Ok(None),
        _ if page.count == 1 => return Ok(None),
        values => {
            return Err(format!(
                "{name}: {} numbers for {} models; write one for each",
                values.len(),
                page.count
            ));
        }
    };
    if !value.is_finite() {
        return Ok(None);
    }
    record.use_field(name);
    Ok(Some(value))
}

/// Returns a number from a struct that describes the flight condition: `trim.airspeed_kt`,
/// `condition.id`.
fn figure_inside(record: &Record<'_>, names: &[&str]) -> Result<Option<f64>, String> {
    for keys in FACTS {
        let Some((key, Value::Struct(records))) = record.find(keys) else {
            continue;
        };
        let inner = Record::of_struct(records, 0, None, 0);
        let value = match figure(&inner, names, Page::ONLY)? {
            None if names == CONDITIONS && keys != ["trim"] => figure(&inner, &["id"], Page::ONLY)?,
            value => value,
        };
        let is_new = !record.is_used(key);
        if value.is_some() {
            record.use_field(key);
        }
        if value.is_some() && is_new {
            let is_fact = |name: &str| {
                [AIRSPEEDS, ALTITUDES, MASSES, CONDITIONS]
                    .concat()
                    .contains(&name)
                    || name == "id"
            };
            let others = inner.fields().filter(|(name, _)| !is_fact(name));
            record.note_unused_inside(others.map(|(name, _)| format!("{key}.{name}")));
        }
        if value.is_some() {
            return Ok(value);
        }
    }
    Ok(None)
}

/// Returns the name beside a model; a single name beside several models applies to none of them.
fn name_beside(record: &Record<'_>, page: Page) -> Option<String> {
    let (key, value) = record.find(&["name"]).filter(|_| !record.is_shared)?;
    let texts = texts_of(value)?;
    let name = match texts.as_slice() {
        [name] if page.count == 1 => name,
        names if page.count > 1 && names.len() == page.count => &names[page.index],
        _ => return None,
    };
    if name.is_empty() {
        return None;
    }
    record.use_field(key);
    Some(name.clone())
}

/// Returns the origin of a model, as far as the fields in its record and the enclosing records give
/// it: role, trim offsets, method.
pub(super) fn origin_of(record: &Record<'_>) -> Origin {
    let text = |names: &[&str]| -> Option<String> {
        for record in record.with_outer() {
            let Some((name, value)) = record.find(names) else {
                continue;
            };
            if let Some([text]) = texts_of(value).as_deref() {
                record.use_field(name);
                return Some(text.clone());
            }
        }
        None
    };
    let role = text(&["role"]).and_then(|word| RowRole::from_word(&word.to_lowercase()));
    // Classes of identified models begin with "id"; other classes imply no origin.
    let is_identified = record.class.is_some_and(|class| class.starts_with("id"));
    let perturbation = Some(offsets_of(record)).filter(|offsets| !offsets.is_empty());
    match role {
        Some(RowRole::Nominal) => Origin::Nominal { perturbation },
        Some(RowRole::Perturbed) => Origin::Perturbed { perturbation },
        Some(RowRole::Identified) => Origin::Identified {
            method: text(&["method"]),
            order: None,
        },
        None if is_identified => Origin::Identified {
            method: text(&["method"]),
            order: None,
        },
        None => Origin::Perturbed { perturbation },
    }
}

/// Returns the trim offsets, by coordinate.
fn offsets_of(record: &Record<'_>) -> BTreeMap<String, f64> {
    let mut offsets = BTreeMap::new();
    for record in record.with_outer() {
        for (name, value) in record.fields() {
            if let (Some(coordinate), Some(offset)) = (name.strip_prefix(OFFSET), scalar_of(value))
            {
                record.use_field(name);
                offsets.entry(coordinate.to_owned()).or_insert(offset);
            }
        }
        let Some((key, Value::Struct(records))) = record.find(OFFSETS) else {
            continue;
        };
        let inner = Record::of_struct(records, 0, None, 0);
        record.use_field(key);
        for (coordinate, value) in inner.fields() {
            match scalar_of(value) {
                Some(offset) => {
                    offsets.entry(coordinate.to_owned()).or_insert(offset);
                }
                None => record.note_unused_inside(std::iter::once(format!("{key}.{coordinate}"))),
            }
        }
    }
    offsets
}

// Conversion of values to numbers.

/// Returns the numbers of a value: the value itself, or the value of a parameter of an identified
/// model.
pub(super) fn array_of(value: &Value) -> Option<&Array> {
    match value {
        Value::Array(array) => Some(array),
        Value::Object(object) => {
            // GNU Octave's transfer functions also store polynomials as objects.
            let values = ["Value", "Value_", "poly"]
                .iter()
                .find_map(|name| object.records.field(name))?;
            array_of(values.first()?)
        }
        Value::Struct(records) if records.shape.iter().product::<usize>() == 1 => {
            array_of(records.field("Value")?.first()?)
        }
        Value::Text(_) | Value::Cell(_) | Value::Struct(_) | Value::Opaque { .. } => None,
    }
}

/// Converts a value to a real matrix of finite numbers.
pub(super) fn matrix_of(name: &str, value: &Value) -> Result<DMatrix<f64>, String> {
    let array = array_of(value).ok_or_else(|| {
        format!(
            "{name}: expected a matrix of numbers, found {}",
            value.words()
        )
    })?;
    if array.shape.iter().skip(2).product::<usize>() > 1 {
        return Err(format!(
            "{name}: expected a matrix, found {}",
            value.words()
        ));
    }
    page_of(name, array, 0, false)
}

/// Returns the number of matrices in an array, and their rows and columns; `pages_first` decides
/// which index counts them.
pub(super) fn pages_of(array: &Array, pages_first: bool) -> (usize, [usize; 2]) {
    let side = |axis: usize| array.shape.get(axis).copied().unwrap_or(0);
    match array.shape.len() {
        3 if pages_first => (side(0), [side(1), side(2)]),
        _ => (array.shape.iter().skip(2).product(), [side(0), side(1)]),
    }
}

/// Extracts one matrix from an array of matrices.
pub(super) fn page_of(
    name: &str,
    array: &Array,
    page: usize,
    pages_first: bool,
) -> Result<DMatrix<f64>, String> {
    let (pages, [rows, columns]) = pages_of(array, pages_first);
    if array
        .im
        .as_ref()
        .is_some_and(|im| im.iter().any(|part| *part != 0.0))
    {
        return Err(format!("{name}: expected real numbers, found complex ones"));
    }
    let (start, step) = if array.shape.len() == 3 && pages_first {
        (page, pages)
    } else {
        (page * rows * columns, 1)
    };
    let values: Vec<f64> = array
        .re
        .iter()
        .skip(start)
        .step_by(step.max(1))
        .take(rows * columns)
        .copied()
        .collect();
    // A later side of length 0 leaves an array of this size without numbers.
    if values.len() != rows * columns {
        return Err(format!(
            "{name}: expected a matrix, found an array without numbers"
        ));
    }
    if let Some(at) = values.iter().position(|value| !value.is_finite()) {
        let place = if rows == 0 {
            (0, 0)
        } else {
            (at % rows + 1, at / rows + 1)
        };
        return Err(format!(
            "{name}, row {}, column {}: expected a finite number, found {}",
            place.0, place.1, values[at]
        ));
    }
    Ok(DMatrix::from_column_slice(rows, columns, &values))
}

/// Converts a value to one real finite number.
pub(super) fn scalar_of(value: &Value) -> Option<f64> {
    let array = array_of(value)?;
    match array.re.as_slice() {
        [value] if value.is_finite() => Some(*value),
        _ => None,
    }
}

/// Converts a row or a column to a list of numbers.
pub(super) fn list_of(name: &str, value: &Value) -> Result<Vec<f64>, String> {
    let array = array_of(value)
        .ok_or_else(|| format!("{name}: expected numbers, found {}", value.words()))?;
    match array.re.iter().position(|value| !value.is_finite()) {
        Some(at) => Err(format!(
            "{name}, entry {}: expected a finite number, found {}",
            at + 1,
            number(array.re[at])
        )),
        None => Ok(array.re.clone()),
    }
}

/// Converts a row or a column to a list of complex numbers.
pub(super) fn complex_list_of(name: &str, value: &Value) -> Result<Vec<Complex<f64>>, String> {
    let re = list_of(name, value)?;
    let im = array_of(value)
        .and_then(|array| array.im.clone())
        .unwrap_or_else(|| vec![0.0; re.len()]);
    if im.iter().any(|part| !part.is_finite()) {
        return Err(format!("{name}: expected finite numbers"));
    }
    Ok(re
        .into_iter()
        .zip(im)
        .map(|(re, im)| Complex::new(re, im))
        .collect())
}
