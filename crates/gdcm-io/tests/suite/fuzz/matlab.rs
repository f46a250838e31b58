//! Random generator of MATLAB files up to version 7, with objects of its classes.

use std::io::Write;

use flate2::Compression;
use flate2::write::ZlibEncoder;

use super::matlab_files::{
    Directory, chars, column, doubles, element, file_with_objects, matrix, opaque, record,
    reference, words_of,
};
use super::{CLASSES, Dice, EXTREME_LENGTHS, NAMES, NamedBytes};

/// Generates a file of a few variables of any kind.
pub(super) fn file(dice: &mut Dice) -> NamedBytes {
    let variables = (0..1 + dice.below(4)).flat_map(|index| {
        let name = if dice.once_in(4) {
            format!("v{index}")
        } else {
            (*dice.pick(&NAMES)).to_owned()
        };
        let variable = if dice.once_in(3) {
            model(dice, &name)
        } else {
            value(dice, &name, 4)
        };
        if dice.once_in(4) {
            packed(&variable)
        } else {
            variable
        }
    });
    let variables: Vec<u8> = variables.collect();
    ("f.mat".to_owned(), file_with_objects(&variables, None))
}

/// Generates a file of objects, with the subsystem data in which their contents are stored.
pub(super) fn file_of_objects(dice: &mut Dice) -> NamedBytes {
    let names: Vec<&str> = (0..4 + dice.below(8))
        .map(|index| {
            if index % 2 == 0 {
                *dice.pick(&CLASSES)
            } else {
                *dice.pick(&NAMES)
            }
        })
        .collect();
    // Indices are valid or one too large; about one in 40 is an extreme value.
    let index_up_to = |dice: &mut Dice, count: usize| match dice.below(40) {
        0 => *dice.pick(&EXTREME_LENGTHS),
        _ => dice.below(count + 1) as u32,
    };
    let classes = 1 + dice.below(4);
    let lists = 1 + dice.below(4);
    let objects = 1 + dice.below(5);
    let values = 1 + dice.below(6);
    let property_list = |dice: &mut Dice| -> Vec<[u32; 3]> {
        let properties = 0..dice.below(6);
        properties
            .map(|_| {
                [
                    index_up_to(dice, names.len()),
                    dice.below(3) as u32,
                    index_up_to(dice, values),
                ]
            })
            .collect()
    };
    let classes: Vec<[u32; 2]> = (0..classes)
        .map(|_| [0, index_up_to(dice, names.len())])
        .collect();
    let made: Vec<Vec<[u32; 3]>> = (0..dice.below(3)).map(|_| property_list(dice)).collect();
    let plain: Vec<Vec<[u32; 3]>> = (0..lists).map(|_| property_list(dice)).collect();
    let entries: Vec<[u32; 3]> = (0..objects)
        .map(|_| {
            [
                index_up_to(dice, classes.len()),
                if dice.once_in(4) { 1 } else { 0 },
                index_up_to(dice, lists),
            ]
        })
        .collect();
    let version = if dice.once_in(10) {
        dice.below(7) as u32
    } else {
        2 + dice.below(3) as u32
    };
    let directory = Directory {
        version,
        names: &names,
        classes: &classes,
        made: &made.iter().map(Vec::as_slice).collect::<Vec<_>>(),
        objects: &entries,
        plain: &plain.iter().map(Vec::as_slice).collect::<Vec<_>>(),
    };
    let random_reference = |dice: &mut Dice| {
        let count = if dice.once_in(5) { dice.below(4) } else { 1 };
        let numbers: Vec<u32> = (0..count).map(|_| index_up_to(dice, objects)).collect();
        reference(&numbers, index_up_to(dice, classes.len()))
    };
    let mut cells = vec![directory.cell(), doubles("", &[0, 0], &[])];
    for _ in 0..values {
        let cell = match dice.below(3) {
            0 => random_reference(dice),
            1 => column(&[random_reference(dice), random_reference(dice)]),
            _ => value(dice, "", 2),
        };
        cells.push(cell);
    }
    cells.extend((2..version).map(|_| doubles("", &[0, 0], &[])));
    let defaults: Vec<Vec<u8>> = (0..=classes.len()).map(|_| value(dice, "", 2)).collect();
    cells.push(column(&defaults));
    let variables = (0..1 + dice.below(3)).flat_map(|index| {
        let class = *dice.pick(&CLASSES);
        opaque(
            &format!("o{index}"),
            class,
            if dice.once_in(10) {
                value(dice, "", 2)
            } else {
                random_reference(dice)
            },
        )
    });
    let variables: Vec<u8> = variables.collect();
    (
        "o.mat".to_owned(),
        file_with_objects(&variables, Some(&cells)),
    )
}

/// Returns a variable in a compressed element (type 15).
fn packed(variable: &[u8]) -> Vec<u8> {
    let mut encoder = ZlibEncoder::new(Vec::new(), Compression::fast());
    encoder.write_all(variable).unwrap();
    let data = encoder.finish().unwrap();
    [
        &15_u32.to_le_bytes()[..],
        &(data.len() as u32).to_le_bytes(),
        &data,
    ]
    .concat()
}

/// Generates the dimensions of an array and its number of elements. One in 30 has an extreme
/// dimension that contradicts the number.
fn shape(dice: &mut Dice) -> (Vec<i32>, usize) {
    let sides: Vec<usize> = (0..2 + usize::from(dice.once_in(5)))
        .map(|_| dice.below(4))
        .collect();
    let count = sides.iter().product();
    let mut shape: Vec<i32> = sides.iter().map(|&side| side as i32).collect();
    if dice.once_in(30) {
        let dimension = dice.below(shape.len());
        shape[dimension] = *dice.pick(&EXTREME_LENGTHS) as i32;
    }
    (shape, count)
}

