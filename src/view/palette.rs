//! The colours of the window, dark and light, and the egui style made of them.

use egui::epaint::Shadow;
use egui::style::{HandleShape, ScrollStyle, Selection, WidgetVisuals, Widgets};
use egui::{
    Color32, Context, CornerRadius, FontDefinitions, FontFamily, FontId, Margin, Stroke, Style, TextStyle, Theme,
    Visuals, vec2,
};

use super::plot_style::{self, CurveColors, PlotStyle};

/// Size of running text \[pt\].
pub const BODY_SIZE: f32 = 13.0;
/// Size of secondary text: captions, tooltips, badges \[pt\].
pub const SMALL_SIZE: f32 = 11.5;

pub(super) const fn hex(rgb: u32) -> Color32 {
    Color32::from_rgb((rgb >> 16) as u8, (rgb >> 8) as u8, rgb as u8)
}

/// The design tokens of one theme: each colour has one meaning everywhere.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Palette {
    /// Whether text is light on dark.
    pub is_dark: bool,
    /// Behind the plots and inside text fields.
    pub background: Color32,
    /// Side panels and bars.
    pub panel: Color32,
    /// Buttons, legends, tooltips: what lies on a panel.
    pub raised: Color32,
    /// Separators and outlines.
    pub line: Color32,
    /// Grid lines of plots.
    pub grid: Color32,
    /// Running text.
    pub text: Color32,
    /// Captions and units.
    pub dim_text: Color32,
    /// Behind what is selected.
    pub selected: Color32,
    /// The nominal physics model.
    pub nominal: Color32,
    /// Physics models at perturbed trims, and their representative.
    pub perturbed: Color32,
    /// Models identified from flight.
    pub identified: Color32,
    /// The corrected physics model, and the schedule.
    pub corrected: Color32,
    /// Models left out.
    pub rejected: Color32,
    /// What can be acted upon: links, handles, the band.
    pub accent: Color32,
    /// Cautions, and what got worse.
    pub warning: Color32,
    /// Proofs, and what got better.
    pub good: Color32,
    /// What the widths of curves are multiplied by.
    pub line_width: f32,
}

impl Palette {
    /// The dark theme.
    pub const fn dark() -> Self {
        Self {
            is_dark: true,
            background: hex(0x17191d),
            panel: hex(0x1e2127),
            raised: hex(0x262a31),
            line: hex(0x343a44),
            grid: hex(0x2a2f37),
            text: hex(0xd7dae0),
            dim_text: hex(0xa4acb9),
            selected: hex(0x21405f),
            nominal: hex(0xef5b5b),
            perturbed: hex(0x5b8def),
            identified: hex(0xe9b949),
            corrected: hex(0x5fcf80),
            rejected: hex(0x878f9c),
            accent: hex(0x5aa9e6),
            warning: hex(0xe0a03a),
            good: hex(0x56c08c),
            line_width: 1.0,
        }
    }

    /// The light theme.
    pub const fn light() -> Self {
        Self {
            is_dark: false,
            background: hex(0xf4f5f7),
            panel: hex(0xffffff),
            raised: hex(0xeef0f3),
            line: hex(0xd4d8de),
            grid: hex(0xe7e9ed),
            text: hex(0x22262e),
            dim_text: hex(0x586070),
            selected: hex(0xd3e5f6),
            nominal: hex(0xc62f2f),
            perturbed: hex(0x3566c8),
            identified: hex(0xb57a00),
            corrected: hex(0x1d8a47),
            rejected: hex(0x646c79),
            accent: hex(0x1b67a6),
            warning: hex(0x8f5400),
            good: hex(0x187049),
            line_width: 1.0,
        }
    }

    /// The palette that goes with `visuals`.
    pub fn of(visuals: &Visuals) -> Self {
        if visuals.dark_mode { Self::dark() } else { Self::light() }
    }

