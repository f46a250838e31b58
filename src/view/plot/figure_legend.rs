//! What the marks of a figure stand for, in one line above its plots.

use egui::{Sense, Ui, pos2, vec2};
use gdcm_files::figure::{Figure, Sample, dot_shapes};

use super::canvas::Canvas;
use crate::view::palette::Palette;

/// Size of a sample \[pt\].
const SAMPLE: egui::Vec2 = vec2(18.0, 14.0);

/// A sample and a name for each key among the marks of a figure, as the legend on paper has them.
pub fn figure_legend_ui(ui: &mut Ui, figure: &Figure, palette: &Palette) {
    ui.horizontal_wrapped(|ui| {
        ui.spacing_mut().item_spacing = vec2(4.0, 0.0);
        for entry in figure.legend() {
            let (rect, _) = ui.allocate_exact_size(SAMPLE, Sense::hover());
            match entry.sample {
                Sample::Dot { shape, color, filled } => {
                    let canvas = Canvas { painter: ui.painter(), origin: rect.center(), palette };
                    canvas.paint(&dot_shapes([0.0, 0.0], (shape, 1.0), color, filled));
                }
                Sample::Line(stroke) => {
                    let ends = [rect.left(), rect.right()].map(|x| pos2(x, rect.center().y));
                    let mut shapes = Vec::new();
                    palette.curve_style(stroke).in_miniature().add_shapes(ends.to_vec(), &mut shapes);
                    ui.painter().extend(shapes);
                }
                Sample::Ground(color) => drop(ui.painter().rect_filled(rect.shrink(2.0), 2.0, palette.color(color))),
            }
            ui.label(palette.small(entry.text));
            ui.add_space(10.0);
        }
    });
}
