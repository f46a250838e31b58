//! Colour, width and pattern with which curves are drawn.
//!
//! Roles, patterns and colours by meaning (`Hue`) are shared with printed figures; here they get
//! the colours of the theme and widths on the screen.

use egui::{Color32, Pos2, Shape, Stroke};

use gdcm_plot::figure::Color;
pub use gdcm_plot::figure::Role;
use gdcm_plot::figure::drawing::{Dash, Hue};

use crate::gui::widgets::palette::Palette;

/// Length of the gaps between dashes, relative to the dashes.
const GAP_OF_DASH: f32 = 0.618;
/// Length of the gaps on either side of a dot, relative to the gaps between dashes.
const GAP_AT_DOT: f32 = 0.6;
/// Length of the dots between dashes \[pt\].
const DOT_LENGTH: f32 = 1.8;
/// Width added to an emphasized line \[pt\].
const EMPHASIZED_WIDER: f32 = 1.6;
/// Width added to emphasized dots \[pt\].
const EMPHASIZED_DOTS_WIDER: f32 = 0.7;
/// Factor by which the spacing between emphasized dots grows.
const EMPHASIZED_DOTS_APART: f32 = 1.5;

/// Colour, width and pattern with which a curve is drawn.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CurveStyle {
    pub color: Color32,
    /// Width \[pt\].
    pub width: f32,
    /// Pattern, which distinguishes roles drawn in the same colour.
    pub dash: Dash,
    /// Dash length, or distance between dots \[pt\].
    pub length: f32,
}

impl CurveStyle {
    /// Returns this line's style when emphasized: opaque and wider.
    pub fn emphasized(self) -> Self {
        let mut style = Self {
            color: self.color.to_opaque(),
            ..self
        };
        if self.dash == Dash::Dotted {
            // Dots need a wider spacing to remain dots.
            style.width += EMPHASIZED_DOTS_WIDER;
            style.length *= EMPHASIZED_DOTS_APART;
        } else {
            style.width += EMPHASIZED_WIDER;
        }
        style
    }

    /// Returns this line's style in a small plot: narrower, with a shorter pattern.
    pub fn in_miniature(self) -> Self {
        /// Width relative to a full plot.
        const WIDTH_PART: f32 = 0.72;
        let length = match self.dash {
            Dash::Solid => 0.0,
            Dash::Long | Dash::Short => 4.0,
            Dash::DashDot | Dash::ShortDashDot => 6.0,
            Dash::Dotted => 3.5,
        };
        Self {
            width: WIDTH_PART * self.width,
            length,
            ..self
        }
    }

    /// Returns whether the line is dashed or dotted; the pattern depends on where the line starts.
    pub fn is_broken(&self) -> bool {
        self.dash != Dash::Solid
    }

    /// Adds the line along `path`, given in screen coordinates.
    pub fn add_shapes(&self, path: Vec<Pos2>, shapes: &mut Vec<Shape>) {
        let stroke = Stroke::new(self.width, self.color);
        let length = self.length;
        match self.dash {
            Dash::Solid => shapes.push(Shape::line(path, stroke)),
            Dash::Long | Dash::Short => {
                Shape::dashed_line_many(&path, stroke, length, GAP_OF_DASH * length, shapes);
            }
            Dash::DashDot | Dash::ShortDashDot => {
                let gap = GAP_OF_DASH * GAP_AT_DOT * length;
                Shape::dashed_line_many_with_offset(
                    &path,
                    stroke,
                    &[length, DOT_LENGTH],
                    &[gap, gap],
                    0.0,
                    shapes,
                );
            }
            Dash::Dotted => {
                shapes.extend(Shape::dotted_line(&path, self.color, length, self.width))
            }
        }
    }
}

impl Palette {
    /// Returns this theme's colour for a figure's colour, which is given by its meaning and
    /// opacity.
    pub fn color(&self, color: Color) -> Color32 {
        let of_hue = match color.hue {
            Hue::Background => self.background,
            Hue::Grid => self.grid,
            Hue::Text => self.text,
            Hue::DimText => self.dim_text,
            Hue::Nominal => self.nominal,
            Hue::Perturbed => self.perturbed,
            Hue::Identified => self.identified,
            Hue::Corrected => self.corrected,
            Hue::Rejected => self.rejected,
            Hue::Accent => self.accent,
            Hue::Warning => self.warning,
            Hue::Good => self.good,
            Hue::OfAirspeed(step) => self.airspeed_color(step),
        };
        if color.percent == 100 {
            of_hue
        } else {
            of_hue.gamma_multiply(f32::from(color.percent) / 100.0)
        }
    }

