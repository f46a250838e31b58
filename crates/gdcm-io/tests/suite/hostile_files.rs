//! Malicious files: memory and work stay within the limits, the error is a single sentence that
//! states the limit, and cancellation is prompt.

use std::cell::Cell;
use std::io::Write;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

use gdcm_io::import::model_files::models_of_bytes;
use gdcm_io::import::record_files::records_of_bytes;
use gdcm_io::reading_budget::{ReadingBudget, VariableFault};
use gdcm_io::{FileError, FolderProgress, load_any, load_dataset, read_models};

/// Memory limit \[bytes\] for the variables of a file in these tests.
const MOST: u64 = 64 << 20;

/// Returns the errors for a file that exceeds the budget, read as models and as records; `None` for
/// a success.
fn refusals(name: &str, bytes: &[u8]) -> [Option<FileError>; 2] {
    refusals_within(MOST, name, bytes)
}

fn refusals_within(most: u64, name: &str, bytes: &[u8]) -> [Option<FileError>; 2] {
    [
        models_of_bytes(bytes, name, &ReadingBudget::new(most)).err(),
        records_of_bytes(bytes, name, &ReadingBudget::new(most)).err(),
    ]
}

/// Asserts that reading failed because of this memory limit, and that the message is a single line
/// that begins with the name of the file.
#[track_caller]
fn assert_too_large(refusal: Option<FileError>, name: &str, limit_mib: u64) {
    let error = refusal.expect("the file is not read");
    assert!(
        matches!(
            error,
            FileError::Variables {
                fault: VariableFault::TooLarge { most_mib, .. },
                ..
            } if most_mib == limit_mib
        ),
        "{error:?}"
    );
    let message = error.to_string();
    assert!(message.starts_with(name), "{message}");
    assert_eq!(message.lines().count(), 1);
}

#[test]
fn things_without_content_count_and_are_refused_in_one_sentence_with_the_limit() {
    for name in [
        "npy-empty-records-hang.npy",
        "npy-empty-record-field-hang.npy",
        "mat5-struct-no-fields.mat",
    ] {
        let bytes = std::fs::read(
            crate::program_folder()
                .join("tests/data/hostile")
                .join(name),
        )
        .unwrap();
        for refusal in refusals(name, &bytes) {
            assert_too_large(refusal, name, 64);
        }
    }
}

#[test]
fn json_of_any_shape_takes_no_more_memory_than_it_may() {
    let chain = format!("{}0{}", "{\"\":".repeat(100), "}".repeat(100));
    for item in [chain.as_str(), "{\"\":0}", "[]", "\"\"", "[0]", "0"] {
        let text = format!("[{}]", vec![item; (3 << 20) / (item.len() + 1)].join(","));
        for refusal in refusals_within(16 << 20, "x.json", text.as_bytes()) {
            assert_too_large(refusal, "x.json", 16);
        }
    }
}

#[test]
fn an_archive_of_many_entries_to_the_same_bytes_is_refused_as_one_that_holds_them_all() {
    // A file of 4 MiB of spaces, to which the directory of the archive has a hundred entries.
    let mut bytes = Vec::new();
    let mut archive = Vec::new();
    let mut writer = flate2::write::DeflateEncoder::new(&mut bytes, flate2::Compression::best());
    writer.write_all(&vec![b' '; 4 << 20]).unwrap();
    writer.finish().unwrap();
    let mut sum = flate2::Crc::new();
    sum.update(&vec![b' '; 4 << 20]);
    let sizes = [sum.sum(), bytes.len() as u32, 4 << 20]
        .map(u32::to_le_bytes)
        .concat();
    let fields = |name: &str| {
        [
            &[20, 0, 0, 0, 8, 0, 0, 0, 0, 0][..],
            &sizes,
            &[name.len() as u8, 0, 0, 0],
        ]
        .concat()
    };
    archive.extend(
        [
            b"PK\x03\x04",
            fields("000.csv").as_slice(),
            b"000.csv",
            &bytes,
        ]
        .concat(),
    );
    let directory = archive.len() as u32;
    for entry in 0..100 {
        let name = format!("{entry:03}.csv");
        archive.extend(
            [
                b"PK\x01\x02\x14\x00",
                fields(&name).as_slice(),
                &[0; 14],
                name.as_bytes(),
            ]
            .concat(),
        );
    }
    let length = archive.len() as u32 - directory;
    archive.extend(
        [
            b"PK\x05\x06",
            &[0; 4][..],
            &[100, 0, 100, 0],
            &length.to_le_bytes(),
            &directory.to_le_bytes(),
        ]
        .concat(),
    );
    archive.extend([0, 0]);
    for refusal in refusals("same.zip", &archive) {
        assert_too_large(refusal, "same.zip", 64);
    }
}

