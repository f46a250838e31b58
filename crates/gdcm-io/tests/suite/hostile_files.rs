//! Malicious files: memory and work stay within their limits, the error is a single line that
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

/// Reads a file as models and as records within [`MOST`] bytes; returns the errors, `None` for a
/// success.
fn refusals(name: &str, bytes: &[u8]) -> [Option<FileError>; 2] {
    refusals_within(MOST, name, bytes)
}

/// Like [`refusals`], within `most` bytes.
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
    let error = refusal.expect("the file must be refused");
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
fn many_elements_without_content_exceed_the_memory_limit() {
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
fn json_of_any_shape_is_limited_in_memory() {
    // Lists of 3 MiB of text: parsed, each would take more than the limit of 16 MiB.
    let chain = format!("{}0{}", "{\"\":".repeat(100), "}".repeat(100));
    for item in [chain.as_str(), "{\"\":0}", "[]", "\"\"", "[0]", "0"] {
        let text = format!("[{}]", vec![item; (3 << 20) / (item.len() + 1)].join(","));
        for refusal in refusals_within(16 << 20, "x.json", text.as_bytes()) {
            assert_too_large(refusal, "x.json", 16);
        }
    }
}

/// Returns a ZIP archive with 4 MiB of spaces and a directory of a hundred entries that all refer
/// to them. The fields are those of PKWARE's APPNOTE, sections 4.3.7, 4.3.12 and 4.3.16.
fn overlapping_archive() -> Vec<u8> {
    let content = vec![b' '; 4 << 20];
    let mut packed: Vec<u8> = Vec::new();
    let mut writer = flate2::write::DeflateEncoder::new(&mut packed, flate2::Compression::best());
    writer.write_all(&content).unwrap();
    writer.finish().unwrap();
    let mut checksum = flate2::Crc::new();
    checksum.update(&content);
    let sizes = [checksum.sum(), packed.len() as u32, 4 << 20]
        .map(u32::to_le_bytes)
        .concat();
    // Version 2.0, no flags, deflated, no date; checksum and sizes; length of the name, no extras.
    let shared_fields = |name: &str| {
        [
            &[20, 0, 0, 0, 8, 0, 0, 0, 0, 0][..],
            &sizes,
            &[name.len() as u8, 0, 0, 0],
        ]
        .concat()
    };
    let mut archive: Vec<u8> = Vec::new();
    archive.extend(b"PK\x03\x04");
    archive.extend(shared_fields("000.csv"));
    archive.extend(b"000.csv");
    archive.extend(&packed);
    let directory_start = archive.len() as u32;
    for entry in 0..100 {
        let name = format!("{entry:03}.csv");
        archive.extend(b"PK\x01\x02\x14\x00");
        archive.extend(shared_fields(&name));
        // The last four of these bytes are the position of the entry's content: 0 for all.
        archive.extend([0; 14]);
        archive.extend(name.as_bytes());
    }
    let directory_length = archive.len() as u32 - directory_start;
    archive.extend(b"PK\x05\x06");
    archive.extend([0, 0, 0, 0, 100, 0, 100, 0]);
    archive.extend(directory_length.to_le_bytes());
    archive.extend(directory_start.to_le_bytes());
    archive.extend([0, 0]);
    archive
}

#[test]
fn archive_entries_that_share_their_bytes_each_count_in_full() {
    for refusal in refusals("same.zip", &overlapping_archive()) {
        assert_too_large(refusal, "same.zip", 64);
    }
}

#[test]
fn many_members_named_like_matrices_take_limited_work() {
    let members: Vec<String> = (0..100_000)
        .map(|index| format!("\"A{index}\":0"))
        .collect();
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
        let error = refusal.expect("the file must be refused");
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
fn every_reader_can_be_cancelled() {
    let lines = "0.02,1.5,-2.25,3.125,4\n".repeat(400_000);
    let list = format!("{{\"t\": [{}0]}}", "[0.25,1.5],".repeat(600_000));
    let members: String = (0..400_000)
        .map(|index| format!("\"A{index}\":[0,1],"))
        .collect();
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
        // The callback sets the flag once this much memory is taken; the reader must then stop
        // without a result.
        for most in [0, 1 << 20, 4 << 20] {
            let stop = Arc::new(AtomicBool::new(false));
            let set_stop = |taken| stop.store(taken >= most, Ordering::Relaxed);
            let budget = ReadingBudget::new(1 << 30)
                .stopped_by(Arc::clone(&stop))
                .with_memory_callback(&set_stop);
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
                "{name}: not stopped after {most} bytes"
            );
        }
    }
}

