//! Curve style chosen by the engineer: colours for the curve roles, and line width.

use egui::Color32;
use serde::{Deserialize, Serialize};

use super::{Palette, hex};

#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct PlotStyle {
    pub curve_colors: CurveColors,
    /// Factor on curve widths.
    pub line_width: f32,
}

impl PlotStyle {
    /// Selectable width factors.
    pub const LINE_WIDTHS: [f32; 6] = [0.5, 0.75, 1.0, 1.5, 2.0, 3.0];

    /// Clamps the width factor to the permitted range, 1 if it is not finite; the stored preference
    /// may come from another version.
    pub fn within_limits(self) -> Self {
        let line_width = if self.line_width.is_finite() {
            self.line_width.clamp(0.5, 3.0)
        } else {
            1.0
        };
        Self { line_width, ..self }
    }
}

impl Default for PlotStyle {
    fn default() -> Self {
        Self {
            curve_colors: CurveColors::default(),
            line_width: 1.0,
        }
    }
}

impl Palette {
    /// Returns this palette with the engineer's curve style.
    pub fn with_looks(self, looks: PlotStyle) -> Self {
        let line_width = looks.line_width;
        match looks.curve_colors {
            CurveColors::Standard => Self { line_width, ..self },
            CurveColors::ForAllEyes => {
                let [nominal, perturbed, identified, corrected] = for_all_eyes(self.is_dark);
                Self {
                    nominal,
                    perturbed,
                    identified,
                    corrected,
                    line_width,
                    ..self
                }
            }
        }
    }
}

/// Colour set for the curve roles.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize)]
pub enum CurveColors {
    /// Nominal red, perturbed blue, identified amber, corrected green.
    #[default]
    Standard,
    /// Distinguishable also for readers without red, green or blue cones.
    ForAllEyes,
}

impl CurveColors {
    /// Every choice, in menu order.
    pub const ALL: [Self; 2] = [Self::Standard, Self::ForAllEyes];

    /// Returns the menu entry's text.
    pub fn name(self) -> &'static str {
        match self {
            Self::Standard => "Standard curve colours",
            Self::ForAllEyes => "Curve colours for colour-blind readers",
        }
    }
}

/// Returns the colours for nominal, perturbed, identified and corrected models. Among all colours
/// near vermilion, blue, yellow and green with a contrast of 3 to the background, they maximise the
/// minimum distance from each other and from grey over all kinds of colour vision.
const fn for_all_eyes(is_dark: bool) -> [Color32; 4] {
    if is_dark {
        [hex(0xc65b04), hex(0x6996ff), hex(0xe8d525), hex(0x12e782)]
    } else {
        [hex(0x9b2817), hex(0x1a64e2), hex(0xa37f00), hex(0x0b9c58)]
    }
}

#[cfg(test)]
mod tests {
    use egui::Rgba;

    use super::*;
    use crate::gui::plot::Role;
    use crate::gui::plot::curve_style::CurveStyle;

