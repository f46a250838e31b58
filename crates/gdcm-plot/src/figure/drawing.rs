//! A figure laid out on paper: shapes and texts at their positions, identical in every file format.

pub use super::area::Area;
pub use super::color::{AirspeedPlace, Color, Hue};
pub use super::stroke::{Dash, Stroke};

use super::thinning::{Pixel, thinned};

/// Points \[pt\] in a millimetre.
pub const PT_PER_MM: f64 = 72.0 / 25.4;

/// A drawing on white paper, in points from the upper left corner, y downwards.
#[derive(Clone, Debug, PartialEq)]
pub struct Drawing {
    /// Title in the file's metadata.
    pub title: String,
    /// Width and height \[pt\].
    pub size: [f64; 2],
    /// In drawing order: later shapes cover earlier ones.
    pub shapes: Vec<Shape>,
}

/// A path, a circle, a text, or a clipped group of shapes.
#[derive(Clone, Debug, PartialEq)]
pub enum Shape {
    Path {
        points: Vec<[f64; 2]>,
        /// Whether the last point connects to the first.
        closed: bool,
        fill: Option<Color>,
        stroke: Option<Stroke>,
    },
    Circle {
        center: [f64; 2],
        radius: f64,
        fill: Option<Color>,
        stroke: Option<Stroke>,
    },
    Text(Text),
    /// Shapes clipped to an area.
    Clipped {
        area: Area,
        shapes: Vec<Shape>,
    },
}

/// A line of text, with its position and style.
#[derive(Clone, Debug, PartialEq)]
pub struct Text {
    /// Position of the anchor, on the base line.
    pub at: [f64; 2],
    pub words: String,
    /// Font size \[pt\].
    pub size_pt: f64,
    /// Part of the text that lies at `at`.
    pub anchor: Anchor,
    /// Whether the text runs upwards.
    pub upright: bool,
    pub color: Color,
}

/// Part of a text that lies at its position.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Anchor {
    Start,
    Middle,
    End,
}

impl Text {
    /// Creates a horizontal text that begins at `at`, in the primary text colour.
    pub fn new(at: [f64; 2], words: impl Into<String>, size_pt: f64) -> Self {
        Self {
            at,
            words: words.into(),
            size_pt,
            anchor: Anchor::Start,
            upright: false,
            color: Color::INK,
        }
    }

    /// Returns the text with another anchor.
    pub fn anchored(self, anchor: Anchor) -> Self {
        Self { anchor, ..self }
    }

    /// Returns the text in another colour.
    pub fn colored(self, color: Color) -> Self {
        Self { color, ..self }
    }

    /// Returns the text, running upwards if `upright` is set, otherwise horizontally.
    pub fn upright(self, upright: bool) -> Self {
        Self { upright, ..self }
    }
}

impl Anchor {
    /// Returns the fraction of the text's width before the anchor, from 0 to 1.
    pub fn before(self) -> f64 {
        match self {
            Self::Start => 0.0,
            Self::Middle => 0.5,
            Self::End => 1.0,
        }
    }
}

impl Shape {
    /// Creates an open polyline without fill.
    pub fn line(points: impl Into<Vec<[f64; 2]>>, stroke: Stroke) -> Self {
        Self::Path {
            points: points.into(),
            closed: false,
            fill: None,
            stroke: Some(stroke),
        }
    }

    /// Creates a rectangular path, with optional fill and stroke.
    pub fn rectangle(area: Area, fill: Option<Color>, stroke: Option<Stroke>) -> Self {
        Self::Path {
            points: area.corners().to_vec(),
            closed: true,
            fill,
            stroke,
        }
    }
}

impl Drawing {
    /// Returns the drawing with fewer points; every omitted point lies within `tolerance_pt` of the
    /// remaining line.
    pub fn thinned(self, tolerance_pt: f64) -> Self {
        // Square, since both coordinates are lengths on paper.
        let pixel = Pixel {
            width: tolerance_pt,
            tolerance: tolerance_pt,
        };
        Self {
            shapes: thinned_shapes(self.shapes, pixel),
            ..self
        }
    }
}

/// Thins open polylines, including those in clipped areas.
fn thinned_shapes(shapes: Vec<Shape>, pixel: Pixel) -> Vec<Shape> {
    shapes
        .into_iter()
        .map(|shape| thinned_shape(shape, pixel))
        .collect()
}

fn thinned_shape(shape: Shape, pixel: Pixel) -> Shape {
    match shape {
        Shape::Path {
            points,
            closed: false,
            fill,
            stroke,
        } => Shape::Path {
            points: thinned(&points, pixel),
            closed: false,
            fill,
            stroke,
        },
        Shape::Clipped { area, shapes } => Shape::Clipped {
            area,
            shapes: thinned_shapes(shapes, pixel),
        },
        other => other,
    }
}
