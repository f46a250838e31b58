//! Members of enumerations.

use super::super::opaque::unread_because;
use super::super::trail::FieldPath;
use super::Subsystem;
use crate::variables::{MemoryBudget, Object, StructArray, TextArray, Value, VariableFault};

/// The field by which the record is known that stands for members of an enumeration.
const TAG: &str = "EnumerationInstanceTag";
/// The property that says which member an object is.
const MEMBER: &str = "Name";

/// Whether records stand for members of an enumeration.
pub(super) fn is_enumeration(records: &StructArray) -> bool {
    records.field(TAG).is_some()
}

impl Subsystem {
    /// Members of an enumeration as objects whose only property is the member's name.
    pub(in super::super) fn enumeration(
        &self,
        records: &StructArray,
        class: &str,
        trail: &FieldPath<'_>,
        meter: &MemoryBudget<'_>,
    ) -> Result<Value, VariableFault> {
        let number = numbers(records, "ClassName").and_then(|numbers| numbers.first().copied());
        let class = number.and_then(|number| self.directory.class(number)).unwrap_or(class);
        let opaque = || unread_because(class, "the members of the enumeration are not read", &trail.words());
        let names = numbers(records, "ValueNames").unwrap_or_default();
        let Some([Value::Array(indices)]) = records.field("ValueIndices") else { return Ok(opaque()) };
        let name = |&index: &f64| self.directory.name(*names.get(index as usize)?);
        let Some(members) = indices.re.iter().map(name).collect::<Option<Vec<_>>>() else { return Ok(opaque()) };
        let bytes = members.iter().map(|name| name.len() as u64 + 256).sum();
        meter.take(1, bytes, "").map_err(|fault| trail.name(fault))?;
        let text = |name: &&str| Value::Text(TextArray { shape: vec![1, 1], texts: vec![(*name).to_owned()] });
        let fields = vec![(MEMBER.to_owned(), members.iter().map(text).collect())];
        let records = StructArray { shape: indices.shape.clone(), fields };
        Ok(Value::Object(Object { class: class.to_owned(), records }))
    }
}

fn numbers(records: &StructArray, field: &str) -> Option<Vec<u32>> {
    match records.field(field)? {
        [Value::Array(array)] => Some(array.re.iter().map(|&number| number as u32).collect()),
        _ => None,
    }
}
