//! Exported files with a common prefix in a folder: a dry run computes every file with its notes,
//! and the same bytes are then written together, or not at all.
//!
//! ```text
//! names   prefix + stem + suffix + extension; a suffix ("_2") prevents replacing files
//! dry run each format computes its bytes, its summary and its notes; notes on the same subject are
//!         merged; then the checksums of these files, if requested
//! write   all files; the caller writes the report
//! ```
//!
//! A note states an omission or an approximation in files; its remedy, if it has one, is a
//! change to the study or the export that removes or reduces it.

use std::path::{Path, PathBuf};

use sha2::{Digest, Sha256};

use gdcm_model::progress::{Cancelled, Progress};
use gdcm_study::Analysis;
use gdcm_study::results::export_note::{ExportNote, FileSummary};

use super::file_head::text_head;
use super::{EXPORTERS, Export, ExportFormat, ExportRequest, ExportSource};
use crate::export_fault::ExportFault;
use crate::file_error::FileError;
use crate::output_set::{OutputSet, make_directory};

/// Report file name, without the prefix.
const REPORT_STEM: &str = "report";
/// Name for the checksum file in format lists; also its extension.
pub const CHECKSUMS: &str = "sha256";
/// Checksum file name, without the prefix.
const CHECKSUM_STEM: &str = "checksums";

/// How existing files with the set's names are treated.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum ExistingNames {
    /// The set gets names as if no file existed; writing then replaces or refuses existing files.
    #[default]
    Ignore,
    /// If a file with one of the names exists, all names in the set get the same number as suffix:
    /// "_2", "_3".
    Number,
}

/// Formats, folder and names for a set of files.
#[derive(Clone, Debug, PartialEq)]
pub struct ExportSet {
    pub formats: Vec<ExportFormat>,
    /// Whether a checksum file (SHA-256) is added.
    pub has_checksums: bool,
    /// Whether the report gets a name from the set; the caller writes it afterwards.
    pub has_report: bool,
    pub folder: PathBuf,
    /// Beginning of every file name; may be empty.
    pub prefix: String,
    pub existing: ExistingNames,
    /// Contents and options for every file; the request's own format is not used.
    pub request: ExportRequest,
}

/// A file computed in a dry run.
#[derive(Clone, Debug)]
pub struct PlannedFile {
    pub name: String,
    pub format: &'static str,
    /// Contents, or why there are none.
    pub contents: Result<PlannedContents, ExportFault>,
}

/// File contents with facts about them.
#[derive(Clone, Debug)]
pub struct PlannedContents {
    pub bytes: Vec<u8>,
    pub summary: FileSummary,
    /// First lines of a text file, or a binary file's description.
    pub head: Vec<String>,
}

/// A note, with the indices of the files that it concerns; the report's index follows the last
/// file's.
#[derive(Clone, Debug, PartialEq)]
pub struct PlannedNote {
    pub note: ExportNote,
    pub files: Vec<usize>,
}

/// Result of a dry run.
#[derive(Clone, Debug)]
pub struct ExportPlan {
    pub files: Vec<PlannedFile>,
    pub notes: Vec<PlannedNote>,
    /// Names that the set would have without a suffix, and that exist in the folder.
    pub existing_files: Vec<String>,
    /// Suffix of the names, by which existing files are kept: "_2"; may be empty.
    pub suffix: String,
    /// Report file name; the dry run does not compute the report.
    pub report: Option<String>,
}

