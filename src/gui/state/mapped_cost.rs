//! Correction whose costs are shown in the condition map.

#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum MappedCost {
    /// The uncorrected physics representative.
    Before,
    /// Each condition's optimum.
    #[default]
    Own,
    /// The schedule, applied to the nominal model.
    Scheduled,
}

impl MappedCost {
    /// Every choice, in menu order.
    pub const ALL: [Self; 3] = [Self::Before, Self::Own, Self::Scheduled];

    /// Returns the menu text.
    pub fn name(self) -> &'static str {
        match self {
            Self::Before => "the uncorrected model",
            Self::Own => "each condition's optimum",
            Self::Scheduled => "the schedule",
        }
    }
}
