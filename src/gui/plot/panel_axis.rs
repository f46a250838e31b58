//! Panel axis: ticks, label and thickness.

use std::ops::RangeInclusive;

use egui::{FontId, RichText};
use egui_plot::{Axis, AxisHints, GridInput, GridMark};

use super::ticks::{LABEL_SPACING, Ticks, named_marks};
use crate::gui::widgets::palette::{Palette, SMALL_SIZE};

/// Font size for tick labels \[pt\].
const TICK_SIZE: f32 = 11.0;
/// Height of an axis with tick labels only \[pt\].
pub(super) const TICKS_HEIGHT: f32 = 15.0;
/// Height of an axis with tick labels and an axis label \[pt\].
pub(super) const LABELLED_HEIGHT: f32 = 33.0;

pub(super) fn tick_font() -> FontId {
    FontId::proportional(TICK_SIZE)
}

#[derive(Clone, Debug)]
pub(super) struct PanelAxis {
    pub(super) ticks: Ticks,
    pub(super) spacing: TickSpacing,
    /// Quantity and unit beside the tick labels; may be empty.
    pub(super) label: String,
    /// Height if the axis is horizontal, width if it is vertical \[pt\].
    pub(super) thickness: f32,
    /// Whether tick labels and axis label are drawn; otherwise the axis takes no room and only its
    /// grid lines are drawn.
    pub(super) is_drawn: bool,
    /// In a low plot, labels move closer together until there are this many, as far as they fit.
    pub(super) least_labels: usize,
}

/// Spacing of the tick labels on an axis.
#[derive(Clone, Debug)]
pub(super) enum TickSpacing {
    /// Usual spacing for this kind of ticks.
    Usual,
    /// Like `Usual`, with room for the widest number; `digit_pt` is a digit's width \[pt\].
    WidestNumber { digit_pt: f64 },
    /// Names at 0, 1, 2 …, instead of numbers, without grid lines; `widest_pt` is the widest name's
    /// width \[pt\].
    Names { names: Vec<String>, widest_pt: f64 },
}

impl PanelAxis {
    /// Creates an axis with tick labels and without an axis label; `thickness` in \[pt\].
    pub(super) fn new(ticks: Ticks, thickness: f32) -> Self {
        Self {
            ticks,
            spacing: TickSpacing::Usual,
            label: String::new(),
            thickness,
            is_drawn: true,
            least_labels: 2,
        }
    }

    pub(super) fn labelled(self, label: impl Into<String>) -> Self {
        Self {
            label: label.into(),
            ..self
        }
    }

    pub(super) fn has_grid(&self) -> bool {
        !matches!(self.spacing, TickSpacing::Names { .. })
    }

    /// Returns the function that places ticks and grid lines; egui_plot calls it with the visible
    /// range and with the length of a point in axis coordinates, `base_step_size`.
    pub(super) fn spacer(&self) -> impl Fn(GridInput) -> Vec<GridMark> + use<> {
        let ticks = self.ticks;
        let spacing = self.spacing.clone();
        let least = self.least_labels;
        move |input| match &spacing {
            TickSpacing::Usual => {
                ticks.marks_with_labels(input.bounds, input.base_step_size, least)
            }
            TickSpacing::WidestNumber { digit_pt } => {
                ticks.horizontal_marks(input.bounds, input.base_step_size, *digit_pt)
            }
            TickSpacing::Names { names, widest_pt } => named_marks(&input, names.len(), *widest_pt),
        }
    }

    /// Returns the axis as egui_plot draws it; empty if it is not drawn.
    pub(super) fn hints<'a>(&self, side: Axis, palette: &Palette) -> Vec<AxisHints<'a>> {
        if !self.is_drawn {
            return Vec::new();
        }
        let ticks = self.ticks;
        let spacing = self.spacing.clone();
        let mut hints = AxisHints::new(side)
            .formatter(move |mark, _: &RangeInclusive<f64>| mark_text(ticks, &spacing, mark))
            .min_thickness(self.thickness)
            .label_spacing(LABEL_SPACING)
            .tick_label_color(palette.text)
            .tick_label_font(tick_font());
        if !self.label.is_empty() {
            let label = RichText::new(&self.label)
                .size(SMALL_SIZE)
                .color(palette.dim_text);
            hints = hints.label(label);
        }
        vec![hints]
    }
}

/// Returns the tick label at a mark: a number or a name.
fn mark_text(ticks: Ticks, spacing: &TickSpacing, mark: GridMark) -> String {
    match spacing {
        TickSpacing::Usual | TickSpacing::WidestNumber { .. } => ticks.text(mark),
        TickSpacing::Names { names, .. } => names
            .get(mark.value.round() as usize)
            .cloned()
            .unwrap_or_default(),
    }
}
