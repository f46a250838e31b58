//! Marks in a panel: curves, dots, bars, areas, lines and notes, in axis units.
//!
//! | mark | shape | extends the axes | in the tables | in the legend |
//! |---|---|---|---|---|
//! | [`Curve`] | line through points | yes | yes | if it has a key |
//! | [`Dots`] | symbols with labels | yes | yes | if it has a key |
//! | [`Bars`] | vertical bars | yes | yes | yes |
//! | [`Envelope`] | area between two lines | if it has edges | yes | yes |
//! | [`Spans`] | vertical ranges, shaded | no | yes | yes |
//! | [`Intervals`] | vertical ranges, as lines | no | yes | yes |
//! | [`Brackets`] | two values at the same x | no | yes | yes |
//! | [`Strip`] | shaded range of x | no | no | yes |
//! | [`Rule`] | straight line across the panel | no | horizontal with a label | no |
//! | [`Guide`] | grid line with a label | no | no | no |
//! | [`Note`] | text | no | no | no |
//!
//! Coordinates are `[x, y]`. On a logarithmic axis they are the values themselves, not their
//! logarithms.

use std::sync::Arc;

use gdcm_model::dataset::{ConditionId, ModelId};

use super::axis::Range;
use super::drawing::{Color, Stroke};

/// A mark drawn in a panel; later marks cover earlier marks.
#[derive(Clone, Debug, PartialEq)]
pub enum Mark {
    Curve(Curve),
    Dots(Dots),
    Bars(Bars),
    Strip(Strip),
    Rule(Rule),
    Spans(Spans),
    Envelope(Envelope),
    Intervals(Intervals),
    Brackets(Brackets),
    Guide(Guide),
    Note(Note),
}

/// A line through points, in axis units.
#[derive(Clone, Debug, PartialEq)]
pub struct Curve {
    /// Name, used as a heading in the tables.
    pub name: String,
    /// Text in the legend, if any; marks with the same text share an entry.
    pub key: Option<String>,
    pub stroke: Stroke,
    pub x: Arc<[f64]>,
    /// A non-finite value leaves a gap.
    pub y: Arc<[f64]>,
}

/// Dots with a common style.
#[derive(Clone, Debug, PartialEq)]
pub struct Dots {
    /// Name, used as a heading in the tables.
    pub name: String,
    /// Text in the legend, if any; marks with the same text share an entry.
    pub key: Option<String>,
    pub shape: DotShape,
    pub color: Color,
    /// Whether the dots are filled; otherwise they are outlines.
    pub filled: bool,
    /// Diameter relative to the usual dot.
    pub size: f64,
    pub dots: Vec<Dot>,
    /// Object whose dots have rings with radius [`RING_PT`] on the screen. Labels lie outside the
    /// rings.
    pub ringed: Option<MarkId>,
}

/// Identity of the object that a dot represents, for the pointer in the window.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub enum MarkId {
    Condition(ConditionId),
    Model(ModelId),
}

/// A dot with its label.
#[derive(Clone, Debug, PartialEq)]
pub struct Dot {
    pub x: f64,
    pub y: f64,
    /// Short text beside the dot. May be empty.
    pub label: String,
    /// Object that the dot represents; `None` if the dot does not react to the pointer.
    pub id: Option<MarkId>,
}

/// Radius of the ring around the dots of [`Dots::ringed`] \[pt\].
pub const RING_PT: f64 = 4.5;

/// Symbol with which a dot is drawn.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum DotShape {
    #[default]
    Circle,
    Diamond,
    Square,
    /// A triangle on its base.
    Triangle,
    /// ×, the usual symbol for poles.
    Cross,
    Plus,
}

/// Vertical bars with a common style.
#[derive(Clone, Debug, PartialEq)]
pub struct Bars {
    /// Heading in the tables, and entry in the legend.
    pub name: String,
    pub color: Color,
    /// Width in x units.
    pub width: f64,
    /// `[x, height]`; a negative height points downwards.
    pub bars: Vec<[f64; 2]>,
    /// Lower ends, for stacked bars; missing entries are 0.
    pub feet: Vec<f64>,
    /// Offset from x, in x units, to make room for other bars at the same x.
    pub beside: f64,
}

