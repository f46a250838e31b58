//! Pages in the Records view, and the roles that curves over time have.

use egui::Color32;

use gdcm_plot::figure::Role;

use crate::gui::widgets::choices::PageWords;
use crate::gui::widgets::palette::Palette;

/// A page in the Records view.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum RecordsPage {
    /// The displayed record over time, and the response in focus with its models.
    #[default]
    Fit,
    /// Excitation of the inputs, and the highest frequency that it reaches.
    Inputs,
    /// Models at all orders: fit, stabilisation diagram and poles; what further sweeps would bring.
    Order,
    /// Columns assigned to channels.
    Columns,
}

impl RecordsPage {
    /// All pages, in display order.
    pub const ALL: [Self; 4] = [Self::Fit, Self::Inputs, Self::Order, Self::Columns];

    /// Returns the texts on the page's tab.
    pub fn words(self) -> PageWords {
        match self {
            Self::Fit => PageWords {
                name: "Fit",
                short_name: "Fit",
                purpose: "The selected record over time with the models' responses; the measured \
                response, and the identified model with its confidence band",
            },
            Self::Inputs => PageWords {
                name: "Inputs",
                short_name: "Inputs",
                purpose: "Spectrum of each input in each record: which inputs are excited, and up to which \
                frequency",
            },
            Self::Order => PageWords {
                name: "Order",
                short_name: "Order",
                purpose: "Fit and poles over the model order, poles of the recommended model, and the \
                intervals that further sweeps would bring",
            },
            Self::Columns => PageWords {
                name: "Columns",
                short_name: "Columns",
                purpose: "Assignment of the record's columns to time and channels",
            },
        }
    }
}

/// Role that a curve over time has, ordered as the chips.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum TimeRole {
    /// The physics representative.
    Physics,
    /// The recommended identified model.
    Identified,
    /// The corrected physics representative.
    Corrected,
    /// The recorded samples.
    Measured,
}

impl TimeRole {
    /// All roles, in display order.
    pub const ALL: [Self; 4] = [
        Self::Physics,
        Self::Identified,
        Self::Corrected,
        Self::Measured,
    ];

    /// Models' roles; their responses to the recorded inputs are simulated.
    pub const MODELS: [Self; 3] = [Self::Physics, Self::Identified, Self::Corrected];

    pub fn name(self) -> &'static str {
        match self {
            Self::Physics => "physics",
            Self::Identified => "identified",
            Self::Corrected => "corrected",
            Self::Measured => "measured",
        }
    }

    /// Returns the role's colour, which is the same as in the Bode view.
    pub fn color(self, palette: &Palette) -> Color32 {
        let role = match self {
            Self::Physics => Role::Representative,
            Self::Identified => Role::IdentifiedRepresentative,
            Self::Corrected => Role::Corrected,
            Self::Measured => return palette.text,
        };
        palette.role_style(role, false).color
    }

    /// Returns the line width over time \[pt\].
    pub fn width(self) -> f32 {
        match self {
            Self::Identified => 2.0,
            Self::Physics | Self::Corrected | Self::Measured => 1.3,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn roles_over_time_have_the_colours_of_the_bode_view() {
        for palette in [Palette::dark(), Palette::light()] {
            let colors = TimeRole::ALL.map(|role| role.color(&palette));
            assert_eq!(
                colors,
                [
                    palette.perturbed,
                    palette.identified,
                    palette.corrected,
                    palette.text
                ]
            );
        }
    }
}
