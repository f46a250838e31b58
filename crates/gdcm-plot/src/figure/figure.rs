//! A figure: contents of a plot, independent of any screen; plots consist of panels with marks.

use std::sync::Arc;

use gdcm_model::dataset::{ConditionId, ModelId};

use super::axis::{Axis, Range};
use super::drawing::{Color, Stroke};
use super::role::{Entry, entries};

/// A figure, independent of any screen: plots side by side, a title above, a legend and a caption
/// below.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Figure {
    pub title: String,
    /// Dataset, condition and settings, as needed to read the figure. No date, so that the same
    /// analysis makes the same file.
    pub caption: String,
    /// Row by row.
    pub plots: Vec<Plot>,
    /// Maximum number of plots side by side.
    pub columns: usize,
    /// Whether all plots show the same range of their axes, with numbers on the outer ones only.
    pub shared: Shared,
    /// Height of the frames of a plot as a fraction of their width.
    pub aspect: f64,
    /// Whether plots may shrink to the limit of readability, as in a table of many.
    pub dense: bool,
}

/// Axes common to the plots of a figure.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Shared {
    pub x: bool,
    pub y: bool,
}

/// Printed width of a figure.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum ColumnWidth {
    /// One of a journal's two columns, 84 mm.
    Single,
    /// Both columns, 174 mm.
    #[default]
    Double,
}

impl ColumnWidth {
    /// Both widths.
    pub const BOTH: [Self; 2] = [Self::Single, Self::Double];

    /// Returns the width \[mm\].
    pub fn mm(self) -> f64 {
        match self {
            Self::Single => 84.0,
            Self::Double => 174.0,
        }
    }

    /// Returns its name in a command.
    pub fn name(self) -> &'static str {
        match self {
            Self::Single => "single",
            Self::Double => "double",
        }
    }

    /// Returns the width in words.
    pub fn words(self) -> &'static str {
        match self {
            Self::Single => "single column (84 mm)",
            Self::Double => "double column (174 mm)",
        }
    }
}

impl Figure {
    /// Creates a figure without plots.
    pub fn new(title: impl Into<String>) -> Self {
        Self {
            title: title.into(),
            columns: 1,
            aspect: 0.62,
            ..Self::default()
        }
    }

    /// Returns the figure with a caption.
    pub fn caption(self, caption: impl Into<String>) -> Self {
        Self {
            caption: caption.into(),
            ..self
        }
    }

    /// Returns the figure with one more plot.
    pub fn plot(mut self, plot: Plot) -> Self {
        self.plots.push(plot);
        self
    }

    /// Returns the figure with more plots.
    pub fn plots(mut self, plots: impl IntoIterator<Item = Plot>) -> Self {
        self.plots.extend(plots);
        self
    }

    /// Returns the figure with at most `columns` plots side by side.
    pub fn columns(self, columns: usize) -> Self {
        Self {
            columns: columns.max(1),
            ..self
        }
    }

    /// Returns the figure with a common horizontal axis.
    pub fn shared_x(self) -> Self {
        Self {
            shared: Shared {
                x: true,
                ..self.shared
            },
            ..self
        }
    }

    /// Returns the figure with common vertical axes.
    pub fn shared_y(self) -> Self {
        Self {
            shared: Shared {
                y: true,
                ..self.shared
            },
            ..self
        }
    }

    /// Returns the figure with the plot height set as a fraction of the plot width.
    pub fn aspect(self, aspect: f64) -> Self {
        Self { aspect, ..self }
    }

    /// Returns the figure with plots that may shrink to the limit of readability.
    pub fn dense(self) -> Self {
        Self {
            dense: true,
            ..self
        }
    }

    /// Returns the figure with the common range of shared axes fixed in each panel.
    pub fn with_ranges(mut self) -> Self {
        let common = |along| {
            self.panels()
                .map(|(_, panel)| panel.shown(along))
                .reduce(Range::union)
        };
        let x = if self.shared.x {
            common(Along::X)
        } else {
            None
        };
        let y = if self.shared.y {
            common(Along::Y)
        } else {
            None
        };
        for panel in self.plots.iter_mut().flat_map(|plot| &mut plot.panels) {
            panel.x.range = x.or(panel.x.range);
            panel.y.range = y.or(panel.y.range);
        }
        self
    }

    /// Iterates over all panels, with the titles of their plots.
    pub fn panels(&self) -> impl Iterator<Item = (&str, &Panel)> {
        self.plots
            .iter()
            .flat_map(|plot| plot.panels.iter().map(|panel| (plot.title.as_str(), panel)))
    }

