//! Legend above a figure's plots.

use egui::{Rect, Role, Sense, Ui, Vec2, pos2, vec2};

use gdcm_plot::figure::Figure;
use gdcm_plot::figure::legend::Sample;
use gdcm_plot::figure::paint::DotStyle;

use super::canvas::Canvas;
use crate::gui::widgets::controls::named;
use crate::gui::widgets::elision::text_width;
use crate::gui::widgets::painted_text::painted_text;
use crate::gui::widgets::palette::{Palette, small};

/// Size of a sample in the legend \[pt\].
const SAMPLE_SIZE: Vec2 = vec2(18.0, 14.0);

/// Line height in the legend \[pt\].
const LINE: f32 = 18.0;
/// Gap between a sample and its name \[pt\].
const NAME_GAP: f32 = 5.0;
/// Gap between two entries \[pt\].
const ENTRY_GAP: f32 = 14.0;

/// Draws a sample and a name for each entry of the printed legend. Lines break between entries.
pub fn figure_legend_ui(ui: &mut Ui, figure: &Figure, palette: &Palette) {
    ui.horizontal_wrapped(|ui| {
        ui.spacing_mut().item_spacing = vec2(ENTRY_GAP, 0.0);
        for entry in figure.legend() {
            let name_width = text_width(ui, &entry.text, small());
            let size = vec2(SAMPLE_SIZE.x + NAME_GAP + name_width, LINE);
            let (place, response) = ui.allocate_exact_size(size, Sense::hover());
            let sample = Rect::from_center_size(
                pos2(place.left() + 0.5 * SAMPLE_SIZE.x, place.center().y),
                SAMPLE_SIZE,
            );
            paint_sample(ui, sample, entry.sample, palette);
            let name_at = SAMPLE_SIZE.x + NAME_GAP;
            painted_text(ui, place, name_at, &entry.text, small(), palette.dim_text);
            named(response, Role::Label, entry.text);
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