#[test]
fn objects_of_many_members_with_the_names_of_matrices_are_no_work_without_end() {
    let members: Vec<String> = (0..100_000).map(|at| format!("\"A{at}\":0")).collect();
    for refusal in refusals("x.json", format!("{{{}}}", members.join(",")).as_bytes()) {
        let Some(error) = refusal else {
            continue;
        };
        assert!(
            matches!(
                error,
                FileError::Variables {
                    fault: VariableFault::TooMuchWork {
                        most_millions: 4000,
                        ..
                    },
                    ..
                }
            ),
            "{error:?}"
        );
    }
}

#[test]
fn a_log_of_too_many_flights_is_refused_with_their_number() {
    let bytes = b"H Product:Blackbox\n".repeat(1001);
    for refusal in refusals("long.bbl", &bytes) {
        let error = refusal.expect("the file is not read");
        assert!(
            matches!(
                error,
                FileError::Variables {
                    fault: VariableFault::TooManyRecords {
                        found: 1001,
                        most: 1000,
                    },
                    ..
                }
            ),
            "{error:?}"
        );
    }
}

#[test]
fn every_reader_stops_when_it_is_asked_to() {
    let lines = "0.02,1.5,-2.25,3.125,4\n".repeat(400_000);
    let list = format!("{{\"t\": [{}0]}}", "[0.25,1.5],".repeat(600_000));
    let members: String = (0..400_000).map(|at| format!("\"A{at}\":[0,1],")).collect();
    let literal = format!("A = [{}];", "0.25 1.5;\n".repeat(500_000));
    let mut packed = flate2::write::GzEncoder::new(Vec::new(), flate2::Compression::fast());
    packed.write_all(lines.as_bytes()).unwrap();
    let header = "{'descr': '<f8', 'fortran_order': False, 'shape': (2000, 2000), }";
    let head = [
        b"\x93NUMPY\x01\x00",
        &(header.len() as u16).to_le_bytes()[..],
        header.as_bytes(),
    ]
    .concat();
    let files: [(&str, Vec<u8>); 6] = [
        ("lines.csv", lines.into_bytes()),
        ("list.json", list.into_bytes()),
        ("members.json", format!("{{{members}\"x\":0}}").into_bytes()),
        ("literal.m", literal.into_bytes()),
        ("lines.csv.gz", packed.finish().unwrap()),
        ("array.npy", [head, vec![0; 32_000_000]].concat()),
    ];
    for (name, bytes) in &files {
        // The flag is set during the reading, after different amounts of memory: the reader must
        // stop without a result.
        for most in [0, 1 << 20, 4 << 20] {
            let stop = Arc::new(AtomicBool::new(false));
            let tell = |taken| stop.store(taken >= most, Ordering::Relaxed);
            let budget = ReadingBudget::new(1 << 30)
                .stopped_by(Arc::clone(&stop))
                .with_memory_callback(&tell);
            let found = [
                models_of_bytes(bytes, name, &budget).err(),
                records_of_bytes(bytes, name, &budget).err(),
            ];
            assert!(
                found.iter().flatten().all(FileError::is_stopped),
                "{name}: {found:?}"
            );
            assert!(
                found.iter().all(Option::is_some),
                "{name}, after {most} bytes"
            );
        }
    }
}

/// Returns an ArduPilot log: message formats, followed by `messages` messages of the same type.
fn dataflash(messages: u64) -> Vec<u8> {
    let padded =
        |text: &str, length: usize| [text.as_bytes(), &vec![0; length - text.len()]].concat();
    let format = |kind: u8, length: u8, name: &str, letters: &str, names: &str| {
        [
            vec![0xa3, 0x95, 128, kind, length],
            padded(name, 4),
            padded(letters, 16),
            padded(names, 64),
        ]
        .concat()
    };
    let mut bytes = format(128, 89, "FMT", "BBnNZ", "Type,Length,Name,Format,Columns");
    bytes.extend(format(140, 19, "RATE", "Qff", "TimeUS,R,ROut"));
    for at in 0..messages {
        let value = (at as f32 / 50.0).sin().to_le_bytes();
        bytes.extend(
            [
                &[0xa3, 0x95, 140][..],
                &(2500 * at).to_le_bytes(),
                &value,
                &value,
            ]
            .concat(),
        );
    }
    bytes
}

