//! Layout of the page Fit: time charts above the response. Texts have fixed heights, charts share
//! the remaining height in proportion to their usual heights.
//!
//! ```text
//! chips
//! lane with the parts
//! charts over time: input, output in focus, further outputs
//! ----------------------------------------------------------
//! heading of the response
//! magnitude          | phase
//! partial coherence  | phase residual (in a low window: the phase goes down to here)
//! ```

use egui::{Rect, pos2};

/// Chip height \[pt\].
const CHIPS: f32 = 28.0;
/// Height of the lane with the record's parts \[pt\].
const LANE: f32 = 22.0;
/// Gap between charts \[pt\].
const GAP: f32 = 6.0;
/// Height of tick labels on a horizontal axis \[pt\].
pub(super) const TICKS: f32 = 15.0;
/// Gap between the time charts and the response \[pt\].
const SEPARATION: f32 = 10.0;
/// Height of the response heading \[pt\].
const HEADING: f32 = 22.0;
/// Height of a caption above a chart \[pt\].
const CAPTION: f32 = 16.0;
/// Usual chart height for the excited input \[pt\].
const INPUT: f32 = 62.0;
/// Usual chart height for the output in focus \[pt\].
const OUTPUT: f32 = 118.0;
/// Usual chart height for an additional output \[pt\].
const MORE_OUTPUT: f32 = 78.0;
/// Usual chart height for magnitude and phase \[pt\].
const BODE: f32 = 196.0;
/// Usual chart height for partial coherence and phase residual \[pt\].
const STRIP: f32 = 40.0;
/// Page height below which only one output and no phase residual are drawn \[pt\].
const LEAST_FULL: f32 = 660.0;
/// Gap between magnitude and phase \[pt\].
const BODE_GAP: f32 = 16.0;
/// Maximum count of additional outputs.
const MORE_OUTPUTS: usize = 2;

/// Areas on the page.
#[derive(Clone, Debug)]
pub(super) struct FitLayout {
    pub(super) chips: Rect,
    pub(super) lane: Rect,
    /// Charts over time: input, output in focus, additional outputs. The last includes its tick
    /// labels.
    pub(super) time: Vec<Rect>,
    /// Vertical position of the line between time charts and response.
    pub(super) separator: f32,
    pub(super) heading: Rect,
    pub(super) response: ResponseLayout,
}

/// Areas for the response, captions included.
#[derive(Clone, Copy, Debug)]
pub(super) struct ResponseLayout {
    pub(super) magnitude: CaptionedChart,
    pub(super) phase: CaptionedChart,
    pub(super) coherence: CaptionedChart,
    /// `None` in a low window, where the phase takes its room.
    pub(super) residual: Option<CaptionedChart>,
}

#[derive(Clone, Copy, Debug)]
pub(super) struct CaptionedChart {
    pub(super) caption: Rect,
    pub(super) chart: Rect,
    /// Whether the chart includes tick labels on its horizontal axis.
    pub(super) has_ticks: bool,
}

impl FitLayout {
    /// Divides an area. Of the `more_outputs` outputs that are to be drawn below the output in
    /// focus, at most [`MORE_OUTPUTS`] have a chart, in a low area none. Charts keep at least 0.3
    /// times their usual heights.
    pub(super) fn new(area: Rect, more_outputs: usize) -> Self {
        let is_full = area.height() >= LEAST_FULL;
        let more = if is_full {
            more_outputs.min(MORE_OUTPUTS)
        } else {
            0
        };
        let charts = 2 + more;
        let texts = CHIPS
            + LANE
            + GAP * charts as f32
            + TICKS
            + SEPARATION
            + HEADING
            + 2.0 * CAPTION
            + TICKS;
        let usual = INPUT + OUTPUT + MORE_OUTPUT * more as f32 + BODE + STRIP;
        let scale = ((area.height() - texts) / usual).max(0.3);
        let mut rows = Rows {
            area,
            y: area.top(),
        };
        let chips = rows.next(CHIPS);
        let lane = rows.next(LANE);
        let mut time = Vec::with_capacity(charts);
        for chart in 0..charts {
            let height = match chart {
                0 => INPUT,
                1 => OUTPUT,
                _ => MORE_OUTPUT,
            };
            rows.y += GAP;
            let ticks = if chart + 1 == charts { TICKS } else { 0.0 };
            time.push(rows.next(scale * height + ticks));
        }
        rows.y += SEPARATION;
        let separator = rows.y - 0.5 * SEPARATION;
        let heading = rows.next(HEADING);
        let response = ResponseLayout::new(&mut rows, scale, is_full);
        Self {
            chips,
            lane,
            time,
            separator,
            heading,
            response,
        }
    }
}

