//! A figure: what a plot shows, apart from any screen; plots of panels of marks.

use std::sync::Arc;

use gdcm_model::dataset::{ConditionId, ModelId};

use super::axis::{Axis, Range};
use super::drawing::{Color, Stroke};
use super::role::{Entry, entries};

/// What a plot shows, apart from any screen: plots side by side, a title above, a legend and a caption below.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Figure {
    /// The title.
    pub title: String,
    /// What has to be known to read it: dataset, condition, settings. No date, so that the same analysis makes the same file.
    pub caption: String,
    /// The plots, row by row.
    pub plots: Vec<Plot>,
    /// The most plots side by side.
    pub columns: usize,
    /// Whether all plots show the same part of their axes, and only the outer ones have numbers.
    pub shared: Shared,
    /// Height of a plot's frames as a part of their width.
    pub aspect: f64,
    /// Whether plots may be as small as is readable at all: a table of many.
    pub dense: bool,
}

/// Which axes the plots of a figure have in common.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Shared {
    /// The horizontal axes.
    pub x: bool,
    /// The vertical axes, panel by panel.
    pub y: bool,
}

/// How wide a figure is printed.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum ColumnWidth {
    /// One column of a journal's two, 84 mm.
    Single,
    /// Both columns, 174 mm.
    #[default]
    Double,
}

impl ColumnWidth {
    /// Both widths.
    pub const BOTH: [Self; 2] = [Self::Single, Self::Double];

    /// The width \[mm\].
    pub fn mm(self) -> f64 {
        match self {
            Self::Single => 84.0,
            Self::Double => 174.0,
        }
    }

    /// Its name in a command.
    pub fn name(self) -> &'static str {
        match self {
            Self::Single => "single",
            Self::Double => "double",
        }
    }

    /// The width in words.
    pub fn words(self) -> &'static str {
        match self {
            Self::Single => "single column (84 mm)",
            Self::Double => "double column (174 mm)",
        }
    }
}

impl Figure {
    /// A figure without plots.
    pub fn new(title: impl Into<String>) -> Self {
        Self {
            title: title.into(),
            columns: 1,
            aspect: 0.62,
            ..Self::default()
        }
    }

    /// The same figure with a caption.
    pub fn caption(self, caption: impl Into<String>) -> Self {
        Self {
            caption: caption.into(),
            ..self
        }
    }

    /// The same figure with one more plot.
    pub fn plot(mut self, plot: Plot) -> Self {
        self.plots.push(plot);
        self
    }

    /// The same figure with more plots.
    pub fn plots(mut self, plots: impl IntoIterator<Item = Plot>) -> Self {
        self.plots.extend(plots);
        self
    }

    /// The same figure with at most so many plots side by side.
    pub fn columns(self, columns: usize) -> Self {
        Self {
            columns: columns.max(1),
            ..self
        }
    }

    /// The same figure, its plots on the same horizontal axis.
    pub fn shared_x(self) -> Self {
        Self {
            shared: Shared {
                x: true,
                ..self.shared
            },
            ..self
        }
    }

    /// The same figure, its plots on the same vertical axes.
    pub fn shared_y(self) -> Self {
        Self {
            shared: Shared {
                y: true,
                ..self.shared
            },
            ..self
        }
    }

    /// The same figure with plots of another height, as a part of their width.
    pub fn aspect(self, aspect: f64) -> Self {
        Self { aspect, ..self }
    }

    /// The same figure with plots as small as is readable at all.
    pub fn dense(self) -> Self {
        Self {
            dense: true,
            ..self
        }
    }

    /// The same figure where each panel says which part of the axes that all have in common it shows.
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

    /// Every panel, with the title of its plot.
    pub fn panels(&self) -> impl Iterator<Item = (&str, &Panel)> {
        self.plots
            .iter()
            .flat_map(|plot| plot.panels.iter().map(|panel| (plot.title.as_str(), panel)))
    }

    /// The legend: one entry for each key among the marks.
    pub fn legend(&self) -> Vec<Entry> {
        entries(self.panels().flat_map(|(_, panel)| &panel.marks))
    }
}

