//! Objects of MATLAB's classes, which lie in a part of the file of their own.

use hdf5_pure::{Dataset, Object};

use super::dataset::{Elements, Order};
use super::fault::fault;
use super::opened::Opened;
use super::reader::Reader;
use crate::variables::{Array, MemoryBudget, Value, VariableFault};

/// The part of the file in which the objects lie (`#subsystem#/MCOS`).
#[derive(Clone, Debug, PartialEq)]
pub struct FileWrapper {
    /// The cells, the first of which are the bytes of the directory.
    pub cells: Vec<Value>,
    /// The cells of whole numbers of 64 bits, to the last digit, with the number of the cell, counted from 0.
    pub long_words: Vec<(usize, Vec<u64>)>,
}

/// Gives the value of a reference such as `[0xDD000000, dimensions, …, class]`, for a variable of this name.
pub type ObjectDecoder<'d> = dyn Fn(&[u32], &str, &MemoryBudget<'_>) -> Result<Value, VariableFault> + 'd;

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
        meter: &MemoryBudget<'_>,
        decoder: impl FnOnce(FileWrapper) -> Result<Box<ObjectDecoder<'d>>, VariableFault>,
    ) -> Result<Self, VariableFault> {
        let Ok(dataset) = opened.root().group("#subsystem#").and_then(|group| group.dataset("MCOS")) else {
            return Ok(Self::Opaque("the file has no part in which objects lie"));
        };
        match wrapper(&dataset, meter).and_then(decoder) {
            Ok(decoder) => Ok(Self::Decoded(decoder)),
            Err(fault @ (VariableFault::Stopped | VariableFault::TooLarge { .. })) => Err(fault),
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
        meter: &MemoryBudget<'_>,
    ) -> Result<Value, VariableFault> {
        let opaque = |why: &str| Ok(Value::Opaque { class: class.to_owned(), why: why.to_owned() });
        match self {
            Self::References => Ok(Value::Array(reference)),
            Self::Opaque(why) => opaque(why),
            Self::Faulty(why) => opaque(why),
            Self::Decoded(decoder) => {
                let word = |&number: &f64| (0.0..=f64::from(u32::MAX)).contains(&number).then_some(number as u32);
                match reference.re.iter().map(word).collect::<Option<Vec<u32>>>() {
                    Some(words) => decoder(&words, path, meter),
                    None => opaque("what refers to it is damaged"),
                }
            }
        }
    }
}

fn wrapper(dataset: &Dataset, meter: &MemoryBudget<'_>) -> Result<FileWrapper, VariableFault> {
    let reader = Reader { meter, objects: &Objects::References };
    let (mut cells, mut long_words) = (Vec::new(), Vec::new());
    for (index, object) in reader.referred(dataset, "")?.iter().enumerate() {
        if let Object::Dataset(dataset) = object {
            long_words.extend(words(dataset, meter)?.map(|words| (index, words)));
        }
        cells.push(reader.value(object, "", 0)?);
    }
    Ok(FileWrapper { cells, long_words })
}

/// What a dataset of whole numbers of 64 bits holds.
fn words(dataset: &Dataset, meter: &MemoryBudget<'_>) -> Result<Option<Vec<u64>>, VariableFault> {
    if dataset.element_size().map_err(|error| fault(&error, ""))? != 8 {
        return Ok(None);
    }
    Elements::read(dataset, Order::Columns, "", meter)?.words("", meter)
}
