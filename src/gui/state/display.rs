//! Display state; none of it changes a result.

use std::collections::BTreeMap;

use super::curve_display::CurveDisplay;
use super::frequency_plots::FrequencyPlots;
use super::gain_display::GainDisplay;
use super::judging_display::JudgingDisplay;
use super::layout::Layout;
use super::physics_display::PhysicsDisplay;
use super::poles_display::PolesDisplay;
use super::selection::Selection;
use super::view::View;
use super::view_pages::ViewPages;
use crate::gui::plot::FigureView;

/// Display state; none of it changes a result.
#[derive(Debug, Default)]
pub struct Display {
    pub selection: Selection,
    pub layout: Layout,
    pub curves: CurveDisplay,
    pub frequency: FrequencyPlots,
    pub gains: GainDisplay,
    pub physics: PhysicsDisplay,
    pub poles: PolesDisplay,
    pub judging: JudgingDisplay,
    pub pages: ViewPages,
    /// Figures of the views, kept between frames.
    pub figures: BTreeMap<View, FigureView>,
}
