//! Result files: `corrections.json`, `corrections.csv`, `assessment.csv`.

mod assessment_table;
mod channel_names;
mod channel_table;
mod explanation;
mod gather;
mod schema;

use std::path::Path;

use super::file_error::FileError;
use super::json_text::Format;
use super::source::Source;
use super::whole_file::write_whole;

pub use assessment_table::write_assessment_csv;
pub use channel_table::write_corrections_csv;
pub use explanation::{ConflictEntry, Explanation, RemedyEntry, SensitivityEntry};
pub use schema::{
    Assessment, Channels, ConditionAssessment, ConditionCorrections, Corrections, CostTable, CostTables, DatasetLabel,
    DelayOutcome, GainOutcome, NetGain, ScheduleUsed, ScheduledDelays, ScheduledGains, SetAsideEntry, SettingsUsed,
    Table, UnmatchedDelayEntry, UnmatchedGainEntry, WithoutResult,
};

const NAME: &str = "gdcm-corrections";
const VERSION: u64 = 1;

/// Writes `corrections.json`; replaced whole, or not at all.
pub fn write_corrections(corrections: &Corrections, path: &Path) -> Result<(), FileError> {
    write_whole(path, |file| {
        serde_json::to_writer_pretty(&mut *file, corrections)?;
        file.write_all(b"\n")
    })
}

/// Reads a `corrections.json`.
pub fn read_corrections(path: &Path) -> Result<Corrections, FileError> {
    let format = Format { name: NAME, version: VERSION };
    let source = Source::read(path)?;
    let (corrections, _) = format.decode::<Corrections>(source.text(), path)?;
    format.check_read(&corrections.format, corrections.version, path)?;
    Ok(corrections)
}
