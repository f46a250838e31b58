//! Window colours, dark and light, and font sizes by use. `palette/plot_style.rs` adapts curve
//! colours, `palette/egui_style.rs` sets colours and fonts in egui.

mod egui_style;
mod plot_style;

use egui::{Color32, FontFamily, FontId, RichText, Visuals};

use gdcm_plot::figure::drawing::AirspeedPlace;

pub use egui_style::apply;
pub use plot_style::{CurveColors, PlotStyle};

/// Font size for captions: axes, units, bars, table headings, chips, status \[pt\].
pub const SMALL_SIZE: f32 = 11.0;
/// Font size for running text: rows, controls, sentences \[pt\].
pub const BODY_SIZE: f32 = 12.5;
/// Font size for titles and for the counts in the verdict \[pt\].
pub const TITLE_SIZE: f32 = 15.0;
/// Font size for the start page's heading \[pt\].
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

/// Values of the cost J (M4: docs/method.md) between which [`Palette::heat`] is interpolated.
pub const HEAT_COSTS: [f32; 5] = [0.0, 10.0, 30.0, 60.0, 110.0];

/// Theme colours, each with a single meaning.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Palette {
    /// Whether the theme has light text on a dark background.
    pub is_dark: bool,
    /// Background in plots and text fields.
    pub background: Color32,
    /// Background in side panels and bars.
    pub panel: Color32,
    /// Background for elements on a panel: buttons, legends, tooltips.
    pub raised: Color32,
    /// Separators and outlines.
    pub line: Color32,
    /// Grid lines in plots.
    pub grid: Color32,
    /// Running text.
    pub text: Color32,
    /// Captions and units.
    pub dim_text: Color32,
    /// Background behind a selection.
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
    /// Met requirements, improvements, and actions that succeeded.
    pub good: Color32,
    /// Background for an unmet verdict and an invalid region.
    pub warning_ground: Color32,
    /// Background for a met verdict.
    pub good_ground: Color32,
    /// Text with low emphasis, such as zero values and excluded names.
    pub quiet_text: Color32,
    /// Marks with low emphasis, such as bars, locks, and check marks in boxes.
    pub quiet_mark: Color32,
    /// Colours for J at [`HEAT_COSTS`]: a single hue with increasing contrast to the background.
    pub heat: [Color32; 5],
    /// Colours for airspeeds, from the lowest to the highest; no role has these colours.
    pub airspeeds: [Color32; 5],
    /// Factor on curve widths.
    pub line_width: f32,
}

impl Palette {
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
            airspeeds: [
                hex(0x6a5ad6),
                hex(0xa35fd0),
                hex(0xd76fb8),
                hex(0xf09cb4),
                hex(0xfbd0dc),
            ],
            line_width: 1.0,
        }
    }

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
            airspeeds: [
                hex(0x3a1f7a),
                hex(0x7a2f95),
                hex(0xb04487),
                hex(0xcf6f8f),
                hex(0xdd9aa4),
            ],
            line_width: 1.0,
        }
    }

    /// Returns the standard palette for the theme of `visuals`.
    pub fn from_visuals(visuals: &Visuals) -> Self {
        if visuals.dark_mode {
            Self::dark()
        } else {
            Self::light()
        }
    }

    /// Shifts `color` towards the text colour by `amount` (0 to 1), for hovered and pressed
    /// elements.
    pub fn towards_text(&self, color: Color32, amount: f32) -> Color32 {
        color.lerp_to_gamma(self.text, amount)
    }

    /// Returns the colour for a value of J in a heat map; constant beyond the last value in
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

    /// Returns the colour for an airspeed; `step` is 0 at the lowest airspeed and 255 at the
    /// highest.
    pub fn airspeed_color(&self, step: u8) -> Color32 {
        let place = AirspeedPlace::new(step);
        let below = self.airspeeds[place.stop];
        below.lerp_to_gamma(self.airspeeds[place.stop + 1], place.part as f32)
    }

    /// Returns the colour for a name beside a curve with the colour `curve`.
    pub fn label_color(&self, curve: Color32) -> Color32 {
        self.towards_text(curve, 0.3)
    }

    /// Returns the colour for text on the accent colour.
    pub fn on_accent(&self) -> Color32 {
        if self.is_dark {
            self.background
        } else {
            self.panel
        }
    }
}

impl Palette {
    /// Returns small dim text, for notes beside a value.
    pub fn small(&self, text: impl Into<String>) -> RichText {
        RichText::new(text).size(SMALL_SIZE).color(self.dim_text)
    }

    /// Returns dim text in the usual size, for labels and explanations.
    pub fn dim(&self, text: impl Into<String>) -> RichText {
        RichText::new(text).color(self.dim_text)
    }

    /// Returns small text in the warning colour.
    pub fn small_warning(&self, text: impl Into<String>) -> RichText {
        RichText::new(text).size(SMALL_SIZE).color(self.warning)
    }
}

#[cfg(test)]
mod tests {
    use egui::Rgba;

    use super::*;

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
            // Names of excluded items and links also appear on selections; errors, in the nominal
            // colour, on panels.
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
    fn airspeeds_differ_in_lightness_from_the_slowest_to_the_fastest() {
        for palette in [Palette::dark(), Palette::light()] {
            let steps = [0, 32, 64, 96, 128, 160, 191, 224, 255];
            let lightness = steps.map(|step| luminance(palette.airspeed_color(step)));
            assert!(
                lightness.is_sorted_by(|slower, faster| slower < faster),
                "{lightness:?}"
            );
            assert_eq!(palette.airspeed_color(0), palette.airspeeds[0]);
            assert_eq!(palette.airspeed_color(255), palette.airspeeds[4]);
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
}
