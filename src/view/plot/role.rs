//! How a curve of a role is drawn on the screen: the same in every view.

use super::line_look::{LineLook, LinePattern};
use crate::view::palette::Palette;
pub use gdcm_files::figure::Role;

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
    use super::*;

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
