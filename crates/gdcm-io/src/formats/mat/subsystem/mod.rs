//! MATLAB class objects, stored in a separate part of the file: the cells of a `FileWrapper__`.
//!
//! The first cell lists the objects and the cell of each of their properties; the last cells are
//! shared by all objects of a class. The format is not published by The MathWorks; it is known from
//! the descriptions of the MatFileHandler, matio (Python) and MAT.jl projects. It is the same in
//! files up to version 7 and in files of version 7.3 (HDF5).

mod instance;

use std::collections::HashMap;

use crate::formats::mat::FieldPath;
use crate::formats::mat::level5::{ByteOrder, name_of};
use crate::formats::mat::matrix::unread_because;
use crate::formats::strides::count;
use crate::formats::variables::{ElementKind, Object, StructArray, TextArray, Value};
use crate::reading_budget::{ReadingBudget, VariableFault};

/// The objects of a file.
#[derive(Clone, Debug)]
pub struct Subsystem {
    directory: Directory,
    /// The values of all properties, in the order of the directory.
    values: Vec<Value>,
    /// Default property values, one record for each class.
    defaults: Vec<Value>,
    /// Exact values of cells with 64-bit integers.
    long_words: HashMap<usize, Vec<u64>>,
}

/// Number of cells before the property values.
const BEFORE_VALUES: usize = 2;

impl Subsystem {
    /// Reads the cells of a `FileWrapper__`; the first holds the bytes of its directory.
    pub fn new(cells: Vec<Value>, budget: &ReadingBudget<'_>) -> Result<Self, VariableFault> {
        let bytes = directory_bytes(cells.first())?;
        // An empty name takes one byte of the file and a whole `String` in memory.
        budget.take(bytes.len() as u64, 2 * size_of::<String>() as u64, "")?;
        let directory = Directory::read(&bytes)?;
        let mut values = cells;
        let defaults = match values.pop() {
            Some(Value::Cell(defaults)) => defaults.values,
            _ => Vec::new(),
        };
        let shared = directory.cells_behind_values.saturating_sub(1);
        values.truncate(values.len().saturating_sub(shared));
        Ok(Self {
            directory,
            values: values.split_off(BEFORE_VALUES.min(values.len())),
            defaults,
            long_words: HashMap::new(),
        })
    }

    /// Adds the exact values of some cells: `string` objects are packed into 64-bit integers, of
    /// which a [`Value`] keeps 53 bits. Each item has the index of its cell, counted from 0.
    pub fn with_long_words(mut self, cells: impl IntoIterator<Item = (usize, Vec<u64>)>) -> Self {
        let values = cells
            .into_iter()
            .filter_map(|(cell, words)| Some((cell.checked_sub(BEFORE_VALUES)?, words)));
        self.long_words = values.collect();
        self
    }

    /// Returns the object, or the array of objects, for a reference: `[0xDD000000, number of
    /// dimensions, dimensions, numbers of the objects, number of the class]`.
    ///
    /// Parts that cannot be decoded are [`Value::Opaque`]; only the budget causes a fault.
    pub fn object(
        &self,
        reference: &[u32],
        variable: &str,
        budget: &ReadingBudget<'_>,
    ) -> Result<Value, VariableFault> {
        match Reference::parse(reference) {
            Some(reference) => self.referred(&reference, &FieldPath::start(variable), budget),
            None => Ok(unread_because(
                "object",
                "what refers to it is damaged",
                variable,
            )),
        }
    }
}

fn directory_bytes(cell: Option<&Value>) -> Result<Vec<u8>, VariableFault> {
    let Some(Value::Array(array)) = cell else {
        return Err(damaged("the directory of objects is missing"));
    };
    let byte = |&number: &f64| {
        if (0.0..256.0).contains(&number) {
            Some(number as u8)
        } else {
            None
        }
    };
    let bytes: Option<Vec<u8>> = array.re.iter().map(byte).collect();
    bytes.ok_or_else(|| damaged("the directory of objects does not consist of bytes"))
}

