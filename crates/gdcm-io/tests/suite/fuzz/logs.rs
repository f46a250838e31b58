//! Random generators of flight logs: ULog, DataFlash in binary and text form, Blackbox.

use super::{Dice, EXTREME_LENGTHS, NamedBytes};

/// Generates a log in one of these formats.
pub(super) fn file(dice: &mut Dice) -> NamedBytes {
    let (name, bytes) = match dice.below(4) {
        0 => ("f.ulg", ulog(dice)),
        1 => ("f.bin", dataflash(dice)),
        2 => ("f.log", dataflash_text(dice)),
        _ => ("f.bbl", blackbox(dice)),
    };
    (name.to_owned(), bytes)
}

/// Generates up to `most - 1` random bytes.
fn random_bytes(dice: &mut Dice, most: usize) -> Vec<u8> {
    (0..dice.below(most))
        .map(|_| dice.below(256) as u8)
        .collect()
}

/// Returns a ULog message: length, kind, content.
fn message(kind: u8, content: &[u8]) -> Vec<u8> {
    [&(content.len() as u16).to_le_bytes()[..], &[kind], content].concat()
}

fn ulog(dice: &mut Dice) -> Vec<u8> {
    const TYPES: [&str; 12] = [
        "float",
        "float[3]",
        "uint8_t",
        "bool",
        "int64_t",
        "char[10]",
        "double",
        "inner",
        "inner[2]",
        "outer",
        "float[70000]",
        "int16_t[0]",
    ];
    let mut bytes = b"ULog\x01\x12\x35\x01\0\0\0\0\0\0\0\0".to_vec();
    if dice.once_in(2) {
        let mut flags = vec![0; 16];
        flags[8] = dice.once_in(2).into();
        // Offsets of appended data.
        for _ in 0..3 {
            let offset = if dice.once_in(2) {
                0
            } else {
                dice.below(2000) as u64
            };
            flags.extend(offset.to_le_bytes());
        }
        bytes.extend(message(b'B', &flags));
    }
    for name in [
        "inner",
        "outer",
        "vehicle_angular_velocity",
        "vehicle_status",
    ] {
        let timestamp = if dice.once_in(8) {
            ""
        } else {
            "uint64_t timestamp;"
        };
        let mut layout = format!("{name}:{timestamp}");
        for index in 0..dice.below(5) {
            layout += &format!("{} f{index};", dice.pick(&TYPES));
        }
        layout += if name == "vehicle_status" {
            "uint8_t arming_state;uint8_t nav_state;"
        } else {
            "float[3] xyz;"
        };
        bytes.extend(message(b'F', layout.as_bytes()));
    }
    for number in 0..dice.below(5) as u8 {
        let name = *dice.pick(&[
            "outer",
            "vehicle_angular_velocity",
            "vehicle_status",
            "none",
        ]);
        bytes.extend(message(
            b'A',
            &[&[dice.below(3) as u8, number, 0][..], name.as_bytes()].concat(),
        ));
    }
    for sample in 0..dice.below(200) as u64 {
        let stamp = if dice.once_in(30) {
            u64::from(*dice.pick(&EXTREME_LENGTHS))
        } else {
            4000 * sample
        };
        let data = [
            &[dice.below(5) as u8, 0][..],
            &stamp.to_le_bytes(),
            &random_bytes(dice, 60),
        ]
        .concat();
        bytes.extend(message(*dice.pick(b"DDDDDDDOLIP"), &data));
    }
    bytes
}

