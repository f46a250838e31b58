//! One array of a file, with everything that lies in it.
//!
//! Source: "MAT-File Format", The MathWorks, "miMATRIX Format".

use super::cursor::Cursor;
use super::element::{DataKind, Element};
use super::header::{ArrayClass, Header};
use super::level5::{behind, matrix};
use super::numbers::{numbers, places};
use super::opaque;
use super::sparse::Entries;
use super::subsystem::Subsystem;
use super::text::text;
use super::trail::{FieldPath, Step};
use crate::variables::{Array, CellArray, MemoryBudget, Object, StructArray, Value, VariableFault};

/// What reading an array takes besides its bytes.
#[derive(Clone, Copy)]
pub(super) struct Arrays<'a> {
    /// Counts the memory.
    pub(super) meter: &'a MemoryBudget<'a>,
    /// The objects of the file, or why they cannot be read.
    pub(super) objects: Result<&'a Subsystem, &'a str>,
}

impl Arrays<'_> {
    /// The contents of an array behind its header.
    pub(super) fn contents(
        &self,
        header: &Header,
        contents: &mut Cursor<'_>,
        trail: &FieldPath<'_>,
    ) -> Result<Value, VariableFault> {
        let value = match header.class {
            ArrayClass::Float | ArrayClass::Integer => self.array(header, contents).map(Value::Array),
            ArrayClass::Sparse => self.sparse(header, contents).map(Value::Array),
            ArrayClass::Char => {
                Element::read(contents).and_then(|element| text(&element, &header.shape, self.meter)).map(Value::Text)
            }
            ArrayClass::Cell => self.cell(header, contents, trail).map(Value::Cell),
            ArrayClass::Struct => self.records(header, contents, trail).map(Value::Struct),
            ArrayClass::Object => self.object(header, contents, trail).map(Value::Object),
            ArrayClass::FunctionHandle => {
                Element::pass_all(contents).map(|()| opaque::unread("function_handle", trail))
            }
            ArrayClass::Opaque => opaque::value(self, contents, trail),
        };
        value.map_err(|fault| trail.name(fault))
    }

    /// The next array, which lies in another.
    pub(super) fn inner(&self, contents: &mut Cursor<'_>, trail: &FieldPath<'_>) -> Result<Value, VariableFault> {
        let value = self.next(contents, trail);
        value.map_err(|fault| trail.name(fault))
    }

    fn next(&self, contents: &mut Cursor<'_>, trail: &FieldPath<'_>) -> Result<Value, VariableFault> {
        let start = *contents;
        let element = Element::read(contents)?;
        let mut data = matrix(element)?;
        if data.is_empty() {
            return Ok(Value::Array(Array::matrix(0, 0, Vec::new())));
        }
        let header = Header::read(&mut data, self.meter)?;
        let value = self.contents(&header, &mut data, trail)?;
        *contents = behind(start, element, data, *contents)?;
        Ok(value)
    }

    fn array(&self, header: &Header, contents: &mut Cursor<'_>) -> Result<Array, VariableFault> {
        let count = header.count;
        let re = numbers(&Element::read(contents)?, count, self.meter)?;
        let im = if header.complex { Some(numbers(&Element::read(contents)?, count, self.meter)?) } else { None };
        Ok(Array { shape: header.shape.clone(), kind: header.element_kind(), re, im })
    }

    fn sparse(&self, header: &Header, contents: &mut Cursor<'_>) -> Result<Array, VariableFault> {
        let start = *contents;
        let &[height, width] = header.shape.as_slice() else {
            return Err(start.damaged("a sparse array that is no matrix"));
        };
        let mut rows = places(&Element::read(contents)?, self.meter)?;
        let starts = places(&Element::read(contents)?, self.meter)?;
        let stored = starts.last().copied().unwrap_or(0);
        let mut part = || {
            let mut element = Element::read(contents)?;
            // MATLAB says of true and false in sparse matrices that they take eight bytes each, and writes one.
            if header.logical && element.kind == DataKind::F64 && element.data.len() < stored.saturating_mul(8) {
                element.kind = DataKind::U8;
            }
            numbers(&element, element.count()?, self.meter)
        };
        let re = part()?;
        let im = if header.complex { Some(part()?) } else { None };
        let short = stored > rows.len() || stored > re.len() || im.as_ref().is_some_and(|im| stored > im.len());
        if starts.len() != width.saturating_add(1) || starts.first() != Some(&0) || !starts.is_sorted() || short {
            return Err(start.damaged("a sparse matrix whose columns do not fit its numbers"));
        }
        // Room for further numbers may have been left behind the last.
        rows.truncate(stored);
        self.meter.take(stored as u64, 8, "")?;
        let runs = starts.iter().zip(starts.iter().skip(1)).enumerate();
        let columns = runs.flat_map(|(column, (&from, &to))| std::iter::repeat_n(column, to - from)).collect();
        let kind = header.element_kind();
        let entries = Entries { shape: [height, width], kind, rows, columns, re, im };
        entries.filled(self.meter, || start.damaged("a number outside its sparse matrix"))
    }

    fn cell(
        &self,
        header: &Header,
        contents: &mut Cursor<'_>,
        trail: &FieldPath<'_>,
    ) -> Result<CellArray, VariableFault> {
        let count = self.room(header.count, contents)?;
        let values = (0..count).map(|at| self.inner(contents, &trail.step(Step::Cell(at))?));
        Ok(CellArray { shape: header.shape.clone(), values: values.collect::<Result<_, _>>()? })
    }

    fn object(
        &self,
        header: &Header,
        contents: &mut Cursor<'_>,
        trail: &FieldPath<'_>,
    ) -> Result<Object, VariableFault> {
        let class = Element::read(contents)?.name()?;
        Ok(Object { class, records: self.records(header, contents, trail)? })
    }

    fn records(
        &self,
        header: &Header,
        contents: &mut Cursor<'_>,
        trail: &FieldPath<'_>,
    ) -> Result<StructArray, VariableFault> {
        let names = field_names(contents, self.meter)?;
        let count = header.count;
        self.room(count.saturating_mul(names.len()), contents)?;
        let mut fields: Vec<(String, Vec<Value>)> = Vec::with_capacity(names.len());
        for name in names {
            fields.push((name, Vec::new()));
        }
        // Of no fields there may be any number of records.
        let records = if fields.is_empty() { 0 } else { count };
        for at in 0..records {
            let record = trail.step(Step::Record(at))?;
            let trail = if count == 1 { trail } else { &record };
            for (name, values) in &mut fields {
                values.push(self.inner(contents, &trail.step(Step::Field(name))?)?);
            }
        }
        Ok(StructArray { shape: header.shape.clone(), fields })
    }

    /// Counts `count` values that follow, each of which takes eight bytes of the file at least.
    fn room(&self, count: usize, contents: &Cursor<'_>) -> Result<usize, VariableFault> {
        if count > contents.len() / 8 {
            return Err(contents.damaged(format!("{count} values in {} bytes", contents.len())));
        }
        // Vectors grow by doubling.
        self.meter.take(count as u64, 2 * size_of::<Value>() as u64, "")?;
        Ok(count)
    }
}

