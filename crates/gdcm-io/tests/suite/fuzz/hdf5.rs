//! Random generator of HDF5 files, with the attributes by which MATLAB marks its classes.

use hdf5_pure::{AttrValue, DatasetBuilder, FileBuilder, GroupBuilder};

use super::{CLASSES, Dice, NAMES, NamedBytes};

/// Generates a file of groups and datasets.
pub(super) fn file(dice: &mut Dice) -> NamedBytes {
    let mut file = FileBuilder::new();
    if dice.once_in(2) {
        file.with_userblock(512);
    }
    for index in 0..1 + dice.below(4) {
        let name = name(dice, index);
        if dice.once_in(3) {
            let mut group = file.create_group(&name);
            fill(dice, &mut group, 3);
            file.add_group(group.finish());
        } else {
            dataset(dice, file.create_dataset(&name));
        }
    }
    // Combinations that the library cannot write become an empty file, which a reader must
    // withstand too.
    ("f.h5".to_owned(), file.finish().unwrap_or_default())
}

/// Generates a name that the readers recognise, a reserved one, or one with a number.
fn name(dice: &mut Dice, index: usize) -> String {
    match dice.below(6) {
        0 => format!("v{index}"),
        1 => ["#refs#", "#subsystem#", "MCOS", "ir", "jc", "data"][dice.below(6)].to_owned(),
        _ => {
            let name = *dice.pick(&NAMES);
            // HDF5 does not permit an empty name.
            if name.is_empty() {
                "e".to_owned()
            } else {
                name.to_owned()
            }
        }
    }
}

/// Adds attributes, datasets and, while `depth` is positive, groups to a group.
fn fill(dice: &mut Dice, group: &mut GroupBuilder, depth: usize) {
    for (name, value) in attributes(dice) {
        group.set_attr(name, value);
    }
    for index in 0..dice.below(5) {
        let name = name(dice, index);
        if depth > 0 && dice.once_in(4) {
            let mut inner = group.create_group(&name);
            fill(dice, &mut inner, depth - 1);
            group.add_group(inner.finish());
        } else {
            dataset(dice, group.create_dataset(&name));
        }
    }
}

/// Generates the attributes with which MATLAB marks the class of a value.
fn attributes(dice: &mut Dice) -> Vec<(&'static str, AttrValue)> {
    let mut attributes = Vec::new();
    if dice.once_in(2) {
        let value_classes = [
            "double",
            "char",
            "cell",
            "struct",
            "logical",
            "single",
            "uint64",
            "canonical empty",
        ];
        let class = if dice.once_in(4) {
            *dice.pick(&CLASSES)
        } else {
            *dice.pick(&value_classes)
        };
        attributes.push(("MATLAB_class", AttrValue::AsciiString(class.into())));
    }
    let number = |dice: &mut Dice| {
        if dice.once_in(8) {
            dice.next()
        } else {
            dice.below(5) as u64
        }
    };
    for (name, times) in [
        ("MATLAB_empty", 8),
        ("MATLAB_sparse", 8),
        ("MATLAB_object_decode", 6),
    ] {
        if dice.once_in(times) {
            attributes.push((name, AttrValue::U64(number(dice))));
        }
    }
    attributes
}

fn dataset(dice: &mut Dice, dataset: &mut DatasetBuilder) {
    let sides: Vec<u64> = (0..dice.below(4)).map(|_| dice.below(5) as u64).collect();
    let count = sides.iter().product::<u64>() as usize;
    let numbers: Vec<f64> = (0..count).map(|_| dice.number()).collect();
    let numbers_of = |bound: f64| numbers.iter().map(move |number| number.rem_euclid(bound));
    let _ = match dice.below(8) {
        0 => dataset.with_u8_data(
            &numbers_of(256.0)
                .map(|number| number as u8)
                .collect::<Vec<_>>(),
        ),
        1 => dataset.with_u16_data(
            &numbers_of(65_536.0)
                .map(|number| number as u16)
                .collect::<Vec<_>>(),
        ),
        // The header with which MATLAB refers to an object.
        2 => dataset.with_u32_data(&[0xdd00_0000, 2, 1, 1, 1, 1]),
        3 => dataset.with_u64_data(
            &numbers
                .iter()
                .map(|&number| number as u64)
                .collect::<Vec<_>>(),
        ),
        4 => {
            let texts: Vec<&str> = (0..count).map(|_| *dice.pick(&NAMES)).collect();
            dataset.with_vlen_strings(&texts)
        }
        5 => {
            let paths: Vec<&str> = (0..count)
                .map(|_| *dice.pick(&["x", "A", "v0", "#refs#", "Data_/A"]))
                .collect();
            dataset.with_path_references(&paths)
        }
        _ => dataset.with_f64_data(&numbers),
    };
    if !dice.once_in(4) {
        dataset.with_shape(&sides);
        if dice.once_in(4) && !sides.is_empty() {
            let chunks: Vec<u64> = sides.iter().map(|&side| side.max(1)).collect();
            dataset.with_chunks(&chunks);
            if dice.once_in(2) {
                dataset.with_deflate(6);
            }
        }
    }
    for (name, value) in attributes(dice) {
        dataset.set_attr(name, value);
    }
}
