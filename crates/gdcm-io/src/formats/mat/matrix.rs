//! One array of a file with its contents.
//!
//! Source: "MAT-File Format", The MathWorks, "miMATRIX Format".

use crate::formats::mat::level5::{Cursor, DataKind, Element, behind, matrix};
use crate::formats::mat::subsystem::{Reference, Subsystem};
use crate::formats::mat::{ArrayClass, FieldPath, Header, Step, count, export_line};
use crate::formats::strides::Entries;
use crate::formats::variables::{Array, CellArray, Object, RECORD, StructArray, TextArray, Value};
use crate::reading_budget::{ReadingBudget, VariableFault};

/// Shared state for reading arrays.
#[derive(Clone, Copy)]
pub(super) struct Arrays<'a> {
    pub(super) budget: &'a ReadingBudget<'a>,
    /// The objects of the file, or the reason why they cannot be read.
    pub(super) objects: Result<&'a Subsystem, &'a str>,
}

impl Arrays<'_> {
    /// Reads the contents of an array after its header.
    pub(super) fn contents(
        &self,
        header: &Header,
        contents: &mut Cursor<'_>,
        trail: &FieldPath<'_>,
    ) -> Result<Value, VariableFault> {
        let value = match header.class {
            ArrayClass::Float | ArrayClass::Integer => {
                self.array(header, contents).map(Value::Array)
            }
            ArrayClass::Sparse => self.sparse(header, contents).map(Value::Array),
            ArrayClass::Char => Element::read(contents)
                .and_then(|element| text(&element, &header.shape, self.budget))
                .map(Value::Text),
            ArrayClass::Cell => self.cell(header, contents, trail).map(Value::Cell),
            ArrayClass::Struct => self.records(header, contents, trail).map(Value::Struct),
            ArrayClass::Object => self.object(header, contents, trail).map(Value::Object),
            ArrayClass::FunctionHandle => {
                Element::pass_all(contents).map(|()| unread("function_handle", trail))
            }
            ArrayClass::Opaque => opaque_value(self, contents, trail),
        };
        value.map_err(|fault| trail.name(fault))
    }

    /// Reads the next array nested in another array.
    pub(super) fn inner(
        &self,
        contents: &mut Cursor<'_>,
        trail: &FieldPath<'_>,
    ) -> Result<Value, VariableFault> {
        let value = self.next(contents, trail);
        value.map_err(|fault| trail.name(fault))
    }

    fn next(
        &self,
        contents: &mut Cursor<'_>,
        trail: &FieldPath<'_>,
    ) -> Result<Value, VariableFault> {
        let start = *contents;
        let element = Element::read(contents)?;
        let mut data = matrix(element)?;
        if data.is_empty() {
            return Ok(Value::empty());
        }
        let header = Header::read(&mut data, self.budget)?;
        let value = self.contents(&header, &mut data, trail)?;
        *contents = behind(start, element, data, *contents)?;
        Ok(value)
    }

    fn array(&self, header: &Header, contents: &mut Cursor<'_>) -> Result<Array, VariableFault> {
        let count = header.count;
        let re = numbers(&Element::read(contents)?, count, self.budget)?;
        let im = if header.complex {
            Some(numbers(&Element::read(contents)?, count, self.budget)?)
        } else {
            None
        };
        Ok(Array {
            shape: header.shape.clone(),
            kind: header.element_kind(),
            re,
            im,
        })
    }

    fn sparse(&self, header: &Header, contents: &mut Cursor<'_>) -> Result<Array, VariableFault> {
        let start = *contents;
        let &[height, width] = header.shape.as_slice() else {
            return Err(start.damaged("a sparse array that is no matrix"));
        };
        let rows = places(&Element::read(contents)?, self.budget)?;
        let starts = places(&Element::read(contents)?, self.budget)?;
        let stored = starts.last().copied().unwrap_or(0);
        let mut part = || {
            let mut element = Element::read(contents)?;
            // MATLAB announces eight bytes for each logical value of a sparse matrix, and writes
            // one.
            if header.logical
                && element.kind == DataKind::F64
                && element.data.len() < stored.saturating_mul(8)
            {
                element.kind = DataKind::U8;
            }
            numbers(&element, element.count()?, self.budget)
        };
        let re = part()?;
        let im = if header.complex { Some(part()?) } else { None };
        self.budget.take(stored as u64, 8, "")?;
        Entries::of_columns(
            [height, width],
            header.element_kind(),
            rows,
            &starts,
            (re, im),
        )
        .ok_or_else(|| start.damaged("a sparse matrix whose columns do not fit its numbers"))?
        .filled("", self.budget, || {
            start.damaged("a number outside its sparse matrix")
        })
    }

    fn cell(
        &self,
        header: &Header,
        contents: &mut Cursor<'_>,
        trail: &FieldPath<'_>,
    ) -> Result<CellArray, VariableFault> {
        let count = self.room(header.count, contents)?;
        let values = (0..count).map(|at| self.inner(contents, &trail.step(Step::Cell(at))?));
        Ok(CellArray {
            shape: header.shape.clone(),
            values: values.collect::<Result<_, _>>()?,
        })
    }

    fn object(
        &self,
        header: &Header,
        contents: &mut Cursor<'_>,
        trail: &FieldPath<'_>,
    ) -> Result<Object, VariableFault> {
        let class = Element::read(contents)?.name()?;
        Ok(Object {
            class,
            records: self.records(header, contents, trail)?,
        })
    }

    fn records(
        &self,
        header: &Header,
        contents: &mut Cursor<'_>,
        trail: &FieldPath<'_>,
    ) -> Result<StructArray, VariableFault> {
        let names = field_names(contents, self.budget)?;
        let count = header.count;
        self.room(count.saturating_mul(names.len()), contents)?;
        // Records without fields can be announced in any number with a few bytes.
        self.budget.take(count as u64, RECORD, "")?;
        let mut fields: Vec<(String, Vec<Value>)> = Vec::with_capacity(names.len());
        for name in names {
            fields.push((name, Vec::new()));
        }
        // Without fields no records are created.
        let records = if fields.is_empty() { 0 } else { count };
        for at in 0..records {
            let record = trail.step(Step::Record(at))?;
            let trail = if count == 1 { trail } else { &record };
            for (name, values) in &mut fields {
                values.push(self.inner(contents, &trail.step(Step::Field(name))?)?);
            }
        }
        Ok(StructArray {
            shape: header.shape.clone(),
            fields,
        })
    }

    /// Budgets `count` values, each of at least eight bytes in the file.
    fn room(&self, count: usize, contents: &Cursor<'_>) -> Result<usize, VariableFault> {
        if count > contents.len() / 8 {
            return Err(contents.damaged(format!("{count} values in {} bytes", contents.len())));
        }
        // Vectors grow by doubling.
        self.budget
            .take(count as u64, 2 * size_of::<Value>() as u64, "")?;
        Ok(count)
    }
}

