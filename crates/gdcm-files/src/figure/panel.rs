//! A panel: two axes and what stands between them.

use super::axis::Axis;
use super::mark::{Along, Mark};
use super::range::Range;

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

    /// The same panel of another height, relative to the others of its plot.
    pub fn weight(self, weight: f64) -> Self {
        Self { weight, ..self }
    }

    /// What is shown of an axis where this panel stands alone.
    pub(super) fn shown(&self, along: Along) -> Range {
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
