//! Values as datasets and groups hold them, one within another.

use hdf5_pure::{Dataset, Datatype, Group, Object, ReferenceType};

use super::dataset::{Elements, Order};
use super::empty::empty;
use super::fault::fault;
use super::marks::{Decode, MatlabAttributes};
use super::objects::Objects;
use super::{compound, group, text};
use crate::variables::{CellArray, ElementKind, MemoryBudget, Value, Variable, VariableFault};

/// How many values may lie in one another.
const DEEPEST: usize = 64;
/// What a value takes besides its elements while it is read: the library's view of its header, and the value itself \[bytes\].
const HEADER: u64 = 1024;

/// Reads values within the limits of a meter.
pub(super) struct Reader<'r> {
    pub(super) meter: &'r MemoryBudget<'r>,
    pub(super) objects: &'r Objects<'r>,
}

impl Reader<'_> {
    /// The variables that lie in the outermost group.
    pub(super) fn variables(&self, root: &Group) -> Result<Vec<Variable>, VariableFault> {
        let mut variables = Vec::new();
        for (name, object) in group::members(root, "", self.meter)? {
            // What other variables refer to.
            if name != "#refs#" && name != "#subsystem#" {
                let value = self.value(&object, &name, 0)?;
                variables.push(Variable { name, value });
            }
        }
        Ok(variables)
    }

    /// The value of a dataset or group; `path` is what faults call it.
    pub(super) fn value(&self, object: &Object, path: &str, depth: usize) -> Result<Value, VariableFault> {
        if depth >= DEEPEST {
            return Err(VariableFault::TooDeep { variable: path.to_owned() });
        }
        self.meter.take(1, HEADER, path)?;
        let value = match object {
            Object::Dataset(dataset) => self.dataset(dataset, path, depth),
            Object::Group(group) => group::value(self, group, path, depth),
            _ => Ok(unread("an HDF5 object", "it is neither a dataset nor a group")),
        };
        match value {
            // The other variables can be read all the same.
            Err(VariableFault::Unsupported { what, remedy, .. }) => Ok(unread(&what, &remedy)),
            value => value,
        }
    }

    fn dataset(&self, dataset: &Dataset, path: &str, depth: usize) -> Result<Value, VariableFault> {
        let marks = MatlabAttributes::new(&dataset.attrs().map_err(|error| fault(&error, path))?);
        let order = if marks.class.is_some() { Order::Columns } else { Order::Rows };
        let elements = Elements::read(dataset, order, path, self.meter)?;
        if marks.empty {
            return empty(&marks, &elements, path, self.meter);
        }
        if marks.decode == Decode::FunctionHandle {
            return Ok(unread("function_handle", "functions are not data"));
        }
        if is_reference(&elements.datatype) {
            return self.cell(dataset, &elements, path, depth);
        }
        if let Some(mut array) = elements.numbers(path, self.meter)? {
            return match (marks.decode, marks.class()) {
                (Decode::Object, class) => self.objects.value(class, array, path, self.meter),
                (_, "char") => Ok(Value::Text(text::rows(&array, path, self.meter)?)),
                (_, "logical") => {
                    array.kind = ElementKind::Logical;
                    Ok(Value::Array(array))
                }
                _ => Ok(Value::Array(array)),
            };
        }
        if let Some(texts) = text::strings(dataset, &elements, path, self.meter)? {
            return Ok(Value::Text(texts));
        }
        let records = compound::records(&elements, path, self.meter)?;
        Ok(records.map_or_else(|| unread("an HDF5 dataset", "it holds neither numbers nor texts"), Value::Struct))
    }

    /// A cell for each reference.
    fn cell(&self, dataset: &Dataset, elements: &Elements, path: &str, depth: usize) -> Result<Value, VariableFault> {
        let objects = self.referred(dataset, path)?;
        let mut values = Vec::with_capacity(objects.len());
        for (index, place) in elements.places().enumerate() {
            if let Some(object) = objects.get(place) {
                values.push(self.value(object, &format!("{path}{{{}}}", index + 1), depth + 1)?);
            }
        }
        Ok(Value::Cell(CellArray { shape: elements.shape.clone(), values }))
    }

    /// What the references of a dataset lead to, in the order of the file.
    pub(super) fn referred(&self, dataset: &Dataset, path: &str) -> Result<Vec<Object>, VariableFault> {
        let failed = |error| fault(&error, path);
        let elements = dataset.shape().map_err(failed)?.iter().copied().fold(1, u64::saturating_mul);
        self.meter.take(elements, HEADER, path)?;
        dataset.dereference().map_err(failed)
    }
}

/// Whether the elements of a dataset are other datasets and groups.
pub(super) fn is_reference(datatype: &Datatype) -> bool {
    matches!(datatype, Datatype::Reference { ref_type: ReferenceType::Object, .. })
}

pub(super) fn unread(class: &str, why: &str) -> Value {
    Value::Opaque { class: class.to_owned(), why: why.to_owned() }
}