/// Reads the field names, which precede the records.
pub(super) fn field_names(
    contents: &mut Cursor<'_>,
    budget: &ReadingBudget<'_>,
) -> Result<Vec<String>, VariableFault> {
    let lengths = Element::read(contents)?;
    let &[length] = places(&lengths, budget)?.as_slice() else {
        return Err(lengths
            .data
            .damaged("records without a length of their names"));
    };
    let names = Element::read(contents)?;
    let bytes = names.data.rest();
    if (length == 0 && !bytes.is_empty()) || (length != 0 && !bytes.len().is_multiple_of(length)) {
        return Err(names
            .data
            .damaged("names of fields that do not fit their length"));
    }
    budget.take((bytes.len() / length.max(1)) as u64, 128, "")?;
    let mut seen = std::collections::HashSet::new();
    let mut found = Vec::new();
    for name in bytes
        .chunks_exact(length.max(1))
        .map(crate::formats::mat::level5::name_of)
    {
        if !seen.insert(name.clone()) {
            return Err(VariableFault::Duplicate { name });
        }
        found.push(name);
    }
    Ok(found)
}

// Numbers of a data element in any stored type.

/// Reads all numbers of an element, which must be `count`.
///
/// MATLAB stores the numbers of an array in the smallest type that holds them, so the stored type
/// differs from the array's type.
pub(super) fn numbers(
    element: &Element<'_>,
    count: usize,
    budget: &ReadingBudget<'_>,
) -> Result<Vec<f64>, VariableFault> {
    let found = element.count()?;
    if found != count {
        return Err(element
            .data
            .damaged(format!("{found} numbers where there should be {count}")));
    }
    budget.take(count as u64, 8, "")?;
    let Some(stored) = element.kind.stored(element.data.order) else {
        return Ok(Vec::new());
    };
    Ok(element
        .data
        .rest()
        .chunks_exact(stored.size())
        .map(|number| stored.decode(number))
        .collect())
}

