//! Visible range on an axis in a Bode or error plot, and how far zooming and panning may change it.
//!
//! `BodeView` has one [`ViewedRange`] for the frequency axis, which both panes share, and one for
//! each pane's values. Charts and figures have no `ViewedRange`; they use only the limits in
//! `zoom_limit` and the conversions below.

use egui_plot::PlotBounds;

use gdcm_plot::figure::Range;

use super::zoom_limit::{ZoomLimit, zoomed_within};

/// Visible range on an axis. The engineer's choice persists until it is released.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct ViewedRange {
    range: Range,
    is_chosen: bool,
    permitted_widths: Range,
    /// Values that may become visible: both ends of a later range lie within them.
    permitted_values: Range,
}

impl ViewedRange {
    /// Creates the visible range `range`, which need not respect the limits; every later range has
    /// a width in `permitted_widths` and lies within `permitted_values`.
    pub(super) fn new(range: Range, permitted_widths: Range, permitted_values: Range) -> Self {
        Self {
            range,
            is_chosen: false,
            permitted_widths,
            permitted_values,
        }
    }

    /// Limits later ranges on a logarithmic axis to a decade on either side of `computed`: for the
    /// frequency axis, the range of `log10 omega` in the computed curves.
    pub(super) fn limit_to_decade_around(&mut self, computed: Range) {
        self.permitted_values = ZoomLimit::Decade.range(computed);
    }

    /// Zooms by `factor`, in if it exceeds 1, about `fixed`.
    ///
    /// The zoomed range is first cut at the permitted values, so that zooming out ends there; then
    /// its width is limited about its middle. The zoom is ignored if nothing within the permitted
    /// values would be visible, or if the range, widened to the least width, exceeds them.
    pub(super) fn zoom(&mut self, factor: f64, fixed: f64) {
        if let Some(range) = zoomed_within(self.range, factor, fixed, self.permitted_values) {
            self.choose(range);
        }
    }

    pub(super) fn range(&self) -> Range {
        self.range
    }

    pub(super) fn is_chosen(&self) -> bool {
        self.is_chosen
    }

    /// Sets the range chosen by the engineer, with the nearest permitted width. Returns whether all
    /// of it is permitted; otherwise the visible range stays. The visible range itself does not
    /// count as chosen.
    pub(super) fn choose(&mut self, range: Range) -> bool {
        let Some(range) = self.permitted(range) else {
            return false;
        };
        if range != self.range {
            self.range = range;
            self.is_chosen = true;
        }
        true
    }

    pub(super) fn permitted_values(&self) -> Range {
        self.permitted_values
    }

    /// Sets the range that fits the data, unless the engineer chose a range; with the nearest
    /// permitted width, and ignored if it exceeds the permitted values.
    pub(super) fn fit(&mut self, range: Range) {
        if let Some(range) = self.permitted(range)
            && !self.is_chosen
        {
            self.range = range;
        }
    }

    /// Drops the engineer's choice, so that the next fit applies.
    pub(super) fn release(&mut self) {
        self.is_chosen = false;
    }

    /// Returns the nearest range with a permitted width, if it lies within the permitted values.
    fn permitted(&self, range: Range) -> Option<Range> {
        let range = range.limited(self.permitted_widths)?;
        if self.permitted_values.contains(range.min) && self.permitted_values.contains(range.max) {
            Some(range)
        } else {
            None
        }
    }
}

/// Returns the horizontal and the vertical range.
pub(super) fn ranges_of(bounds: &PlotBounds) -> [Range; 2] {
    let min = bounds.min();
    let max = bounds.max();
    [0, 1].map(|axis| Range::new(min[axis], max[axis]))
}

pub(super) fn bounds_of([x, y]: [Range; 2]) -> PlotBounds {
    PlotBounds::from_min_max([x.min, y.min], [x.max, y.max])
}

#[cfg(test)]
mod tests {
    use super::*;

    fn viewed() -> ViewedRange {
        ViewedRange::new(
            Range::new(0.0, 1.0),
            Range::new(0.1, 50.0),
            Range::new(-100.0, 100.0),
        )
    }

    #[test]
    fn a_chosen_range_stays_until_it_is_released() {
        let mut viewed = viewed();
        viewed.fit(Range::new(2.0, 3.0));
        assert_eq!(
            (viewed.range(), viewed.is_chosen()),
            (Range::new(2.0, 3.0), false)
        );
        viewed.choose(Range::new(4.0, 5.0));
        viewed.fit(Range::new(2.0, 3.0));
        assert_eq!(
            (viewed.range(), viewed.is_chosen()),
            (Range::new(4.0, 5.0), true)
        );
        viewed.release();
        viewed.fit(Range::new(2.0, 3.0));
        assert_eq!(viewed.range(), Range::new(2.0, 3.0));
    }

    #[test]
    fn zooming_out_ends_a_decade_beyond_the_computed_range() {
        let mut viewed = viewed();
        viewed.limit_to_decade_around(Range::new(-0.5, 1.25));
        for _ in 0..100 {
            viewed.zoom(1.0 / 1.1, 0.3);
        }
        assert_eq!(viewed.range(), Range::new(-1.5, 2.25));
        viewed.zoom(1.1, 0.3);
        assert!(viewed.range().width() < 3.75, "and back");
    }

    #[test]
    fn choosing_the_visible_range_is_no_choice() {
        let mut viewed = viewed();
        viewed.choose(Range::new(0.0, 1.0));
        assert!(!viewed.is_chosen());
    }

    #[test]
    fn a_range_beyond_the_permitted_values_is_not_shown() {
        let mut viewed = viewed();
        assert!(!viewed.choose(Range::new(99.0, 101.0)));
        viewed.choose(Range {
            min: f64::NAN,
            max: 1.0,
        });
        assert_eq!(viewed, self::viewed());
    }

    #[test]
    fn zooming_in_ends_at_the_least_width() {
        let mut viewed = viewed();
        for _ in 0..100 {
            viewed.zoom(1.1, 0.5);
        }
        assert!((viewed.range().width() - 0.1).abs() < 1e-9);
    }

    #[test]
    fn a_zoom_whose_least_width_exceeds_the_permitted_values_is_ignored() {
        let mut viewed = ViewedRange::new(
            Range::new(0.9, 1.0),
            Range::new(0.1, 50.0),
            Range::new(0.0, 1.0),
        );
        viewed.zoom(1.1, 1.0);
        assert_eq!(viewed.range(), Range::new(0.9, 1.0));
        assert!(!viewed.is_chosen());
    }
}
