//! Colour, width and pattern of a line.

use egui::{Color32, Pos2, Shape, Stroke};
pub use gdcm_files::figure::Role;

use crate::view::palette::Palette;

/// What tells lines apart where colours do not.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum LinePattern {
    /// One line.
    Solid,
    /// Two lines with the ground between them, which another line may fill.
    Double {
        /// Colour of the ground.
        ground: Color32,
    },
    /// Dashes.
    Dashed {
        /// Of each dash \[pt\].
        length: f32,
    },
    /// Dashes with a dot between them.
    DashDotted {
        /// Of each dash \[pt\].
        length: f32,
    },
    /// Dots.
    Dotted {
        /// From one to the next \[pt\].
        spacing: f32,
    },
}

/// Gap between dashes as a part of their length.
const GAP_OF_DASH: f32 = 0.618;
/// Of a double line, the part that is ground.
const GROUND_OF_DOUBLE: f32 = 0.42;
/// Length of a dot between dashes \[pt\].
const DOT_LENGTH: f32 = 1.8;

/// Colour, width and pattern of a curve.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LineLook {
    /// Colour of the line.
    pub color: Color32,
    /// Width of the line \[pt\].
    pub width: f32,
    /// Tells roles apart where colours do not.
    pub pattern: LinePattern,
}

impl LineLook {
    /// This line as it is drawn while something points at it.
    pub fn emphasized(self) -> Self {
        let color = self.color.to_opaque();
        match self.pattern {
            // Dots need room to stay dots.
            LinePattern::Dotted { spacing } => {
                let pattern = LinePattern::Dotted { spacing: 1.5 * spacing };
                Self { color, width: self.width + 0.7, pattern }
            }
            _ => Self { color, width: self.width + 1.6, pattern: self.pattern },
        }
    }

    /// This line in a small plot: narrower, with a shorter pattern.
    pub fn in_miniature(self) -> Self {
        /// Width as a part of that in a full plot.
        const WIDTH_PART: f32 = 0.72;
        let pattern = match self.pattern {
            LinePattern::Solid | LinePattern::Double { .. } => self.pattern,
            LinePattern::Dashed { .. } => LinePattern::Dashed { length: 4.0 },
            LinePattern::DashDotted { .. } => LinePattern::DashDotted { length: 6.0 },
            LinePattern::Dotted { .. } => LinePattern::Dotted { spacing: 3.5 },
        };
        Self { width: WIDTH_PART * self.width, pattern, ..self }
    }

    /// Whether the line is made of many pieces, which begin where it does.
    pub fn is_broken(&self) -> bool {
        !matches!(self.pattern, LinePattern::Solid | LinePattern::Double { .. })
    }

    /// This line along `path`, in screen coordinates.
    pub fn add_shapes(&self, path: Vec<Pos2>, shapes: &mut Vec<Shape>) {
        let stroke = Stroke::new(self.width, self.color);
        match self.pattern {
            LinePattern::Solid => shapes.push(Shape::line(path, stroke)),
            LinePattern::Double { ground } => {
                shapes.push(Shape::line(path.clone(), stroke));
                shapes.push(Shape::line(path, Stroke::new(GROUND_OF_DOUBLE * self.width, ground)));
            }
            LinePattern::Dashed { length } => {
                Shape::dashed_line_many(&path, stroke, length, GAP_OF_DASH * length, shapes);
            }
            LinePattern::DashDotted { length } => {
                let gap = GAP_OF_DASH * 0.6 * length;
                Shape::dashed_line_many_with_offset(&path, stroke, &[length, DOT_LENGTH], &[gap, gap], 0.0, shapes);
            }
            LinePattern::Dotted { spacing } => {
                shapes.extend(Shape::dotted_line(&path, self.color, spacing, self.width))
            }
        }
    }
}

/// The dots of what is left out.
const DOTTED: LinePattern = LinePattern::Dotted { spacing: 4.5 };

/// How a role looks on the screen.
pub trait RoleLook {
    /// How a curve of this role is drawn. A rejected nominal model stays red, but dotted.
    fn look(self, rejected: bool, palette: &Palette) -> LineLook;
}