fn damaged(what: impl Into<String>) -> VariableFault {
    VariableFault::damaged("", what, 0)
}

// Directory of the objects and the positions of their properties.

/// Bytes before the names: version, number of names, and the offsets of eight regions.
const HEADER_BYTES: usize = 40;
/// Newest known layout version.
const NEWEST: u32 = 4;

/// Directory of the objects and the positions of their properties.
#[derive(Clone, Debug)]
pub(super) struct Directory {
    /// Names of properties and classes, counted from 1; 0 means none.
    names: Vec<String>,
    /// Names of the classes, also counted from 1.
    classes: Vec<String>,
    objects: Vec<Entry>,
    /// Properties of objects saved as another value that their class creates.
    made: Vec<Vec<Property>>,
    /// Properties of all other objects.
    plain: Vec<Vec<Property>>,
    /// Number of cells after the property values.
    pub(super) cells_behind_values: usize,
}

/// One object.
#[derive(Clone, Copy, Debug)]
struct Entry {
    class: u32,
    made: u32,
    plain: u32,
}

/// One property of an object.
#[derive(Clone, Copy, Debug)]
pub(super) struct Property {
    pub(super) name: u32,
    pub(super) content: Content,
}

/// Location of a property value.
#[derive(Clone, Copy, Debug)]
pub(super) enum Content {
    /// The value is a name.
    Name(u32),
    /// The value is in a cell, counted from the first cell with a value.
    Cell(usize),
    /// The value is this number.
    Number(u32),
}

impl Directory {
    /// Reads the bytes of the first cell.
    pub(super) fn read(bytes: &[u8]) -> Result<Self, VariableFault> {
        let words = |order: ByteOrder| -> Vec<u32> {
            bytes
                .get(..HEADER_BYTES)
                .unwrap_or_default()
                .as_chunks()
                .0
                .iter()
                .map(|&word| order.u32(word))
                .collect()
        };
        let little = words(ByteOrder::Little);
        let big = words(ByteOrder::Big);
        // A version is a small number and becomes large in the wrong byte order.
        let is_little = little.first() <= big.first();
        let (order, head) = if is_little {
            (ByteOrder::Little, little)
        } else {
            (ByteOrder::Big, big)
        };
        let [version, count, regions @ ..] = head.as_slice() else {
            return Err(damaged("the directory of objects is cut off"));
        };
        if !(1..=NEWEST).contains(version) {
            return Err(damaged(format!(
                "the directory of objects has the unknown version {version}"
            )));
        }
        let region = |number: usize| region(bytes, regions, number, order);
        let first = regions.first().map_or(0, |&at| at as usize);
        let names = bytes
            .get(HEADER_BYTES..first)
            .ok_or_else(|| damaged("the names of objects are cut off"))?;
        let names = names
            .split(|&byte| byte == 0)
            .take(*count as usize)
            .map(name_of)
            .collect();
        let cells_behind_values = match version {
            4 => 3,
            3 => 2,
            _ => 1,
        };
        let mut directory = Directory {
            classes: Vec::new(),
            names,
            cells_behind_values,
            ..Directory::without_names(&region)?
        };
        directory.classes = region(0)?
            .chunks_exact(4)
            .map(|class| directory.class_of(class))
            .collect();
        Ok(directory)
    }

    fn without_names(
        region: &dyn Fn(usize) -> Result<Vec<u32>, VariableFault>,
    ) -> Result<Self, VariableFault> {
        let entry = |words: &[u32]| match *words {
            [class, _, _, made, plain, _] => Some(Entry { class, made, plain }),
            _ => None,
        };
        Ok(Directory {
            names: Vec::new(),
            classes: Vec::new(),
            objects: region(2)?.chunks_exact(6).filter_map(entry).collect(),
            made: properties(&region(1)?)?,
            plain: properties(&region(3)?)?,
            cells_behind_values: 0,
        })
    }