impl ExportSet {
    /// Returns the formats with these names, in display order, and whether the names include
    /// [`CHECKSUMS`]; unknown names are ignored.
    pub fn formats_named<'n>(
        names: impl IntoIterator<Item = &'n str>,
    ) -> (Vec<ExportFormat>, bool) {
        let names: Vec<&str> = names.into_iter().collect();
        let formats = EXPORTERS
            .into_iter()
            .filter(|format| names.contains(&format.name))
            .collect();
        (formats, names.contains(&CHECKSUMS))
    }

    /// Returns the set's file names with this suffix: one per format in their order, then checksums
    /// and report if the set has them.
    fn names(&self, suffix: &str) -> Vec<String> {
        let mut names = Vec::new();
        for format in &self.formats {
            names.push(file_name(
                &self.prefix,
                format.stem,
                suffix,
                format.extension,
            ));
        }
        if self.has_checksums {
            names.push(file_name(&self.prefix, CHECKSUM_STEM, suffix, CHECKSUMS));
        }
        if self.has_report {
            names.push(self.report_name(suffix));
        }
        names
    }

    fn report_name(&self, suffix: &str) -> String {
        file_name(&self.prefix, REPORT_STEM, suffix, "html")
    }

    /// Returns the names in the folder that a set with this suffix would replace.
    fn existing_files(&self, suffix: &str) -> Vec<String> {
        let mut names = self.names(suffix);
        names.retain(|name| self.folder.join(name).exists());
        names
    }

    /// Returns the first suffix, from "_2", with which no file exists.
    fn free_suffix(&self) -> String {
        let mut number = 2;
        loop {
            let suffix = format!("_{number}");
            if self.existing_files(&suffix).is_empty() {
                return suffix;
            }
            number += 1;
        }
    }

    /// Rejects names that do not suit their formats; meant to be called before the analysis.
    ///
    /// # Errors
    /// [`FileError::Export`] with the first fault.
    pub fn check(&self) -> Result<(), FileError> {
        for (format, name) in self.formats.iter().zip(self.names("")) {
            super::check_export(*format, &self.folder.join(name))?;
        }
        Ok(())
    }

    /// Returns the set's paths, as if no file existed.
    pub fn paths(&self) -> Vec<PathBuf> {
        let names = self.names("").into_iter();
        names.map(|name| self.folder.join(name)).collect()
    }

    /// Computes all files and, if requested, their checksums, without writing any. A file that
    /// cannot be computed stays in the plan, with the fault instead of its contents.
    ///
    /// # Errors
    /// [`Cancelled`] between two files.
    pub fn dry_run(
        &self,
        analysis: &Analysis,
        source: &ExportSource,
        progress: &dyn Progress,
    ) -> Result<ExportPlan, Cancelled> {
        let existing_files = self.existing_files("");
        let suffix = if existing_files.is_empty() || self.existing == ExistingNames::Ignore {
            String::new()
        } else {
            self.free_suffix()
        };
        let mut plan = ExportPlan {
            files: Vec::new(),
            notes: Vec::new(),
            existing_files,
            report: if self.has_report {
                Some(self.report_name(&suffix))
            } else {
                None
            },
            suffix,
        };
        // After the formats, the next name is that of the checksums.
        let mut names = self.names(&plan.suffix).into_iter();
        for (index, (format, name)) in self.formats.iter().zip(&mut names).enumerate() {
            progress.advanced(index, self.formats.len());
            if progress.cancelled() {
                return Err(Cancelled);
            }
            self.add_file(&mut plan, *format, name, analysis, source);
        }
        if self.has_checksums
            && let Some(name) = names.next()
        {
            plan.add_checksums(name);
        }
        if self.has_report && self.request.conditions.is_some() {
            plan.add_note(ExportNote::ReportOfAllConditions);
        }
        plan.sort_notes();
        Ok(plan)
    }

    /// Computes a file and adds it to the plan with its notes.
    fn add_file(
        &self,
        plan: &mut ExportPlan,
        format: ExportFormat,
        name: String,
        analysis: &Analysis,
        source: &ExportSource,
    ) {
        let request = ExportRequest {
            format,
            ..self.request.clone()
        };
        let path = self.folder.join(&name);
        let export = Export {
            analysis,
            source,
            request: &request,
            path: &path,
        };
        let (contents, notes) = match compute_file(&export) {
            Ok((contents, notes)) => (Ok(contents), notes),
            Err(fault) => (Err(fault), Vec::new()),
        };
        for note in notes {
            plan.add_note(note);
        }
        plan.files.push(PlannedFile {
            name,
            format: format.name,
            contents,
        });
    }
}

/// Computes the contents of a file, with its notes.
fn compute_file(export: &Export<'_>) -> Result<(PlannedContents, Vec<ExportNote>), ExportFault> {
    let format = &export.request.format;
    (format.check_path)(export.path)?;
    let exported = (format.export)(export)?;
    let mut bytes = Vec::new();
    (exported.write)(&mut bytes).map_err(|error| ExportFault::contents(&error))?;
    let head = match exported.head {
        Some(head) => head,
        None => text_head(&bytes),
    };
    let contents = PlannedContents {
        bytes,
        summary: exported.summary,
        head,
    };
    Ok((contents, exported.notes))
}

