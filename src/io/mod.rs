//! Files: datasets, studies and results. The only place that touches the file system.

mod by_name;
mod content_fault;
mod corrections_file;
mod csv_file;
mod dataset_file;
mod directory;
mod file_error;
mod file_stamp;
mod flaw;
mod json_text;
mod nested;
mod opened;
mod outline;
mod place;
mod plain;
mod recent_files;
mod recovery_file;
mod source;
mod study_file;
mod unknown_keys;
mod whole_file;

pub use by_name::ByName;
pub use content_fault::ContentFault;
pub use corrections_file::{
    Assessment, Channels, ConditionAssessment, ConditionCorrections, ConflictEntry, Corrections, CostTable, CostTables,
    DatasetLabel, DelayOutcome, Explanation, GainOutcome, NetGain, RemedyEntry, ScheduleUsed, ScheduledDelays,
    ScheduledGains, SensitivityEntry, SetAsideEntry, SettingsUsed, Table, UnmatchedDelayEntry, UnmatchedGainEntry,
    WithoutResult, read_corrections, write_assessment_csv, write_corrections, write_corrections_csv,
};
pub use dataset_file::{
    DatasetOrigin, LoadedDataset, embedded_example, load_dataset, load_dataset_bytes, save_dataset, write_example,
};
pub use directory::make_directory;
pub use file_error::FileError;
pub use file_stamp::{FileStamp, file_exists, file_sha256};
pub use opened::{Opened, load_any};
pub use place::{ConditionPlace, ModelPlace, Place};
pub use plain::plain;
pub use recent_files::{add_recent_file, recent_files};
pub use recovery_file::{LostStudy, RecoveryFile, lost_studies};
pub use source::LARGEST_TEXT;
pub use study_file::{OpenedStudy, STUDY_EXTENSION, open_study, open_study_of, save_study};
