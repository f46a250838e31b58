//! Correction whose costs the map of conditions shows.

/// Correction whose costs the map shows.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum MappedCost {
    /// The uncorrected physics representative.
    Before,
    /// Optimum of each condition.
    #[default]
    Own,
    /// The schedule, applied to the nominal model.
    Scheduled,
}

impl MappedCost {
    /// Every choice, in the order of the menu.
    pub const ALL: [Self; 3] = [Self::Before, Self::Own, Self::Scheduled];

    /// Returns the text of the menu entry.
    pub fn name(self) -> &'static str {
        match self {
            Self::Before => "before any correction",
            Self::Own => "each optimum",
            Self::Scheduled => "the schedule",
        }
    }
}
