//! Values of datasets and groups, which may contain further values.
//!
//! MATLAB's attributes (`attributes.rs`) and the element type decide what a dataset or a group
//! represents:
//!
//! ```text
//! dataset of numbers      numbers, characters, logical values, or a reference to an object
//! dataset of references   cell array; each reference points to a value
//! dataset, marked empty   empty value; the elements are its dimensions
//! group                   struct, whose members are its fields; or an old-style object
//! group of datasets of references that have no class
//!                         struct array; each member holds a field, with a reference per record
//! group, marked sparse    sparse matrix
//! ```
//!
//! Anything else becomes an opaque value ([`Value::Opaque`]) with the reason. Three kinds of object
//! occur: an [`Object`] is a dataset or a group, [`Objects`] are those of MATLAB's `classdef`
//! classes, and [`variables::Object`] is an object as a value.

use hdf5_pure::{Dataset, Group, Object};

use crate::formats::mat73::attributes::{FOLDER_OBJECT, FUNCTION_HANDLE, MatlabAttributes, OBJECT};
use crate::formats::mat73::compound_records::compound_records;
use crate::formats::mat73::dataset::{Elements, Order, is_object_reference};
use crate::formats::mat73::empty_value::empty_value;
use crate::formats::mat73::library_fault::{damaged, library_fault};
use crate::formats::mat73::member::Member;
use crate::formats::mat73::object_references::Objects;
use crate::formats::mat73::sparse_group::SparseGroup;
use crate::formats::mat73::strings::{character_rows, strings};
use crate::formats::variables::{
    self, Array, CellArray, ElementKind, StructArray, Value, Variable,
};
use crate::reading_budget::{ReadingBudget, VariableFault};
use crate::variable_fault::damage::Damage;
use crate::variable_fault::unread::Unread;

/// Maximum nesting depth of values.
const DEEPEST: usize = 64;
/// Nesting depth of a variable, and of a cell in the object part.
pub(super) const OUTERMOST: usize = 0;
/// Memory for a value without its elements while it is read \[bytes\]: the value, and the library's
/// data about it.
const VALUE_MEMORY: u64 = 1024;
/// Memory that the library needs for each group member \[bytes\].
const MEMBER_MEMORY: u64 = 256;

/// Reads values within a budget.
///
/// In the methods, `path` is the value's name in errors, such as "sys.A", and `depth` its nesting
/// depth.
pub(super) struct Reader<'r> {
    pub(super) budget: &'r ReadingBudget<'r>,
    pub(super) objects: &'r Objects,
}