#[test]
fn the_reader_of_every_format_ends_at_once_wherever_it_is_stopped() {
    let data = crate::program_folder().join("tests/data");
    let of = |name: &str| {
        (
            name.rsplit('/').next().unwrap().to_owned(),
            std::fs::read(data.join(name)).unwrap(),
        )
    };
    let mut files: Vec<(String, Vec<u8>)> = [
        "mat/scipy-4.mat",
        "mat/scipy-5.mat",
        "mat/scipy-5-packed.mat",
        "mat73/objects.mat",
        "mat73/plain.h5",
        "foreign/octave/kinds.txt",
        "foreign/octave/kinds.bin",
        "foreign/octave/kinds.h5.gz",
        "npy/matrix_c.npy",
        "npy/compressed.npz",
        "logs/quadrotor.ulg",
        "logs/two-flights.bbl",
        "small-dataset.json",
    ]
    .map(of)
    .into();
    files.push(("rate.bin".to_owned(), dataflash(2000)));
    files.push((
        "records.zip".to_owned(),
        std::fs::read(crate::program_folder().join("assets/example-records-3-and-10.zip")).unwrap(),
    ));
    type Reader = fn(&[u8], &str, &ReadingBudget<'_>) -> Result<(), FileError>;
    let readers: [Reader; 2] = [
        |bytes, name, budget| models_of_bytes(bytes, name, budget).map(drop),
        |bytes, name, budget| records_of_bytes(bytes, name, budget).map(drop),
    ];
    for ((name, bytes), read) in files
        .iter()
        .flat_map(|file| readers.map(|read| (file, read)))
    {
        // Reads with the flag set at the given call of the callback; returns the result and the
        // number of calls.
        let taken = |stopped_at: usize| {
            let stop = Arc::new(AtomicBool::new(false));
            let count = Cell::new(0);
            let tell = |_| {
                count.set(count.get() + 1);
                stop.store(count.get() >= stopped_at, Ordering::Relaxed);
            };
            let budget = ReadingBudget::default()
                .stopped_by(Arc::clone(&stop))
                .with_memory_callback(&tell);
            (read(bytes, name, &budget), count.get())
        };
        let (_, all) = taken(usize::MAX);
        assert!(all > 0, "{name} is read without a budget");
        for stopped_at in (1..all).step_by((all / 20).max(1)) {
            let (outcome, count) = taken(stopped_at);
            assert_eq!(
                count, stopped_at,
                "{name}: it takes memory after it was stopped"
            );
            let error = outcome.err();
            assert!(
                error.as_ref().is_some_and(FileError::is_stopped),
                "{name}, stopped at {stopped_at} of {all}: {error:?}"
            );
        }
    }
}

#[test]
fn a_dataset_and_its_study_are_read_within_a_budget_that_can_be_ended() {
    let path = crate::program_folder().join("tests/data/small-dataset.json");
    let stopped = ReadingBudget::default().stopped_by(Arc::new(true.into()));
    assert!(load_any(&path, &stopped).is_err_and(|error| error.is_stopped()));
    let small = load_any(&path, &ReadingBudget::new(1 << 10)).unwrap_err();
    assert_eq!(small.code(), "too-much-memory", "{small}");
    assert!(load_any(&path, &ReadingBudget::default().with_work(100)).is_err());
    assert!(load_any(&path, &ReadingBudget::default()).is_ok());
}

struct Silent;

impl FolderProgress for Silent {
    fn reading(&self, _: usize, _: usize, _: &str) {}
}

#[cfg(unix)]
#[test]
fn a_named_pipe_is_skipped_with_a_word_in_a_folder_and_refused_before_it_is_read_where_it_is_given()
{
    let folder = tempfile::tempdir().unwrap();
    let pipe = folder.path().join("p.csv");
    assert!(
        std::process::Command::new("mkfifo")
            .arg(&pipe)
            .status()
            .unwrap()
            .success()
    );
    std::fs::write(folder.path().join("A.csv"), "1,2\n3,4\n").unwrap();
    let found = read_models(&[folder.path().to_owned()], &Default::default(), &Silent).unwrap();
    let given = read_models(std::slice::from_ref(&pipe), &Default::default(), &Silent).unwrap_err();
    let FileError::NotAFile { kind, .. } = &given else {
        panic!("{given}")
    };
    assert_eq!((found.files, *kind), (1, "a named pipe"));
    let fault = &found.faults[0];
    assert!(
        fault.starts_with("p.csv: ") && fault.contains(kind),
        "{fault}"
    );
    assert!(matches!(
        load_dataset(&pipe),
        Err(FileError::NotAFile { .. })
    ));
    let device = load_dataset(std::path::Path::new("/dev/zero")).unwrap_err();
    assert_eq!(device.code(), "input-not-a-file", "{device}");
    assert!(
        matches!(
            device,
            FileError::NotAFile {
                kind: "a device",
                ..
            }
        ),
        "{device:?}"
    );
}
