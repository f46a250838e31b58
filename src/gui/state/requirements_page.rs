//! Page of the requirements.

/// Page of requirements.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum RequirementsPage {
    /// Bandwidth and phase delay of every response, condition and model.
    #[default]
    Bandwidth,
    /// Responses of the displayed condition's models over time.
    Histories,
    /// Modes of the displayed condition.
    Modes,
    /// Corrected model of every condition compared with the identified model; mean J and shares of
    /// the band of every condition and model.
    Summary,
}
