//! Compares the limits in `docs/limits.md` with those of the program. With the environment variable
//! `GDCM_WRITE_FILES`, the tables of the page are rewritten instead.

use gdcm_model::dataset::limits;
use gdcm_model::dataset::limits::{
    LARGEST_TEXT, MOST_CHANNELS, MOST_CONDITIONS, MOST_COORDINATES, MOST_FREQUENCIES, MOST_MODELS,
    MOST_MODELS_IN_ALL, MOST_STATES,
};
use gdcm_model::dataset::state_space::GREATEST_CHANNEL_DELAY_S;
use gdcm_model::units::number;
use gdcm_study::decisions::setting::{Kind, Setting};
use gdcm_study::decisions::setting_table::SETTINGS;

use crate::files::study_file::MOST_VARIANTS;
use crate::formats::file_import::LARGEST_FILE;
use crate::formats::folders::{DEEPEST, MOST_FILES};
use crate::formats::recorded_columns::MOST_RECORDS;
use crate::import::recognise::{DEEPEST as DEEPEST_VALUE, MOST_FOUND};
use crate::reading_budget::{MOST_MEMORY, MOST_WORK};

/// Returns the table of file limits as Markdown rows.
fn file_rows() -> String {
    let rows = [
        ("a file of other programs", mebibytes(LARGEST_FILE)),
        ("text of a file, unpacked", mebibytes(LARGEST_TEXT)),
        (
            "memory for what a file holds, beside a copy of the models or records found in it",
            mebibytes(MOST_MEMORY),
        ),
        (
            "work on a file: bytes of text, elements of arrays, values, names compared",
            format!("{} million steps", MOST_WORK / 1_000_000),
        ),
        (
            "files of the folders that are given",
            MOST_FILES.to_string(),
        ),
        ("folders inside one another", DEEPEST.to_string()),
        (
            "models among the variables of a file; values inside one another",
            format!("{MOST_FOUND}; {DEEPEST_VALUE}"),
        ),
        ("records of an archive", MOST_RECORDS.to_string()),
        ("inputs, outputs", format!("{MOST_CHANNELS} each")),
        ("conditions", MOST_CONDITIONS.to_string()),
        (
            "models of a bundle; of a file",
            format!("{MOST_MODELS}; {MOST_MODELS_IN_ALL}"),
        ),
        ("records of a condition", limits::MOST_RECORDS.to_string()),
        ("states of a model", MOST_STATES.to_string()),
        (
            "frequencies of a measured response",
            MOST_FREQUENCIES.to_string(),
        ),
        (
            "coordinates of a perturbation",
            MOST_COORDINATES.to_string(),
        ),
        (
            "named parameters of the physics model",
            limits::MOST_PARAMETERS.to_string(),
        ),
        ("variants of a study", MOST_VARIANTS.to_string()),
        (
            "delay of a model's channel",
            format!("{} s", number(GREATEST_CHANNEL_DELAY_S)),
        ),
    ];
    rows.map(|(limited, most)| format!("| {limited} | {most} |\n"))
        .concat()
}

fn mebibytes(bytes: u64) -> String {
    format!("{} MiB", bytes >> 20)
}

/// Returns the table of settings with a range as Markdown rows.
fn setting_rows() -> String {
    SETTINGS
        .iter()
        .filter_map(|setting| setting_row(setting))
        .collect()
}

fn setting_row(setting: &Setting) -> Option<String> {
    let [least, greatest] = setting.kind.range()?;
    let is_whole = matches!(setting.kind, Kind::Number { whole: true, .. });
    let kind = if is_whole { ", a whole number" } else { "" };
    let unit = if setting.unit.file.is_empty() {
        String::new()
    } else {
        format!(" {}", setting.unit.file)
    };
    let option = setting.option;
    let name = setting.name;
    Some(format!(
        "| {name}{kind} | `{option}` | {}{unit} | {}{unit} |\n",
        number(least),
        number(greatest)
    ))
}

/// Returns the Markdown table rows at the beginning of `part`.
fn table_rows(part: &str) -> &str {
    let mut end = 0;
    for line in part.split_inclusive('\n') {
        if !line.starts_with('|') {
            break;
        }
        end += line.len();
    }
    &part[..end]
}

#[test]
fn limits_in_the_documentation_match_the_program() {
    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/../../docs/limits.md");
    let text = std::fs::read_to_string(path).unwrap();
    let mut parts: Vec<&str> = text.split_inclusive("|---|\n").collect();
    let [_, files, settings] = parts.as_mut_slice() else {
        panic!("{path}: expected two tables, of files and of settings")
    };
    let files = table_rows(files);
    let settings = table_rows(settings);
    if std::env::var_os("GDCM_WRITE_FILES").is_some() {
        std::fs::write(
            path,
            text.replace(files, &file_rows())
                .replace(settings, &setting_rows()),
        )
        .unwrap();
        return;
    }
    assert_eq!(files, file_rows(), "limits of files");
    assert_eq!(settings, setting_rows(), "ranges of settings");
}
