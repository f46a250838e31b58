//! A figure: what a plot shows, apart from any screen.

use super::legend::{Entry, entries};
use super::panel::{Panel, Plot};

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
        Self { title: title.into(), columns: 1, aspect: 0.62, ..Self::default() }
    }

    /// The same figure with a caption.
    pub fn caption(self, caption: impl Into<String>) -> Self {
        Self { caption: caption.into(), ..self }
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
        Self { columns: columns.max(1), ..self }
    }

    /// The same figure, its plots on the same horizontal axis.
    pub fn shared_x(self) -> Self {
        Self { shared: Shared { x: true, ..self.shared }, ..self }
    }

    /// The same figure, its plots on the same vertical axes.
    pub fn shared_y(self) -> Self {
        Self { shared: Shared { y: true, ..self.shared }, ..self }
    }

    /// The same figure with plots of another height, as a part of their width.
    pub fn aspect(self, aspect: f64) -> Self {
        Self { aspect, ..self }
    }

    /// The same figure with plots as small as is readable at all.
    pub fn dense(self) -> Self {
        Self { dense: true, ..self }
    }

    /// Every panel, with the title of its plot.
    pub fn panels(&self) -> impl Iterator<Item = (&str, &Panel)> {
        self.plots.iter().flat_map(|plot| plot.panels.iter().map(|panel| (plot.title.as_str(), panel)))
    }

    /// The legend: one entry for each key among the marks.
    pub fn legend(&self) -> Vec<Entry> {
        entries(self.panels().flat_map(|(_, panel)| &panel.marks))
    }
}
