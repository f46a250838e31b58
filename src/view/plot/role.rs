//! What a curve stands for, and how it is therefore drawn: the same in every view.

use egui::{Color32, Pos2, Shape, Stroke};
use egui_plot::LineStyle;

use crate::view::palette::Palette;

/// What a curve stands for.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Role {
    /// The physics model at the trim itself.
    Nominal,
    /// A physics model at a perturbed trim.
    Perturbed,
    /// The physics model that represents its bundle.
    Representative,
    /// A model identified from flight.
    Identified,
    /// The identified model that represents its bundle.
    IdentifiedRepresentative,
    /// The representative physics model with the condition's own correction.
    Corrected,
    /// The physics model with the correction of the schedule.
    Scheduled,
    /// A model left out, whatever it was.
    Rejected,
}

/// Colour, width and line style of a curve.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LineLook {
    /// Colour of the line.
    pub color: Color32,
    /// Width of the line \[pt\].
    pub width: f32,
    /// Solid, dashed or dotted: tells roles apart where colours do not.
    pub style: LineStyle,
}

impl LineLook {
    /// This line as it is drawn while something points at it.
    pub fn emphasized(self) -> Self {
        let color = self.color.to_opaque();
        match self.style {
            // Dots need room to stay dots.
            LineStyle::Dotted { spacing } => {
                let style = LineStyle::Dotted { spacing: 1.5 * spacing };
                Self { color, width: self.width + 0.7, style }
            }
            _ => Self { color, width: self.width + 1.6, style: self.style },
        }
    }

    /// This line along `path`, in screen coordinates.
    pub fn shapes(&self, path: &[Pos2]) -> Vec<Shape> {
        let stroke = Stroke::new(self.width, self.color);
        match self.style {
            LineStyle::Solid => vec![Shape::line(path.to_vec(), stroke)],
            LineStyle::Dashed { length } => Shape::dashed_line(path, stroke, length, GAP_OF_DASH * length),
            LineStyle::Dotted { spacing } => Shape::dotted_line(path, self.color, spacing, self.width),
        }
    }
}

/// Gap between dashes as a part of their length: as egui_plot has it, so that legends look like their plots.
const GAP_OF_DASH: f32 = 0.618;
const DOTTED: LineStyle = LineStyle::Dotted { spacing: 4.5 };

impl Role {
    /// Every role, in the order of a legend.
    pub const ALL: [Self; 8] = [
        Self::Nominal,
        Self::Perturbed,
        Self::Representative,
        Self::Identified,
        Self::IdentifiedRepresentative,
        Self::Corrected,
        Self::Scheduled,
        Self::Rejected,
    ];

    /// The name in a legend.
    pub fn name(self) -> &'static str {
        match self {
            Self::Nominal => "nominal",
            Self::Perturbed => "perturbed",
            Self::Representative => "representative",
            Self::Identified => "identified",
            Self::IdentifiedRepresentative => "identified representative",
            Self::Corrected => "corrected",
            Self::Scheduled => "scheduled",
            Self::Rejected => "rejected",
        }
    }

    /// The role that a curve is shown in: a rejected curve is `Rejected`, but the nominal model stays nominal.
    pub fn shown(self, rejected: bool) -> Self {
        if rejected && self != Self::Nominal { Self::Rejected } else { self }
    }

    /// How a curve of this role is drawn. A rejected nominal model stays red, but dotted.
    pub fn look(self, rejected: bool, palette: &Palette) -> LineLook {
        let look = |color, width, style| LineLook { color, width, style };
        match self.shown(rejected) {
            Self::Nominal if rejected => look(palette.nominal, 1.3, DOTTED),
            Self::Nominal => look(palette.nominal, 1.8, LineStyle::Solid),
            Self::Perturbed => look(palette.perturbed.gamma_multiply(0.8), 1.0, LineStyle::Solid),
            Self::Representative => look(palette.perturbed, 2.4, LineStyle::Solid),
            Self::Identified => look(palette.identified, 1.2, LineStyle::Dashed { length: 6.0 }),
            // Wider than the corrected curve that is to lie on it, so that both are seen where they agree.
            Self::IdentifiedRepresentative => look(palette.identified, 3.0, LineStyle::Solid),
            Self::Corrected => look(palette.corrected, 2.0, LineStyle::Solid),
            Self::Scheduled => look(palette.corrected, 2.0, LineStyle::Dashed { length: 8.0 }),
            Self::Rejected => look(palette.rejected, 1.0, DOTTED),
        }
    }

    /// Place in the order of drawing: what matters most is drawn last, on top.
    pub fn layer(self, rejected: bool) -> usize {
        match self.shown(rejected) {
            Self::Rejected => 0,
            Self::Perturbed => 1,
            Self::Identified => 2,
            Self::Nominal => 3,
            Self::Representative => 4,
            Self::IdentifiedRepresentative => 5,
            Self::Scheduled => 6,
            Self::Corrected => 7,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_rejected_nominal_model_stays_red_but_is_dotted() {
        let palette = Palette::dark();
        let look = Role::Nominal.look(true, &palette);
        assert_eq!(look.color, palette.nominal);
        assert!(matches!(look.style, LineStyle::Dotted { .. }));
    }

    #[test]
    fn roles_differ_by_style_or_width_without_their_colours() {
        for palette in [Palette::dark(), Palette::light()] {
            for a in Role::ALL {
                for b in Role::ALL.into_iter().filter(|b| *b != a) {
                    let (a, b) = (a.look(false, &palette), b.look(false, &palette));
                    assert!(a.style != b.style || (a.width - b.width).abs() > 0.15, "{a:?} {b:?}");
                }
            }
        }
    }
}