impl ExportPlan {
    /// Adds a note on the file that is added next, or on the report after all files. If the plan
    /// already has a note on the same subject, the file is added to that note.
    fn add_note(&mut self, note: ExportNote) {
        // The next file's index; after all files, the report's.
        let file = self.files.len();
        for known in &mut self.notes {
            if known.note.has_same_subject(&note) {
                if !known.files.contains(&file) {
                    known.files.push(file);
                }
                return;
            }
        }
        self.notes.push(PlannedNote {
            note,
            files: vec![file],
        });
    }

    /// Sorts the notes: those with a remedy first, otherwise in their order.
    fn sort_notes(&mut self) {
        self.notes
            .sort_by_key(|planned| planned.note.remedy().is_none());
    }

    /// Returns the number of files, including the report.
    pub fn file_count(&self) -> usize {
        self.files.len() + usize::from(self.report.is_some())
    }

    /// Returns the name of a file; the report follows the others.
    pub fn file_name(&self, index: usize) -> Option<&str> {
        match self.files.get(index) {
            Some(file) => Some(&file.name),
            None if index == self.files.len() => self.report.as_deref(),
            None => None,
        }
    }

    /// Adds the notes on the report, once it is composed.
    pub fn add_report_notes(&mut self, notes: &[ExportNote]) {
        for note in notes {
            self.add_note(note.clone());
        }
        self.sort_notes();
    }

    /// Adds the file with the SHA-256 of the others, in the format of `sha256sum`.
    fn add_checksums(&mut self, name: String) {
        let mut text = String::new();
        let mut files = 0;
        for file in &self.files {
            if let Ok(contents) = &file.contents {
                text.push_str(&format!(
                    "{:x}  {}\n",
                    Sha256::digest(&contents.bytes),
                    file.name
                ));
                files += 1;
            }
        }
        let bytes = text.into_bytes();
        self.files.push(PlannedFile {
            name,
            format: CHECKSUMS,
            contents: Ok(PlannedContents {
                head: text_head(&bytes),
                bytes,
                summary: FileSummary::Checksums { files },
            }),
        });
    }

    /// Returns the total file size \[bytes\], without the report.
    pub fn size(&self) -> usize {
        let mut size = 0;
        for file in &self.files {
            if let Ok(contents) = &file.contents {
                size += contents.bytes.len();
            }
        }
        size
    }

    /// Returns the first file without contents, with the reason.
    pub fn first_fault(&self) -> Option<(&PlannedFile, &ExportFault)> {
        self.files.iter().find_map(|file| match &file.contents {
            Ok(_) => None,
            Err(fault) => Some((file, fault)),
        })
    }

    /// Writes all files into `folder`, which is created if missing, or none; returns their paths.
    ///
    /// # Errors
    /// [`FileError::Export`] if a file has no contents, [`FileError::Exists`] if a file exists and
    /// `outputs` keeps it, and disk errors.
    pub fn write(&self, folder: &Path, mut outputs: OutputSet) -> Result<Vec<PathBuf>, FileError> {
        if let Some((file, fault)) = self.first_fault() {
            return Err(FileError::export(&folder.join(&file.name), fault.clone()));
        }
        let paths: Vec<PathBuf> = self
            .files
            .iter()
            .map(|file| folder.join(&file.name))
            .collect();
        outputs.check(&paths)?;
        make_directory(folder)?;
        for (file, path) in self.files.iter().zip(&paths) {
            if let Ok(contents) = &file.contents {
                outputs.add(path, |out| out.write_all(&contents.bytes))?;
            }
        }
        outputs.persist()?;
        Ok(paths)
    }
}

/// Composes a file name, such as "uh60_correction_2.m".
fn file_name(prefix: &str, stem: &str, suffix: &str, extension: &str) -> String {
    format!("{prefix}{stem}{suffix}.{extension}")
}