/// A shaded range of x, over the full panel height.
#[derive(Clone, Debug, PartialEq)]
pub struct Strip {
    pub range: Range,
    pub color: Color,
    /// Entry in the legend.
    pub key: String,
}

/// Shaded vertical ranges, each at an x, such as search bounds for values.
#[derive(Clone, Debug, PartialEq)]
pub struct Spans {
    /// Heading in the tables, and entry in the legend.
    pub name: String,
    pub color: Color,
    /// Width in x units.
    pub width: f64,
    /// `[x, lower end, upper end]`.
    pub spans: Vec<[f64; 3]>,
}

/// The area between two lines over the same x, such as a tolerance about a curve.
#[derive(Clone, Debug, PartialEq)]
pub struct Envelope {
    /// Heading in the tables, and entry in the legend.
    pub name: String,
    pub color: Color,
    /// Style for both lines; `None` for a shaded area without lines. On paper, an area with lines
    /// is not shaded.
    pub edge: Option<Stroke>,
    /// `[x, lower end, upper end]`, ascending in x; a non-finite end leaves a gap.
    pub points: Vec<[f64; 3]>,
}

/// Confidence intervals, drawn as vertical lines.
#[derive(Clone, Debug, PartialEq)]
pub struct Intervals {
    /// Heading in the tables, and entry in the legend.
    pub name: String,
    pub stroke: Stroke,
    /// `[x, lower end, upper end]`.
    pub ends: Vec<[f64; 3]>,
}

/// Brackets, each between two values at the same x.
#[derive(Clone, Debug, PartialEq)]
pub struct Brackets {
    /// Heading in the tables, and entry in the legend.
    pub name: String,
    pub stroke: Stroke,
    pub brackets: Vec<Bracket>,
}

/// A bracket between two values.
#[derive(Clone, Debug, PartialEq)]
pub struct Bracket {
    pub x: f64,
    /// Both values, in either order.
    pub ends: [f64; 2],
    /// Text beside the bracket. May be empty.
    pub label: String,
}

/// A straight line across the panel.
#[derive(Clone, Debug, PartialEq)]
pub struct Rule {
    /// Axis on which `at` is a value: `Y` gives a horizontal line.
    pub along: Along,
    pub at: f64,
    pub stroke: Stroke,
    /// Text beside the line. May be empty.
    pub label: String,
}

/// A grid line with a label, such as a line of constant damping ratio.
#[derive(Clone, Debug, PartialEq)]
pub struct Guide {
    pub points: Vec<[f64; 2]>,
    /// Text at the last visible point. May be empty.
    pub label: String,
}

/// A text in a panel.
#[derive(Clone, Debug, PartialEq)]
pub struct Note {
    pub at: Place,
    pub text: String,
}

/// Position of a note in its panel.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Place {
    /// Centred on a point in axis units.
    Value {
        x: f64,
        y: f64,
        /// Whether the text runs upwards.
        upright: bool,
    },
    UpperRight,
    LowerLeft,
}

/// Axis along which a coordinate is measured.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Along {
    X,
    Y,
}

macro_rules! into_mark {
    ($($kind:ident),*) => {
        $(impl From<$kind> for Mark {
            fn from(mark: $kind) -> Self {
                Mark::$kind(mark)
            }
        })*
    };
}

into_mark!(
    Curve, Dots, Bars, Strip, Rule, Spans, Envelope, Intervals, Brackets, Guide, Note
);

impl Curve {
    /// Creates a line through the points `(x[k], y[k])`, without an entry in the legend.
    pub fn new(
        name: impl Into<String>,
        stroke: Stroke,
        x: impl Into<Arc<[f64]>>,
        y: impl Into<Arc<[f64]>>,
    ) -> Self {
        Self {
            name: name.into(),
            key: None,
            stroke,
            x: x.into(),
            y: y.into(),
        }
    }

    /// Creates a line through `[x, y]` points, without an entry in the legend.
    pub fn through(
        name: impl Into<String>,
        stroke: Stroke,
        points: impl IntoIterator<Item = [f64; 2]>,
    ) -> Self {
        let mut x = Vec::new();
        let mut y = Vec::new();
        for [point_x, point_y] in points {
            x.push(point_x);
            y.push(point_y);
        }
        Self::new(name, stroke, x, y)
    }

    /// Returns the curve with an entry in the legend.
    pub fn key(self, key: impl Into<String>) -> Self {
        Self {
            key: Some(key.into()),
            ..self
        }
    }

