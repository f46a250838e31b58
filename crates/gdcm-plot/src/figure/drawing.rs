//! A figure laid out on paper: shapes and texts at their positions, identical in every file format.

use super::thinning::{Pixel, thinned};

/// Points \[pt\] in a millimetre.
pub const PT_PER_MM: f64 = 72.0 / 25.4;

/// A drawing on white paper, in points from the upper left corner, y downwards.
#[derive(Clone, Debug, PartialEq)]
pub struct Drawing {
    /// Title in the metadata of the file.
    pub title: String,
    /// Width and height \[pt\].
    pub size: [f64; 2],
    /// In drawing order: later shapes cover earlier ones.
    pub shapes: Vec<Shape>,
}

/// A shape of a drawing: a path, a text, or a clipped group of shapes.
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
    /// Part of the text that is placed at `at`.
    pub anchor: Anchor,
    /// Whether the text runs upwards.
    pub upright: bool,
    pub color: Color,
}

/// Part of a text that is placed at its position.
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

/// An axis-aligned rectangle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Area {
    pub left: f64,
    pub top: f64,
    pub width: f64,
    pub height: f64,
}

impl Area {
    /// Creates a rectangle from its upper left corner, width and height.
    pub fn new(left: f64, top: f64, width: f64, height: f64) -> Self {
        Self {
            left,
            top,
            width,
            height,
        }
    }

    /// Returns the coordinate of the right edge, `left + width`.
    pub fn right(&self) -> f64 {
        self.left + self.width
    }

    /// Returns the coordinate of the lower edge, `top + height`.
    pub fn bottom(&self) -> f64 {
        self.top + self.height
    }

    /// Returns the point at `x` widths from the left edge and `y` heights from the lower edge.
    pub fn at(&self, x: f64, y: f64) -> [f64; 2] {
        [self.left + x * self.width, self.bottom() - y * self.height]
    }

    /// Returns the four corners, clockwise from the upper left corner.
    pub fn corners(&self) -> [[f64; 2]; 4] {
        [
            [self.left, self.top],
            [self.right(), self.top],
            [self.right(), self.bottom()],
            [self.left, self.bottom()],
        ]
    }

    /// Returns whether a point lies in the rectangle, edges included.
    pub fn contains(&self, [x, y]: [f64; 2]) -> bool {
        (self.left..=self.right()).contains(&x) && (self.top..=self.bottom()).contains(&y)
    }

    /// Returns the area, width times height.
    pub fn size(&self) -> f64 {
        self.width * self.height
    }

    /// Returns the rectangle enlarged by `by` on every side.
    pub fn expanded(&self, by: f64) -> Self {
        Self::new(
            self.left - by,
            self.top - by,
            self.width + 2.0 * by,
            self.height + 2.0 * by,
        )
    }

    /// Returns the distance from a point to the rectangle; 0 inside.
    pub fn distance(&self, [x, y]: [f64; 2]) -> f64 {
        let dx = outside_distance(x, self.left, self.right());
        let dy = outside_distance(y, self.top, self.bottom());
        dx.hypot(dy)
    }

    /// Returns the area common to both rectangles; 0 if they do not overlap.
    pub fn overlap(&self, other: &Self) -> f64 {
        let width = self.right().min(other.right()) - self.left.max(other.left);
        let height = self.bottom().min(other.bottom()) - self.top.max(other.top);
        width.max(0.0) * height.max(0.0)
    }
}

/// Returns the distance from a value to the interval between `low` and `high`; 0 inside.
fn outside_distance(value: f64, low: f64, high: f64) -> f64 {
    (low - value).max(value - high).max(0.0)
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

/// Meaning of a colour. Paper and each theme of the window assign a different colour to it.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Hue {
    /// Paper, and plot backgrounds in the window.
    Background,
    Grid,
    /// Titles and primary text.
    Text,
    /// Labels, frames and secondary text.
    DimText,
    /// The nominal physics model.
    Nominal,
    /// The other physics models.
    Perturbed,
    /// Models identified from flight.
    Identified,
    /// Corrected models and the schedule.
    Corrected,
    /// Excluded models and conditions.
    Rejected,
    /// The band of comparison, and highlights.
    Accent,
    /// Cautions and deteriorations.
    Warning,
    /// Proofs of optimality, and improvements.
    Good,
    /// Airspeed, from 0 in the colour of perturbed models to 255 in the colour of identified
    /// models; distinguishable by colour-blind readers.
    OfAirspeed(u8),
}

