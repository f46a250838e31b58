//! Page in the requirements view.

/// Page in the requirements view.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum RequirementsPage {
    /// Bandwidth and phase delay of every response, condition and model.
    #[default]
    Bandwidth,
    /// Responses of the models over time, in the displayed condition.
    Histories,
    /// Modes in the displayed condition.
    Modes,
    /// Corrected models compared with the identified models: mean J, and shares of the band, for
    /// every condition and model.
    Summary,
}
