//! Builders of MATLAB file bytes for tests.
//!
//! The numbers of types and classes are those of "MAT-File Format" (The MathWorks, level 5), except
//! that of opaque arrays, which is not documented there, like the layout of objects.

/// Types of data elements (miINT8 and so on).
mod data_type {
    pub(super) const INT8: u32 = 1;
    pub(super) const UINT8: u32 = 2;
    pub(super) const INT32: u32 = 5;
    pub(super) const UINT32: u32 = 6;
    pub(super) const DOUBLE: u32 = 9;
    pub(super) const UINT64: u32 = 13;
    pub(super) const MATRIX: u32 = 14;
    pub(super) const UTF8: u32 = 16;
}

/// Classes of arrays (mxCELL_CLASS and so on).
mod array_class {
    pub(super) const CELL: u32 = 1;
    pub(super) const STRUCT: u32 = 2;
    pub(super) const CHAR: u32 = 4;
    pub(super) const DOUBLE: u32 = 6;
    pub(super) const UINT8: u32 = 9;
    pub(super) const UINT32: u32 = 13;
    pub(super) const UINT64: u32 = 15;
    pub(super) const OPAQUE: u32 = 17;
}

/// Returns a data element with the type number `kind`, padded to a multiple of eight bytes.
pub(super) fn element(kind: u32, data: &[u8]) -> Vec<u8> {
    let mut bytes = [kind.to_le_bytes(), (data.len() as u32).to_le_bytes()].concat();
    bytes.extend(data);
    bytes.resize(bytes.len().next_multiple_of(8), 0);
    bytes
}

/// Returns an array; `class` includes the flags.
pub(super) fn matrix(class: u32, shape: &[i32], name: &str, contents: &[Vec<u8>]) -> Vec<u8> {
    let flags = element(data_type::UINT32, &[class.to_le_bytes(), [0; 4]].concat());
    let shape = element(
        data_type::INT32,
        &shape
            .iter()
            .flat_map(|side| side.to_le_bytes())
            .collect::<Vec<_>>(),
    );
    let name = element(data_type::INT8, name.as_bytes());
    element(
        data_type::MATRIX,
        &[&[flags, shape, name][..], contents].concat().concat(),
    )
}

/// Returns an array of `double`.
pub(super) fn doubles(name: &str, shape: &[i32], numbers: &[f64]) -> Vec<u8> {
    let data: Vec<u8> = numbers
        .iter()
        .flat_map(|number| number.to_le_bytes())
        .collect();
    matrix(
        array_class::DOUBLE,
        shape,
        name,
        &[element(data_type::DOUBLE, &data)],
    )
}

/// Returns a character array with a single row.
pub(super) fn chars(name: &str, text: &str) -> Vec<u8> {
    matrix(
        array_class::CHAR,
        &[1, text.len() as i32],
        name,
        &[element(data_type::UTF8, text.as_bytes())],
    )
}

/// Returns a struct with one record.
pub(super) fn record(name: &str, fields: &[(&str, Vec<u8>)]) -> Vec<u8> {
    // Every field name takes the same number of bytes.
    const NAME_LENGTH: usize = 32;
    let mut names: Vec<u8> = Vec::new();
    let mut values: Vec<u8> = Vec::new();
    for (number, (field, value)) in fields.iter().enumerate() {
        names.extend(field.as_bytes());
        names.resize((number + 1) * NAME_LENGTH, 0);
        values.extend(value);
    }
    let contents = [
        element(data_type::INT32, &(NAME_LENGTH as i32).to_le_bytes()),
        element(data_type::INT8, &names),
        values,
    ];
    matrix(array_class::STRUCT, &[1, 1], name, &contents)
}

/// Returns a column cell array.
pub(super) fn column(values: &[Vec<u8>]) -> Vec<u8> {
    matrix(array_class::CELL, &[values.len() as i32, 1], "", values)
}

/// Returns an opaque array: an object of `class` in MATLAB's class system MCOS.
pub(super) fn opaque(name: &str, class: &str, contents: Vec<u8>) -> Vec<u8> {
    let flags = [array_class::OPAQUE.to_le_bytes(), [0; 4]].concat();
    let flags = element(data_type::UINT32, &flags);
    let texts = [name, "MCOS", class].map(|text| element(data_type::INT8, text.as_bytes()));
    element(
        data_type::MATRIX,
        &[flags, texts.concat(), contents].concat(),
    )
}

/// Returns a reference to objects of a class: a mark, the number of dimensions, the shape, the
/// numbers of the objects, and the number of the class.
pub(super) fn reference(objects: &[u32], class: u32) -> Vec<u8> {
    let words = [
        &[0xdd00_0000, 2, 1, objects.len() as u32][..],
        objects,
        &[class],
    ]
    .concat();
    words_of(&words)
}

/// Returns a column of 32-bit integers.
pub(super) fn words_of(words: &[u32]) -> Vec<u8> {
    let bytes: Vec<u8> = words.iter().flat_map(|word| word.to_le_bytes()).collect();
    let data = element(data_type::UINT32, &bytes);
    matrix(array_class::UINT32, &[words.len() as i32, 1], "", &[data])
}

/// Returns a row of 64-bit integers.
pub(super) fn long_words_of(words: &[u64]) -> Vec<u8> {
    let bytes: Vec<u8> = words.iter().flat_map(|word| word.to_le_bytes()).collect();
    let data = element(data_type::UINT64, &bytes);
    matrix(array_class::UINT64, &[1, words.len() as i32], "", &[data])
}

