//! Contents of the overview, its state between frames, and its events.

use std::collections::BTreeMap;

use egui::Pos2;
use egui_plot::{PlotPoint, PlotTransform};

use gdcm_model::dataset::Pair;
use gdcm_plot::figure::Range;
use gdcm_plot::figure::axis::FrequencyUnit;

use super::bode_event::CurveAction;
use super::drawn_curves::{BodeCurve, CurveId, PANES, Pane};
use super::drawn_pane::DrawnPane;
use super::nearest_curve::{Hit, nearest_curve};
use super::overview_ranges::SharedRanges;
use super::overview_response::OverviewCell;
use super::steady_range::AxisUpdate;
use super::viewed_range::ranges_of;

#[derive(Clone, Copy, Debug)]
pub struct OverviewScene<'a> {
    /// Input names: the columns.
    pub inputs: &'a [String],
    /// Output names: the rows.
    pub outputs: &'a [String],
    /// Responses, in any order.
    pub cells: &'a [OverviewCell<'a>],
    /// Lower and upper end of the comparison band \[rad/s\].
    pub band: (f64, f64),
    /// Unit of the frequency labels.
    pub unit: FrequencyUnit,
    /// Frequency under the pointer in any plot \[rad/s\].
    pub cursor: Option<f64>,
    /// Stage of an update to the displayed results, which decides whether the axes may change.
    pub update: AxisUpdate,
    /// Message shown if there is nothing to draw.
    pub message: Option<&'a str>,
}

#[derive(Clone, Debug, PartialEq)]
pub enum OverviewEvent {
    PairClicked(Pair),
    /// A curve is under the pointer.
    Hovered(CurveId),
    /// Frequency under the pointer \[rad/s\].
    PointedAt(f64),
    /// Status text for the element under the pointer.
    StatusText(String),
    /// A curve was clicked with Alt pressed.
    Isolated(CurveId),
    /// An entry in a curve's menu was chosen.
    ActionChosen(CurveId, CurveAction),
}

/// Curve whose menu is open, and its cell.
#[derive(Clone, Debug)]
pub(super) struct MenuCurve {
    pub(super) pair: Pair,
    pub(super) curve: CurveId,
}

/// The overview's state between frames.
#[derive(Clone, Debug, Default)]
pub struct OverviewView {
    /// Whether phases are shown below magnitudes.
    pub show_phase: bool,
    /// Visible values of the rows.
    pub(super) ranges: SharedRanges,
    /// Panes of the cells as last drawn, with their cached lines.
    pub(super) drawn_panes: BTreeMap<(Pair, Pane), DrawnPane>,
    pub(super) menu_curve: Option<MenuCurve>,
}

impl OverviewView {
    /// Returns a cell's transform as last drawn.
    fn transform(&self, pair: Pair, pane: Pane) -> Option<&PlotTransform> {
        self.drawn_panes.get(&(pair, pane))?.transform.as_ref()
    }

    /// Returns the cell's curve under the pointer, if any.
    pub(super) fn curve_at<'c>(
        &self,
        cell: &OverviewCell<'c>,
        pointer: Pos2,
    ) -> Option<&'c BodeCurve> {
        let mut best: Option<Hit> = None;
        for pane in PANES {
            let Some(transform) = self.transform(cell.pair, pane) else {
                continue;
            };
            if !transform.frame().contains(pointer) {
                continue;
            }
            if let Some(hit) = nearest_curve(cell.curves, pane, pointer, transform)
                && best.is_none_or(|best| hit.distance < best.distance)
            {
                best = Some(hit);
            }
        }
        cell.curves.get(best?.curve)
    }

    /// Returns the visible range of `log10 omega` and of the values in a cell as last drawn.
    pub fn ranges_in(&self, pair: Pair, pane: Pane) -> Option<[Range; 2]> {
        Some(ranges_of(self.transform(pair, pane)?.bounds()))
    }

    /// Returns the screen position of a magnitude, given as `log10 omega` and decibels.
    pub fn position_in(&self, pair: Pair, log_omega: f64, magnitude_db: f64) -> Option<Pos2> {
        let transform = self.transform(pair, Pane::Magnitude)?;
        Some(transform.position_from_point(&PlotPoint::new(log_omega, magnitude_db)))
    }

    /// Returns the centre of a cell's magnitude plot on the screen.
    pub fn screen_position(&self, pair: Pair) -> Option<Pos2> {
        let transform = self.transform(pair, Pane::Magnitude)?;
        Some(transform.frame().center())
    }
}
