//! Objects of MATLAB classes, stored in a separate part of the file: the dataset
//! `#subsystem#/MCOS`, whose elements are references to cells. The first cell is the directory,
//! which lists the objects; other cells hold the values of their properties. The cells are the same
//! as in files up to version 7, and are explained in `mat/subsystem/mod.rs`.

use hdf5_pure::{Dataset, File, Object};

use crate::formats::mat::{LongWords, Subsystem};
use crate::formats::mat73::dataset::{Elements, Order};
use crate::formats::mat73::library_fault::library_fault;
use crate::formats::mat73::object_references::Objects;
use crate::formats::mat73::reader::{OUTERMOST, Reader};
use crate::formats::variables::Value;
use crate::reading_budget::{ReadingBudget, VariableFault};
use crate::variable_fault::unread::Unread;

/// Size of a 64-bit element, integer or double \[bytes\].
const LONG_ELEMENT: u64 = 8;

/// Cells of the object part; `long_words` contains those with 64-bit integers unrounded, by cell
/// index.
pub(super) struct ObjectCells {
    /// Cells; the first holds the directory.
    pub(super) cells: Vec<Value>,
    pub(super) long_words: LongWords,
}

/// Reads the object part. If it is missing or cannot be read, the objects are marked as unread and
/// the other variables stay readable; the only errors are an exhausted budget and a cancellation.
pub(super) fn read_objects(
    file: &File,
    budget: &ReadingBudget<'_>,
) -> Result<Objects, VariableFault> {
    let root = file.root();
    let part = root
        .group("#subsystem#")
        .and_then(|group| group.dataset("MCOS"));
    let Ok(part) = part else {
        return Ok(Objects::Unread(Unread::NoObjectPart));
    };
    match read_subsystem(&part, budget) {
        Ok(subsystem) => Ok(Objects::Read(subsystem)),
        Err(fault) if fault.is_of_the_budget() => Err(fault),
        Err(fault) => Ok(Objects::Unread(Unread::ObjectPart(fault))),
    }
}

fn read_subsystem(part: &Dataset, budget: &ReadingBudget<'_>) -> Result<Subsystem, VariableFault> {
    let ObjectCells { cells, long_words } = read_cells(part, budget)?;
    Ok(Subsystem::new(cells, budget)?.with_long_words(long_words))
}

/// Reads the object part's cells. Cells with 64-bit integers are also read without rounding:
/// `string` objects are packed into such integers, and a [`Value`] would keep only 53 bits.
pub(super) fn read_cells(
    part: &Dataset,
    budget: &ReadingBudget<'_>,
) -> Result<ObjectCells, VariableFault> {
    let reader = Reader {
        budget,
        // Properties may refer to objects; these references stay integers.
        objects: &Objects::References,
    };
    let mut cells = Vec::new();
    let mut long_words = LongWords::new();
    for (index, object) in reader.referenced_objects(part, "")?.iter().enumerate() {
        if let Object::Dataset(dataset) = object {
            let size = dataset
                .element_size()
                .map_err(|error| library_fault(&error, ""))?;
            if size == LONG_ELEMENT {
                let elements = Elements::read(dataset, Order::Columns, "", budget)?;
                // `None` for doubles.
                if let Some(words) = elements.words("", budget)? {
                    long_words.insert(index, words);
                }
            }
        }
        cells.push(reader.value(object, "", OUTERMOST)?);
    }
    Ok(ObjectCells { cells, long_words })
}
