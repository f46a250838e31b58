//! A study's corrections for other tools: programs and tables that compute the corrections
//! elsewhere, corrected models, and all results as JSON, CSV or a MATLAB struct. Each is an
//! [`ExportFormat`]; the command line, the window and the documentation list the formats in
//! [`EXPORTERS`].
//!
//! A format computes an [`Exported`] from an [`Export`]: the bytes of the file, with *remarks*,
//! lines of text for the command line, and *notes*, facts for the list of files. A correction has
//! the *parts* gains, delays, leads and couplings; [`ExportContents`] tells which of them a file
//! contains, and where they come from.

mod all_results;
mod corrected_models;
mod corrections_struct;
mod export_notes;
pub mod export_set;
mod exported_model;
mod exported_schedule;
pub mod figure_file;
mod file_head;
mod json_to_matlab;
mod lookup_table;
mod matlab_names;
mod matlab_values;
mod model_description;
mod program_text;
mod programs;
mod requested_models;
mod schedule_heading;
mod state_names;
mod table_deviation;

use std::collections::BTreeSet;
use std::io::{self, Write};
use std::path::Path;

use gdcm_method::correction::Pade;
use gdcm_model::dataset::ConditionId;
use gdcm_study::decisions::export_choices::ExportChoices;
use gdcm_study::results::export_note::{ExportNote, FileSummary};
use gdcm_study::{Analysis, AssessedCorrection};
use gdcm_words::coupling_error::coupling_error_text;
use gdcm_words::lead_price::price_text;

pub use self::corrected_models::corrected_models_json;
use self::exported_schedule::ExportedSchedule;
pub use self::requested_models::corrected_response;
use crate::export_fault::ExportFault;
use crate::file_error::FileError;
use crate::files::export_contents::ExportContents;
use crate::output_set::OutputSet;

/// Purpose that several formats share; the variants are in display order.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FormatGroup {
    PerCondition,
    /// The schedule as a function in a programming language.
    Function,
    /// The schedule at some airspeeds.
    Table,
    Models,
}

impl FormatGroup {
    pub const ALL: [Self; 4] = [
        Self::PerCondition,
        Self::Function,
        Self::Table,
        Self::Models,
    ];

    /// Returns the group heading.
    pub fn name(self) -> &'static str {
        match self {
            Self::PerCondition => "Per condition",
            Self::Function => "Functions of airspeed",
            Self::Table => "Tables over airspeed",
            Self::Models => "Models",
        }
    }
}

/// A format in which a study's corrections can be exported.
#[derive(Clone, Copy, Debug)]
pub struct ExportFormat {
    /// Name on the command line.
    pub name: &'static str,
    /// File extension, without the dot.
    pub extension: &'static str,
    /// File name without prefix and extension, for files that are named by the program.
    pub stem: &'static str,
    pub group: FormatGroup,
    /// Name within its group.
    pub title: &'static str,
    /// Short description, for lists of formats.
    pub words: &'static str,
    /// Options of `gdcm export` that affect this format. An option that affects no requested format
    /// is rejected.
    pub options: &'static [&'static str],
    /// Rejects a file name that does not suit the format; called before the analysis.
    check_path: fn(&Path) -> Result<(), ExportFault>,
    /// Returns the correction parts that the file will contain.
    correction_parts: fn(&Analysis, &ExportRequest) -> ExportContents,
    /// Computes the bytes of the file.
    export: for<'e> fn(&Export<'e>) -> Result<Exported<'e>, ExportFault>,
}

/// All export formats, in display order; the first is the default.
pub static EXPORTERS: [ExportFormat; 13] = [
    all_results::JSON,
    all_results::CSV,
    all_results::ASSESSMENT,
    all_results::PHYSICS,
    all_results::MAT,
    programs::MATLAB,
    programs::PYTHON,
    programs::C,
    lookup_table::CSV,
    lookup_table::MAT,
    corrected_models::STATE_SPACE,
    corrected_models::NUMPY,
    corrected_models::JSON,
];

impl ExportFormat {
    /// Returns the format with this command-line name; `None` for an unknown name.
    pub fn named(name: &str) -> Option<Self> {
        EXPORTERS.into_iter().find(|format| format.name == name)
    }
}

impl Default for ExportFormat {
    fn default() -> Self {
        EXPORTERS[0]
    }
}

impl PartialEq for ExportFormat {
    fn eq(&self, other: &Self) -> bool {
        self.name == other.name
    }
}

/// Physics model to export at each condition.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub enum ExportedRole {
    /// The model at the condition's own trim.
    #[default]
    Nominal,
    /// The model that represents the bundle.
    Representative,
    Named(String),
}

impl ExportedRole {
    /// Returns the role for a command-line name: "nominal", "representative", or a model name.
    pub fn from_name(name: &str) -> Self {
        match name {
            ExportChoices::NOMINAL => Self::Nominal,
            ExportChoices::REPRESENTATIVE => Self::Representative,
            name => Self::Named(name.to_owned()),
        }
    }
}

/// Request for an export, with its options; by default nominal models with the scheduled correction
/// and second-order Padé approximants.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ExportRequest {
    pub format: ExportFormat,
    /// Airspeeds \[kt\] for a lookup table; by default the scheduled conditions' distinct
    /// airspeeds.
    pub breakpoints_kt: Option<Vec<f64>>,
    /// Conditions whose results and models are exported; all conditions if `None`.
    pub conditions: Option<BTreeSet<ConditionId>>,
    /// Physics model exported for each condition.
    pub role: ExportedRole,
    /// Correction that is applied to exported models.
    pub correction: AssessedCorrection,
    /// Padé approximant for delays in exported models.
    pub pade: Pade,
}

