//! Display state; no result depends on it.

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
    /// Each view's figure, kept between frames.
    pub figures: BTreeMap<View, FigureView>,
}
