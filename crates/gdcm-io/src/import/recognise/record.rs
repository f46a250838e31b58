//! Named fields that belong together: a struct, an object, or a file's variables.
//!
//! A record knows the record that encloses it, whose labels and flight condition apply to its
//! models, and remembers which of its fields were used, so that the others can be reported. MATLAB
//! objects store the fields that other files hold directly in *parts* (`Data_`); in an array of
//! models, a part has an element for each model, called *page*.

use std::cell::{OnceCell, RefCell};
use std::collections::{BTreeSet, HashMap};
use std::rc::Rc;

use gdcm_model::names::channel_alias::folded_name;

use super::delay_names::{DelayField, delay_fields};
use super::values::Field;
use crate::formats::variables::{StructArray, Value, Variable};

/// Parts in MATLAB and GNU Octave objects with the fields that other files store directly.
const INNER_PARTS: [&str; 4] = ["data", "structure", "lti", RESPONSE_PART];
/// Field in this program's models that holds the measured response.
const RESPONSE_PART: &str = "frequencyresponse";
/// Maximum nesting depth of parts.
const DEEPEST_PART: usize = 3;

/// Index of the first field with each name, built at the first query. A record may have nearly as
/// many fields as its file has bytes, too many to search for each name.
#[derive(Clone, Debug, Default)]
struct FieldIndex<'v> {
    exact: HashMap<&'v str, Field<'v>>,
    /// Fields by name without case and underscores.
    folded: HashMap<String, Field<'v>>,
}

impl<'v> FieldIndex<'v> {
    fn new(fields: &[Field<'v>]) -> Self {
        let mut index = Self::default();
        for &field in fields {
            index.exact.entry(field.name).or_insert(field);
            index.folded.entry(folded_name(field.name)).or_insert(field);
        }
        index
    }
}

/// A group of fields, which remembers the fields already used.
#[derive(Clone, Debug, Default)]
pub(crate) struct Record<'v> {
    fields: Vec<Field<'v>>,
    index: OnceCell<FieldIndex<'v>>,
    used: RefCell<BTreeSet<&'v str>>,
    /// Paths to unused fields inside structs that were used.
    unused_inside: RefCell<Vec<String>>,
    delays: OnceCell<Vec<DelayField<'v>>>,
    /// The enclosing record, whose labels and flight condition apply to all models inside.
    outer: Option<Rc<Record<'v>>>,
    /// Whether the fields apply to several models at once.
    pub(super) is_shared: bool,
    /// Class, if the record is a MATLAB or Octave object.
    pub(crate) class: Option<&'v str>,
    /// Whether the record is a struct or an object; false for the variables in a file.
    pub(crate) is_struct_or_object: bool,
}

impl<'v> Record<'v> {
    /// Creates a record from a file's variables.
    pub(crate) fn from_variables(variables: &'v [Variable]) -> Self {
        Self::from_fields(variables.iter().map(|variable| Field {
            name: &variable.name,
            value: &variable.value,
        }))
    }

    /// Creates a record from fields that do not form a struct.
    pub(crate) fn from_fields(fields: impl Iterator<Item = Field<'v>>) -> Self {
        Self {
            fields: fields.collect(),
            ..Self::default()
        }
    }

    /// Creates a record from element `index` of a struct array.
    pub(crate) fn from_struct(records: &'v StructArray, index: usize) -> Self {
        Self::from_object(records, index, None, 0)
    }

    /// Creates a record from element `index` of a struct array or, if `class` is given, of an
    /// object array. The fields in the parts of an object, or of a struct with a measured response,
    /// are added to its own; from a part that is an array, those in the element `page`.
    pub(super) fn from_object(
        records: &'v StructArray,
        index: usize,
        class: Option<&'v str>,
        page: usize,
    ) -> Self {
        let mut fields = fields_of(records, index);
        let holds_response = fields
            .iter()
            .any(|field| folded_name(field.name) == RESPONSE_PART);
        if class.is_some() || holds_response {
            add_inner(&mut fields, page, DEEPEST_PART);
        }
        Self {
            fields,
            class,
            is_struct_or_object: true,
            ..Self::default()
        }
    }

    /// Sets the record that encloses this record.
    pub(super) fn inside(self, outer: &Rc<Record<'v>>) -> Self {
        Self {
            outer: Some(Rc::clone(outer)),
            ..self
        }
    }

    /// Marks the fields as applying to several models.
    pub(super) fn shared(self) -> Self {
        Self {
            is_shared: true,
            ..self
        }
    }

