//! The least that a screen can show, in the units of a plot.

use egui_plot::PlotTransform;

/// The least that a screen can show, in the units of a plot.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Pixel {
    /// Width of a column of pixels, in units of x.
    pub(super) width: f64,
    /// How far from a curve a line may be drawn, in units of y.
    pub(super) tolerance: f64,
}

impl Pixel {
    /// The pixel of a plot drawn as `transform` says, where lines may be `tolerance_pt` points away from their curves.
    pub(super) fn of(transform: &PlotTransform, pixels_per_point: f32, tolerance_pt: f64) -> Self {
        let [x_per_point, y_per_point] = transform.dvalue_dpos().map(f64::abs);
        Self { width: x_per_point / f64::from(pixels_per_point), tolerance: tolerance_pt * y_per_point }
    }

    /// Splits points, ascending in x, into those of each column of pixels.
    pub(super) fn columns(self, points: &[[f64; 2]]) -> impl Iterator<Item = &[[f64; 2]]> {
        let mut rest = points;
        std::iter::from_fn(move || {
            let first = rest.first()?;
            let end = ((first[0] / self.width).floor() + 1.0) * self.width;
            // By rounding, the end may come out at the first point itself.
            let count = rest.iter().take_while(|point| point[0] < end).count().max(1);
            let (column, others) = rest.split_at(count);
            rest = others;
            Some(column)
        })
    }
}
