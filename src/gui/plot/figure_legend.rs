//! Legend line above the plots of a figure.

use egui::{Rect, Sense, Ui, Vec2, vec2};

use gdcm_plot::figure::Figure;
use gdcm_plot::figure::legend::Sample;
use gdcm_plot::figure::paint::DotStyle;

use super::canvas::Canvas;
use crate::gui::widgets::palette::Palette;

/// Size of a sample in the legend \[pt\].
const SAMPLE_SIZE: Vec2 = vec2(18.0, 14.0);

/// Draws a sample and a name for each key of the figure's marks, as in the printed legend.
pub fn figure_legend_ui(ui: &mut Ui, figure: &Figure, palette: &Palette) {
    ui.horizontal_wrapped(|ui| {
        ui.spacing_mut().item_spacing = vec2(4.0, 0.0);
        for entry in figure.legend() {
            let (place, _) = ui.allocate_exact_size(SAMPLE_SIZE, Sense::hover());
            paint_sample(ui, place, entry.sample, palette);
            ui.label(palette.small(entry.text));
            ui.add_space(10.0);
        }
    });
}

fn paint_sample(ui: &Ui, place: Rect, sample: Sample, palette: &Palette) {
    match sample {
        Sample::Dot {
            shape,
            color,
            filled,
        } => {
            let canvas = Canvas {
                painter: ui.painter(),
                origin: place.center(),
                palette,
            };
            let style = DotStyle {
                shape,
                size: 1.0,
                color,
                filled,
            };
            canvas.paint(&style.shapes([0.0, 0.0]));
        }
        Sample::Line(stroke) => {
            let path = vec![place.left_center(), place.right_center()];
            let style = palette.curve_style(stroke).in_miniature();
            let mut shapes = Vec::new();
            style.add_shapes(path, &mut shapes);
            ui.painter().extend(shapes);
        }
        Sample::Ground(color) => {
            let fill = palette.color(color);
            ui.painter().rect_filled(place.shrink(2.0), 2.0, fill);
        }
    }
}
