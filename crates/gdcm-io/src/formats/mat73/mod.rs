//! MATLAB 7.3 files, and plain HDF5 files such as those written by h5py.
//!
//! The container follows the HDF5 File Format Specification 3.0. MATLAB's use of it is not
//! published by The MathWorks; it is known from its files and from the descriptions of the matio,
//! hdf5storage and MAT.jl projects: attributes give the classes, arrays are stored by columns, with
//! their shapes reversed, and the elements of cells and struct arrays are references into a group
//! `#refs#`.
//!
//! Arrays without MATLAB's attributes are stored by rows, as in C and Python: a dataset of r x c
//! elements becomes an r x c array, a scalar 1 x 1, n elements without a second dimension the row 1
//! x n. (MATLAB's own `h5write` writes such datasets from its columns; they are read transposed.)
//! Groups become structs. Members of groups are sorted by name, unless MATLAB gives an order;
//! symbolic links, including links to other files, are skipped.

mod dataset;
mod values;

use std::collections::HashMap;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};

use hdf5_pure::{
    AttrValue, Dataset, Datatype, Error, File, FileAccessProperties, FormatError, Group,
    MetadataCacheConfig, Object, ReferenceType, Source, is_hdf5_bytes,
};

use super::variables::{self, Array, CellArray, ElementKind, StructArray, Value, Variable};
use crate::formats::mat::is_hdf5;
use crate::formats::mat73::dataset::{Elements, Order};
use crate::formats::mat73::values::{Objects, empty, records, rows, sparse, strings};
use crate::formats::{Contents, Importer, octave};
use crate::reading_budget::{ReadingBudget, VariableFault};

/// MATLAB 7.3 and HDF5.
pub(crate) const HDF5: Importer = Importer {
    name: "an HDF5 file, as MATLAB writes with -v7.3",
    endings: &["mat", "h5", "hdf5"],
    recognises: |bytes, _| is_hdf5(bytes),
    read: |bytes, path, budget| {
        let read = open(bytes, budget).and_then(|file| {
            let objects = Objects::read(&file, budget)?;
            Reader {
                budget,
                objects: &objects,
            }
            .variables(&file.root())
        });
        // The library reports a stop as an unreadable file.
        Contents::variables(
            budget
                .work(0, "")
                .and(read)
                .and_then(|variables| octave::unwrapped(variables, budget)),
            path,
        )
    },
};

// Values in datasets and groups, including nested values.

/// Deepest nesting of values.
const DEEPEST: usize = 64;
/// Memory of a value during reading, without its elements: the library's view of its header, and
/// the value itself \[bytes\].
const HEADER: u64 = 1024;

/// Reads values within a budget.
struct Reader<'r> {
    budget: &'r ReadingBudget<'r>,
    objects: &'r Objects,
}

