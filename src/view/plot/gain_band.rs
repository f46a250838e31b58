//! What stands about a schedule in a plot of gains: its bands, and the brackets of differences at one airspeed.

use egui::{Color32, Mesh, Painter, Pos2, Shape, Stroke, pos2, vec2};
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

impl Bracket {
    /// The ends of its upright line on the screen: at the left of its dots, or at their right where there is no room.
    pub(super) fn spine(&self, transform: &PlotTransform) -> [Pos2; 2] {
        let ends = self.ends.map(|value| transform.position_from_point(&PlotPoint::new(self.x, value)));
        let x = ends[0].x - BRACKET[0];
        let x = if x > transform.frame().left() + 1.0 { x } else { ends[0].x + BRACKET[0] };
        ends.map(|end| pos2(x, end.y))
    }

    /// Draws it; its factor stands among the numbers of the dots where it is more than the bundles explain, and pointing at a dot tells
    /// the others.
    pub(super) fn paint(&self, painter: &Painter, transform: &PlotTransform, palette: &Palette) {
        let color = if self.beyond { palette.warning } else { palette.dim_text };
        let stroke = Stroke::new(1.0, color);
        let [from, to] = self.spine(transform);
        let dots = transform.position_from_point_x(self.x);
        let hook = vec2(BRACKET[1] * (dots - from.x).signum(), 0.0);
        painter.line_segment([from, to], stroke);
        for end in [from, to] {
            painter.line_segment([end, end + hook], stroke);
        }
    }
}
