//! One input or output of the helicopter.

/// An input (a control position) or an output (a measured motion), as the dataset names it.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Channel {
    /// Short name, unique among the inputs or among the outputs ("LON", "NY").
    pub name: String,
    /// Unit as the dataset writes it ("%", "deg/s").
    pub unit: String,
    /// What the channel is and which way is positive.
    pub description: String,
}

impl Channel {
    /// A channel with a name and a unit, and no description.
    pub fn new(name: impl Into<String>, unit: impl Into<String>) -> Self {
        Self { name: name.into(), unit: unit.into(), description: String::new() }
    }
}