/// Two axes and what stands between them.
#[derive(Clone, Debug, PartialEq)]
pub struct Panel {
    /// The horizontal axis.
    pub x: Axis,
    /// The vertical axis.
    pub y: Axis,
    /// What stands in it; later marks are drawn over earlier ones.
    pub marks: Vec<Mark>,
    /// Its part of the height of its plot, relative to the others'.
    pub weight: f64,
}

impl Panel {
    /// An empty panel.
    pub fn new(x: Axis, y: Axis) -> Self {
        Self {
            x,
            y,
            marks: Vec::new(),
            weight: 1.0,
        }
    }

    /// The same panel with one more mark, over those before.
    pub fn with(mut self, mark: impl Into<Mark>) -> Self {
        self.marks.push(mark.into());
        self
    }

    /// The same panel with more marks, over those before.
    pub fn with_all<M: Into<Mark>>(mut self, marks: impl IntoIterator<Item = M>) -> Self {
        self.marks.extend(marks.into_iter().map(Into::into));
        self
    }

    /// The same panel with one more mark, below all others.
    pub fn over(mut self, ground: impl Into<Mark>) -> Self {
        self.marks.insert(0, ground.into());
        self
    }

    /// The same panel of another height, relative to the others of its plot.
    pub fn weight(self, weight: f64) -> Self {
        Self { weight, ..self }
    }

    /// Every dot in it.
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

    /// What is shown of an axis where this panel stands alone.
    pub fn shown(&self, along: Along) -> Range {
        let axis = match along {
            Along::X => &self.x,
            Along::Y => &self.y,
        };
        axis.fitted(self.marks.iter().flat_map(|mark| mark.values(along)))
    }
}

/// Panels above one another on one horizontal axis, under one title.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Plot {
    /// What the panels are of: `LON → Q`. May be empty.
    pub title: String,
    /// The panels, from above.
    pub panels: Vec<Panel>,
}

impl Plot {
    /// A plot without panels.
    pub fn new(title: impl Into<String>) -> Self {
        Self {
            title: title.into(),
            panels: Vec::new(),
        }
    }

    /// The same plot with one more panel below.
    pub fn panel(mut self, panel: Panel) -> Self {
        self.panels.push(panel);
        self
    }
}

/// What a figure is written as.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum FigureFormat {
    /// Lines and letters, for documents and for drawing programs.
    Svg,
    /// Dots, 300 to the inch.
    Png,
    /// A page as large as the figure, with its letters.
    Pdf,
    /// The numbers.
    Csv,
}

impl FigureFormat {
    /// Every format.
    pub const ALL: [Self; 4] = [Self::Svg, Self::Png, Self::Pdf, Self::Csv];

    /// The end of a file's name.
    pub fn extension(self) -> &'static str {
        match self {
            Self::Svg => "svg",
            Self::Png => "png",
            Self::Pdf => "pdf",
            Self::Csv => "csv",
        }
    }

    /// Its name and what it is good for.
    pub fn words(self) -> &'static str {
        match self {
            Self::Svg => "SVG, for documents and drawing programs",
            Self::Png => "PNG, 300 dots to the inch",
            Self::Pdf => "PDF, one page",
            Self::Csv => "CSV, the numbers",
        }
    }
}

/// What stands in a panel; later marks are drawn over earlier ones.
#[derive(Clone, Debug, PartialEq)]
pub enum Mark {
    /// A line through points.
    Curve(Curve),
    /// Dots.
    Dots(Dots),
    /// Bars from a foot.
    Bars(Bars),
    /// A shaded part of the horizontal axis.
    Band(Band),
    /// A line across the panel at one value.
    Rule(Rule),
    /// Parts of the vertical axis, one at each place.
    Spans(Spans),
    /// The area between two lines.
    Envelope(Envelope),
    /// How sure values are.
    Intervals(Intervals),
    /// Pairs of values that differ.
    Brackets(Brackets),
    /// A line that helps to read values and is none itself.
    Guide(Guide),
    /// Words at a place.
    Note(Note),
}

