//! Texts: MATLAB's characters, and strings of HDF5.

use hdf5_pure::{CompoundMember, Dataset, Datatype, Object, StringPadding, VlenStringReadOptions};

use crate::mat73::dataset::{Elements, NumberType, Order};
use crate::mat73::{MatlabAttributes, Opened, Reader, damaged, fault};
use crate::strides::count;
use crate::variables::{Array, CellArray, ElementKind, ReadingBudget, StructArray, TextArray, Value, VariableFault};

/// The texts in the rows of an array of characters' numbers (UTF-16), as many as the shape says.
///
/// An array without characters is one empty text, as MATLAB's `''` is, unless it has several rows.
pub(super) fn rows(codes: &Array, path: &str, budget: &ReadingBudget<'_>) -> Result<TextArray, VariableFault> {
    let (height, length) = (codes.shape.first().copied().unwrap_or(1), codes.shape.get(1).copied().unwrap_or(1));
    if codes.is_empty() && height <= 1 {
        return Ok(TextArray { shape: vec![1, 1], texts: vec![String::new()] });
    }
    let mut shape = codes.shape.clone();
    if let Some(length) = shape.get_mut(1) {
        *length = 1;
    }
    let texts = count(&shape).ok_or_else(|| damaged(path, "there are more rows than can be counted"))?;
    budget.take(texts as u64, size_of::<String>() as u64, path)?;
    // A unit of UTF-16 takes up to three bytes.
    budget.take(codes.len() as u64, 3, path)?;
    let row = |text: usize| {
        let first = (text / height).saturating_mul(height.saturating_mul(length)) + text % height;
        let places = (0..length).map(|column| first.saturating_add(column.saturating_mul(height)));
        let units = places.filter_map(|place| codes.re.get(place)).map(|&code| code as u16);
        char::decode_utf16(units).map(|letter| letter.unwrap_or(char::REPLACEMENT_CHARACTER)).collect()
    };
    Ok(TextArray { shape, texts: (0..texts).map(row).collect() })
}

/// A text of fixed length without what fills it up.
pub(super) fn fixed(bytes: &[u8], padding: &StringPadding) -> String {
    let text = String::from_utf8_lossy(bytes);
    let end = text.find('\0').unwrap_or(text.len());
    let text = &text[..end];
    if matches!(padding, StringPadding::SpacePad) { text.trim_end_matches(' ') } else { text }.to_owned()
}

/// The strings of a dataset, if they are of one of HDF5's two kinds.
pub(super) fn strings(
    dataset: &Dataset,
    elements: &Elements,
    path: &str,
    budget: &ReadingBudget<'_>,
) -> Result<Option<TextArray>, VariableFault> {
    budget.take(elements.count() as u64, (size_of::<String>()) as u64, path)?;
    let texts = match &elements.datatype {
        Datatype::String { padding, size, .. } => {
            budget.take(elements.count() as u64, u64::from(*size), path)?;
            elements.places().map(|place| fixed(elements.at(place), padding)).collect()
        }
        Datatype::VariableLength { is_string: true, .. } => {
            let mut texts = variable(dataset, elements.count(), path, budget)?;
            elements.places().filter_map(|place| texts.get_mut(place).map(std::mem::take)).collect()
        }
        _ => return Ok(None),
    };
    Ok(Some(TextArray { shape: elements.shape.clone(), texts }))
}

fn variable(
    dataset: &Dataset,
    count: usize,
    path: &str,
    budget: &ReadingBudget<'_>,
) -> Result<Vec<String>, VariableFault> {
    if count == 0 {
        return Ok(Vec::new());
    }
    let failed = |error| fault(&error, path);
    // Each string may be the same long one.
    let length = dataset.vlen_string_payload_size().map_err(failed)?;
    budget.take(length, 1, path)?;
    let most = usize::try_from(length).unwrap_or(usize::MAX);
    let options = VlenStringReadOptions::new().with_max_elements(count).with_max_payload_bytes(most);
    let texts = dataset.read_vlen_strings(options).map_err(failed)?;
    if texts.len() == count { Ok(texts) } else { Err(damaged(path, "strings are missing")) }
}

// Arrays without elements, of which MATLAB stores the shape.