impl RoleLook for Role {
    fn look(self, rejected: bool, palette: &Palette) -> LineLook {
        let look = |color, width, pattern| LineLook { color, width: width * palette.line_width, pattern };
        let dashed = |length| LinePattern::Dashed { length };
        match self.shown(rejected) {
            Self::Nominal if rejected => look(palette.nominal, 1.3, DOTTED),
            Self::Nominal => look(palette.nominal, 1.6, LinePattern::DashDotted { length: 11.0 }),
            Self::Perturbed => look(palette.perturbed.gamma_multiply(0.8), 1.0, LinePattern::Solid),
            Self::Representative => look(palette.perturbed, 2.8, LinePattern::Solid),
            Self::Identified => look(palette.identified, 1.2, dashed(5.0)),
            // Wide and open: the corrected curve that is to lie on it fills it, so that both are seen where they agree.
            Self::IdentifiedRepresentative => {
                look(palette.identified, 4.6, LinePattern::Double { ground: palette.background })
            }
            Self::Corrected => look(palette.corrected, 2.2, LinePattern::Solid),
            Self::Scheduled => look(palette.corrected, 2.2, dashed(9.0)),
            Self::WithoutLeads => look(palette.corrected, 1.4, LinePattern::DashDotted { length: 5.0 }),
            Self::Rejected => look(palette.rejected, 1.0, DOTTED),
            // From blue over grey to amber, as in scales made for colour-blind eyes.
            Self::OfAirspeed(step) => {
                let part = f32::from(step) / f32::from(u8::MAX);
                look(palette.perturbed.lerp_to_gamma(palette.identified, part), 1.8, LinePattern::Solid)
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use egui::pos2;

    use super::super::curve_style::*;

    fn shapes(pattern: LinePattern) -> usize {
        let mut shapes = Vec::new();
        let look = LineLook { color: Color32::WHITE, width: 2.0, pattern };
        look.add_shapes(vec![pos2(0.0, 0.0), pos2(100.0, 0.0)], &mut shapes);
        shapes.len()
    }

    #[test]
    fn every_pattern_looks_different_along_a_line() {
        assert_eq!(shapes(LinePattern::Solid), 1);
        assert_eq!(shapes(LinePattern::Double { ground: Color32::BLACK }), 2);
        // 100 points of dashes of 8 with gaps of 4.9; of 8, 1.8 and two gaps of 3.0; of dots every 5 but at the end.
        assert_eq!(shapes(LinePattern::Dashed { length: 8.0 }), 8);
        assert_eq!(shapes(LinePattern::DashDotted { length: 8.0 }), 13);
        assert_eq!(shapes(LinePattern::Dotted { spacing: 5.0 }), 20);
    }
}

#[cfg(test)]
mod tests2 {
    use super::super::curve_style::*;

    #[test]
    fn a_rejected_nominal_model_stays_red_but_is_dotted() {
        let palette = Palette::dark();
        let look = Role::Nominal.look(true, &palette);
        assert_eq!(look.color, palette.nominal);
        assert!(matches!(look.pattern, LinePattern::Dotted { .. }));
    }

    #[test]
    fn before_and_after_and_the_reference_differ_in_pattern_and_in_width() {
        let palette = Palette::light();
        for other in [Role::Nominal, Role::Identified, Role::IdentifiedRepresentative] {
            let (corrected, other) = (Role::Corrected.look(false, &palette), other.look(false, &palette));
            assert!(corrected.pattern != other.pattern && (corrected.width - other.width).abs() > 0.5, "{other:?}");
        }
    }

    #[test]
    fn widths_follow_the_engineer() {
        let palette = Palette { line_width: 2.0, ..Palette::dark() };
        for role in Role::ALL {
            let (wide, usual) = (role.look(false, &palette), role.look(false, &Palette::dark()));
            assert_eq!(wide, LineLook { width: 2.0 * usual.width, ..usual });
        }
    }

    #[test]
    fn roles_differ_by_style_or_width_without_their_colours() {
        for palette in [Palette::dark(), Palette::light()] {
            for a in Role::ALL {
                for b in Role::ALL.into_iter().filter(|b| *b != a) {
                    let (a, b) = (a.look(false, &palette), b.look(false, &palette));
                    assert!(a.pattern != b.pattern || (a.width - b.width).abs() > 0.5, "{a:?} {b:?}");
                }
            }
        }
    }
}
