//! A figure laid out on paper: shapes and texts at their places, which every file format takes over as they are.

use super::thinning::{Pixel, thinned};

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
        Self {
            left,
            top,
            width,
            height,
        }
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
        [
            [self.left, self.top],
            [self.right(), self.top],
            [self.right(), self.bottom()],
            [self.left, self.bottom()],
        ]
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
        Self::new(
            self.left - by,
            self.top - by,
            self.width + 2.0 * by,
            self.height + 2.0 * by,
        )
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
        Self::Path {
            points: points.into(),
            closed: false,
            fill: None,
            stroke: Some(stroke),
        }
    }

    /// A rectangle.
    pub fn rectangle(area: Area, fill: Option<Color>, stroke: Option<Stroke>) -> Self {
        Self::Path {
            points: area.corners().to_vec(),
            closed: true,
            fill,
            stroke,
        }
    }
}

/// What a colour means: the same in the themes of the window and on paper, each of which has a colour of its own for it.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Hue {
    /// Paper, and the ground of the plots of the window.
    Background,
    /// Grid lines.
    Grid,
    /// Titles and what is read first.
    Text,
    /// Labels, frames, and what is read second.
    DimText,
    /// The nominal physics model.
    Nominal,
    /// The other physics models.
    Perturbed,
    /// Models identified from flight.
    Identified,
    /// Corrected models, and the schedule.
    Corrected,
    /// What is left out.
    Rejected,
    /// The band of comparison, and what was looked through.
    Accent,
    /// Cautions, and what got worse.
    Warning,
    /// Proofs, and what got better.
    Good,
    /// From that of perturbed models, 0, to that of identified ones, 255, as in scales made for colour-blind eyes.
    OfAirspeed(u8),
}

impl Hue {
    /// Red, green and blue on paper (sRGB): those of the light theme, on white.
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

/// The colour that is this part of the way to another one.
fn mixed(from: [u8; 3], to: [u8; 3], part: f64) -> [u8; 3] {
    let mix = |from: u8, to: u8| {
        (f64::from(from) + part * (f64::from(to) - f64::from(from))).round() as u8
    };
    std::array::from_fn(|at| mix(from[at], to[at]))
}

/// A colour by what it means, and how strong it is.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct Color {
    /// What it means.
    pub hue: Hue,
    /// How strong it is \[%\]: 100 as it is, 0 the background.
    pub percent: u8,
}

impl Color {
    /// Paper.
    pub const WHITE: Self = Self::of(Hue::Background);
    /// Titles and what is read first.
    pub const INK: Self = Self::of(Hue::Text);
    /// Labels, frames, and what is read second.
    pub const DIM: Self = Self::of(Hue::DimText);
    /// Grid lines.
    pub const GRID: Self = Self::of(Hue::Grid);

    /// A hue as it is.
    pub const fn of(hue: Hue) -> Self {
        Self { hue, percent: 100 }
    }

    /// This colour thinned with the background.
    pub const fn tint(self, percent: u8) -> Self {
        Self { percent, ..self }
    }

    /// Red, green and blue on paper (sRGB).
    pub fn rgb(self) -> [u8; 3] {
        mixed(
            Hue::Background.on_paper(),
            self.hue.on_paper(),
            f64::from(self.percent.min(100)) / 100.0,
        )
    }
}

/// What parts a line consists of: tells lines apart where colours do not.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Dash {
    /// One unbroken line.
    #[default]
    Solid,
    /// Long dashes.
    Long,
    /// Short dashes.
    Short,
    /// Dots.
    Dotted,
    /// Dashes with a dot between them.
    DashDot,
    /// Short dashes with a dot between them.
    ShortDashDot,
}

impl Dash {
    /// Lengths of dashes and gaps in turn \[pt\]; none of a solid line.
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

/// Colour, width and dashes of a line.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Stroke {
    /// Colour.
    pub color: Color,
    /// Width \[pt\].
    pub width_pt: f64,
    /// Dashes.
    pub dash: Dash,
}

impl Stroke {
    /// A solid line.
    pub const fn solid(color: Color, width_pt: f64) -> Self {
        Self {
            color,
            width_pt,
            dash: Dash::Solid,
        }
    }

    /// A line of dashes.
    pub const fn dashed(color: Color, width_pt: f64, dash: Dash) -> Self {
        Self {
            color,
            width_pt,
            dash,
        }
    }

    /// This line of the window as it is printed: finer, for paper shows more.
    pub fn printed(self) -> Self {
        Self {
            width_pt: Self::PRINTED * self.width_pt,
            ..self
        }
    }

    /// Width on paper as a part of that in the window.
    const PRINTED: f64 = 0.55;
}

impl Drawing {
    /// The same drawing with fewer points: none of those left out is farther than `tolerance_pt` from its line.
    pub fn thinned(self, tolerance_pt: f64) -> Self {
        Self {
            shapes: coarser(
                self.shapes,
                Pixel {
                    width: tolerance_pt,
                    tolerance: tolerance_pt,
                },
            ),
            ..self
        }
    }
}

fn coarser(shapes: Vec<Shape>, pixel: Pixel) -> Vec<Shape> {
    let one = |shape: Shape| match shape {
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
            shapes: coarser(shapes, pixel),
        },
        other => other,
    };
    shapes.into_iter().map(one).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_tint_lies_between_the_colour_and_white() {
        let color = Color::of(Hue::Nominal);
        assert_eq!(color.rgb(), [0xc6, 0x2f, 0x2f]);
        assert_eq!(color.tint(0).rgb(), [255, 255, 255]);
        assert_eq!(color.tint(50).rgb(), [227, 151, 151]);
    }
}
