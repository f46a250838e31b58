//! A figure laid out on paper: shapes and texts at their places, which every file format takes over as they are.

use super::stroke::{Color, Stroke};

/// Points \[pt\] in a millimetre.
pub const PT_PER_MM: f64 = 72.0 / 25.4;

/// Shapes on white paper, in points from the upper left corner, y downwards.
#[derive(Clone, Debug, PartialEq)]
pub struct Drawing {
    /// What it shows, for the file's title.
    pub title: String,
    /// Width and height \[pt\].
    pub size: [f64; 2],
    /// What stands on it; later shapes cover earlier ones.
    pub shapes: Vec<Shape>,
}

/// One shape.
#[derive(Clone, Debug, PartialEq)]
pub enum Shape {
    /// Straight lines through points.
    Path {
        /// The points.
        points: Vec<[f64; 2]>,
        /// Whether the last leads back to the first.
        closed: bool,
        /// The colour within.
        fill: Option<Color>,
        /// The line.
        stroke: Option<Stroke>,
    },
    /// A circle.
    Circle {
        /// Its centre.
        center: [f64; 2],
        /// Its radius.
        radius: f64,
        /// The colour within.
        fill: Option<Color>,
        /// The line.
        stroke: Option<Stroke>,
    },
    /// A line of words.
    Text(Text),
    /// Shapes of which only what lies within an area is seen.
    Clipped {
        /// The area.
        area: Area,
        /// The shapes.
        shapes: Vec<Shape>,
    },
}

/// A line of words.
#[derive(Clone, Debug, PartialEq)]
pub struct Text {
    /// Where its base line is, at the end that the anchor says.
    pub at: [f64; 2],
    /// The words.
    pub words: String,
    /// Size of the letters \[pt\].
    pub size_pt: f64,
    /// Which end is at the place.
    pub anchor: Anchor,
    /// Whether it runs upwards.
    pub upright: bool,
    /// Colour.
    pub color: Color,
}

/// Which end of a text is at its place.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Anchor {
    /// Its start.
    Start,
    /// Its middle.
    Middle,
    /// Its end.
    End,
}

impl Anchor {
    /// The part of a text's width that lies before its place.
    pub fn before(self) -> f64 {
        match self {
            Self::Start => 0.0,
            Self::Middle => 0.5,
            Self::End => 1.0,
        }
    }
}

/// A rectangle with upright sides.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Area {
    /// Left edge.
    pub left: f64,
    /// Upper edge.
    pub top: f64,
    /// Width.
    pub width: f64,
    /// Height.
    pub height: f64,
}

impl Area {
    /// The rectangle of these edges.
    pub fn new(left: f64, top: f64, width: f64, height: f64) -> Self {
        Self { left, top, width, height }
    }

    /// Right edge.
    pub fn right(&self) -> f64 {
        self.left + self.width
    }

    /// Lower edge.
    pub fn bottom(&self) -> f64 {
        self.top + self.height
    }

    /// The point that is these parts of the way from the left and from below.
    pub fn at(&self, x: f64, y: f64) -> [f64; 2] {
        [self.left + x * self.width, self.bottom() - y * self.height]
    }

    /// The corners, from the upper left with the clock.
    pub fn corners(&self) -> [[f64; 2]; 4] {
        [[self.left, self.top], [self.right(), self.top], [self.right(), self.bottom()], [self.left, self.bottom()]]
    }

    /// Whether a point lies in it, edges included.
    pub fn contains(&self, [x, y]: [f64; 2]) -> bool {
        (self.left..=self.right()).contains(&x) && (self.top..=self.bottom()).contains(&y)
    }

    /// How large it is.
    pub fn size(&self) -> f64 {
        self.width * self.height
    }

    /// The rectangle that is larger by `by` on every side.
    pub fn expanded(&self, by: f64) -> Self {
        Self::new(self.left - by, self.top - by, self.width + 2.0 * by, self.height + 2.0 * by)
    }

    /// How far a point is from it; 0 within.
    pub fn distance(&self, [x, y]: [f64; 2]) -> f64 {
        let beyond = |value: f64, low: f64, high: f64| (low - value).max(value - high).max(0.0);
        beyond(x, self.left, self.right()).hypot(beyond(y, self.top, self.bottom()))
    }

    /// The area that both have in common, 0 where there is none.
    pub fn overlap(&self, other: &Self) -> f64 {
        let along = |a: f64, b: f64, c: f64, d: f64| (b.min(d) - a.max(c)).max(0.0);
        along(self.left, self.right(), other.left, other.right())
            * along(self.top, self.bottom(), other.top, other.bottom())
    }
}

impl Shape {
    /// A line through points.
    pub fn line(points: impl Into<Vec<[f64; 2]>>, stroke: Stroke) -> Self {
        Self::Path { points: points.into(), closed: false, fill: None, stroke: Some(stroke) }
    }

    /// A rectangle.
    pub fn rectangle(area: Area, fill: Option<Color>, stroke: Option<Stroke>) -> Self {
        Self::Path { points: area.corners().to_vec(), closed: true, fill, stroke }
    }
}