/// Returns a file with these elements and no objects.
pub(super) fn file(elements: &[u8]) -> Vec<u8> {
    file_with_objects(elements, None)
}

/// Returns a file with these elements and, if given, the cells of its objects.
pub(super) fn file_with_objects(elements: &[u8], cells: Option<&[Vec<u8>]>) -> Vec<u8> {
    let mut bytes = b"MATLAB 5.0 MAT-file, by hand".to_vec();
    // The heading: 116 bytes of text, the offset of the objects, the version, the byte order.
    bytes.resize(116, b' ');
    let objects_at = if cells.is_some() {
        128 + elements.len() as u64
    } else {
        0
    };
    bytes.extend(objects_at.to_le_bytes());
    bytes.extend(b"\0\x01IM");
    bytes.extend(elements);
    if let Some(cells) = cells {
        let wrapper = record("", &[("MCOS", opaque("", "FileWrapper__", column(cells)))]);
        let inner = [b"\0\x01IM\0\0\0\0".to_vec(), wrapper].concat();
        bytes.extend(matrix(
            array_class::UINT8,
            &[1, inner.len() as i32],
            "",
            &[element(data_type::UINT8, &inner)],
        ));
    }
    bytes
}

/// Returns a big-endian file with an array of `double`.
pub(super) fn big_file(name: &str, shape: &[i32], numbers: &[f64]) -> Vec<u8> {
    let element = |kind: u32, data: &[u8]| {
        let mut bytes = [kind.to_be_bytes(), (data.len() as u32).to_be_bytes()].concat();
        bytes.extend(data);
        bytes.resize(bytes.len().next_multiple_of(8), 0);
        bytes
    };
    // The compact form of an element with up to four bytes: length and type share a word.
    let small = |text: &str| {
        let mut bytes = ((text.len() as u32) << 16 | data_type::INT8)
            .to_be_bytes()
            .to_vec();
        bytes.extend(text.as_bytes());
        bytes.resize(8, 0);
        bytes
    };
    let contents = [
        element(
            data_type::UINT32,
            &[array_class::DOUBLE.to_be_bytes(), [0; 4]].concat(),
        ),
        element(
            data_type::INT32,
            &shape
                .iter()
                .flat_map(|side| side.to_be_bytes())
                .collect::<Vec<_>>(),
        ),
        small(name),
        element(
            data_type::DOUBLE,
            &numbers
                .iter()
                .flat_map(|number| number.to_be_bytes())
                .collect::<Vec<_>>(),
        ),
    ];
    let mut bytes = vec![b' '; 124];
    bytes.extend(b"\x01\0MI");
    bytes.extend(element(data_type::MATRIX, &contents.concat()));
    bytes
}

/// Contents of an object directory.
pub(super) struct Directory<'d> {
    pub(super) version: u32,
    /// Names of properties and classes, in the order of their indices, which count from 1.
    pub(super) names: &'d [&'d str],
    /// For each class, the indices of its package name and of its own name.
    pub(super) classes: &'d [[u32; 2]],
    /// Property lists of objects that their class saves as another value: index of the name, kind,
    /// value.
    pub(super) made: &'d [&'d [[u32; 3]]],
    /// For each object, the class number, the index in `made` and the index in `plain`, from 1; 0
    /// for none.
    pub(super) objects: &'d [[u32; 3]],
    /// Property lists of the other objects: index of the name, kind, value.
    pub(super) plain: &'d [&'d [[u32; 3]]],
}

impl Directory<'_> {
    /// Returns the directory as the first cell of the object part.
    pub(super) fn cell(&self) -> Vec<u8> {
        let bytes = self.bytes();
        let data = element(data_type::UINT8, &bytes);
        matrix(array_class::UINT8, &[bytes.len() as i32, 1], "", &[data])
    }

    fn bytes(&self) -> Vec<u8> {
        let mut names: Vec<u8> = self
            .names
            .iter()
            .flat_map(|name| [name.as_bytes(), b"\0"].concat())
            .collect();
        names.resize(names.len().next_multiple_of(8), 0);
        // Indices count from 1: each region begins with an empty entry.
        let mut classes: Vec<u32> = vec![0; 4];
        for &[package, name] in self.classes {
            classes.extend([package, name, 0, 0]);
        }
        let mut objects: Vec<u32> = vec![0; 6];
        for &[class, made, plain] in self.objects {
            objects.extend([class, 0, 0, made, plain, 0]);
        }
        let regions = [
            classes,
            property_lists(self.made),
            objects,
            property_lists(self.plain),
            vec![0, 0],
            vec![],
            vec![0, 0],
        ];
        // The head has ten words of four bytes: version, number of names, the offsets of the seven
        // regions and of their end.
        let mut at = 40 + names.len() as u32;
        let mut head = vec![self.version, self.names.len() as u32];
        for region in &regions {
            head.push(at);
            at += 4 * region.len() as u32;
        }
        head.push(at);
        [
            little_endian(&head),
            names,
            little_endian(&regions.concat()),
        ]
        .concat()
    }
}

/// Returns the region of property lists: an empty entry, then each list with its length in front,
/// padded to a multiple of two words.
fn property_lists(lists: &[&[[u32; 3]]]) -> Vec<u32> {
    let mut words: Vec<u32> = vec![0; 2];
    for list in lists {
        words.push(list.len() as u32);
        words.extend(list.as_flattened());
        words.resize(words.len().next_multiple_of(2), 0);
    }
    words
}

fn little_endian(words: &[u32]) -> Vec<u8> {
    words.iter().flat_map(|word| word.to_le_bytes()).collect()
}
