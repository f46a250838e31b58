//! Directory of the objects: their classes, and where each property value is found.

use crate::formats::mat::cursor::ByteOrder;
use crate::formats::mat::element::decode_name;
use crate::formats::mat::subsystem::damaged;
use crate::reading_budget::VariableFault;

/// Bytes before the names: version, name count, and eight region offsets.
const HEADER_BYTES: usize = 40;
/// Newest supported layout version.
const NEWEST: u32 = 4;

/// Regions of 32-bit words after the names, by index.
#[derive(Clone, Copy)]
enum Region {
    Classes = 0,
    CreatedProperties = 1,
    Objects = 2,
    PlainProperties = 3,
}

#[derive(Clone, Debug)]
pub(super) struct Directory {
    /// Property and class names, counted from 1; 0 means none.
    names: Vec<String>,
    /// Class names by class number; number 0 is unused.
    classes: Vec<String>,
    objects: Vec<ObjectEntry>,
    /// Property lists of objects that are saved as another value, created by their class.
    created: Vec<Vec<Property>>,
    /// Property lists of all other objects.
    plain: Vec<Vec<Property>>,
    /// Number of cells after the property values.
    pub(super) cells_after_values: usize,
}

#[derive(Clone, Copy, Debug)]
struct ObjectEntry {
    /// Class number.
    class: u32,
    /// Index in the created property lists; 0 if the object has a plain list.
    created: u32,
    /// Index in the plain property lists.
    plain: u32,
}

/// An object with its class.
#[derive(Clone, Copy, Debug)]
pub(super) struct ObjectProperties<'d> {
    /// Class number.
    pub(super) class: u32,
    pub(super) properties: &'d [Property],
}

#[derive(Clone, Copy, Debug)]
pub(super) struct Property {
    /// Index of the name, counted from 1.
    pub(super) name: u32,
    pub(super) content: Content,
}

/// Where a property value is found.
#[derive(Clone, Copy, Debug)]
pub(super) enum Content {
    /// The value is the name with this index, counted from 1.
    Name(u32),
    /// The value is in a cell, counted from the first cell with a value.
    Cell(usize),
    /// The value is this integer.
    Number(u32),
}

/// Bytes of a directory with its decoded header.
struct DirectoryBytes<'b> {
    bytes: &'b [u8],
    order: ByteOrder,
    version: u32,
    name_count: usize,
    /// Region offsets \[bytes\]; a region ends where the next begins.
    regions: Vec<u32>,
}

impl Directory {
    /// Reads the bytes of the first cell.
    pub(super) fn read(bytes: &[u8]) -> Result<Self, VariableFault> {
        let bytes = DirectoryBytes::read(bytes)?;
        let names = bytes.names()?;
        let mut directory = Directory {
            names,
            classes: Vec::new(),
            objects: object_entries(&bytes.words(Region::Objects)?),
            created: property_lists(&bytes.words(Region::CreatedProperties)?)?,
            plain: property_lists(&bytes.words(Region::PlainProperties)?)?,
            cells_after_values: match bytes.version {
                4 => 3,
                3 => 2,
                _ => 1,
            },
        };
        directory.classes = bytes
            .words(Region::Classes)?
            .chunks_exact(4)
            .map(|class| directory.qualified_name(class))
            .collect();
        Ok(directory)
    }

    /// Returns the full name of a class, from the indices of its package name and its own name.
    fn qualified_name(&self, words: &[u32]) -> String {
        let package = self.name_or_empty(words.first());
        let name = self.name_or_empty(words.get(1));
        if package.is_empty() {
            name.to_owned()
        } else {
            format!("{package}.{name}")
        }
    }

    fn name_or_empty(&self, number: Option<&u32>) -> &str {
        number
            .and_then(|&number| self.name(number))
            .unwrap_or_default()
    }

    /// Returns the name of a property or class by its index, counted from 1.
    pub(super) fn name(&self, number: u32) -> Option<&str> {
        self.names
            .get((number as usize).checked_sub(1)?)
            .map(String::as_str)
    }

    /// Returns a class name by the class number.
    pub(super) fn class(&self, number: u32) -> Option<&str> {
        if number == 0 {
            None
        } else {
            self.classes.get(number as usize).map(String::as_str)
        }
    }

