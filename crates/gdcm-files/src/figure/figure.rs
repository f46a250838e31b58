//! A figure: what a plot shows, apart from any screen.

use super::axis::{Axis, Range};
use super::mark::{Along, Dot, Mark};
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

    /// The same figure where each panel says which part of the axes that all have in common it shows.
    pub fn with_ranges(mut self) -> Self {
        let panels = || self.plots.iter().flat_map(|plot| &plot.panels);
        let common = |along| panels().map(|panel| panel.shown(along)).reduce(Range::union);
        let x = if self.shared.x { common(Along::X) } else { None };
        let y = if self.shared.y { common(Along::Y) } else { None };
        for panel in self.plots.iter_mut().flat_map(|plot| &mut plot.panels) {
            panel.x.range = x.or(panel.x.range);
            panel.y.range = y.or(panel.y.range);
        }
        self
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
        Self { x, y, marks: Vec::new(), weight: 1.0 }
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
        self.marks.iter().filter_map(|mark| if let Mark::Dots(of) = mark { Some(&of.dots) } else { None }).flatten()
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
        Self { title: title.into(), panels: Vec::new() }
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