impl ResponseLayout {
    fn new(rows: &mut Rows, scale: f32, is_full: bool) -> Self {
        let upper_caption = rows.next(CAPTION);
        let upper = rows.next(scale * BODE);
        let lower_caption = rows.next(CAPTION);
        let lower = rows.next(scale * STRIP + TICKS);
        let [upper_captions, uppers, lower_captions, lowers] =
            [upper_caption, upper, lower_caption, lower].map(halves);
        let phase_chart = if is_full {
            uppers[1]
        } else {
            uppers[1].union(lowers[1])
        };
        let residual = if is_full {
            Some(CaptionedChart {
                caption: lower_captions[1],
                chart: lowers[1],
                has_ticks: true,
            })
        } else {
            None
        };
        Self {
            magnitude: CaptionedChart {
                caption: upper_captions[0],
                chart: uppers[0],
                has_ticks: false,
            },
            phase: CaptionedChart {
                caption: upper_captions[1],
                chart: phase_chart,
                has_ticks: !is_full,
            },
            coherence: CaptionedChart {
                caption: lower_captions[0],
                chart: lowers[0],
                has_ticks: true,
            },
            residual,
        }
    }
}

/// Rows from top to bottom.
struct Rows {
    area: Rect,
    y: f32,
}

impl Rows {
    fn next(&mut self, height: f32) -> Rect {
        let top = self.y;
        self.y += height;
        Rect::from_min_max(pos2(self.area.left(), top), pos2(self.area.right(), self.y))
    }
}

/// Returns the left and the right half of a row.
fn halves(row: Rect) -> [Rect; 2] {
    let middle = row.center().x;
    [
        row.with_max_x(middle - 0.5 * BODE_GAP),
        row.with_min_x(middle + 0.5 * BODE_GAP),
    ]
}

#[cfg(test)]
mod tests {
    use egui::vec2;

    use super::*;

    fn layout(height: f32) -> FitLayout {
        FitLayout::new(
            Rect::from_min_size(pos2(10.0, 20.0), vec2(900.0, height)),
            5,
        )
    }

    fn chart_height(layout: &FitLayout, chart: usize) -> f32 {
        layout.time[chart].height()
    }

    #[test]
    fn the_page_fills_its_area_and_a_low_one_has_one_output_and_no_residual() {
        for (height, charts) in [(760.0, 4), (940.0, 4), (580.0, 2)] {
            let layout = layout(height);
            assert_eq!(layout.time.len(), charts);
            assert_eq!(layout.response.residual.is_some(), charts == 4);
            let bottom = layout.response.coherence.chart.bottom();
            assert!((bottom - (20.0 + height)).abs() < 0.01, "{bottom}");
            assert_eq!(layout.response.phase.chart.bottom() == bottom, charts == 2);
        }
    }

    #[test]
    fn the_output_in_focus_is_the_highest_and_the_charts_do_not_overlap() {
        let layout = layout(760.0);
        assert!(chart_height(&layout, 1) > chart_height(&layout, 2));
        assert!(chart_height(&layout, 2) > chart_height(&layout, 0));
        for pair in layout.time.windows(2) {
            assert!(pair[0].bottom() < pair[1].top());
        }
    }
}