    /// Returns an object by its number.
    pub(super) fn object(&self, number: u32) -> Option<ObjectProperties<'_>> {
        let entry = self.objects.get(number as usize)?;
        let properties = if entry.created == 0 {
            self.plain.get(entry.plain as usize)?
        } else {
            self.created.get(entry.created as usize)?
        };
        Some(ObjectProperties {
            class: entry.class,
            properties,
        })
    }

    /// Whether an object with this number exists; 0 marks a deleted object.
    pub(super) fn has_object(&self, number: u32) -> bool {
        number == 0 || (number as usize) < self.objects.len()
    }
}

impl<'b> DirectoryBytes<'b> {
    /// Reads the header.
    fn read(bytes: &'b [u8]) -> Result<Self, VariableFault> {
        let head = bytes.get(..HEADER_BYTES).unwrap_or_default();
        let little = decode_words(head, ByteOrder::Little);
        let big = decode_words(head, ByteOrder::Big);
        // A version is a small number and becomes large in the wrong byte order.
        let order = if little.first() <= big.first() {
            ByteOrder::Little
        } else {
            ByteOrder::Big
        };
        let head = match order {
            ByteOrder::Little => little,
            ByteOrder::Big => big,
        };
        let &[version, name_count, ref regions @ ..] = head.as_slice() else {
            return Err(damaged("the directory of objects is cut off"));
        };
        if !(1..=NEWEST).contains(&version) {
            return Err(damaged(format!(
                "the directory of objects has the unknown version {version}"
            )));
        }
        Ok(Self {
            bytes,
            order,
            version,
            name_count: name_count as usize,
            regions: regions.to_vec(),
        })
    }

    /// Reads the names, each followed by a zero, between the header and the first region.
    fn names(&self) -> Result<Vec<String>, VariableFault> {
        let first = self.regions.first().map_or(0, |&at| at as usize);
        let Some(names) = self.bytes.get(HEADER_BYTES..first) else {
            return Err(damaged("the names of objects are cut off"));
        };
        Ok(names
            .split(|&byte| byte == 0)
            .take(self.name_count)
            .map(decode_name)
            .collect())
    }

    fn words(&self, region: Region) -> Result<Vec<u32>, VariableFault> {
        let number = region as usize;
        let words = match self.regions.get(number..number + 2) {
            Some(&[from, to]) => self.bytes.get(from as usize..to as usize),
            _ => None,
        };
        match words {
            Some(bytes) => Ok(decode_words(bytes, self.order)),
            None => Err(damaged("the directory of objects exceeds its cell")),
        }
    }
}

/// Decodes consecutive 32-bit words; incomplete words at the end are ignored.
fn decode_words(bytes: &[u8], order: ByteOrder) -> Vec<u32> {
    let (words, _) = bytes.as_chunks();
    words.iter().map(|&word| order.u32(word)).collect()
}

/// Decodes the object entries, six words each.
fn object_entries(words: &[u32]) -> Vec<ObjectEntry> {
    let (entries, _) = words.as_chunks();
    entries
        .iter()
        .map(|&[class, _, _, created, plain, _]| ObjectEntry {
            class,
            created,
            plain,
        })
        .collect()
}

/// Decodes consecutive property lists, each preceded by its length and padded to eight bytes.
fn property_lists(words: &[u32]) -> Result<Vec<Vec<Property>>, VariableFault> {
    let mut lists = Vec::new();
    let mut rest = words;
    while let [count, after @ ..] = rest {
        let length = (*count as usize).saturating_mul(3);
        let Some((list, after)) = after.split_at_checked(length) else {
            return Err(damaged("the properties of an object are cut off"));
        };
        let (properties, _) = list.as_chunks();
        lists.push(properties.iter().copied().map(decode_property).collect());
        rest = after.get((length + 1) % 2..).unwrap_or_default();
    }
    Ok(lists)
}

fn decode_property([name, kind, value]: [u32; 3]) -> Property {
    let content = match kind {
        0 => Content::Name(value),
        1 => Content::Cell(value as usize),
        _ => Content::Number(value),
    };
    Property { name, content }
}