    /// Iterates over the points `[x, y]`; a non-finite y marks a gap.
    pub fn points(&self) -> impl Iterator<Item = [f64; 2]> + '_ {
        self.x.iter().zip(self.y.iter()).map(|(x, y)| [*x, *y])
    }
}

impl Dots {
    /// Creates an empty group with this style: filled dots in the usual size, without an entry in
    /// the legend.
    pub fn new(name: impl Into<String>, shape: DotShape, color: Color) -> Self {
        Self {
            name: name.into(),
            key: None,
            shape,
            color,
            filled: true,
            size: 1.0,
            dots: Vec::new(),
            ringed: None,
        }
    }

    /// Returns the dots with an entry in the legend.
    pub fn key(self, key: impl Into<String>) -> Self {
        Self {
            key: Some(key.into()),
            ..self
        }
    }

    /// Returns the dots, filled or as outlines as requested.
    pub fn filled(self, filled: bool) -> Self {
        Self { filled, ..self }
    }

    /// Returns the group with another dot, which does not react to the pointer.
    pub fn dot(mut self, x: f64, y: f64, label: impl Into<String>) -> Self {
        self.dots.push(Dot {
            x,
            y,
            label: label.into(),
            id: None,
        });
        self
    }
}

impl Envelope {
    /// Returns the lower and the upper line; empty for an area without lines.
    pub(super) fn edges(&self) -> Vec<Curve> {
        match self.edge {
            Some(stroke) => vec![self.edge_curve(stroke, 1), self.edge_curve(stroke, 2)],
            None => Vec::new(),
        }
    }

    /// Returns the line through the lower ends (`end` = 1) or the upper ends (`end` = 2).
    fn edge_curve(&self, stroke: Stroke, end: usize) -> Curve {
        let points = self.points.iter().map(|point| [point[0], point[end]]);
        Curve::through(&self.name, stroke, points)
    }
}

impl Bars {
    /// Iterates over the bars' lower and upper ends; a stacked bar starts at its foot.
    pub(super) fn ends(&self) -> impl Iterator<Item = [f64; 2]> + '_ {
        let feet = self.feet.iter().copied().chain(std::iter::repeat(0.0));
        self.bars
            .iter()
            .zip(feet)
            .map(|([_, value], foot)| [foot, foot + value])
    }
}

impl Rule {
    /// Creates an unlabelled horizontal line at `y`.
    pub fn horizontal(y: f64, stroke: Stroke) -> Self {
        Self {
            along: Along::Y,
            at: y,
            stroke,
            label: String::new(),
        }
    }

    /// Creates an unlabelled vertical line at `x`.
    pub fn vertical(x: f64, stroke: Stroke) -> Self {
        Self {
            along: Along::X,
            at: x,
            stroke,
            label: String::new(),
        }
    }

    /// Returns the line with a text beside it.
    pub fn label(self, label: impl Into<String>) -> Self {
        Self {
            label: label.into(),
            ..self
        }
    }
}

impl Along {
    /// Returns a point's coordinate along this axis.
    fn coordinate(self, [x, y]: [f64; 2]) -> f64 {
        match self {
            Self::X => x,
            Self::Y => y,
        }
    }
}

impl Mark {
    /// Returns the values that the axis must include to show this mark; empty for marks that do not
    /// extend the axes. The axis ignores non-finite values.
    pub(super) fn values(&self, along: Along) -> Vec<f64> {
        match self {
            Mark::Curve(curve) => curve
                .points()
                .filter(|[x, y]| x.is_finite() && y.is_finite())
                .map(|point| along.coordinate(point))
                .collect(),
            Mark::Dots(dots) => dots
                .dots
                .iter()
                .map(|dot| along.coordinate([dot.x, dot.y]))
                .collect(),
            Mark::Bars(bars) => match along {
                Along::X => bars.bars.iter().map(|[x, _]| *x).collect(),
                Along::Y => bars.ends().flatten().chain([0.0]).collect(),
            },
            Mark::Envelope(envelope) if envelope.edge.is_some() => envelope
                .points
                .iter()
                .flat_map(|&[x, low, high]| [[x, low], [x, high]])
                .map(|point| along.coordinate(point))
                .collect(),
            _ => Vec::new(),
        }
    }
}