impl Reader<'_> {
    /// Reads the variables in the root group.
    pub(super) fn variables(&self, root: &Group) -> Result<Vec<Variable>, VariableFault> {
        let mut variables = Vec::new();
        for Member { name, object } in self.members(root, "")? {
            // Skip the groups that hold other variables' contents.
            if name != "#refs#" && name != "#subsystem#" {
                let value = self.value(&object, &name, OUTERMOST)?;
                variables.push(Variable { name, value });
            }
        }
        Ok(variables)
    }

    /// Reads a dataset or a group. An unsupported dataset or group becomes an opaque value.
    pub(super) fn value(
        &self,
        object: &Object,
        path: &str,
        depth: usize,
    ) -> Result<Value, VariableFault> {
        if depth >= DEEPEST {
            return Err(VariableFault::too_deep(path));
        }
        self.budget.take(1, VALUE_MEMORY, path)?;
        let value = match object {
            Object::Dataset(dataset) => self.dataset_value(dataset, path, depth),
            Object::Group(group) => self.group_value(group, path, depth),
            _ => Ok(Value::opaque(
                "an HDF5 object",
                Unread::NeitherDatasetNorGroup,
            )),
        };
        match value {
            // An unsupported value must not prevent reading the other variables.
            Err(VariableFault::Unsupported { content, .. }) => Ok(Value::opaque(
                content.to_string(),
                Unread::Unsupported(content),
            )),
            value => value,
        }
    }

    /// Reads a dataset; its elements are in row-major order unless it has a MATLAB class. The first
    /// that applies: empty value; function handle (opaque); references (cell array); numbers;
    /// strings; compound elements (struct array); anything else is opaque.
    fn dataset_value(
        &self,
        dataset: &Dataset,
        path: &str,
        depth: usize,
    ) -> Result<Value, VariableFault> {
        let attributes = MatlabAttributes::read(dataset.attrs(), path)?;
        let order = if attributes.class.is_some() {
            Order::Columns
        } else {
            Order::Rows
        };
        let elements = Elements::read(dataset, order, path, self.budget)?;
        if attributes.is_empty {
            return empty_value(&attributes, &elements, path, self.budget);
        }
        if attributes.encoding == FUNCTION_HANDLE {
            return Ok(function_handle());
        }
        if is_object_reference(&elements.datatype) {
            return self.cell(dataset, &elements, path, depth);
        }
        if let Some(array) = elements.numbers(path, self.budget)? {
            return self.number_value(array, &attributes, path);
        }
        if let Some(texts) = strings(dataset, &elements, path, self.budget)? {
            return Ok(Value::Text(texts));
        }
        match compound_records(&elements, path, self.budget)? {
            Some(records) => Ok(Value::Struct(records)),
            None => Ok(Value::opaque(
                "an HDF5 dataset",
                Unread::NeitherNumbersNorStrings,
            )),
        }
    }

    /// Converts the numbers in a dataset to a value. A reference to an object of a MATLAB class
    /// becomes the object; the class decides between characters, logical values and numbers.
    fn number_value(
        &self,
        mut array: Array,
        attributes: &MatlabAttributes,
        path: &str,
    ) -> Result<Value, VariableFault> {
        let class = attributes.class_name();
        if attributes.encoding == OBJECT {
            return self.objects.value(class, array, path, self.budget);
        }
        match class {
            "char" => Ok(Value::Text(character_rows(&array, path, self.budget)?)),
            "logical" => {
                array.kind = ElementKind::Logical;
                Ok(Value::Array(array))
            }
            _ => Ok(Value::Array(array)),
        }
    }

    /// Reads a cell array, whose elements are references to values.
    fn cell(
        &self,
        dataset: &Dataset,
        elements: &Elements,
        path: &str,
        depth: usize,
    ) -> Result<Value, VariableFault> {
        let objects = self.referenced_objects(dataset, path)?;
        let mut values = Vec::with_capacity(objects.len());
        for (index, place) in elements.places().enumerate() {
            if let Some(object) = objects.get(place) {
                let path = format!("{path}{{{}}}", index + 1);
                values.push(self.value(object, &path, depth + 1)?);
            }
        }
        Ok(Value::Cell(CellArray {
            shape: elements.shape.clone(),
            values,
        }))
    }

    /// Returns the objects to which the references in a dataset point, in file order.
    pub(super) fn referenced_objects(
        &self,
        dataset: &Dataset,
        path: &str,
    ) -> Result<Vec<Object>, VariableFault> {
        let sides = dataset
            .shape()
            .map_err(|error| library_fault(&error, path))?;
        let count = sides.iter().copied().fold(1, u64::saturating_mul);
        self.budget.take(count, VALUE_MEMORY, path)?;
        dataset
            .dereference()
            .map_err(|error| library_fault(&error, path))
    }

    /// Reads a group. The first that applies: sparse matrix; function handle or enumeration
    /// (opaque); struct array or struct, which may be an object of an old-style (`@` folder) class.
    fn group_value(&self, group: &Group, path: &str, depth: usize) -> Result<Value, VariableFault> {
        let attributes = MatlabAttributes::read(group.attrs(), path)?;
        let members = self.members(group, path)?;
        let class = attributes.class_name();
        if let Some(height) = attributes.sparse_height {
            let sparse = SparseGroup {
                height,
                is_logical: class == "logical",
                members: &members,
                path,
                budget: self.budget,
            };
            return Ok(Value::Array(sparse.full_matrix()?));
        }
        if attributes.encoding == FUNCTION_HANDLE || class == "function_handle" {
            return Ok(function_handle());
        }
        if attributes.encoding == OBJECT {
            return Ok(Value::opaque(class, Unread::Enumeration));
        }
        let members = self.in_field_order(members, &attributes.fields, path)?;
        let records = if is_struct_array(&attributes, &members, path)? {
            self.struct_array(&members, path, depth)?
        } else {
            self.scalar_struct(members, attributes.is_empty, path, depth)?
        };
        if attributes.encoding == FOLDER_OBJECT {
            return Ok(Value::Object(variables::Object {
                class: class.to_owned(),
                records,
            }));
        }
        Ok(Value::Struct(records))
    }

    /// Returns the datasets and groups in a group, sorted by name; a duplicate name is an error.
    fn members(&self, group: &Group, path: &str) -> Result<Vec<Member>, VariableFault> {
        let datasets = group
            .iter_datasets()
            .map_err(|error| library_fault(&error, path))?;
        let groups = group
            .iter_groups()
            .map_err(|error| library_fault(&error, path))?;
        let count = (datasets.len() + groups.len()) as u64;
        self.budget.take(count, MEMBER_MEMORY, path)?;
        let mut members = Vec::new();
        for (name, dataset) in datasets {
            let object = Object::Dataset(Box::new(dataset));
            members.push(Member { name, object });
        }
        for (name, group) in groups {
            let object = Object::Group(group);
            members.push(Member { name, object });
        }
        members.sort_by(|a, b| a.name.cmp(&b.name));
        match members.windows(2).find(|pair| pair[0].name == pair[1].name) {
            Some(pair) => Err(VariableFault::Duplicate {
                name: field_path(path, &pair[0].name),
            }),
            None => Ok(members),
        }
    }

    /// Sorts members by the stored field order; members that are not listed follow. MATLAB stores
    /// this order only if it differs from the order by name.
    fn in_field_order(
        &self,
        mut members: Vec<Member>,
        fields: &[String],
        path: &str,
    ) -> Result<Vec<Member>, VariableFault> {
        let comparisons = (members.len() as u64).saturating_mul(fields.len() as u64);
        self.budget.work(comparisons, path)?;
        members.sort_by_cached_key(|member| {
            fields
                .iter()
                .position(|field| *field == member.name)
                .unwrap_or(usize::MAX)
        });
        Ok(members)
    }

    /// Reads a struct with a single record, whose fields are the members. `holds_shapes`: the group
    /// is marked by Octave as containing empty arrays.
    fn scalar_struct(
        &self,
        members: Vec<Member>,
        holds_shapes: bool,
        path: &str,
        depth: usize,
    ) -> Result<StructArray, VariableFault> {
        let mut fields = Vec::with_capacity(members.len());
        for Member { name, object } in members {
            let mut value = self.value(&object, &field_path(path, &name), depth + 1)?;
            if holds_shapes {
                restore_octave_empty(&mut value);
            }
            fields.push((name, vec![value]));
        }
        Ok(StructArray::one(fields))
    }

    /// Reads a struct array. Each member is a dataset with references to a field's values.
    fn struct_array(
        &self,
        members: &[Member],
        path: &str,
        depth: usize,
    ) -> Result<StructArray, VariableFault> {
        let mut records = StructArray {
            shape: Vec::new(),
            fields: Vec::with_capacity(members.len()),
        };
        for Member { name, object } in members {
            let Object::Dataset(dataset) = object else {
                continue;
            };
            let shape = Elements::read(dataset, Order::Columns, path, self.budget)?.shape;
            if !records.fields.is_empty() && records.shape != shape {
                return Err(damaged(&field_path(path, name), Damage::FieldLength));
            }
            records.shape = shape;
            let mut values = Vec::new();
            for (index, object) in self.referenced_objects(dataset, path)?.iter().enumerate() {
                let path = format!("{path}({}).{name}", index + 1);
                values.push(self.value(object, &path, depth + 1)?);
            }
            records.fields.push((name.clone(), values));
        }
        Ok(records)
    }
}

