//! Curves as egui_plot draws them, with the patterns of their roles.

use std::ops::RangeInclusive;

use egui::{Color32, Pos2, Shape, Ui};
use egui_plot::{PlotBounds, PlotGeometry, PlotItem, PlotItemBase, PlotPoint, PlotTransform};

use super::line_look::LineLook;

/// A curve of one or more runs of points, drawn as its look says. Pointing at it is not egui_plot's business.
pub(super) struct CurveItem<'a> {
    base: PlotItemBase,
    runs: &'a [Vec<PlotPoint>],
    look: LineLook,
}

impl<'a> CurveItem<'a> {
    /// The curve through each of `runs`.
    pub(super) fn new(runs: &'a [Vec<PlotPoint>], look: LineLook) -> Self {
        Self { base: PlotItemBase::new(String::new()), runs, look }
    }

    /// What it is drawn of, in screen coordinates.
    pub(super) fn lines(&self, transform: &PlotTransform) -> Vec<Shape> {
        let mut shapes = Vec::new();
        for run in self.runs {
            let path: Vec<Pos2> = run.iter().map(|point| transform.position_from_point(point)).collect();
            self.look.add_shapes(path, &mut shapes);
        }
        shapes
    }
}

impl PlotItem for CurveItem<'_> {
    fn shapes(&self, _: &Ui, transform: &PlotTransform, shapes: &mut Vec<Shape>) {
        shapes.append(&mut self.lines(transform));
    }

    fn initialize(&mut self, _: RangeInclusive<f64>) {}

    fn color(&self) -> Color32 {
        self.look.color
    }

    fn allow_hover(&self) -> bool {
        false
    }

    fn geometry(&self) -> PlotGeometry<'_> {
        PlotGeometry::None
    }

    fn bounds(&self) -> PlotBounds {
        PlotBounds::NOTHING
    }

    fn base(&self) -> &PlotItemBase {
        &self.base
    }

    fn base_mut(&mut self) -> &mut PlotItemBase {
        &mut self.base
    }
}
