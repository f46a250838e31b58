//! What is to be exported.

use crate::correction::Pade;
use crate::dataset::ConditionId;

use super::AssessedCorrection;

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

/// What is to be exported, and how.
#[derive(Clone, Debug, PartialEq)]
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

impl ExportRequest {
    /// A format, with what is usual of everything else: nominal models under the schedule, delays in second order.
    pub fn new(format: ExportFormat) -> Self {
        Self {
            format,
            breakpoints_kt: None,
            condition: None,
            role: ExportedRole::Nominal,
            correction: AssessedCorrection::Scheduled,
            pade: Pade::default(),
        }
    }
}

/// What a study's corrections are exported as, for other tools.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum ExportFormat {
    /// Everything that was found, as one struct of MATLAB.
    #[default]
    Mat,
    /// The scheduled correction as a function of MATLAB.
    Matlab,
    /// The scheduled correction as a module of Python.
    Python,
    /// The scheduled correction as a header of C.
    C,
    /// The scheduled correction as a lookup table, in text.
    TableCsv,
    /// The scheduled correction as a lookup table, for MATLAB.
    TableMat,
    /// The corrected models as matrices.
    StateSpace,
    /// Gains and delays of each condition, as `corrections.csv`.
    Csv,
    /// Everything that was found, as `corrections.json`.
    Json,
}

impl ExportFormat {
    /// Every format, in the order of their list.
    pub const ALL: [Self; 9] = [
        Self::Mat,
        Self::Matlab,
        Self::Python,
        Self::C,
        Self::TableCsv,
        Self::TableMat,
        Self::StateSpace,
        Self::Csv,
        Self::Json,
    ];

    /// Its name on the command line.
    pub fn name(self) -> &'static str {
        match self {
            Self::Mat => "mat",
            Self::Matlab => "m",
            Self::Python => "py",
            Self::C => "h",
            Self::TableCsv => "table-csv",
            Self::TableMat => "table-mat",
            Self::StateSpace => "state-space",
            Self::Csv => "csv",
            Self::Json => "json",
        }
    }

    /// What it is, for people.
    pub fn words(self) -> &'static str {
        match self {
            Self::Mat => "MATLAB data: all corrections as one struct",
            Self::Matlab => "MATLAB function of airspeed",
            Self::Python => "Python module, a function of airspeed",
            Self::C => "C header, a function of airspeed",
            Self::TableCsv => "Lookup table over airspeed, CSV",
            Self::TableMat => "Lookup table over airspeed, MATLAB data",
            Self::StateSpace => "Corrected models as state-space",
            Self::Csv => "corrections.csv alone",
            Self::Json => "corrections.json alone",
        }
    }

    /// The end of a file's name; corrected models may be .json and .npz too, and their file says by its name which.
    pub fn extension(self) -> &'static str {
        match self {
            Self::Mat | Self::TableMat | Self::StateSpace => "mat",
            Self::Matlab => "m",
            Self::Python => "py",
            Self::C => "h",
            Self::TableCsv | Self::Csv => "csv",
            Self::Json => "json",
        }
    }
}
