//! Sheets: the reasons are below the verdict, the others cover part of the views.

use crate::gui::plot::derivation_menu::QUESTION;

/// Content shown by a sheet.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Sheet {
    /// Reasons for the result, below the verdict.
    Reasons,
    /// Physics models, beside the left panel in its narrow form.
    Models,
    /// Identified models, beside the left panel in its narrow form.
    Identified,
    /// The displayed condition's flight records, beside the left panel in its narrow form.
    Records,
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
            Self::Records => "Records",
            Self::Derivation => QUESTION,
        }
    }

    /// Returns whether the sheet is at the right, beside the values that it explains; otherwise it
    /// covers the left side of the views.
    pub fn is_on_right(self) -> bool {
        match self {
            Self::Reasons | Self::Derivation => true,
            Self::Models | Self::Identified | Self::Records => false,
        }
    }

    /// Returns the width \[pt\].
    pub fn width(self) -> f32 {
        match self {
            Self::Reasons => 380.0,
            Self::Derivation => 440.0,
            Self::Models | Self::Identified | Self::Records => 272.0,
        }
    }
}
