//! Pane as last drawn, kept between frames: transform, visible points, and the image that replaces
//! many static curves.

use egui::Context;
use egui_plot::PlotTransform;

use super::cached_raster::{CachedRaster, MANY, RasterImage, RasterScene};
use super::curve_layer::{add_curve_lines, lies_at_the_bottom};
use super::drawn_curves::{BodeCurve, DrawnCurves};
use crate::gui::widgets::palette::Palette;

/// Pane as last drawn: transform, lines, and the image of its static lines.
#[derive(Clone, Debug, Default)]
pub(super) struct DrawnPane {
    /// Transform as last drawn, where x is `log10 omega`; `None` if there was nothing to draw.
    pub(super) transform: Option<PlotTransform>,
    pub(super) curves: DrawnCurves,
    pub(super) image: CachedRaster,
}

impl DrawnPane {
    /// Returns the image of the curves at the bottom if these are static and at least
    /// [`MANY`] in number.
    pub(super) fn image_of_many(
        &mut self,
        ctx: &Context,
        curves: &[BodeCurve],
        transform: &PlotTransform,
        palette: &Palette,
    ) -> Option<RasterImage> {
        let mut lowest: Vec<(usize, &BodeCurve)> = curves
            .iter()
            .enumerate()
            .filter(|(_, curve)| lies_at_the_bottom(curve))
            .collect();
        if lowest.len() < MANY {
            return None;
        }
        lowest.sort_by_key(|(_, curve)| curve.role.layer(curve.rejected));
        let drawn = &self.curves;
        let mut lines = Vec::with_capacity(lowest.len());
        let mut still = RasterScene {
            frame: *transform.frame(),
            pixels_per_point: ctx.pixels_per_point(),
            curves: Vec::with_capacity(lowest.len()),
        };
        for (index, curve) in lowest {
            let style = palette.role_style(curve.role, curve.rejected);
            still.curves.push((drawn.serial(index), style));
            lines.push((drawn.runs(index), style));
        }
        self.image.image_of(ctx, still, || {
            let mut shapes = Vec::new();
            for (runs, style) in lines {
                add_curve_lines(runs, style, transform, &mut shapes);
            }
            shapes
        })
    }
}