/// Generates an element of `count` numbers of a random type (the number before the data).
fn numbers(dice: &mut Dice, count: usize) -> Vec<u8> {
    let values: Vec<f64> = (0..count).map(|_| dice.number()).collect();
    let each = |bytes: fn(f64) -> Vec<u8>| {
        values
            .iter()
            .flat_map(|&value| bytes(value))
            .collect::<Vec<u8>>()
    };
    match dice.below(8) {
        0 => element(1, &each(|value| vec![value as i8 as u8])),
        1 => element(2, &each(|value| vec![value as u8])),
        2 => element(3, &each(|value| (value as i16).to_le_bytes().to_vec())),
        3 => element(6, &each(|value| (value as u32).to_le_bytes().to_vec())),
        4 => element(7, &each(|value| (value as f32).to_le_bytes().to_vec())),
        5 => element(13, &each(|value| (value as u64).to_le_bytes().to_vec())),
        _ => element(9, &each(|value| value.to_le_bytes().to_vec())),
    }
}

/// Generates a value of any kind; `depth` limits the nesting.
fn value(dice: &mut Dice, name: &str, depth: usize) -> Vec<u8> {
    let (sides, count) = shape(dice);
    match dice.below(if depth == 0 { 5 } else { 10 }) {
        0 => chars(name, dice.pick::<&str>(&NAMES)),
        1 => {
            // A sparse matrix: row indices, column starts, values.
            let row_indices = |dice: &mut Dice, count: usize, bound: usize| {
                let data: Vec<u8> = (0..count)
                    .flat_map(|_| (dice.below(bound) as i32).to_le_bytes())
                    .collect();
                element(5, &data)
            };
            let stored = dice.below(5);
            let width = sides[1].clamp(0, 8) as usize;
            let starts: Vec<u8> = (0..=width)
                .flat_map(|at| ((stored * at / width.max(1)) as i32).to_le_bytes())
                .collect();
            let rows = row_indices(dice, stored, 4);
            matrix(
                5,
                &sides[..2],
                name,
                &[rows, element(5, &starts), numbers(dice, stored)],
            )
        }
        2..=4 => {
            let class = 6 + dice.below(10) as u32;
            let complex = dice.once_in(4);
            let parts = (0..1 + usize::from(complex))
                .map(|_| numbers(dice, count))
                .collect::<Vec<_>>();
            matrix(
                class | if complex { 0x0800 } else { 0 },
                &sides,
                name,
                &parts,
            )
        }
        5 => {
            let values: Vec<Vec<u8>> = (0..count).map(|_| value(dice, "", depth - 1)).collect();
            matrix(1, &sides, name, &values)
        }
        6 => {
            let fields: Vec<(&str, Vec<u8>)> = (0..dice.below(4))
                .map(|_| (*dice.pick(&NAMES), value(dice, "", depth - 1)))
                .collect();
            record(name, &fields)
        }
        7 => {
            // A struct array with any number of fields.
            let width = dice.below(3);
            let names: Vec<u8> = (0..width)
                .flat_map(|at| [b'a' + at as u8, 0, 0, 0])
                .collect();
            let values: Vec<Vec<u8>> = (0..count * width)
                .map(|_| value(dice, "", depth - 1))
                .collect();
            let head = [element(5, &4_i32.to_le_bytes()), element(1, &names)].concat();
            let is_object = dice.once_in(3);
            let class = if is_object {
                vec![element(1, dice.pick(&CLASSES).as_bytes())]
            } else {
                Vec::new()
            };
            matrix(
                if is_object { 3 } else { 2 },
                &sides,
                name,
                &[class, vec![head], values].concat(),
            )
        }
        8 => matrix(16, &[1, 1], name, &[value(dice, "", 0)]),
        _ => opaque(
            name,
            dice.pick::<&str>(&CLASSES),
            words_of(&[0xdd00_0000, 2, 1, 1, 1, 1]),
        ),
    }
}

/// Generates a state-space model or a response with consistent dimensions, in which some matrices
/// are replaced by other values.
fn model(dice: &mut Dice, name: &str) -> Vec<u8> {
    let states = dice.below(4);
    let inputs = 1 + dice.below(2);
    let outputs = 1 + dice.below(2);
    let array = |dice: &mut Dice, rows: usize, columns: usize| {
        if dice.once_in(15) {
            return value(dice, "", 1);
        }
        let values: Vec<f64> = (0..rows * columns).map(|_| dice.number()).collect();
        doubles("", &[rows as i32, columns as i32], &values)
    };
    let mut fields = if dice.once_in(3) {
        let count = 2 + dice.below(4);
        let frequencies: Vec<f64> = (0..count).map(|at| at as f64 + 0.5).collect();
        let parts = [
            numbers(dice, outputs * inputs * count),
            numbers(dice, outputs * inputs * count),
        ];
        let shape = [outputs as i32, inputs as i32, count as i32];
        vec![
            ("ResponseData", matrix(6 | 0x0800, &shape, "", &parts)),
            ("Frequency", doubles("", &[count as i32, 1], &frequencies)),
        ]
    } else {
        vec![
            ("A", array(dice, states, states)),
            ("B", array(dice, states, inputs)),
            ("C", array(dice, outputs, states)),
            ("D", array(dice, outputs, inputs)),
        ]
    };
    for _ in 0..dice.below(3) {
        fields.push((*dice.pick(&NAMES), value(dice, "", 1)));
    }
    record(name, &fields)
}
