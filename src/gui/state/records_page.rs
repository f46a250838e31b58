//! Pages of the Records view, and the models compared there.

use egui::Color32;

use crate::gui::widgets::choices::PageWords;
use crate::gui::widgets::palette::Palette;

/// A page of the Records view.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum RecordsPage {
    /// Every channel of the selected record over time.
    #[default]
    Histories,
    /// Excitation of the inputs, and its highest frequency.
    Inputs,
    /// Measured frequency response, compared with the models.
    Response,
    /// Poles over the model order.
    Stabilisation,
    /// Poles of the recommended model with standard deviations.
    Poles,
    /// Quality of fit of each record and output.
    Fit,
    /// Columns assigned to channels.
    Columns,
}

impl RecordsPage {
    /// All pages, in display order.
    pub const ALL: [Self; 7] = [
        Self::Histories,
        Self::Inputs,
        Self::Response,
        Self::Stabilisation,
        Self::Poles,
        Self::Fit,
        Self::Columns,
    ];

    /// Returns the texts of the page's tab.
    pub fn words(self) -> PageWords {
        match self {
            Self::Histories => PageWords {
                name: "Time",
                short_name: "Time",
                purpose: "Every channel of the selected record over time; bridged gaps and cut parts are \
                marked",
            },
            Self::Inputs => PageWords {
                name: "Inputs",
                short_name: "Inputs",
                purpose: "Spectrum of each input in each record: which inputs are excited, and up to which \
                frequency",
            },
            Self::Response => PageWords {
                name: "Response",
                short_name: "Response",
                purpose: "Measured response with error bars, and the models with their confidence bands",
            },
            Self::Stabilisation => PageWords {
                name: "Stabilisation",
                short_name: "Orders",
                purpose: "Poles over the model order: poles of the aircraft remain as the order increases",
            },
            Self::Poles => PageWords {
                name: "Identified poles",
                short_name: "Poles",
                purpose: "Poles of the recommended model with their standard deviations; grey: not \
                determined by the records",
            },
            Self::Fit => PageWords {
                name: "Fit",
                short_name: "Fit",
                purpose: "Fit of the model to each record and output, in the frequency and time domains",
            },
            Self::Columns => PageWords {
                name: "Columns",
                short_name: "Columns",
                purpose: "Assignment of the record's columns to time and channels",
            },
        }
    }
}

/// A model that can be compared with a record in the time domain.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum TimeModel {
    /// The recommended identified model.
    Identified,
    /// The physics representative.
    Physics,
    /// The corrected physics representative.
    Corrected,
}

impl TimeModel {
    /// All models, in display order.
    pub const ALL: [Self; 3] = [Self::Identified, Self::Physics, Self::Corrected];

    pub fn name(self) -> &'static str {
        match self {
            Self::Identified => "identified",
            Self::Physics => "physics",
            Self::Corrected => "corrected",
        }
    }

    pub fn color(self, palette: &Palette) -> Color32 {
        match self {
            Self::Identified => palette.accent,
            Self::Physics => palette.nominal,
            Self::Corrected => palette.corrected,
        }
    }
}
