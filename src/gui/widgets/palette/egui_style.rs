//! egui style and fonts derived from the palette.

use std::sync::Arc;

use egui::epaint::Shadow;
use egui::style::{HandleShape, ScrollStyle, Selection, WidgetVisuals, Widgets};
use egui::{
    Color32, Context, CornerRadius, FontData, FontDefinitions, FontFamily, FontId, Margin, Stroke,
    Style, TextStyle, Theme, Visuals, vec2,
};

use super::{BODY_SIZE, MEDIUM, Palette, SMALL_SIZE, TITLE_SIZE, medium};

impl Palette {
    /// Builds the egui visuals from these colours.
    pub fn visuals(&self) -> Visuals {
        let base = if self.is_dark {
            Visuals::dark()
        } else {
            Visuals::light()
        };
        let shadow = Shadow {
            offset: [0, 3],
            blur: 10,
            spread: 0,
            color: Color32::from_black_alpha(if self.is_dark { 110 } else { 40 }),
        };
        Visuals {
            widgets: self.widgets(),
            selection: Selection {
                bg_fill: self.selected,
                stroke: Stroke::new(1.0, self.text),
            },
            weak_text_color: Some(self.dim_text),
            hyperlink_color: self.accent,
            faint_bg_color: self.panel.lerp_to_gamma(self.raised, 0.5),
            extreme_bg_color: self.background,
            code_bg_color: self.raised,
            warn_fg_color: self.warning,
            error_fg_color: self.nominal,
            window_corner_radius: CornerRadius::same(8),
            window_shadow: shadow,
            window_fill: if self.is_dark {
                self.raised
            } else {
                self.panel
            },
            window_stroke: Stroke::new(1.0, self.line),
            menu_corner_radius: CornerRadius::same(6),
            panel_fill: self.panel,
            popup_shadow: shadow,
            indent_has_left_vline: false,
            handle_shape: HandleShape::Circle,
            slider_trailing_fill: true,
            ..base
        }
    }

    fn widgets(&self) -> Widgets {
        let pale = self.towards_text(self.raised, 0.07);
        let strong = self.towards_text(self.raised, 0.22);
        let outline = self.towards_text(self.raised, 0.3);
        Widgets {
            noninteractive: self.widget(self.panel, self.panel, self.line),
            inactive: self.widget(self.raised, self.line, self.line),
            hovered: self.widget(pale, strong, outline),
            // `active` also applies to focused boxes: with a fill in the accent colour they would
            // look checked.
            active: self.widget(self.selected, strong, self.accent),
            open: self.widget(pale, self.raised, self.line),
        }
    }

    /// Returns a control's style from the fill for buttons, the fill for boxes and handles, and the
    /// outline.
    fn widget(&self, weak_bg_fill: Color32, bg_fill: Color32, outline: Color32) -> WidgetVisuals {
        WidgetVisuals {
            bg_fill,
            weak_bg_fill,
            bg_stroke: Stroke::new(1.0, outline),
            corner_radius: CornerRadius::same(6),
            fg_stroke: Stroke::new(1.0, self.text),
            expansion: 0.0,
        }
    }

    /// Builds the egui style: small text, narrow spacing, thin scroll bars.
    pub fn style(&self) -> Style {
        let mut style = Style {
            visuals: self.visuals(),
            // Menus fade in over this time, and with software rendering a frame may be the last for
            // a while: a menu must be opaque from its first frame on.
            animation_time: 0.0,
            ..Style::default()
        };
        style.text_styles = [
            (
                TextStyle::Small,
                FontId::new(SMALL_SIZE, FontFamily::Proportional),
            ),
            (
                TextStyle::Body,
                FontId::new(BODY_SIZE, FontFamily::Proportional),
            ),
            (
                TextStyle::Button,
                FontId::new(BODY_SIZE, FontFamily::Proportional),
            ),
            (TextStyle::Heading, medium(TITLE_SIZE)),
            (
                TextStyle::Monospace,
                FontId::new(SMALL_SIZE, FontFamily::Monospace),
            ),
        ]
        .into();
        let spacing = &mut style.spacing;
        spacing.item_spacing = vec2(8.0, 4.0);
        spacing.button_padding = vec2(8.0, 3.0);
        spacing.interact_size = vec2(28.0, 24.0);
        spacing.window_margin = Margin::same(12);
        spacing.menu_margin = Margin::same(4);
        spacing.slider_rail_height = 4.0;
        spacing.icon_width = 15.0;
        spacing.icon_width_inner = 9.0;
        spacing.icon_spacing = 6.0;
        spacing.scroll = ScrollStyle {
            bar_width: 7.0,
            ..ScrollStyle::thin()
        };
        style
    }
}

