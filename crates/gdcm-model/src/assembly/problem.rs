//! Missing and contradictory facts that keep files from forming a dataset.
//!
//! A *part* is a model found in a file, with its place in the dataset. A *measured model* consists
//! of one or more parts with the same name.

use std::fmt;

use super::file_scope::FileScope;
use crate::dataset::channel::ChannelSide;
use crate::dataset::dataset_draft::ResponseDraft;
use crate::names::RowRole;
use crate::names::response_name::ResponseNameError;
use crate::number_format::counted;
use crate::number_format::number;

/// A missing or contradictory fact about a model, a condition or the dataset.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum ProblemKind {
    #[error("no model is included; add files with models, or include a model that is left out")]
    NoModels,
    /// The dataset has no inputs, or no outputs.
    #[error("the dataset has no {0}; name them and their units (\"{0}\" in the rules)")]
    NoChannels(&'static str),
    /// Dataset channel without a unit.
    #[error("{0}: the unit of the dataset is missing; choose one (\"unit\" of {0} in the rules)")]
    NoUnit(String),
    /// Dataset channel whose unit in a file is given neither by the file nor by the rules.
    #[error("the file gives no unit for {0}; choose the unit of its values")]
    UnitOfFile(String),
    #[error(
        "{channel} has the unit \"{from}\" in the file and \"{to}\" in the dataset, which cannot \
        be converted; enter a factor"
    )]
    Conversion {
        channel: String,
        from: String,
        to: String,
    },
    /// Dataset channel that the model lacks.
    #[error(
        "the model has no {side} {channel}; its {side}s are {found}; choose one of them (\"{side}s\" under \"models\" in the rules), or leave the model out"
    )]
    NoChannel {
        side: ChannelSide,
        channel: String,
        /// File channels, separated by commas.
        found: String,
    },
    /// Channel whose name in the file does not determine its sign.
    #[error(
        "{channel} is called {found} in the file, which may be positive in the opposite \
        direction; enter its sign, 1 or -1 (\"signs\" in the rules)"
    )]
    Sign {
        channel: String,
        /// Channel name in the file.
        found: String,
    },
    /// Model that looks discrete-time but has no sample time.
    #[error(
        "all poles lie inside the unit circle and {near} of {poles} near 1, as in a discrete-time \
        model, but the model has no sample time; enter it in s, or 0 for a continuous-time model \
        (--sample-time)"
    )]
    NoSampleTime { near: usize, poles: usize },
    /// Part of the file name that looks like a trim offset but matches no pattern.
    #[error(
        "\"{0}\" in the name of the model looks like a trim offset but matches no pattern; enter the \
        trim offset (\"perturbation\" under \"models\" in the rules)"
    )]
    TrimPart(String),
    /// Several model channels match the same dataset channel.
    #[error(
        "several {side}s of the model match {channel}: {found}; choose one of them (\"{side}s\" under \"models\" in the rules)"
    )]
    AmbiguousChannel {
        side: ChannelSide,
        channel: String,
        /// The candidates, separated by commas.
        found: String,
    },
    /// Channels without names whose count differs from the dataset's.
    #[error(
        "the model has {} without names, but the dataset has {expected}; name those of the model \
        (\"{side}s\" under \"models\" in the rules)",
        counted(*found, &side.to_string())
    )]
    Unnamed {
        side: ChannelSide,
        expected: usize,
        found: usize,
    },
    /// Measured response with no dataset channel among its inputs, or among its outputs.
    #[error(
        "the measured response has no {side} of the dataset ({known}): {}. Name it in the \
        headings, \"mag Q/LON [dB]\" (--headings, or \"headings\" in the rules), or under \
        \"models\" in the rules: \"inputs\": [\"LON\"], \"outputs\": [\"Q\"]; or leave the \
        response out",
        if found.is_empty() { "neither the file nor its name names one".to_owned() } else { format!("it has {found}") }
    )]
    ResponseUnmatched {
        side: ChannelSide,
        /// Channels named by the file; empty where it names none.
        found: String,
        known: String,
    },
    /// Measured response whose channels appear only in an ambiguous file or variable name.
    #[error(
        "the name \"{name}\" does not identify one output and one input: {error}. Name them in \
        the headings, \"mag Q/LON [dB]\" (--headings, or \"headings\" in the rules), or under \
        \"models\" in the rules: \"inputs\": [\"LON\"], \"outputs\": [\"Q\"]"
    )]
    ResponseName {
        /// File or variable name.
        name: String,
        error: ResponseNameError,
    },
    /// Two files give the same measured response.
    #[error(
        "{input} → {output} of the measured model \"{name}\" is also in {first}; leave one of them out, or rename one to make it a separate \
         model"
    )]
    ResponseTwice {
        output: String,
        input: String,
        name: String,
        first: String,
    },
    /// Declared channel names whose count differs from the model's channel count.
    #[error(
        "{} given for {} of the model; give one name for each, in the file's order",
        counted(*given, "name"), counted(*found, &side.to_string())
    )]
    NameCount {
        side: ChannelSide,
        /// Number of names in the rules.
        given: usize,
        /// The model's channel count.
        found: usize,
    },
    #[error("the condition is not given; enter it (\"condition\" under \"models\" in the rules)")]
    NoCondition,
    #[error(
        "the role is not given; choose nominal, perturbed or identified (\"role\" under \"models\" in the rules)"
    )]
    NoRole,
    #[error(
        "no model of the condition gives its airspeed; enter it (\"airspeed_kt\" under \"models\" in the rules)"
    )]
    NoAirspeed,
    /// Models in a condition contradict one another.
    #[error("condition {condition}: {field} is both {first} and {second}; correct one")]
    Contradiction {
        condition: i64,
        field: &'static str,
        first: String,
        second: String,
    },
    /// The values in a file contradict its name or its folders' names.
    #[error(
        "{field} is {} in the file and {} in the names of the file and its folders: correct one, or enter the right value (\"{}\" \
         under \"models\" in the rules)", number(*of_file), number(*of_name), rules_key(field)
    )]
    NameContradiction {
        /// Quantity, by its key in the rules; a trim offset as "perturbation, roll_deg".
        field: String,
        of_file: f64,
        of_name: f64,
    },
    /// Condition without a nominal model, or with several.
    #[error(
        "condition {condition}: expected exactly one nominal model, found {found}; change the roles"
    )]
    Nominal { condition: i64, found: usize },
    #[error(
        "duplicate name \"{name}\" among the {bundle} models of condition {condition}; rename one"
    )]
    DuplicateName {
        condition: i64,
        /// "physics" or "identified".
        bundle: &'static str,
        name: String,
    },
    /// Measured data with the role of a physics model, which needs matrices.
    #[error("a {} model needs matrices, but this is a measured response; choose the role identified", .0.word())]
    MeasuredPhysics(RowRole),
    /// One model's measured parts have different frequency grids.
    #[error(
        "measured responses of one model must be at the same frequencies; {first} has {first_grid} and {second} has {second_grid}. Estimate \
         them at the same frequencies, or rename one to make it a separate model"
    )]
    Grids {
        first: String,
        first_grid: GridSpan,
        second: String,
        second_grid: GridSpan,
    },
    /// Fault found in the final dataset check.
    #[error("{0}")]
    Dataset(String),
}

