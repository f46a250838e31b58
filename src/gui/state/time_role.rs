//! Roles of the curves over time in the Records view.
//!
//! A role says which model a curve shows, or that it shows the samples of the record.

use egui::Color32;

use gdcm_plot::figure::Role;
use gdcm_plot::figure::drawing::Dash;

use crate::gui::plot::curve_style::CurveStyle;
use crate::gui::widgets::palette::Palette;

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