/// Reads all integers of an element: sizes and indices.
pub(super) fn places(
    element: &Element<'_>,
    budget: &ReadingBudget<'_>,
) -> Result<Vec<usize>, VariableFault> {
    match element.kind {
        DataKind::I32 | DataKind::U32 => {}
        _ => {
            return Err(element
                .data
                .damaged("numbers of another kind where sizes should stand"));
        }
    }
    let count = element.count()?;
    budget.take(count as u64, 8, "")?;
    let values = numbers(element, count, budget)?;
    let place = |value: f64| {
        if value < 0.0 {
            None
        } else {
            Some(value as usize)
        }
    };
    let places: Option<Vec<usize>> = values.into_iter().map(place).collect();
    places.ok_or_else(|| element.data.damaged("a negative size"))
}

/// Reads the 64-bit integers of an element, if it holds that type.
pub(super) fn long_words(
    element: &Element<'_>,
    budget: &ReadingBudget<'_>,
) -> Result<Option<Vec<u64>>, VariableFault> {
    if element.kind != DataKind::U64 {
        return Ok(None);
    }
    budget.take(element.count()? as u64, 8, "")?;
    let order = element.data.order;
    Ok(Some(
        element
            .data
            .rest()
            .as_chunks()
            .0
            .iter()
            .map(|&bytes| order.u64(bytes))
            .collect(),
    ))
}

// Character arrays.

/// Reads the rows of a character array, stored as text or as character codes.
pub(super) fn text(
    element: &Element<'_>,
    shape: &[usize],
    budget: &ReadingBudget<'_>,
) -> Result<TextArray, VariableFault> {
    let wanted = count(shape);
    budget.take(wanted as u64, 16, "")?;
    let mut characters = characters(element, wanted, budget)?;
    if characters.is_empty() {
        // Old versions omit the characters of blank arrays.
        characters = vec![u32::from(b' '); wanted];
    }
    if characters.len() != wanted {
        let found = characters.len();
        return Err(element
            .data
            .damaged(format!("{found} characters where there should be {wanted}")));
    }
    rows(&characters, shape, "", budget)
}

/// Splits a character array into texts, one for each row of the shape.
///
/// An array without characters is one empty text, such as MATLAB's `''`, unless it has several
/// rows.
pub(crate) fn rows(
    characters: &[u32],
    shape: &[usize],
    variable: &str,
    budget: &ReadingBudget<'_>,
) -> Result<TextArray, VariableFault> {
    let height = shape.first().copied().unwrap_or(1);
    let length = shape.get(1).copied().unwrap_or(1);
    let pages = shape.get(2..).unwrap_or_default();
    if characters.is_empty() && height <= 1 {
        return Ok(TextArray::one(""));
    }
    let shape: Vec<usize> = [height, 1].iter().chain(pages).copied().collect();
    let texts = count(&shape);
    budget.take(texts as u64, size_of::<String>() as u64, variable)?;
    // A UTF-16 unit takes up to three bytes.
    budget.take(characters.len() as u64, 3, variable)?;
    let page = height.saturating_mul(length);
    let row = |text: usize| {
        let first = (text / height)
            .saturating_mul(page)
            .saturating_add(text % height);
        let places = (0..length).map(|column| first.saturating_add(column.saturating_mul(height)));
        written(places.filter_map(|place| characters.get(place).copied()))
    };
    Ok(TextArray {
        shape,
        texts: (0..texts).map(row).collect(),
    })
}

/// Builds a text from character codes; codes beyond 16 bits may be one number or a UTF-16 pair.
fn written(numbers: impl Iterator<Item = u32>) -> String {
    let mut units = Vec::new();
    for number in numbers {
        match char::from_u32(number).filter(|_| number > 0xffff) {
            Some(letter) => units.extend_from_slice(letter.encode_utf16(&mut [0; 2])),
            None => units.push(u16::try_from(number).unwrap_or(0xfffd)),
        }
    }
    String::from_utf16_lossy(&units)
}

fn characters(
    element: &Element<'_>,
    wanted: usize,
    budget: &ReadingBudget<'_>,
) -> Result<Vec<u32>, VariableFault> {
    if element.kind == DataKind::Utf8 {
        return Ok(of_utf8(element.data.rest(), wanted));
    }
    let found = element.count()?;
    Ok(numbers(element, found, budget)?
        .into_iter()
        .map(|number| number as u32)
        .collect())
}

