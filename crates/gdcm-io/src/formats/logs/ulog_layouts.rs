//! Message layouts in ULog. The fields are numbers, arrays or nested layouts, flattened to a list
//! of numbers: with `esc_report:float rpm` and `esc_status:uint64_t timestamp;esc_report[2] esc`,
//! the numbers of `esc_status` are `timestamp`, `esc[0].rpm` and `esc[1].rpm`.

use std::collections::BTreeMap;

use crate::formats::stored_number::{NumberClass, StoredNumber};
use crate::reading_budget::{ReadingBudget, VariableFault};
use crate::variable_fault::damage::Damage;

/// Maximum message length \[bytes\]; the length field has 16 bits.
const LARGEST: usize = 65_535;
/// Maximum nesting depth of layouts.
const DEEPEST: usize = 8;

/// A number's position and type in a message's data.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Place {
    /// The number's name, for example `xyz[0]` or `esc[1].esc_rpm`.
    pub(super) name: String,
    stored: StoredNumber,
    /// Offset in the message data \[bytes\].
    offset: usize,
}

impl Place {
    /// Returns whether this is the time stamp, the unsigned 64-bit integer `timestamp` \[µs\].
    pub(super) fn is_stamp(&self) -> bool {
        self.name == "timestamp" && Some(self.stored) == number_type("uint64_t")
    }

    /// Returns the offset just after the number \[bytes\].
    pub(super) fn end(&self) -> usize {
        self.offset + self.stored.size()
    }

    /// Reads the number from message data; `None` if the data are too short.
    pub(super) fn read(&self, data: &[u8]) -> Option<f64> {
        self.stored.decode_at(data, self.offset)
    }
}

/// Layouts by message name, as written in the file: `uint64_t timestamp;float[3] xyz`.
pub(super) type LayoutTexts<'b> = BTreeMap<&'b str, &'b str>;

/// Returns the places that numbers have in a message with this name; characters and padding are
/// left out.
///
/// # Errors
/// [`VariableFault`] if a layout is missing, damaged, nested more than `DEEPEST` levels deep (for
/// example recursive), or longer than the largest message, or if the budget is exhausted.
pub(super) fn places_in_message(
    name: &str,
    layouts: &LayoutTexts<'_>,
    budget: &ReadingBudget<'_>,
) -> Result<Vec<Place>, VariableFault> {
    let mut flattening = Flattening {
        layouts,
        budget,
        message: name,
        places: Vec::new(),
        offset: 0,
    };
    flattening.add_layout(name, "", DEEPEST)?;
    Ok(flattening.places)
}

/// State while a layout is flattened.
struct Flattening<'a> {
    layouts: &'a LayoutTexts<'a>,
    budget: &'a ReadingBudget<'a>,
    message: &'a str,
    places: Vec<Place>,
    /// Next field's offset \[bytes\].
    offset: usize,
}

/// Layout field, such as `float[3] xyz`.
struct LayoutField<'f> {
    /// Name of a number type or another layout.
    kind: &'f str,
    name: &'f str,
    /// Element count if the field is an array.
    length: Option<usize>,
}

