//! Chart content: lines, areas and marks with error bars, over a linear or logarithmic axis.

use std::sync::Arc;

use egui::{Color32, Id, TextureId};

use gdcm_plot::figure::Range;
use gdcm_plot::figure::axis::FrequencyUnit;

use super::curve_style::CurveStyle;

/// Quantity along the horizontal axis.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum ChartAxis {
    /// Plain values.
    #[default]
    Linear,
    /// Angular frequencies \[rad/s\], drawn logarithmically and labelled in this unit.
    Frequency(FrequencyUnit),
}

impl ChartAxis {
    /// Returns a value's coordinate along the axis: the value or its logarithm.
    pub(super) fn place(self, value: f64) -> f64 {
        match self {
            Self::Linear => value,
            Self::Frequency(_) => value.log10(),
        }
    }
}

#[derive(Clone, Debug)]
pub struct ChartLine {
    /// Points in ascending order along the horizontal axis; on a linear axis, details finer than a
    /// pixel and points outside the view are not drawn.
    pub points: Arc<[[f64; 2]]>,
    pub color: Color32,
    /// Width \[pt\].
    pub width: f32,
    /// Length of the dashes \[pt\]; `None` for a solid line.
    pub dash: Option<f32>,
}

/// Length of short dashes \[pt\].
pub const DENSE_DASH: f32 = 5.0;

impl ChartLine {
    /// Creates a line with the style of a curve; dots are drawn as dashes.
    pub fn styled(points: Arc<[[f64; 2]]>, style: CurveStyle) -> Self {
        Self {
            points,
            color: style.color,
            width: style.width,
            dash: if style.is_broken() {
                Some(style.length)
            } else {
                None
            },
        }
    }
}

/// Area between two lines over the same x values.
#[derive(Clone, Debug)]
pub struct ChartArea {
    /// `[x, lower value, upper value]`.
    pub points: Vec<[f64; 3]>,
    pub color: Color32,
}

/// Marks in the same style.
#[derive(Clone, Debug)]
pub struct ChartMarks {
    /// `[x, value, half-length of the vertical error bar]`; a half-length of 0 means no bar.
    pub points: Vec<[f64; 3]>,
    /// Half-lengths of the horizontal error bars; empty if there are none.
    pub sideways: Vec<f64>,
    pub color: Color32,
    pub filled: bool,
    /// Whether the marks are crosses; otherwise they are circles.
    pub crosses: bool,
}

/// Highlighted range.
#[derive(Clone, Debug)]
pub struct ChartSpan {
    pub ends: [f64; 2],
    pub color: Color32,
}

/// Everything that a chart shows.
#[derive(Clone, Debug, Default)]
pub struct Chart<'a> {
    /// Title, with which the chart's accessible name begins.
    pub title: &'a str,
    /// Texts at the right end of the title line, with their colours.
    pub notes: Vec<(String, Color32)>,
    pub across: ChartAxis,
    /// Label on the horizontal axis; an empty label reduces the axis height.
    pub across_label: &'a str,
    pub value_label: &'a str,
    pub layout: ChartLayout,
    /// Whether the visible values always fill the height, as in charts over time and small charts;
    /// only the horizontal axis can then be zoomed and panned, and not beyond the data.
    pub fits_values: bool,
    /// Values shown, if not the range that fits the data; requires `fits_values`.
    pub values: Option<Range>,
    /// Horizontal range that is visible until a gesture changes it, if not the range that fits the
    /// data.
    pub whole_across: Option<Range>,
    /// Charts with the same group share the visible horizontal range.
    pub group: Option<Id>,
    /// Highlighted horizontal ranges.
    pub spans: Vec<ChartSpan>,
    /// Areas, below all lines.
    pub areas: Vec<ChartArea>,
    /// Lines, the last on top.
    pub lines: Vec<ChartLine>,
    /// Marks, on top of the lines.
    pub marks: Vec<ChartMarks>,
    /// Dotted vertical lines.
    pub verticals: Vec<f64>,
    /// Lower and upper end of the frequency band \[rad/s\], drawn as solid vertical lines in the
    /// accent colour.
    pub band_ends: Option<[f64; 2]>,
    /// Dashed horizontal lines.
    pub levels: Vec<f64>,
    /// Values between which the chart is shaded.
    pub tolerance: Option<ChartSpan>,
    /// Image below everything else.
    pub image: Option<ChartImage>,
}

/// Room around a chart's frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ChartLayout {
    /// Title line height; 0 for a chart without a title \[pt\].
    pub title_height: f32,
    /// Value axis width, sufficient for the longest number, so that stacked frames align \[pt\].
    pub value_axis_width: f32,
    /// Room to the right of the frame \[pt\].
    pub right_margin: f32,
    /// Whether the horizontal axis has tick labels.
    pub has_ticks_across: bool,
}

impl Default for ChartLayout {
    fn default() -> Self {
        Self {
            title_height: 18.0,
            value_axis_width: 54.0,
            right_margin: 8.0,
            has_ticks_across: true,
        }
    }
}

/// Image within ranges on both axes; its vertical axis shows frequencies \[rad/s\].
#[derive(Clone, Copy, Debug)]
pub struct ChartImage {
    /// Texture with the highest frequency at the top.
    pub texture: TextureId,
    /// Left and right edges.
    pub across: [f64; 2],
    /// Frequencies at the lower and upper edges \[rad/s\].
    pub omega: [f64; 2],
    /// Display unit for frequencies.
    pub unit: FrequencyUnit,
}

impl<'a> Chart<'a> {
    /// Creates an empty chart.
    pub fn new(
        title: &'a str,
        across: ChartAxis,
        across_label: &'a str,
        value_label: &'a str,
    ) -> Self {
        Self {
            title,
            across,
            across_label,
            value_label,
            ..Self::default()
        }
    }
}
