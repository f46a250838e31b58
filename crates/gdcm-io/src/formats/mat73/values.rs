//! Values of datasets other than arrays of numbers: strings, empty arrays and compound records.

use hdf5_pure::{CompoundMember, Dataset, Datatype, StringPadding, VlenStringReadOptions};

use crate::formats::mat::text_rows;
use crate::formats::mat73::attributes::MatlabAttributes;
use crate::formats::mat73::dataset::Elements;
use crate::formats::mat73::library_fault::{damaged, library_fault};
use crate::formats::mat73::number_type::NumberType;
use crate::formats::strides::element_count;
use crate::formats::variables::{Array, CellArray, ElementKind, StructArray, TextArray, Value};
use crate::reading_budget::{ReadingBudget, VariableFault};

/// Memory of the shape and the number in an array with a single number \[bytes\].
const NUMBER_MEMORY: u64 = 24;

/// Converts a character array, stored as UTF-16 codes, to a string for each row.
pub(super) fn character_rows(
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
    text_rows(&units, &codes.shape, path, budget)
}

/// Reads the strings of a dataset, of fixed or variable length; `None` if its type is not a string.
pub(super) fn strings(
    dataset: &Dataset,
    elements: &Elements,
    path: &str,
    budget: &ReadingBudget<'_>,
) -> Result<Option<TextArray>, VariableFault> {
    let count = elements.count();
    budget.take(count as u64, size_of::<String>() as u64, path)?;
    let texts = match &elements.datatype {
        Datatype::String { padding, size, .. } => {
            budget.take(count as u64, u64::from(*size), path)?;
            elements
                .places()
                .map(|place| decode_fixed_text(elements.bytes_at(place), padding))
                .collect()
        }
        Datatype::VariableLength {
            is_string: true, ..
        } => {
            let mut texts = variable_strings(dataset, count, path, budget)?;
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

/// Decodes a string of fixed length and removes its padding.
fn decode_fixed_text(bytes: &[u8], padding: &StringPadding) -> String {
    let text = String::from_utf8_lossy(bytes);
    let end = text.find('\0').unwrap_or(text.len());
    let text = &text[..end];
    match padding {
        StringPadding::SpacePad => text.trim_end_matches(' ').to_owned(),
        _ => text.to_owned(),
    }
}

/// Reads `count` variable-length strings, in file order.
fn variable_strings(
    dataset: &Dataset,
    count: usize,
    path: &str,
    budget: &ReadingBudget<'_>,
) -> Result<Vec<String>, VariableFault> {
    if count == 0 {
        return Ok(Vec::new());
    }
    // Take the total length from the budget: all strings may refer to the same long string.
    let length = dataset
        .vlen_string_payload_size()
        .map_err(|error| library_fault(&error, path))?;
    budget.take(length, 1, path)?;
    let options = VlenStringReadOptions::new()
        .with_max_elements(count)
        .with_max_payload_bytes(usize::try_from(length).unwrap_or(usize::MAX));
    let texts = dataset
        .read_vlen_strings(options)
        .map_err(|error| library_fault(&error, path))?;
    if texts.len() == count {
        Ok(texts)
    } else {
        Err(damaged(path, "strings are missing"))
    }
}

/// Returns an empty value; `elements` holds its shape.
pub(super) fn empty_value(
    attributes: &MatlabAttributes,
    elements: &Elements,
    path: &str,
    budget: &ReadingBudget<'_>,
) -> Result<Value, VariableFault> {
    let Some(shape) = stored_shape(elements, path, budget)? else {
        return Err(damaged(path, "the shape of an empty array is wrong"));
    };
    if shape.len() < 2 || element_count(&shape) != Some(0) {
        return Err(damaged(path, "the shape of an empty array is wrong"));
    }
    Ok(match attributes.class_name() {
        "cell" => Value::Cell(CellArray {
            shape,
            values: Vec::new(),
        }),
        "struct" => {
            let fields = attributes
                .fields
                .iter()
                .map(|name| (name.clone(), Vec::new()))
                .collect();
            Value::Struct(StructArray { shape, fields })
        }
        "char" => {
            let codes = empty_array(shape, ElementKind::Integer);
            Value::Text(character_rows(&codes, path, budget)?)
        }
        // GNU Octave writes no class for numeric arrays.
        "double" | "single" | "" => Value::Array(empty_array(shape, ElementKind::Float)),
        "logical" => Value::Array(empty_array(shape, ElementKind::Logical)),
        "int8" | "int16" | "int32" | "int64" | "uint8" | "uint16" | "uint32" | "uint64" => {
            Value::Array(empty_array(shape, ElementKind::Integer))
        }
        class => Value::opaque(class, "it is empty"),
    })
}

/// Returns the elements as the dimensions of an array; `None` if they are not 64-bit integers or
/// exceed `usize`.
fn stored_shape(
    elements: &Elements,
    path: &str,
    budget: &ReadingBudget<'_>,
) -> Result<Option<Vec<usize>>, VariableFault> {
    let Some(sides) = elements.words(path, budget)? else {
        return Ok(None);
    };
    Ok(sides
        .iter()
        .map(|&side| usize::try_from(side).ok())
        .collect())
}

/// Returns an array without elements.
fn empty_array(shape: Vec<usize>, kind: ElementKind) -> Array {
    Array {
        shape,
        kind,
        re: Vec::new(),
        im: None,
    }
}

/// Converts the elements of a compound type to records, with numbers, strings of fixed length, and
/// opaque values for all other members. Returns `None` for any other type.
pub(super) fn compound_records(
    elements: &Elements,
    path: &str,
    budget: &ReadingBudget<'_>,
) -> Result<Option<StructArray>, VariableFault> {
    let Datatype::Compound { members, .. } = &elements.datatype else {
        return Ok(None);
    };
    let mut fields = Vec::with_capacity(members.len());
    for member in members {
        let size = size_of::<Value>() as u64 + NUMBER_MEMORY;
        budget.take(elements.count() as u64, size, path)?;
        let mut values = Vec::new();
        for place in elements.places() {
            values.push(member_value(
                member,
                elements.bytes_at(place),
                path,
                budget,
            )?);
        }
        fields.push((member.name.clone(), values));
    }
    Ok(Some(StructArray {
        shape: elements.shape.clone(),
        fields,
    }))
}

/// Decodes a member of a compound record.
fn member_value(
    member: &CompoundMember,
    record: &[u8],
    path: &str,
    budget: &ReadingBudget<'_>,
) -> Result<Value, VariableFault> {
    let offset = usize::try_from(member.byte_offset).unwrap_or(usize::MAX);
    let bytes = record.get(offset..).unwrap_or_default();
    if let Some(number_type) = NumberType::from_datatype(&member.datatype) {
        return Ok(Value::Array(Array {
            shape: vec![1, 1],
            kind: number_type.number.kind(),
            re: vec![number_type.real_part(bytes)],
            im: number_type.imaginary_part(bytes).map(|im| vec![im]),
        }));
    }
    if let Datatype::String { size, padding, .. } = &member.datatype {
        let bytes = &bytes[..bytes.len().min(*size as usize)];
        budget.take(bytes.len() as u64, 1, path)?;
        return Ok(Value::text(decode_fixed_text(bytes, padding)));
    }
    Ok(Value::opaque(
        "a field of a record",
        "it is neither a number nor a string of fixed length",
    ))
}
