//! Cache for a pane's visible points, thinned to what the screen can show.

use std::sync::Arc;

use egui_plot::{PlotBounds, PlotPoint, PlotTransform};
pub use gdcm_plot::figure::condition_source::CurveId;
pub use gdcm_plot::figure::responses::{BodeCurve, LogFrequencies, Pane};
use gdcm_plot::figure::thinning::{Pixel, thinned};

use super::thinning::{pixel_of, runs_in_view};
use crate::gui::widgets::palette::Palette;

/// Panes, from top to bottom.
pub(crate) const PANES: [Pane; 2] = [Pane::Magnitude, Pane::Phase];

/// Margin around the view in which points are still drawn, as a share of the view, because lines
/// have a width.
const LINE_MARGIN: f64 = 0.02;
/// Margin around the view for dashed and dotted lines: a small pan must not change where the
/// pattern begins.
const PATTERN_MARGIN: f64 = 1.0;

/// Visible part of both axes, and the size of a pixel.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct VisiblePart {
    pub(super) bounds: PlotBounds,
    pub(super) pixel: Pixel,
}

impl VisiblePart {
    /// Returns the visible part for this `transform`; lines may deviate from their curves by
    /// `tolerance_pt` points.
    pub(super) fn new(transform: &PlotTransform, pixels_per_point: f32, tolerance_pt: f64) -> Self {
        Self {
            bounds: *transform.bounds(),
            pixel: pixel_of(transform, pixels_per_point, tolerance_pt),
        }
    }
}

/// A pane's visible points, cached because with a thousand models finding them takes longer than
/// drawing them.
#[derive(Clone, Debug, Default)]
pub(super) struct DrawnCurves {
    visible: Option<VisiblePart>,
    /// In the same order as the scene's curves.
    curves: Vec<DrawnCurve>,
    /// Number of curves thinned so far, from which serial numbers are made.
    made: u64,
}

/// A curve's thinned points, and the values from which they were computed.
#[derive(Clone, Debug)]
struct DrawnCurve {
    omega: Arc<[f64]>,
    values: Arc<[f64]>,
    /// Margin around the view, as a share of it; wider for dashed and dotted lines.
    margin: f64,
    /// Pieces of the line, separated by gaps and by parts outside the view.
    runs: Vec<Vec<PlotPoint>>,
    /// Serial number among all curves thinned so far.
    serial: u64,
}

impl DrawnCurves {
    /// Recomputes the points for curves that have changed since the last frame:
    ///
    /// 1. the same view and the same curves in the same order: nothing to do;
    /// 2. the same view: unchanged curves keep their points, also at another place in the order;
    ///    in another view, no points are kept;
    /// 3. for the other curves, cut out the visible points and thin them, with a new serial number.
    pub(super) fn update(
        &mut self,
        curves: &[BodeCurve],
        pane: Pane,
        visible: VisiblePart,
        palette: &Palette,
    ) {
        // Step 1.
        if self.visible == Some(visible) && self.are_drawn_from(curves, pane, palette) {
            return;
        }
        // Step 2.
        let mut reusable: Vec<Option<DrawnCurve>> = Vec::new();
        if self.visible == Some(visible) {
            reusable.extend(self.curves.drain(..).map(Some));
        }
        self.visible = Some(visible);
        let mut axis = LogFrequencies::default();
        let mut drawn = Vec::with_capacity(curves.len());
        for (index, curve) in curves.iter().enumerate() {
            let margin = margin(curve, palette);
            let place = reusable_place(&reusable, index, |drawn| {
                drawn.is_drawn_from(curve, pane, margin)
            });
            drawn.push(match place.and_then(|place| reusable[place].take()) {
                Some(unchanged) => unchanged,
                None => {
                    // Step 3.
                    let points = curve.points_on(&mut axis, pane);
                    let runs = runs_in_view(points, &visible.bounds, margin);
                    self.made += 1;
                    DrawnCurve {
                        omega: Arc::clone(&curve.omega),
                        values: Arc::clone(curve.shared_values(pane)),
                        margin,
                        runs: runs.iter().map(|run| thin(run, visible.pixel)).collect(),
                        serial: self.made,
                    }
                }
            });
        }
        self.curves = drawn;
    }

    /// Returns whether the cached points belong to exactly these curves, in this order.
    fn are_drawn_from(&self, curves: &[BodeCurve], pane: Pane, palette: &Palette) -> bool {
        self.curves.len() == curves.len()
            && self
                .curves
                .iter()
                .zip(curves)
                .all(|(drawn, curve)| drawn.is_drawn_from(curve, pane, margin(curve, palette)))
    }