/// Derives a file name prefix from a study or dataset name: small ASCII letters, digits and
/// underscores, with an underscore at its end and a letter at its beginning, so that it can begin a
/// function name. Empty if the name begins with a digit, or has neither letters nor digits.
pub fn proposed_prefix(name: &str) -> String {
    let mut prefix = String::new();
    for letter in name.chars() {
        let plain = if letter.is_ascii_alphanumeric() {
            letter.to_ascii_lowercase()
        } else {
            '_'
        };
        if !(plain == '_' && (prefix.is_empty() || prefix.ends_with('_'))) {
            prefix.push(plain);
        }
    }
    let prefix = prefix.trim_end_matches('_');
    if prefix.starts_with(|letter: char| letter.is_ascii_alphabetic()) {
        format!("{prefix}_")
    } else {
        String::new()
    }
}

#[cfg(test)]
mod tests {
    use gdcm_model::progress::Unobserved;
    use gdcm_study::decisions::setting_table;
    use gdcm_study::results::export_note::ExportRemedy;
    use gdcm_study::{Engine, PhaseCorrection, Study};

    use super::*;
    use crate::files::dataset_file::embedded_example;
    use crate::output_set::Existing;

    fn analysis(phase: PhaseCorrection) -> Analysis {
        let mut study = Study::new(embedded_example().unwrap().dataset);
        study.apply(&setting_table::PHASE.to(phase)).unwrap();
        Engine::default().analyze(&study, &Unobserved).unwrap()
    }

    fn source() -> ExportSource {
        ExportSource {
            name: "example".to_owned(),
            sha256: "ba78".to_owned(),
        }
    }

    fn set(folder: &Path, formats: &[&str]) -> ExportSet {
        let (formats, has_checksums) = ExportSet::formats_named(formats.iter().copied());
        ExportSet {
            formats,
            has_checksums,
            has_report: false,
            folder: folder.to_owned(),
            prefix: "uh60_".to_owned(),
            existing: ExistingNames::Number,
            request: ExportRequest::default(),
        }
    }