/// Decodes UTF-8 characters. The shape counts UTF-16 units in files of MATLAB, characters in files
/// of some other programs, and bytes in files that label Latin-1 as UTF-8.
fn of_utf8(bytes: &[u8], wanted: usize) -> Vec<u32> {
    let text = String::from_utf8_lossy(bytes);
    let units = text.encode_utf16().count();
    if units == wanted {
        text.encode_utf16().map(u32::from).collect()
    } else if bytes.len() == wanted {
        bytes.iter().copied().map(u32::from).collect()
    } else {
        text.chars().map(u32::from).collect()
    }
}

// Opaque arrays, whose contents are elsewhere in the file: class objects, and values that cannot be
// read.
//
// The format is not published by The MathWorks; it is known from the descriptions of the
// MatFileHandler, matio (Python) and MAT.jl projects.

/// Reads the value of an opaque array after its name.
pub(super) fn opaque_value(
    arrays: &Arrays<'_>,
    contents: &mut Cursor<'_>,
    trail: &FieldPath<'_>,
) -> Result<Value, VariableFault> {
    let system = Element::read(contents)?.name()?;
    let class = Element::read(contents)?.name()?;
    if system != "MCOS" {
        Element::pass_all(contents)?;
        let why = "only objects of MATLAB's own classes are read; in MATLAB, save what it holds as numbers or text";
        return Ok(Value::opaque(format!("{class} ({system})"), why));
    }
    let contents = arrays.inner(contents, trail)?;
    let variable = trail.words();
    let objects = match arrays.objects {
        Ok(objects) => objects,
        Err(why) => return Ok(unread_because(&class, why, &variable)),
    };
    match (&contents, Reference::of(&contents)) {
        (_, Some(reference)) => objects.referred(&reference, trail, arrays.budget),
        (Value::Struct(records), None) => {
            objects.enumeration(records, &class, trail, arrays.budget)
        }
        _ => Ok(unread_because(&class, "it refers to no object", &variable)),
    }
}

/// Returns the value for a class that this program does not read.
pub(super) fn unread(class: &str, trail: &FieldPath<'_>) -> Value {
    unread_because(class, "values of this class are not read", &trail.words())
}

/// Returns an unreadable value with the reason and a way to export its data.
pub(super) fn unread_because(class: &str, why: &str, variable: &str) -> Value {
    let line = export_line(class, variable);
    Value::opaque(class, format!("{why}; in MATLAB, save its data: {line}"))
}

#[cfg(test)]
mod matrix_tests {
    use super::*;
    use crate::formats::mat::read;
    use crate::formats::mat::sample_tests::{big_file, doubles, element, file, matrix};

    fn first(bytes: &[u8]) -> Result<Value, VariableFault> {
        let mut variables = read(bytes, &ReadingBudget::new(1 << 16))?;
        Ok(variables.remove(0).value)
    }

    #[test]
    fn the_other_order_of_bytes_is_read() {
        let Ok(Value::Array(array)) = first(&big_file("x", &[1, 2], &[1.0, -2.0])) else {
            panic!()
        };
        assert_eq!((array.shape, array.re), (vec![1, 2], vec![1.0, -2.0]));
    }

    #[test]
    fn an_old_object_has_a_class_and_fields() {
        let fields = [
            element(5, &8_i32.to_le_bytes()),
            element(1, b"a\0\0\0\0\0\0\0b\0\0\0\0\0\0\0"),
        ]
        .concat();
        let values = [doubles("", &[1, 1], &[1.0]), doubles("", &[1, 1], &[2.0])].concat();
        let Ok(Value::Object(object)) = first(&file(&matrix(
            3,
            &[1, 1],
            "sys",
            &[element(1, b"ss"), fields, values],
        ))) else {
            panic!()
        };
        assert_eq!(object.class, "ss");
        assert_eq!(
            object.records.field("b").unwrap()[0],
            Value::Array(Array::matrix(1, 1, vec![2.0]))
        );
    }

    #[test]
    fn a_function_handle_says_how_to_save_it() {
        let Ok(Value::Opaque { class, why }) = first(&file(&matrix(
            16,
            &[1, 1],
            "f",
            &[doubles("", &[1, 1], &[1.0])],
        ))) else {
            panic!()
        };
        assert_eq!(class, "function_handle");
        assert!(why.contains("func2str(f)"));
    }

