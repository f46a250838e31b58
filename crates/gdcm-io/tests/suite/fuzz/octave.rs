//! Random generators of GNU Octave's files, `save -text` and `save -binary`, with extreme
//! dimensions and counts.

use super::{CLASSES, Dice, HARD, NAMES, NamedBytes};

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
        (0..1 + dice.below(4)).for_each(|_| text_value(dice, &mut text, 3));
        return ("f.txt".to_owned(), text.into_bytes());
    }
    let mut bytes = format!("Octave-1-{}\0", dice.of_list(&["L", "L", "B"])).into_bytes();
    (0..1 + dice.below(4)).for_each(|_| binary_value(dice, &mut bytes, 3));
    ("f.bin".to_owned(), bytes)
}

fn text_value(dice: &mut Dice, text: &mut String, deeper: usize) {
    let kind = *dice.of_list(&TYPES);
    let rows = dice.side();
    let columns = dice.side();
    *text += &format!("# name: {}\n# type: {kind}\n", dice.of_list(&NAMES));
    let complex = kind.starts_with("complex");
    let number = |dice: &mut Dice| {
        if complex {
            format!(" ({},{})", dice.number(), dice.number())
        } else {
            format!(" {}", dice.number())
        }
    };
    match kind {
        "cell" | "scalar struct" | "object" if deeper > 0 => {
            match kind {
                "cell" => *text += &format!("# rows: {rows}\n# columns: {columns}\n"),
                "object" => {
                    *text += &format!(
                        "# classname: {}\n# length: {rows}\n",
                        dice.of_list(&CLASSES)
                    )
                }
                _ => *text += &format!("# ndims: 2\n 1 1\n# length: {rows}\n"),
            }
            (0..dice.below(4)).for_each(|_| text_value(dice, text, deeper - 1));
        }
        "string" => *text += &format!("# elements: {rows}\n# length: {columns}\nhover\n"),
        "sparse matrix" => {
            *text += &format!(
                "# nnz: {}\n# rows: {rows}\n# columns: {columns}\n",
                dice.side()
            );
            (0..dice.below(6)).for_each(|_| {
                *text += &format!("{} {}{}\n", dice.side(), dice.side(), dice.number())
            });
        }
        "scalar" | "complex scalar" | "uint64 scalar" => *text += &format!("{}\n", number(dice)),
        _ if dice.once_in(5) => {
            *text += &format!(
                "# ndims: {}\n {rows} {columns} {}\n",
                dice.side(),
                dice.side()
            );
            (0..dice.below(30)).for_each(|_| *text += &format!("{}\n", number(dice)));
        }
        _ => {
            *text += &format!("# rows: {rows}\n# columns: {columns}\n");
            for _ in 0..rows.min(6) {
                (0..columns.min(6)).for_each(|_| *text += &number(dice));
                *text += "\n";
            }
        }
    }
    *text += "\n\n";
}

fn binary_value(dice: &mut Dice, bytes: &mut Vec<u8>, deeper: usize) {
    let put = |bytes: &mut Vec<u8>, number: usize| bytes.extend((number as u32).to_le_bytes());
    let word = |bytes: &mut Vec<u8>, word: &str| {
        bytes.extend((word.len() as u32).to_le_bytes());
        bytes.extend(word.as_bytes());
    };
    let kind = *dice.of_list(&TYPES);
    let name: &&str = dice.of_list(&NAMES);
    word(bytes, name);
    word(bytes, "");
    bytes.extend([0, 0xff]);
    word(bytes, kind);
    let rows = dice.side();
    let columns = dice.side();
    if !kind.contains("scalar") {
        if dice.once_in(2) {
            bytes.extend((-(dice.of_list(&[2_i32, 2, 3, i32::MAX, 0]))).to_le_bytes());
        }
        put(bytes, rows);
        put(bytes, columns);
    }
    match kind {
        "cell" | "scalar struct" | "object" if deeper > 0 => {
            if kind == "object" {
                let class: &&str = dice.of_list(&CLASSES);
                word(bytes, class);
            }
            put(bytes, rows);
            (0..dice.below(4)).for_each(|_| binary_value(dice, bytes, deeper - 1));
        }
        "sparse matrix" => (0..dice.below(12)).for_each(|_| put(bytes, dice.below(6))),
        "string" => bytes.extend(b"hover"),
        _ => {
            bytes.push(dice.below(11) as u8);
            let count = rows.min(6) * columns.min(6);
            (0..count).for_each(|_| bytes.extend(dice.number().to_le_bytes()));
        }
    }
    if dice.once_in(12) {
        bytes.extend(dice.of_list(&HARD).to_le_bytes());
    }
}
