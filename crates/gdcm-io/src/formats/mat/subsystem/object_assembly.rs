//! Assembles MATLAB objects from the cells that hold their properties ([`Subsystem`]).
//!
//! An object becomes a record with its saved properties, followed by the class defaults for the
//! properties that are not saved. References in property values are replaced by the objects to
//! which they point; `Assembly::open` prevents endless recursion, and [`ValuePath::step`] limits
//! the nesting depth. An *opaque* value ([`Value::Opaque`]) holds only the reason why it could not
//! be read.

use std::collections::{HashMap, HashSet};

use crate::formats::mat::subsystem::directory::{Content, Property};
use crate::formats::mat::subsystem::enumeration::is_enumeration;
use crate::formats::mat::subsystem::packed_text::unpack_texts;
use crate::formats::mat::subsystem::reference::Reference;
use crate::formats::mat::subsystem::{Subsystem, damaged};
use crate::formats::mat::unreadable::unreadable;
use crate::formats::mat::value_path::{Step, ValuePath};
use crate::formats::variables::{
    Array, CellArray, ElementKind, Object, StructArray, TextArray, Value,
};
use crate::reading_budget::{ReadingBudget, VariableFault};
use crate::variable_fault::damage::Damage;
use crate::variable_fault::unread::ObjectFault;

/// Property in which some classes, such as `timetable`, save a replacement for all properties; the
/// class defaults then do not apply.
const REPLACEMENT: &str = "any";
/// Estimated memory for a property without the contents of its value \[bytes\].
const PROPERTY_MEMORY: u64 = 256;
/// All integers below this limit are exact as floats.
const EXACT_BELOW: f64 = (1_u64 << 53) as f64;

/// Assembles objects, including nested objects.
pub(super) struct Assembly<'s> {
    subsystem: &'s Subsystem,
    budget: &'s ReadingBudget<'s>,
    /// Numbers of the objects being assembled, to detect an object that contains itself.
    open: Vec<u32>,
}

/// Property of an object: its name and value.
struct NamedValue {
    name: String,
    value: Value,
}

/// Fields of records that are being assembled.
#[derive(Default)]
struct Fields {
    /// Each field's name and values, in the order found.
    fields: Vec<(String, Vec<Value>)>,
    /// Index in `fields`, by name.
    indices: HashMap<String, usize>,
}

impl Fields {
    /// Returns a field's values; adds the field if it is new.
    fn values_mut(&mut self, name: String) -> &mut Vec<Value> {
        let index = match self.indices.get(&name) {
            Some(&index) => index,
            None => {
                self.fields.push((name.clone(), Vec::new()));
                let index = self.fields.len() - 1;
                self.indices.insert(name, index);
                index
            }
        };
        &mut self.fields[index].1
    }
}

impl<'s> Assembly<'s> {
    pub(super) fn new(subsystem: &'s Subsystem, budget: &'s ReadingBudget<'s>) -> Self {
        Self {
            subsystem,
            budget,
            open: Vec::new(),
        }
    }

    /// Returns the objects to which a reference points. The first case that applies:
    ///
    /// 1. a single `string` object: its strings, or opaque if their packing is unknown;
    /// 2. an object that is already being assembled, and thus contains itself: opaque;
    /// 3. else the records of all objects; opaque if they are nested too deeply
    ///    ([`ValuePath::step`]) or damaged.
    ///
    /// # Errors
    /// Any other fault, such as an exceeded limit.
    pub(super) fn resolve(
        &mut self,
        reference: &Reference,
        path: &ValuePath<'_>,
    ) -> Result<Value, VariableFault> {
        let directory = &self.subsystem.directory;
        let class = directory.class(reference.class).unwrap_or("object");
        // Case 1
        if let ("string", &[object]) = (class, reference.objects.as_slice()) {
            return Ok(match self.packed_texts(object)? {
                Some(texts) => Value::Text(texts),
                None => unreadable(class, ObjectFault::Strings, &path.text()),
            });
        }
        // Case 2
        let contains_itself = reference
            .objects
            .iter()
            .any(|&object| object != 0 && self.open.contains(&object));
        if contains_itself {
            return Ok(unreadable(class, ObjectFault::Cycle, &path.text()));
        }
        // Case 3
        let open_before = self.open.len();
        let records = self.records(reference, path);
        // After an error, the objects that were being assembled are still marked as open.
        self.open.truncate(open_before);
        match records {
            Ok(records) => Ok(Value::Object(Object {
                class: class.to_owned(),
                records,
            })),
            Err(VariableFault::TooDeep { .. }) => {
                Ok(unreadable(class, ObjectFault::TooDeep, &path.text()))
            }
            Err(VariableFault::Damaged { damage, .. }) => Ok(unreadable(
                class,
                ObjectFault::Damaged(damage),
                &path.text(),
            )),
            Err(fault) => Err(path.locate(fault)),
        }
    }