    #[test]
    fn true_and_false_in_a_sparse_matrix_take_a_byte_each() {
        let rows = element(5, &[0, 1].map(i32::to_le_bytes).concat());
        let starts = element(5, &[0, 1, 2].map(i32::to_le_bytes).concat());
        let sparse = matrix(
            5 | 0x0200,
            &[2, 2],
            "x",
            &[rows, starts, element(9, &[1, 1])],
        );
        let Ok(Value::Array(array)) = first(&file(&sparse)) else {
            panic!()
        };
        assert_eq!(array.re, [1.0, 0.0, 0.0, 1.0]);
    }

    #[test]
    fn sparse_matrices_that_contradict_themselves_are_damaged() {
        let places = |places: &[i32]| {
            element(
                5,
                &places
                    .iter()
                    .flat_map(|place| place.to_le_bytes())
                    .collect::<Vec<_>>(),
            )
        };
        let sparse = |rows: &[i32], starts: &[i32]| {
            let numbers = element(9, &[1.0_f64, 2.0].map(f64::to_le_bytes).concat());
            first(&file(&matrix(
                5,
                &[2, 2],
                "x",
                &[places(rows), places(starts), numbers],
            )))
        };
        assert!(sparse(&[0, 1], &[0, 1, 2]).is_ok());
        for (rows, starts) in [
            (&[0, 1][..], &[0, 1][..]),
            (&[0, 2], &[0, 1, 2]),
            (&[0, 1], &[0, 2, 1]),
            (&[0, 1], &[1, 1, 2]),
            (&[0, 1], &[0, 1, 3]),
            (&[0, -1], &[0, 1, 2]),
        ] {
            assert!(
                matches!(sparse(rows, starts), Err(VariableFault::Damaged { .. })),
                "{rows:?} {starts:?}"
            );
        }
    }

    #[test]
    fn sizes_that_nothing_stands_behind_are_refused() {
        let large = [i32::MAX, i32::MAX];
        let none = element(5, &[]);
        let zeros = element(5, &0_i32.to_le_bytes());
        for class in [1, 2, 4, 5, 6, 12] {
            let name = [
                element(5, &8_i32.to_le_bytes()),
                element(1, b"a\0\0\0\0\0\0\0"),
            ]
            .concat();
            let contents = if class == 2 {
                vec![name]
            } else {
                vec![none.clone(), zeros.clone(), none.clone()]
            };
            assert!(
                first(&file(&matrix(class, &large, "x", &contents))).is_err(),
                "{class}"
            );
        }
        let overflow = first(&file(&matrix(
            2,
            &[i32::MAX, i32::MAX, i32::MAX, 0],
            "x",
            &[zeros, none],
        )));
        assert!(
            matches!(overflow, Err(VariableFault::TooLarge { .. })),
            "{overflow:?}"
        );
        let negative = first(&file(&doubles("x", &[-1, 1], &[])));
        assert!(
            matches!(negative, Err(VariableFault::Damaged { .. })),
            "{negative:?}"
        );
    }

    #[test]
    fn two_fields_of_one_name_are_refused() {
        let fields = [element(5, &2_i32.to_le_bytes()), element(1, b"a\0a\0")].concat();
        let twice = first(&file(&matrix(2, &[1, 1], "s", &[fields])));
        assert_eq!(
            twice,
            Err(VariableFault::Duplicate {
                name: "a".to_owned()
            })
        );
    }
}

#[cfg(test)]
mod numbers_tests {
    use super::*;
    use crate::formats::mat::level5::{ByteOrder, Cursor};

    fn read(kind: u8, data: &[u8], count: usize) -> Result<Vec<f64>, VariableFault> {
        let bytes = [&[kind, 0, 0, 0, data.len() as u8, 0, 0, 0], data].concat();
        let element = Element::read(&mut Cursor::file(&bytes, ByteOrder::Little)).unwrap();
        numbers(&element, count, &ReadingBudget::new(1 << 10))
    }

    #[test]
    fn every_kind_of_number_becomes_the_nearest() {
        assert_eq!(read(1, &[0xff], 1), Ok(vec![-1.0]));
        assert_eq!(read(3, &[0xfe, 0xff], 1), Ok(vec![-2.0]));
        assert_eq!(read(5, &(-3_i32).to_le_bytes(), 1), Ok(vec![-3.0]));
        assert_eq!(read(7, &0.5_f32.to_le_bytes(), 1), Ok(vec![0.5]));
        assert_eq!(read(12, &(-4_i64).to_le_bytes(), 1), Ok(vec![-4.0]));
        assert_eq!(
            read(13, &u64::MAX.to_le_bytes(), 1),
            Ok(vec![18_446_744_073_709_551_616.0])
        );
    }

