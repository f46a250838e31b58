//! Records of HDF5.

use hdf5_pure::{CompoundMember, Datatype};

use super::dataset::Elements;
use super::number_type::NumberType;
use super::text::fixed;
use crate::variables::{Array, MemoryBudget, StructArray, TextArray, Value, VariableFault};

/// A record for each element, if the elements are records: numbers and texts of fixed length, and what else there is by name.
pub(super) fn records(
    elements: &Elements,
    path: &str,
    meter: &MemoryBudget<'_>,
) -> Result<Option<StructArray>, VariableFault> {
    let Datatype::Compound { members, .. } = &elements.datatype else { return Ok(None) };
    let mut fields = Vec::with_capacity(members.len());
    for member in members {
        // A value, its shape and its one number.
        meter.take(elements.count() as u64, size_of::<Value>() as u64 + 24, path)?;
        let values = elements.places().map(|place| value(member, elements.at(place), path, meter));
        fields.push((member.name.clone(), values.collect::<Result<_, _>>()?));
    }
    Ok(Some(StructArray { shape: elements.shape.clone(), fields }))
}

fn value(member: &CompoundMember, record: &[u8], path: &str, meter: &MemoryBudget<'_>) -> Result<Value, VariableFault> {
    let offset = usize::try_from(member.byte_offset).unwrap_or(usize::MAX);
    let bytes = record.get(offset..).unwrap_or_default();
    if let Some(numbers) = NumberType::of(&member.datatype) {
        let part = |offset: usize| vec![numbers.number.decode(bytes.get(offset..).unwrap_or_default())];
        let (re, im) = (part(numbers.re), numbers.im.map(part));
        return Ok(Value::Array(Array { shape: vec![1, 1], kind: numbers.number.kind(), re, im }));
    }
    if let Datatype::String { size, padding, .. } = &member.datatype {
        let bytes = &bytes[..bytes.len().min(*size as usize)];
        meter.take(bytes.len() as u64, 1, path)?;
        return Ok(Value::Text(TextArray { shape: vec![1, 1], texts: vec![fixed(bytes, padding)] }));
    }
    Ok(Value::Opaque {
        class: "a field of a record".to_owned(),
        why: "it is neither a number nor a text of fixed length".to_owned(),
    })
}
