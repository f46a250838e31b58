//! What stands about a schedule in a plot of gains: its bands, and the brackets of differences at one airspeed.

use egui::{Align2, Color32, FontId, Mesh, Painter, Pos2, Shape, Stroke, pos2};
use egui_plot::{PlotPoint, PlotTransform};

use super::range::Range;
use crate::view::palette::Palette;

/// How much fainter a band is where no condition supports it.
const FADED: f32 = 0.4;
/// Distance of a bracket from its dots, and length of its ends \[pt\].
const BRACKET: [f32; 2] = [9.0, 3.0];

/// The bands of a schedule at one place of the horizontal axis.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct GainBand {
    /// The place.
    pub x: f64,
    /// Where the schedule may lie.
    pub confidence: [f64; 2],
    /// Where another condition would fall.
    pub scatter: [f64; 2],
}

/// The difference of two conditions at one airspeed.
#[derive(Clone, Debug, PartialEq)]
pub struct Bracket {
    /// Where both stand on the horizontal axis.
    pub x: f64,
    /// Their figures.
    pub ends: [f64; 2],
    /// Times what the bundles explain: "5.4×".
    pub label: String,
    /// Whether it is more than they explain.
    pub beyond: bool,
}

/// Draws the bands; beyond their first and last place the end values hold, fainter.
pub(super) fn paint_bands(
    painter: &Painter,
    bands: &[GainBand],
    x: Range,
    transform: &PlotTransform,
    palette: &Palette,
) {
    let (Some(first), Some(last)) = (bands.first(), bands.last()) else { return };
    let ends = [GainBand { x: x.min, ..*first }, *first, *last, GainBand { x: x.max, ..*last }];
    for (of, strength) in
        [((|band: &GainBand| band.scatter) as fn(&GainBand) -> [f64; 2], 0.13), (|band| band.confidence, 0.22)]
    {
        let color = palette.corrected.gamma_multiply(strength);
        painter.add(strip(bands, of, transform, color));
        for beyond in ends.chunks(2) {
            painter.add(strip(beyond, of, transform, color.gamma_multiply(FADED)));
        }
    }
}

fn strip(bands: &[GainBand], of: fn(&GainBand) -> [f64; 2], transform: &PlotTransform, color: Color32) -> Shape {
    let mut mesh = Mesh::default();
    for (place, band) in bands.iter().enumerate() {
        for value in of(band) {
            mesh.colored_vertex(transform.position_from_point(&PlotPoint::new(band.x, value)), color);
        }
        if place > 0 {
            let corner = 2 * place as u32;
            mesh.add_triangle(corner - 2, corner - 1, corner);
            mesh.add_triangle(corner - 1, corner, corner + 1);
        }
    }
    Shape::mesh(mesh)
}

/// Draws a bracket beside its dots, with its factor where that is more than the bundles explain; pointing at a dot tells the others.
pub(super) fn paint_bracket(painter: &Painter, bracket: &Bracket, transform: &PlotTransform, palette: &Palette) {
    let [low, high] = bracket.ends.map(|value| transform.position_from_point(&PlotPoint::new(bracket.x, value)));
    let color = if bracket.beyond { palette.warning } else { palette.dim_text };
    let stroke = Stroke::new(1.0, color);
    let x = low.x - BRACKET[0];
    let end = |from: Pos2| [pos2(x, from.y), pos2(x + BRACKET[1], from.y)];
    painter.line_segment([pos2(x, low.y), pos2(x, high.y)], stroke);
    painter.line_segment(end(low), stroke);
    painter.line_segment(end(high), stroke);
    if !bracket.beyond {
        return;
    }
    let (middle, font) = (pos2(x - 2.0, 0.5 * (low.y + high.y)), FontId::proportional(9.5));
    // No room at the left edge: the factor stands below.
    if middle.x - 24.0 > painter.clip_rect().left() {
        painter.text(middle, Align2::RIGHT_CENTER, &bracket.label, font, color);
    } else {
        painter.text(pos2(x, low.y.max(high.y) + 4.0), Align2::LEFT_TOP, &bracket.label, font, color);
    }
}
