//! Files that are made to harm: no more memory and work than is allowed, one sentence with the limit, an end where it is asked for.

use std::io::Write;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

use gdcm_files::variables::ReadingBudget;
use gdcm_files::{FileError, FolderProgress, load_dataset, models_of_bytes, read_models, records_of_bytes};

/// Memory that the variables of a file may take here.
const MOST: u64 = 64 << 20;

/// What is said of a file beyond the budget, whether models or records are looked for in it.
fn refusals(name: &str, bytes: &[u8]) -> [String; 2] {
    let refusals = [
        models_of_bytes(bytes, name, &ReadingBudget::new(MOST)).map(drop),
        records_of_bytes(bytes, name, &ReadingBudget::new(MOST)).map(drop),
    ];
    refusals.map(|refusal| refusal.map_or_else(|error| error.to_string(), |()| "read".to_owned()))
}

#[test]
fn things_without_content_count_and_are_refused_in_one_sentence_with_the_limit() {
    for name in ["npy-empty-records-hang.npy", "npy-empty-record-field-hang.npy", "mat5-struct-no-fields.mat"] {
        let bytes = std::fs::read(crate::program_folder().join("tests/data/hostile").join(name)).unwrap();
        for words in refusals(name, &bytes) {
            assert!(words.starts_with(name) && words.contains("would take more than 64 MiB of memory"), "{words}");
        }
    }
}

#[test]
fn json_of_any_shape_takes_no_more_memory_than_it_may() {
    let chain = format!("{}0{}", "{\"\":".repeat(100), "}".repeat(100));
    for item in [chain.as_str(), "{\"\":0}", "[]", "\"\"", "[0]", "0"] {
        let text = format!("[{}]", vec![item; (12 << 20) / (item.len() + 1)].join(","));
        for words in refusals("x.json", text.as_bytes()) {
            assert!(words.contains("would take more than 64 MiB of memory"), "{item}: {words}");
        }
    }
}

#[test]
fn an_archive_of_many_entries_to_the_same_bytes_is_refused_as_one_that_holds_them_all() {
    // One file of 4 MiB of blanks, and a directory in which it stands a hundred times.
    let (mut bytes, mut archive) = (Vec::new(), Vec::new());
    let mut writer = flate2::write::DeflateEncoder::new(&mut bytes, flate2::Compression::best());
    writer.write_all(&vec![b' '; 4 << 20]).unwrap();
    writer.finish().unwrap();
    let mut sum = flate2::Crc::new();
    sum.update(&vec![b' '; 4 << 20]);
    let sizes = [sum.sum(), bytes.len() as u32, 4 << 20].map(u32::to_le_bytes).concat();
    let fields = |name: &str| [&[20, 0, 0, 0, 8, 0, 0, 0, 0, 0][..], &sizes, &[name.len() as u8, 0, 0, 0]].concat();
    archive.extend([b"PK\x03\x04", fields("000.csv").as_slice(), b"000.csv", &bytes].concat());
    let directory = archive.len() as u32;
    for entry in 0..100 {
        let name = format!("{entry:03}.csv");
        archive.extend([b"PK\x01\x02\x14\x00", fields(&name).as_slice(), &[0; 14], name.as_bytes()].concat());
    }
    let length = archive.len() as u32 - directory;
    archive.extend(
        [b"PK\x05\x06", &[0; 4][..], &[100, 0, 100, 0], &length.to_le_bytes(), &directory.to_le_bytes()].concat(),
    );
    archive.extend([0, 0]);
    for words in refusals("same.zip", &archive) {
        assert!(words.starts_with("same.zip") && words.contains("would take more than 64 MiB of memory"), "{words}");
    }
}

#[test]
fn objects_of_many_members_with_the_names_of_matrices_are_no_work_without_end() {
    let members: Vec<String> = (0..100_000).map(|at| format!("\"A{at}\":0")).collect();
    for words in refusals("x.json", format!("{{{}}}", members.join(",")).as_bytes()) {
        assert!(words == "read" || words.contains("would take more than 4000 million steps of work"), "{words}");
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
    let head = [b"\x93NUMPY\x01\x00", &(header.len() as u16).to_le_bytes()[..], header.as_bytes()].concat();
    let files: [(&str, Vec<u8>); 6] = [
        ("lines.csv", lines.into_bytes()),
        ("list.json", list.into_bytes()),
        ("members.json", format!("{{{members}\"x\":0}}").into_bytes()),
        ("literal.m", literal.into_bytes()),
        ("lines.csv.gz", packed.finish().unwrap()),
        ("array.npy", [head, vec![0; 32_000_000]].concat()),
    ];
    for (name, bytes) in &files {
        // The flag is set while they read: whatever they are at, they end by it and have found nothing.
        for most in [0, 1 << 20, 4 << 20] {
            let stop = Arc::new(AtomicBool::new(false));
            let tell = |taken| stop.store(taken >= most, Ordering::Relaxed);
            let budget = ReadingBudget::new(1 << 30).stopped_by(Arc::clone(&stop)).telling(&tell);
            let found = [models_of_bytes(bytes, name, &budget).err(), records_of_bytes(bytes, name, &budget).err()];
            assert!(found.iter().flatten().all(|error| error.to_string().contains("stopped")), "{name}: {found:?}");
            assert!(found.iter().all(Option::is_some), "{name}, after {most} bytes");
        }
    }
}

struct Silent;

impl FolderProgress for Silent {
    fn reading(&self, _: usize, _: usize, _: &str) {}
}

#[cfg(unix)]
#[test]
fn a_named_pipe_is_skipped_with_a_word_in_a_folder_and_refused_before_it_is_read_where_it_is_given() {
    let folder = tempfile::tempdir().unwrap();
    let pipe = folder.path().join("p.csv");
    assert!(std::process::Command::new("mkfifo").arg(&pipe).status().unwrap().success());
    std::fs::write(folder.path().join("A.csv"), "1,2\n3,4\n").unwrap();
    let found = read_models(&[folder.path().to_owned()], &Default::default(), &Silent).unwrap();
    assert_eq!((found.files, found.faults[0].as_str()), (1, "p.csv: skipped, for this is a named pipe, not a file"));
    let given = read_models(std::slice::from_ref(&pipe), &Default::default(), &Silent).unwrap_err();
    assert!(matches!(given, FileError::NotAFile { kind: "a named pipe", .. }), "{given}");
    assert!(matches!(load_dataset(&pipe), Err(FileError::NotAFile { .. })));
    let device = load_dataset(std::path::Path::new("/dev/zero")).unwrap_err().to_string();
    assert_eq!(device, "/dev/zero: this is a device, not a file; save what it gives as a file, and give its name");
}