impl Reader<'_> {
    /// Reads the variables in the root group.
    fn variables(&self, root: &Group) -> Result<Vec<Variable>, VariableFault> {
        let mut variables = Vec::new();
        for (name, object) in members(root, "", self.budget)? {
            // Contents referenced by other variables.
            if name != "#refs#" && name != "#subsystem#" {
                let value = self.value(&object, &name, 0)?;
                variables.push(Variable { name, value });
            }
        }
        Ok(variables)
    }

    /// Reads the value of a dataset or group; `path` is its name in faults.
    fn value(&self, object: &Object, path: &str, depth: usize) -> Result<Value, VariableFault> {
        if depth >= DEEPEST {
            return Err(VariableFault::too_deep(path));
        }
        self.budget.take(1, HEADER, path)?;
        let value = match object {
            Object::Dataset(dataset) => self.dataset(dataset, path, depth),
            Object::Group(group) => group_value(self, group, path, depth),
            _ => Ok(Value::opaque(
                "an HDF5 object",
                "it is neither a dataset nor a group",
            )),
        };
        match value {
            // The other variables remain readable.
            Err(VariableFault::Unsupported { what, remedy, .. }) => Ok(Value::opaque(what, remedy)),
            value => value,
        }
    }

    fn dataset(&self, dataset: &Dataset, path: &str, depth: usize) -> Result<Value, VariableFault> {
        let marks = MatlabAttributes::of(dataset.attrs(), path)?;
        let order = if marks.class.is_some() {
            Order::Columns
        } else {
            Order::Rows
        };
        let elements = Elements::read(dataset, order, path, self.budget)?;
        if marks.empty {
            return empty(&marks, &elements, path, self.budget);
        }
        if marks.decode == FUNCTION_HANDLE {
            return Ok(Value::opaque("function_handle", "functions are not data"));
        }
        if is_reference(&elements.datatype) {
            return self.cell(dataset, &elements, path, depth);
        }
        if let Some(mut array) = elements.numbers(path, self.budget)? {
            return match (marks.decode, marks.class()) {
                (OBJECT, class) => self.objects.value(class, array, path, self.budget),
                (_, "char") => Ok(Value::Text(rows(&array, path, self.budget)?)),
                (_, "logical") => {
                    array.kind = ElementKind::Logical;
                    Ok(Value::Array(array))
                }
                _ => Ok(Value::Array(array)),
            };
        }
        if let Some(texts) = strings(dataset, &elements, path, self.budget)? {
            return Ok(Value::Text(texts));
        }
        let records = records(&elements, path, self.budget)?;
        Ok(records.map_or_else(
            || Value::opaque("an HDF5 dataset", "it holds neither numbers nor texts"),
            Value::Struct,
        ))
    }

    /// Reads a cell for each reference.
    fn cell(
        &self,
        dataset: &Dataset,
        elements: &Elements,
        path: &str,
        depth: usize,
    ) -> Result<Value, VariableFault> {
        let objects = self.referred(dataset, path)?;
        let mut values = Vec::with_capacity(objects.len());
        for (index, place) in elements.places().enumerate() {
            if let Some(object) = objects.get(place) {
                values.push(self.value(object, &format!("{path}{{{}}}", index + 1), depth + 1)?);
            }
        }
        Ok(Value::Cell(CellArray {
            shape: elements.shape.clone(),
            values,
        }))
    }

    /// Resolves the references of a dataset, in file order.
    fn referred(&self, dataset: &Dataset, path: &str) -> Result<Vec<Object>, VariableFault> {
        let failed = |error| fault(&error, path);
        let elements = dataset
            .shape()
            .map_err(failed)?
            .iter()
            .copied()
            .fold(1, u64::saturating_mul);
        self.budget.take(elements, HEADER, path)?;
        dataset.dereference().map_err(failed)
    }
}

/// Whether the elements of a dataset are references to datasets and groups.
fn is_reference(datatype: &Datatype) -> bool {
    matches!(
        datatype,
        Datatype::Reference {
            ref_type: ReferenceType::Object,
            ..
        }
    )
}

/// Opens a copy of the file and checks that it is complete; a user block such as MATLAB's may
/// precede it.
fn open(bytes: &[u8], budget: &ReadingBudget<'_>) -> Result<File, VariableFault> {
    if !is_hdf5_bytes(bytes) {
        return Err(VariableFault::other_bytes(
            "a file of MATLAB 7.3 or HDF5",
            bytes,
        ));
    }
    budget.take(bytes.len() as u64, 1, "")?;
    // Reads from a cache would not be counted.
    let properties =
        FileAccessProperties::new().with_metadata_cache(MetadataCacheConfig::disabled());
    let source = Rationed::new(bytes.to_vec(), Arc::clone(budget.stop()));
    let file =
        File::from_source_with_options(source, properties).map_err(|error| fault(&error, ""))?;
    // Chunks may be missing at the end without any structure extending beyond it.
    if file.superblock().eof_address > bytes.len() as u64 {
        return Err(VariableFault::cut_off("", bytes.len()));
    }
    Ok(file)
}

// Errors of the HDF5 library in the words of this program.

/// Converts an error of the library to a fault; `path` is the variable.
///
/// The library does not report the position of the error in the file.
fn fault(error: &Error, path: &str) -> VariableFault {
    match error {
        Error::Format(FormatError::NestingDepthExceeded) => VariableFault::too_deep(path),
        Error::Format(FormatError::UnexpectedEof { .. }) => {
            damaged(path, "something lies beyond the end of the file")
        }
        Error::Format(
            FormatError::UnsupportedFilter(_)
            | FormatError::UnsupportedVirtualLayout
            | FormatError::UnsupportedExternalStorage
            | FormatError::UnsupportedMessage(_)
            | FormatError::UnsupportedFilteredHeapObject
            | FormatError::UnsupportedVersion(_)
            | FormatError::InvalidLayoutVersion(_)
            | FormatError::UnsupportedZfp(_),
        ) => {
            // HDF5 2.0 uses a new chunk layout if its latest format is requested.
            let remedy = "write it with compression gzip or none, in one file, in the format of HDF5 1.14 or earlier";
            VariableFault::unsupported(path, format!("a dataset of this kind ({error})"), remedy)
        }
        _ => damaged(path, &error.to_string()),
    }
}

