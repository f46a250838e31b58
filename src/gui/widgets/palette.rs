//! Window colours, dark and light; font sizes by use; and the curve style chosen by the engineer.

mod egui_style;

use egui::{Color32, FontFamily, FontId, Visuals};
use serde::{Deserialize, Serialize};

pub use egui_style::apply;

/// Font size of captions: axes, units, bars, table headings, chips, status \[pt\].
pub const SMALL_SIZE: f32 = 11.0;
/// Font size of running text: rows, controls, sentences \[pt\].
pub const BODY_SIZE: f32 = 12.5;
/// Font size of titles and of the counts in the verdict \[pt\].
pub const TITLE_SIZE: f32 = 15.0;
/// Font size of the heading of the start page \[pt\].
pub const DISPLAY_SIZE: f32 = 20.0;

/// Returns the medium-weight font, used for section headings, selection, constrained values and
/// buttons.
pub fn medium(size: f32) -> FontId {
    FontId::new(size, FontFamily::Name(MEDIUM.into()))
}

/// Name of the medium-weight font family.
const MEDIUM: &str = "medium";

/// Returns the caption font.
pub fn small() -> FontId {
    FontId::proportional(SMALL_SIZE)
}

/// Returns the font for running text.
pub fn body() -> FontId {
    FontId::proportional(BODY_SIZE)
}

const fn hex(rgb: u32) -> Color32 {
    Color32::from_rgb((rgb >> 16) as u8, (rgb >> 8) as u8, rgb as u8)
}

/// Values of J between which [`Palette::heat`] is interpolated.
pub const HEAT_COSTS: [f32; 5] = [0.0, 10.0, 30.0, 60.0, 110.0];

/// Colours of a theme, each with a single meaning.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Palette {
    /// Whether the theme has light text on a dark background.
    pub is_dark: bool,
    /// Background of plots and text fields.
    pub background: Color32,
    /// Background of side panels and bars.
    pub panel: Color32,
    /// Background of elements on a panel: buttons, legends, tooltips.
    pub raised: Color32,
    /// Separators and outlines.
    pub line: Color32,
    /// Grid lines in plots.
    pub grid: Color32,
    /// Running text.
    pub text: Color32,
    /// Captions and units.
    pub dim_text: Color32,
    /// Background of a selection.
    pub selected: Color32,
    /// Nominal physics model.
    pub nominal: Color32,
    /// Physics models at perturbed trims, and their representative.
    pub perturbed: Color32,
    /// Models identified from flight.
    pub identified: Color32,
    /// Corrected physics model, and the schedule.
    pub corrected: Color32,
    /// Rejected models.
    pub rejected: Color32,
    /// Interactive elements: links, handles, the band.
    pub accent: Color32,
    /// Cautions and deteriorations.
    pub warning: Color32,
    /// Met requirements.
    pub good: Color32,
    /// Background of an unmet verdict and of an invalid region.
    pub warning_ground: Color32,
    /// Background of a met verdict.
    pub good_ground: Color32,
    /// Text of zero values and of excluded names.
    pub quiet_text: Color32,
    /// Marks of low emphasis: bars, and check marks in boxes.
    pub quiet_mark: Color32,
    /// Colours of J at [`HEAT_COSTS`]: a single hue with increasing contrast to the background.
    pub heat: [Color32; 5],
    /// Factor on the widths of curves.
    pub line_width: f32,
}

impl Palette {
    /// Returns the dark theme.
    pub const fn dark() -> Self {
        Self {
            is_dark: true,
            background: hex(0x17191d),
            panel: hex(0x1e2127),
            raised: hex(0x262a31),
            line: hex(0x343a44),
            grid: hex(0x262a31),
            text: hex(0xd7dae0),
            dim_text: hex(0xa4acb9),
            selected: hex(0x1d3850),
            nominal: hex(0xef5b5b),
            perturbed: hex(0x5b8def),
            identified: hex(0xe9b949),
            corrected: hex(0x5fcf80),
            rejected: hex(0x878f9c),
            accent: hex(0x5aa9e6),
            warning: hex(0xf3935a),
            good: hex(0x56c08c),
            warning_ground: hex(0x33251d),
            good_ground: hex(0x1b2d26),
            quiet_text: hex(0x9aa2b0),
            quiet_mark: hex(0x6d7583),
            heat: [
                hex(0x2b3038),
                hex(0x574337),
                hex(0x9b613d),
                hex(0xe07f45),
                hex(0xffb083),
            ],
            line_width: 1.0,
        }
    }