    /// Returns the class name: its package and its own name.
    fn class_of(&self, words: &[u32]) -> String {
        let name = |at: usize| {
            words
                .get(at)
                .and_then(|&number| self.name(number))
                .unwrap_or_default()
        };
        match (name(0), name(1)) {
            ("", name) => name.to_owned(),
            (package, name) => format!("{package}.{name}"),
        }
    }

    /// Returns the name of a property or a class.
    pub(super) fn name(&self, number: u32) -> Option<&str> {
        self.names
            .get((number as usize).checked_sub(1)?)
            .map(String::as_str)
    }

    /// Returns the name of a class.
    pub(super) fn class(&self, number: u32) -> Option<&str> {
        if number == 0 {
            None
        } else {
            self.classes.get(number as usize).map(String::as_str)
        }
    }

    /// Returns the class of an object and its properties.
    pub(super) fn object(&self, number: u32) -> Option<(u32, &[Property])> {
        let entry = self.objects.get(number as usize)?;
        let (list, at) = if entry.made == 0 {
            (&self.plain, entry.plain)
        } else {
            (&self.made, entry.made)
        };
        Some((entry.class, list.get(at as usize)?.as_slice()))
    }

    /// Whether an object with this number exists; 0 marks a deleted object.
    pub(super) fn has_object(&self, number: u32) -> bool {
        number == 0 || (number as usize) < self.objects.len()
    }
}

fn region(
    bytes: &[u8],
    regions: &[u32],
    number: usize,
    order: ByteOrder,
) -> Result<Vec<u32>, VariableFault> {
    let bounds = regions.get(number).zip(regions.get(number + 1));
    let region = bounds.and_then(|(&from, &to)| bytes.get(from as usize..to as usize));
    let region =
        region.ok_or_else(|| damaged("a part of the directory of objects lies outside it"))?;
    Ok(region
        .as_chunks()
        .0
        .iter()
        .map(|&word| order.u32(word))
        .collect())
}

/// Reads consecutive property lists, each preceded by its length and padded to eight bytes.
fn properties(region: &[u32]) -> Result<Vec<Vec<Property>>, VariableFault> {
    let mut lists = Vec::new();
    let mut rest = region;
    while let [count, after @ ..] = rest {
        let length = (*count as usize).saturating_mul(3);
        let (list, after) = after
            .split_at_checked(length)
            .ok_or_else(|| damaged("the properties of an object are cut off"))?;
        lists.push(list.chunks_exact(3).filter_map(property).collect());
        rest = after.get((length + 1) % 2..).unwrap_or_default();
    }
    Ok(lists)
}

fn property(words: &[u32]) -> Option<Property> {
    let &[name, kind, value] = words else {
        return None;
    };
    let content = match kind {
        0 => Content::Name(value),
        1 => Content::Cell(value as usize),
        _ => Content::Number(value),
    };
    Some(Property { name, content })
}

// Texts of a `string` object, packed into 64-bit integers.

/// The only known version of the packing.
const VERSION: u64 = 1;
/// Length that marks a missing text.
const MISSING: u64 = u64::MAX;

/// Unpacks the texts from version, number of dimensions, dimensions, lengths and UTF-16 units, four
/// to a number; `None` for other numbers. A missing text is read as an empty text.
pub(super) fn packed_text(
    words: &[u64],
    budget: &ReadingBudget<'_>,
) -> Result<Option<TextArray>, VariableFault> {
    budget.take(words.len() as u64, 64, "")?;
    Ok(unpacked(words))
}

