//! Converts JSON to MATLAB values with the same structure.
//!
//! A list of objects with equal members becomes a struct array, which MATLAB shows element by
//! element, or is *gathered*: a struct with an array for each member, which can be plotted
//! directly: `[{"x": 1, "y": [2, 3]}, {"x": 4, "y": [5, 6]}]` is gathered to `x = [1; 4]` and
//! `y = [2 3; 5 6]`.

use serde_json::Value as Json;

use super::matlab_names::valid_name;
use super::matlab_values::{Fields, cell_of_texts, row};
use crate::formats::element_order::first_index_fastest;
use crate::formats::variables::{Array, CellArray, ElementKind, StructArray, Value};

static NULL: Json = Json::Null;

/// Names of the members that need special conversion.
pub(super) struct Layout {
    /// Objects with a member for each channel; they become arrays in channel order.
    pub(super) by_channel: &'static [&'static str],
    /// Objects with a member for each model, whose name MATLAB may not accept as a field; they
    /// become structs with the fields `name` and `value`.
    pub(super) by_model_name: &'static [&'static str],
    /// Lists of objects that are gathered rather than converted to a struct array.
    pub(super) gathered_lists: &'static [&'static str],
}

impl Layout {
    /// Converts a JSON value: objects become structs, lists of objects struct arrays, rectangular
    /// lists of numbers matrices, lists of strings cell columns, and null becomes NaN. `name` is
    /// the value's member name, which selects the conversions in [`Layout`].
    pub(super) fn value(&self, name: &str, json: &Json) -> Value {
        match json {
            Json::Null | Json::Number(_) => Value::number(number(json)),
            Json::Bool(flag) => Value::truth(*flag),
            Json::String(words) => Value::text(words),
            Json::Array(entries) => self.list(name, entries),
            Json::Object(members) if self.by_channel.contains(&name) => {
                self.gathered(&[members.len()], members.values().collect())
            }
            Json::Object(members) if self.by_model_name.contains(&name) => {
                let mut fields = Fields::default();
                fields.add("name", cell_of_texts(members.keys().cloned()));
                fields.add(
                    "value",
                    self.gathered(&[members.len()], members.values().collect()),
                );
                fields.record()
            }
            Json::Object(_) => self.records(&[json]),
        }
    }

    /// Converts a list. The first case that applies:
    ///
    /// 1. empty: an empty cell column;
    /// 2. objects: gathered if `gathered_lists` contains `name`, otherwise a struct array;
    /// 3. numbers: a row;
    /// 4. lists with equal lengths: gathered with two indices;
    /// 5. anything else: gathered with one index.
    fn list(&self, name: &str, entries: &[Json]) -> Value {
        // Case 1
        if entries.is_empty() {
            return Value::Cell(CellArray {
                shape: vec![0, 1],
                values: Vec::new(),
            });
        }
        // Case 2
        if entries.iter().all(Json::is_object) {
            let entries: Vec<&Json> = entries.iter().collect();
            return if self.gathered_lists.contains(&name) {
                self.gathered(&[entries.len()], entries)
            } else {
                self.records(&entries)
            };
        }
        // Case 3
        if entries.iter().all(is_number) {
            return row(entries.iter().map(number));
        }
        // Cases 4 and 5
        let rows: Option<Vec<&Vec<Json>>> = entries.iter().map(Json::as_array).collect();
        match rows.as_deref() {
            Some([first, rest @ ..]) if rest.iter().all(|row| row.len() == first.len()) => {
                let leaves = rows.iter().flatten().copied().flatten().collect();
                self.gathered(&[entries.len(), first.len()], leaves)
            }
            _ => self.gathered(&[entries.len()], entries.iter().collect()),
        }
    }

    /// Converts objects to a row of structs with the same fields; a missing member becomes an empty
    /// value.
    fn records(&self, objects: &[&Json]) -> Value {
        let mut fields = Vec::new();
        for name in names_of(objects) {
            let mut values = Vec::with_capacity(objects.len());
            for object in objects {
                values.push(match object.get(name) {
                    Some(value) => self.value(name, value),
                    None => Value::empty(),
                });
            }
            fields.push((valid_name(name), values));
        }
        Value::Struct(StructArray {
            shape: vec![1, objects.len()],
            fields,
        })
    }

