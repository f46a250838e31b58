//! Which objects a file has, and where their properties lie.

use super::damaged;
use crate::variables::VariableFault;

use super::super::cursor::ByteOrder;
use super::super::element::name_of;

/// The bytes before the names: version, number of names, and where eight regions begin.
const HEADER_BYTES: usize = 40;
/// The newest version of the layout that is known.
const NEWEST: u32 = 4;

/// Which objects a file has, and where their properties lie.
#[derive(Clone, Debug)]
pub(super) struct Directory {
    /// Names of properties and classes. They are counted from 1: 0 means none.
    names: Vec<String>,
    /// Names of the classes, counted from 1 as well.
    classes: Vec<String>,
    objects: Vec<Entry>,
    /// Properties of objects that are saved as another value, which their class makes of them.
    made: Vec<Vec<Property>>,
    /// Properties of all other objects.
    plain: Vec<Vec<Property>>,
    /// Number of cells that follow those of the properties' values.
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
    /// Number of its name.
    pub(super) name: u32,
    /// What the value's number means.
    pub(super) content: Content,
}

/// Where the value of a property is.
#[derive(Clone, Copy, Debug)]
pub(super) enum Content {
    /// It is a name.
    Name(u32),
    /// It lies in a cell, counted from the first that holds a value.
    Cell(usize),
    /// It is this number.
    Number(u32),
}

impl Directory {
    /// Reads the bytes of the first cell.
    pub(super) fn read(bytes: &[u8]) -> Result<Self, VariableFault> {
        let words = |order: ByteOrder| -> Vec<u32> {
            bytes.get(..HEADER_BYTES).unwrap_or_default().as_chunks().0.iter().map(|&word| order.u32(word)).collect()
        };
        let (little, big) = (words(ByteOrder::Little), words(ByteOrder::Big));
        // A version is a small number: read in the wrong order it is a large one.
        let is_little = little.first() <= big.first();
        let (order, head) = if is_little { (ByteOrder::Little, little) } else { (ByteOrder::Big, big) };
        let [version, count, regions @ ..] = head.as_slice() else {
            return Err(damaged("the directory of objects is cut off"));
        };
        if !(1..=NEWEST).contains(version) {
            return Err(damaged(format!("the directory of objects has the unknown version {version}")));
        }
        let region = |number: usize| region(bytes, regions, number, order);
        let first = regions.first().map_or(0, |&at| at as usize);
        let names = bytes.get(HEADER_BYTES..first).ok_or_else(|| damaged("the names of objects are cut off"))?;
        let names = names.split(|&byte| byte == 0).take(*count as usize).map(name_of).collect();
        let cells_behind_values = match version {
            4 => 3,
            3 => 2,
            _ => 1,
        };
        let mut directory =
            Directory { classes: Vec::new(), names, cells_behind_values, ..Directory::without_names(&region)? };
        directory.classes = region(0)?.chunks_exact(4).map(|class| directory.class_of(class)).collect();
        Ok(directory)
    }

    fn without_names(region: &dyn Fn(usize) -> Result<Vec<u32>, VariableFault>) -> Result<Self, VariableFault> {
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

    /// The name of a class: the package it lies in, and its own.
    fn class_of(&self, words: &[u32]) -> String {
        let name = |at: usize| words.get(at).and_then(|&number| self.name(number)).unwrap_or_default();
        match (name(0), name(1)) {
            ("", name) => name.to_owned(),
            (package, name) => format!("{package}.{name}"),
        }
    }

    /// A name of a property or a class.
    pub(super) fn name(&self, number: u32) -> Option<&str> {
        self.names.get((number as usize).checked_sub(1)?).map(String::as_str)
    }

    /// The name of a class.
    pub(super) fn class(&self, number: u32) -> Option<&str> {
        if number == 0 { None } else { self.classes.get(number as usize).map(String::as_str) }
    }

    /// The class of an object and its properties.
    pub(super) fn object(&self, number: u32) -> Option<(u32, &[Property])> {
        let entry = self.objects.get(number as usize)?;
        let (list, at) = if entry.made == 0 { (&self.plain, entry.plain) } else { (&self.made, entry.made) };
        Some((entry.class, list.get(at as usize)?.as_slice()))
    }

    /// Whether there is an object of this number; 0 stands for one that was deleted.
    pub(super) fn has_object(&self, number: u32) -> bool {
        number == 0 || (number as usize) < self.objects.len()
    }
}

fn region(bytes: &[u8], regions: &[u32], number: usize, order: ByteOrder) -> Result<Vec<u32>, VariableFault> {
    let bounds = regions.get(number).zip(regions.get(number + 1));
    let region = bounds.and_then(|(&from, &to)| bytes.get(from as usize..to as usize));
    let region = region.ok_or_else(|| damaged("a part of the directory of objects lies outside it"))?;
    Ok(region.as_chunks().0.iter().map(|&word| order.u32(word)).collect())
}

/// One list of properties after the other, each with its length before it and filled up to eight bytes.
fn properties(region: &[u32]) -> Result<Vec<Vec<Property>>, VariableFault> {
    let (mut lists, mut rest) = (Vec::new(), region);
    while let [count, after @ ..] = rest {
        let length = (*count as usize).saturating_mul(3);
        let (list, after) =
            after.split_at_checked(length).ok_or_else(|| damaged("the properties of an object are cut off"))?;
        lists.push(list.chunks_exact(3).filter_map(property).collect());
        rest = after.get((length + 1) % 2..).unwrap_or_default();
    }
    Ok(lists)
}

fn property(words: &[u32]) -> Option<Property> {
    let &[name, kind, value] = words else { return None };
    let content = match kind {
        0 => Content::Name(value),
        1 => Content::Cell(value as usize),
        _ => Content::Number(value),
    };
    Some(Property { name, content })
}