/// Returns the fault for bytes that contradict the format.
fn damaged(path: &str, what: &str) -> VariableFault {
    VariableFault::damaged(path, what, 0)
}

// File bytes with a limited amount of reading.

/// Number of times a file may be read: headers and indices are read several times, once for each
/// query.
const TIMES: u64 = 16;
/// Additional amount that may be read from a small file \[bytes\].
const BESIDES: u64 = 16 << 20;
/// Smallest charge for a read \[bytes\].
const LEAST: u64 = 16;

/// Bytes in memory with a limited amount of reading.
///
/// The nodes of an index may refer to one another so that a file of a few kilobytes has more paths
/// than can ever be visited; the library follows them all. The limit ends such reading.
struct Rationed {
    bytes: Vec<u8>,
    left: AtomicU64,
    stop: Arc<AtomicBool>,
}

impl Rationed {
    fn new(bytes: Vec<u8>, stop: Arc<AtomicBool>) -> Self {
        let left = AtomicU64::new(
            (bytes.len() as u64)
                .saturating_mul(TIMES)
                .saturating_add(BESIDES),
        );
        Self { bytes, left, stop }
    }
}

impl Source for Rationed {
    fn len(&self) -> u64 {
        self.bytes.len() as u64
    }

    fn read_at(&self, offset: u64, buffer: &mut [u8]) -> Result<(), FormatError> {
        let cost = (buffer.len() as u64).max(LEAST);
        let paid = self
            .left
            .fetch_update(Ordering::Relaxed, Ordering::Relaxed, |left| {
                left.checked_sub(cost)
            });
        if self.stop.load(Ordering::Relaxed) {
            return Err(FormatError::Source("stopped".to_owned()));
        }
        if paid.is_err() {
            return Err(FormatError::Source(
                "its parts lead to one another too often".to_owned(),
            ));
        }
        let start = usize::try_from(offset).unwrap_or(usize::MAX);
        let found = self.bytes.get(start..start.saturating_add(buffer.len()));
        let end = FormatError::UnexpectedEof {
            expected: start.saturating_add(buffer.len()),
            available: self.bytes.len(),
        };
        buffer.copy_from_slice(found.ok_or(end)?);
        Ok(())
    }
}

// MATLAB's attributes of groups and datasets.

/// `MATLAB_object_decode` of a function handle.
const FUNCTION_HANDLE: u64 = 1;
/// `MATLAB_object_decode` of an object of an `@`-folder class, stored as a struct.
const OLD_OBJECT: u64 = 2;
/// `MATLAB_object_decode` of a `classdef` object, stored as a reference.
const OBJECT: u64 = 3;

/// MATLAB's attributes of a group or dataset.
#[derive(Clone, Debug, PartialEq)]
struct MatlabAttributes {
    /// Class name (`MATLAB_class`); `None` for objects not written by MATLAB.
    class: Option<String>,
    /// The dataset holds the shape of an empty array (`MATLAB_empty`, `OCTAVE_EMPTY_MATRIX`).
    empty: bool,
    /// Number of rows of a sparse matrix (`MATLAB_sparse`).
    sparse: Option<u64>,
    /// Field names of a struct in order (`MATLAB_fields`).
    fields: Vec<String>,
    /// Encoding of the value (`MATLAB_object_decode`); 0 for a plain value.
    decode: u64,
}

