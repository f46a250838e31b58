//! Sheets that cover part of the views.

use crate::gui::widgets::controls::QUESTION;

/// Content shown by a sheet.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Sheet {
    /// Reasons for the result.
    Reasons,
    /// Physics models, beside the narrow form of the left panel.
    Models,
    /// Identified models, beside the narrow form of the left panel.
    Identified,
    /// Derivation of a value.
    Derivation,
}

impl Sheet {
    /// Returns the heading, which is also the accessible name.
    pub fn title(self) -> &'static str {
        match self {
            Self::Reasons => "Reasons for the result",
            Self::Models => "Physics models",
            Self::Identified => "Identified models",
            Self::Derivation => QUESTION,
        }
    }

    /// Returns whether the sheet is on the right side, and its width \[pt\].
    pub fn place(self) -> (bool, f32) {
        match self {
            Self::Reasons => (true, 380.0),
            Self::Derivation => (true, 440.0),
            Self::Models | Self::Identified => (false, 272.0),
        }
    }
}