/// Returns both font weights, each followed by egui's fonts for other scripts and rare symbols.
fn fonts() -> FontDefinitions {
    let mut fonts = FontDefinitions::default();
    let monospaced = fonts
        .families
        .get(&FontFamily::Monospace)
        .cloned()
        .unwrap_or_default();
    let others = fonts
        .families
        .get(&FontFamily::Proportional)
        .cloned()
        .unwrap_or_default();
    let cuts = [
        (
            "Inter",
            include_bytes!("../../../../assets/fonts/Inter-Regular.ttf").as_slice(),
            FontFamily::Proportional,
        ),
        (
            "Inter Medium",
            include_bytes!("../../../../assets/fonts/Inter-Medium.ttf"),
            FontFamily::Name(MEDIUM.into()),
        ),
    ];
    for (name, bytes, family) in cuts {
        fonts
            .font_data
            .insert(name.to_owned(), Arc::new(FontData::from_static(bytes)));
        let mut names = vec![name.to_owned()];
        for other in others.iter().chain(&monospaced) {
            if !names.contains(other) {
                names.push(other.clone());
            }
        }
        fonts.families.insert(family, names);
    }
    fonts
}

/// Sets this program's style for both egui themes, so that egui's `set_theme` switches between
/// them.
pub fn apply(ctx: &Context) {
    ctx.set_fonts(fonts());
    for (theme, palette) in [
        (Theme::Dark, Palette::dark()),
        (Theme::Light, Palette::light()),
    ] {
        ctx.set_style_of(theme, palette.style());
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_box_with_the_focus_is_not_filled_as_if_it_were_checked() {
        for palette in [Palette::dark(), Palette::light()] {
            let widgets = palette.widgets();
            assert_eq!(widgets.active.bg_fill, widgets.hovered.bg_fill);
            assert_ne!(widgets.active.bg_fill, palette.accent);
        }
    }

    #[test]
    fn figures_are_of_equal_width_in_both_cuts() {
        let ctx = Context::default();
        apply(&ctx);
        let output = ctx.run_ui(egui::RawInput::default(), |ui| {
            for font in [FontId::proportional(BODY_SIZE), medium(BODY_SIZE)] {
                let widths: Vec<f32> = "0123456789−+±"
                    .chars()
                    .map(|figure| ui.fonts_mut(|fonts| fonts.glyph_width(&font, figure)))
                    .collect();
                assert!(
                    widths.iter().all(|other| (other - widths[0]).abs() < 1e-3),
                    "{widths:?}"
                );
            }
        });
        output.drop_without_applying_deltas();
    }

    #[test]
    fn the_symbols_of_the_window_have_glyphs() {
        let ctx = Context::default();
        apply(&ctx);
        let output = ctx.run_ui(egui::RawInput::default(), |ui| {
            let font = FontId::proportional(BODY_SIZE);
            for symbol in "→−–·°ωτΔα…●○◆◇■▲★⚠✓±≈".chars() {
                for font in [&font, &medium(BODY_SIZE)] {
                    assert!(
                        ui.fonts_mut(|fonts| fonts.has_glyph(font, symbol)),
                        "{symbol}"
                    );
                }
            }
        });
        output.drop_without_applying_deltas();
    }

    #[test]
    fn menus_are_opaque_from_their_first_frame_on() {
        let ctx = Context::default();
        apply(&ctx);
        // The first frame measures the menu, unseen; the second shows it.
        let mut opacity = 0.0;
        for _ in 0..2 {
            let output = ctx.run_ui(egui::RawInput::default(), |ui| {
                egui::Area::new(egui::Id::unique("menu")).show(ui.ctx(), |ui| {
                    opacity = ui.opacity();
                    ui.label("entry");
                });
            });
            output.drop_without_applying_deltas();
        }
        assert_eq!(opacity, 1.0);
    }

    #[test]
    fn both_themes_of_a_context_get_their_own_style() {
        let ctx = Context::default();
        apply(&ctx);
        for (theme, palette) in [
            (Theme::Dark, Palette::dark()),
            (Theme::Light, Palette::light()),
        ] {
            assert_eq!(ctx.style_of(theme).visuals.panel_fill, palette.panel);
            assert_eq!(Palette::from_visuals(&ctx.style_of(theme).visuals), palette);
        }
    }
}
