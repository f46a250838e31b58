//! Files: datasets, studies and results. The only place that touches the file system.

mod beginning;
mod corrections_file;
mod dataset_file;
mod export_contents;
mod exports;
mod figure_file;
mod file_error;
mod formats;
mod json_text;
mod location;
mod model_files;
mod models_file;
mod output_set;
mod recognise;
mod record_files;
mod report_file;
mod requirements_file;
mod rules_file;
mod source;
mod strides;
mod study_file;
mod user_state;
pub mod variables;

pub use beginning::check_beginning;
pub use corrections_file::*;
pub use dataset_file::{
    DatasetOrigin, LoadedDataset, add_dataset, dataset_faults, embedded_example, load_dataset,
    load_dataset_bytes, load_dataset_within, save_dataset, write_example,
};
pub use export_contents::{ExportContents, LeftOutPart, PartSource};
pub use exports::{
    EXPORTERS, ExportFault, ExportFormat, ExportRequest, ExportSource, ExportedRole, check_export,
    export_contents, write_export,
};
pub use figure_file::{csv_text, figure_format, save_tables, write_as, write_figure};
pub use file_error::{ContentFault, FileError, system_words};

pub use formats::mat::write as write_mat;
pub use formats::npy::write_npz;
pub use formats::text::UnsaidUnit;
pub use formats::{FolderProgress, sources_folder};
pub use gdcm_model::dataset::limits::LARGEST_TEXT;
pub use json_text::write_pretty;
pub use model_files::{EVERY_TABLE, FoundModels, models_of_bytes, read_models};
pub use models_file::{IdentifiedModels, add_identified, add_models};
pub use output_set::{Existing, OutputSet, make_directory, report_size_limit};
pub use record_files::{
    EXAMPLE_RECORD_CONDITIONS, FoundRecords, example_records, load_records, read_records,
    records_of_bytes, relative_entry,
};
pub use report_file::{ReportSource, ReportSubject, assessment_sentence, report, save_report};
pub use requirements_file::{
    REQUIREMENT_FILES, add_tolerances, load_tolerances, read_levels, requirement_paths,
    write_requirements,
};
pub use rules_file::{add_rules, load_rules, rules_path};
pub use source::{FileStamp, at_home, file_exists, file_sha256};
pub use study_file::{
    Opened, OpenedStudy, STUDY_EXTENSION, holds_models, load_any, open_study, open_study_of,
    relative_folder, save_study,
};
pub use user_state::{
    LostStudy, RecoveryFile, add_recent_file, is_first_start, lost_studies, recent_files,
};