/// Returns an ArduPilot log: message formats, followed by `messages` messages of the same type.
fn dataflash(messages: u64) -> Vec<u8> {
    // Each message begins with two constant bytes and its type.
    const FORMAT: u8 = 128;
    const RATE: u8 = 140;
    let mut bytes: Vec<u8> = Vec::new();
    // Descriptions of a format: type, length, name, letters of the column types, column names.
    bytes.extend([0xa3, 0x95, FORMAT, FORMAT, 89]);
    bytes.extend(padded("FMT", 4));
    bytes.extend(padded("BBnNZ", 16));
    bytes.extend(padded("Type,Length,Name,Format,Columns", 64));
    bytes.extend([0xa3, 0x95, FORMAT, RATE, 19]);
    bytes.extend(padded("RATE", 4));
    bytes.extend(padded("Qff", 16));
    bytes.extend(padded("TimeUS,R,ROut", 64));
    for index in 0..messages {
        let value = (index as f32 / 50.0).sin().to_le_bytes();
        bytes.extend([0xa3, 0x95, RATE]);
        bytes.extend((2500 * index).to_le_bytes());
        bytes.extend(value);
        bytes.extend(value);
    }
    bytes
}

/// Returns the bytes of a text, padded with zeros.
fn padded(text: &str, length: usize) -> Vec<u8> {
    let mut bytes = text.as_bytes().to_vec();
    bytes.resize(length, 0);
    bytes
}

struct TestFile {
    name: String,
    bytes: Vec<u8>,
}

impl TestFile {
    /// Reads a file in `tests/data`.
    fn read(path: &str) -> Self {
        let folder = crate::program_folder().join("tests/data");
        Self {
            name: path.rsplit('/').next().unwrap().to_owned(),
            bytes: std::fs::read(folder.join(path)).unwrap(),
        }
    }
}

type Reader = fn(&[u8], &str, &ReadingBudget<'_>) -> Result<(), FileError>;

/// Reads a file and sets the stop flag at call number `stop_at` of the memory callback; returns the
/// result and the number of calls.
fn read_and_stop(read: Reader, file: &TestFile, stop_at: usize) -> (Result<(), FileError>, usize) {
    let stop = Arc::new(AtomicBool::new(false));
    let calls = Cell::new(0);
    let count_call = |_| {
        calls.set(calls.get() + 1);
        stop.store(calls.get() >= stop_at, Ordering::Relaxed);
    };
    let budget = ReadingBudget::default()
        .stopped_by(Arc::clone(&stop))
        .with_memory_callback(&count_call);
    (read(&file.bytes, &file.name, &budget), calls.get())
}

#[test]
fn the_reader_of_every_format_stops_at_once_at_any_point() {
    let mut files: Vec<TestFile> = [
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
    .map(TestFile::read)
    .into();
    files.push(TestFile {
        name: "rate.bin".to_owned(),
        bytes: dataflash(2000),
    });
    let archive = crate::program_folder().join("assets/example-records-3-and-10.zip");
    files.push(TestFile {
        name: "records.zip".to_owned(),
        bytes: std::fs::read(archive).unwrap(),
    });
    let readers: [Reader; 2] = [
        |bytes, name, budget| models_of_bytes(bytes, name, budget).map(drop),
        |bytes, name, budget| records_of_bytes(bytes, name, budget).map(drop),
    ];
    for (file, read) in files
        .iter()
        .flat_map(|file| readers.map(|read| (file, read)))
    {
        let name = &file.name;
        let (_, all) = read_and_stop(read, file, usize::MAX);
        assert!(all > 0, "{name}: the reader never asked for memory");
        // About twenty points, spread over the whole reading.
        for stop_at in (1..all).step_by((all / 20).max(1)) {
            let (outcome, calls) = read_and_stop(read, file, stop_at);
            assert_eq!(
                calls, stop_at,
                "{name}: the reader took memory after it was stopped"
            );
            let error = outcome.err();
            assert!(
                error.as_ref().is_some_and(FileError::is_stopped),
                "{name}, stopped at {stop_at} of {all}: {error:?}"
            );
        }
    }
}

#[test]
fn a_dataset_is_read_within_a_budget_and_can_be_cancelled() {
    let path = crate::program_folder().join("tests/data/small-dataset.json");
    let stopped = ReadingBudget::default().stopped_by(Arc::new(true.into()));
    assert!(load_any(&path, &stopped).is_err_and(|error| error.is_stopped()));
    let small = load_any(&path, &ReadingBudget::new(1 << 10)).unwrap_err();
    assert_eq!(small.code(), "too-much-memory", "{small}");
    assert!(load_any(&path, &ReadingBudget::default().with_work(100)).is_err());
    assert!(load_any(&path, &ReadingBudget::default()).is_ok());
}

/// Progress of a folder that is not shown.
struct Silent;

impl FolderProgress for Silent {
    fn reading(&self, _: usize, _: usize, _: &str) {}
}

#[cfg(unix)]
#[test]
fn a_named_pipe_is_skipped_in_a_folder_and_refused_as_an_input() {
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