    fn codes(plan: &ExportPlan) -> Vec<&'static str> {
        plan.notes
            .iter()
            .map(|planned| planned.note.code())
            .collect()
    }

    #[test]
    fn what_is_written_is_what_the_dry_run_computed_and_existing_files_are_kept() {
        let folder = tempfile::tempdir().unwrap();
        let analysis = analysis(PhaseCorrection::Delay);
        let set = set(folder.path(), &["csv", "m", CHECKSUMS]);
        let plan = set.dry_run(&analysis, &source(), &Unobserved).unwrap();
        assert_eq!(plan.existing_files, [""; 0]);
        let outputs = OutputSet::new(Existing::Keep, Vec::new());
        let paths = plan.write(folder.path(), outputs).unwrap();
        for (path, file) in paths.iter().zip(&plan.files) {
            let contents = file.contents.as_ref().unwrap();
            assert_eq!(std::fs::read(path).unwrap(), contents.bytes);
        }
        let again = set.dry_run(&analysis, &source(), &Unobserved).unwrap();
        let names: Vec<&str> = again.files.iter().map(|file| file.name.as_str()).collect();
        assert_eq!(
            names,
            [
                "uh60_corrections_2.csv",
                "uh60_correction_2.m",
                "uh60_checksums_2.sha256"
            ]
        );
        assert_eq!(again.existing_files.len(), 3);
        let function = again.files[1].contents.as_ref().unwrap();
        assert!(function.head[0].contains("= uh60_correction_2(airspeed_kt"));
        let sums = String::from_utf8(again.files[2].contents.as_ref().unwrap().bytes.clone());
        assert_eq!(sums.unwrap().lines().count(), 2);
    }

    #[test]
    fn the_writers_name_what_the_schedule_lacks_and_offer_to_turn_it_on() {
        let folder = tempfile::tempdir().unwrap();
        let analysis = analysis(PhaseCorrection::Delay);
        let set = set(folder.path(), &["json", "m", "h", "table-csv"]);
        let plan = set.dry_run(&analysis, &source(), &Unobserved).unwrap();
        assert_eq!(
            codes(&plan),
            ["delays-not-scheduled", "gain-table-error", "no-error-bars"]
        );
        let delays = &plan.notes[0];
        assert_eq!(delays.files, [1, 2, 3]);
        assert_eq!(delays.note.remedy(), Some(ExportRemedy::ScheduleDelays));
    }

    #[test]
    fn adding_the_offered_airspeed_reduces_the_error_of_the_table() {
        let folder = tempfile::tempdir().unwrap();
        let analysis = analysis(PhaseCorrection::None);
        let mut set = set(folder.path(), &["table-csv"]);
        set.request.breakpoints_kt = Some(vec![45.0, 100.0, 140.0]);
        let error = |set: &ExportSet| {
            let plan = set.dry_run(&analysis, &source(), &Unobserved).unwrap();
            let table = plan.notes.iter().find_map(|planned| match planned.note {
                ExportNote::GainTableError {
                    error_percent,
                    remedy_kt,
                    ..
                } => Some((error_percent, remedy_kt.unwrap())),
                _ => None,
            });
            table.unwrap()
        };
        let (before, remedy_kt) = error(&set);
        assert_eq!(remedy_kt % 5.0, 0.0);
        let breakpoints = set.request.breakpoints_kt.as_mut().unwrap();
        breakpoints.push(remedy_kt);
        breakpoints.sort_by(f64::total_cmp);
        let (after, _) = error(&set);
        assert!(after < before, "{after} and {before}");
    }

    #[test]
    fn leads_limit_the_validity_and_a_higher_order_reduces_the_error_of_delays() {
        let folder = tempfile::tempdir().unwrap();
        let analysis = analysis(PhaseCorrection::Lead);
        let mut set = set(folder.path(), &["py", "state-space-npz"]);
        let plan = set.dry_run(&analysis, &source(), &Unobserved).unwrap();
        let limit = plan.notes.iter().find_map(|planned| match &planned.note {
            ExportNote::NotValidAbove { price } => Some((price.limit_rad_s, &planned.files)),
            _ => None,
        });
        assert_eq!(limit, Some((12.0, &vec![0, 1])));
        assert!(
            codes(&plan).contains(&"signed-delays-not-scheduled"),
            "{:?}",
            codes(&plan)
        );
        set.request.correction = gdcm_study::AssessedCorrection::Own;
        let pade = |set: &ExportSet| {
            let plan = set.dry_run(&analysis, &source(), &Unobserved).unwrap();
            plan.notes.iter().find_map(|planned| match planned.note {
                ExportNote::PadeError {
                    error_deg, remedy, ..
                } => Some((error_deg, remedy)),
                _ => None,
            })
        };
        set.request.pade = gdcm_method::correction::Pade::new(1).unwrap();
        let (first, remedy) = pade(&set).unwrap();
        assert_eq!(remedy, Some(2));
        set.request.pade = gdcm_method::correction::Pade::new(2).unwrap();
        let second = pade(&set).map_or(0.0, |(error_deg, _)| error_deg);
        assert!(second < 0.2 * first, "{second} and {first}");
    }

    #[test]
    fn conditions_that_are_left_out_are_named_by_the_files_without_them() {
        let folder = tempfile::tempdir().unwrap();
        let analysis = analysis(PhaseCorrection::None);
        let mut set = set(folder.path(), &["json", "csv", "py", "state-space"]);
        let chosen = analysis.study.dataset.ids().take(9).collect();
        set.request.conditions = Some(chosen);
        let plan = set.dry_run(&analysis, &source(), &Unobserved).unwrap();
        let left_out = plan.notes.iter().find_map(|planned| match &planned.note {
            ExportNote::ConditionsNotChosen { conditions } => {
                Some((conditions.len(), planned.files.clone()))
            }
            _ => None,
        });
        assert_eq!(left_out, Some((2, vec![0, 1, 3])));
        let models = plan.files[3].contents.as_ref().unwrap();
        let expected = FileSummary::Models {
            models: 9,
            added_states: 0,
        };
        assert_eq!(models.summary, expected);
    }

    #[test]
    fn a_prefix_can_begin_the_name_of_a_function() {
        assert_eq!(
            proposed_prefix("flight 7.gdcm-study.json"),
            "flight_7_gdcm_study_json_"
        );
        assert_eq!(proposed_prefix("UH-60A"), "uh_60a_");
        assert_eq!(proposed_prefix("7"), "");
    }
}