fn unpacked(words: &[u64]) -> Option<TextArray> {
    let [VERSION, dimensions, rest @ ..] = words else {
        return None;
    };
    let (shape, rest) = rest.split_at_checked(usize::try_from(*dimensions).ok()?)?;
    let shape: Vec<usize> = shape
        .iter()
        .map(|&length| usize::try_from(length).ok())
        .collect::<Option<_>>()?;
    let count = shape
        .iter()
        .try_fold(1_usize, |product, &length| product.checked_mul(length))?;
    let (lengths, rest) = rest.split_at_checked(count)?;
    let units: Vec<u16> = rest
        .iter()
        .flat_map(|word| [0, 16, 32, 48].map(|shift| (word >> shift) as u16))
        .collect();
    let mut rest = units.as_slice();
    let mut texts = Vec::new();
    for &length in lengths {
        let length = if length == MISSING {
            0
        } else {
            usize::try_from(length).ok()?
        };
        let (text, after) = rest.split_at_checked(length)?;
        texts.push(String::from_utf16_lossy(text));
        rest = after;
    }
    Some(TextArray { shape, texts })
}

// References to objects.

/// First number of every reference.
const REFERENCE: u32 = 0xdd00_0000;

/// A reference to objects.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(in crate::formats::mat) struct Reference {
    /// Number of objects along each dimension.
    pub(super) shape: Vec<usize>,
    /// Number of each object, first index fastest.
    pub(super) objects: Vec<u32>,
    /// Number of the class.
    pub(super) class: u32,
}

impl Reference {
    /// Parses `[0xDD000000, number of dimensions, dimensions, numbers of the objects, number of the
    /// class]`.
    pub(super) fn parse(words: &[u32]) -> Option<Self> {
        let [REFERENCE, dimensions, rest @ ..] = words else {
            return None;
        };
        let (shape, rest) = rest.split_at_checked(*dimensions as usize)?;
        let shape: Vec<usize> = shape.iter().map(|&length| length as usize).collect();
        let (&class, objects) = rest.split_last()?;
        let is_whole = shape.len() >= 2 && count(&shape)? == objects.len();
        is_whole.then(|| Self {
            shape,
            objects: objects.to_vec(),
            class,
        })
    }

    /// Returns the reference in a value: a column of integers.
    pub(in crate::formats::mat) fn of(value: &Value) -> Option<Self> {
        let Value::Array(array) = value else {
            return None;
        };
        let begins = array.re.first() == Some(&f64::from(REFERENCE));
        if !begins
            || array.kind != ElementKind::Integer
            || array.shape.get(1) != Some(&1)
            || array.im.is_some()
        {
            return None;
        }
        let word = |&number: &f64| {
            if (0.0..=f64::from(u32::MAX)).contains(&number) {
                Some(number as u32)
            } else {
                None
            }
        };
        let words: Option<Vec<u32>> = array.re.iter().map(word).collect();
        Self::parse(&words?)
    }
}

// Enumeration members.

/// Field that marks a record as enumeration members.
const TAG: &str = "EnumerationInstanceTag";
/// Property with the name of the member.
const MEMBER: &str = "Name";

/// Whether the records are enumeration members.
pub(super) fn is_enumeration(records: &StructArray) -> bool {
    records.field(TAG).is_some()
}

impl Subsystem {
    /// Converts enumeration members to objects whose only property is the member's name.
    pub(in crate::formats::mat) fn enumeration(
        &self,
        records: &StructArray,
        class: &str,
        trail: &FieldPath<'_>,
        budget: &ReadingBudget<'_>,
    ) -> Result<Value, VariableFault> {
        let number = numbers(records, "ClassName").and_then(|numbers| numbers.first().copied());
        let class = number
            .and_then(|number| self.directory.class(number))
            .unwrap_or(class);
        let opaque = || {
            unread_because(
                class,
                "the members of the enumeration are not read",
                &trail.words(),
            )
        };
        let names = numbers(records, "ValueNames").unwrap_or_default();
        let Some([Value::Array(indices)]) = records.field("ValueIndices") else {
            return Ok(opaque());
        };
        let name = |&index: &f64| self.directory.name(*names.get(index as usize)?);
        let Some(members) = indices.re.iter().map(name).collect::<Option<Vec<_>>>() else {
            return Ok(opaque());
        };
        let bytes = members.iter().map(|name| name.len() as u64 + 256).sum();
        budget
            .take(1, bytes, "")
            .map_err(|fault| trail.name(fault))?;
        let fields = vec![(
            MEMBER.to_owned(),
            members.iter().copied().map(Value::text).collect(),
        )];
        let records = StructArray {
            shape: indices.shape.clone(),
            fields,
        };
        Ok(Value::Object(Object {
            class: class.to_owned(),
            records,
        }))
    }
}