    /// Unpacks the strings in a `string` object; `None` if they are missing, or if their packing is
    /// unknown.
    fn packed_texts(&self, object: u32) -> Result<Option<TextArray>, VariableFault> {
        let subsystem = self.subsystem;
        let Some(object) = subsystem.directory.object(object) else {
            return Ok(None);
        };
        let Some(&Property {
            content: Content::Cell(cell),
            ..
        }) = object.properties.first()
        else {
            return Ok(None);
        };
        // The exact 64-bit values if they are known; else the floats, unless any may be rounded.
        if let Some(words) = subsystem.long_words.get(&cell) {
            return unpack_texts(words, self.budget);
        }
        let Some(Value::Array(array)) = subsystem.values.get(cell) else {
            return Ok(None);
        };
        match exact_words(array) {
            Some(words) => unpack_texts(&words, self.budget),
            None => Ok(None),
        }
    }

    /// Returns a record for each referenced object; the fields are all properties that occur in any
    /// of them.
    fn records(
        &mut self,
        reference: &Reference,
        path: &ValuePath<'_>,
    ) -> Result<StructArray, VariableFault> {
        let mut fields = Fields::default();
        // A property may be missing in some objects: its values are padded to one per object.
        for (at, &object) in reference.objects.iter().enumerate() {
            let record = path.step(Step::Record(at))?;
            let path = if reference.objects.len() == 1 {
                path
            } else {
                &record
            };
            self.open.push(object);
            for NamedValue { name, value } in self.properties(object, reference.class, path)? {
                let values = fields.values_mut(name);
                self.pad(values, at)?;
                values.push(value);
            }
            self.open.pop();
        }
        for (_, values) in &mut fields.fields {
            self.pad(values, reference.objects.len())?;
        }
        Ok(StructArray {
            shape: reference.shape.clone(),
            fields: fields.fields,
        })
    }

    /// Appends empty values up to `length`, for objects that lack the property.
    fn pad(&self, values: &mut Vec<Value>, length: usize) -> Result<(), VariableFault> {
        let missing = length.saturating_sub(values.len());
        // The factor 2: vectors grow by doubling.
        self.budget
            .take(missing as u64, 2 * size_of::<Value>() as u64, "")?;
        values.extend((0..missing).map(|_| Value::empty()));
        Ok(())
    }

    /// Returns an object's saved properties, and the class defaults for the properties that are not
    /// saved; only the saved ones if they are replaced ([`REPLACEMENT`]), and none for a deleted
    /// object (number 0).
    fn properties(
        &mut self,
        object: u32,
        class: u32,
        path: &ValuePath<'_>,
    ) -> Result<Vec<NamedValue>, VariableFault> {
        if object == 0 {
            return Ok(Vec::new());
        }
        let subsystem = self.subsystem;
        let Some(saved) = subsystem.directory.object(object) else {
            return Err(damaged(Damage::NoSuchObject { class, object }));
        };
        let mut properties = Vec::new();
        let mut known: HashSet<&str> = HashSet::new();
        for property in saved.properties {
            let Some(name) = subsystem.directory.name(property.name) else {
                return Err(damaged(Damage::PropertyWithoutName));
            };
            if known.insert(name) {
                let value = self.property(property, &path.step(Step::Field(name))?)?;
                let name = name.to_owned();
                properties.push(NamedValue { name, value });
            }
        }
        if known.contains(REPLACEMENT) {
            return Ok(properties);
        }
        let Some(Value::Struct(defaults)) = subsystem.defaults.get(saved.class as usize) else {
            return Ok(properties);
        };
        for (name, values) in &defaults.fields {
            if known.contains(name.as_str()) {
                continue;
            }
            if let Some(value) = values.first() {
                let value = self.copy(value, &path.step(Step::Field(name))?)?;
                let name = name.clone();
                properties.push(NamedValue { name, value });
            }
        }
        Ok(properties)
    }

