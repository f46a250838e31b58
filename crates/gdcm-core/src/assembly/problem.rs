//! What is still to be said before the files are a dataset.

use super::RowRole;

/// What is missing or contradicts itself.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum ProblemKind {
    /// No model is taken.
    #[error("no model is included; add files that hold models")]
    NoModels,
    /// The dataset has no inputs, or no outputs.
    #[error("the dataset has no {0}; say which there are")]
    NoChannels(&'static str),
    /// A channel of the dataset has no unit.
    #[error("{0}: choose a unit")]
    NoUnit(String),
    /// Files that do not say the unit of a channel.
    #[error("{channel}: choose the unit that it has in files that do not say one")]
    UnitOfFile {
        /// The channel of the dataset.
        channel: String,
    },
    /// A unit that cannot be converted.
    #[error(
        "{channel} has the unit \"{from}\" in the file and \"{to}\" in the dataset: there is no factor from one to the other; enter one"
    )]
    Conversion {
        /// The channel of the dataset.
        channel: String,
        /// The file's unit.
        from: String,
        /// The dataset's unit.
        to: String,
    },
    /// A channel that the model does not have.
    #[error("the model has no {side} {channel}; it has {found}")]
    NoChannel {
        /// "input" or "output".
        side: &'static str,
        /// The channel of the dataset.
        channel: String,
        /// What the file has, in words.
        found: String,
    },
    /// A channel that the file calls by a name which leaves the sign open.
    #[error(
        "{channel} is called {found} in the file, which can be positive the other way: say its sign, 1 or -1 (\"signs\" in the rules, \
         --sign {channel}=-1:all)"
    )]
    Sign {
        /// The channel of the dataset.
        channel: String,
        /// Its name in the file.
        found: String,
    },
    /// A model that looks like one of discrete time, and has no sample time.
    #[error(
        "all its poles lie inside the unit circle and {near} of {poles} near 1, as those of a discrete-time model do, and it has no \
         sample time: enter it in s, or 0 of a continuous-time model (--sample-time)"
    )]
    NoSampleTime {
        /// Poles near 1.
        near: usize,
        /// All.
        poles: usize,
    },
    /// A part of the name that says how the trim differs and is not understood.
    #[error("\"{part}\" in its name is not understood: say how its trim differs")]
    TrimPart {
        /// The part.
        part: String,
    },
    /// Two channels of the model are called the same.
    #[error("two {side}s of the model can be {channel}: {found}; say which")]
    AmbiguousChannel {
        /// "input" or "output".
        side: &'static str,
        /// The channel of the dataset.
        channel: String,
        /// Their names.
        found: String,
    },
    /// Channels without names, and another number of them than the dataset has.
    #[error("the model has {found} {side}s without names, the dataset has {expected}; say their names")]
    Unnamed {
        /// "input" or "output".
        side: &'static str,
        /// How many the dataset has.
        expected: usize,
        /// How many the model has.
        found: usize,
    },
    /// More or fewer names are said of a model's channels than it has.
    #[error("{said} names are said for the {found} {side}s of the model; say one for each, in the file's order")]
    Names {
        /// "input" or "output".
        side: &'static str,
        /// How many names.
        said: usize,
        /// How many channels.
        found: usize,
    },
    /// The condition is not said.
    #[error("choose its condition")]
    NoCondition,
    /// The role is not said.
    #[error("choose its role: nominal, perturbed or identified")]
    NoRole,
    /// The airspeed is not said.
    #[error("enter the airspeed of its condition")]
    NoAirspeed,
    /// Rows of one condition contradict one another.
    #[error("condition {condition}: {field} is {first} and {second}; one condition has one")]
    Contradiction {
        /// The condition.
        condition: i64,
        /// What.
        field: &'static str,
        /// In one row.
        first: String,
        /// In another.
        second: String,
    },
    /// A condition without a nominal model, or with several.
    #[error("condition {condition} has {found} nominal models; it needs exactly one")]
    Nominal {
        /// The condition.
        condition: i64,
        /// How many it has.
        found: usize,
    },
    /// A condition without identified models.
    #[error("condition {condition} has no identified model")]
    NoIdentified {
        /// The condition.
        condition: i64,
    },
    /// Two models of a bundle have one name.
    #[error("the name \"{name}\" stands twice among the {bundle} models of condition {condition}")]
    Name {
        /// The condition.
        condition: i64,
        /// "physics" or "identified".
        bundle: &'static str,
        /// The name.
        name: String,
    },
    /// A physics model is measured data.
    #[error("a {} model needs matrices; this is measured data", .0.word())]
    MeasuredPhysics(RowRole),
    /// Measured parts of one model are on different frequencies.
    #[error(
        "measured responses of one model must be at the same frequencies; {first} has {} and {second} has {}. Estimate them at the same ones, \
         or give one of them another name: it is a model of its own then",
        grid_words(*first_grid), grid_words(*second_grid)
    )]
    Grids {
        /// One file.
        first: String,
        /// How many frequencies it has, the lowest and the highest \[rad/s\].
        first_grid: (usize, [f64; 2]),
        /// The other file.
        second: String,
        /// Its frequencies.
        second_grid: (usize, [f64; 2]),
    },
    /// What the dataset itself refuses.
    #[error("{0}")]
    Dataset(String),
}

/// "40 from 0.3 to 12.3 rad/s".
fn grid_words((count, [lowest, highest]): (usize, [f64; 2])) -> String {
    format!("{count} from {lowest:.1} to {highest:.1} rad/s")
}

/// A problem, and the model that has it.
#[derive(Clone, Debug, PartialEq)]
pub struct Problem {
    /// Index of the model; none of a problem of the whole.
    pub part: Option<usize>,
    /// What it is.
    pub kind: ProblemKind,
}

impl Problem {
    /// A problem of the whole.
    pub fn of_all(kind: ProblemKind) -> Self {
        Self { part: None, kind }
    }

    /// A problem of one model.
    pub fn of(part: usize, kind: ProblemKind) -> Self {
        Self { part: Some(part), kind }
    }
}
