//! Objects assembled from the cells of their properties.

use std::collections::{HashMap, HashSet};

use super::{Content, Property, Reference, Subsystem, is_enumeration, packed_text};
use crate::formats::mat::matrix::unread_because;
use crate::formats::mat::{FieldPath, Step};
use crate::formats::variables::{
    Array, CellArray, ElementKind, Object, StructArray, TextArray, Value,
};
use crate::reading_budget::{ReadingBudget, VariableFault};

/// Property with the value that a class creates when saving its objects.
const MADE: &str = "any";

/// Assembles objects, including nested objects.
pub(super) struct Assembly<'s> {
    pub(super) subsystem: &'s Subsystem,
    pub(super) budget: &'s ReadingBudget<'s>,
    /// Objects under assembly, to detect an object that contains itself.
    open: Vec<u32>,
}

impl Subsystem {
    /// Resolves a reference.
    pub(in super::super) fn referred(
        &self,
        reference: &Reference,
        trail: &FieldPath<'_>,
        budget: &ReadingBudget<'_>,
    ) -> Result<Value, VariableFault> {
        Assembly::new(self, budget).referred(reference, trail)
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

    /// Resolves a reference; objects that are nested too deeply or cannot be decoded are opaque.
    pub(super) fn referred(
        &mut self,
        reference: &Reference,
        trail: &FieldPath<'_>,
    ) -> Result<Value, VariableFault> {
        let directory = &self.subsystem.directory;
        let class = directory.class(reference.class).unwrap_or("object");
        let opaque = |why: &str| Ok(unread_because(class, why, &trail.words()));
        if let ("string", &[object]) = (class, reference.objects.as_slice()) {
            let text = self.text(object)?;
            return text.map_or_else(
                || opaque("its texts are packed in an unknown way"),
                |text| Ok(Value::Text(text)),
            );
        }
        if reference
            .objects
            .iter()
            .any(|&object| object != 0 && self.open.contains(&object))
        {
            return opaque("it lies in itself");
        }
        let begun = self.open.len();
        let records = self.records(reference, trail);
        self.open.truncate(begun);
        match records {
            Ok(records) => Ok(Value::Object(Object {
                class: class.to_owned(),
                records,
            })),
            Err(VariableFault::TooDeep { .. }) => opaque("too many values lie in one another"),
            Err(VariableFault::Damaged { what, .. }) => opaque(&what),
            Err(fault) => Err(trail.name(fault)),
        }
    }

    /// Returns the texts of a `string` object.
    fn text(&self, object: u32) -> Result<Option<TextArray>, VariableFault> {
        let properties = self
            .subsystem
            .directory
            .object(object)
            .map_or(&[][..], |(_, properties)| properties);
        let Some(&Property {
            content: Content::Cell(cell),
            ..
        }) = properties.first()
        else {
            return Ok(None);
        };
        let words = match (
            self.subsystem.long_words.get(&cell),
            self.subsystem.values.get(cell),
        ) {
            (Some(words), _) => Some(words.clone()),
            (None, Some(Value::Array(array))) => exact_words(array),
            _ => None,
        };
        words.map_or(Ok(None), |words| packed_text(&words, self.budget))
    }

    fn records(
        &mut self,
        reference: &Reference,
        trail: &FieldPath<'_>,
    ) -> Result<StructArray, VariableFault> {
        let mut fields: Vec<(String, Vec<Value>)> = Vec::new();
        let mut places: HashMap<String, usize> = HashMap::new();
        for (at, &object) in reference.objects.iter().enumerate() {
            let record = trail.step(Step::Record(at))?;
            let trail = if reference.objects.len() == 1 {
                trail
            } else {
                &record
            };
            self.open.push(object);
            for (name, value) in self.properties(object, reference.class, trail)? {
                let field = *places.entry(name).or_insert_with_key(|name| {
                    fields.push((name.clone(), Vec::new()));
                    fields.len() - 1
                });
                if let Some((_, values)) = fields.get_mut(field) {
                    self.fill(values, at)?;
                    values.push(value);
                }
            }
            self.open.pop();
        }
        for (_, values) in &mut fields {
            self.fill(values, reference.objects.len())?;
        }
        Ok(StructArray {
            shape: reference.shape.clone(),
            fields,
        })
    }

    /// Fills missing properties of objects in an array with empty values.
    fn fill(&self, values: &mut Vec<Value>, length: usize) -> Result<(), VariableFault> {
        let missing = length.saturating_sub(values.len());
        self.budget
            .take(missing as u64, 2 * size_of::<Value>() as u64, "")?;
        values.extend((0..missing).map(|_| Value::empty()));
        Ok(())
    }

    /// Collects the properties of one object: its saved values, and the defaults of its class for
    /// the others.
    fn properties(
        &mut self,
        object: u32,
        class: u32,
        trail: &FieldPath<'_>,
    ) -> Result<Vec<(String, Value)>, VariableFault> {
        if object == 0 {
            return Ok(Vec::new());
        }
        let subsystem = self.subsystem;
        let entry = subsystem.directory.object(object);
        let (class, saved) = entry.ok_or_else(|| {
            super::damaged(format!("there is no object {object} of class {class}"))
        })?;
        let mut properties: Vec<(String, Value)> = Vec::new();
        let mut known: HashSet<&str> = HashSet::new();
        for property in saved {
            let name = subsystem
                .directory
                .name(property.name)
                .ok_or_else(|| super::damaged("a property has no name"))?;
            if known.insert(name) {
                let value = self.property(property, &trail.step(Step::Field(name))?)?;
                properties.push((name.to_owned(), value));
            }
        }
        let defaults = if known.contains(MADE) {
            None
        } else {
            subsystem.defaults.get(class as usize)
        };
        let Some(Value::Struct(defaults)) = defaults else {
            return Ok(properties);
        };
        for (name, values) in &defaults.fields {
            if let (Some(value), false) = (values.first(), known.contains(name.as_str())) {
                let value = self.copy(value, &trail.step(Step::Field(name))?)?;
                properties.push((name.clone(), value));
            }
        }
        Ok(properties)
    }

    fn property(
        &mut self,
        property: &Property,
        trail: &FieldPath<'_>,
    ) -> Result<Value, VariableFault> {
        let subsystem = self.subsystem;
        self.budget.take(1, 256, "")?;
        match property.content {
            Content::Cell(cell) => {
                let value = subsystem
                    .values
                    .get(cell)
                    .ok_or_else(|| super::damaged("a property has no value"))?;
                self.copy(value, trail)
            }
            Content::Name(name) => Ok(Value::text(
                subsystem.directory.name(name).unwrap_or_default(),
            )),
            Content::Number(number) => Ok(Value::Array(Array {
                shape: vec![1, 1],
                kind: if number <= 1 {
                    ElementKind::Logical
                } else {
                    ElementKind::Integer
                },
                re: vec![f64::from(number)],
                im: None,
            })),
        }
    }

    /// Copies the value of a cell, with references replaced by their objects.
    pub(super) fn copy(
        &mut self,
        value: &Value,
        trail: &FieldPath<'_>,
    ) -> Result<Value, VariableFault> {
        self.budget.take(1, value.own_memory(), "")?;
        if let Some(reference) = self.reference(value) {
            return self.referred(&reference, trail);
        }
        Ok(match value {
            Value::Array(_) | Value::Text(_) | Value::Opaque { .. } => value.clone(),
            Value::Cell(cell) => Value::Cell(CellArray {
                shape: cell.shape.clone(),
                values: self.cells(cell, trail)?,
            }),
            Value::Struct(records) if is_enumeration(records) => {
                self.subsystem
                    .enumeration(records, "", trail, self.budget)?
            }
            Value::Struct(records) => Value::Struct(self.copied(records, trail)?),
            Value::Object(object) => Value::Object(Object {
                class: object.class.clone(),
                records: self.copied(&object.records, trail)?,
            }),
        })
    }

    fn cells(
        &mut self,
        cell: &CellArray,
        trail: &FieldPath<'_>,
    ) -> Result<Vec<Value>, VariableFault> {
        let values = cell.values.iter().enumerate();
        values
            .map(|(at, value)| self.copy(value, &trail.step(Step::Cell(at))?))
            .collect()
    }

    fn copied(
        &mut self,
        records: &StructArray,
        trail: &FieldPath<'_>,
    ) -> Result<StructArray, VariableFault> {
        let mut fields = Vec::with_capacity(records.fields.len());
        for (name, values) in &records.fields {
            let mut copies = Vec::with_capacity(values.len());
            for (at, value) in values.iter().enumerate() {
                let record = trail.step(Step::Record(at))?;
                let trail = if values.len() == 1 { trail } else { &record };
                copies.push(self.copy(value, &trail.step(Step::Field(name))?)?);
            }
            fields.push((name.clone(), copies));
        }
        Ok(StructArray {
            shape: records.shape.clone(),
            fields,
        })
    }

    /// Returns the reference in a value if its objects exist: numbers may look like a reference by
    /// chance.
    fn reference(&self, value: &Value) -> Option<Reference> {
        let directory = &self.subsystem.directory;
        Reference::of(value).filter(|reference| {
            directory.class(reference.class).is_some()
                && reference
                    .objects
                    .iter()
                    .all(|&object| directory.has_object(object))
        })
    }
}

/// Returns the integers of an array if none can have lost digits.
fn exact_words(array: &Array) -> Option<Vec<u64>> {
    const MOST: f64 = (1_u64 << 53) as f64;
    array
        .re
        .iter()
        .map(|&number| {
            if (0.0..MOST).contains(&number) {
                Some(number as u64)
            } else {
                None
            }
        })
        .collect()
}