/// The value without elements that marks and a stored shape stand for.
pub(super) fn empty(
    marks: &MatlabAttributes,
    elements: &Elements,
    path: &str,
    budget: &ReadingBudget<'_>,
) -> Result<Value, VariableFault> {
    let wrong = || damaged(path, "the shape of an array without elements is wrong");
    let sides = elements.words(path, budget)?.ok_or_else(wrong)?;
    let shape: Vec<usize> =
        sides.iter().map(|&side| usize::try_from(side).ok()).collect::<Option<_>>().ok_or_else(wrong)?;
    if shape.len() < 2 || count(&shape) != Some(0) {
        return Err(wrong());
    }
    let numbers = |kind| Array { shape: shape.clone(), kind, re: Vec::new(), im: None };
    Ok(match marks.class() {
        "cell" => Value::Cell(CellArray { shape, values: Vec::new() }),
        "struct" => {
            let fields = marks.fields.iter().map(|name| (name.clone(), Vec::new())).collect();
            Value::Struct(StructArray { shape, fields })
        }
        "char" => Value::Text(rows(&numbers(ElementKind::Integer), path, budget)?),
        // GNU Octave names no class here.
        "double" | "single" | "" => Value::Array(numbers(ElementKind::Float)),
        "logical" => Value::Array(numbers(ElementKind::Logical)),
        "int8" | "int16" | "int32" | "int64" | "uint8" | "uint16" | "uint32" | "uint64" => {
            Value::Array(numbers(ElementKind::Integer))
        }
        class => Value::Opaque { class: class.to_owned(), why: "it is empty".to_owned() },
    })
}

// Records of HDF5.

/// A record for each element, if the elements are records: numbers and texts of fixed length, and what else there is by name.
pub(super) fn records(
    elements: &Elements,
    path: &str,
    budget: &ReadingBudget<'_>,
) -> Result<Option<StructArray>, VariableFault> {
    let Datatype::Compound { members, .. } = &elements.datatype else { return Ok(None) };
    let mut fields = Vec::with_capacity(members.len());
    for member in members {
        // A value, its shape and its one number.
        budget.take(elements.count() as u64, size_of::<Value>() as u64 + 24, path)?;
        let values = elements.places().map(|place| value(member, elements.at(place), path, budget));
        fields.push((member.name.clone(), values.collect::<Result<_, _>>()?));
    }
    Ok(Some(StructArray { shape: elements.shape.clone(), fields }))
}

fn value(
    member: &CompoundMember,
    record: &[u8],
    path: &str,
    budget: &ReadingBudget<'_>,
) -> Result<Value, VariableFault> {
    let offset = usize::try_from(member.byte_offset).unwrap_or(usize::MAX);
    let bytes = record.get(offset..).unwrap_or_default();
    if let Some(numbers) = NumberType::of(&member.datatype) {
        let part = |offset: usize| vec![numbers.number.decode(bytes.get(offset..).unwrap_or_default())];
        let (re, im) = (part(numbers.re), numbers.im.map(part));
        return Ok(Value::Array(Array { shape: vec![1, 1], kind: numbers.number.kind(), re, im }));
    }
    if let Datatype::String { size, padding, .. } = &member.datatype {
        let bytes = &bytes[..bytes.len().min(*size as usize)];
        budget.take(bytes.len() as u64, 1, path)?;
        return Ok(Value::Text(TextArray { shape: vec![1, 1], texts: vec![fixed(bytes, padding)] }));
    }
    Ok(Value::Opaque {
        class: "a field of a record".to_owned(),
        why: "it is neither a number nor a text of fixed length".to_owned(),
    })
}

// Matrices of which only the numbers other than zero are stored (`MATLAB_sparse`): by columns, compressed.

/// The members of a group that is a sparse matrix, and its marks.
pub(super) struct Sparse<'s> {
    pub(super) rows: u64,
    pub(super) marks: &'s MatlabAttributes,
    pub(super) members: &'s [(String, Object)],
    pub(super) path: &'s str,
    pub(super) budget: &'s ReadingBudget<'s>,
}

impl Sparse<'_> {
    /// The matrix, filled up with zeros.
    pub(super) fn filled(&self) -> Result<Array, VariableFault> {
        let wrong = || damaged(self.path, "the sparse matrix contradicts itself");
        let starts = self.indices("jc")?.ok_or_else(wrong)?;
        let (indices, data) = (self.indices("ir")?.unwrap_or_default(), self.data()?);
        let columns = starts.len().checked_sub(1).ok_or_else(wrong)?;
        let cells = self.rows.saturating_mul(columns as u64);
        self.budget.take(cells, if data.im.is_some() { 16 } else { 8 }, self.path)?;
        let (cells, rows) =
            (usize::try_from(cells).map_err(|_| wrong())?, usize::try_from(self.rows).map_err(|_| wrong())?);
        let (mut re, mut im) = (vec![0.0; cells], data.im.as_ref().map(|_| vec![0.0; cells]));
        for (column, bounds) in starts.windows(2).enumerate() {
            let [first, end] = [bounds[0], bounds[1]];
            if first > end || end > indices.len() || end > data.re.len() {
                return Err(wrong());
            }
            for place in first..end {
                let cell = column * rows + Some(indices[place]).filter(|&row| row < rows).ok_or_else(wrong)?;
                re[cell] = data.re[place];
                if let (Some(im), Some(data)) = (&mut im, &data.im) {
                    im[cell] = data[place];
                }
            }
        }
        let kind = if self.marks.class() == "logical" { ElementKind::Logical } else { data.kind };
        Ok(Array { shape: vec![rows, columns], kind, re, im })
    }

    fn member(&self, name: &str) -> Option<&Dataset> {
        self.members.iter().find_map(|(member, object)| match object {
            Object::Dataset(dataset) if member == name => Some(dataset.as_ref()),
            _ => None,
        })
    }

    fn indices(&self, name: &str) -> Result<Option<Vec<usize>>, VariableFault> {
        let Some(dataset) = self.member(name) else { return Ok(None) };
        let words = Elements::read(dataset, Order::Columns, self.path, self.budget)?.words(self.path, self.budget)?;
        let words = words.ok_or_else(|| damaged(self.path, "the places of a sparse matrix are no whole numbers"))?;
        Ok(Some(words.into_iter().map(|word| usize::try_from(word).unwrap_or(usize::MAX)).collect()))
    }

    /// The numbers; there is no dataset where there are none.
    fn data(&self) -> Result<Array, VariableFault> {
        let Some(dataset) = self.member("data") else { return Ok(Array::matrix(0, 0, Vec::new())) };
        let numbers =
            Elements::read(dataset, Order::Columns, self.path, self.budget)?.numbers(self.path, self.budget)?;
        numbers.ok_or_else(|| damaged(self.path, "the elements of a sparse matrix are no numbers"))
    }
}