/// The names of the fields of records, which stand before them.
pub(super) fn field_names(contents: &mut Cursor<'_>, meter: &MemoryBudget<'_>) -> Result<Vec<String>, VariableFault> {
    let lengths = Element::read(contents)?;
    let &[length] = places(&lengths, meter)?.as_slice() else {
        return Err(lengths.data.damaged("records without a length of their names"));
    };
    let names = Element::read(contents)?;
    let bytes = names.data.rest();
    if (length == 0 && !bytes.is_empty()) || (length != 0 && !bytes.len().is_multiple_of(length)) {
        return Err(names.data.damaged("names of fields that do not fit their length"));
    }
    meter.take((bytes.len() / length.max(1)) as u64, 128, "")?;
    let mut seen = std::collections::HashSet::new();
    let mut found = Vec::new();
    for name in bytes.chunks_exact(length.max(1)).map(super::element::name_of) {
        if !seen.insert(name.clone()) {
            return Err(VariableFault::Duplicate { name });
        }
        found.push(name);
    }
    Ok(found)
}

#[cfg(test)]
mod tests {
    use super::super::read;
    use super::super::sample::{big_file, doubles, element, file, matrix};
    use super::{Array, MemoryBudget, Value, VariableFault};

    fn first(bytes: &[u8]) -> Result<Value, VariableFault> {
        let mut variables = read(bytes, &MemoryBudget::new(1 << 16, &|_| false))?;
        Ok(variables.remove(0).value)
    }