impl MatlabAttributes {
    fn of(
        attributes: Result<HashMap<String, AttrValue>, Error>,
        path: &str,
    ) -> Result<Self, VariableFault> {
        let attributes = attributes.map_err(|error| fault(&error, path))?;
        let number = |name| attributes.get(name).and_then(AttrValue::as_u64);
        let class = attributes.get("MATLAB_class").and_then(AttrValue::as_str);
        let fields = attributes
            .get("MATLAB_fields")
            .and_then(AttrValue::as_strings);
        Ok(Self {
            class: class.map(str::to_owned),
            empty: number("MATLAB_empty").is_some_and(|empty| empty != 0)
                || attributes.contains_key("OCTAVE_EMPTY_MATRIX"),
            sparse: number("MATLAB_sparse"),
            fields: fields.unwrap_or_default().to_vec(),
            decode: number("MATLAB_object_decode").unwrap_or(0),
        })
    }

    /// Returns the class, or an empty text.
    fn class(&self) -> &str {
        self.class.as_deref().unwrap_or_default()
    }
}

// Groups: structs, struct arrays, sparse matrices and other values.

/// Memory of the library for each member of a group during reading \[bytes\].
const MEMBER: u64 = 256;

/// Returns the datasets and groups in a group, sorted by name.
fn members(
    group: &Group,
    path: &str,
    budget: &ReadingBudget<'_>,
) -> Result<Vec<(String, Object)>, VariableFault> {
    let failed = |error| fault(&error, path);
    let datasets = group.iter_datasets().map_err(failed)?;
    let groups = group.iter_groups().map_err(failed)?;
    budget.take((datasets.len() + groups.len()) as u64, MEMBER, path)?;
    let datasets = datasets.map(|(name, dataset)| (name, Object::Dataset(Box::new(dataset))));
    let mut members: Vec<_> = datasets
        .chain(groups.map(|(name, group)| (name, Object::Group(group))))
        .collect();
    members.sort_by(|(one, _), (other, _)| one.cmp(other));
    match members.windows(2).find(|pair| pair[0].0 == pair[1].0) {
        Some(pair) => Err(VariableFault::Duplicate {
            name: within(path, &pair[0].0),
        }),
        None => Ok(members),
    }
}

/// Octave stores the sides of an empty array in its place and marks this at the group that contains
/// it.
fn without_elements(value: &mut Value) {
    if let Value::Array(sides) = value
        && sides.re.contains(&0.0)
    {
        *sides = Array {
            shape: sides.re.iter().rev().map(|side| *side as usize).collect(),
            ..Array::matrix(0, 0, vec![])
        };
    }
}

/// Reads the value of a group.
fn group_value(
    reader: &Reader<'_>,
    group: &Group,
    path: &str,
    depth: usize,
) -> Result<Value, VariableFault> {
    let marks = MatlabAttributes::of(group.attrs(), path)?;
    let mut members = members(group, path, reader.budget)?;
    if let Some(rows) = marks.sparse {
        return Ok(Value::Array(sparse(
            rows,
            &marks,
            &members,
            path,
            reader.budget,
        )?));
    }
    match (marks.decode, marks.class()) {
        (FUNCTION_HANDLE, _) | (_, "function_handle") => {
            return Ok(Value::opaque("function_handle", "functions are not data"));
        }
        (OBJECT, class) => return Ok(Value::opaque(class, "enumerations are not read")),
        _ => {}
    }
    // MATLAB stores the field order only if it differs from the name order.
    reader.budget.work(
        (members.len() as u64).saturating_mul(marks.fields.len() as u64),
        path,
    )?;
    let order = |name: &str| {
        marks
            .fields
            .iter()
            .position(|field| field == name)
            .unwrap_or(usize::MAX)
    };
    members.sort_by_cached_key(|(name, _)| order(name));
    let records = if is_array(&marks, &members, path)? {
        array(reader, &members, path, depth)?
    } else {
        let mut fields = Vec::with_capacity(members.len());
        for (name, object) in members {
            let value = reader.value(&object, &within(path, &name), depth + 1)?;
            fields.push((name, vec![value]));
        }
        if marks.empty {
            fields
                .iter_mut()
                .flat_map(|(_, values)| values)
                .for_each(without_elements);
        }
        StructArray::one(fields)
    };
    Ok(match marks.decode {
        OLD_OBJECT => Value::Object(variables::Object {
            class: marks.class().to_owned(),
            records,
        }),
        _ => Value::Struct(records),
    })
}