// Objects of MATLAB's classes, which lie in a part of the file of their own.

/// The part of the file in which the objects lie (`#subsystem#/MCOS`).
#[derive(Clone, Debug, PartialEq)]
pub struct FileWrapper {
    /// The cells, the first of which are the bytes of the directory.
    pub cells: Vec<Value>,
    /// The cells of whole numbers of 64 bits, to the last digit, with the number of the cell, counted from 0.
    pub long_words: Vec<(usize, Vec<u64>)>,
}

/// Gives the value of a reference such as `[0xDD000000, dimensions, …, class]`, for a variable of this name.
pub type ObjectDecoder<'d> = dyn Fn(&[u32], &str, &ReadingBudget<'_>) -> Result<Value, VariableFault> + 'd;

/// What becomes of references to objects.
pub(super) enum Objects<'d> {
    /// They stay the whole numbers that they are: within the part that the decoder itself reads.
    References,
    /// They cannot be read, and why.
    Opaque(&'static str),
    /// As before, in the words of a fault.
    Faulty(String),
    Decoded(Box<ObjectDecoder<'d>>),
}

impl<'d> Objects<'d> {
    /// Reads the part of the objects, where there is one, and makes the decoder of it.
    pub(super) fn read(
        opened: &Opened,
        budget: &ReadingBudget<'_>,
        decoder: impl FnOnce(FileWrapper) -> Result<Box<ObjectDecoder<'d>>, VariableFault>,
    ) -> Result<Self, VariableFault> {
        let Ok(dataset) = opened.root().group("#subsystem#").and_then(|group| group.dataset("MCOS")) else {
            return Ok(Self::Opaque("the file has no part in which objects lie"));
        };
        match wrapper(&dataset, budget).and_then(decoder) {
            Ok(decoder) => Ok(Self::Decoded(decoder)),
            Err(fault) if fault.is_of_the_budget() => Err(fault),
            // The other variables can be read all the same.
            Err(fault) => Ok(Self::Faulty(fault.to_string())),
        }
    }

    /// The value of a reference of a class.
    pub(super) fn value(
        &self,
        class: &str,
        reference: Array,
        path: &str,
        budget: &ReadingBudget<'_>,
    ) -> Result<Value, VariableFault> {
        let opaque = |why: &str| Ok(Value::Opaque { class: class.to_owned(), why: why.to_owned() });
        match self {
            Self::References => Ok(Value::Array(reference)),
            Self::Opaque(why) => opaque(why),
            Self::Faulty(why) => opaque(why),
            Self::Decoded(decoder) => {
                let word = |&number: &f64| (0.0..=f64::from(u32::MAX)).contains(&number).then_some(number as u32);
                match reference.re.iter().map(word).collect::<Option<Vec<u32>>>() {
                    Some(words) => decoder(&words, path, budget),
                    None => opaque("what refers to it is damaged"),
                }
            }
        }
    }
}

fn wrapper(dataset: &Dataset, budget: &ReadingBudget<'_>) -> Result<FileWrapper, VariableFault> {
    let reader = Reader { budget, objects: &Objects::References };
    let (mut cells, mut long_words) = (Vec::new(), Vec::new());
    for (index, object) in reader.referred(dataset, "")?.iter().enumerate() {
        if let Object::Dataset(dataset) = object {
            long_words.extend(words(dataset, budget)?.map(|words| (index, words)));
        }
        cells.push(reader.value(object, "", 0)?);
    }
    Ok(FileWrapper { cells, long_words })
}

/// What a dataset of whole numbers of 64 bits holds.
fn words(dataset: &Dataset, budget: &ReadingBudget<'_>) -> Result<Option<Vec<u64>>, VariableFault> {
    if dataset.element_size().map_err(|error| fault(&error, ""))? != 8 {
        return Ok(None);
    }
    Elements::read(dataset, Order::Columns, "", budget)?.words("", budget)
}
