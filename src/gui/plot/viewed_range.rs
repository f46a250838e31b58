//! Visible range on an axis, and how far zooming and panning may change it.

use egui_plot::PlotBounds;

use gdcm_plot::figure::Range;

/// Margin at either end, relative to the data range; in total, ten times the data range is visible.
const BEYOND: f64 = 4.5;

/// Maximum range when zooming out.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum ZoomLimit {
    /// Data range: a record has no values before its start and after its end.
    Data,
    /// Data range, extended by this share of its width on either side.
    DataWithMargin(f64),
    /// Data range on a logarithmic axis, extended by a decade on either side.
    Decade,
    /// Ten times the data range, and at least this wide.
    TenWidths { least: f64 },
}

impl ZoomLimit {
    /// Returns the maximum range for an axis with this data range; in decades for a logarithmic
    /// axis.
    pub(super) fn range(self, data: Range) -> Range {
        match self {
            Self::Data => data,
            Self::DataWithMargin(margin) => data.with_margin(margin, 0.0),
            Self::Decade => Range::new(data.min - 1.0, data.max + 1.0),
            Self::TenWidths { least } => data.with_margin(BEYOND, least),
        }
    }
}

/// Returns `range` zoomed in by `factor` about `fixed`, within `limit`; `None` if nothing within
/// the limit would be visible.
pub(super) fn zoomed_within(range: Range, factor: f64, fixed: f64, limit: Range) -> Option<Range> {
    let zoomed = range.zoomed(factor, fixed);
    let within = Range {
        min: zoomed.min.max(limit.min),
        max: zoomed.max.min(limit.max),
    };
    if within.min < within.max {
        Some(within)
    } else {
        None
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

/// Visible range on an axis. The engineer's choice persists until it is released.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct ViewedRange {
    range: Range,
    is_chosen: bool,
    /// Permitted range widths.
    widths: Range,
    /// Permitted values in the range.
    ends: Range,
}

impl ViewedRange {
    /// Creates the visible range `range`, which need not respect the limits; every later range has
    /// a width in `widths` and lies within `ends`.
    pub(super) fn new(range: Range, widths: Range, ends: Range) -> Self {
        Self {
            range,
            is_chosen: false,
            widths,
            ends,
        }
    }

    /// Limits later visible ranges to a decade on either side of `computed`, the range of `log10
    /// omega` in the computed curves.
    pub(super) fn reach(&mut self, computed: Range) {
        self.ends = ZoomLimit::Decade.range(computed);
    }

    /// Zooms by `factor` about `fixed`, within the limits.
    pub(super) fn zoom(&mut self, factor: f64, fixed: f64) {
        if let Some(range) = zoomed_within(self.range, factor, fixed, self.ends) {
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
        let Some(range) = self.allowed(range) else {
            return false;
        };
        if range != self.range {
            self.range = range;
            self.is_chosen = true;
        }
        true
    }

    /// Returns the values within which every range lies.
    pub(super) fn ends(&self) -> Range {
        self.ends
    }

    /// Sets the range that fits the data, unless the engineer chose a range; with the nearest
    /// permitted width, and ignored if it exceeds the permitted values.
    pub(super) fn fit(&mut self, range: Range) {
        if let Some(range) = self.allowed(range)
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
    fn allowed(&self, range: Range) -> Option<Range> {
        let range = range.limited(self.widths)?;
        if self.ends.contains(range.min) && self.ends.contains(range.max) {
            Some(range)
        } else {
            None
        }
    }
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
        viewed.reach(Range::new(-0.5, 1.25));
        (0..100).for_each(|_| viewed.zoom(1.0 / 1.1, 0.3));
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
    fn a_range_beyond_the_ends_is_not_shown() {
        let mut viewed = viewed();
        assert!(!viewed.choose(Range::new(99.0, 101.0)));
        viewed.choose(Range {
            min: f64::NAN,
            max: 1.0,
        });
        assert_eq!(viewed, self::viewed());
    }

    #[test]
    fn a_limit_follows_the_data_of_its_axis() {
        let data = Range::new(0.0, 2.0);
        assert_eq!(ZoomLimit::Data.range(data), data);
        assert_eq!(ZoomLimit::Decade.range(data), Range::new(-1.0, 3.0));
        let ten = ZoomLimit::TenWidths { least: 0.0 };
        assert_eq!(ten.range(data), Range::new(-9.0, 11.0));
        assert_eq!(
            ZoomLimit::DataWithMargin(0.5).range(data),
            Range::new(-1.0, 3.0)
        );
    }

    #[test]
    fn a_zoom_keeps_within_its_limit_and_shows_something() {
        let limit = Range::new(0.0, 4.0);
        let out = zoomed_within(Range::new(1.0, 2.0), 0.1, 1.5, limit);
        assert_eq!(out, Some(limit));
        assert_eq!(
            zoomed_within(Range::new(6.0, 8.0), 2.0, 7.0, limit),
            None,
            "dragged beyond the limit"
        );
    }
}