    #[test]
    fn too_few_numbers_are_damage_and_too_many_are_not_taken() {
        assert!(matches!(
            read(9, &[0; 8], 2),
            Err(VariableFault::Damaged { .. })
        ));
        assert!(matches!(
            read(2, &[0; 200], 200),
            Err(VariableFault::TooLarge { .. })
        ));
    }
}

#[cfg(test)]
mod text_tests {
    use super::*;
    use crate::formats::mat::level5::{ByteOrder, Cursor};

    fn read(kind: u8, data: &[u8], shape: &[usize]) -> Result<TextArray, VariableFault> {
        let bytes = [&[kind, 0, 0, 0, data.len() as u8, 0, 0, 0], data].concat();
        let element = Element::read(&mut Cursor::file(&bytes, ByteOrder::Little)).unwrap();
        text(&element, shape, &ReadingBudget::new(1 << 16))
    }

    #[test]
    fn the_rows_of_an_array_are_texts() {
        let found = read(16, b"adbecf", &[2, 3]).unwrap();
        assert_eq!(
            found,
            TextArray {
                shape: vec![2, 1],
                texts: vec!["abc".to_owned(), "def".to_owned()]
            }
        );
        let paged = read(16, b"abcd", &[1, 2, 2]).unwrap();
        assert_eq!(
            paged,
            TextArray {
                shape: vec![1, 1, 2],
                texts: vec!["ab".to_owned(), "cd".to_owned()]
            }
        );
    }

    #[test]
    fn letters_beyond_16_bits_are_read_however_they_are_counted() {
        for length in [2, 1, 4] {
            let found = read(16, "\u{1f681}".as_bytes(), &[1, length]).unwrap();
            assert_eq!(found.texts[0] == "\u{1f681}", length < 4);
        }
        assert_eq!(
            read(17, &[0x3d, 0xd8, 0x81, 0xde], &[1, 2]).unwrap().texts,
            ["\u{1f681}"]
        );
        assert_eq!(
            read(18, &[0x81, 0xf6, 1, 0], &[1, 1]).unwrap().texts,
            ["\u{1f681}"]
        );
    }

    #[test]
    fn nothing_is_one_empty_text_and_blanks_that_were_left_out_come_back() {
        assert_eq!(
            read(4, &[], &[0, 0]).unwrap(),
            TextArray {
                shape: vec![1, 1],
                texts: vec![String::new()]
            }
        );
        assert_eq!(read(4, &[], &[3, 0]).unwrap().texts, ["", "", ""]);
        assert_eq!(read(4, &[], &[1, 3]).unwrap().texts, ["   "]);
        assert!(matches!(
            read(4, &[65, 0], &[1, 3]),
            Err(VariableFault::Damaged { .. })
        ));
        assert!(matches!(
            read(4, &[], &[1 << 20, 1 << 20]),
            Err(VariableFault::TooLarge { .. })
        ));
    }
}

#[cfg(test)]
mod opaque_tests {
    use crate::formats::mat::read;
    use crate::formats::mat::sample_tests::{element, file, opaque, reference};
    use crate::formats::variables::Value;
    use crate::reading_budget::ReadingBudget;

    fn first(bytes: &[u8]) -> (String, String) {
        match read(bytes, &ReadingBudget::new(1 << 16))
            .unwrap()
            .remove(0)
            .value
        {
            Value::Opaque { class, why } => (class, why),
            other => panic!("{other:?}"),
        }
    }

    #[test]
    fn an_object_without_the_part_that_holds_it_says_how_to_save_it() {
        let (class, why) = first(&file(&opaque("sys", "tf", reference(&[1], 1))));
        assert_eq!(class, "tf");
        assert!(
            why.contains("nowhere")
                && why.ends_with("[num,den,Ts] = tfdata(sys); save out.mat num den Ts"),
            "{why}"
        );
    }

    #[test]
    fn objects_of_other_systems_are_named_and_not_read() {
        let flags = element(6, &[17, 0, 0, 0, 0, 0, 0, 0]);
        let names = ["x", "java", "java.util.Date"]
            .map(|name| element(1, name.as_bytes()))
            .concat();
        let (class, _) = first(&file(&element(14, &[flags, names].concat())));
        assert_eq!(class, "java.util.Date (java)");
    }
}
