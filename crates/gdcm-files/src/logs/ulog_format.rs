//! The layouts of a ULog's messages: fields of numbers, of arrays and of other layouts, as a flat list of numbers.

use std::collections::BTreeMap;

use crate::logs::little_endian::Scalar;
use crate::variables::{ReadingBudget, VariableFault};

/// The most bytes that a message can have: its length is a number of 16 bits.
const LARGEST: usize = 65_535;
/// Layouts inside one another.
const DEEPEST: usize = 8;

/// A number in the data of a message.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Place {
    /// Its name: `xyz[0]`, `esc[1].esc_rpm`.
    pub(super) name: String,
    pub(super) scalar: Scalar,
    pub(super) offset: usize,
}

/// Layouts by the name of their message, as they stand in the file: `uint64_t timestamp;float[3] xyz`.
pub(super) type Formats<'b> = BTreeMap<&'b str, &'b str>;

/// The numbers in a message of this name, and how many bytes it has.
///
/// # Errors
/// A layout that is missing, in a circle, or longer than any message.
pub(super) fn places_of(
    name: &str,
    formats: &Formats<'_>,
    budget: &ReadingBudget<'_>,
) -> Result<(Vec<Place>, usize), VariableFault> {
    let mut flat = Flat { formats, budget, message: name, places: Vec::new() };
    let size = flat.add(name, "", 0, DEEPEST)?;
    Ok((flat.places, size))
}

struct Flat<'a> {
    formats: &'a Formats<'a>,
    budget: &'a ReadingBudget<'a>,
    message: &'a str,
    places: Vec<Place>,
}

impl Flat<'_> {
    fn damaged(&self, what: String) -> VariableFault {
        VariableFault::Damaged { variable: self.message.to_owned(), what, offset: 0 }
    }

    /// Adds the numbers of a layout from a place on; gives where it ends.
    fn add(&mut self, name: &str, prefix: &str, mut offset: usize, deeper: usize) -> Result<usize, VariableFault> {
        if deeper == 0 {
            return Err(VariableFault::TooDeep { variable: self.message.to_owned() });
        }
        let Some(fields) = self.formats.get(name) else {
            return Err(self.damaged(format!("the layout of \"{}\" is missing", short(name))));
        };
        for field in fields.split(';').map(str::trim).filter(|field| !field.is_empty()) {
            let Some((kind, field)) = field.split_once(' ') else {
                return Err(self.damaged(format!("\"{}\" is no field", short(field))));
            };
            let is_array = kind.ends_with(']');
            let (kind, count) = match kind.strip_suffix(']').and_then(|kind| kind.split_once('[')) {
                Some((kind, count)) => (kind, count.parse::<usize>().ok().filter(|count| *count <= LARGEST)),
                None => (kind, Some(1)),
            };
            let Some(count) = count else { return Err(self.damaged(format!("\"{}\" has no length", short(field)))) };
            for index in 0..count {
                let label = if is_array { format!("{prefix}{field}[{index}]") } else { format!("{prefix}{field}") };
                let begin = offset;
                self.budget.work(1, self.message)?;
                offset = match scalar(kind) {
                    Some(Kind::Number(scalar)) => {
                        if !field.starts_with("_padding") {
                            self.budget.take(1, (size_of::<Place>() + label.len()) as u64, self.message)?;
                            self.places.push(Place { name: label, scalar, offset });
                        }
                        offset + scalar.size()
                    }
                    Some(Kind::Letter) => offset + 1,
                    None => self.add(kind, &format!("{label}."), offset, deeper - 1)?,
                };
                // What has no bytes could stand there any number of times.
                if offset == begin || offset > LARGEST {
                    return Err(self.damaged(format!("the field \"{}\" has no length, or too much", short(field))));
                }
            }
        }
        Ok(offset)
    }
}

enum Kind {
    Number(Scalar),
    Letter,
}

/// What a name of a type of C means.
fn scalar(kind: &str) -> Option<Kind> {
    Some(Kind::Number(match kind {
        "int8_t" => Scalar::I8,
        "uint8_t" | "bool" => Scalar::U8,
        "int16_t" => Scalar::I16,
        "uint16_t" => Scalar::U16,
        "int32_t" => Scalar::I32,
        "uint32_t" => Scalar::U32,
        "int64_t" => Scalar::I64,
        "uint64_t" => Scalar::U64,
        "float" => Scalar::F32,
        "double" => Scalar::F64,
        "char" => return Some(Kind::Letter),
        _ => return None,
    }))
}

/// As much of a name as a message can bear.
fn short(name: &str) -> String {
    name.chars().take(60).filter(|letter| !letter.is_control()).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn layouts_inside_layouts_become_a_flat_list() {
        let formats = Formats::from([
            ("esc", "uint64_t timestamp;one[2] esc;uint8_t[3] _padding0;"),
            ("one", "int16_t rpm;char[4] name;float v"),
        ]);
        let (places, size) = places_of("esc", &formats, &ReadingBudget::new(1 << 20)).unwrap();
        let found: Vec<(&str, usize)> = places.iter().map(|place| (place.name.as_str(), place.offset)).collect();
        let expected = [("timestamp", 0), ("esc[0].rpm", 8), ("esc[0].v", 14), ("esc[1].rpm", 18), ("esc[1].v", 24)];
        assert_eq!((found, size), (expected.to_vec(), 31));
    }

    #[test]
    fn circles_and_layouts_without_bytes_are_refused() {
        let formats = Formats::from([("a", "a x"), ("b", "none[60000] x"), ("none", ""), ("c", "float[99999999] x")]);
        for name in ["a", "b", "c", "d"] {
            assert!(places_of(name, &formats, &ReadingBudget::new(1 << 20)).is_err(), "{name}");
        }
    }
}