fn numbers(records: &StructArray, field: &str) -> Option<Vec<u32>> {
    match records.field(field)? {
        [Value::Array(array)] => Some(array.re.iter().map(|&number| number as u32).collect()),
        _ => None,
    }
}

#[cfg(test)]
mod subsystem_tests {
    use proptest::prelude::*;

    use super::*;
    use crate::formats::mat::read;
    use crate::formats::mat::sample_tests::{
        Directory, chars, column, doubles, file_with_objects, long_words_of, opaque, record,
        reference, words_of,
    };
    use crate::formats::variables::{Array, StructArray, TextArray};

    const NAMES: [&str; 12] = [
        "ss", "ssdata", "ltipack", "string", "node", "Data_", "Name_", "any", "a", "self", "Mode_",
        "Flag_",
    ];

    /// A model with data and a name, a text, and an object that contains itself.
    fn directory(version: u32) -> Directory<'static> {
        Directory {
            version,
            names: &NAMES,
            classes: &[[0, 1], [3, 2], [0, 4], [0, 5]],
            made: &[&[[8, 1, 1]]],
            objects: &[[1, 0, 1], [2, 0, 2], [3, 1, 0], [4, 0, 3]],
            plain: &[
                &[[6, 1, 0], [7, 1, 4], [11, 0, 9], [12, 2, 1]],
                &[[9, 1, 2]],
                &[[10, 1, 3]],
            ],
        }
    }

    fn cells(version: u32) -> Vec<Vec<u8>> {
        let text = [1, 2, 1, 1, 5, 0x006f_0074_006f_0072, 0x72];
        let defaults = record(
            "",
            &[
                ("Version_", doubles("", &[1, 1], &[17.0])),
                ("Name_", chars("", "none")),
            ],
        );
        let empty = doubles("", &[0, 0], &[]);
        let mut cells = vec![
            directory(version).cell(),
            empty.clone(),
            column(&[reference(&[2], 2)]),
            long_words_of(&text),
            doubles("", &[1, 2], &[1.0, 2.0]),
            reference(&[4], 4),
            reference(&[3], 3),
        ];
        cells.extend((2..version).map(|_| empty.clone()));
        cells.push(column(&[
            empty.clone(),
            defaults,
            empty.clone(),
            empty.clone(),
            empty,
        ]));
        cells
    }

    fn file(version: u32) -> Vec<u8> {
        let variables = [
            opaque("sys", "ss", reference(&[1], 1)),
            opaque("two", "ss", reference(&[1, 0], 1)),
            opaque("ring", "node", reference(&[4], 4)),
            opaque("lost", "node", reference(&[9], 4)),
            doubles("x", &[1, 1], &[3.0]),
        ];
        file_with_objects(&variables.concat(), Some(&cells(version)))
    }

    fn values(bytes: &[u8]) -> HashMap<String, Value> {
        let variables = read(bytes, &ReadingBudget::new(1 << 20)).unwrap();
        variables
            .into_iter()
            .map(|variable| (variable.name, variable.value))
            .collect()
    }

    fn records(value: &Value) -> &StructArray {
        match value {
            Value::Object(object) => &object.records,
            other => panic!("{other:?}"),
        }
    }

    #[test]
    fn an_object_has_its_own_properties_and_those_of_its_class() {
        for version in 2..=4 {
            let values = values(&file(version));
            let model = records(&values["sys"]);
            let names: Vec<&str> = model.fields.iter().map(|(name, _)| name.as_str()).collect();
            assert_eq!(names, ["Data_", "Name_", "Mode_", "Flag_", "Version_"]);
            assert_eq!(
                model.field("Version_").unwrap()[0],
                Value::Array(Array::matrix(1, 1, vec![17.0]))
            );
            let text = |text: &str| {
                Value::Text(TextArray {
                    shape: vec![1, 1],
                    texts: vec![text.to_owned()],
                })
            };
            assert_eq!(model.field("Name_").unwrap()[0], text("rotor"));
            assert_eq!(model.field("Mode_").unwrap()[0], text("a"));
            let Value::Array(flag) = &model.field("Flag_").unwrap()[0] else {
                panic!()
            };
            assert_eq!(flag.re, [1.0]);
        }
    }

    #[test]
    fn objects_within_objects_are_put_in_their_places() {
        let values = values(&file(4));
        let Value::Cell(data) = &records(&values["sys"]).field("Data_").unwrap()[0] else {
            panic!()
        };
        let Value::Object(data) = &data.values[0] else {
            panic!()
        };
        assert_eq!(data.class, "ltipack.ssdata");
        assert_eq!(
            data.records.field("a").unwrap()[0],
            Value::Array(Array::matrix(1, 2, vec![1.0, 2.0]))
        );
    }

    #[test]
    fn a_deleted_object_of_an_array_has_empty_properties() {
        let values = values(&file(4));
        let two = records(&values["two"]);
        assert_eq!(two.shape, [1, 2]);
        assert_eq!(
            two.field("Name_").unwrap()[1],
            Value::Array(Array::matrix(0, 0, Vec::new()))
        );
    }

    #[test]
    fn an_object_that_lies_in_itself_is_cut() {
        let values = values(&file(4));
        let Value::Opaque { class, why } = &records(&values["ring"]).field("self").unwrap()[0]
        else {
            panic!()
        };
        assert_eq!(class, "node");
        assert!(
            why.contains("itself") && why.contains("struct(ring.self)"),
            "{why}"
        );
    }

    #[test]
    fn what_cannot_be_decoded_leaves_the_other_variables_alone() {
        let values = values(&file(4));
        assert!(matches!(&values["lost"], Value::Opaque { .. }));
        assert_eq!(values["x"], Value::Array(Array::matrix(1, 1, vec![3.0])));
        let unknown = self::values(&file(9));
        let Value::Opaque { class, why } = &unknown["sys"] else {
            panic!()
        };
        assert_eq!(class, "ss");
        assert!(
            why.contains("unknown version 9") && why.contains("ssdata(sys)"),
            "{why}"
        );
        assert!(unknown.contains_key("x"));
    }

    #[test]
    fn members_of_an_enumeration_are_known_by_name() {
        let fields = [
            ("EnumerationInstanceTag", words_of(&[0xdd00_0000])),
            ("ClassName", words_of(&[4])),
            ("ValueNames", words_of(&[9, 10])),
            ("ValueIndices", words_of(&[1, 0, 1])),
        ];
        let variable = opaque("mode", "node", record("", &fields));
        let values = values(&file_with_objects(&variable, Some(&cells(4))));
        let texts =
            records(&values["mode"])
                .field("Name")
                .unwrap()
                .iter()
                .map(|value| match value {
                    Value::Text(text) => text.texts[0].as_str(),
                    other => panic!("{other:?}"),
                });
        assert_eq!(texts.collect::<Vec<_>>(), ["self", "a", "self"]);
    }

    #[test]
    fn strings_whose_words_lost_no_digits_are_read_without_the_long_words() {
        let words = [1.0, 2.0, 1.0, 1.0, 2.0, f64::from(0x62_u32 << 16 | 0x61)];
        let bytes = directory(2).cell();
        let directory = values(&file_with_objects(
            &crate::formats::mat::sample_tests::record("d", &[("d", bytes)]),
            None,
        ));
        let Value::Struct(record) = &directory["d"] else {
            panic!()
        };
        let directory = record.field("d").unwrap()[0].clone();
        let empty = || Value::Array(Array::matrix(0, 0, Vec::new()));
        let text = Value::Array(Array::matrix(1, 6, words.to_vec()));
        let cells = vec![directory, empty(), empty(), text, empty()];
        let subsystem = Subsystem::new(cells, &ReadingBudget::new(1 << 20)).unwrap();
        let budget = ReadingBudget::new(1 << 16);
        let found = subsystem.object(&[0xdd00_0000, 2, 1, 1, 3, 3], "t", &budget);
        assert_eq!(
            found,
            Ok(Value::Text(TextArray {
                shape: vec![1, 1],
                texts: vec!["ab".to_owned()]
            }))
        );
        assert!(matches!(
            subsystem.object(&[1, 2, 3], "t", &budget),
            Ok(Value::Opaque { .. })
        ));
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(400))]
        #[test]
        fn changed_bytes_never_panic(
            changes in prop::collection::vec((any::<prop::sample::Index>(), any::<u8>()), 1..4),
        ) {
            let mut bytes = file(4);
            for (at, byte) in changes {
                let at = at.index(bytes.len());
                bytes[at] ^= byte;
            }
            let _ = read(&bytes, &ReadingBudget::new(1 << 20));
        }
    }

    #[test]
    fn a_file_cut_off_anywhere_never_panics() {
        let bytes = file(4);
        for length in 0..bytes.len() {
            let _ = read(&bytes[..length], &ReadingBudget::new(1 << 20));
        }
    }
}