/// Where the exported corrections come from, as stated in the file.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ExportSource {
    pub name: String,
    /// SHA-256 of the dataset file, in hexadecimal.
    pub sha256: String,
}

impl ExportSource {
    /// Creates the origin from its file name, without folders. `file` is the study, or the dataset
    /// if the study is not saved; `None` for the embedded example.
    pub fn new(file: Option<&Path>, sha256: &str) -> Self {
        let name = match file.and_then(Path::file_name) {
            Some(name) => name.to_string_lossy().into_owned(),
            None => "the embedded example".to_owned(),
        };
        Self {
            name,
            sha256: sha256.to_owned(),
        }
    }
}

/// Everything that an export needs: analysis, origin, request and path.
#[derive(Clone, Copy)]
pub struct Export<'e> {
    pub analysis: &'e Analysis,
    pub source: &'e ExportSource,
    pub request: &'e ExportRequest,
    pub path: &'e Path,
}

impl ExportRequest {
    /// Returns the conditions in the request, by default all.
    fn chosen_conditions(&self, analysis: &Analysis) -> BTreeSet<ConditionId> {
        match &self.conditions {
            Some(conditions) => conditions.clone(),
            None => analysis.study.dataset.ids().collect(),
        }
    }
}

impl<'e> Export<'e> {
    /// Returns a remark on the price of the scheduled leads (the gain that they add above the band,
    /// and the frequency above which the model is not valid; M15.6), for files that contain these
    /// leads; empty without leads.
    fn price_remarks(&self) -> Vec<String> {
        let Ok(schedule) = &self.analysis.schedule else {
            return Vec::new();
        };
        match schedule.lead_price() {
            Some(price) => {
                let (inputs, outputs) = self.analysis.study.dataset.input_and_output_names();
                vec![price_text(&price, &inputs, &outputs)]
            }
            None => Vec::new(),
        }
    }

    /// Returns the study's schedule with its couplings.
    ///
    /// # Errors
    /// Fails if the study has no schedule, or if couplings or physics parameters that it requests
    /// are unavailable.
    fn scheduled(&self) -> Result<ExportedSchedule<'e>, ExportFault> {
        let analysis = self.analysis;
        let schedule = match &analysis.schedule {
            Ok(schedule) => schedule,
            Err(error) => return Err(ExportFault::Schedule(*error)),
        };
        analysis
            .requested_physics()
            .map_err(|failure| ExportFault::NoPhysics {
                why: failure.to_string(),
            })?;
        let couplings =
            analysis
                .requested_couplings()
                .map_err(|error| ExportFault::NoCouplings {
                    why: coupling_error_text(error, &analysis.study.dataset),
                })?;
        Ok(ExportedSchedule {
            schedule,
            dataset: &analysis.study.dataset,
            source: self.source,
            couplings: couplings.map(|fitted| fitted.matrices()),
            contents: ExportContents::of_scheduled(analysis),
        })
    }
}

/// Function that writes a file's bytes.
type WriteBytes<'e> = Box<dyn FnOnce(&mut dyn Write) -> io::Result<()> + 'e>;

/// A file's bytes, with remarks on them line by line, and with facts for the list of files.
pub struct Exported<'e> {
    write: WriteBytes<'e>,
    remarks: Vec<String>,
    summary: FileSummary,
    notes: Vec<ExportNote>,
    /// Description of a binary file for the list of files, line by line; `None` for text, whose
    /// first lines are shown instead.
    head: Option<Vec<String>>,
}

impl<'e> Exported<'e> {
    fn new(
        summary: FileSummary,
        write: impl FnOnce(&mut dyn Write) -> io::Result<()> + 'e,
    ) -> Self {
        Self {
            write: Box::new(write),
            remarks: Vec::new(),
            summary,
            notes: Vec::new(),
            head: None,
        }
    }

    fn bytes(summary: FileSummary, bytes: impl Into<Vec<u8>>) -> Self {
        let bytes = bytes.into();
        Self::new(summary, move |file| file.write_all(&bytes))
    }

    fn with_remarks(self, remarks: Vec<String>) -> Self {
        Self { remarks, ..self }
    }

    fn with_notes(self, notes: Vec<ExportNote>) -> Self {
        Self { notes, ..self }
    }

    fn with_head(self, head: Vec<String>) -> Self {
        Self {
            head: Some(head),
            ..self
        }
    }
}

/// Rejects a file name that does not suit the export format; meant to be called before the
/// analysis.
///
/// # Errors
/// [`FileError::Export`] with the reason.
pub fn check_export(format: ExportFormat, path: &Path) -> Result<(), FileError> {
    (format.check_path)(path).map_err(|fault| FileError::export(path, fault))
}

/// Returns the correction parts that the requested file will contain.
pub fn export_contents(analysis: &Analysis, request: &ExportRequest) -> ExportContents {
    (request.format.correction_parts)(analysis, request)
}

/// Writes the requested export and returns remarks, line by line. [`export_contents`] describes the
/// file's contents.
pub fn write_export(
    analysis: &Analysis,
    source: &ExportSource,
    request: &ExportRequest,
    path: &Path,
    mut outputs: OutputSet,
) -> Result<Vec<String>, FileError> {
    check_export(request.format, path)?;
    let export = Export {
        analysis,
        source,
        request,
        path,
    };
    let exported =
        (request.format.export)(&export).map_err(|fault| FileError::export(path, fault))?;
    outputs.add(path, exported.write)?;
    outputs.persist()?;
    Ok(exported.remarks)
}