/// Frequency grid size and range.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct GridSpan {
    pub count: usize,
    /// NaN for an empty grid.
    pub lowest_rad_s: f64,
    /// NaN for an empty grid.
    pub highest_rad_s: f64,
}

impl GridSpan {
    pub(super) fn new(response: &ResponseDraft) -> Self {
        let omega = &response.omega;
        Self {
            count: omega.len(),
            lowest_rad_s: omega.first().copied().unwrap_or(f64::NAN),
            highest_rad_s: omega.last().copied().unwrap_or(f64::NAN),
        }
    }
}

impl fmt::Display for GridSpan {
    /// Formats the count and the range: "40 frequencies from 0.3 to 12.3 rad/s".
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self {
            count,
            lowest_rad_s,
            highest_rad_s,
        } = self;
        write!(
            formatter,
            "{count} frequencies from {lowest_rad_s:.1} to {highest_rad_s:.1} rad/s"
        )
    }
}

/// Returns the key in the rules for a quantity of [`ProblemKind::NameContradiction`]: for a trim
/// offset, "perturbation, roll_deg", the member without the coordinate.
fn rules_key(field: &str) -> &str {
    field.split(',').next().unwrap_or(field)
}

impl ProblemKind {
    /// Returns a stable code for scripts and tests.
    pub fn code(&self) -> &'static str {
        match self {
            Self::NoModels => "no-models",
            Self::NoChannels(_) => "no-channels",
            Self::NoUnit(_) => "no-unit",
            Self::UnitOfFile(_) => "unit-of-file",
            Self::Conversion { .. } => "conversion",
            Self::NoChannel { .. } => "no-channel",
            Self::Sign { .. } => "sign",
            Self::NoSampleTime { .. } => "no-sample-time",
            Self::TrimPart(_) => "trim-part",
            Self::AmbiguousChannel { .. } => "ambiguous-channel",
            Self::Unnamed { .. } => "unnamed-channels",
            Self::ResponseUnmatched { .. } => "response-unmatched",
            Self::ResponseName { .. } => "response-name",
            Self::ResponseTwice { .. } => "response-twice",
            Self::NameCount { .. } => "names",
            Self::NoCondition => "no-condition",
            Self::NoRole => "no-role",
            Self::NoAirspeed => "no-airspeed",
            Self::Contradiction { .. } => "contradiction",
            Self::NameContradiction { .. } => "name-contradiction",
            Self::Nominal { .. } => "nominal",
            Self::DuplicateName { .. } => "duplicate-name",
            Self::MeasuredPhysics(_) => "measured-physics",
            Self::Grids { .. } => "grids",
            Self::Dataset(_) => "dataset",
        }
    }

    /// Returns the question to the engineer, if a command-line option can settle the problem for a
    /// channel; otherwise `None`.
    pub(super) fn question(&self) -> Option<Question> {
        let (channel, option, value) = match self {
            Self::Sign { channel, .. } => (channel, "--sign", "-1"),
            Self::UnitOfFile(channel) => (channel, "--unit", "UNIT"),
            Self::Conversion { channel, .. } => (channel, "--factor", "X"),
            _ => return None,
        };
        Some(Question {
            channel: channel.clone(),
            option,
            value,
        })
    }
}

