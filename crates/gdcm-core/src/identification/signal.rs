//! What a column of a flight record is.

use std::fmt;

/// Whether a signal drives the aircraft or answers.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Role {
    /// A measured input.
    Input,
    /// A measured output.
    Output,
}

impl fmt::Display for Role {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(if *self == Self::Input { "input" } else { "output" })
    }
}

/// A channel of the flight records, by place and by name.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct Signal {
    /// Input or output.
    pub role: Role,
    /// Which of them, counted from 0.
    pub index: usize,
    /// Its name, for people.
    pub name: String,
}

impl fmt::Display for Signal {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.name)
    }
}

/// The names of `signals` in a row: `P, Q and R`.
pub(super) fn names(signals: &[Signal]) -> String {
    match signals {
        [] => String::new(),
        [one] => one.name.clone(),
        [most @ .., last] => {
            let most: Vec<_> = most.iter().map(|signal| signal.name.as_str()).collect();
            format!("{} and {last}", most.join(", "))
        }
    }
}