    /// Returns the number of models in element `index` of an object array, whose part `Data_` has
    /// an element for each model; 1 without such a part.
    pub(crate) fn page_count(records: &StructArray, index: usize) -> usize {
        let data = fields_of(records, index)
            .into_iter()
            .find(|field| folded_name(field.name) == "data");
        match data.map(|field| field.value) {
            Some(Value::Object(object)) => object.records.shape.iter().product(),
            _ => 1,
        }
    }

    /// Returns the value in the first field found under these names and marks it as used. Exact
    /// names are tried before names without case and underscores.
    pub(crate) fn get(&self, names: &[&str]) -> Option<&'v Value> {
        Some(self.take(self.find(names)?))
    }

    /// Finds the same field as [`Self::get`], without marking it as used.
    pub(crate) fn find(&self, names: &[&str]) -> Option<Field<'v>> {
        for name in names {
            if let Some(field) = self.index().exact.get(name) {
                return Some(*field);
            }
        }
        for name in names {
            if let Some(field) = self.index().folded.get(&folded_name(name)) {
                return Some(*field);
            }
        }
        None
    }

    /// Returns the value in the field with exactly this name and marks it as used.
    pub(crate) fn exact(&self, name: &str) -> Option<&'v Value> {
        Some(self.take(*self.index().exact.get(name)?))
    }

    /// Returns the value in the field with exactly this name, without marking it as used.
    pub(super) fn peek(&self, name: &str) -> Option<&'v Value> {
        let field = self.index().exact.get(name)?;
        Some(field.value)
    }

    /// Returns a field's value and marks it as used.
    pub(super) fn take(&self, field: Field<'v>) -> &'v Value {
        self.mark_used(field.name);
        field.value
    }

    pub(super) fn mark_used(&self, name: &'v str) {
        self.used.borrow_mut().insert(name);
    }

    pub(super) fn is_used(&self, name: &str) -> bool {
        self.used.borrow().contains(name)
    }

    /// Adds the path to an unused field inside a struct in this record, such as "trim.theta_deg".
    pub(super) fn note_unused_inside(&self, path: String) {
        let mut unused = self.unused_inside.borrow_mut();
        if !unused.contains(&path) {
            unused.push(path);
        }
    }

    /// Returns the unused field names, and the paths to unused fields inside structs that were
    /// used; empty for objects, which hold much internal data.
    pub(super) fn unused(&self) -> Vec<String> {
        if self.class.is_some() {
            return Vec::new();
        }
        let mut unused: Vec<String> = self
            .fields
            .iter()
            .filter(|field| !self.is_used(field.name))
            .map(|field| field.name.to_owned())
            .collect();
        unused.extend(self.unused_inside.borrow().iter().cloned());
        unused
    }

    /// Returns the fields whose names suggest a delay.
    pub(super) fn delay_fields(&self) -> &[DelayField<'v>] {
        self.delays.get_or_init(|| delay_fields(&self.fields))
    }

    /// Iterates over this record and its enclosing records, from the inside out.
    pub(super) fn with_outer(&self) -> impl Iterator<Item = &Record<'v>> {
        std::iter::successors(Some(self), |record| record.outer.as_deref())
    }

    fn index(&self) -> &FieldIndex<'v> {
        self.index.get_or_init(|| FieldIndex::new(&self.fields))
    }

    /// Returns the fields in file order.
    pub(crate) fn fields(&self) -> impl Iterator<Item = Field<'v>> + '_ {
        self.fields.iter().copied()
    }
}

/// Returns the fields in element `index` of a struct array.
fn fields_of(records: &StructArray, index: usize) -> Vec<Field<'_>> {
    let mut fields = Vec::with_capacity(records.fields.len());
    for (name, values) in &records.fields {
        if let Some(value) = values.get(index) {
            fields.push(Field { name, value });
        }
    }
    fields
}

/// Appends the fields in an object's parts, down to `levels` levels, after its other fields.
fn add_inner(fields: &mut Vec<Field<'_>>, page: usize, levels: usize) {
    if levels == 0 {
        return;
    }
    let mut parts = Vec::new();
    for field in fields.iter() {
        if !INNER_PARTS.contains(&folded_name(field.name).as_str()) {
            continue;
        }
        match field.value {
            Value::Object(object) => parts.push(&object.records),
            Value::Struct(records) => parts.push(records),
            Value::Array(_) | Value::Text(_) | Value::Cell(_) | Value::Opaque { .. } => {}
        }
    }
    for records in parts {
        let mut inner = fields_of(records, page);
        add_inner(&mut inner, 0, levels - 1);
        fields.append(&mut inner);
    }
}