/// A line through points.
#[derive(Clone, Debug, PartialEq)]
pub struct Curve {
    /// What it is of: heads its column of numbers.
    pub name: String,
    /// Its entry in the legend; equal entries are one. None where it has none.
    pub key: Option<String>,
    /// How it is drawn.
    pub stroke: Stroke,
    /// Where its points are along x.
    pub x: Arc<[f64]>,
    /// Their values; one that is not finite leaves a gap.
    pub y: Arc<[f64]>,
}

/// Dots that belong together.
#[derive(Clone, Debug, PartialEq)]
pub struct Dots {
    /// What they are of: heads their numbers.
    pub name: String,
    /// Their entry in the legend; equal entries are one. None where they have none.
    pub key: Option<String>,
    /// Their outline.
    pub shape: DotShape,
    /// Their colour.
    pub color: Color,
    /// Filled or open.
    pub filled: bool,
    /// How large they are, as a part of the usual size.
    pub size: f64,
    /// The dots.
    pub dots: Vec<Dot>,
}

/// What a mark is of: how a window tells which one is pointed at.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub enum MarkId {
    /// A condition.
    Condition(ConditionId),
    /// A model.
    Model(ModelId),
}

/// One dot.
#[derive(Clone, Debug, PartialEq)]
pub struct Dot {
    /// Where it is along x.
    pub x: f64,
    /// Its value.
    pub y: f64,
    /// The short text beside it. May be empty.
    pub label: String,
    /// What it is of, where that can be pointed at.
    pub id: Option<MarkId>,
}

/// The outline of a dot.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum DotShape {
    /// A circle.
    #[default]
    Circle,
    /// A square on its corner.
    Diamond,
    /// A square.
    Square,
    /// A triangle on its side.
    Triangle,
    /// ×, as poles are drawn.
    Cross,
    /// +.
    Plus,
}

/// Bars that belong together.
#[derive(Clone, Debug, PartialEq)]
pub struct Bars {
    /// What they are of: heads their numbers and is their entry in the legend.
    pub name: String,
    /// Their colour.
    pub color: Color,
    /// Their width in units of x.
    pub width: f64,
    /// Where each stands along x, and its value.
    pub bars: Vec<[f64; 2]>,
    /// What each stands on, so that bars are stacked; without it on 0.
    pub feet: Vec<f64>,
    /// How far they stand beside that place, so that others find room, in units of x.
    pub beside: f64,
}

/// A shaded part of the horizontal axis.
#[derive(Clone, Debug, PartialEq)]
pub struct Band {
    /// The part.
    pub range: Range,
    /// Its colour.
    pub color: Color,
    /// Its entry in the legend.
    pub key: String,
}

/// Shaded parts of the vertical axis, one at each place: between which values something was looked for. They widen no range.
#[derive(Clone, Debug, PartialEq)]
pub struct Spans {
    /// What they are of: heads their numbers and is their entry in the legend.
    pub name: String,
    /// Their colour.
    pub color: Color,
    /// Their width in units of x.
    pub width: f64,
    /// Where each stands along x, its lower end, its upper end.
    pub spans: Vec<[f64; 3]>,
}

/// The area between two lines over the same places: how far a curve may lie. It widens no range but where it has edges.
#[derive(Clone, Debug, PartialEq)]
pub struct Envelope {
    /// What it is: heads its numbers and is its entry in the legend.
    pub name: String,
    /// Its colour.
    pub color: Color,
    /// How its edges are drawn; paper then leaves the area between them white.
    pub edge: Option<Stroke>,
    /// Where it is along x, ascending, its lower end, its upper end; one that is not finite leaves a gap.
    pub points: Vec<[f64; 3]>,
}

/// How sure values are: an upright line at each. They widen no range.
#[derive(Clone, Debug, PartialEq)]
pub struct Intervals {
    /// What they are: heads their numbers and is their entry in the legend.
    pub name: String,
    /// How they are drawn.
    pub stroke: Stroke,
    /// Where each stands along x, its lower end, its upper end.
    pub ends: Vec<[f64; 3]>,
}

/// Pairs of values at one place that differ: a bracket at each. They widen no range.
#[derive(Clone, Debug, PartialEq)]
pub struct Brackets {
    /// What they say: heads their numbers and is their entry in the legend.
    pub name: String,
    /// How they are drawn.
    pub stroke: Stroke,
    /// The brackets.
    pub brackets: Vec<Bracket>,
}

