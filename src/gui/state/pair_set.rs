//! Responses shown in the net-gain plots.

use serde::{Deserialize, Serialize};

#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub enum PairSet {
    /// Responses constrained now or at any time since the dataset was opened: releasing a response
    /// keeps its plot.
    #[default]
    Held,
    Focused,
    OnAxis,
    All,
    /// Responses added one by one with the + button beside the list.
    Picked,
}

impl PairSet {
    /// Every set, in list order.
    pub const ALL: [Self; 5] = [
        Self::Held,
        Self::Focused,
        Self::OnAxis,
        Self::All,
        Self::Picked,
    ];

    pub fn name(self) -> &'static str {
        match self {
            Self::Held => "held",
            Self::Focused => "in focus",
            Self::OnAxis => "on-axis",
            Self::All => "all",
            Self::Picked => "picked",
        }
    }

    /// Describes the set in a sentence.
    pub fn purpose(self) -> &'static str {
        match self {
            Self::Held => "Responses that are held, or were held since the dataset was opened",
            Self::Focused => "Response selected in the matrix",
            Self::OnAxis => "The on-axis responses of the dataset",
            Self::All => "Every response of the dataset",
            Self::Picked => "Responses picked with the button beside this list",
        }
    }
}
