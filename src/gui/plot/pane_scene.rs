//! Bode pane with its place, content and cursor.

use egui::Rect;

use super::bode_scene::BodeScene;
use super::curve_layer::CurveLooks;
use super::drawn_curves::Pane;
use crate::gui::widgets::palette::Palette;

#[derive(Clone, Copy)]
pub(super) struct PaneScene<'a> {
    pub(super) pane: Pane,
    /// Area that the pane and its axes fill.
    pub(super) rect: Rect,
    pub(super) scene: &'a BodeScene<'a>,
    pub(super) looks: CurveLooks<'a>,
    /// `log10 omega` under the pointer, in either pane or in another plot.
    pub(super) cursor: Option<f64>,
    pub(super) palette: &'a Palette,
}
