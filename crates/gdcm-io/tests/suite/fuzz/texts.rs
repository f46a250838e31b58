//! Random generators of text files: JSON of any structure and of this program, tables, matrices in
//! MATLAB and Python syntax; also NumPy arrays, whose headers are text, and archives.

use std::io::Write;

use flate2::Compression;
use flate2::write::{DeflateEncoder, GzEncoder};
use serde_json::{Value, json};

use super::{CORPUS, Dice, NAMES, NamedBytes};

/// Generates JSON of any structure, compressed or not, sometimes repeated many times.
pub(super) fn json(dice: &mut Dice) -> NamedBytes {
    let value = tree(dice, 5);
    let mut text = value.to_string();
    if dice.once_in(40) {
        text = format!(
            "[{}]",
            vec![text.as_str(); 1 + 100_000 / text.len().max(1)].join(",")
        );
    }
    if dice.once_in(5) {
        ("f.json.gz".to_owned(), gzip(text.as_bytes()))
    } else {
        ("f.json".to_owned(), text.into())
    }
}

/// Generates a JSON value; `depth` limits the nesting.
fn tree(dice: &mut Dice, depth: usize) -> Value {
    let count = dice.below(4);
    match dice.below(if depth == 0 { 4 } else { 9 }) {
        0 => Value::Null,
        1 => json!(*dice.pick(&NAMES)),
        2 => json!(dice.once_in(2)),
        3 => json!(dice.number()),
        4 | 5 => (0..count).map(|_| tree(dice, depth - 1)).collect(),
        6 => {
            // A rectangular array of numbers.
            let width = dice.below(4);
            (0..count)
                .map(|_| (0..width).map(|_| json!(dice.number())).collect::<Value>())
                .collect()
        }
        _ => {
            let members =
                (0..count).map(|_| ((*dice.pick(&NAMES)).to_owned(), tree(dice, depth - 1)));
            Value::Object(members.collect())
        }
    }
}

fn gzip(text: &[u8]) -> Vec<u8> {
    let mut encoder = GzEncoder::new(Vec::new(), Compression::fast());
    encoder.write_all(text).unwrap();
    encoder.finish().unwrap()
}

/// Returns a JSON file of the corpus in which one to three values are changed.
pub(super) fn program_json(dice: &mut Dice) -> NamedBytes {
    let files: Vec<&NamedBytes> = CORPUS
        .iter()
        .filter(|(name, _)| name.ends_with(".json"))
        .collect();
    let (name, bytes) = *dice.pick(&files);
    let Ok(mut value) = serde_json::from_slice::<Value>(bytes) else {
        return (name.clone(), bytes.clone());
    };
    for _ in 0..1 + dice.below(3) {
        change(&mut value, dice);
    }
    (name.clone(), value.to_string().into_bytes())
}

/// Changes a value at a random place of a JSON tree: descends into the tree, and at each level
/// replaces the value with a probability of 1 / 6.
fn change(value: &mut Value, dice: &mut Dice) {
    let is_replaced = dice.once_in(6);
    match value {
        Value::Array(list) if !is_replaced && !list.is_empty() => {
            let at = dice.below(list.len());
            match dice.below(12) {
                0 => drop(list.remove(at)),
                1 => list.push(list[at].clone()),
                _ => change(&mut list[at], dice),
            }
        }
        Value::Object(members) if !is_replaced && !members.is_empty() => {
            let name = members
                .keys()
                .nth(dice.below(members.len()))
                .cloned()
                .unwrap_or_default();
            match dice.below(16) {
                0 => drop(members.remove(&name)),
                1 => drop(members.insert((*dice.pick(&NAMES)).to_owned(), tree(dice, 1))),
                _ => {
                    if let Some(member) = members.get_mut(&name) {
                        change(member, dice);
                    }
                }
            }
        }
        Value::Number(_) if !dice.once_in(8) => *value = json!(dice.number()),
        _ => *value = tree(dice, 2),
    }
}

