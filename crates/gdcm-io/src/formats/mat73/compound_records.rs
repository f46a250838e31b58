//! Records of a compound type, such as those that h5py writes for a structured NumPy array.

use hdf5_pure::{CompoundMember, Datatype};

use crate::formats::mat73::dataset::Elements;
use crate::formats::mat73::number_type::NumberType;
use crate::formats::mat73::strings::decode_fixed_text;
use crate::formats::variables::{Array, StructArray, Value};
use crate::reading_budget::{ReadingBudget, VariableFault};
use crate::variable_fault::unread::Unread;

/// Memory for the shape and the number in an array with a single number \[bytes\].
const NUMBER_MEMORY: u64 = 24;

/// Converts the elements of a compound type to records with numbers, fixed-length strings, and
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

/// Decodes a member from the bytes of a record; a member that is neither a number nor a
/// fixed-length string is opaque.
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
    Ok(Value::opaque("a field of a record", Unread::RecordField))
}