fn dataflash(dice: &mut Dice) -> Vec<u8> {
    const LETTERS: &[u8] = b"QQIfdbBhHiIcCeELMnNZqa?";
    let mut bytes = Vec::new();
    let format = |kind: u8, length: u8, name: &str, letters: &str, names: &str| {
        let padded = |text: &str, length: usize| {
            [text.as_bytes(), &vec![0; length - text.len().min(length)]].concat()[..length].to_vec()
        };
        [
            vec![0xa3, 0x95, 128, kind, length],
            padded(name, 4),
            padded(letters, 16),
            padded(names, 64),
        ]
        .concat()
    };
    bytes.extend(format(
        128,
        89,
        "FMT",
        "BBnNZ",
        "Type,Length,Name,Format,Columns",
    ));
    bytes.extend(format(
        130,
        44,
        "FMTU",
        "QBNN",
        "TimeUS,FmtType,UnitIds,MultIds",
    ));
    for kind in 140..140 + dice.below(5) as u8 {
        let letters: String = (0..1 + dice.below(6))
            .map(|_| char::from(*dice.pick(LETTERS)))
            .collect();
        let name = *dice.pick(&["RATE", "IMU", "MODE", "ARM", "SIDD", "UNIT", "MULT", "FMTU"]);
        let names = *dice.pick(&[
            "TimeUS,I,GyrX",
            "TimeUS,R,ROut,P",
            "TimeMS,Mode",
            "TimeUS,Id,Label",
            "TimeUS,Id,Mult",
            "A,B",
        ]);
        bytes.extend(format(
            kind,
            dice.below(256) as u8,
            name,
            &format!("Q{letters}"),
            names,
        ));
        let units = [
            &[0xa3, 0x95, 130][..],
            &[0; 8],
            &[kind],
            b"s#kE-\0\0\0\0\0\0\0\0\0\0\0F-CB0\0\0\0\0\0\0\0\0\0\0\0",
        ]
        .concat();
        bytes.extend(units);
    }
    for sample in 0..dice.below(200) as u64 {
        bytes.extend(
            [
                &[0xa3, 0x95, 138 + dice.below(8) as u8][..],
                &(2500 * sample).to_le_bytes(),
                &random_bytes(dice, 40),
            ]
            .concat(),
        );
    }
    bytes
}

fn dataflash_text(dice: &mut Dice) -> Vec<u8> {
    let mut text = "FMT, 128, 89, FMT, BBnNZ, Type,Length,Name,Format,Columns\n".to_owned();
    text += &format!(
        "FMT, 140, 19, RATE, {}, TimeUS,R,ROut\n",
        dice.pick(&["Qff", "Q", "QffZ", "??"])
    );
    text += &format!(
        "FMTU, 0, {}, s#k, F--\nUNIT, 0, {}, deg/s\n",
        dice.number(),
        dice.number()
    );
    for sample in 0..dice.below(200) {
        text += &format!(
            "{}, {}, {}, {}\n",
            dice.pick(&["RATE", "MODE", ""]),
            2500 * sample,
            dice.number(),
            dice.number()
        );
    }
    text.into_bytes()
}

fn blackbox(dice: &mut Dice) -> Vec<u8> {
    let mut bytes = Vec::new();
    for _ in 0..1 + dice.below(3) {
        bytes.extend(b"H Product:Blackbox flight data recorder\nH Data version:2\n");
        let fields = 1 + dice.below(12);
        let names: Vec<String> = (0..fields)
            .map(|index| {
                ["time", "axisP[0]", "gyroADC[0]", "motor[0]", "x"][index.min(4)].to_owned()
            })
            .collect();
        bytes.extend(
            format!("H Field I name:{}\nH Field S name:flags\n", names.join(",")).into_bytes(),
        );
        for (kind, count) in [("I", fields), ("P", fields), ("S", 1)] {
            for property in ["signed", "predictor", "encoding"] {
                let known: &[u8] = if property == "encoding" {
                    &[0, 1, 3, 6, 7, 8, 9]
                } else {
                    &[0, 1, 2, 3, 5, 8, 11]
                };
                let numbers: Vec<String> =
                    (0..count).map(|_| dice.pick(known).to_string()).collect();
                bytes.extend(
                    format!("H Field {kind} {property}:{}\n", numbers.join(",")).into_bytes(),
                );
            }
        }
        bytes.extend(b"H gyro_scale:0x3f800000\nH motorOutput:158,2047\n");
        for _ in 0..dice.below(300) {
            bytes.push(*dice.pick(b"IIPPPPPSEGH"));
            bytes.extend((0..fields).map(|_| dice.below(128) as u8));
        }
    }
    bytes
}