/// A missing fact about a channel, and the option of `gdcm assemble` that supplies it.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) struct Question {
    pub channel: String,
    /// Option name: "--sign".
    option: &'static str,
    /// Example or placeholder for the option's value: "-1", "UNIT".
    value: &'static str,
}

/// A missing or contradictory fact, and the model to which it belongs.
#[derive(Clone, Debug, PartialEq)]
pub struct Problem {
    /// Model index; for a problem with a condition, its first model; `None` for a problem with the
    /// whole dataset.
    pub part: Option<usize>,
    pub kind: ProblemKind,
    /// Models to which the option's value applies; `None` if no command-line option settles the
    /// problem.
    pub scope: Option<FileScope>,
}

impl Problem {
    /// Creates a problem with the whole dataset.
    pub fn in_dataset(kind: ProblemKind) -> Self {
        Self {
            part: None,
            kind,
            scope: None,
        }
    }

    /// Creates a problem with the model at index `part`.
    pub fn in_part(part: usize, kind: ProblemKind) -> Self {
        Self {
            part: Some(part),
            kind,
            scope: None,
        }
    }

    /// Returns the option of `gdcm assemble` that settles the problem in all models within its
    /// scope: "--sign NZ=-1:identified". The value is quoted if a shell requires it; `None` if no
    /// option applies.
    pub fn option(&self) -> Option<String> {
        let question = self.kind.question()?;
        let scope = self.scope.as_ref()?;
        let answer = format!("{}={}:{scope}", question.channel, question.value);
        let is_plain = answer
            .chars()
            .all(|letter| letter.is_ascii_alphanumeric() || "=-+_./:#,%".contains(letter));
        if is_plain {
            Some(format!("{} {answer}", question.option))
        } else {
            Some(format!("{} '{answer}'", question.option))
        }
    }
}
