//! How curves are drawn, apart from the theme.

use egui::Color32;
use serde::{Deserialize, Serialize};

use super::hex;

/// The colours of the roles of curves.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize)]
pub enum CurveColors {
    /// Red, blue, amber, green.
    #[default]
    Standard,
    /// Colours that stay apart without red, green or blue cones.
    ForAllEyes,
}

impl CurveColors {
    /// Each of them, in the order of a menu.
    pub const ALL: [Self; 2] = [Self::Standard, Self::ForAllEyes];

    /// The name in a menu.
    pub fn name(self) -> &'static str {
        match self {
            Self::Standard => "Standard colours of curves",
            Self::ForAllEyes => "Colours of curves for all eyes",
        }
    }
}

/// How the engineer wants curves to be drawn.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct PlotStyle {
    /// The colours of their roles.
    pub curve_colors: CurveColors,
    /// What their widths are multiplied by.
    pub line_width: f32,
}

impl PlotStyle {
    /// What widths can be multiplied by.
    pub const LINE_WIDTHS: [f32; 6] = [0.5, 0.75, 1.0, 1.5, 2.0, 3.0];

    /// These looks where the widths are some that can be seen; a preference may have been written by another version.
    pub fn within_limits(self) -> Self {
        let line_width = if self.line_width.is_finite() { self.line_width.clamp(0.5, 3.0) } else { 1.0 };
        Self { line_width, ..self }
    }
}

impl Default for PlotStyle {
    fn default() -> Self {
        Self { curve_colors: CurveColors::default(), line_width: 1.0 }
    }
}

/// Nominal, perturbed, identified, corrected: of colours with a contrast of 3 to the background, near vermilion, blue, yellow and
/// green, those whose least distance to one another and to grey is greatest, to all eyes.
pub(super) const fn for_all_eyes(is_dark: bool) -> [Color32; 4] {
    if is_dark {
        [hex(0xc65b04), hex(0x6996ff), hex(0xe8d525), hex(0x12e782)]
    } else {
        [hex(0x9b2817), hex(0x1a64e2), hex(0xa37f00), hex(0x0b9c58)]
    }
}

#[cfg(test)]
mod tests {
    use egui::Rgba;

    use super::super::plot_style::*;
    use crate::view::palette::Palette;
    use crate::view::plot::{CurveStyle, Role};

    /// What is seen of a linear colour: all of it, or what is left without one kind of cones. Machado, Oliveira and Fernandes,
    /// "A Physiologically-based Model for Simulation of Color Vision Deficiency", IEEE TVCG 15(6), 2009, severity 1.0.
    const SIGHTS: [(&str, [[f32; 3]; 3]); 4] = [
        ("full", [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]]),
        (
            "protanopia",
            [[0.152286, 1.052583, -0.204868], [0.114503, 0.786281, 0.099216], [-0.003882, -0.048116, 1.051998]],
        ),
        (
            "deuteranopia",
            [[0.367322, 0.860646, -0.227968], [0.280085, 0.672501, 0.047413], [-0.011820, 0.042940, 0.968881]],
        ),
        (
            "tritanopia",
            [[1.255528, -0.076749, -0.178779], [-0.078411, 0.930809, 0.147602], [0.004733, 0.691367, 0.303900]],
        ),
    ];

    /// CIELAB under D65 (CIE 15:2004), of linear sRGB (IEC 61966-2-1).
    fn lab([r, g, b]: [f32; 3]) -> [f32; 3] {
        let x = (0.4124564 * r + 0.3575761 * g + 0.1804375 * b) / 0.95047;
        let y = 0.2126729 * r + 0.7151522 * g + 0.0721750 * b;
        let z = (0.0193339 * r + 0.119192 * g + 0.9503041 * b) / 1.08883;
        let f = |t: f32| if t > 216.0 / 24389.0 { t.cbrt() } else { (24389.0 / 27.0 * t + 16.0) / 116.0 };
        [116.0 * f(y) - 16.0, 500.0 * (f(x) - f(y)), 200.0 * (f(y) - f(z))]
    }

    /// The colour that a translucent one is a part of.
    fn opaque(color: Color32) -> Color32 {
        let [r, g, b, _] = color.to_srgba_unmultiplied();
        Color32::from_rgb(r, g, b)
    }

    fn seen(color: Color32, sight: &[[f32; 3]; 3]) -> [f32; 3] {
        let [r, g, b, _] = Rgba::from(opaque(color)).to_array();
        lab(sight.map(|row| (row[0] * r + row[1] * g + row[2] * b).clamp(0.0, 1.0)))
    }

    /// Distance of two colours to the eye: CIE76, where 2.3 can just be told.
    fn distance(a: Color32, b: Color32, sight: &[[f32; 3]; 3]) -> f32 {
        let (a, b) = (seen(a, sight), seen(b, sight));
        a.iter().zip(b).map(|(a, b)| (a - b).powi(2)).sum::<f32>().sqrt()
    }

    /// Far enough for thin lines: ten times what can just be told of large fields.
    const APART: f32 = 23.0;

    /// The looks of every role in both themes.
    fn roles(curve_colors: CurveColors) -> Vec<Vec<(Role, CurveStyle)>> {
        let of = |theme: Palette| {
            let palette = theme.with_looks(PlotStyle { curve_colors, ..PlotStyle::default() });
            Role::ALL.into_iter().map(|role| (role, palette.role_style(role, false))).collect()
        };
        [Palette::dark(), Palette::light()].map(of).to_vec()
    }

    fn assert_told_apart(curve_colors: CurveColors, is_told: impl Fn(&CurveStyle, &CurveStyle, f32) -> bool) {
        for looks in roles(curve_colors) {
            for (place, (role, look)) in looks.iter().enumerate() {
                for (other, other_look) in &looks[place + 1..] {
                    for (sight, matrix) in &SIGHTS {
                        let distance = distance(look.color, other_look.color, matrix);
                        assert!(is_told(look, other_look, distance), "{role:?} {other:?}, {sight}: {distance}");
                    }
                }
            }
        }
    }

    #[test]
    fn roles_of_two_colours_are_told_apart_by_colour_alone_to_all_eyes() {
        // Some roles share a colour, and differ in pattern or width; translucent ones come back with a rounding error.
        let is_shared = |a: &CurveStyle, b: &CurveStyle| distance(a.color, b.color, &SIGHTS[0].1) < 2.3;
        assert_told_apart(CurveColors::ForAllEyes, |a, b, distance| is_shared(a, b) || distance > APART);
    }

    #[test]
    fn with_the_standard_colours_what_looks_alike_to_some_eyes_differs_in_line_and_width() {
        for curve_colors in CurveColors::ALL {
            assert_told_apart(curve_colors, |a, b, distance| {
                distance > APART || (a.dash, a.length) != (b.dash, b.length) || (a.width - b.width).abs() > 0.5
            });
        }
    }

    #[test]
    fn the_eye_without_green_cones_confuses_red_with_green() {
        let (red, green) = (Palette::dark().nominal, Palette::dark().corrected);
        assert!(distance(red, green, &SIGHTS[0].1) > 100.0);
        assert!(distance(red, green, &SIGHTS[2].1) < 20.0, "so the simulation sees what it is there for");
    }
}