impl Flattening<'_> {
    fn damaged(&self, damage: Damage) -> VariableFault {
        VariableFault::damaged(self.message, damage, 0)
    }

    /// Adds the numbers in a layout, down to `deeper` nested layout levels.
    fn add_layout(&mut self, name: &str, prefix: &str, deeper: usize) -> Result<(), VariableFault> {
        if deeper == 0 {
            return Err(VariableFault::too_deep(self.message));
        }
        let Some(fields) = self.layouts.get(name) else {
            return Err(self.damaged(Damage::LayoutMissing { name: short(name) }));
        };
        for field in fields.split(';').map(str::trim) {
            if !field.is_empty() {
                let field = self.parse_field(field)?;
                self.add_field(&field, prefix, deeper)?;
            }
        }
        Ok(())
    }

    fn parse_field<'f>(&self, field: &'f str) -> Result<LayoutField<'f>, VariableFault> {
        let Some((kind, name)) = field.split_once(' ') else {
            return Err(self.damaged(Damage::LayoutField { name: short(field) }));
        };
        let array = kind.strip_suffix(']').and_then(|kind| kind.split_once('['));
        let Some((kind, length)) = array else {
            return Ok(LayoutField {
                kind,
                name,
                length: None,
            });
        };
        match length.parse() {
            Ok(length) if length <= LARGEST => Ok(LayoutField {
                kind,
                name,
                length: Some(length),
            }),
            _ => Err(self.damaged(Damage::LayoutFieldLength { name: short(name) })),
        }
    }

    /// Adds the numbers in a field, for an array those in each element.
    fn add_field(
        &mut self,
        field: &LayoutField<'_>,
        prefix: &str,
        deeper: usize,
    ) -> Result<(), VariableFault> {
        let name = field.name;
        for index in 0..field.length.unwrap_or(1) {
            let label = if field.length.is_some() {
                format!("{prefix}{name}[{index}]")
            } else {
                format!("{prefix}{name}")
            };
            let begin = self.offset;
            self.budget.work(1, self.message)?;
            match number_type(field.kind) {
                Some(stored) => self.add_number(label, name, stored)?,
                None if field.kind == "char" => self.offset += 1,
                None => self.add_layout(field.kind, &format!("{label}."), deeper - 1)?,
            }
            // Reject zero-length fields, which could be repeated without limit.
            if self.offset == begin || self.offset > LARGEST {
                return Err(self.damaged(Damage::LayoutFieldSize { name: short(name) }));
            }
        }
        Ok(())
    }

    /// Adds a number; for padding, only advances the offset.
    fn add_number(
        &mut self,
        label: String,
        field: &str,
        stored: StoredNumber,
    ) -> Result<(), VariableFault> {
        if !field.starts_with("_padding") {
            self.budget
                .take(1, (size_of::<Place>() + label.len()) as u64, self.message)?;
            self.places.push(Place {
                name: label,
                stored,
                offset: self.offset,
            });
        }
        self.offset += stored.size();
        Ok(())
    }
}

/// Returns the number type for a C type name; `None` if the name is unknown.
fn number_type(name: &str) -> Option<StoredNumber> {
    use NumberClass::{Float, Signed, Unsigned};
    let (class, size) = match name {
        "int8_t" => (Signed, 1),
        "uint8_t" | "bool" => (Unsigned, 1),
        "int16_t" => (Signed, 2),
        "uint16_t" => (Unsigned, 2),
        "int32_t" => (Signed, 4),
        "uint32_t" => (Unsigned, 4),
        "int64_t" => (Signed, 8),
        "uint64_t" => (Unsigned, 8),
        "float" => (Float, 4),
        "double" => (Float, 8),
        _ => return None,
    };
    Some(StoredNumber::little_endian(class, size))
}

/// Shortens a name for a message, without control characters.
fn short(name: &str) -> String {
    name.chars()
        .take(60)
        .filter(|letter| !letter.is_control())
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn nested_layouts_become_a_flat_list() {
        let layouts = LayoutTexts::from([
            (
                "esc",
                "uint64_t timestamp;one[2] esc;uint8_t[3] _padding0;bool last",
            ),
            ("one", "int16_t rpm;char[4] name;float v"),
        ]);
        let places = places_in_message("esc", &layouts, &ReadingBudget::new(1 << 20)).unwrap();
        let found: Vec<(&str, usize)> = places
            .iter()
            .map(|place| (place.name.as_str(), place.offset))
            .collect();
        let expected = [
            ("timestamp", 0),
            ("esc[0].rpm", 8),
            ("esc[0].v", 14),
            ("esc[1].rpm", 18),
            ("esc[1].v", 24),
            ("last", 31),
        ];
        assert_eq!(found, expected);
    }

    #[test]
    fn circles_and_layouts_without_bytes_are_refused() {
        let layouts = LayoutTexts::from([
            ("a", "a x"),
            ("b", "none[60000] x"),
            ("none", ""),
            ("c", "float[99999999] x"),
        ]);
        for name in ["a", "b", "c", "d"] {
            assert!(
                places_in_message(name, &layouts, &ReadingBudget::new(1 << 20)).is_err(),
                "{name}"
            );
        }
    }
}
