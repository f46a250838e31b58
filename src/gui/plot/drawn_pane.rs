//! Pane as last drawn, kept between frames: transform, visible points, and the image that replaces
//! many static curves.

use egui::{Context, Shape};
use egui_plot::PlotTransform;

use super::cached_raster::{CachedRaster, MANY, RasterImage, RasterScene};
use super::curve_layer::{CurveLooks, add_curve_lines, lies_at_the_bottom};
use super::curve_style::CurveStyle;
use super::drawn_curves::{BodeCurve, DrawnCurves};
use crate::gui::widgets::palette::Palette;

/// Minimum number of curves in a small plot that are replaced by an image.
const MANY_IN_MINIATURE: usize = 8;

/// Pane as last drawn: transform, lines, and the image that shows its static lines.
#[derive(Clone, Debug, Default)]
pub(super) struct DrawnPane {
    /// Transform as last drawn, where x is `log10 omega`; `None` before the first drawing.
    pub(super) transform: Option<PlotTransform>,
    pub(super) curves: DrawnCurves,
    pub(super) image: CachedRaster,
}

impl DrawnPane {
    /// Returns an image that shows the curves at the bottom, if these are static and at least
    /// [`MANY`] in number; `None` also if the image would be too large.
    pub(super) fn image_of_many(
        &mut self,
        ctx: &Context,
        curves: &[BodeCurve],
        transform: &PlotTransform,
        looks: CurveLooks<'_>,
        palette: &Palette,
    ) -> Option<RasterImage> {
        let lowest = LowestCurves::new(curves, looks, palette);
        if lowest.curves.len() < MANY {
            return None;
        }
        let scene = lowest.scene(ctx, transform, &self.curves);
        let drawn = &self.curves;
        self.image
            .image_once_static(ctx, scene, || lowest.shapes(transform, drawn))
    }

    /// Returns an image that shows the curves at the bottom of a small plot, if these are at least
    /// [`MANY_IN_MINIATURE`] in number. As triangles, the lines in all overview cells would take
    /// tens of megabytes.
    pub(super) fn image_in_miniature(
        &mut self,
        ctx: &Context,
        curves: &[BodeCurve],
        transform: &PlotTransform,
        looks: CurveLooks<'_>,
        palette: &Palette,
    ) -> Option<RasterImage> {
        let lowest = LowestCurves::new(curves, looks, palette);
        if lowest.curves.len() < MANY_IN_MINIATURE {
            return None;
        }
        let scene = lowest.scene(ctx, transform, &self.curves);
        let drawn = &self.curves;
        self.image
            .image_at_once(ctx, scene, || lowest.shapes(transform, drawn))
    }
}

/// Curves in the lowest layers ([`lies_at_the_bottom`]), from bottom to top.
struct LowestCurves {
    /// Index in the scene, and style.
    curves: Vec<(usize, CurveStyle)>,
}

impl LowestCurves {
    fn new(curves: &[BodeCurve], looks: CurveLooks<'_>, palette: &Palette) -> Self {
        let mut lowest: Vec<(usize, &BodeCurve)> = curves
            .iter()
            .enumerate()
            .filter(|(_, curve)| lies_at_the_bottom(curve))
            .collect();
        lowest.sort_by_key(|(_, curve)| curve.role.layer(curve.rejected));
        let mut styled = Vec::with_capacity(lowest.len());
        for (index, curve) in lowest {
            styled.push((index, looks.resting_style(curve, palette)));
        }
        Self { curves: styled }
    }

    fn scene(&self, ctx: &Context, transform: &PlotTransform, drawn: &DrawnCurves) -> RasterScene {
        let mut scene = RasterScene {
            frame: *transform.frame(),
            pixels_per_point: ctx.pixels_per_point(),
            curves: Vec::with_capacity(self.curves.len()),
        };
        for (index, style) in &self.curves {
            scene.curves.push((drawn.serial(*index), *style));
        }
        scene
    }

    fn shapes(&self, transform: &PlotTransform, drawn: &DrawnCurves) -> Vec<Shape> {
        let mut shapes = Vec::new();
        for (index, style) in &self.curves {
            add_curve_lines(drawn.runs(*index), *style, transform, &mut shapes);
        }
        shapes
    }
}
