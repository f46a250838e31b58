//! A study's corrections for other tools: programs and tables that compute them outside of this one, corrected models, and all
//! results as variables of MATLAB. Each is an [`ExportFormat`]; the command line, the window and the documentation go by [`EXPORTERS`].

mod all_results;
mod corrected_models;
mod lookup_table;
mod matlab_struct;
mod programs;
mod scheduled;

use std::io::{self, Write};
use std::path::Path;

use gdcm_method::correction::Pade;
use gdcm_method::schedule::ScheduleError;
use gdcm_model::dataset::ConditionId;
use gdcm_model::message_text::quoted;
use gdcm_study::study::{Analysis, AssessedCorrection};

use crate::export_contents::ExportContents;
use crate::file_error::FileError;
use crate::output_set::OutputSet;
use crate::variables::VariableFault;
use scheduled::Scheduled;

/// Something that a study's corrections can be exported as.
#[derive(Clone, Copy, Debug)]
pub struct ExportFormat {
    /// Its name on the command line.
    pub name: &'static str,
    /// The end of a file's name.
    pub extension: &'static str,
    /// What it is, for people.
    pub words: &'static str,
    /// The options of the command line that it takes.
    pub options: &'static [&'static str],
    /// Refuses a name of a file that does not fit: a question for before the work.
    check_path: fn(&Path) -> Result<(), ExportFault>,
    /// What the file contains of the correction.
    contents: fn(&Analysis, &ExportRequest) -> ExportContents,
    /// The contents of the file.
    export: for<'e> fn(&Export<'e>) -> Result<Exported<'e>, ExportFault>,
}

/// Every export, in the order of their list; the first of them before any choice.
pub static EXPORTERS: [ExportFormat; 9] = [
    all_results::MAT,
    programs::MATLAB,
    programs::PYTHON,
    programs::C,
    lookup_table::CSV,
    lookup_table::MAT,
    corrected_models::STATE_SPACE,
    all_results::CSV,
    all_results::JSON,
];

impl ExportFormat {
    /// The format of this name.
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

/// Which physics model of a condition is exported.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub enum ExportedRole {
    /// The one at the condition's own trim.
    #[default]
    Nominal,
    /// The one that represents its bundle.
    Representative,
    /// The one of this name.
    Named(String),
}

/// What is to be exported, and how; without any choice, nominal models under the schedule, delays in second order.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ExportRequest {
    /// As what.
    pub format: ExportFormat,
    /// Airspeeds of a lookup table \[kt\]; none for the distinct airspeeds of the scheduled conditions.
    pub breakpoints_kt: Option<Vec<f64>>,
    /// The condition whose corrected model is exported; none for every one.
    pub condition: Option<ConditionId>,
    /// Which of its models.
    pub role: ExportedRole,
    /// Under which correction.
    pub correction: AssessedCorrection,
    /// What its delays are approximated by.
    pub pade: Pade,
}

/// Where a correction comes from.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ExportSource {
    /// What it is called: the name of the study.
    pub name: String,
    /// SHA-256 of the dataset's file, in hexadecimal.
    pub sha256: String,
}

/// What an export is made of.
#[derive(Clone, Copy)]
pub struct Export<'e> {
    /// What was found.
    pub analysis: &'e Analysis,
    /// Where it comes from.
    pub source: &'e ExportSource,
    /// What is asked for.
    pub request: &'e ExportRequest,
    /// The file that it goes to.
    pub path: &'e Path,
}

impl<'e> Export<'e> {
    /// What the leads of the schedule cost, in words, for a file that holds them as numbers.
    fn price(&self) -> Vec<String> {
        let (inputs, outputs) = self.analysis.study.dataset.names_of_channels();
        let price = self
            .analysis
            .schedule
            .as_ref()
            .ok()
            .and_then(|schedule| schedule.lead_price());
        price
            .into_iter()
            .map(|price| price.words(&inputs, &outputs))
            .collect()
    }

    /// The schedule of the study.
    fn scheduled(&self) -> Result<Scheduled<'e>, ExportFault> {
        let schedule = self
            .analysis
            .schedule
            .as_ref()
            .map_err(|error| ExportFault::Schedule(*error))?;
        let couplings = self
            .analysis
            .asked_couplings()
            .map_err(|why| ExportFault::NoCouplings { why })?;
        let couplings = couplings.map(|fitted| fitted.matrices());
        let contents = ExportContents::of_scheduled(self.analysis);
        Ok(Scheduled {
            schedule,
            dataset: &self.analysis.study.dataset,
            source: self.source,
            couplings,
            contents,
        })
    }
}

/// What writes the contents of a file.
type Writing<'e> = Box<dyn FnOnce(&mut dyn Write) -> io::Result<()> + 'e>;

