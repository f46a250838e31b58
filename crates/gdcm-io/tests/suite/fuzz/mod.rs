//! Random tests of every reader with files that are damaged, randomly generated or malicious: each
//! reading must end without a panic, within the time limit and its budget, and must not return
//! non-finite numbers.
//!
//! A short run is part of the tests. For a long run (docs/testing.md):
//!
//! ```text
//! GDCM_FUZZ_EXECUTIONS=1000000 GDCM_FUZZ_SEED=7 cargo test -p gdcm-io --test suite fuzz::long -- --ignored --nocapture
//! ```
//!
//! An execution is determined by the seed and its number, from which the same file is generated on
//! every machine. A file that fails is kept in the folder for temporary files;
//! `GDCM_FUZZ_FILE=path` runs that file alone.

mod hdf5;
mod logs;
mod matlab;
#[path = "../../../src/formats/mat/sample_tests.rs"]
#[expect(dead_code, reason = "the readers' own tests use the rest")]
mod matlab_files;
mod octave;
mod texts;

use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::{Arc, LazyLock, Mutex};
use std::time::{Duration, Instant};

use gdcm_io::files::levels_and_tolerances::{add_tolerances, load_tolerances, read_levels};
use gdcm_io::files::recovery_file::lost_studies;
use gdcm_io::files::rules_file::{add_rules, load_rules};
use gdcm_io::files::study_file::open_study_of;
use gdcm_io::import::model_files::models_of_bytes;
use gdcm_io::import::record_files::records_of_bytes;
use gdcm_io::output_set::OutputSet;
use gdcm_io::reading_budget::ReadingBudget;
use gdcm_io::{DatasetOrigin, Existing, FileError, load_dataset, load_dataset_bytes, save_study};
use gdcm_method::correction::Channel;
use gdcm_method::requirements::ToleranceTable;
use gdcm_model::assembly::{FoundModel, RowRule, Rules};
use gdcm_model::dataset::{BundleKind, ModelId};
use gdcm_study::decisions::signs::SignRole;
use gdcm_study::{Edit, Study};

use crate::synthetic::tries;

/// Memory limit \[bytes\] of the reading budget in these tests.
const MOST_MEMORY: u64 = 16 << 20;
/// Work limit \[steps\] of the reading budget in these tests.
const MOST_WORK: u64 = 20_000_000;
/// Maximum additional memory \[bytes\], beyond the budget and copies of the content: tables of the
/// decompression libraries.
const LIBRARY_MEMORY: u64 = 4 << 20;
/// Time limit of an execution. The longest takes 2 s, or about 26 s on a heavily loaded machine.
const LONGEST: Duration = Duration::from_secs(60);
/// Number of failures after which a run ends.
const MOST_FAILURES: usize = 20;

/// Extreme values of lengths and indices.
const EXTREME_LENGTHS: [u32; 8] = [
    0,
    1,
    0x7fff_ffff,
    0x8000_0000,
    0xffff_ffff,
    0xffff_fff8,
    0x0010_0000,
    0xdd00_0000,
];
/// Extreme values of numbers.
const EXTREME_NUMBERS: [f64; 12] = [
    0.0,
    -0.0,
    1.0,
    -1.0,
    1e-3,
    5e-324,
    1e200,
    -1e308,
    f64::MAX,
    f64::NAN,
    f64::INFINITY,
    f64::NEG_INFINITY,
];

/// Random number generator with the same results on every machine (SplitMix64, Steele et al. 2014).
#[derive(Clone)]
struct Dice(u64);

impl Dice {
    /// Creates the generator of an execution.
    fn for_execution(seed: u64, execution: u64) -> Self {
        Self(
            seed.wrapping_mul(0x9e37_79b9_7f4a_7c15)
                ^ execution.wrapping_mul(0xd6e8_feb8_6659_fd93),
        )
    }