    /// Returns the light theme.
    pub const fn light() -> Self {
        Self {
            is_dark: false,
            background: hex(0xf7f8fa),
            panel: hex(0xffffff),
            raised: hex(0xeef0f3),
            line: hex(0xd4d8de),
            grid: hex(0xe9ebef),
            text: hex(0x22262e),
            dim_text: hex(0x586070),
            selected: hex(0xdcebf8),
            nominal: hex(0xc62f2f),
            perturbed: hex(0x3566c8),
            identified: hex(0xb57a00),
            corrected: hex(0x1d8a47),
            rejected: hex(0x646c79),
            accent: hex(0x1b67a6),
            warning: hex(0xa9410a),
            good: hex(0x187049),
            warning_ground: hex(0xfdf0e7),
            good_ground: hex(0xe6f4ec),
            quiet_text: hex(0x5e6674),
            quiet_mark: hex(0x8a92a0),
            heat: [
                hex(0xeceef2),
                hex(0xf6d3b8),
                hex(0xee9f68),
                hex(0xd1661f),
                hex(0x8c3706),
            ],
            line_width: 1.0,
        }
    }

    /// Returns the palette that matches `visuals`.
    pub fn from_visuals(visuals: &Visuals) -> Self {
        if visuals.dark_mode {
            Self::dark()
        } else {
            Self::light()
        }
    }

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

    /// Shifts `color` towards the text colour by `amount` (0 to 1), for hovered and pressed
    /// elements.
    pub fn towards_text(&self, color: Color32, amount: f32) -> Color32 {
        color.lerp_to_gamma(self.text, amount)
    }

    /// Returns the colour of a value of J in a heat map; constant beyond the last of
    /// [`HEAT_COSTS`].
    pub fn heat_color(&self, cost: f64) -> Color32 {
        const LAST: usize = HEAT_COSTS.len() - 1;
        let cost = (cost as f32).clamp(HEAT_COSTS[0], HEAT_COSTS[LAST]);
        // Index of the upper end of the interval that contains the cost, from 1 to `LAST`.
        let above = HEAT_COSTS
            .iter()
            .position(|end| cost < *end)
            .unwrap_or(LAST)
            .max(1);
        let part = (cost - HEAT_COSTS[above - 1]) / (HEAT_COSTS[above] - HEAT_COSTS[above - 1]);
        self.heat[above - 1].lerp_to_gamma(self.heat[above], part)
    }

    /// Returns the colour of a name beside a curve of colour `curve`.
    pub fn label_color(&self, curve: Color32) -> Color32 {
        self.towards_text(curve, 0.3)
    }

    /// Returns the colour of text on the accent colour.
    pub fn on_accent(&self) -> Color32 {
        if self.is_dark {
            self.background
        } else {
            self.panel
        }
    }
}

/// Set of colours of the curve roles.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize)]
pub enum CurveColors {
    /// Red, blue, amber, green.
    #[default]
    Standard,
    /// Distinguishable without red, green or blue cones.
    ForAllEyes,
}

impl CurveColors {
    /// Every choice, in menu order.
    pub const ALL: [Self; 2] = [Self::Standard, Self::ForAllEyes];

    /// Returns the text of the menu entry.
    pub fn name(self) -> &'static str {
        match self {
            Self::Standard => "Standard curve colours",
            Self::ForAllEyes => "Curve colours for colour-blind readers",
        }
    }
}

/// Curve style chosen by the engineer.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct PlotStyle {
    pub curve_colors: CurveColors,
    /// Factor on the widths of curves.
    pub line_width: f32,
}

