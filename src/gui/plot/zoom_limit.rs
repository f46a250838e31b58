//! How far an axis may be zoomed out: [`ZoomLimit`], relative to its data, and a zoom that respects
//! such a limit. Charts, figures and [`ViewedRange`](super::viewed_range::ViewedRange) use it.

use gdcm_plot::figure::Range;

/// Margin at either end, relative to the data range, with which ten times the data range is visible.
const MARGIN_FOR_TEN_WIDTHS: f64 = 4.5;
/// Least width, for a range that may become as narrow as its data.
const NO_LEAST_WIDTH: f64 = 0.0;

/// Maximum range when zooming out, relative to the range of an axis's data.
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
            Self::DataWithMargin(margin) => data.with_margin(margin, NO_LEAST_WIDTH),
            Self::Decade => Range::new(data.min - 1.0, data.max + 1.0),
            Self::TenWidths { least } => data.with_margin(MARGIN_FOR_TEN_WIDTHS, least),
        }
    }
}

/// Returns `range` zoomed by `factor` about `fixed` and cut at `limit`; `None` if nothing within the
/// limit would be visible. A factor above 1 zooms in.
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

#[cfg(test)]
mod tests {
    use super::*;

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