impl Hue {
    /// Returns red, green and blue on paper (sRGB): the light theme's colours on white.
    pub fn on_paper(self) -> [u8; 3] {
        let rgb: u32 = match self {
            Self::Background => 0xffffff,
            Self::Grid => 0xdfe2e7,
            Self::Text => 0x22262e,
            Self::DimText => 0x586070,
            Self::Nominal => 0xc62f2f,
            Self::Perturbed => 0x3566c8,
            Self::Identified => 0xb57a00,
            Self::Corrected => 0x1d8a47,
            Self::Rejected => 0x646c79,
            Self::Accent => 0x1b67a6,
            Self::Warning => 0xa9410a,
            Self::Good => 0x187049,
            Self::OfAirspeed(step) => {
                return mixed(
                    Self::Perturbed.on_paper(),
                    Self::Identified.on_paper(),
                    f64::from(step) / 255.0,
                );
            }
        };
        [(rgb >> 16) as u8, (rgb >> 8) as u8, rgb as u8]
    }
}

/// Interpolates linearly between two colours: `part` = 0 gives `from`, `part` = 1 gives `to`.
fn mixed(from: [u8; 3], to: [u8; 3], part: f64) -> [u8; 3] {
    let mut mixed = [0; 3];
    for (channel, mixed) in mixed.iter_mut().enumerate() {
        let start = f64::from(from[channel]);
        let end = f64::from(to[channel]);
        *mixed = (start + part * (end - start)).round() as u8;
    }
    mixed
}

/// A colour, given by its meaning and strength.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct Color {
    pub hue: Hue,
    /// Strength \[%\]: 100 is the full colour, 0 the background.
    pub percent: u8,
}

impl Color {
    /// Background colour of paper.
    pub const WHITE: Self = Self::new(Hue::Background);
    /// Colour of titles and primary text.
    pub const INK: Self = Self::new(Hue::Text);
    /// Colour of labels, frames and secondary text.
    pub const DIM: Self = Self::new(Hue::DimText);
    /// Colour of grid lines.
    pub const GRID: Self = Self::new(Hue::Grid);

    /// Creates a colour at full strength.
    pub const fn new(hue: Hue) -> Self {
        Self { hue, percent: 100 }
    }

    /// Returns this colour blended with the background to a strength of `percent`.
    pub const fn tint(self, percent: u8) -> Self {
        Self { percent, ..self }
    }

    /// Returns red, green and blue on paper (sRGB), blended to the strength of this colour.
    pub fn rgb(self) -> [u8; 3] {
        mixed(
            Hue::Background.on_paper(),
            self.hue.on_paper(),
            f64::from(self.percent.min(100)) / 100.0,
        )
    }
}

/// Dash pattern, which distinguishes lines without colour.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Dash {
    #[default]
    Solid,
    Long,
    Short,
    Dotted,
    /// Dashes with a dot between them.
    DashDot,
    /// Short dashes with a dot between them.
    ShortDashDot,
}

impl Dash {
    /// Returns dash and gap lengths alternately \[pt\]; empty for a solid line.
    pub fn pattern_pt(self) -> &'static [f64] {
        match self {
            Self::Solid => &[],
            Self::Long => &[7.0, 2.0],
            Self::Short => &[3.0, 1.6],
            Self::Dotted => &[0.9, 1.7],
            Self::DashDot => &[6.0, 1.8, 1.2, 1.8],
            Self::ShortDashDot => &[3.0, 1.5, 1.0, 1.5],
        }
    }
}

/// Line style: colour, width and dashes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Stroke {
    pub color: Color,
    pub width_pt: f64,
    pub dash: Dash,
}

impl Stroke {
    /// Creates the style of a solid line.
    pub const fn solid(color: Color, width_pt: f64) -> Self {
        Self {
            color,
            width_pt,
            dash: Dash::Solid,
        }
    }

    /// Creates the style of a dashed line.
    pub const fn dashed(color: Color, width_pt: f64, dash: Dash) -> Self {
        Self {
            color,
            width_pt,
            dash,
        }
    }

    /// Returns this line as printed: thinner than in the window, because paper resolves more.
    pub fn printed(self) -> Self {
        Self {
            width_pt: Self::PRINTED * self.width_pt,
            ..self
        }
    }

    /// Line width on paper, relative to the width in the window.
    const PRINTED: f64 = 0.55;
}

impl Drawing {
    /// Returns the drawing with fewer points; every omitted point lies within `tolerance_pt` of the
    /// remaining line.
    pub fn thinned(self, tolerance_pt: f64) -> Self {
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_tint_lies_between_the_colour_and_white() {
        let color = Color::new(Hue::Nominal);
        assert_eq!(color.rgb(), [0xc6, 0x2f, 0x2f]);
        assert_eq!(color.tint(0).rgb(), [255, 255, 255]);
        assert_eq!(color.tint(50).rgb(), [227, 151, 151]);
    }
}
