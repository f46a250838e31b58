//! The heading of a part of a panel.

use egui::{Align, Layout, RichText, Ui};

use super::palette::{Palette, SMALL_SIZE};

/// A dim heading on the left, a figure on the right.
pub fn heading_ui(ui: &mut Ui, palette: &Palette, title: &str, figure: &str) {
    ui.add_space(4.0);
    ui.horizontal(|ui| {
        ui.label(RichText::new(title).size(SMALL_SIZE).strong().color(palette.dim_text));
        ui.with_layout(Layout::right_to_left(Align::Center), |ui| {
            ui.label(RichText::new(figure).size(SMALL_SIZE).color(palette.dim_text));
        });
    });
}
