//! What a study's corrections can be exported as.

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
