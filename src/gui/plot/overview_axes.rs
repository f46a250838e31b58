//! Axes of the overview: labels at the left of each row and below each column, and the grid lines of
//! every cell at the labelled values. A cell holds a response's panes ([`Pane`]), magnitude and
//! phase, one above the other; here `pane` is also the rectangle of one.

use egui::{Align2, Painter, Rect, Stroke, pos2};

use gdcm_plot::figure::Range;

use super::drawn_curves::Pane;
use super::overview_ranges::value_unit;
use super::panel_axis::tick_font;
use super::ticks::{TickLabel, Ticks};
use crate::gui::widgets::palette::Palette;

/// Half the height of a label \[pt\]: labels at the ends of a value axis are moved inwards by as
/// much.
const HALF_LABEL: f32 = 6.0;
/// Distance between the labels and the cells at their right \[pt\]; half of it to the cells above.
const GAP: f32 = 4.0;

/// Range and ticks of an axis along one side of a pane, in axis coordinates: `log10` of a frequency
/// \[rad/s\], or a value. A *place* is such a coordinate.
#[derive(Clone, Copy, Debug)]
pub(super) struct AxisRange {
    pub(super) ticks: Ticks,
    pub(super) range: Range,
}

impl AxisRange {
    /// Returns the axis of the values in a pane.
    pub(super) fn of_values(pane: Pane, range: Range) -> Self {
        Self {
            ticks: value_unit(pane).ticks(),
            range,
        }
    }

    fn labels(self, length_pt: f32) -> Vec<TickLabel> {
        self.ticks.labels(self.range, f64::from(length_pt))
    }

    /// Returns the position of a place as a share of the axis.
    fn share(self, place: f64) -> f32 {
        ((place - self.range.min) / self.range.width()) as f32
    }

    /// Paints labels at the left of a pane.
    pub(super) fn paint_beside(self, painter: &Painter, pane: Rect, palette: &Palette) {
        for label in self.labels(pane.height()) {
            let y = self.height_in(pane, label.place);
            let y = y.clamp(pane.top() + HALF_LABEL, pane.bottom() - HALF_LABEL);
            let at = pos2(pane.left() - GAP, y);
            painter.text(
                at,
                Align2::RIGHT_CENTER,
                label.text,
                tick_font(),
                palette.dim_text,
            );
        }
    }

    /// Paints labels below a column of cells.
    pub(super) fn paint_below(self, painter: &Painter, column: Rect, palette: &Palette) {
        for label in self.labels(column.width()) {
            let at = pos2(
                self.across_in(column, label.place),
                column.bottom() + HALF_LABEL + 0.5 * GAP,
            );
            painter.text(
                at,
                Align2::CENTER_CENTER,
                label.text,
                tick_font(),
                palette.dim_text,
            );
        }
    }

    /// Paints horizontal grid lines into a pane.
    pub(super) fn paint_levels(self, painter: &Painter, pane: Rect, palette: &Palette) {
        for label in self.labels(pane.height()) {
            let y = self.height_in(pane, label.place);
            painter.hline(pane.x_range(), y, Stroke::new(1.0, palette.grid));
        }
    }

    /// Paints vertical grid lines into a pane.
    pub(super) fn paint_verticals(self, painter: &Painter, pane: Rect, palette: &Palette) {
        for label in self.labels(pane.width()) {
            let x = self.across_in(pane, label.place);
            painter.vline(x, pane.y_range(), Stroke::new(1.0, palette.grid));
        }
    }

    /// Returns the vertical screen position of a place in a pane.
    fn height_in(self, pane: Rect, place: f64) -> f32 {
        pane.bottom() - self.share(place) * pane.height()
    }

    /// Returns the horizontal screen position of a place in a pane, limited to the pane: the
    /// comparison band and the cursor may exceed the range of the axis.
    pub(super) fn across_in(self, pane: Rect, place: f64) -> f32 {
        pane.left() + self.share(place).clamp(0.0, 1.0) * pane.width()
    }
}