    /// Returns the pieces of the curve at an index.
    pub(super) fn runs(&self, index: usize) -> &[Vec<PlotPoint>] {
        match self.curves.get(index) {
            Some(curve) => &curve.runs,
            None => &[],
        }
    }

    /// Returns a serial number for a curve's lines, which changes whenever they are recomputed.
    pub(super) fn serial(&self, index: usize) -> u64 {
        self.curves.get(index).map_or(0, |curve| curve.serial)
    }
}

/// Returns the index of the curve in `reusable` for which `matches` returns true. The index
/// `likely` is tried first, because curves usually keep their order.
fn reusable_place(
    reusable: &[Option<DrawnCurve>],
    likely: usize,
    matches: impl Fn(&DrawnCurve) -> bool,
) -> Option<usize> {
    let is_match = |drawn: &Option<DrawnCurve>| drawn.as_ref().is_some_and(&matches);
    if reusable.get(likely).is_some_and(is_match) {
        return Some(likely);
    }
    reusable.iter().position(is_match)
}

fn thin(run: &[[f64; 2]], pixel: Pixel) -> Vec<PlotPoint> {
    thinned(run, pixel)
        .into_iter()
        .map(PlotPoint::from)
        .collect()
}

impl DrawnCurve {
    /// Returns whether the points were computed from the present values of `curve` with this
    /// margin.
    fn is_drawn_from(&self, curve: &BodeCurve, pane: Pane, margin: f64) -> bool {
        self.margin == margin
            && are_same(&self.values, curve.shared_values(pane))
            && are_same(&self.omega, &curve.omega)
    }
}

/// Returns whether two slices are equal bit by bit (gaps are NaN); usually they have the same
/// address, which is compared first.
fn are_same(one: &Arc<[f64]>, other: &Arc<[f64]>) -> bool {
    Arc::ptr_eq(one, other)
        || one
            .iter()
            .map(|value| value.to_bits())
            .eq(other.iter().map(|value| value.to_bits()))
}

/// Returns the margin around the view in which a curve is drawn, as a share of the view.
fn margin(curve: &BodeCurve, palette: &Palette) -> f64 {
    if palette.role_style(curve.role, curve.rejected).is_broken() {
        PATTERN_MARGIN
    } else {
        LINE_MARGIN
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::gui::plot::tests::sample_curve as curve;

    const PIXEL: Pixel = Pixel {
        width: 0.01,
        tolerance: 0.01,
    };

    fn view(height: f64) -> VisiblePart {
        VisiblePart {
            bounds: PlotBounds::from_min_max([0.0, 0.0], [1.0, height]),
            pixel: PIXEL,
        }
    }

    fn update(drawn: &mut DrawnCurves, curves: &[BodeCurve], height: f64) {
        drawn.update(curves, Pane::Magnitude, view(height), &Palette::dark());
    }

    /// Memory addresses of the points, which change when the points are recomputed.
    fn places(drawn: &DrawnCurves) -> Vec<*const PlotPoint> {
        drawn
            .curves
            .iter()
            .map(|curve| curve.runs[0].as_ptr())
            .collect()
    }

    #[test]
    fn points_are_kept_until_their_curve_or_the_view_changes() {
        let mut drawn = DrawnCurves::default();
        let mut curves = vec![curve(0, &[1.0, 9.0, 5.0]), curve(1, &[1.0; 3])];
        update(&mut drawn, &curves, 10.0);
        let first = places(&drawn);
        curves[0].highlighted = true;
        update(&mut drawn, &curves, 10.0);
        assert_eq!(
            places(&drawn),
            first,
            "the style does not change the points"
        );
        curves.swap(0, 1);
        update(&mut drawn, &curves, 10.0);
        assert_eq!(places(&drawn), [first[1], first[0]], "nor does the order");
        curves[0] = curve(1, &[2.0; 3]);
        update(&mut drawn, &curves, 10.0);
        assert_eq!(places(&drawn)[1], first[0]);
        assert_eq!(drawn.runs(0)[0][0].y, 2.0);
        assert_eq!(
            [drawn.serial(0), drawn.serial(1)],
            [3, 1],
            "a recomputed curve has a new number"
        );
        // The remaining curve, with the values 1, 9 and 5, lies above the view, which ends at 0.5.
        update(&mut drawn, &curves[1..], 0.5);
        assert!(drawn.runs(0).is_empty());
    }

    #[test]
    fn a_missing_curve_has_no_points() {
        assert!(DrawnCurves::default().runs(3).is_empty());
    }
}