    #[test]
    fn the_other_order_of_bytes_is_read() {
        let Ok(Value::Array(array)) = first(&big_file("x", &[1, 2], &[1.0, -2.0])) else { panic!() };
        assert_eq!((array.shape, array.re), (vec![1, 2], vec![1.0, -2.0]));
    }

    #[test]
    fn an_old_object_has_a_class_and_fields() {
        let fields = [element(5, &8_i32.to_le_bytes()), element(1, b"a\0\0\0\0\0\0\0b\0\0\0\0\0\0\0")].concat();
        let values = [doubles("", &[1, 1], &[1.0]), doubles("", &[1, 1], &[2.0])].concat();
        let Ok(Value::Object(object)) = first(&file(&matrix(3, &[1, 1], "sys", &[element(1, b"ss"), fields, values])))
        else {
            panic!()
        };
        assert_eq!(object.class, "ss");
        assert_eq!(object.records.field("b").unwrap()[0], Value::Array(Array::matrix(1, 1, vec![2.0])));
    }

    #[test]
    fn a_function_handle_says_how_to_save_it() {
        let Ok(Value::Opaque { class, why }) = first(&file(&matrix(16, &[1, 1], "f", &[doubles("", &[1, 1], &[1.0])])))
        else {
            panic!()
        };
        assert_eq!(class, "function_handle");
        assert!(why.contains("func2str(f)"));
    }

    #[test]
    fn true_and_false_in_a_sparse_matrix_take_a_byte_each() {
        let rows = element(5, &[0, 1].map(i32::to_le_bytes).concat());
        let starts = element(5, &[0, 1, 2].map(i32::to_le_bytes).concat());
        let sparse = matrix(5 | 0x0200, &[2, 2], "x", &[rows, starts, element(9, &[1, 1])]);
        let Ok(Value::Array(array)) = first(&file(&sparse)) else { panic!() };
        assert_eq!(array.re, [1.0, 0.0, 0.0, 1.0]);
    }

    #[test]
    fn sparse_matrices_that_contradict_themselves_are_damaged() {
        let places =
            |places: &[i32]| element(5, &places.iter().flat_map(|place| place.to_le_bytes()).collect::<Vec<_>>());
        let sparse = |rows: &[i32], starts: &[i32]| {
            let numbers = element(9, &[1.0_f64, 2.0].map(f64::to_le_bytes).concat());
            first(&file(&matrix(5, &[2, 2], "x", &[places(rows), places(starts), numbers])))
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
            assert!(matches!(sparse(rows, starts), Err(VariableFault::Damaged { .. })), "{rows:?} {starts:?}");
        }
    }

    #[test]
    fn sizes_that_nothing_stands_behind_are_refused() {
        let large = [i32::MAX, i32::MAX];
        let none = element(5, &[]);
        let zeros = element(5, &0_i32.to_le_bytes());
        for class in [1, 2, 4, 5, 6, 12] {
            let name = [element(5, &8_i32.to_le_bytes()), element(1, b"a\0\0\0\0\0\0\0")].concat();
            let contents = if class == 2 { vec![name] } else { vec![none.clone(), zeros.clone(), none.clone()] };
            assert!(first(&file(&matrix(class, &large, "x", &contents))).is_err(), "{class}");
        }
        let overflow = first(&file(&matrix(2, &[i32::MAX, i32::MAX, i32::MAX, 0], "x", &[zeros, none])));
        assert!(matches!(overflow, Err(VariableFault::TooLarge { .. })), "{overflow:?}");
        let negative = first(&file(&doubles("x", &[-1, 1], &[])));
        assert!(matches!(negative, Err(VariableFault::Damaged { .. })), "{negative:?}");
    }

    #[test]
    fn two_fields_of_one_name_are_refused() {
        let fields = [element(5, &2_i32.to_le_bytes()), element(1, b"a\0a\0")].concat();
        let twice = first(&file(&matrix(2, &[1, 1], "s", &[fields])));
        assert_eq!(twice, Err(VariableFault::Duplicate { name: "a".to_owned() }));
    }
}