    /// This palette with curves as the engineer wants them.
    pub fn with_looks(self, looks: PlotStyle) -> Self {
        let line_width = looks.line_width;
        match looks.curve_colors {
            CurveColors::Standard => Self { line_width, ..self },
            CurveColors::ForAllEyes => {
                let [nominal, perturbed, identified, corrected] = plot_style::for_all_eyes(self.is_dark);
                Self { nominal, perturbed, identified, corrected, line_width, ..self }
            }
        }
    }

    /// The palette of an egui theme.
    pub fn of_theme(theme: Theme) -> Self {
        match theme {
            Theme::Dark => Self::dark(),
            Theme::Light => Self::light(),
        }
    }

    /// `color` moved towards the text by `amount` (0 to 1): a hovered or pressed shade of it.
    pub fn towards_text(&self, color: Color32, amount: f32) -> Color32 {
        color.lerp_to_gamma(self.text, amount)
    }

    /// Text that stands on the accent colour.
    pub fn on_accent(&self) -> Color32 {
        if self.is_dark { self.background } else { self.panel }
    }

    /// The visuals made of these colours.
    pub fn visuals(&self) -> Visuals {
        let base = if self.is_dark { Visuals::dark() } else { Visuals::light() };
        let shadow = Shadow {
            offset: [0, 3],
            blur: 10,
            spread: 0,
            color: Color32::from_black_alpha(if self.is_dark { 110 } else { 40 }),
        };
        Visuals {
            widgets: self.widgets(),
            selection: Selection { bg_fill: self.selected, stroke: Stroke::new(1.0, self.text) },
            weak_text_color: Some(self.dim_text),
            hyperlink_color: self.accent,
            faint_bg_color: self.panel.lerp_to_gamma(self.raised, 0.5),
            extreme_bg_color: self.background,
            code_bg_color: self.raised,
            warn_fg_color: self.warning,
            error_fg_color: self.nominal,
            window_corner_radius: CornerRadius::same(6),
            window_shadow: shadow,
            window_fill: if self.is_dark { self.raised } else { self.panel },
            window_stroke: Stroke::new(1.0, self.line),
            menu_corner_radius: CornerRadius::same(5),
            panel_fill: self.panel,
            popup_shadow: shadow,
            indent_has_left_vline: false,
            handle_shape: HandleShape::Circle,
            slider_trailing_fill: true,
            ..base
        }
    }

    fn widgets(&self) -> Widgets {
        let widget = |weak_bg_fill, bg_fill, outline, text| WidgetVisuals {
            bg_fill,
            weak_bg_fill,
            bg_stroke: Stroke::new(1.0, outline),
            corner_radius: CornerRadius::same(4),
            fg_stroke: Stroke::new(1.0, text),
            expansion: 0.0,
        };
        let shade = |amount| self.towards_text(self.raised, amount);
        Widgets {
            noninteractive: widget(self.panel, self.panel, self.line, self.text),
            inactive: widget(self.raised, self.line, self.line, self.text),
            hovered: widget(shade(0.07), shade(0.22), shade(0.3), self.text),
            active: widget(self.selected, self.accent, self.accent, self.text),
            open: widget(shade(0.07), self.raised, self.line, self.text),
        }
    }

    /// The whole style made of these colours: small text, close spacing, thin scroll bars.
    pub fn style(&self) -> Style {
        let mut style = Style { visuals: self.visuals(), animation_time: 0.08, ..Style::default() };
        style.text_styles = [
            (TextStyle::Small, FontId::new(SMALL_SIZE, FontFamily::Proportional)),
            (TextStyle::Body, FontId::new(BODY_SIZE, FontFamily::Proportional)),
            (TextStyle::Button, FontId::new(BODY_SIZE, FontFamily::Proportional)),
            (TextStyle::Heading, FontId::new(15.0, FontFamily::Proportional)),
            (TextStyle::Monospace, FontId::new(12.0, FontFamily::Monospace)),
        ]
        .into();
        let spacing = &mut style.spacing;
        spacing.item_spacing = vec2(6.0, 4.0);
        spacing.button_padding = vec2(7.0, 2.0);
        spacing.interact_size = vec2(28.0, 20.0);
        spacing.window_margin = Margin::same(8);
        spacing.menu_margin = Margin::same(5);
        spacing.slider_rail_height = 4.0;
        spacing.icon_width = 15.0;
        spacing.icon_width_inner = 9.0;
        spacing.icon_spacing = 6.0;
        spacing.scroll = ScrollStyle { bar_width: 7.0, ..ScrollStyle::thin() };
        style
    }
}

