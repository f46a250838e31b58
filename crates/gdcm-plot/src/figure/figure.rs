//! Figures: plots side by side, each with panels below one another; a panel has two axes and marks.
//! Nothing here depends on paper or screen.

use super::axis::{Axis, Range};
use super::legend::{Entry, entries};
use super::marks::Mark;

pub use super::marks::{Along, Bars, Curve, Dot, DotShape, Dots, Note, Place, Rule, Spans};

/// A figure: plots in a table, with a title above and a legend and a caption below.
///
/// Contents and styles are fixed here. Ranges that are not set follow from the marks
/// ([`Panel::shown`], [`Self::with_ranges`]); positions follow from paper or screen.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Figure {
    pub title: String,
    /// Dataset, condition and settings needed to read the figure. Without a date, so that the same
    /// analysis produces the same file.
    pub caption: String,
    /// In reading order, row by row.
    pub plots: Vec<Plot>,
    /// Maximum number of plots in a row.
    pub columns: usize,
    pub shared: Shared,
    /// Total height of a plot's frames, relative to the frame width.
    pub aspect: f64,
    /// Whether plots may shrink to the limit of readability, as in large tables of plots.
    pub dense: bool,
}

/// Axes with the same range in all plots; only the outer plots then show tick labels.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Shared {
    pub x: bool,
    pub y: bool,
}

impl Figure {
    /// Creates a figure without plots, with a single column and without shared axes.
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

    /// Returns the figure with another plot.
    pub fn plot(mut self, plot: Plot) -> Self {
        self.plots.push(plot);
        self
    }

    /// Returns the figure with more plots.
    pub fn plots(mut self, plots: impl IntoIterator<Item = Plot>) -> Self {
        self.plots.extend(plots);
        self
    }

    /// Limits how many plots are side by side; 0 counts as 1.
    pub fn columns(self, columns: usize) -> Self {
        Self {
            columns: columns.max(1),
            ..self
        }
    }

    /// Returns the figure with the same horizontal range in all plots.
    pub fn shared_x(mut self) -> Self {
        self.shared.x = true;
        self
    }

    /// Returns the figure with the same vertical range in all plots.
    pub fn shared_y(mut self) -> Self {
        self.shared.y = true;
        self
    }

    /// Sets the total height of a plot's frames, relative to the frame width.
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

    /// Returns the figure with the common ranges of shared axes stored in every panel, so that each
    /// panel can be painted separately.
    pub fn with_ranges(mut self) -> Self {
        let mut x = None;
        if self.shared.x {
            x = self.common_range(Along::X);
        }
        let mut y = None;
        if self.shared.y {
            y = self.common_range(Along::Y);
        }
        for panel in self.plots.iter_mut().flat_map(|plot| &mut plot.panels) {
            panel.x.range = x.or(panel.x.range);
            panel.y.range = y.or(panel.y.range);
        }
        self
    }

    /// Returns the smallest range that contains all panels' ranges; `None` without panels.
    fn common_range(&self, along: Along) -> Option<Range> {
        self.panels()
            .map(|(_, panel)| panel.shown(along))
            .reduce(Range::union)
    }

    /// Iterates over all panels, each with its plot's title.
    pub fn panels(&self) -> impl Iterator<Item = (&str, &Panel)> {
        self.plots
            .iter()
            .flat_map(|plot| plot.panels.iter().map(|panel| (plot.title.as_str(), panel)))
    }

    /// Returns the legend: an entry for each distinct key among all marks.
    pub fn legend(&self) -> Vec<Entry> {
        entries(self.panels().flat_map(|(_, panel)| &panel.marks))
    }
}

/// Two axes and the marks between them.
#[derive(Clone, Debug, PartialEq)]
pub struct Panel {
    pub x: Axis,
    pub y: Axis,
    /// In drawing order: later marks cover earlier ones.
    pub marks: Vec<Mark>,
    /// Height relative to the other panels in its plot.
    pub weight: f64,
}

impl Panel {
    /// Creates an empty panel with weight 1.
    pub fn new(x: Axis, y: Axis) -> Self {
        Self {
            x,
            y,
            marks: Vec::new(),
            weight: 1.0,
        }
    }

    /// Returns the panel with another mark, drawn over the existing marks.
    pub fn with(mut self, mark: impl Into<Mark>) -> Self {
        self.marks.push(mark.into());
        self
    }

    /// Returns the panel with more marks, drawn over the existing marks.
    pub fn with_all<M: Into<Mark>>(mut self, marks: impl IntoIterator<Item = M>) -> Self {
        self.marks.extend(marks.into_iter().map(Into::into));
        self
    }

    /// Returns the panel with another mark, drawn below the existing marks.
    pub fn with_ground(mut self, ground: impl Into<Mark>) -> Self {
        self.marks.insert(0, ground.into());
        self
    }

    /// Sets the height relative to the plot's other panels.
    pub fn weight(self, weight: f64) -> Self {
        Self { weight, ..self }
    }

    /// Iterates over the dots in all marks.
    pub fn dots(&self) -> impl Iterator<Item = &Dot> {
        self.marks.iter().flat_map(|mark| match mark {
            Mark::Dots(group) => group.dots.as_slice(),
            _ => &[],
        })
    }

    /// Returns the range of an axis: the fixed range if there is one, otherwise a range fitted to
    /// this panel's marks.
    pub fn shown(&self, along: Along) -> Range {
        let axis = match along {
            Along::X => &self.x,
            Along::Y => &self.y,
        };
        axis.fitted(self.marks.iter().flat_map(|mark| mark.values(along)))
    }
}

/// A title, and panels below one another. On paper, the panels' horizontal ranges are united into a
/// common range.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Plot {
    /// Subject: `LON → Q`. May be empty.
    pub title: String,
    /// In order from top to bottom.
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

    /// Returns the plot with another panel at the bottom.
    pub fn panel(mut self, panel: Panel) -> Self {
        self.panels.push(panel);
        self
    }
}
