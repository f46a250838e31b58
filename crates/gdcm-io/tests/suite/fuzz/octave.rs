//! Random generators of GNU Octave's files, `save -text` and `save -binary`, with extreme
//! dimensions and counts.

use super::{CLASSES, Dice, EXTREME_LENGTHS, NAMES, NamedBytes};

/// Types that Octave writes, and some that it does not.
const TYPES: [&str; 14] = [
    "scalar",
    "complex scalar",
    "matrix",
    "complex matrix",
    "bool matrix",
    "int8 matrix",
    "uint64 scalar",
    "sparse matrix",
    "diagonal matrix",
    "string",
    "cell",
    "scalar struct",
    "object",
    "range",
];

/// Generates a file in one of the two formats.
pub(super) fn file(dice: &mut Dice) -> NamedBytes {
    if dice.once_in(2) {
        let mut text = "# Created by Octave 7.3.0, Mon Nov 23 00:28:20 2026 UTC <a@b>\n".to_owned();
        for _ in 0..1 + dice.below(4) {
            text_value(dice, &mut text, 3);
        }
        return ("f.txt".to_owned(), text.into_bytes());
    }
    let mut bytes = format!("Octave-1-{}\0", dice.pick(&["L", "L", "B"])).into_bytes();
    for _ in 0..1 + dice.below(4) {
        binary_value(dice, &mut bytes, 3);
    }
    ("f.bin".to_owned(), bytes)
}

/// Appends a named value of any type in text form; `depth` limits the nesting.
fn text_value(dice: &mut Dice, text: &mut String, depth: usize) {
    let kind = *dice.pick(&TYPES);
    let rows = dice.side();
    let columns = dice.side();
    *text += &format!("# name: {}\n# type: {kind}\n", dice.pick(&NAMES));
    let complex = kind.starts_with("complex");
    let number = |dice: &mut Dice| {
        if complex {
            format!(" ({},{})", dice.number(), dice.number())
        } else {
            format!(" {}", dice.number())
        }
    };
    match kind {
        "cell" | "scalar struct" | "object" if depth > 0 => {
            match kind {
                "cell" => *text += &format!("# rows: {rows}\n# columns: {columns}\n"),
                "object" => {
                    *text += &format!("# classname: {}\n# length: {rows}\n", dice.pick(&CLASSES))
                }
                _ => *text += &format!("# ndims: 2\n 1 1\n# length: {rows}\n"),
            }
            for _ in 0..dice.below(4) {
                text_value(dice, text, depth - 1);
            }
        }
        "string" => *text += &format!("# elements: {rows}\n# length: {columns}\nhover\n"),
        "sparse matrix" => {
            *text += &format!(
                "# nnz: {}\n# rows: {rows}\n# columns: {columns}\n",
                dice.side()
            );
            for _ in 0..dice.below(6) {
                *text += &format!("{} {}{}\n", dice.side(), dice.side(), dice.number());
            }
        }
        "scalar" | "complex scalar" | "uint64 scalar" => *text += &format!("{}\n", number(dice)),
        _ if dice.once_in(5) => {
            *text += &format!(
                "# ndims: {}\n {rows} {columns} {}\n",
                dice.side(),
                dice.side()
            );
            for _ in 0..dice.below(30) {
                *text += &format!("{}\n", number(dice));
            }
        }
        _ => {
            *text += &format!("# rows: {rows}\n# columns: {columns}\n");
            for _ in 0..rows.min(6) {
                for _ in 0..columns.min(6) {
                    *text += &number(dice);
                }
                *text += "\n";
            }
        }
    }
    *text += "\n\n";
}

fn put_number(bytes: &mut Vec<u8>, number: usize) {
    bytes.extend((number as u32).to_le_bytes());
}

/// Appends a text with its length before it.
fn put_text(bytes: &mut Vec<u8>, text: &str) {
    put_number(bytes, text.len());
    bytes.extend(text.as_bytes());
}

/// Appends a named value of any type in binary form; `depth` limits the nesting.
fn binary_value(dice: &mut Dice, bytes: &mut Vec<u8>, depth: usize) {
    let kind = *dice.pick(&TYPES);
    let name: &&str = dice.pick(&NAMES);
    put_text(bytes, name);
    put_text(bytes, "");
    bytes.extend([0, 0xff]);
    put_text(bytes, kind);
    let rows = dice.side();
    let columns = dice.side();
    if !kind.contains("scalar") {
        if dice.once_in(2) {
            bytes.extend((-(dice.pick(&[2_i32, 2, 3, i32::MAX, 0]))).to_le_bytes());
        }
        put_number(bytes, rows);
        put_number(bytes, columns);
    }
    match kind {
        "cell" | "scalar struct" | "object" if depth > 0 => {
            if kind == "object" {
                let class: &&str = dice.pick(&CLASSES);
                put_text(bytes, class);
            }
            put_number(bytes, rows);
            for _ in 0..dice.below(4) {
                binary_value(dice, bytes, depth - 1);
            }
        }
        "sparse matrix" => {
            for _ in 0..dice.below(12) {
                put_number(bytes, dice.below(6));
            }
        }
        "string" => bytes.extend(b"hover"),
        _ => {
            bytes.push(dice.below(11) as u8);
            let count = rows.min(6) * columns.min(6);
            for _ in 0..count {
                bytes.extend(dice.number().to_le_bytes());
            }
        }
    }
    if dice.once_in(12) {
        bytes.extend(dice.pick(&EXTREME_LENGTHS).to_le_bytes());
    }
}