/// The contents of a file, with what is to be known of it, line by line.
pub struct Exported<'e> {
    write: Writing<'e>,
    remarks: Vec<String>,
}

impl<'e> Exported<'e> {
    fn new(write: impl FnOnce(&mut dyn Write) -> io::Result<()> + 'e) -> Self {
        Self {
            write: Box::new(write),
            remarks: Vec::new(),
        }
    }

    fn bytes(bytes: impl Into<Vec<u8>>) -> Self {
        let bytes = bytes.into();
        Self::new(move |file| file.write_all(&bytes))
    }

    fn with(self, remarks: Vec<String>) -> Self {
        Self { remarks, ..self }
    }
}

/// Refuses a name that does not fit what is to be exported: a question for before the work.
///
/// # Errors
/// [`FileError::Export`] with what is wrong with it.
pub fn check_export(format: ExportFormat, path: &Path) -> Result<(), FileError> {
    (format.check_path)(path).map_err(|fault| FileError::export(path, fault))
}

/// What the file of a request contains of the correction.
pub fn export_contents(analysis: &Analysis, request: &ExportRequest) -> ExportContents {
    (request.format.contents)(analysis, request)
}

/// Writes what a request asks for, and gives what is to be known of it, line by line; what it contains is told by
/// [`export_contents`].
pub fn write_export(
    analysis: &Analysis,
    source: &ExportSource,
    request: &ExportRequest,
    path: &Path,
    mut outputs: OutputSet,
) -> Result<Vec<String>, FileError> {
    check_export(request.format, path)?;
    let exported = (request.format.export)(&Export {
        analysis,
        source,
        request,
        path,
    });
    let Exported { write, remarks } = exported.map_err(|fault| FileError::export(path, fault))?;
    outputs.add(path, write)?;
    outputs.persist()?;
    Ok(remarks)
}

// Why something cannot be exported.

/// Why something cannot be exported.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum ExportFault {
    /// A curve cannot be computed.
    #[error(
        "the {curve} of {channel} has a number that is not finite; correct it before it is exported"
    )]
    Curve {
        /// The channel.
        channel: String,
        /// "gain" or "delay".
        curve: &'static str,
    },
    /// The airspeeds asked for make no table.
    #[error("the airspeeds of the table must be finite, increase, and be at least one")]
    Breakpoints,
    /// A file of MATLAB has a name that no function can have.
    #[error(
        "MATLAB calls a function by the name of its file: a letter, then letters, digits and _, 63 at most, and neither a \
         keyword nor a name that the file uses itself; found {}",
        quoted(found)
    )]
    FunctionName {
        /// The name of the file without its ending.
        found: String,
    },
    /// The name of the file says none of the formats that models are written in.
    #[error("models are written to a name that ends in .mat, .json or .npz")]
    ModelsFormat,
    /// The values cannot be written.
    #[error(transparent)]
    Variables(#[from] VariableFault),
    /// There is no schedule to be exported.
    #[error(transparent)]
    Schedule(#[from] ScheduleError),
    /// The study asks for couplings and has none: what would be exported is not what was asked for.
    #[error(
        "the study asks for couplings, and there are none: {why}; mend that, or set couplings to none"
    )]
    NoCouplings {
        /// Why there are none.
        why: String,
    },
    /// A condition has no result of its own.
    #[error("condition {condition}: {why}")]
    NoResult {
        /// The condition.
        condition: ConditionId,
        /// Why not.
        why: String,
    },
    /// The dataset has no such condition.
    #[error("the dataset has no condition {condition}")]
    NoCondition {
        /// The id asked for.
        condition: ConditionId,
    },
    /// A condition has no physics model of this name.
    #[error(
        "condition {condition} has no physics model \"{model}\"; name the condition that has it"
    )]
    NoModel {
        /// The condition.
        condition: ConditionId,
        /// The name asked for.
        model: String,
    },
    /// A model is known by its response only.
    #[error(
        "condition {condition}, model \"{model}\": it is a measured response and has no matrices to be exported"
    )]
    NoMatrices {
        /// The condition.
        condition: ConditionId,
        /// The model.
        model: String,
    },
    /// A corrected model cannot be written as matrices.
    #[error("condition {condition}, model \"{model}\": {words}")]
    Model {
        /// The condition.
        condition: ConditionId,
        /// The model.
        model: String,
        /// Why not; see [`CorrectedModelError`](gdcm_method::correction::corrected_model::CorrectedModelError).
        words: String,
    },
}

impl ExportFault {
    /// Whether it is the analysis that has not what is asked for; otherwise something else would have to be asked.
    pub fn is_of_analysis(&self) -> bool {
        matches!(
            self,
            Self::Schedule(_) | Self::NoResult { .. } | Self::Curve { .. }
        )
    }
}