    fn property(
        &mut self,
        property: &Property,
        path: &ValuePath<'_>,
    ) -> Result<Value, VariableFault> {
        let subsystem = self.subsystem;
        self.budget.take(1, PROPERTY_MEMORY, "")?;
        match property.content {
            Content::Cell(cell) => match subsystem.values.get(cell) {
                Some(value) => self.copy(value, path),
                None => Err(damaged(Damage::PropertyWithoutValue)),
            },
            Content::Name(name) => Ok(Value::text(
                subsystem.directory.name(name).unwrap_or_default(),
            )),
            Content::Number(number) => {
                // The directory stores logical values like integers: 0 and 1 are taken as logical.
                let kind = if number <= 1 {
                    ElementKind::Logical
                } else {
                    ElementKind::Integer
                };
                Ok(Value::Array(Array {
                    kind,
                    ..Array::matrix(1, 1, vec![f64::from(number)])
                }))
            }
        }
    }

    /// Copies a value; replaces references by their objects, and enumeration records by objects.
    fn copy(&mut self, value: &Value, path: &ValuePath<'_>) -> Result<Value, VariableFault> {
        self.budget.take(1, value.own_memory(), "")?;
        if let Some(reference) = self.reference(value) {
            return self.resolve(&reference, path);
        }
        Ok(match value {
            Value::Array(_) | Value::Text(_) | Value::Opaque { .. } => value.clone(),
            Value::Cell(cell) => Value::Cell(self.copy_cell(cell, path)?),
            Value::Struct(records) if is_enumeration(records) => {
                self.subsystem.enumeration(records, "", path, self.budget)?
            }
            Value::Struct(records) => Value::Struct(self.copy_records(records, path)?),
            Value::Object(object) => Value::Object(Object {
                class: object.class.clone(),
                records: self.copy_records(&object.records, path)?,
            }),
        })
    }

    fn copy_cell(
        &mut self,
        cell: &CellArray,
        path: &ValuePath<'_>,
    ) -> Result<CellArray, VariableFault> {
        let mut values = Vec::new();
        for (at, value) in cell.values.iter().enumerate() {
            values.push(self.copy(value, &path.step(Step::Cell(at))?)?);
        }
        Ok(CellArray {
            shape: cell.shape.clone(),
            values,
        })
    }

    fn copy_records(
        &mut self,
        records: &StructArray,
        path: &ValuePath<'_>,
    ) -> Result<StructArray, VariableFault> {
        let mut fields = Vec::with_capacity(records.fields.len());
        for (name, values) in &records.fields {
            let mut copies = Vec::with_capacity(values.len());
            for (at, value) in values.iter().enumerate() {
                let record = path.step(Step::Record(at))?;
                let path = if values.len() == 1 { path } else { &record };
                copies.push(self.copy(value, &path.step(Step::Field(name))?)?);
            }
            fields.push((name.clone(), copies));
        }
        Ok(StructArray {
            shape: records.shape.clone(),
            fields,
        })
    }

    /// Returns the reference in a value. Returns `None` unless its class and objects exist, because
    /// numbers may look like a reference by chance.
    fn reference(&self, value: &Value) -> Option<Reference> {
        let directory = &self.subsystem.directory;
        let reference = Reference::from_value(value)?;
        directory.class(reference.class)?;
        let has_objects = reference
            .objects
            .iter()
            .all(|&object| directory.has_object(object));
        if has_objects { Some(reference) } else { None }
    }
}

/// Converts numbers to integers; `None` if any is negative or may have been rounded.
fn exact_words(array: &Array) -> Option<Vec<u64>> {
    let mut words = Vec::with_capacity(array.re.len());
    for &number in &array.re {
        if !(0.0..EXACT_BELOW).contains(&number) {
            return None;
        }
        words.push(number as u64);
    }
    Some(words)
}