impl PlotStyle {
    /// Selectable width factors.
    pub const LINE_WIDTHS: [f32; 6] = [0.5, 0.75, 1.0, 1.5, 2.0, 3.0];

    /// Clamps the width factor to the permitted range; the stored preference may come from another
    /// version.
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

/// Colours of nominal, perturbed, identified and corrected models. Among all colours near
/// vermilion, blue, yellow and green with a contrast of 3 to the background, they maximise the
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

    /// Computes relative luminance (Web Content Accessibility Guidelines 2.2).
    fn luminance(color: Color32) -> f32 {
        let [r, g, b, _] = Rgba::from(color).to_array();
        0.2126 * r + 0.7152 * g + 0.0722 * b
    }

    /// Computes the contrast ratio (Web Content Accessibility Guidelines 2.2).
    fn contrast(a: Color32, b: Color32) -> f32 {
        let a = luminance(a);
        let b = luminance(b);
        (a.max(b) + 0.05) / (a.min(b) + 0.05)
    }

    /// Contrast required by the guidelines for text and for meaningful lines.
    const OF_TEXT: f32 = 4.5;
    const OF_LINES: f32 = 3.0;

    #[test]
    fn text_is_readable_on_every_surface_of_both_themes() {
        for palette in [Palette::dark(), Palette::light()] {
            let Palette {
                background,
                panel,
                raised,
                selected,
                warning_ground,
                good_ground,
                ..
            } = palette;
            for surface in [
                background,
                panel,
                raised,
                selected,
                warning_ground,
                good_ground,
            ] {
                assert!(contrast(palette.text, surface) > 6.0, "{palette:?}");
                for text in [palette.dim_text, palette.warning, palette.good] {
                    assert!(
                        contrast(text, surface) >= OF_TEXT,
                        "{text:?} on {surface:?} of {palette:?}"
                    );
                }
            }
            // Names of excluded items and links also appear on selections, and warnings on panels.
            for (text, surfaces) in [
                (palette.quiet_text, [background, panel, raised, selected]),
                (palette.accent, [background, panel, raised, selected]),
                (palette.nominal, [panel; 4]),
            ] {
                for surface in surfaces {
                    assert!(
                        contrast(text, surface) >= OF_TEXT,
                        "{text:?} on {surface:?} of {palette:?}"
                    );
                }
            }
        }
    }

    #[test]
    fn curves_stand_out_from_the_background_of_both_themes() {
        for theme in [Palette::dark(), Palette::light()] {
            for curve_colors in CurveColors::ALL {
                let palette = theme.with_looks(PlotStyle {
                    curve_colors,
                    ..PlotStyle::default()
                });
                let Palette {
                    nominal,
                    perturbed,
                    identified,
                    corrected,
                    rejected,
                    ..
                } = palette;
                for color in [nominal, perturbed, identified, corrected, rejected] {
                    assert!(
                        contrast(color, palette.background) > OF_LINES,
                        "{color:?} of {palette:?}"
                    );
                }
            }
        }
    }

    #[test]
    fn the_names_of_curves_are_readable_beside_their_plots() {
        for theme in [Palette::dark(), Palette::light()] {
            let curves = [
                theme.nominal,
                theme.perturbed,
                theme.identified,
                theme.corrected,
                theme.rejected,
            ];
            for name in curves.map(|color| theme.label_color(color)) {
                assert!(
                    contrast(name, theme.background) >= OF_TEXT,
                    "{name:?} of {theme:?}"
                );
            }
        }
    }

    #[test]
    fn a_greater_cost_stands_out_more_from_the_ground() {
        for palette in [Palette::dark(), Palette::light()] {
            let costs = [0.0, 5.0, 10.0, 20.0, 30.0, 45.0, 60.0, 90.0, 110.0];
            let contrasts = costs.map(|cost| contrast(palette.heat_color(cost), palette.panel));
            assert!(
                contrasts.is_sorted_by(|less, more| less < more),
                "{palette:?}"
            );
            assert_eq!(palette.heat_color(1e9), palette.heat[4]);
        }
    }

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
