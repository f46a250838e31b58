//! Directory of the objects: the class of each object, and the place of each property value.
//!
//! ```text
//! header     10 words of 32 bits: version, number of names, offsets [bytes] of 8 regions
//! names      of properties and classes, each ended by a zero byte; counted from 1
//! region 0   classes, 4 words each: index of the package name, of the class name, 2 unused
//! region 1   property lists of objects whose class saves another value instead (`created`)
//! region 2   objects, 6 words each: class, 2 unused, index of the list in region 1 (0 if there is
//!            none), index of the list in region 3, 1 unused
//! region 3   property lists of all other objects
//! regions 4 to 7 are not read
//! ```
//!
//! A property list consists of its property count, 3 words per property (name index, content kind,
//! content; [`Content`] lists the kinds), and padding to a multiple of 8 bytes. Classes, objects
//! and lists are counted from 0; their entries 0 are empty.

use crate::formats::mat::cursor::ByteOrder;
use crate::formats::mat::element::decode_name;
use crate::formats::mat::subsystem::damaged;
use crate::reading_budget::VariableFault;
use crate::variable_fault::damage::Damage;

/// Header length \[bytes\].
const HEADER_BYTES: usize = 40;
/// Number of words per class.
const CLASS_WORDS: usize = 4;
/// Number of words per property in a list.
const PROPERTY_WORDS: usize = 3;
/// Newest supported layout version.
const NEWEST: u32 = 4;

/// The regions that are read; the values are their numbers.
#[derive(Clone, Copy)]
enum Region {
    Classes = 0,
    CreatedProperties = 1,
    Objects = 2,
    PlainProperties = 3,
}

#[derive(Clone, Debug)]
pub(super) struct Directory {
    /// Property and class names. Indices count from 1; 0 means none.
    names: Vec<String>,
    /// Class names by class number; class 0 is not used.
    classes: Vec<String>,
    objects: Vec<ObjectEntry>,
    /// Property lists for objects whose class saves another value instead of the object.
    created: Vec<Vec<Property>>,
    /// Property lists for all other objects.
    plain: Vec<Vec<Property>>,
    /// Number of cells after the property values, which depends on the version.
    pub(super) cells_after_values: usize,
}

#[derive(Clone, Copy, Debug)]
struct ObjectEntry {
    class: u32,
    /// Index in `Directory::created`; 0 if the list is in `Directory::plain`.
    created: u32,
    /// Index in `Directory::plain`.
    plain: u32,
}

/// An object's properties, with its class.
#[derive(Clone, Copy, Debug)]
pub(super) struct ObjectProperties<'d> {
    pub(super) class: u32,
    pub(super) properties: &'d [Property],
}

#[derive(Clone, Copy, Debug)]
pub(super) struct Property {
    /// Name index, counted from 1.
    pub(super) name: u32,
    pub(super) content: Content,
}

/// Value of a property, or its place.
#[derive(Clone, Copy, Debug)]
pub(super) enum Content {
    /// The value is the name with this index, counted from 1.
    Name(u32),
    /// The value is in the cell with this index among the value cells, counted from 0.
    Cell(usize),
    /// The value is this integer, or this logical value (0 or 1).
    Number(u32),
}

/// A directory's bytes, with its decoded header.
struct DirectoryBytes<'b> {
    bytes: &'b [u8],
    order: ByteOrder,
    version: u32,
    name_count: usize,
    /// Region offsets \[bytes\]; a region ends where the next begins.
    regions: Vec<u32>,
}