    /// Gathers values in an array with this shape. `leaves` holds the value at each index; the last
    /// index runs fastest. The first case that applies:
    ///
    /// 1. an object among them: a struct with an array for each member name;
    /// 2. all numbers: an array;
    /// 3. all booleans: a logical array;
    /// 4. equally long lists of numbers: an array with an additional index;
    /// 5. anything else: a cell array.
    fn gathered(&self, shape: &[usize], leaves: Vec<&Json>) -> Value {
        // Case 1
        if leaves.iter().any(|leaf| leaf.is_object()) {
            return self.gathered_objects(shape, &leaves);
        }
        // Case 2
        if leaves.iter().all(|leaf| is_number(leaf)) {
            let numbers = leaves.into_iter().map(number).collect();
            return array(shape, numbers, ElementKind::Float);
        }
        // Case 3
        if let Some(flags) = truth_values(&leaves) {
            return array(shape, flags, ElementKind::Logical);
        }
        // Case 4
        if let Some(length) = row_length(&leaves) {
            let mut numbers = Vec::new();
            for leaf in leaves {
                match leaf {
                    Json::Array(list) => numbers.extend(list.iter().map(number)),
                    // A missing list becomes as many missing numbers.
                    _ => numbers.extend(std::iter::repeat_n(f64::NAN, length)),
                }
            }
            return array(&[shape, &[length]].concat(), numbers, ElementKind::Float);
        }
        // Case 5
        let mut values = Vec::with_capacity(leaves.len());
        for leaf in leaves {
            values.push(match leaf {
                Json::Null => Value::empty(),
                leaf => self.value("", leaf),
            });
        }
        let shape = matlab_shape(shape);
        Value::Cell(CellArray {
            values: first_index_fastest(&shape, values),
            shape,
        })
    }

    /// Gathers objects in a struct with an array for each member name. An object with a member for
    /// each channel adds an index, the channel's, to the array.
    fn gathered_objects(&self, shape: &[usize], leaves: &[&Json]) -> Value {
        let mut fields = Fields::default();
        for name in names_of(leaves) {
            let values: Vec<&Json> = leaves
                .iter()
                .map(|leaf| leaf.get(name).unwrap_or(&NULL))
                .collect();
            let channel_count = values
                .iter()
                .filter_map(|value| Some(value.as_object()?.len()))
                .max();
            let value = match channel_count {
                Some(channel_count) if self.by_channel.contains(&name) => {
                    let mut members = Vec::new();
                    for value in values {
                        for channel in 0..channel_count {
                            members.push(member_at(value, channel));
                        }
                    }
                    self.gathered(&[shape, &[channel_count]].concat(), members)
                }
                _ => self.gathered(shape, values),
            };
            fields.add(&valid_name(name), value);
        }
        fields.record()
    }
}

/// Returns whether a value is a number, or null for a missing number.
fn is_number(json: &Json) -> bool {
    matches!(json, Json::Number(_) | Json::Null)
}

/// Converts a JSON number; null becomes NaN.
fn number(json: &Json) -> f64 {
    json.as_f64().unwrap_or(f64::NAN)
}

/// Returns an object's member at an index; null if there is none.
fn member_at(value: &Json, index: usize) -> &Json {
    match value {
        Json::Object(members) => members.values().nth(index).unwrap_or(&NULL),
        _ => &NULL,
    }
}

/// Returns booleans as ones and zeros; `None` unless all leaves are booleans.
fn truth_values(leaves: &[&Json]) -> Option<Vec<f64>> {
    let mut numbers = Vec::with_capacity(leaves.len());
    for leaf in leaves {
        numbers.push(f64::from(u8::from(leaf.as_bool()?)));
    }
    Some(numbers)
}

/// Returns the leaves' common length if all are equally long lists of numbers; null counts as a
/// missing list. `None` otherwise, and if the lists are empty.
fn row_length(leaves: &[&Json]) -> Option<usize> {
    let length = leaves
        .iter()
        .find_map(|leaf| Some(leaf.as_array()?.len()))?;
    let are_rows = leaves.iter().all(|leaf| match leaf {
        Json::Array(list) => list.len() == length && list.iter().all(is_number),
        leaf => leaf.is_null(),
    });
    if length == 0 || !are_rows {
        return None;
    }
    Some(length)
}

