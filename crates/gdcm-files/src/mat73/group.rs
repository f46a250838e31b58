//! Groups: structs, struct arrays, sparse matrices, and what else MATLAB keeps in them.

use hdf5_pure::{Dataset, Group, Object};

use super::dataset::{Elements, Order};
use super::fault::{damaged, fault};
use super::marks::{Decode, MatlabAttributes};
use super::reader::{Reader, is_reference, unread};
use super::sparse::Sparse;
use crate::variables::{self, MemoryBudget, StructArray, Value, VariableFault};

/// What the library keeps for each member of a group while it is read \[bytes\].
const MEMBER: u64 = 256;

/// The datasets and groups in a group, in the order of their names.
pub(super) fn members(
    group: &Group,
    path: &str,
    meter: &MemoryBudget<'_>,
) -> Result<Vec<(String, Object)>, VariableFault> {
    let failed = |error| fault(&error, path);
    let datasets = group.iter_datasets().map_err(failed)?;
    let groups = group.iter_groups().map_err(failed)?;
    meter.take((datasets.len() + groups.len()) as u64, MEMBER, path)?;
    let datasets = datasets.map(|(name, dataset)| (name, Object::Dataset(Box::new(dataset))));
    let mut members: Vec<_> = datasets.chain(groups.map(|(name, group)| (name, Object::Group(group)))).collect();
    members.sort_by(|(one, _), (other, _)| one.cmp(other));
    match members.windows(2).find(|pair| pair[0].0 == pair[1].0) {
        Some(pair) => Err(VariableFault::Duplicate { name: within(path, &pair[0].0) }),
        None => Ok(members),
    }
}

/// The value of a group.
pub(super) fn value(reader: &Reader<'_>, group: &Group, path: &str, depth: usize) -> Result<Value, VariableFault> {
    let marks = MatlabAttributes::new(&group.attrs().map_err(|error| fault(&error, path))?);
    let mut members = members(group, path, reader.meter)?;
    if let Some(rows) = marks.sparse {
        let sparse = Sparse { rows, marks: &marks, members: &members, path, meter: reader.meter };
        return Ok(Value::Array(sparse.filled()?));
    }
    match (marks.decode, marks.class()) {
        (Decode::FunctionHandle, _) | (_, "function_handle") => {
            return Ok(unread("function_handle", "functions are not data"));
        }
        (Decode::Object, class) => return Ok(unread(class, "enumerations are not read")),
        _ => {}
    }
    // MATLAB says the order of fields only where it is not that of the names.
    let order = |name: &str| marks.fields.iter().position(|field| field == name).unwrap_or(usize::MAX);
    members.sort_by_cached_key(|(name, _)| order(name));
    let records = if is_array(&marks, &members, path)? {
        array(reader, &members, path, depth)?
    } else {
        let mut fields = Vec::with_capacity(members.len());
        for (name, object) in members {
            let value = reader.value(&object, &within(path, &name), depth + 1)?;
            fields.push((name, vec![value]));
        }
        StructArray { shape: vec![1, 1], fields }
    };
    Ok(match marks.decode {
        Decode::OldObject => Value::Object(variables::Object { class: marks.class().to_owned(), records }),
        _ => Value::Struct(records),
    })
}

/// Whether a struct has several records: its fields are references that are not marked as cells.
fn is_array(marks: &MatlabAttributes, members: &[(String, Object)], path: &str) -> Result<bool, VariableFault> {
    if marks.class.is_none() || members.is_empty() {
        return Ok(false);
    }
    for (_, object) in members {
        let Object::Dataset(dataset) = object else { return Ok(false) };
        let failed = |error| fault(&error, path);
        let marked = MatlabAttributes::new(&dataset.attrs().map_err(failed)?).class.is_some();
        if marked || !is_reference(&dataset.datatype().map_err(failed)?) {
            return Ok(false);
        }
    }
    Ok(true)
}

fn array(
    reader: &Reader<'_>,
    members: &[(String, Object)],
    path: &str,
    depth: usize,
) -> Result<StructArray, VariableFault> {
    let mut records = StructArray { shape: Vec::new(), fields: Vec::with_capacity(members.len()) };
    for (name, object) in members {
        let Object::Dataset(dataset) = object else { continue };
        let shape = Elements::read(dataset, Order::Columns, path, reader.meter)?.shape;
        if !records.fields.is_empty() && records.shape != shape {
            return Err(damaged(&within(path, name), "a field has not as many values as there are records"));
        }
        records.shape = shape;
        records.fields.push((name.clone(), values(reader, dataset, (path, name), depth)?));
    }
    Ok(records)
}

/// The values of one field, one for each record.
fn values(
    reader: &Reader<'_>,
    dataset: &Dataset,
    (path, name): (&str, &str),
    depth: usize,
) -> Result<Vec<Value>, VariableFault> {
    let objects = reader.referred(dataset, path)?;
    let value = |(index, object)| reader.value(object, &format!("{path}({}).{name}", index + 1), depth + 1);
    objects.iter().enumerate().map(value).collect()
}

fn within(path: &str, name: &str) -> String {
    if path.is_empty() { name.to_owned() } else { format!("{path}.{name}") }
}
