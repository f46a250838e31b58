//! Dot styles and shapes on paper and on the screen.

use super::drawing::{Color, Shape, Stroke};
use super::marks::{DotShape, Dots};

/// Radius of the usual dot \[pt\].
pub(super) const DOT: f64 = 2.1;
/// Line width for an open dot, a cross or a plus in the usual size \[pt\].
const DOT_LINE: f64 = 0.9;

// Corners and line ends, relative to the radius; y runs downwards. Some corners lie outside the
// radius, so that the polygons have about the circle's area.
const DIAMOND: [[f64; 2]; 4] = [[0.0, -1.3], [1.3, 0.0], [0.0, 1.3], [-1.3, 0.0]];
const SQUARE: [[f64; 2]; 4] = [[-0.9, -0.9], [0.9, -0.9], [0.9, 0.9], [-0.9, 0.9]];
const TRIANGLE: [[f64; 2]; 3] = [[0.0, -1.3], [1.2, 0.9], [-1.2, 0.9]];
const CROSS: [[[f64; 2]; 2]; 2] = [[[-1.0, -1.0], [1.0, 1.0]], [[-1.0, 1.0], [1.0, -1.0]]];
const PLUS: [[[f64; 2]; 2]; 2] = [[[-1.3, 0.0], [1.3, 0.0]], [[0.0, -1.3], [0.0, 1.3]]];

/// Appearance of a dot.
#[derive(Clone, Copy, Debug)]
pub struct DotStyle {
    pub shape: DotShape,
    /// Size relative to the usual dot.
    pub size: f64,
    pub color: Color,
    /// Whether the dot is filled; otherwise it is an outline.
    pub filled: bool,
}

impl DotStyle {
    /// Returns the style shared by the dots in a group.
    pub fn of_group(group: &Dots) -> Self {
        Self {
            shape: group.shape,
            size: group.size,
            color: group.color,
            filled: group.filled,
        }
    }

    /// Returns the shapes for a dot at `center`; circle and polygons have about the same area.
    pub fn shapes(self, center: [f64; 2]) -> Vec<Shape> {
        match self.shape {
            DotShape::Circle => {
                let pen = self.pen();
                vec![Shape::Circle {
                    center,
                    radius: pen.radius,
                    fill: pen.fill,
                    stroke: pen.stroke,
                }]
            }
            DotShape::Diamond => vec![self.polygon(center, &DIAMOND)],
            DotShape::Square => vec![self.polygon(center, &SQUARE)],
            DotShape::Triangle => vec![self.polygon(center, &TRIANGLE)],
            DotShape::Cross => self.lines(center, CROSS),
            DotShape::Plus => self.lines(center, PLUS),
        }
    }

    /// Returns radius, fill and line for a circle or a polygon: a filled dot has no line, an open
    /// dot a white fill.
    fn pen(self) -> DotPen {
        if self.filled {
            DotPen {
                radius: self.radius(),
                fill: Some(self.color),
                stroke: None,
            }
        } else {
            // The line is centred on its path: its outer edge then coincides with a filled dot's
            // edge.
            DotPen {
                radius: self.radius() - 0.5 * self.line().width_pt,
                fill: Some(Color::WHITE),
                stroke: Some(self.line()),
            }
        }
    }

    fn radius(self) -> f64 {
        DOT * self.size
    }

    fn line(self) -> Stroke {
        Stroke::solid(self.color, DOT_LINE * self.size.sqrt())
    }

    /// Returns a polygon; `corners` are relative to the radius.
    fn polygon(self, center: [f64; 2], corners: &[[f64; 2]]) -> Shape {
        let pen = self.pen();
        Shape::Path {
            points: corners
                .iter()
                .map(|corner| moved(center, *corner, pen.radius))
                .collect(),
            closed: true,
            fill: pen.fill,
            stroke: pen.stroke,
        }
    }

    /// Returns two crossing lines; their ends are relative to the radius. They are separate shapes:
    /// a single polyline would double back on itself, and the screen cannot draw such a corner.
    fn lines(self, center: [f64; 2], lines: [[[f64; 2]; 2]; 2]) -> Vec<Shape> {
        let mut shapes = Vec::new();
        for ends in lines {
            let ends = ends.map(|end| moved(center, end, self.radius()));
            shapes.push(Shape::line(ends, self.line()));
        }
        shapes
    }
}

struct DotPen {
    radius: f64,
    fill: Option<Color>,
    stroke: Option<Stroke>,
}

/// Returns `center` moved by an offset, which is relative to `radius`.
fn moved([x, y]: [f64; 2], [dx, dy]: [f64; 2], radius: f64) -> [f64; 2] {
    [x + radius * dx, y + radius * dy]
}