    /// Returns a line's style in this theme, with the line width chosen by the engineer.
    pub fn curve_style(&self, line: gdcm_plot::figure::drawing::Stroke) -> CurveStyle {
        let length = match line.dash {
            Dash::Solid => 0.0,
            Dash::Long => 9.0,
            Dash::Short | Dash::ShortDashDot => 5.0,
            Dash::Dotted => 4.5,
            Dash::DashDot => 11.0,
        };
        let color = self.color(line.color);
        let width = line.width_pt as f32 * self.line_width;
        CurveStyle {
            color,
            width,
            dash: line.dash,
            length,
        }
    }

    /// Returns the curve style for kept or rejected models in a role.
    pub fn role_style(&self, role: Role, rejected: bool) -> CurveStyle {
        self.curve_style(role.line(rejected))
    }
}

#[cfg(test)]
mod tests {
    use egui::pos2;

    use super::*;

    fn shapes(dash: Dash, length: f32) -> usize {
        let mut shapes = Vec::new();
        let look = CurveStyle {
            color: Color32::WHITE,
            width: 2.0,
            dash,
            length,
        };
        look.add_shapes(vec![pos2(0.0, 0.0), pos2(100.0, 0.0)], &mut shapes);
        shapes.len()
    }

    #[test]
    fn every_pattern_looks_different_along_a_line() {
        assert_eq!(shapes(Dash::Solid, 0.0), 1);
        // A line 100 pt long is drawn with dashes of 8 and gaps of 4.9; dashes of 8, dots of 1.8
        // and gaps of 3.0; dots at a distance of 5.
        assert_eq!(shapes(Dash::Long, 8.0), 8);
        assert_eq!(shapes(Dash::DashDot, 8.0), 13);
        assert_eq!(shapes(Dash::Dotted, 5.0), 20);
    }

    #[test]
    fn paper_has_the_colours_of_the_light_theme() {
        let light = Palette::light();
        let roles = [
            Hue::Nominal,
            Hue::Perturbed,
            Hue::Identified,
            Hue::Corrected,
            Hue::Rejected,
        ];
        for hue in roles.into_iter().chain([
            Hue::Text,
            Hue::DimText,
            Hue::Accent,
            Hue::Warning,
            Hue::Good,
            Hue::OfAirspeed(0),
            Hue::OfAirspeed(255),
        ]) {
            let [red, green, blue, _] = light.color(Color::new(hue)).to_array();
            assert_eq!([red, green, blue], hue.on_paper(), "{hue:?}");
        }
    }

    #[test]
    fn lines_are_broken_in_the_window_as_on_paper() {
        for role in Role::ALL {
            let window = Palette::light().role_style(role, false);
            let paper = role.stroke(false);
            assert_eq!(
                window.is_broken(),
                !paper.dash.pattern_pt().is_empty(),
                "{role:?}"
            );
        }
        assert_eq!(Role::Corrected.stroke(false).dash, Dash::Solid);
        assert_eq!(Role::Scheduled.stroke(false).dash, Dash::Long);
    }

    #[test]
    fn a_rejected_nominal_model_stays_red_but_is_dotted() {
        let palette = Palette::dark();
        let look = palette.role_style(Role::Nominal, true);
        assert_eq!(look.color, palette.nominal);
        assert_eq!(look.dash, Dash::Dotted);
    }

    #[test]
    fn before_and_after_and_the_reference_differ_in_pattern_or_clearly_in_width() {
        let palette = Palette::light();
        for other in [
            Role::Nominal,
            Role::Identified,
            Role::IdentifiedRepresentative,
        ] {
            let corrected = palette.role_style(Role::Corrected, false);
            let other = palette.role_style(other, false);
            assert!(
                corrected.dash != other.dash || (corrected.width - other.width).abs() > 1.5,
                "{other:?}"
            );
        }
    }

    #[test]
    fn widths_follow_the_engineer() {
        let palette = Palette {
            line_width: 2.0,
            ..Palette::dark()
        };
        for role in Role::ALL {
            let wide = palette.role_style(role, false);
            let usual = Palette::dark().role_style(role, false);
            assert_eq!(
                wide,
                CurveStyle {
                    width: 2.0 * usual.width,
                    ..usual
                }
            );
        }
    }

    #[test]
    fn roles_differ_by_style_or_width_without_their_colours() {
        for palette in [Palette::dark(), Palette::light()] {
            for a in Role::ALL {
                for b in Role::ALL.into_iter().filter(|b| *b != a) {
                    let a = palette.role_style(a, false);
                    let b = palette.role_style(b, false);
                    assert!(
                        (a.dash, a.length) != (b.dash, b.length) || (a.width - b.width).abs() > 0.5,
                        "{a:?} {b:?}"
                    );
                }
            }
        }
    }
}
