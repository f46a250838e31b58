//! Chart content: lines, bands and marks with error bars over a linear or logarithmic axis.

use std::sync::Arc;

use egui::{Color32, Id, TextureId};

use gdcm_plot::figure::axis::FrequencyUnit;

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
    /// Returns a value's place along the axis.
    pub(super) fn place(self, value: f64) -> f64 {
        match self {
            Self::Linear => value,
            Self::Frequency(_) => value.log10(),
        }
    }
}

/// Chart line.
#[derive(Clone, Debug)]
pub struct ChartLine {
    /// Points, ascending along the horizontal axis; invisible points and details finer than a pixel
    /// are not drawn.
    pub points: Arc<[[f64; 2]]>,
    pub color: Color32,
    /// Width \[pt\].
    pub width: f32,
    pub dashed: bool,
}

/// Area between two lines over the same places.
#[derive(Clone, Debug)]
pub struct ChartBand {
    /// Places, lower and upper values.
    pub points: Vec<[f64; 3]>,
    pub color: Color32,
}

/// Marks with the same style.
#[derive(Clone, Debug)]
pub struct ChartMarks {
    /// Places, values, and vertical error bars (half-lengths, 0 for none).
    pub points: Vec<[f64; 3]>,
    /// Half-lengths of the horizontal error bars; empty for none.
    pub sideways: Vec<f64>,
    pub color: Color32,
    pub filled: bool,
    /// Whether the marks are crosses instead of circles.
    pub crosses: bool,
}

/// Marked horizontal stretch.
#[derive(Clone, Debug)]
pub struct ChartSpan {
    pub ends: [f64; 2],
    pub color: Color32,
}

/// Content of a chart.
#[derive(Clone, Debug, Default)]
pub struct Chart<'a> {
    /// Title, which is also its accessible name.
    pub title: &'a str,
    /// Words right in the title line, with their colours.
    pub notes: Vec<(String, Color32)>,
    pub across: ChartAxis,
    /// Horizontal label; an empty label keeps the axis low.
    pub across_label: &'a str,
    pub value_label: &'a str,
    /// Whether the visible values fill the height: then only the horizontal axis can be zoomed and
    /// panned.
    pub fits_values: bool,
    /// Charts in a group share the visible horizontal stretch.
    pub group: Option<Id>,
    /// Marked stretches.
    pub spans: Vec<ChartSpan>,
    /// Areas, below all lines.
    pub bands: Vec<ChartBand>,
    /// Lines, the last on top.
    pub lines: Vec<ChartLine>,
    /// Marks, on top of the lines.
    pub marks: Vec<ChartMarks>,
    pub verticals: Vec<f64>,
    /// Image below everything else.
    pub image: Option<ChartImage>,
    /// Whether dragging chooses a horizontal stretch instead of panning;
    /// [`chosen_stretch`](super::stretch::chosen_stretch) returns it for the group.
    pub chooses: bool,
}

/// Image over a stretch along both axes; the vertical axis shows frequencies \[rad/s\].
#[derive(Clone, Copy, Debug)]
pub struct ChartImage {
    /// Texture with the highest frequency at the top.
    pub texture: TextureId,
    /// Left and right edge.
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