    /// Returns the legend: one entry for each key among the marks.
    pub fn legend(&self) -> Vec<Entry> {
        entries(self.panels().flat_map(|(_, panel)| &panel.marks))
    }
}

/// Two axes and the marks between them.
#[derive(Clone, Debug, PartialEq)]
pub struct Panel {
    pub x: Axis,
    pub y: Axis,
    /// Later marks are drawn over earlier ones.
    pub marks: Vec<Mark>,
    /// Share of the height of its plot, relative to the other panels.
    pub weight: f64,
}

impl Panel {
    /// Creates an empty panel.
    pub fn new(x: Axis, y: Axis) -> Self {
        Self {
            x,
            y,
            marks: Vec::new(),
            weight: 1.0,
        }
    }

    /// Returns the panel with one more mark, drawn over the others.
    pub fn with(mut self, mark: impl Into<Mark>) -> Self {
        self.marks.push(mark.into());
        self
    }

    /// Returns the panel with more marks, drawn over the others.
    pub fn with_all<M: Into<Mark>>(mut self, marks: impl IntoIterator<Item = M>) -> Self {
        self.marks.extend(marks.into_iter().map(Into::into));
        self
    }

    /// Returns the panel with one more mark, drawn below all others.
    pub fn over(mut self, ground: impl Into<Mark>) -> Self {
        self.marks.insert(0, ground.into());
        self
    }

    /// Returns the panel with another height, relative to the other panels of its plot.
    pub fn weight(self, weight: f64) -> Self {
        Self { weight, ..self }
    }

    /// Iterates over the dots of the panel.
    pub fn dots(&self) -> impl Iterator<Item = &Dot> {
        self.marks
            .iter()
            .filter_map(|mark| {
                if let Mark::Dots(of) = mark {
                    Some(&of.dots)
                } else {
                    None
                }
            })
            .flatten()
    }

    /// Returns the range of an axis shown if the panel stands alone.
    pub fn shown(&self, along: Along) -> Range {
        let axis = match along {
            Along::X => &self.x,
            Along::Y => &self.y,
        };
        axis.fitted(self.marks.iter().flat_map(|mark| mark.values(along)))
    }
}

/// Vertically stacked panels with a common horizontal axis and a title.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Plot {
    /// Subject of the panels: `LON → Q`. May be empty.
    pub title: String,
    /// From top to bottom.
    pub panels: Vec<Panel>,
}

impl Plot {
    /// Creates a plot without panels.
    pub fn new(title: impl Into<String>) -> Self {
        Self {
            title: title.into(),
            panels: Vec::new(),
        }
    }

    /// Returns the plot with one more panel below.
    pub fn panel(mut self, panel: Panel) -> Self {
        self.panels.push(panel);
        self
    }
}

/// File format of a figure.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum FigureFormat {
    /// Vector graphics, for documents and drawing programs.
    Svg,
    /// Pixels, 300 dpi.
    Png,
    /// A page as large as the figure, with embedded fonts.
    Pdf,
    /// The numbers.
    Csv,
}

impl FigureFormat {
    /// Every format.
    pub const ALL: [Self; 4] = [Self::Svg, Self::Png, Self::Pdf, Self::Csv];

    /// Returns the extension of a file name.
    pub fn extension(self) -> &'static str {
        match self {
            Self::Svg => "svg",
            Self::Png => "png",
            Self::Pdf => "pdf",
            Self::Csv => "csv",
        }
    }

    /// Returns its name and its use.
    pub fn words(self) -> &'static str {
        match self {
            Self::Svg => "SVG, for documents and drawing programs",
            Self::Png => "PNG, 300 dots to the inch",
            Self::Pdf => "PDF, one page",
            Self::Csv => "CSV, the numbers",
        }
    }
}

/// Contents of a panel; later marks are drawn over earlier ones.
#[derive(Clone, Debug, PartialEq)]
pub enum Mark {
    Curve(Curve),
    Dots(Dots),
    Bars(Bars),
    /// A shaded range of the horizontal axis.
    Band(Band),
    /// A line across the panel at a value.
    Rule(Rule),
    /// Shaded ranges of the vertical axis, at given places.
    Spans(Spans),
    /// The area between two lines.
    Envelope(Envelope),
    /// Confidence intervals.
    Intervals(Intervals),
    /// Pairs of different values.
    Brackets(Brackets),
    /// A line that helps to read values and carries none itself.
    Guide(Guide),
    /// Text at a place.
    Note(Note),
}

