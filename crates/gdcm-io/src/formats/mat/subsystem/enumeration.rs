//! Members of enumeration classes, saved as a record with these fields:
//!
//! ```text
//! EnumerationInstanceTag   marks the record
//! ClassName                class number
//! ValueNames               for each member, the index of its name in the directory
//! ValueIndices             for each value, an index in `ValueNames`, from 0
//! ```
//!
//! The directory (`directory.rs`) lists the names of all classes, properties and members.

use crate::formats::mat::subsystem::directory::Directory;
use crate::formats::variables::{Object, StructArray, Value};

/// Field by which a record with enumeration members is recognised.
const TAG: &str = "EnumerationInstanceTag";
/// Estimated memory of a member without its name \[bytes\].
const BYTES_PER_MEMBER: u64 = 256;
/// Property of the converted object that holds the member name.
const MEMBER_NAME: &str = "Name";

/// Enumeration members, given by their names.
pub(super) struct EnumerationMembers<'d> {
    class: &'d str,
    shape: Vec<usize>,
    names: Vec<&'d str>,
}

impl<'d> EnumerationMembers<'d> {
    /// Reads enumeration members; `class` is used if the records do not name a class.
    ///
    /// # Errors
    /// The class name if the members cannot be decoded.
    pub(super) fn read(
        directory: &'d Directory,
        records: &StructArray,
        class: &'d str,
    ) -> Result<Self, &'d str> {
        let class = integers(records, "ClassName")
            .and_then(|numbers| directory.class(*numbers.first()?))
            .unwrap_or(class);
        let name_numbers = integers(records, "ValueNames").unwrap_or_default();
        let Some([Value::Array(indices)]) = records.field("ValueIndices") else {
            return Err(class);
        };
        let mut names = Vec::new();
        for &index in &indices.re {
            let number = name_numbers.get(index as usize).ok_or(class)?;
            names.push(directory.name(*number).ok_or(class)?);
        }
        Ok(Self {
            class,
            shape: indices.shape.clone(),
            names,
        })
    }

    /// Estimates the memory of the converted value \[bytes\].
    pub(super) fn memory(&self) -> u64 {
        self.names
            .iter()
            .map(|name| name.len() as u64 + BYTES_PER_MEMBER)
            .sum()
    }

    /// Converts the members to an object array whose only property is the member name.
    pub(super) fn into_value(self) -> Value {
        let names = self.names.into_iter().map(Value::text).collect();
        let records = StructArray {
            shape: self.shape,
            fields: vec![(MEMBER_NAME.to_owned(), names)],
        };
        Value::Object(Object {
            class: self.class.to_owned(),
            records,
        })
    }
}

pub(super) fn is_enumeration(records: &StructArray) -> bool {
    records.field(TAG).is_some()
}

/// Returns a field's numbers as integers; `None` unless the field has a single array.
fn integers(records: &StructArray, field: &str) -> Option<Vec<u32>> {
    match records.field(field)? {
        [Value::Array(array)] => Some(array.re.iter().map(|&number| number as u32).collect()),
        _ => None,
    }
}
