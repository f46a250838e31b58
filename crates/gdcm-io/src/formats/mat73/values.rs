//! Texts: MATLAB's characters, and HDF5 strings.

use hdf5_pure::{
    CompoundMember, Dataset, Datatype, File, Object, StringPadding, VlenStringReadOptions,
};

use crate::formats::mat;
use crate::formats::mat::Subsystem;
use crate::formats::mat73::dataset::{Elements, NumberType, Order};
use crate::formats::mat73::{MatlabAttributes, Reader, damaged, fault};
use crate::formats::strides::{Entries, count};
use crate::formats::variables::{Array, CellArray, ElementKind, StructArray, TextArray, Value};
use crate::reading_budget::{ReadingBudget, VariableFault};

/// Returns the texts in the rows of an array of UTF-16 codes.
pub(super) fn rows(
    codes: &Array,
    path: &str,
    budget: &ReadingBudget<'_>,
) -> Result<TextArray, VariableFault> {
    budget.take(codes.len() as u64, size_of::<u32>() as u64, path)?;
    let units: Vec<u32> = codes
        .re
        .iter()
        .map(|&code| u32::from(code as u16))
        .collect();
    mat::rows(&units, &codes.shape, path, budget)
}

/// Decodes a fixed-length text without its padding.
pub(super) fn fixed(bytes: &[u8], padding: &StringPadding) -> String {
    let text = String::from_utf8_lossy(bytes);
    let end = text.find('\0').unwrap_or(text.len());
    let text = &text[..end];
    if matches!(padding, StringPadding::SpacePad) {
        text.trim_end_matches(' ')
    } else {
        text
    }
    .to_owned()
}

/// Reads the strings of a dataset, if it has one of HDF5's two string types.
pub(super) fn strings(
    dataset: &Dataset,
    elements: &Elements,
    path: &str,
    budget: &ReadingBudget<'_>,
) -> Result<Option<TextArray>, VariableFault> {
    budget.take(elements.count() as u64, (size_of::<String>()) as u64, path)?;
    let texts = match &elements.datatype {
        Datatype::String { padding, size, .. } => {
            budget.take(elements.count() as u64, u64::from(*size), path)?;
            elements
                .places()
                .map(|place| fixed(elements.at(place), padding))
                .collect()
        }
        Datatype::VariableLength {
            is_string: true, ..
        } => {
            let mut texts = variable(dataset, elements.count(), path, budget)?;
            elements
                .places()
                .filter_map(|place| texts.get_mut(place).map(std::mem::take))
                .collect()
        }
        _ => return Ok(None),
    };
    Ok(Some(TextArray {
        shape: elements.shape.clone(),
        texts,
    }))
}

fn variable(
    dataset: &Dataset,
    count: usize,
    path: &str,
    budget: &ReadingBudget<'_>,
) -> Result<Vec<String>, VariableFault> {
    if count == 0 {
        return Ok(Vec::new());
    }
    let failed = |error| fault(&error, path);
    // Every string may refer to the same long string.
    let length = dataset.vlen_string_payload_size().map_err(failed)?;
    budget.take(length, 1, path)?;
    let most = usize::try_from(length).unwrap_or(usize::MAX);
    let options = VlenStringReadOptions::new()
        .with_max_elements(count)
        .with_max_payload_bytes(most);
    let texts = dataset.read_vlen_strings(options).map_err(failed)?;
    if texts.len() == count {
        Ok(texts)
    } else {
        Err(damaged(path, "strings are missing"))
    }
}

// Empty arrays, whose shape MATLAB stores.

