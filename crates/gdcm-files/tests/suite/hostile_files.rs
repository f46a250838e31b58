//! Damaged and hostile files of models: every reader ends with an answer, and takes no more memory than it may.
//!
//! A short run is a test. `GDCM_FUZZ_SECONDS=600 cargo test --release -p gdcm-files --test suite hostile_files -- --nocapture` tries each seed's
//! format for so long and says how many files were tried.

use crate::made_up::tries;
use std::io::Write;
use std::path::Path;
use std::time::{Duration, Instant};

use gdcm_files::{models_of_bytes, records_of_bytes};

/// Memory that the variables of a file may take here.
const MOST: u64 = 64 << 20;

/// Numbers that are hard on readers of sizes.
const HARD: [u32; 8] = [0, 1, 0x7fff_ffff, 0x8000_0000, 0xffff_ffff, 0xffff_fff8, 0x0010_0000, 0xdd00_0000];

/// A generator of random numbers that is the same on every machine (Knuth's MMIX).
struct Dice(u64);

impl Dice {
    fn below(&mut self, bound: usize) -> usize {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        ((self.0 >> 33) as usize) % bound.max(1)
    }
}

/// One damage: a flipped bit, a hard number, a cut, a piece twice, a piece of another place.
fn damaged(seed: &[u8], dice: &mut Dice) -> Vec<u8> {
    let mut bytes = seed.to_vec();
    for _ in 0..=dice.below(4) {
        let at = dice.below(bytes.len());
        match dice.below(5) {
            0 if !bytes.is_empty() => bytes[at] ^= 1 << dice.below(8),
            1 => {
                let number = HARD[dice.below(HARD.len())].to_le_bytes();
                let end = (at + number.len()).min(bytes.len());
                bytes[at..end].copy_from_slice(&number[..end - at]);
            }
            2 => bytes.truncate(at),
            3 => {
                let end = (at + 1 + dice.below(64)).min(bytes.len());
                let piece = bytes[at..end].to_vec();
                bytes.splice(at..at, piece);
            }
            _ => {
                let from = dice.below(bytes.len());
                let end = (from + 16).min(bytes.len());
                let piece = bytes[from..end].to_vec();
                let until = (at + piece.len()).min(bytes.len());
                let piece = piece[..until - at].to_vec();
                bytes[at..until].copy_from_slice(&piece);
            }
        }
    }
    bytes
}

/// Seeds: files of the tests' data in a folder, and texts.
fn seeds(folder: &str) -> Vec<(String, Vec<u8>)> {
    let root = crate::program_folder().join("tests/data").join(folder);
    let mut files: Vec<_> = std::fs::read_dir(root).unwrap().map(|entry| entry.unwrap().path()).collect();
    files.sort();
    let name = |path: &Path| path.file_name().unwrap().to_str().unwrap().to_owned();
    files.iter().map(|path| (name(path), std::fs::read(path).unwrap())).collect()
}

const TEXTS: [(&str, &str); 5] = [
    (
        "frf.csv",
        "omega [rad/s];mag [dB];phase [deg];coherence\n0,5;-1,2;-10;0,99\n1,0;-2,2;-20;0,98\n2,0;-4,5;-45;0,9\n",
    ),
    ("re_im.txt", "1.0 0.5 -0.5\n2.0 0.25 -0.4\n3.0D+00 0.1 -0.3\n"),
    ("sys.m", "A = [-1 2; 3 -4]; % A\nB = [1; 0]; C = eye(2);\nD = zeros(2,1); Ts = 0; sys = ss(A, B, C, D, Ts);\n"),
    (
        "model.json",
        "{\"A\": [[-1.0, 0.5], [0.0, -2.0]], \"B\": [[1.0], [0.0]], \"C\": [[1.0, 0.0]], \"D\": [[0.0]], \"inputs\": [\"LON\"]}",
    ),
    ("printed.txt", "A =\n  -1 2\n  3 -4\nB =\n  1\n  0\nC =\n  1 0\nD =\n  0\n"),
];

fn try_all(format: &str, seeds: &[(String, Vec<u8>)]) {
    let seconds = std::env::var("GDCM_FUZZ_SECONDS").ok().and_then(|text| text.parse::<u64>().ok());
    let until = seconds.map(|seconds| Instant::now() + Duration::from_secs(seconds));
    let mut dice = Dice(20_261_122);
    // Every seed has its turn.
    let enough = tries(100, 400).max(seeds.len());
    let (mut tried, mut read) = (0usize, 0usize);
    while until.map_or(tried < enough, |until| Instant::now() < until) {
        let (name, seed) = &seeds[tried % seeds.len()];
        let bytes = damaged(seed, &mut dice);
        match models_of_bytes(&bytes, name, MOST) {
            Ok(_) => read += 1,
            Err(error) => assert!(error.to_string().starts_with(name.as_str()), "{error}"),
        }
        tried += 1;
    }
    assert!(tried >= seeds.len(), "every seed had its turn");
    println!("{format}: {tried} files tried, {read} read all the same");
}

#[test]
fn damaged_matlab_files_end_with_an_answer() {
    try_all("mat", &seeds("mat"));
}

#[test]
fn damaged_hdf5_files_end_with_an_answer() {
    try_all("mat73", &seeds("mat73"));
}

#[test]
fn damaged_numpy_files_end_with_an_answer() {
    try_all("npy", &seeds("npy"));
}

#[test]
fn damaged_texts_end_with_an_answer() {
    try_all("text", &TEXTS.map(|(name, text)| (name.to_owned(), text.as_bytes().to_vec())));
}

/// What is said of a file beyond the budget, whether models or records are looked for in it.
fn refusals(name: &str, bytes: &[u8]) -> [String; 2] {
    let begun = Instant::now();
    let refusals = [models_of_bytes(bytes, name, MOST).map(drop), records_of_bytes(bytes, name, MOST).map(drop)];
    assert!(begun.elapsed() < Duration::from_secs(20), "{name}");
    refusals.map(|refusal| refusal.map_or_else(|error| error.to_string(), |()| "read".to_owned()))
}

#[test]
fn things_without_content_count_and_are_refused_in_one_sentence_with_the_limit() {
    let files = seeds("hostile");
    assert!(files.len() >= 3);
    for (name, bytes) in files {
        for words in refusals(&name, &bytes) {
            assert!(words.starts_with(&name) && words.contains("would take more than 64 MiB of memory"), "{words}");
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
