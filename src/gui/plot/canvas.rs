//! Canvas that draws printed figures' shapes on the screen, enlarged and in the theme's colours.

use egui::epaint::TextShape;
use egui::{Color32, FontId, Mesh, Painter, Pos2, Rect, Shape, Stroke, pos2, vec2};

use gdcm_plot::figure::drawing::{Area, Shape as Drawn, Stroke as Line, Text};

use crate::gui::widgets::palette::Palette;

/// Screen points per paper point; printed lines are thinner by this factor.
pub(super) const SCALE: f32 = 1.8;
/// Font size in figures \[pt on paper\]: 10.5 pt on the screen.
pub(super) const LETTERS_PT: f64 = 10.5 / SCALE as f64;

/// Number of points up to which a filled path is known to be convex.
const CONVEX_POINTS: usize = 4;

/// Screen area on which shapes are drawn.
pub(super) struct Canvas<'a> {
    pub(super) painter: &'a Painter,
    pub(super) origin: Pos2,
    pub(super) palette: &'a Palette,
}

/// Returns the size that a screen rectangle has on paper, as an area at the origin.
pub(super) fn area(rect: Rect) -> Area {
    Area::new(
        0.0,
        0.0,
        (rect.width() / SCALE).into(),
        (rect.height() / SCALE).into(),
    )
}

impl Canvas<'_> {
    /// Converts a paper position to the screen.
    pub(super) fn at(&self, [x, y]: [f64; 2]) -> Pos2 {
        self.origin + SCALE * vec2(x as f32, y as f32)
    }

    /// Converts a screen position to paper.
    pub(super) fn paper_place(&self, at: Pos2) -> [f64; 2] {
        let offset = (at - self.origin) / SCALE;
        [offset.x.into(), offset.y.into()]
    }

    /// Draws shapes in order, so that later shapes cover earlier ones.
    pub(super) fn paint(&self, shapes: &[Drawn]) {
        for shape in shapes {
            self.paint_shape(shape);
        }
    }

    /// Draws a shape. A path is: if it has a fill and more than four points, an area between two
    /// lines; else, if it has a fill and is closed, a polygon with its outline; else, if it has a
    /// stroke, a line; else nothing.
    fn paint_shape(&self, shape: &Drawn) {
        match shape {
            Drawn::Path {
                points,
                closed,
                fill,
                stroke,
            } => {
                let points: Vec<Pos2> = points.iter().map(|point| self.at(*point)).collect();
                match (fill, stroke) {
                    // Such an area need not be convex, as egui's polygons must be; shorter paths
                    // are bars, marks, or one step of an area.
                    (Some(color), _) if points.len() > CONVEX_POINTS => {
                        self.fill_between(&points, self.palette.color(*color));
                    }
                    (Some(color), stroke) if *closed => {
                        let fill = self.palette.color(*color);
                        self.polygon(points, fill, self.optional_stroke(*stroke));
                    }
                    (_, Some(line)) => self.line(points, *line),
                    _ => {}
                }
            }
            Drawn::Circle {
                center,
                radius,
                fill,
                stroke,
            } => {
                let fill = match fill {
                    Some(color) => self.palette.color(*color),
                    None => Color32::TRANSPARENT,
                };
                let radius = SCALE * *radius as f32;
                let stroke = self.optional_stroke(*stroke);
                self.painter.circle(self.at(*center), radius, fill, stroke);
            }
            Drawn::Text(text) => self.text(text),
            Drawn::Clipped { area, shapes } => {
                let [upper_left, _, lower_right, _] = area.corners().map(|corner| self.at(corner));
                let visible =
                    Rect::from_min_max(upper_left, lower_right).intersect(self.painter.clip_rect());
                let clipped = Canvas {
                    painter: &self.painter.with_clip_rect(visible),
                    ..*self
                };
                clipped.paint(shapes);
            }
        }
    }

    /// Draws a filled outline. An outline without area has no direction at its ends and is drawn as
    /// a line.
    fn polygon(&self, points: Vec<Pos2>, fill: Color32, stroke: Stroke) {
        let bounds = Rect::from_points(&points);
        if bounds.is_positive() {
            self.painter
                .add(Shape::convex_polygon(points, fill, stroke));
        } else {
            self.painter.line_segment([bounds.min, bounds.max], stroke);
        }
    }

    fn optional_stroke(&self, line: Option<Line>) -> Stroke {
        match line {
            Some(line) => self.stroke(line),
            None => Stroke::NONE,
        }
    }

    fn stroke(&self, line: Line) -> Stroke {
        Stroke::new(SCALE * line.width_pt as f32, self.palette.color(line.color))
    }

    fn line(&self, points: Vec<Pos2>, line: Line) {
        let mut shapes = Vec::new();
        let line = Line {
            width_pt: f64::from(SCALE) * line.width_pt,
            ..line
        };
        self.palette
            .curve_style(line)
            .add_shapes(points, &mut shapes);
        self.painter.extend(shapes);
    }

    /// Fills the area between two lines over the same x values; the second line is listed backwards
    /// after the first.
    fn fill_between(&self, outline: &[Pos2], color: Color32) {
        let mut mesh = Mesh::default();
        for place in 0..outline.len() / 2 {
            // Two points at the same x, one on each line, and two triangles back to the previous
            // points.
            mesh.colored_vertex(outline[place], color);
            mesh.colored_vertex(outline[outline.len() - 1 - place], color);
            if place > 0 {
                let corner = 2 * place as u32;
                mesh.add_triangle(corner - 2, corner - 1, corner);
                mesh.add_triangle(corner - 1, corner, corner + 1);
            }
        }
        self.painter.add(Shape::mesh(mesh));
    }

    fn text(&self, text: &Text) {
        let color = self.palette.color(text.color);
        let font = FontId::proportional(SCALE * text.size_pt as f32);
        let galley = self.painter.layout_no_wrap(text.words.clone(), font, color);
        // Distance from the top of the text to its base line.
        let base = match galley.rows.first().and_then(|row| row.glyphs.first()) {
            Some(glyph) => glyph.pos.y,
            None => 0.0,
        };
        let before = text.anchor.before() as f32 * galley.size().x;
        let at = self.at(text.at);
        if text.upright {
            let text = TextShape::new(pos2(at.x - base, at.y + before), galley, color);
            self.painter
                .add(text.with_angle(-std::f32::consts::FRAC_PI_2));
        } else {
            self.painter.galley(at - vec2(before, base), galley, color);
        }
    }
}
