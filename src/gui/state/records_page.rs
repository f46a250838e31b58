//! Pages in the Records view, and the roles that curves over time have.
//!
//! The recommended model of an identification is the refined one, "CT-PBSID, refined" (M14:
//! docs/identification.md).

use egui::Color32;

use gdcm_plot::figure::Role;
use gdcm_plot::figure::drawing::Dash;

use crate::gui::plot::curve_style::CurveStyle;
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
    /// The physics representative, corrected by the schedule.
    Scheduled,
    /// The samples of the record.
    Measured,
}

impl TimeRole {
    /// All roles, in display order.
    pub const ALL: [Self; 5] = [
        Self::Physics,
        Self::Identified,
        Self::Corrected,
        Self::Scheduled,
        Self::Measured,
    ];

    /// Roles of the models, whose responses to the recorded inputs are simulated.
    pub const MODELS: [Self; 4] = [
        Self::Physics,
        Self::Identified,
        Self::Corrected,
        Self::Scheduled,
    ];

    pub fn name(self) -> &'static str {
        match self {
            Self::Physics => "physics",
            Self::Identified => "identified",
            Self::Corrected => "corrected",
            Self::Scheduled => "scheduled",
            Self::Measured => "measured",
        }
    }

    /// Returns the role of the same model in the Bode view; `None` for the samples.
    pub fn bode_role(self) -> Option<Role> {
        match self {
            Self::Physics => Some(Role::Representative),
            Self::Identified => Some(Role::IdentifiedRepresentative),
            Self::Corrected => Some(Role::Corrected),
            Self::Scheduled => Some(Role::Scheduled),
            Self::Measured => None,
        }
    }

    /// Returns the style of the role, with a line width for plots over time: colour and dashes as
    /// in the Bode view; for the samples, which have no role there, solid in the text colour.
    pub fn style(self, palette: &Palette) -> CurveStyle {
        let width = match self {
            Self::Identified => 2.0,
            Self::Physics | Self::Corrected | Self::Scheduled | Self::Measured => 1.3,
        };
        match self.bode_role() {
            Some(role) => CurveStyle {
                width,
                ..palette.role_style(role, false)
            },
            None => CurveStyle {
                color: palette.text,
                width,
                dash: Dash::Solid,
                length: 0.0,
            },
        }
    }

    /// Returns the colour of the role: as in the Bode view; for the samples, the text colour.
    pub fn color(self, palette: &Palette) -> Color32 {
        self.style(palette).color
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
                    palette.corrected,
                    palette.text
                ]
            );
        }
    }

    #[test]
    fn the_scheduled_model_is_drawn_and_named_as_in_the_bode_view() {
        let palette = Palette::dark();
        let style = TimeRole::Scheduled.style(&palette);
        let bode = palette.role_style(Role::Scheduled, false);
        assert_eq!((style.dash, style.length), (bode.dash, bode.length));
        assert!(style.is_broken());
        assert_eq!(TimeRole::Scheduled.name(), Role::Scheduled.name());
    }
}
