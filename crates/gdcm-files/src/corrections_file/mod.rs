//! Result files: `corrections.json`, `corrections.csv`, `assessment.csv`.

mod gather;
mod schema;
mod tables;

use std::collections::BTreeSet;
use std::fmt;
use std::io::{self, Write};
use std::marker::PhantomData;
use std::path::{Path, PathBuf};

use serde::de::{Deserializer, MapAccess, Visitor};
use serde::ser::Serializer;
use serde::{Deserialize, Serialize};

use gdcm_core::dataset::ConditionId;
use gdcm_core::study::Analysis;

use super::file_error::FileError;
use super::json_text::Format;
use super::output_set::{OutputSet, make_directory};
use super::source::Source;
use tables::response_table;

pub(super) use tables::channel_table;

pub use schema::*;

const NAME: &str = "gdcm-corrections";
const VERSION: u64 = 1;

/// The names of the files of results.
pub const RESULT_FILES: [&str; 3] = ["corrections.json", "corrections.csv", "assessment.csv"];

/// Where the files of results stand in a directory.
pub fn result_paths(directory: &Path) -> [PathBuf; 3] {
    RESULT_FILES.map(|name| directory.join(name))
}

/// Writes the results of the chosen conditions into a directory, made where there is none: all three files, or none.
///
/// `sha256` is that of the dataset's file.
pub fn write_results(
    analysis: &Analysis,
    sha256: &str,
    chosen: &BTreeSet<ConditionId>,
    directory: &Path,
    mut outputs: OutputSet,
) -> Result<(), FileError> {
    let [json, channels, responses] = result_paths(directory);
    outputs.check(&[&json, &channels, &responses])?;
    make_directory(directory)?;
    outputs.add(&json, |file| write_corrections(analysis, sha256, chosen, file))?;
    outputs.add(&channels, |file| channel_table(analysis, chosen, file))?;
    outputs.add(&responses, |file| response_table(analysis, chosen, file))?;
    outputs.persist()
}

/// `corrections.json`: everything that was found in the chosen conditions.
pub(super) fn write_corrections(
    analysis: &Analysis,
    sha256: &str,
    chosen: &BTreeSet<ConditionId>,
    file: &mut dyn Write,
) -> io::Result<()> {
    serde_json::to_writer_pretty(&mut *file, &Corrections::of(analysis, sha256, chosen))?;
    file.write_all(b"\n")
}

/// Reads a `corrections.json`.
pub fn read_corrections(path: &Path) -> Result<Corrections, FileError> {
    let format = Format { name: NAME, version: VERSION };
    let source = Source::read(path)?;
    let (corrections, _) = format.decode::<Corrections>(source.text(), path)?;
    format.check_read(&corrections.format, corrections.version, path)?;
    Ok(corrections)
}

/// One figure for each channel or model, by name, in the dataset's order: `{"LON": 1.1, "LAT": 1.0}`.
#[derive(Clone, Debug, PartialEq)]
pub struct ByName<T>(pub Vec<(String, T)>);

impl<T> ByName<T> {
    /// The figure of this name.
    pub fn get(&self, name: &str) -> Option<&T> {
        self.0.iter().find(|(named, _)| named == name).map(|(_, figure)| figure)
    }
}

impl<T: Serialize> Serialize for ByName<T> {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.collect_map(self.0.iter().map(|(name, figure)| (name, figure)))
    }
}

impl<'de, T: Deserialize<'de>> Deserialize<'de> for ByName<T> {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        deserializer.deserialize_map(Entries(PhantomData))
    }
}

struct Entries<T>(PhantomData<T>);

impl<'de, T: Deserialize<'de>> Visitor<'de> for Entries<T> {
    type Value = ByName<T>;

    fn expecting(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.write_str("an object with a figure for each name")
    }

    fn visit_map<A: MapAccess<'de>>(self, mut entries: A) -> Result<ByName<T>, A::Error> {
        let mut figures = Vec::new();
        while let Some(entry) = entries.next_entry()? {
            figures.push(entry);
        }
        Ok(ByName(figures))
    }
}