fn function_handle() -> Value {
    Value::opaque("function_handle", Unread::Function)
}

/// Returns whether a group is a struct array: it has a MATLAB class, and members that are all
/// datasets of references without a class, unlike cell arrays.
fn is_struct_array(
    attributes: &MatlabAttributes,
    members: &[Member],
    path: &str,
) -> Result<bool, VariableFault> {
    if attributes.class.is_none() || members.is_empty() {
        return Ok(false);
    }
    for member in members {
        let Object::Dataset(dataset) = &member.object else {
            return Ok(false);
        };
        if MatlabAttributes::read(dataset.attrs(), path)?
            .class
            .is_some()
        {
            return Ok(false);
        }
        let datatype = dataset
            .datatype()
            .map_err(|error| library_fault(&error, path))?;
        if !is_object_reference(&datatype) {
            return Ok(false);
        }
    }
    Ok(true)
}

/// Replaces an array that lists dimensions, one of them zero, by an empty array with this shape.
/// For an empty array, Octave stores the dimensions instead of the elements, and marks the group
/// that contains it.
fn restore_octave_empty(value: &mut Value) {
    if let Value::Array(sides) = value
        && sides.re.contains(&0.0)
    {
        *sides = Array {
            shape: sides.re.iter().rev().map(|side| *side as usize).collect(),
            ..Array::matrix(0, 0, Vec::new())
        };
    }
}

/// Returns the path to a field, or to a variable in the root group.
fn field_path(path: &str, name: &str) -> String {
    if path.is_empty() {
        name.to_owned()
    } else {
        format!("{path}.{name}")
    }
}