/// Generates a table of numbers with one of many separators, with or without headings.
pub(super) fn table(dice: &mut Dice) -> NamedBytes {
    let separator = *dice.pick(&[",", ";", "\t", " ", "  ", "|", ", "]);
    let headings = [
        "omega [rad/s]",
        "f (Hz)",
        "mag [dB]",
        "|H|",
        "phase [deg]",
        "ph",
        "coherence",
        "coh %",
        "re",
        "im",
        "time",
        "t [s]",
        "LON",
        "NZ",
        "Q [deg/s]",
        "-az",
        "run",
        "\"a;b\"",
        "",
        "\u{1b}[31m",
        "=1+1",
    ];
    let width = 1 + dice.below(5);
    let mut lines = Vec::new();
    if dice.once_in(4) {
        lines.push(
            ["# comment", "% x", "sep=;", "A =", "\u{feff}", "units"][dice.below(6)].to_owned(),
        );
    }
    if !dice.once_in(4) {
        lines.push(
            (0..width)
                .map(|_| *dice.pick(&headings))
                .collect::<Vec<_>>()
                .join(separator),
        );
    }
    let number = |dice: &mut Dice, row: usize| match dice.below(40) {
        0 => [
            "NaN", "inf", "-", "", "1e999", "1,5", "0x10", "1.0D+00", "12:30:01", "on", "1+2i",
            "\"1\"",
        ][dice.below(12)]
        .to_owned(),
        1 => dice.number().to_string(),
        _ => format!("{}", row as f64 * 0.25 + dice.below(100) as f64 / 100.0),
    };
    for row in 0..dice.below(40) {
        let width = if dice.once_in(60) {
            dice.below(9)
        } else {
            width
        };
        lines.push(
            (0..width)
                .map(|_| number(dice, row))
                .collect::<Vec<_>>()
                .join(separator),
        );
    }
    let mut text = lines.join(*dice.pick(&["\n", "\n", "\r\n", "\r"]));
    if dice.once_in(60) {
        text = text.repeat(1 + 200_000 / text.len().max(1));
    }
    let name = ["f.csv", "f.txt", "A.csv", "f_P_LAT.txt", "f.dat"][dice.below(5)];
    if dice.once_in(15) {
        let units = text.encode_utf16().flat_map(u16::to_le_bytes);
        return (
            name.to_owned(),
            [0xff, 0xfe].into_iter().chain(units).collect(),
        );
    }
    (name.to_owned(), text.into_bytes())
}

/// Generates assignments in the syntax of MATLAB, GNU Octave and Python.
pub(super) fn literals(dice: &mut Dice) -> NamedBytes {
    let mut text = String::new();
    for _ in 0..1 + dice.below(6) {
        let name = *dice.pick(&NAMES);
        let value = literal(dice, 3);
        text += &match dice.below(8) {
            0 => format!("{name}.{} = {value};\n", dice.pick(&NAMES)),
            1 => format!("% {name}\n"),
            2 => format!("sys = ss({name}, B, C, {value});\n"),
            3 => format!("{name} = ...\n {value}\n"),
            _ => format!("{name} = {value};\n"),
        };
    }
    (
        if dice.once_in(3) { "f.py" } else { "f.m" }.to_owned(),
        text.into_bytes(),
    )
}

/// Generates an expression; `depth` limits the nesting.
fn literal(dice: &mut Dice, depth: usize) -> String {
    let count = dice.below(4);
    match dice.below(if depth == 0 { 3 } else { 10 }) {
        0 | 1 => dice.number().to_string(),
        2 => format!("'{}'", dice.pick(&NAMES)),
        3 => format!(
            "{}({}, {})",
            dice.pick(&["zeros", "ones", "eye", "repmat"]),
            dice.side(),
            dice.side()
        ),
        4 => format!("{}:{}:{}", dice.number(), dice.number(), dice.number()),
        5 => format!(
            "{{{}}}",
            (0..count)
                .map(|_| literal(dice, depth - 1))
                .collect::<Vec<_>>()
                .join(", ")
        ),
        6 => format!(
            "struct('{}', {})",
            dice.pick(&NAMES),
            literal(dice, depth - 1)
        ),
        7 => format!(
            "-{}*{}'",
            literal(dice, depth - 1),
            literal(dice, depth - 1)
        ),
        _ => {
            let width = 1 + dice.below(3);
            let row = |dice: &mut Dice| {
                (0..width)
                    .map(|_| literal(dice, 0))
                    .collect::<Vec<_>>()
                    .join(" ")
            };
            format!(
                "[{}]",
                (0..count).map(|_| row(dice)).collect::<Vec<_>>().join("; ")
            )
        }
    }
}