/// Returns the distinct member names of all objects, in order of appearance.
fn names_of<'j>(objects: &[&'j Json]) -> Vec<&'j str> {
    let mut names: Vec<&str> = Vec::new();
    for object in objects {
        let Json::Object(members) = object else {
            continue;
        };
        for name in members.keys() {
            if !names.contains(&name.as_str()) {
                names.push(name);
            }
        }
    }
    names
}

/// Returns an array's dimensions in MATLAB, at least two; a list becomes a column.
fn matlab_shape(shape: &[usize]) -> Vec<usize> {
    if let [length] = shape {
        vec![*length, 1]
    } else {
        shape.to_vec()
    }
}

fn array(shape: &[usize], numbers: Vec<f64>, kind: ElementKind) -> Value {
    let shape = matlab_shape(shape);
    Value::Array(Array {
        re: first_index_fastest(&shape, numbers),
        kind,
        im: None,
        shape,
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::export::matlab_values::{column, matrix};

    const LAYOUT: Layout = Layout {
        by_channel: &["inputs"],
        by_model_name: &["ratios"],
        gathered_lists: &["table"],
    };

    fn field(json: &str, path: &[&str]) -> Value {
        let json: Json = serde_json::from_str(json).unwrap();
        path.iter().fold(LAYOUT.value("", &json), |value, name| {
            let Value::Struct(records) = value else {
                panic!("{name} of {value:?}")
            };
            records.field(name).unwrap()[0].clone()
        })
    }

    #[test]
    fn tables_are_matrices_and_null_is_nan() {
        let Value::Array(table) = field("{\"G\": [[1, 2, 3], [4, null, 6]]}", &["G"]) else {
            panic!("an array")
        };
        assert_eq!(
            (table.shape, &table.re[..3]),
            (vec![2, 3], &[1.0, 4.0, 2.0][..])
        );
        assert!(table.re[3].is_nan());
        assert_eq!(field("{\"band\": [1, 2]}", &["band"]), row([1.0, 2.0]));
    }

    #[test]
    fn objects_by_channel_are_arrays_in_their_order() {
        let json = "{\"inputs\": {\"Z\": {\"u\": 1, \"ends\": [1, 2]}, \"A\": {\"u\": 2, \"ends\": null}}}";
        assert_eq!(field(json, &["inputs", "u"]), column([1.0, 2.0]));
        let Value::Array(ends) = field(json, &["inputs", "ends"]) else {
            panic!("an array")
        };
        assert_eq!(
            (ends.shape, &ends.re[..1], ends.re[2]),
            (vec![2, 2], &[1.0][..], 2.0)
        );
        let rows =
            "{\"table\": [{\"inputs\": {\"Z\": 1, \"A\": 2}}, {\"inputs\": {\"Z\": 3, \"A\": 4}}]}";
        assert_eq!(
            field(rows, &["table", "inputs"]),
            matrix(2, 2, vec![1.0, 3.0, 2.0, 4.0])
        );
    }

    #[test]
    fn records_that_lack_a_field_have_it_empty_and_names_are_valid() {
        let json = "{\"of\": [{\"a\": true}, {\"2 b\": [[\"P\", \"LAT\"], [\"Q\", \"LON\"]]}]}";
        let Value::Struct(of) = field(json, &["of"]) else {
            panic!("structs")
        };
        assert_eq!(of.shape, [1, 2]);
        assert_eq!(
            of.field("a").unwrap(),
            [Value::truth(true), matrix(0, 0, Vec::new())]
        );
        let Value::Cell(pairs) = &of.field("x2_b").unwrap()[1] else {
            panic!("cells")
        };
        assert_eq!(
            (&pairs.shape, &pairs.values[1]),
            (&vec![2, 2], &Value::text("Q"))
        );
        let names = field(
            "{\"ratios\": {\"V+5kt\": 1, \"V-5kt\": 2}}",
            &["ratios", "name"],
        );
        assert_eq!(names, cell_of_texts(["V+5kt", "V-5kt"].map(str::to_owned)));
    }
}