/// Returns the empty value for the attributes and a stored shape.
pub(super) fn empty(
    marks: &MatlabAttributes,
    elements: &Elements,
    path: &str,
    budget: &ReadingBudget<'_>,
) -> Result<Value, VariableFault> {
    let wrong = || damaged(path, "the shape of an array without elements is wrong");
    let sides = elements.words(path, budget)?.ok_or_else(wrong)?;
    let shape: Vec<usize> = sides
        .iter()
        .map(|&side| usize::try_from(side).ok())
        .collect::<Option<_>>()
        .ok_or_else(wrong)?;
    if shape.len() < 2 || count(&shape) != Some(0) {
        return Err(wrong());
    }
    let numbers = |kind| Array {
        shape: shape.clone(),
        kind,
        re: Vec::new(),
        im: None,
    };
    Ok(match marks.class() {
        "cell" => Value::Cell(CellArray {
            shape,
            values: Vec::new(),
        }),
        "struct" => {
            let fields = marks
                .fields
                .iter()
                .map(|name| (name.clone(), Vec::new()))
                .collect();
            Value::Struct(StructArray { shape, fields })
        }
        "char" => Value::Text(rows(&numbers(ElementKind::Integer), path, budget)?),
        // GNU Octave writes no class here.
        "double" | "single" | "" => Value::Array(numbers(ElementKind::Float)),
        "logical" => Value::Array(numbers(ElementKind::Logical)),
        "int8" | "int16" | "int32" | "int64" | "uint8" | "uint16" | "uint32" | "uint64" => {
            Value::Array(numbers(ElementKind::Integer))
        }
        class => Value::opaque(class, "it is empty"),
    })
}

// HDF5 compound types.

/// Returns a record for each element, if the type is compound: numbers, fixed-length texts, and the
/// names of other members.
pub(super) fn records(
    elements: &Elements,
    path: &str,
    budget: &ReadingBudget<'_>,
) -> Result<Option<StructArray>, VariableFault> {
    let Datatype::Compound { members, .. } = &elements.datatype else {
        return Ok(None);
    };
    let mut fields = Vec::with_capacity(members.len());
    for member in members {
        // A value, its shape and its single number.
        budget.take(
            elements.count() as u64,
            size_of::<Value>() as u64 + 24,
            path,
        )?;
        let values = elements
            .places()
            .map(|place| value(member, elements.at(place), path, budget));
        fields.push((member.name.clone(), values.collect::<Result<_, _>>()?));
    }
    Ok(Some(StructArray {
        shape: elements.shape.clone(),
        fields,
    }))
}

fn value(
    member: &CompoundMember,
    record: &[u8],
    path: &str,
    budget: &ReadingBudget<'_>,
) -> Result<Value, VariableFault> {
    let offset = usize::try_from(member.byte_offset).unwrap_or(usize::MAX);
    let bytes = record.get(offset..).unwrap_or_default();
    if let Some(numbers) = NumberType::of(&member.datatype) {
        let part = |offset: usize| {
            vec![
                numbers
                    .number
                    .decode(bytes.get(offset..).unwrap_or_default()),
            ]
        };
        let re = part(numbers.re);
        let im = numbers.im.map(part);
        return Ok(Value::Array(Array {
            shape: vec![1, 1],
            kind: numbers.number.kind(),
            re,
            im,
        }));
    }
    if let Datatype::String { size, padding, .. } = &member.datatype {
        let bytes = &bytes[..bytes.len().min(*size as usize)];
        budget.take(bytes.len() as u64, 1, path)?;
        return Ok(Value::text(fixed(bytes, padding)));
    }
    Ok(Value::opaque(
        "a field of a record",
        "it is neither a number nor a text of fixed length",
    ))
}

// Sparse matrices (`MATLAB_sparse`), in compressed columns.

/// Returns the full matrix of a group's members.
pub(super) fn sparse(
    height: u64,
    marks: &MatlabAttributes,
    members: &[(String, Object)],
    path: &str,
    budget: &ReadingBudget<'_>,
) -> Result<Array, VariableFault> {
    let wrong = || damaged(path, "the sparse matrix contradicts itself");
    let member = |name: &str| {
        let found = members.iter().find(|(member, _)| member == name);
        let Some((_, Object::Dataset(dataset))) = found else {
            return Ok(None);
        };
        Elements::read(dataset, Order::Columns, path, budget).map(Some)
    };
    let places = |name: &str| -> Result<Option<Vec<usize>>, VariableFault> {
        let Some(elements) = member(name)? else {
            return Ok(None);
        };
        let words = elements.words(path, budget)?;
        let words = words
            .ok_or_else(|| damaged(path, "the places of a sparse matrix are no whole numbers"))?;
        Ok(Some(
            words
                .into_iter()
                .map(|word| usize::try_from(word).unwrap_or(usize::MAX))
                .collect(),
        ))
    };
    let starts = places("jc")?.ok_or_else(wrong)?;
    let rows = places("ir")?.unwrap_or_default();
    // The dataset is absent if there are no nonzero numbers.
    let data = match member("data")? {
        None => Array::matrix(0, 0, Vec::new()),
        Some(elements) => elements
            .numbers(path, budget)?
            .ok_or_else(|| damaged(path, "the elements of a sparse matrix are no numbers"))?,
    };
    let shape = [
        usize::try_from(height).map_err(|_| wrong())?,
        starts.len().checked_sub(1).ok_or_else(wrong)?,
    ];
    let kind = if marks.class() == "logical" {
        ElementKind::Logical
    } else {
        data.kind
    };
    budget.take(rows.len() as u64, 8, path)?;
    let entries =
        Entries::of_columns(shape, kind, rows, &starts, (data.re, data.im)).ok_or_else(wrong)?;
    entries.filled(path, budget, wrong)
}