/// Generates a NumPy array with a header of any kind, alone or in an archive with other files.
pub(super) fn numpy_or_archive(dice: &mut Dice) -> NamedBytes {
    if dice.once_in(3) {
        ("f.zip".to_owned(), archive(dice))
    } else {
        ("f.npy".to_owned(), array(dice))
    }
}

fn array(dice: &mut Dice) -> Vec<u8> {
    let sides: Vec<usize> = (0..dice.below(4)).map(|_| dice.side()).collect();
    let (kind, size) = element(dice, 2);
    let shape: String = sides.iter().map(|side| format!("{side}, ")).collect();
    let order = if dice.once_in(2) { "True" } else { "False" };
    let header = format!("{{'descr': {kind}, 'fortran_order': {order}, 'shape': ({shape}), }}\n");
    let length = sides
        .iter()
        .try_fold(size, |product, &side| product.checked_mul(side))
        .unwrap_or(0)
        .min(1 << 16);
    let data: Vec<u8> = (0..length.div_ceil(8))
        .flat_map(|_| dice.number().to_le_bytes())
        .take(length)
        .collect();
    [
        b"\x93NUMPY\x01\x00",
        &(header.len() as u16).to_le_bytes()[..],
        header.as_bytes(),
        &data,
    ]
    .concat()
}

/// Generates an element type; returns its description and size \[bytes\].
fn element(dice: &mut Dice, depth: usize) -> (String, usize) {
    let plain = [
        ("'<f8'", 8),
        ("'>f4'", 4),
        ("'<i2'", 2),
        ("'|b1'", 1),
        ("'<c16'", 16),
        ("'<U0'", 0),
        ("'|S3'", 3),
        ("'|O'", 8),
    ];
    if depth == 0 || !dice.once_in(3) {
        let (kind, size) = *dice.pick(&plain);
        return (kind.to_owned(), size);
    }
    let mut fields = String::new();
    let mut total_size = 0usize;
    for index in 0..dice.below(3) {
        let (kind, size) = element(dice, depth - 1);
        let count = if dice.once_in(3) { dice.side() } else { 1 };
        fields += &format!("('f{index}', {kind}, ({count},)), ");
        total_size = total_size.saturating_add(size.saturating_mul(count));
    }
    (format!("[{fields}]"), total_size)
}

/// Generates an archive in which some entries point to the same bytes.
fn archive(dice: &mut Dice) -> Vec<u8> {
    let mut bytes = Vec::new();
    let mut directory = Vec::new();
    let mut entries = 0_u16;
    for index in 0..1 + dice.below(3) {
        let (name, contents) = match dice.below(5) {
            0 => ("a.npy".to_owned(), array(dice)),
            1 => json(dice),
            2 => super::matlab::file(dice),
            3 => ("blank.csv".to_owned(), vec![b' '; dice.below(1 << 20)]),
            _ => table(dice),
        };
        let mut encoder = DeflateEncoder::new(Vec::new(), Compression::fast());
        encoder.write_all(&contents).unwrap();
        let packed = encoder.finish().unwrap();
        let mut checksum = flate2::Crc::new();
        checksum.update(&contents);
        let checksum_and_sizes = [checksum.sum(), packed.len() as u32, contents.len() as u32]
            .map(u32::to_le_bytes)
            .concat();
        let offset = bytes.len() as u32;
        // Entries of the directory that point to these bytes.
        let copies = if dice.once_in(6) {
            1 + dice.below(60)
        } else {
            1
        };
        for copy in 0..copies {
            let name = format!("{index}-{copy}-{name}");
            let head = [
                &[20, 0, 0, 0, 8, 0, 0, 0, 0, 0][..],
                &checksum_and_sizes,
                &[name.len() as u8, 0, 0, 0],
            ]
            .concat();
            if copy == 0 {
                bytes.extend([b"PK\x03\x04", head.as_slice(), name.as_bytes(), &packed].concat());
            }
            let directory_fields = [&[0; 10][..], &offset.to_le_bytes(), name.as_bytes()].concat();
            directory.extend([b"PK\x01\x02\x14\x00", head.as_slice(), &directory_fields].concat());
            entries += 1;
        }
    }
    let sizes = [directory.len() as u32, bytes.len() as u32]
        .map(u32::to_le_bytes)
        .concat();
    let count = entries.to_le_bytes();
    let end = [
        b"PK\x05\x06".as_slice(),
        &[0; 4],
        &count,
        &count,
        &sizes,
        &[0; 2],
    ]
    .concat();
    [bytes, directory, end].concat()
}
