//! A panel at its position on paper or on the screen, and where values lie in it.

use super::axis::{Range, Tick};
use super::drawing::Area;
use super::figure::Panel;
use super::marks::{Along, Bracket};

/// Distance between a bracket and its values \[pt\].
const BRACKET_DISTANCE: f64 = 5.0;
/// Minimum distance between a bracket and the left edge of the frame \[pt\].
const LEAST_ROOM: f64 = 1.0;
/// Tolerance by which a position in the frame may lie beyond its edge \[pt\].
const EDGE_TOLERANCE: f64 = 0.5;
/// Length of the hooks at both ends of a bracket \[pt\].
pub(super) const HOOK: f64 = 1.8;

/// A panel at its position.
#[derive(Debug)]
pub(super) struct Placed<'f> {
    pub(super) panel: &'f Panel,
    /// Title above the frame. May be empty.
    pub(super) title: &'f str,
    /// Area in which the axes and marks are drawn \[pt\].
    pub(super) frame: Area,
    pub(super) x: Side,
    pub(super) y: Side,
    /// Font size for the texts in the panel \[pt\].
    pub(super) font_size_pt: f64,
}

/// An axis at its position: visible range, ticks and label.
#[derive(Debug)]
pub(super) struct Side {
    pub(super) range: Range,
    pub(super) ticks: Vec<Tick>,
    pub(super) has_numbers: bool,
    pub(super) has_label: bool,
    /// Room for the tick labels, perpendicular to the axis \[pt\].
    pub(super) depth: f64,
}

impl Side {
    /// Creates an axis without ticks and without a label.
    pub(super) fn bare(range: Range) -> Self {
        Self {
            range,
            ticks: Vec::new(),
            has_numbers: false,
            has_label: false,
            depth: 0.0,
        }
    }
}

/// Line ends in a bracket \[pt\], in the same order as the bracket's values.
pub(super) struct PlacedBracket {
    /// Ends of the line beside the values.
    pub(super) spine: [[f64; 2]; 2],
    /// Ends of the hooks, which point to the values.
    pub(super) hooks: [[f64; 2]; 2],
}

impl Placed<'_> {
    /// Returns a point's position, which lies outside the frame if the point is outside the ranges;
    /// `None` if an axis cannot show the point.
    pub(super) fn at(&self, [x, y]: [f64; 2]) -> Option<[f64; 2]> {
        let x = self.panel.x.fraction(x, self.x.range)?;
        let y = self.panel.y.fraction(y, self.y.range)?;
        Some(self.frame.at(x, y))
    }

    /// Returns the ends of a line at a value, across the whole frame: the lower or left end first.
    /// `None` if the axis cannot show the value.
    pub(super) fn across(&self, along: Along, value: f64) -> Option<[[f64; 2]; 2]> {
        match along {
            Along::X => {
                let x = self.panel.x.fraction(value, self.x.range)?;
                Some([self.frame.at(x, 0.0), self.frame.at(x, 1.0)])
            }
            Along::Y => {
                let y = self.panel.y.fraction(value, self.y.range)?;
                Some([self.frame.at(0.0, y), self.frame.at(1.0, y)])
            }
        }
    }

    /// Returns the positions of both ends in a vertical range `[x, lower end, upper end]`; `None`
    /// if an axis cannot show one of them.
    pub(super) fn vertical(&self, [x, low, high]: [f64; 3]) -> Option<[[f64; 2]; 2]> {
        Some([self.at([x, low])?, self.at([x, high])?])
    }

    /// Returns a bracket's lines: to the left of its values, or to their right if there is no room
    /// on the left. `None` if an axis cannot show a value.
    pub(super) fn bracket(&self, bracket: &Bracket) -> Option<PlacedBracket> {
        let [from, to] = bracket.ends;
        let from = self.at([bracket.x, from])?;
        let to = self.at([bracket.x, to])?;
        // Direction from the values to the line: 1 to the right.
        let side = if from[0] - BRACKET_DISTANCE < self.frame.left + LEAST_ROOM {
            1.0
        } else {
            -1.0
        };
        let ends = [from, to];
        Some(PlacedBracket {
            spine: ends.map(|[x, y]| [x + side * BRACKET_DISTANCE, y]),
            hooks: ends.map(|[x, y]| [x + side * (BRACKET_DISTANCE - HOOK), y]),
        })
    }

    /// Returns whether a position is in the frame, edge included, with a tolerance of half a point.
    pub(super) fn shows(&self, position: [f64; 2]) -> bool {
        self.frame.expanded(EDGE_TOLERANCE).contains(position)
    }
}