/// A line through points.
#[derive(Clone, Debug, PartialEq)]
pub struct Curve {
    /// Subject, used as the heading of its column of numbers.
    pub name: String,
    /// Its entry in the legend, if any; equal entries are merged.
    pub key: Option<String>,
    pub stroke: Stroke,
    /// x values of its points.
    pub x: Arc<[f64]>,
    /// y values; a value that is not finite leaves a gap.
    pub y: Arc<[f64]>,
}

/// Dots that belong together.
#[derive(Clone, Debug, PartialEq)]
pub struct Dots {
    /// Subject, used as the heading of their numbers.
    pub name: String,
    /// Their entry in the legend, if any; equal entries are merged.
    pub key: Option<String>,
    pub shape: DotShape,
    pub color: Color,
    pub filled: bool,
    pub size: f64,
    pub dots: Vec<Dot>,
}

/// Identity of a mark's subject, by which a window recognises the mark under the pointer.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub enum MarkId {
    Condition(ConditionId),
    Model(ModelId),
}

/// A dot with its text and subject.
#[derive(Clone, Debug, PartialEq)]
pub struct Dot {
    pub x: f64,
    pub y: f64,
    /// The short text beside it. May be empty.
    pub label: String,
    /// Its subject, if it can be pointed at.
    pub id: Option<MarkId>,
}

/// Shape of a dot.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum DotShape {
    #[default]
    Circle,
    Diamond,
    Square,
    /// A triangle pointing sideways.
    Triangle,
    /// ×, as poles are drawn.
    Cross,
    /// +.
    Plus,
}

/// Bars that belong together.
#[derive(Clone, Debug, PartialEq)]
pub struct Bars {
    /// Heading of their numbers and entry in the legend.
    pub name: String,
    pub color: Color,
    /// Width in units of x.
    pub width: f64,
    /// x position and value of each bar.
    pub bars: Vec<[f64; 2]>,
    /// Lower end of each bar, for stacking; 0 without it.
    pub feet: Vec<f64>,
    /// Offset of the bars from their x position, to make room for others, in units of x.
    pub beside: f64,
}

/// A shaded range of the horizontal axis.
#[derive(Clone, Debug, PartialEq)]
pub struct Band {
    pub range: Range,
    pub color: Color,
    /// Its entry in the legend.
    pub key: String,
}

/// Shaded ranges of the vertical axis, one at each place: the search range of a value. They do not
/// extend the axis range.
#[derive(Clone, Debug, PartialEq)]
pub struct Spans {
    /// Heading of their numbers and entry in the legend.
    pub name: String,
    pub color: Color,
    /// Width in units of x.
    pub width: f64,
    /// x position, lower end and upper end of each.
    pub spans: Vec<[f64; 3]>,
}

/// The area between two lines over the same places: tolerance of a curve. It extends the axis range
/// only if it has edges.
#[derive(Clone, Debug, PartialEq)]
pub struct Envelope {
    /// Heading of its numbers and entry in the legend.
    pub name: String,
    pub color: Color,
    /// Style of its edges; on paper, the area between visible edges stays white.
    pub edge: Option<Stroke>,
    /// x position (ascending), lower end and upper end; a value that is not finite leaves a gap.
    pub points: Vec<[f64; 3]>,
}

/// Confidence intervals: a vertical line at each place. They do not extend the axis range.
#[derive(Clone, Debug, PartialEq)]
pub struct Intervals {
    /// Heading of their numbers and entry in the legend.
    pub name: String,
    pub stroke: Stroke,
    /// x position, lower end and upper end of each.
    pub ends: Vec<[f64; 3]>,
}

/// Pairs of different values at the same place: a bracket at each. They do not extend the axis
/// range.
#[derive(Clone, Debug, PartialEq)]
pub struct Brackets {
    /// Heading of their numbers and entry in the legend.
    pub name: String,
    pub stroke: Stroke,
    pub brackets: Vec<Bracket>,
}

/// A bracket between two values.
#[derive(Clone, Debug, PartialEq)]
pub struct Bracket {
    /// x position of both values.
    pub x: f64,
    pub ends: [f64; 2],
    /// The text beside it. May be empty.
    pub label: String,
}

/// A line across the panel at a value.
#[derive(Clone, Debug, PartialEq)]
pub struct Rule {
    /// The axis of the value: a value along y makes a horizontal line.
    pub along: Along,
    pub at: f64,
    pub stroke: Stroke,
    /// The text beside it. May be empty.
    pub label: String,
}

