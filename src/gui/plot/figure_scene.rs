//! A figure with its interaction on the screen, and its events.
//!
//! A mark's id ([`MarkId`]) is the identity of the object that a dot or a column represents. Axis
//! coordinates are the values or, on a logarithmic horizontal axis, their logarithms.

use egui::{Modifiers, Vec2};

use gdcm_plot::figure::Figure;
use gdcm_plot::figure::marks::MarkId;
use gdcm_words::derivation::ExplainTarget;

use super::derivation_menu::Question;

/// Describes a figure's plots and marks in words. A plot is given by its index in the figure plus
/// [`FigureScene::first_plot`], a mark by its id and its axis coordinates.
pub trait FigureWords {
    /// Returns the accessible name of a plot, read by screen readers.
    fn plot_name(&self, plot: usize) -> String;

    /// Returns a dot's accessible name; `None` if dots have no names of their own.
    fn dot_name(&self, _plot: usize, _id: &MarkId, _at: [f64; 2]) -> Option<String> {
        None
    }

    /// Returns the status text for the mark under the pointer; `None` for no text.
    fn status_text(&self, _plot: usize, _id: &MarkId, _at: [f64; 2]) -> Option<String> {
        None
    }

    /// Returns the values at a mark for which a derivation can be displayed.
    fn questions(&self, _plot: usize, _id: &MarkId) -> Vec<Question> {
        Vec::new()
    }
}

/// Titles as names, for scenes that show the whole figure, with 0 as [`FigureScene::first_plot`].
impl FigureWords for Figure {
    fn plot_name(&self, plot: usize) -> String {
        self.plots[plot].title.clone()
    }
}

/// Figure with its interaction on the screen. In each plot the panels are below one another; only
/// the first has interactive marks.
pub struct FigureScene<'a> {
    /// Distinguishes the widgets from those in other figures.
    pub name: &'static str,
    pub figure: &'a Figure,
    /// Mark in focus.
    pub selected: Option<MarkId>,
    /// Mark highlighted by another view.
    pub highlighted: Option<MarkId>,
    /// Marks of the named columns (the places 0, 1, … of a horizontal axis with names), in this
    /// order, if they are to be pointed at and clicked instead of dots; otherwise empty.
    pub columns: &'a [MarkId],
    /// Whether the plots can be zoomed and panned.
    pub zooms: bool,
    /// Minimum plot size \[pt\].
    pub least_plot_size: Vec2,
    /// Message shown if there is nothing to draw.
    pub message: &'a str,
    /// Whether the axis texts are reduced: tick labels of the values only in the leftmost plots,
    /// and only the unit of the horizontal axis, beside the last plot.
    pub is_compact: bool,
    /// Whether, in a stack of panels, only the lowest has numbers along the common horizontal axis.
    pub is_stacked: bool,
    /// Plot in focus, which has a bar in the accent colour.
    pub accented: Option<usize>,
    pub words: &'a dyn FigureWords,
    /// Index that this figure's first plot has in descriptions and events; not 0 if a view shows
    /// its plots in several figures.
    pub first_plot: usize,
}

impl<'a> FigureScene<'a> {
    /// Creates a figure's scene without zoom and without a mark in focus.
    pub fn new(
        name: &'static str,
        figure: &'a Figure,
        least_plot_size: Vec2,
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
            least_plot_size,
            message,
            is_compact: false,
            is_stacked: false,
            accented: None,
            words,
            first_plot: 0,
        }
    }
}

/// Event in a figure, for its view to handle.
#[derive(Clone, Debug, PartialEq)]
pub enum FigureEvent {
    /// This mark is under the pointer.
    Pointed(MarkId),
    /// Status text for the mark under the pointer.
    StatusText(String),
    /// A mark was clicked, in the plot with this index (as in [`FigureWords`]), with these modifier
    /// keys.
    Clicked(usize, MarkId, Modifiers),
    /// A value's derivation was requested.
    ExplanationRequested(ExplainTarget),
}