/// Whether a struct has several records: its fields are references not marked as cells.
fn is_array(
    marks: &MatlabAttributes,
    members: &[(String, Object)],
    path: &str,
) -> Result<bool, VariableFault> {
    if marks.class.is_none() || members.is_empty() {
        return Ok(false);
    }
    for (_, object) in members {
        let Object::Dataset(dataset) = object else {
            return Ok(false);
        };
        let marked = MatlabAttributes::of(dataset.attrs(), path)?.class.is_some();
        if marked || !is_reference(&dataset.datatype().map_err(|error| fault(&error, path))?) {
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
    let mut records = StructArray {
        shape: Vec::new(),
        fields: Vec::with_capacity(members.len()),
    };
    for (name, object) in members {
        let Object::Dataset(dataset) = object else {
            continue;
        };
        let shape = Elements::read(dataset, Order::Columns, path, reader.budget)?.shape;
        if !records.fields.is_empty() && records.shape != shape {
            return Err(damaged(
                &within(path, name),
                "a field has not as many values as there are records",
            ));
        }
        records.shape = shape;
        records
            .fields
            .push((name.clone(), values(reader, dataset, (path, name), depth)?));
    }
    Ok(records)
}

/// Reads the values of one field, one for each record.
fn values(
    reader: &Reader<'_>,
    dataset: &Dataset,
    (path, name): (&str, &str),
    depth: usize,
) -> Result<Vec<Value>, VariableFault> {
    let objects = reader.referred(dataset, path)?;
    let value =
        |(index, object)| reader.value(object, &format!("{path}({}).{name}", index + 1), depth + 1);
    objects.iter().enumerate().map(value).collect()
}

fn within(path: &str, name: &str) -> String {
    if path.is_empty() {
        name.to_owned()
    } else {
        format!("{path}.{name}")
    }
}

#[cfg(test)]
mod mat73_tests {
    use std::path::Path;

    use super::*;
    use crate::formats::variables::{Array, CellArray, ElementKind, TextArray, Value};

    /// Reads all variables of a MATLAB 7.3 file or a plain HDF5 file; unreadable objects of
    /// MATLAB's classes are [`Value::Opaque`](crate::formats::variables::Value::Opaque).
    fn read(bytes: &[u8], budget: &ReadingBudget<'_>) -> Result<Vec<Variable>, VariableFault> {
        let objects = Objects::Unread("objects of classes are not read".to_owned());
        Reader {
            budget,
            objects: &objects,
        }
        .variables(&open(bytes, budget)?.root())
    }

    fn file(name: &str) -> Vec<u8> {
        std::fs::read(format!(
            "{}/../../tests/data/mat73/{name}",
            env!("CARGO_MANIFEST_DIR")
        ))
        .unwrap()
    }

    fn read_file(name: &str) -> Result<Vec<Variable>, VariableFault> {
        read(&file(name), &ReadingBudget::new(1 << 24))
    }

    fn value(variables: &[Variable], name: &str) -> Value {
        variables
            .iter()
            .find(|variable| variable.name == name)
            .unwrap_or_else(|| panic!("no {name}"))
            .value
            .clone()
    }

    fn array(variables: &[Variable], name: &str) -> Array {
        let Value::Array(array) = value(variables, name) else {
            panic!("{name} is no array")
        };
        array
    }

    fn texts(shape: &[usize], texts: &[&str]) -> Value {
        Value::Text(TextArray {
            shape: shape.to_vec(),
            texts: texts.iter().map(|&text| text.to_owned()).collect(),
        })
    }

    fn number(value: f64) -> Value {
        Value::Array(Array::matrix(1, 1, vec![value]))
    }

    #[test]
    fn a_matrix_keeps_its_rows_and_columns() {
        for name in ["numbers.mat", "plain.h5", "plain_latest.h5"] {
            let variables = read_file(name).unwrap();
            assert_eq!(
                array(&variables, "A"),
                Array::matrix(2, 3, vec![1.0, 4.0, 2.0, 5.0, 3.0, 6.0]),
                "{name}"
            );
            // numpy.arange(24).reshape(2, 3, 4): element (i, j, k) is 12 i + 4 j + k.
            let cube = array(&variables, "cube");
            assert_eq!(
                (cube.shape.as_slice(), &cube.re[..3], cube.re[6]),
                ([2, 3, 4].as_slice(), [0.0, 12.0, 4.0].as_slice(), 1.0)
            );
            // numpy.arange(600).reshape(20, 30), in chunks that do not divide it.
            let packed = array(&variables, "packed");
            assert_eq!(
                (packed.shape.as_slice(), packed.re[1], packed.re[20]),
                ([20, 30].as_slice(), 30.0, 1.0)
            );
        }
    }

    #[test]
    fn every_class_of_numbers_of_matlab_is_read() {
        let variables = read_file("numbers.mat").unwrap();
        for name in ["int8", "int16", "int32", "int64"] {
            let expected = Array {
                kind: ElementKind::Integer,
                ..Array::matrix(2, 1, vec![-3.0, 100.0])
            };
            assert_eq!(array(&variables, name), expected, "{name}");
        }
        for name in ["uint8", "uint16", "uint32", "uint64"] {
            assert_eq!(array(&variables, name).re, [3.0, 200.0], "{name}");
        }
        assert_eq!(array(&variables, "single").re, [0.5, -0.25]);
        let flags = array(&variables, "flags");
        assert_eq!(
            (flags.kind, flags.shape, flags.re),
            (ElementKind::Logical, vec![1, 3], vec![1.0, 0.0, 1.0])
        );
        let complex = array(&variables, "z");
        assert_eq!(
            (complex.shape, complex.re, complex.im),
            (vec![1, 2], vec![1.0, -3.0], Some(vec![2.0, 0.5]))
        );
        assert_eq!(array(&variables, "none"), Array::matrix(0, 3, Vec::new()));
    }

    #[test]
    fn sparse_matrices_are_filled_up() {
        let variables = read_file("numbers.mat").unwrap();
        let expected = vec![0.0, 0.0, 1.5, 0.0, 0.0, 0.0, -2.0, 0.0, 0.0, 0.0, 0.0, 0.0];
        assert_eq!(array(&variables, "S"), Array::matrix(3, 4, expected));
        let nothing = array(&variables, "S0");
        assert_eq!(
            (nothing.kind, nothing.shape, nothing.re),
            (ElementKind::Logical, vec![2, 2], vec![0.0; 4])
        );
    }

    #[test]
    fn texts_are_the_rows_of_characters() {
        let variables = read_file("nested.mat").unwrap();
        assert_eq!(value(&variables, "name"), texts(&[1, 1], &["theta_dot"]));
        assert_eq!(
            value(&variables, "greek"),
            texts(&[1, 1], &["\u{3b8}\u{1d6fc}"])
        );
        assert_eq!(value(&variables, "rows"), texts(&[2, 1], &["ab ", "cde"]));
        assert_eq!(value(&variables, "nothing"), texts(&[1, 1], &[""]));
    }

    #[test]
    fn structs_keep_the_order_of_their_fields() {
        let variables = read_file("nested.mat").unwrap();
        let Value::Struct(system) = value(&variables, "sys") else {
            panic!("no struct")
        };
        let names: Vec<_> = system
            .fields
            .iter()
            .map(|(name, _)| name.as_str())
            .collect();
        assert_eq!(
            (system.shape.as_slice(), names),
            ([1, 1].as_slice(), vec!["B", "A", "name", "inner"])
        );
        assert_eq!(
            system.field("A").unwrap(),
            [Value::Array(Array::matrix(2, 2, vec![1.0, 3.0, 2.0, 4.0]))]
        );
        let Value::Struct(inner) = &system.field("inner").unwrap()[0] else {
            panic!("no struct")
        };
        assert_eq!(inner.field("x").unwrap(), [number(7.0)]);
    }

    #[test]
    fn struct_arrays_and_cells_are_read_through_their_references() {
        let variables = read_file("nested.mat").unwrap();
        let Value::Struct(models) = value(&variables, "models") else {
            panic!("no struct")
        };
        assert_eq!(models.shape, [1, 3]);
        assert_eq!(
            models.field("gain").unwrap(),
            [number(0.0), number(1.0), number(2.0)]
        );
        assert_eq!(models.field("name").unwrap()[2], texts(&[1, 1], &["w"]));
        let deep = Value::Cell(CellArray {
            shape: vec![1, 1],
            values: vec![texts(&[1, 1], &["deep"])],
        });
        let values = vec![
            number(0.0),
            number(1.0),
            number(2.0),
            number(3.0),
            number(4.0),
            deep,
        ];
        assert_eq!(
            value(&variables, "C"),
            Value::Cell(CellArray {
                shape: vec![2, 3],
                values
            })
        );
        assert_eq!(
            value(&variables, "C0"),
            Value::Cell(CellArray {
                shape: vec![0, 1],
                values: Vec::new()
            })
        );
        assert!(
            matches!(value(&variables, "T0"), Value::Struct(records) if records.shape == [0, 0])
        );
        assert!(
            matches!(value(&variables, "f"), Value::Opaque { class, .. } if class == "function_handle")
        );
    }

    #[test]
    fn the_part_in_which_objects_lie_is_read_with_whole_numbers_to_the_last_digit() {
        let budget = ReadingBudget::new(1 << 24);
        let opened = open(&file("objects.mat"), &budget).unwrap();
        let dataset = opened
            .root()
            .group("#subsystem#")
            .and_then(|group| group.dataset("MCOS"))
            .unwrap();
        let (cells, long_words) = values::wrapper(&dataset, &budget).unwrap();
        assert_eq!(cells.len(), 3);
        assert!(matches!(&cells[0], Value::Array(bytes) if bytes.re == [4.0, 0.0, 0.0, 0.0]));
        assert_eq!(long_words, [(2, vec![u64::MAX])]);
        let variables = Reader {
            budget: &budget,
            objects: &Objects::References,
        }
        .variables(&opened.root())
        .unwrap();
        assert_eq!(
            array(&variables, "sys").re,
            [f64::from(0xdd00_0000_u32), 2.0, 1.0, 1.0, 1.0, 1.0]
        );
        let opaque = value(&read_file("objects.mat").unwrap(), "sys");
        assert!(matches!(opaque, Value::Opaque { class, .. } if class == "ss"));
    }

    #[test]
    fn other_variables_are_read_where_the_objects_are_damaged() {
        // The directory of this file is cut off after its version.
        let read = (HDF5.read)(
            &file("objects.mat"),
            Path::new("objects.mat"),
            &ReadingBudget::new(1 << 24),
        )
        .unwrap();
        let Contents::Variables { variables, .. } = read else {
            panic!("variables")
        };
        assert_eq!(
            (variables.len(), value(&variables, "before")),
            (2, number(1.0))
        );
        let sys = value(&variables, "sys");
        assert!(
            matches!(&sys, Value::Opaque { why, .. } if why.contains("cut off")),
            "{sys:?}"
        );
    }

    #[test]
    fn files_of_h5py_are_read() {
        for name in ["plain.h5", "plain_latest.h5"] {
            let variables = read_file(name).unwrap();
            let whole = Array {
                kind: ElementKind::Integer,
                ..Array::matrix(2, 3, vec![1.0, 4.0, 2.0, 5.0, 3.0, 6.0])
            };
            assert_eq!(array(&variables, "big_endian"), whole);
            assert_eq!(
                array(&variables, "half"),
                Array::matrix(1, 2, vec![0.5, 1.25])
            );
            assert_eq!(value(&variables, "scalar"), number(2.5));
            assert_eq!(
                (
                    array(&variables, "flags").kind,
                    array(&variables, "flags").re
                ),
                (ElementKind::Logical, vec![1.0, 0.0])
            );
            assert_eq!(array(&variables, "z").im, Some(vec![2.0, 0.5]));
            assert_eq!(
                value(&variables, "text"),
                texts(&[1, 1], &["hover \u{3b8}"])
            );
            assert_eq!(
                value(&variables, "names"),
                texts(&[1, 3], &["u", "theta", ""])
            );
            assert_eq!(value(&variables, "fixed"), texts(&[1, 2], &["u", "theta"]));
            assert_eq!(
                array(&variables, "nothing"),
                Array::matrix(0, 0, Vec::new())
            );
            assert_eq!(
                array(&variables, "no_rows"),
                Array::matrix(0, 3, Vec::new())
            );
            assert_eq!(array(&variables, "summed").re[..2], [0.0, 3.0]);
            assert_eq!(array(&variables, "unwritten").re, [7.0; 4]);
            assert!(matches!(value(&variables, "ragged"), Value::Opaque { .. }));
        }
    }

    #[test]
    fn groups_and_records_are_structs() {
        for name in ["plain.h5", "plain_latest.h5"] {
            let variables = read_file(name).unwrap();
            let Value::Struct(group) = value(&variables, "group") else {
                panic!("no struct")
            };
            let Value::Struct(inner) = &group.field("inner").unwrap()[0] else {
                panic!("no struct")
            };
            assert_eq!(inner.field("x").unwrap(), [number(1.0)]);
            assert!(
                matches!(value(&variables, "empty"), Value::Struct(records) if records.fields.is_empty())
            );
            let Value::Struct(records) = value(&variables, "records") else {
                panic!("no struct")
            };
            assert_eq!(records.field("gain").unwrap(), [number(1.5), number(-2.0)]);
            assert_eq!(records.field("name").unwrap()[1], texts(&[1, 1], &["phi"]));
        }
    }

    #[test]
    fn other_variables_are_read_beside_one_of_a_newer_format() {
        let variables = read_file("hdf5_2.h5").unwrap();
        assert!(
            matches!(value(&variables, "packed"), Value::Opaque { why, .. } if why.contains("HDF5 1.14"))
        );
        assert_eq!(value(&variables, "x"), number(1.0));
    }

    #[test]
    fn links_to_elsewhere_are_passed_over_and_names_that_are_not_utf8_refused() {
        let variables = read_file("links.h5").unwrap();
        assert_eq!((variables.len(), value(&variables, "x")), (1, number(1.0)));
        assert!(
            matches!(read_file("name.h5"), Err(VariableFault::Damaged { what, .. }) if what.contains("UTF-8"))
        );
    }

    #[test]
    fn values_that_contain_themselves_or_lie_too_deep_are_refused() {
        for name in ["circle.mat", "circle.h5", "deep.h5"] {
            assert!(
                matches!(read_file(name), Err(VariableFault::TooDeep { .. })),
                "{name}"
            );
        }
    }

    #[test]
    fn what_would_take_too_much_memory_is_refused() {
        for name in ["laughs.mat", "huge.mat", "huge_sparse.mat"] {
            assert!(
                matches!(read_file(name), Err(VariableFault::TooLarge { .. })),
                "{name}"
            );
        }
        assert!(matches!(
            read_file("huge_empty.mat"),
            Err(VariableFault::Damaged { .. })
        ));
    }

    #[test]
    fn what_is_no_hdf5_is_named_and_what_is_cut_off_is_said_to_be() {
        let read = |bytes: &[u8]| read(bytes, &ReadingBudget::new(1 << 24));
        assert!(matches!(read(b""), Err(VariableFault::Format { .. })));
        assert!(matches!(
            read(b"MATLAB 5.0 MAT-file"),
            Err(VariableFault::Format { .. })
        ));
        for name in ["numbers.mat", "plain_latest.h5"] {
            let whole = file(name);
            assert!(
                matches!(
                    read(&whole[..whole.len() - 1]),
                    Err(VariableFault::CutOff { .. })
                ),
                "{name}"
            );
        }
    }

    #[test]
    fn damage_anywhere_is_a_fault_and_never_a_panic() {
        let read = |bytes: &[u8]| read(bytes, &ReadingBudget::new(1 << 24));
        for name in ["objects.mat", "plain_latest.h5"] {
            let whole = file(name);
            for length in (0..whole.len()).step_by(97) {
                assert!(read(&whole[..length]).is_err(), "{name} cut to {length}");
            }
            for place in (0..whole.len()).step_by(5) {
                let mut bytes = whole.clone();
                bytes[place] ^= 1 << (place % 8);
                let _ = read(&bytes);
            }
        }
    }
}

#[cfg(test)]
mod rationed_tests {
    use super::*;

    #[test]
    fn a_file_can_be_read_only_so_often() {
        let source = Rationed::new(vec![7; 1 << 20], Arc::default());
        let mut buffer = vec![0; 1 << 20];
        for _ in 0..32 {
            source.read_at(0, &mut buffer).unwrap();
        }
        assert!(matches!(
            source.read_at(0, &mut buffer),
            Err(FormatError::Source(_))
        ));
    }

    #[test]
    fn nothing_is_read_beyond_the_end() {
        let source = Rationed::new(vec![1, 2, 3], Arc::default());
        assert!(source.read_at(2, &mut [0; 2]).is_err());
        assert!(source.read_at(u64::MAX, &mut [0; 2]).is_err());
    }
}
