//! Builders of MATLAB file bytes for tests.

/// Returns a data element with the type number `kind`.
pub(super) fn element(kind: u32, data: &[u8]) -> Vec<u8> {
    let mut bytes = [kind.to_le_bytes(), (data.len() as u32).to_le_bytes()].concat();
    bytes.extend(data);
    bytes.resize(bytes.len().next_multiple_of(8), 0);
    bytes
}

/// Returns an array; `class` includes the flags.
pub(super) fn matrix(class: u32, shape: &[i32], name: &str, contents: &[Vec<u8>]) -> Vec<u8> {
    let flags = element(6, &[class.to_le_bytes(), [0; 4]].concat());
    let shape = element(
        5,
        &shape
            .iter()
            .flat_map(|side| side.to_le_bytes())
            .collect::<Vec<_>>(),
    );
    let name = element(1, name.as_bytes());
    element(14, &[&[flags, shape, name][..], contents].concat().concat())
}

/// Returns an array of `double`.
pub(super) fn doubles(name: &str, shape: &[i32], numbers: &[f64]) -> Vec<u8> {
    let data: Vec<u8> = numbers
        .iter()
        .flat_map(|number| number.to_le_bytes())
        .collect();
    matrix(6, shape, name, &[element(9, &data)])
}

/// Returns a character array with a single row.
pub(super) fn chars(name: &str, text: &str) -> Vec<u8> {
    matrix(
        4,
        &[1, text.len() as i32],
        name,
        &[element(16, text.as_bytes())],
    )
}

/// Returns a struct with one record.
pub(super) fn record(name: &str, fields: &[(&str, Vec<u8>)]) -> Vec<u8> {
    let names = fields.iter().flat_map(|(field, _)| {
        let mut bytes = field.as_bytes().to_vec();
        bytes.resize(32, 0);
        bytes
    });
    let values = fields.iter().flat_map(|(_, value)| value.clone());
    let contents = [
        element(5, &32_i32.to_le_bytes()),
        element(1, &names.collect::<Vec<_>>()),
        values.collect(),
    ];
    matrix(2, &[1, 1], name, &contents)
}

/// Returns a column cell array.
pub(super) fn column(values: &[Vec<u8>]) -> Vec<u8> {
    matrix(1, &[values.len() as i32, 1], "", values)
}

/// Returns an opaque array.
pub(super) fn opaque(name: &str, class: &str, contents: Vec<u8>) -> Vec<u8> {
    let flags = element(6, &[17_u32.to_le_bytes(), [0; 4]].concat());
    let texts = [name, "MCOS", class].map(|text| element(1, text.as_bytes()));
    element(14, &[flags, texts.concat(), contents].concat())
}

/// Returns a reference to objects.
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
    matrix(13, &[words.len() as i32, 1], "", &[element(6, &bytes)])
}

/// Returns a row of 64-bit integers.
pub(super) fn long_words_of(words: &[u64]) -> Vec<u8> {
    let bytes: Vec<u8> = words.iter().flat_map(|word| word.to_le_bytes()).collect();
    matrix(15, &[1, words.len() as i32], "", &[element(13, &bytes)])
}

/// Returns a file with these elements and no objects.
pub(super) fn file(elements: &[u8]) -> Vec<u8> {
    file_with_objects(elements, None)
}

/// Returns a file with these elements and, if given, the cells of its objects.
pub(super) fn file_with_objects(elements: &[u8], cells: Option<&[Vec<u8>]>) -> Vec<u8> {
    let mut bytes = b"MATLAB 5.0 MAT-file, by hand".to_vec();
    bytes.resize(116, b' ');
    let at = if cells.is_some() {
        128 + elements.len() as u64
    } else {
        0
    };
    bytes.extend(at.to_le_bytes());
    bytes.extend(b"\0\x01IM");
    bytes.extend(elements);
    if let Some(cells) = cells {
        let wrapper = record("", &[("MCOS", opaque("", "FileWrapper__", column(cells)))]);
        let inner = [b"\0\x01IM\0\0\0\0".to_vec(), wrapper].concat();
        bytes.extend(matrix(
            9,
            &[1, inner.len() as i32],
            "",
            &[element(2, &inner)],
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
    let small = |text: &str| {
        let mut bytes = ((text.len() as u32) << 16 | 1).to_be_bytes().to_vec();
        bytes.extend(text.as_bytes());
        bytes.resize(8, 0);
        bytes
    };
    let contents = [
        element(6, &[6_u32.to_be_bytes(), [0; 4]].concat()),
        element(
            5,
            &shape
                .iter()
                .flat_map(|side| side.to_be_bytes())
                .collect::<Vec<_>>(),
        ),
        small(name),
        element(
            9,
            &numbers
                .iter()
                .flat_map(|number| number.to_be_bytes())
                .collect::<Vec<_>>(),
        ),
    ];
    let mut bytes = vec![b' '; 124];
    bytes.extend(b"\x01\0MI");
    bytes.extend(element(14, &contents.concat()));
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
        matrix(9, &[bytes.len() as i32, 1], "", &[element(2, &bytes)])
    }

    fn bytes(&self) -> Vec<u8> {
        let mut names: Vec<u8> = self
            .names
            .iter()
            .flat_map(|name| [name.as_bytes(), b"\0"].concat())
            .collect();
        names.resize(names.len().next_multiple_of(8), 0);
        let lists = |lists: &[&[[u32; 3]]]| {
            let list = |list: &&[[u32; 3]]| {
                let mut words = [&[list.len() as u32][..], list.as_flattened()].concat();
                words.resize(words.len().next_multiple_of(2), 0);
                words
            };
            [0, 0]
                .into_iter()
                .chain(lists.iter().flat_map(list))
                .collect::<Vec<u32>>()
        };
        let classes: Vec<u32> = [[0; 2]]
            .iter()
            .chain(self.classes)
            .flat_map(|&[package, name]| [package, name, 0, 0])
            .collect();
        let objects: Vec<u32> = [[0; 3]]
            .iter()
            .chain(self.objects)
            .flat_map(|&[class, made, plain]| [class, 0, 0, made, plain, 0])
            .collect();
        let regions = [
            classes,
            lists(self.made),
            objects,
            lists(self.plain),
            vec![0, 0],
            vec![],
            vec![0, 0],
        ];
        let mut at = 40 + names.len() as u32;
        let mut head = vec![self.version, self.names.len() as u32];
        for region in &regions {
            head.push(at);
            at += 4 * region.len() as u32;
        }
        head.push(at);
        let words = |words: Vec<u32>| {
            words
                .into_iter()
                .flat_map(u32::to_le_bytes)
                .collect::<Vec<u8>>()
        };
        [words(head), names, words(regions.concat())].concat()
    }
}