impl Directory {
    /// Reads the directory from the first cell's bytes.
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
            .chunks_exact(CLASS_WORDS)
            .map(|class| directory.qualified_name(class))
            .collect();
        Ok(directory)
    }

    /// Returns the class name with its package, from the words of a class.
    fn qualified_name(&self, words: &[u32]) -> String {
        let package = self.name_or_empty(words.first());
        let name = self.name_or_empty(words.get(1));
        if package.is_empty() {
            name.to_owned()
        } else {
            format!("{package}.{name}")
        }
    }

    /// Returns the name at an index, counted from 1; empty if there is no such name.
    fn name_or_empty(&self, number: Option<&u32>) -> &str {
        number
            .and_then(|&number| self.name(number))
            .unwrap_or_default()
    }

    /// Returns the property or class name at an index, counted from 1.
    pub(super) fn name(&self, number: u32) -> Option<&str> {
        self.names
            .get((number as usize).checked_sub(1)?)
            .map(String::as_str)
    }

    /// Returns the name of a class; `None` for 0 and unknown class numbers.
    pub(super) fn class(&self, number: u32) -> Option<&str> {
        if number == 0 {
            None
        } else {
            self.classes.get(number as usize).map(String::as_str)
        }
    }

    /// Returns the properties of the object with this number; `None` if the object or its property
    /// list is missing.
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

    /// Returns whether an object number is valid; 0, a deleted object, is valid.
    pub(super) fn has_object(&self, number: u32) -> bool {
        number == 0 || (number as usize) < self.objects.len()
    }
}

impl<'b> DirectoryBytes<'b> {
    /// Reads the header, and determines the byte order from the version.
    fn read(bytes: &'b [u8]) -> Result<Self, VariableFault> {
        let head = bytes.get(..HEADER_BYTES).unwrap_or_default();
        let little = decode_words(head, ByteOrder::Little);
        let big = decode_words(head, ByteOrder::Big);
        // The version is a small number; in the wrong byte order it would be large.
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
            return Err(damaged(Damage::DirectoryCutOff));
        };
        if !(1..=NEWEST).contains(&version) {
            return Err(damaged(Damage::DirectoryVersion { version }));
        }
        Ok(Self {
            bytes,
            order,
            version,
            name_count: name_count as usize,
            regions: regions.to_vec(),
        })
    }

    /// Reads the names, each ended by a zero byte, between the header and the first region.
    fn names(&self) -> Result<Vec<String>, VariableFault> {
        let first = self.regions.first().map_or(0, |&at| at as usize);
        let Some(names) = self.bytes.get(HEADER_BYTES..first) else {
            return Err(damaged(Damage::ObjectNamesCutOff));
        };
        Ok(names
            .split(|&byte| byte == 0)
            .take(self.name_count)
            .map(decode_name)
            .collect())
    }

    /// Returns a region's words.
    fn words(&self, region: Region) -> Result<Vec<u32>, VariableFault> {
        let number = region as usize;
        let words = match self.regions.get(number..number + 2) {
            Some(&[from, to]) => self.bytes.get(from as usize..to as usize),
            _ => None,
        };
        match words {
            Some(bytes) => Ok(decode_words(bytes, self.order)),
            None => Err(damaged(Damage::DirectoryLength)),
        }
    }
}

/// Decodes consecutive 32-bit words; ignores an incomplete word at the end.
fn decode_words(bytes: &[u8], order: ByteOrder) -> Vec<u32> {
    let (words, _) = bytes.as_chunks();
    words.iter().map(|&word| order.u32(word)).collect()
}

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

/// Decodes consecutive property lists.
fn property_lists(words: &[u32]) -> Result<Vec<Vec<Property>>, VariableFault> {
    let mut lists = Vec::new();
    let mut rest = words;
    while let [count, after @ ..] = rest {
        let length = (*count as usize).saturating_mul(PROPERTY_WORDS);
        let Some((list, after)) = after.split_at_checked(length) else {
            return Err(damaged(Damage::PropertiesCutOff));
        };
        let (properties, _) = list.as_chunks();
        lists.push(properties.iter().copied().map(decode_property).collect());
        // With its count, a list has `length` + 1 words; one padding word follows if this number is
        // odd.
        let padding = (length + 1) % 2;
        rest = after.get(padding..).unwrap_or_default();
    }
    Ok(lists)
}

fn decode_property([name, kind, content]: [u32; PROPERTY_WORDS]) -> Property {
    let content = match kind {
        0 => Content::Name(content),
        1 => Content::Cell(content as usize),
        _ => Content::Number(content),
    };
    Property { name, content }
}