    /// Transformations of linear colour for full colour vision and for each missing kind of cone.
    /// Machado, Oliveira and Fernandes, "A Physiologically-based Model for Simulation of Color
    /// Vision Deficiency", IEEE TVCG 15(6), 2009, severity 1.0.
    const SIGHTS: [(&str, [[f32; 3]; 3]); 4] = [
        ("full", [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]]),
        (
            "protanopia",
            [
                [0.152286, 1.052583, -0.204868],
                [0.114503, 0.786281, 0.099216],
                [-0.003882, -0.048116, 1.051998],
            ],
        ),
        (
            "deuteranopia",
            [
                [0.367322, 0.860646, -0.227968],
                [0.280085, 0.672501, 0.047413],
                [-0.011820, 0.042940, 0.968881],
            ],
        ),
        (
            "tritanopia",
            [
                [1.255528, -0.076749, -0.178779],
                [-0.078411, 0.930809, 0.147602],
                [0.004733, 0.691367, 0.303900],
            ],
        ),
    ];

    /// Converts linear sRGB (IEC 61966-2-1) to CIELAB under D65 (CIE 15:2004).
    fn lab([r, g, b]: [f32; 3]) -> [f32; 3] {
        let x = (0.4124564 * r + 0.3575761 * g + 0.1804375 * b) / 0.95047;
        let y = 0.2126729 * r + 0.7151522 * g + 0.0721750 * b;
        let z = (0.0193339 * r + 0.119192 * g + 0.9503041 * b) / 1.08883;
        let [fx, fy, fz] = [x, y, z].map(lightness_root);
        [116.0 * fy - 16.0, 500.0 * (fx - fy), 200.0 * (fy - fz)]
    }

    /// Computes f(t) in CIE 15:2004: the cube root, linear near zero.
    fn lightness_root(t: f32) -> f32 {
        if t > 216.0 / 24389.0 {
            t.cbrt()
        } else {
            (24389.0 / 27.0 * t + 16.0) / 116.0
        }
    }

    /// Returns the opaque colour of which a translucent colour is a faded version.
    fn opaque(color: Color32) -> Color32 {
        let [r, g, b, _] = color.to_srgba_unmultiplied();
        Color32::from_rgb(r, g, b)
    }

    fn seen(color: Color32, sight: &[[f32; 3]; 3]) -> [f32; 3] {
        let [r, g, b, _] = Rgba::from(opaque(color)).to_array();
        lab(sight.map(|row| (row[0] * r + row[1] * g + row[2] * b).clamp(0.0, 1.0)))
    }

    /// Computes the perceived colour distance CIE76; 2.3 is just noticeable.
    fn distance(a: Color32, b: Color32, sight: &[[f32; 3]; 3]) -> f32 {
        let a = seen(a, sight);
        let b = seen(b, sight);
        a.iter()
            .zip(b)
            .map(|(a, b)| (a - b).powi(2))
            .sum::<f32>()
            .sqrt()
    }

    /// Minimum colour distance of thin lines: ten times the just noticeable difference of large
    /// fields.
    const APART: f32 = 23.0;

    /// Returns the styles of every role in both themes.
    fn roles(curve_colors: CurveColors) -> Vec<Vec<(Role, CurveStyle)>> {
        let mut looks = Vec::new();
        for theme in [Palette::dark(), Palette::light()] {
            let palette = theme.with_looks(PlotStyle {
                curve_colors,
                ..PlotStyle::default()
            });
            looks.push(
                Role::ALL
                    .into_iter()
                    .map(|role| (role, palette.role_style(role, false)))
                    .collect(),
            );
        }
        looks
    }

    fn assert_distinct(
        curve_colors: CurveColors,
        is_distinct: impl Fn(&CurveStyle, &CurveStyle, f32) -> bool,
    ) {
        for looks in roles(curve_colors) {
            for (place, (role, look)) in looks.iter().enumerate() {
                for (other, other_look) in &looks[place + 1..] {
                    for (sight, matrix) in &SIGHTS {
                        let distance = distance(look.color, other_look.color, matrix);
                        assert!(
                            is_distinct(look, other_look, distance),
                            "{role:?} {other:?}, {sight}: {distance}"
                        );
                    }
                }
            }
        }
    }

    /// Returns whether two roles have the same colour and differ only in pattern or width;
    /// translucent colours are compared with a tolerance for rounding.
    fn shares_color(a: &CurveStyle, b: &CurveStyle) -> bool {
        distance(a.color, b.color, &SIGHTS[0].1) < 2.3
    }

    #[test]
    fn roles_of_two_colours_are_distinct_by_colour_alone_to_all_eyes() {
        assert_distinct(CurveColors::ForAllEyes, |a, b, distance| {
            shares_color(a, b) || distance > APART
        });
    }

    #[test]
    fn standard_colours_that_look_alike_to_some_eyes_differ_in_line_or_width() {
        for curve_colors in CurveColors::ALL {
            assert_distinct(curve_colors, |a, b, distance| {
                distance > APART
                    || (a.dash, a.length) != (b.dash, b.length)
                    || (a.width - b.width).abs() > 0.5
            });
        }
    }

    #[test]
    fn the_eye_without_green_cones_confuses_red_with_green() {
        let red = Palette::dark().nominal;
        let green = Palette::dark().corrected;
        assert!(distance(red, green, &SIGHTS[0].1) > 100.0);
        assert!(
            distance(red, green, &SIGHTS[2].1) < 20.0,
            "the simulated eye confuses them"
        );
    }
}
