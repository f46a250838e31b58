//! A figure with its interaction on the screen, and the events in it.

use egui::{Modifiers, Vec2};

use gdcm_plot::figure::{Figure, MarkId};
use gdcm_words::derivation::ExplainTarget;

use super::questions::NamedFigure;

/// Descriptions for a figure's plots.
pub trait FigureWords {
    /// Describes a plot for screen readers.
    fn plot(&self, plot: usize) -> String;

    /// Describes a dot at a place on the axes for screen readers; `None` if dots are not described
    /// individually.
    fn dot(&self, _plot: usize, _id: &MarkId, _at: [f64; 2]) -> Option<String> {
        None
    }

    /// Returns the status line for a mark under the pointer; `None` for no text.
    fn pointed(&self, _plot: usize, _id: &MarkId, _at: [f64; 2]) -> Option<String> {
        None
    }

    /// Returns the values with a derivation at a mark.
    fn questions(&self, _plot: usize, _id: &MarkId) -> Vec<NamedFigure> {
        Vec::new()
    }
}

impl FigureWords for Figure {
    fn plot(&self, plot: usize) -> String {
        self.plots[plot].title.clone()
    }
}

/// Figure with its interaction on the screen. Panels are stacked; interactive marks
/// are in the first panel.
pub struct FigureScene<'a> {
    /// Distinguishes the widgets from those in other figures.
    pub name: &'static str,
    pub figure: &'a Figure,
    /// Mark in focus.
    pub selected: Option<MarkId>,
    /// Mark highlighted by another view.
    pub highlighted: Option<MarkId>,
    /// Marks at the names along the horizontal axes, if the columns are interactive instead of the
    /// dots.
    pub columns: &'a [MarkId],
    /// Whether the plots can be zoomed and panned.
    pub zooms: bool,
    /// Least plot size \[pt\].
    pub least: Vec2,
    /// Message shown if there is nothing to draw.
    pub message: &'a str,
    /// Whether the vertical label appears once per row, at the left, and the unit
    /// of the horizontal axis at its end.
    pub is_compact: bool,
    /// Plot in focus, which has a bar in the accent colour.
    pub accented: Option<usize>,
    pub words: &'a dyn FigureWords,
    /// Number that this figure's first plot has in the descriptions and in events.
    pub first_plot: usize,
}

impl<'a> FigureScene<'a> {
    /// Creates a figure without zoom and without a mark in focus.
    pub fn new(
        name: &'static str,
        figure: &'a Figure,
        least: Vec2,
        message: &'a str,
        words: &'a dyn FigureWords,
    ) -> Self {
        Self {
            name,
            figure,
            selected: None,
            highlighted: None,
            columns: &[],
            zooms: false,
            least,
            message,
            is_compact: false,
            accented: None,
            words,
            first_plot: 0,
        }
    }
}

/// Event in a figure.
#[derive(Clone, Debug, PartialEq)]
pub enum FigureEvent {
    /// The mark under the pointer.
    Pointed(MarkId),
    /// Its description.
    Told(String),
    /// A mark was clicked in this plot, with these modifier keys.
    Clicked(usize, MarkId, Modifiers),
    /// A derivation was requested.
    Asked(ExplainTarget),
}