// Objects of MATLAB's classes, in a separate part of the file (`#subsystem#/MCOS`), as in files of
// earlier versions.

/// Treatment of references to objects.
pub(super) enum Objects {
    /// References remain integers, within the object part itself.
    References,
    /// Objects cannot be read, with the reason.
    Unread(String),
    /// References are resolved.
    Read(Subsystem),
}

impl Objects {
    /// Reads the object part, if there is one.
    pub(super) fn read(file: &File, budget: &ReadingBudget<'_>) -> Result<Self, VariableFault> {
        let Ok(dataset) = file
            .root()
            .group("#subsystem#")
            .and_then(|group| group.dataset("MCOS"))
        else {
            return Ok(Self::Unread(
                "the file has no part in which objects lie".to_owned(),
            ));
        };
        let subsystem = wrapper(&dataset, budget).and_then(|(cells, long_words)| {
            Ok(Subsystem::new(cells, budget)?.with_long_words(long_words))
        });
        match subsystem {
            Ok(subsystem) => Ok(Self::Read(subsystem)),
            Err(fault) if fault.is_of_the_budget() => Err(fault),
            // The other variables remain readable.
            Err(fault) => Ok(Self::Unread(fault.to_string())),
        }
    }

    /// Returns the value of a reference with a class.
    pub(super) fn value(
        &self,
        class: &str,
        reference: Array,
        path: &str,
        budget: &ReadingBudget<'_>,
    ) -> Result<Value, VariableFault> {
        let opaque = |why: &str| Ok(Value::opaque(class, why));
        match self {
            Self::References => Ok(Value::Array(reference)),
            Self::Unread(why) => opaque(why),
            Self::Read(subsystem) => {
                let word = |&number: &f64| {
                    (0.0..=f64::from(u32::MAX))
                        .contains(&number)
                        .then_some(number as u32)
                };
                match reference.re.iter().map(word).collect::<Option<Vec<u32>>>() {
                    Some(words) => subsystem.object(&words, path, budget),
                    None => opaque("what refers to it is damaged"),
                }
            }
        }
    }
}

/// The cells of the objects, and the exact 64-bit integers of cells.
pub(super) type Wrapper = (Vec<Value>, Vec<(usize, Vec<u64>)>);

/// Reads the cells of the objects, the first of which holds the bytes of their directory, and the
/// exact 64-bit integers of cells, each with the index of its cell, counted from 0.
pub(super) fn wrapper(
    dataset: &Dataset,
    budget: &ReadingBudget<'_>,
) -> Result<Wrapper, VariableFault> {
    let reader = Reader {
        budget,
        objects: &Objects::References,
    };
    let mut cells = Vec::new();
    let mut long_words = Vec::new();
    for (index, object) in reader.referred(dataset, "")?.iter().enumerate() {
        if let Object::Dataset(dataset) = object
            && dataset.element_size().map_err(|error| fault(&error, ""))? == 8
        {
            let words = Elements::read(dataset, Order::Columns, "", budget)?.words("", budget)?;
            long_words.extend(words.map(|words| (index, words)));
        }
        cells.push(reader.value(object, "", 0)?);
    }
    Ok((cells, long_words))
}