#[cfg(test)]
mod packed_text_tests {
    use super::*;

    #[test]
    fn texts_follow_one_another_without_gaps() {
        let units: Vec<u16> = "abcde".encode_utf16().collect();
        let word = |units: &[u16]| {
            units
                .iter()
                .rev()
                .fold(0_u64, |word, &unit| (word << 16) | u64::from(unit))
        };
        let words = [
            1,
            2,
            1,
            3,
            3,
            MISSING,
            2,
            word(&units[..4]),
            word(&units[4..]),
        ];
        let texts = ["abc", "", "de"].map(str::to_owned).to_vec();
        assert_eq!(
            unpacked(&words),
            Some(TextArray {
                shape: vec![1, 3],
                texts
            })
        );
    }

    #[test]
    fn other_numbers_are_no_texts() {
        for words in [
            &[][..],
            &[2, 2, 1, 1, 0],
            &[1, 2, 1, 1, 5, 0],
            &[1, 9, 1],
            &[1, 2, u64::MAX, 2, 0],
        ] {
            assert_eq!(unpacked(words), None);
        }
    }
}

#[cfg(test)]
mod reference_tests {
    use super::*;
    use crate::formats::variables::Array;

    #[test]
    fn a_reference_names_its_objects_and_their_class() {
        let reference = Reference::parse(&[REFERENCE, 2, 1, 2, 7, 8, 3]);
        assert_eq!(
            reference,
            Some(Reference {
                shape: vec![1, 2],
                objects: vec![7, 8],
                class: 3
            })
        );
    }

    #[test]
    fn what_does_not_fit_its_own_sizes_is_no_reference() {
        for words in [
            &[REFERENCE, 2, 1, 2, 7, 3][..],
            &[REFERENCE, 9, 1, 1, 1, 1],
            &[1, 2, 1, 1, 1, 1],
            &[],
        ] {
            assert_eq!(Reference::parse(words), None);
        }
        assert_eq!(
            Reference::parse(&[REFERENCE, 4, u32::MAX, u32::MAX, u32::MAX, 0, 1]),
            None
        );
    }

    #[test]
    fn ordinary_numbers_are_no_reference_even_if_they_look_like_one() {
        let numbers = Array::matrix(6, 1, [REFERENCE, 2, 1, 1, 1, 1].map(f64::from).to_vec());
        assert_eq!(Reference::of(&Value::Array(numbers.clone())), None);
        let integers = Array {
            kind: ElementKind::Integer,
            ..numbers
        };
        assert!(Reference::of(&Value::Array(integers)).is_some());
    }
}