/// egui's own fonts, where text in the proportional font finds arrows, dots and stars in the monospaced one.
pub fn fonts() -> FontDefinitions {
    let mut fonts = FontDefinitions::default();
    let monospaced = fonts.families.get(&FontFamily::Monospace).cloned().unwrap_or_default();
    let proportional = fonts.families.entry(FontFamily::Proportional).or_default();
    for name in monospaced {
        if !proportional.contains(&name) {
            proportional.push(name);
        }
    }
    fonts
}

/// Gives both of egui's themes the style of this program: switching between them is egui's own `set_theme`.
pub fn apply(ctx: &Context) {
    ctx.set_fonts(fonts());
    for theme in [Theme::Dark, Theme::Light] {
        ctx.set_style_of(theme, Palette::of_theme(theme).style());
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Relative luminance and contrast as the Web Content Accessibility Guidelines 2.2 define them.
    fn contrast(a: Color32, b: Color32) -> f32 {
        let luminance = |color: Color32| {
            let [r, g, b, _] = egui::Rgba::from(color).to_array();
            0.2126 * r + 0.7152 * g + 0.0722 * b
        };
        let (a, b) = (luminance(a), luminance(b));
        (a.max(b) + 0.05) / (a.min(b) + 0.05)
    }

    /// What the guidelines ask of text, and of lines that mean something.
    const OF_TEXT: f32 = 4.5;
    const OF_LINES: f32 = 3.0;

    #[test]
    fn text_is_readable_on_every_surface_of_both_themes() {
        for palette in [Palette::dark(), Palette::light()] {
            for surface in [palette.background, palette.panel, palette.raised, palette.selected] {
                assert!(contrast(palette.text, surface) > 6.0, "{palette:?}");
                for text in [palette.dim_text, palette.warning, palette.good] {
                    assert!(contrast(text, surface) >= OF_TEXT, "{text:?} on {surface:?} of {palette:?}");
                }
            }
            // Names of rejected models, links and errors stand on panels.
            for text in [palette.rejected, palette.accent, palette.nominal] {
                assert!(contrast(text, palette.panel) >= OF_TEXT, "{text:?} of {palette:?}");
            }
        }
    }

    #[test]
    fn curves_stand_out_from_the_background_of_both_themes() {
        for theme in [Palette::dark(), Palette::light()] {
            for curve_colors in CurveColors::ALL {
                let palette = theme.with_looks(PlotStyle { curve_colors, ..PlotStyle::default() });
                let Palette { nominal, perturbed, identified, corrected, rejected, .. } = palette;
                for color in [nominal, perturbed, identified, corrected, rejected] {
                    assert!(contrast(color, palette.background) > OF_LINES, "{color:?} of {palette:?}");
                }
            }
        }
    }

    #[test]
    fn the_symbols_of_the_window_have_glyphs() {
        let ctx = Context::default();
        apply(&ctx);
        let output = ctx.run_ui(egui::RawInput::default(), |ui| {
            let font = FontId::proportional(BODY_SIZE);
            for symbol in "→−–·°ωτΔα…●○◆◇■▲".chars() {
                assert!(ui.fonts_mut(|fonts| fonts.has_glyph(&font, symbol)), "{symbol}");
            }
        });
        output.drop_without_applying_deltas();
    }

    #[test]
    fn both_themes_of_a_context_get_their_own_style() {
        let ctx = Context::default();
        apply(&ctx);
        for theme in [Theme::Dark, Theme::Light] {
            assert_eq!(ctx.style_of(theme).visuals.panel_fill, Palette::of_theme(theme).panel);
            assert_eq!(Palette::of(&ctx.style_of(theme).visuals), Palette::of_theme(theme));
        }
    }
}
