//! The flight records of a condition, and where they come from.

/// The manoeuvre that a record is of.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum RecordKind {
    /// A frequency sweep.
    Sweep,
    /// Several sines at once.
    Multisine,
    /// Steps of three, two, one and one units of time, or doublets.
    ThreeTwoOneOne,
    /// Anything else.
    #[default]
    Other,
}

impl RecordKind {
    /// Every kind.
    pub const ALL: [Self; 4] = [Self::Sweep, Self::Multisine, Self::ThreeTwoOneOne, Self::Other];

    /// Its word in files and tables.
    pub fn word(self) -> &'static str {
        match self {
            Self::Sweep => "sweep",
            Self::Multisine => "multisine",
            Self::ThreeTwoOneOne => "3-2-1-1",
            Self::Other => "other",
        }
    }

    /// The kind of a word.
    pub fn of(word: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|kind| kind.word() == word)
    }
}

/// A flight record of a condition: not its samples, but which file holds them and what is done with them.
#[derive(Clone, Debug, PartialEq)]
pub struct ConditionRecord {
    /// Name, unique in the condition.
    pub name: String,
    /// The file, relative to the dataset's.
    pub file: String,
    /// Which record of the file, or which variable; none where the file holds one.
    pub variable: Option<String>,
    /// SHA-256 of the file, in hexadecimal.
    pub sha256: Option<String>,
    /// The manoeuvre.
    pub kind: RecordKind,
    /// Whether it is kept from identification, to validate what comes of it.
    pub held_out: bool,
    /// Whether anything is done with it at all.
    pub used: bool,
    /// Sample time \[s\], once it is known.
    pub sample_time_s: Option<f64>,
    /// First and last time \[s\] of each piece that is used, on the record's clock; none for all of it.
    pub used_s: Vec<[f64; 2]>,
}

impl ConditionRecord {
    /// A record that is used, of an unknown manoeuvre.
    pub fn new(name: impl Into<String>, file: impl Into<String>) -> Self {
        Self {
            name: name.into(),
            file: file.into(),
            variable: None,
            sha256: None,
            kind: RecordKind::Other,
            held_out: false,
            used: true,
            sample_time_s: None,
            used_s: Vec::new(),
        }
    }
}