/// A bracket between two values.
#[derive(Clone, Debug, PartialEq)]
pub struct Bracket {
    /// Where both stand along x.
    pub x: f64,
    /// The values.
    pub ends: [f64; 2],
    /// The text beside it. May be empty.
    pub label: String,
}

/// A line across the panel at one value.
#[derive(Clone, Debug, PartialEq)]
pub struct Rule {
    /// The axis of the value: a value along y makes a horizontal line.
    pub along: Along,
    /// The value.
    pub at: f64,
    /// How it is drawn.
    pub stroke: Stroke,
    /// The text beside it. May be empty.
    pub label: String,
}

/// A line that helps to read values and is none itself, such as that of a damping ratio: it widens no range and has no numbers.
#[derive(Clone, Debug, PartialEq)]
pub struct Guide {
    /// Its points.
    pub points: Vec<[f64; 2]>,
    /// The text at its end. May be empty.
    pub label: String,
}

/// Words at a place.
#[derive(Clone, Debug, PartialEq)]
pub struct Note {
    /// Where: x and y, in the panel's units, or in parts of the panel from its lower left corner.
    pub at: Place,
    /// The words.
    pub text: String,
}

/// A place in a panel.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Place {
    /// In the units of the axes; the words stand about it, upright where `upright` says so.
    Value {
        /// Along x.
        x: f64,
        /// Along y.
        y: f64,
        /// Whether the words run upwards.
        upright: bool,
    },
    /// In the upper right corner.
    UpperRight,
    /// In the lower left corner.
    LowerLeft,
}

/// One of the axes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Along {
    /// The horizontal one.
    X,
    /// The vertical one.
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
    /// A line through the points `x[k]`, `y[k]`.
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

    /// A line through these points.
    pub fn through(
        name: impl Into<String>,
        stroke: Stroke,
        points: impl IntoIterator<Item = [f64; 2]>,
    ) -> Self {
        let (x, y): (Vec<f64>, Vec<f64>) = points.into_iter().map(|[x, y]| (x, y)).unzip();
        Self::new(name, stroke, x, y)
    }

    /// The same curve with an entry in the legend.
    pub fn key(self, key: impl Into<String>) -> Self {
        Self {
            key: Some(key.into()),
            ..self
        }
    }

    /// Its points.
    pub fn points(&self) -> impl Iterator<Item = [f64; 2]> + '_ {
        self.x.iter().zip(self.y.iter()).map(|(x, y)| [*x, *y])
    }
}

impl Dots {
    /// No dots yet, drawn like this.
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

    /// The same dots with an entry in the legend.
    pub fn key(self, key: impl Into<String>) -> Self {
        Self {
            key: Some(key.into()),
            ..self
        }
    }

    /// The same dots, filled or open.
    pub fn filled(self, filled: bool) -> Self {
        Self { filled, ..self }
    }

    /// The same dots and one more.
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
    /// Its lower or its upper edge, as a curve, where its edges are drawn.
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
    /// Foot and top of each.
    pub(super) fn ends(&self) -> impl Iterator<Item = [f64; 2]> + '_ {
        let feet = self.feet.iter().copied().chain(std::iter::repeat(0.0));
        self.bars
            .iter()
            .zip(feet)
            .map(|([_, value], foot)| [foot, foot + value])
    }
}

impl Rule {
    /// A horizontal line at the value `y`.
    pub fn horizontal(y: f64, stroke: Stroke) -> Self {
        Self {
            along: Along::Y,
            at: y,
            stroke,
            label: String::new(),
        }
    }

    /// A vertical line at the value `x`.
    pub fn vertical(x: f64, stroke: Stroke) -> Self {
        Self {
            along: Along::X,
            at: x,
            stroke,
            label: String::new(),
        }
    }

    /// The same line with a text beside it.
    pub fn label(self, label: impl Into<String>) -> Self {
        Self {
            label: label.into(),
            ..self
        }
    }
}

impl Mark {
    /// The values along an axis that a panel has to show for this mark.
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