/// A line that helps to read values, such as a line of constant damping ratio: it does not extend
/// the axis range and has no numbers.
#[derive(Clone, Debug, PartialEq)]
pub struct Guide {
    pub points: Vec<[f64; 2]>,
    /// The text at its end. May be empty.
    pub label: String,
}

/// Text at a place.
#[derive(Clone, Debug, PartialEq)]
pub struct Note {
    /// In the units of the panel, or in a corner of the panel.
    pub at: Place,
    pub text: String,
}

/// A place in a panel.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Place {
    /// In the units of the axes; the text is centred about it, vertical if `upright`.
    Value {
        x: f64,
        y: f64,
        /// Whether the text runs upwards.
        upright: bool,
    },
    UpperRight,
    LowerLeft,
}

/// One of the two axes.
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
    Curve, Dots, Bars, Band, Rule, Spans, Envelope, Intervals, Brackets, Guide, Note
);

impl Curve {
    /// Creates a line through the points `x[k]`, `y[k]`.
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

    /// Creates a line through these points.
    pub fn through(
        name: impl Into<String>,
        stroke: Stroke,
        points: impl IntoIterator<Item = [f64; 2]>,
    ) -> Self {
        let (x, y): (Vec<f64>, Vec<f64>) = points.into_iter().map(|[x, y]| (x, y)).unzip();
        Self::new(name, stroke, x, y)
    }

    /// Returns the curve with an entry in the legend.
    pub fn key(self, key: impl Into<String>) -> Self {
        Self {
            key: Some(key.into()),
            ..self
        }
    }

    /// Iterates over its points.
    pub fn points(&self) -> impl Iterator<Item = [f64; 2]> + '_ {
        self.x.iter().zip(self.y.iter()).map(|(x, y)| [*x, *y])
    }
}

impl Dots {
    /// Creates an empty group of dots with this style.
    pub fn new(name: impl Into<String>, shape: DotShape, color: Color) -> Self {
        Self {
            name: name.into(),
            key: None,
            shape,
            color,
            filled: true,
            size: 1.0,
            dots: Vec::new(),
        }
    }

    /// Returns the dots with an entry in the legend.
    pub fn key(self, key: impl Into<String>) -> Self {
        Self {
            key: Some(key.into()),
            ..self
        }
    }

    /// Returns the dots, filled or open.
    pub fn filled(self, filled: bool) -> Self {
        Self { filled, ..self }
    }

    /// Returns the dots with one more.
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
    /// Returns its lower and upper edges as curves, if they are drawn.
    pub(super) fn edges(&self) -> impl Iterator<Item = Curve> + '_ {
        let edge = |stroke: Stroke, at: usize| {
            Curve::through(
                &self.name,
                stroke,
                self.points.iter().map(|point| [point[0], point[at]]),
            )
        };
        self.edge
            .into_iter()
            .flat_map(move |stroke| [edge(stroke, 1), edge(stroke, 2)])
    }
}

impl Bars {
    /// Iterates over the lower and upper ends of the bars.
    pub(super) fn ends(&self) -> impl Iterator<Item = [f64; 2]> + '_ {
        let feet = self.feet.iter().copied().chain(std::iter::repeat(0.0));
        self.bars
            .iter()
            .zip(feet)
            .map(|([_, value], foot)| [foot, foot + value])
    }
}

impl Rule {
    /// Creates a horizontal line at the value `y`.
    pub fn horizontal(y: f64, stroke: Stroke) -> Self {
        Self {
            along: Along::Y,
            at: y,
            stroke,
            label: String::new(),
        }
    }

    /// Creates a vertical line at the value `x`.
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

impl Mark {
    /// Returns the values along an axis that a panel must show for this mark.
    pub(super) fn values(&self, along: Along) -> Vec<f64> {
        let pick = |[x, y]: [f64; 2]| if along == Along::X { x } else { y };
        match self {
            Mark::Curve(curve) => curve
                .points()
                .filter(|point| point.iter().all(|c| c.is_finite()))
                .map(pick)
                .collect(),
            Mark::Dots(dots) => dots.dots.iter().map(|dot| pick([dot.x, dot.y])).collect(),
            Mark::Bars(bars) if along == Along::Y => bars.ends().flatten().chain([0.0]).collect(),
            Mark::Bars(bars) => bars.bars.iter().map(|bar| bar[0]).collect(),
            Mark::Envelope(of) if of.edge.is_some() => of
                .points
                .iter()
                .flat_map(|&[x, low, high]| [pick([x, low]), pick([x, high])])
                .collect(),
            _ => Vec::new(),
        }
    }
}