    fn next(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mixed = (self.0 ^ (self.0 >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        let mixed = (mixed ^ (mixed >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        mixed ^ (mixed >> 31)
    }

    /// Returns a number from 0 to `bound - 1`; 0 if `bound` is 0.
    fn below(&mut self, bound: usize) -> usize {
        (self.next() >> 33) as usize % bound.max(1)
    }

    /// Returns true with a probability of 1 / `times`.
    fn once_in(&mut self, times: usize) -> bool {
        self.below(times) == 0
    }

    /// Returns a random entry of a list.
    fn pick<'l, T>(&mut self, list: &'l [T]) -> &'l T {
        &list[self.below(list.len())]
    }

    /// Generates a number, mostly a small one, occasionally an extreme one.
    fn number(&mut self) -> f64 {
        match self.below(8) {
            0 => *self.pick(&EXTREME_NUMBERS),
            1 => self.below(1000) as f64,
            _ => (self.below(2001) as f64 - 1000.0) / 250.0,
        }
    }

    /// Generates the length of a dimension, mostly small, occasionally extreme.
    fn side(&mut self) -> usize {
        match self.below(24) {
            0 => *self.pick(&EXTREME_LENGTHS) as usize,
            1 => self.below(70_000),
            _ => self.below(5),
        }
    }
}

/// Names that the readers recognise, and some others.
const NAMES: [&str; 48] = [
    "A",
    "B",
    "C",
    "D",
    "E",
    "K",
    "Ts",
    "A_nom",
    "B_nom",
    "C_nom",
    "A1",
    "B1",
    "C1",
    "D1",
    "num",
    "den",
    "z",
    "p",
    "k",
    "InputName",
    "OutputName",
    "StateName",
    "InputDelay",
    "OutputDelay",
    "IODelay",
    "InternalDelay",
    "ResponseData",
    "Frequency",
    "FrequencyUnit",
    "H",
    "w",
    "coherence",
    "Data_",
    "Name_",
    "lti",
    "InputData",
    "OutputData",
    "Time",
    "t",
    "u",
    "y",
    "time",
    "models",
    "frequency_response",
    "condition",
    "airspeed_kt",
    "x",
    "",
];
/// Classes of MATLAB and GNU Octave.
const CLASSES: [&str; 16] = [
    "ss",
    "tf",
    "zpk",
    "frd",
    "idss",
    "idtf",
    "idfrd",
    "iddata",
    "string",
    "timetable",
    "table",
    "timeseries",
    "ltipack.ssdata",
    "containers.Map",
    "datetime",
    "any",
];

/// File names of a study and of rules.
const STUDY: &str = "small.gdcm-study.json";
const RULES: &str = "small.gdcm-rules.json";
/// File names of a table of tolerances and of boundaries of levels.
const TOLERANCES: &str = "small-tolerances.json";
const LEVELS: &str = "small-levels.json";

/// Name and bytes of a file.
type NamedBytes = (String, Vec<u8>);

/// Files of the test data, which are damaged at random.
static CORPUS: LazyLock<Vec<NamedBytes>> = LazyLock::new(|| {
    let root = crate::program_folder().join("tests/data");
    let folders = [
        "mat",
        "mat73",
        "npy",
        "records",
        "logs",
        "edges",
        "hostile",
        "foreign/octave",
        "foreign/numpy",
        "foreign/text",
        "",
    ];
    let mut paths: Vec<PathBuf> = folders
        .iter()
        .flat_map(|folder| std::fs::read_dir(root.join(folder)).unwrap())
        .map(|entry| entry.unwrap().path())
        .filter(|path| {
            path.is_file()
                && path
                    .metadata()
                    .is_ok_and(|metadata| metadata.len() < 200_000)
        })
        .collect();
    paths.sort();
    let files = paths.iter().map(|path| {
        let name = path.file_name().unwrap().to_str().unwrap().to_owned();
        (name, std::fs::read(path).unwrap())
    });
    files.chain(own_files()).collect()
});

/// Path of the dataset to which the study in the corpus belongs.
fn small_dataset() -> PathBuf {
    crate::program_folder().join("tests/data/small-dataset.json")
}

/// Returns files in the formats of this program: a study with a pinned model, a sign and a variant;
/// rules with a declaration for one model; a table of tolerances; level boundaries.
fn own_files() -> [NamedBytes; 4] {
    let folder = tempfile::tempdir().unwrap();
    let [study_path, rules_path, tolerances_path] =
        [STUDY, RULES, TOLERANCES].map(|name| folder.path().join(name));
    let loaded = load_dataset(&small_dataset()).unwrap();
    let mut study = Study::new(Arc::clone(&loaded.dataset));
    let condition = study.dataset.conditions()[0].id();
    let model = study.dataset.conditions()[0]
        .bundle(BundleKind::Physics)
        .iter()
        .next()
        .unwrap()
        .name
        .clone();
    let sign = Edit::SetSign {
        channel: Channel::Output(0),
        role: Some(SignRole::Identified),
    };
    let pin = Edit::Pin(ModelId::new(condition, BundleKind::Physics, model));
    for edit in [
        pin,
        sign,
        Edit::StoreVariant {
            name: "other".to_owned(),
        },
    ] {
        study.apply(&edit).unwrap();
    }
    save_study(&study, &loaded, &study_path).unwrap();
    let row = RowRule {
        condition: Some(3),
        signs: Some([("NZ".to_owned(), -1.0)].into()),
        ..RowRule::default()
    };
    let rules = Rules {
        name: "rules".to_owned(),
        rows: [("a/b.mat".to_owned(), row)].into(),
        ..Rules::default()
    };
    let mut outputs = OutputSet::new(Existing::Keep, Vec::new());
    add_rules(&rules, &rules_path, &mut outputs).unwrap();
    add_tolerances(&ToleranceTable::default(), &tolerances_path, &mut outputs).unwrap();
    outputs.persist().unwrap();
    let levels = concat!(
        r#"[{"name": "Level 1", "level": 1, "axis": "P", "points": [[2, 0], [2.5, 0.2]]}, "#,
        r#"{"name": "Level 2", "axis": "Q", "points": [[1, 0.1], [3, 0.4]]}]"#,
    );
    let named = |name: &str, path: &Path| (name.to_owned(), std::fs::read(path).unwrap());
    [
        named(STUDY, &study_path),
        named(RULES, &rules_path),
        named(TOLERANCES, &tolerances_path),
        (LEVELS.to_owned(), levels.as_bytes().to_vec()),
    ]
}

/// Writes a file in a format that is read only from a path, and opens it; returns whether it was
/// read. A study is also read as the autosaved study of a crashed window.
fn read_from_path(name: &str, bytes: &[u8]) -> Result<bool, String> {
    let folder = tempfile::tempdir().map_err(|error| error.to_string())?;
    let path = folder.path().join(name);
    std::fs::write(&path, bytes).map_err(|error| error.to_string())?;
    let error = match name {
        STUDY => {
            std::fs::write(folder.path().join("small.lock"), "")
                .map_err(|error| error.to_string())?;
            lost_studies(folder.path());
            open_study_of(&path, &small_dataset(), &Default::default()).err()
        }
        TOLERANCES => load_tolerances(&path).err(),
        LEVELS => read_levels(&path).err(),
        _ => load_rules(&path).err(),
    };
    let Some(error) = error else { return Ok(true) };
    let folder_name = folder.path().display().to_string();
    let message = error.to_string().replace(&folder_name, "");
    check_message(name, message.trim_start_matches('/'))?;
    Ok(false)
}

/// Damages a file once: flips a bit, inserts an extreme value, truncates it, or repeats or replaces
/// a part.
fn damage(bytes: &mut Vec<u8>, dice: &mut Dice) {
    let at = dice.below(bytes.len());
    match dice.below(6) {
        _ if bytes.is_empty() => {}
        0 => bytes[at] ^= 1 << dice.below(8),
        1 => {
            let number = dice.pick(&EXTREME_LENGTHS).to_le_bytes();
            let end = (at + number.len()).min(bytes.len());
            bytes[at..end].copy_from_slice(&number[..end - at]);
        }
        2 if dice.once_in(3) => bytes.truncate(at),
        2 => bytes[at] = dice.next() as u8,
        3 => {
            let end = (at + 1 + dice.below(64)).min(bytes.len());
            let piece = bytes[at..end].to_vec();
            let times = if dice.once_in(20) { 2000 } else { 1 };
            bytes.splice(at..at, piece.repeat(times));
        }
        4 => {
            let end = (at + 1 + dice.below(32)).min(bytes.len());
            bytes.drain(at..end);
        }
        _ => {
            let from = dice.below(bytes.len());
            let length = 16.min(bytes.len() - from).min(bytes.len() - at);
            bytes.copy_within(from..from + length, at);
        }
    }
}

/// Returns the file of an execution: a damaged file of the corpus, or a generated one, damaged or
/// not.
fn file_of(dice: &mut Dice) -> NamedBytes {
    let grammars: [fn(&mut Dice) -> NamedBytes; 10] = [
        matlab::file,
        matlab::file_of_objects,
        hdf5::file,
        octave::file,
        logs::file,
        texts::json,
        texts::program_json,
        texts::table,
        texts::literals,
        texts::numpy_or_archive,
    ];
    let is_from_corpus = dice.once_in(3);
    let (name, mut bytes) = if is_from_corpus {
        dice.pick(&CORPUS).clone()
    } else {
        (*dice.pick(&grammars))(dice)
    };
    let damages = if is_from_corpus {
        1 + dice.below(4)
    } else {
        dice.below(3)
    };
    for _ in 0..damages {
        damage(&mut bytes, dice);
    }
    (name, bytes)
}

/// Counts and extremes of a run.
#[derive(Default)]
struct Tally {
    read: AtomicU64,
    slowest_ms: AtomicU64,
    most_memory: AtomicU64,
    failures: Mutex<Vec<String>>,
}

/// Reads a file as models, as records and, if it is JSON, as a dataset, or in the format that its
/// name indicates; returns whether it had any content.
///
/// # Errors
/// A violation of the requirements on a reader.
fn read(name: &str, bytes: &[u8]) -> Result<bool, String> {
    if [STUDY, RULES, TOLERANCES, LEVELS].contains(&name) {
        return read_from_path(name, bytes);
    }
    let budget = || ReadingBudget::new(MOST_MEMORY).with_work(MOST_WORK);
    let models = models_of_bytes(bytes, name, &budget());
    if let Ok(found) = &models {
        found.models.iter().try_for_each(check_finite)?;
    }
    let count = models.as_ref().map_or(0, |found| found.models.len());
    check_error(name, models.err())?;
    let records = records_of_bytes(bytes, name, &budget());
    let tables = records.as_ref().map_or(0, |found| found.tables.len());
    check_error(name, records.err())?;
    let mut is_dataset = false;
    if name.ends_with("json") {
        match load_dataset_bytes(bytes, DatasetOrigin::File(PathBuf::from(name))) {
            Ok(loaded) => is_dataset = !Study::new(loaded.dataset).dataset.conditions().is_empty(),
            Err(error) => check_error(name, Some(error))?,
        }
    }
    Ok(count + tables > 0 || is_dataset)
}

fn check_error(name: &str, error: Option<FileError>) -> Result<(), String> {
    match error {
        Some(error) => check_message(name, &error.to_string()),
        None => Ok(()),
    }
}

/// Checks that an error message names its file, is not too long and has no control characters.
fn check_message(name: &str, message: &str) -> Result<(), String> {
    if !message.starts_with(name)
        || message.len() > 4000
        || message.contains(|letter: char| letter.is_control())
    {
        return Err(format!("unsuitable error message: {message:?}"));
    }
    Ok(())
}

/// Checks that the matrices, the response and the sample time of a model are finite.
fn check_finite(model: &FoundModel) -> Result<(), String> {
    let matrices = model
        .draft
        .matrices
        .iter()
        .flatten()
        .flat_map(|matrix| matrix.iter());
    let response = model.draft.response.iter().flat_map(|response| {
        response
            .omega
            .iter()
            .chain(&response.re.values)
            .chain(&response.im.values)
    });
    let timing = model.draft.timing.sample_time_s.iter();
    let not_finite = matrices
        .chain(response)
        .chain(timing)
        .find(|value| !value.is_finite());
    match not_finite {
        Some(value) => Err(format!(
            "the model {} contains the number {value}",
            model.draft.name
        )),
        None => Ok(()),
    }
}

/// Reads a file once.
///
/// # Errors
/// The reason for the failure: a panic, too much memory, too much time, or a wrong result.
fn execute((name, bytes): &NamedBytes, tally: &Tally) -> Result<(), String> {
    let start = Instant::now();
    let mut outcome = Ok(Ok(false));
    let memory = allocation_counter::measure(|| {
        outcome = catch_unwind(AssertUnwindSafe(|| read(name, bytes)));
    });
    let time = start.elapsed();
    let limit = 2 * MOST_MEMORY + LIBRARY_MEMORY + 4 * bytes.len() as u64;
    tally
        .slowest_ms
        .fetch_max(time.as_millis() as u64, Ordering::Relaxed);
    tally
        .most_memory
        .fetch_max(memory.bytes_max, Ordering::Relaxed);
    let found = outcome.map_err(|_| "the reader panicked".to_owned())??;
    tally.read.fetch_add(u64::from(found), Ordering::Relaxed);
    if memory.bytes_max > limit {
        return Err(format!(
            "the reader took {} bytes of memory",
            memory.bytes_max
        ));
    }
    if time > LONGEST {
        Err(format!("the reader took {time:?}"))
    } else {
        Ok(())
    }
}

/// Runs `executions` executions on all cores, ending earlier at the time `until`.
fn run(seed: u64, executions: u64, until: Option<Instant>) {
    let tally = Tally::default();
    let next = AtomicU64::new(0);
    let start = Instant::now();
    rayon::scope(|scope| {
        for _ in 0..rayon::current_num_threads() {
            scope.spawn(|_| {
                loop {
                    let execution = next.fetch_add(1, Ordering::Relaxed);
                    let is_over = until.is_some_and(|until| Instant::now() >= until)
                        || execution >= executions;
                    if is_over || tally.failures.lock().unwrap().len() >= MOST_FAILURES {
                        return;
                    }
                    let file = file_of(&mut Dice::for_execution(seed, execution));
                    if let Err(why) = execute(&file, &tally) {
                        let path = std::env::temp_dir()
                            .join(format!("gdcm-fuzz-{seed}-{execution}-{}", file.0));
                        let kept = std::fs::write(&path, &file.1)
                            .map_or(String::new(), |()| path.display().to_string());
                        let failure =
                            format!("execution {execution} of seed {seed}: {why} ({kept})");
                        println!("{failure}");
                        tally.failures.lock().unwrap().push(failure);
                    }
                }
            });
        }
    });
    let executed = next.into_inner().min(executions);
    println!(
        "{executed} files tried in {:.0} s, {} of them with readable content; longest {} ms, \
         most memory {} KiB",
        start.elapsed().as_secs_f64(),
        tally.read.into_inner(),
        tally.slowest_ms.into_inner(),
        tally.most_memory.into_inner() >> 10
    );
    let failures = tally.failures.into_inner().unwrap();
    assert!(failures.is_empty(), "{}", failures.join("\n"));
}

#[test]
fn every_reader_ends_in_time_and_within_its_memory_with_content_or_an_error() {
    // An arbitrary seed.
    run(20_261_122, tries(1_000, 20_000), None);
}

#[test]
#[ignore = "long run: GDCM_FUZZ_EXECUTIONS or GDCM_FUZZ_SECONDS sets its length"]
fn long() {
    let number = |name: &str| {
        std::env::var(name)
            .ok()
            .and_then(|text| text.parse::<u64>().ok())
    };
    if let Some(path) = std::env::var_os("GDCM_FUZZ_FILE") {
        let name = Path::new(&path)
            .file_name()
            .unwrap()
            .to_string_lossy()
            .into_owned();
        let outcome = execute(&(name, std::fs::read(&path).unwrap()), &Tally::default());
        return assert_eq!(outcome, Ok(()));
    }
    let seconds = number("GDCM_FUZZ_SECONDS");
    let executions = number("GDCM_FUZZ_EXECUTIONS").unwrap_or(if seconds.is_some() {
        u64::MAX
    } else {
        100_000
    });
    let until = seconds.map(|seconds| Instant::now() + Duration::from_secs(seconds));
    run(number("GDCM_FUZZ_SEED").unwrap_or(1), executions, until);
}
