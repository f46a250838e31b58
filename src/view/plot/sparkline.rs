//! Curves without axes, in the little room of a table's cell.

use egui::{Painter, Pos2, Rect, Shape, pos2, remap};
use egui_plot::LineStyle;

use super::curve::{BodeCurve, Pane};
use super::range::Range;
use crate::view::palette::Palette;

/// Least distance between two drawn points \[pt\]: more would be drawn on top of one another.
const POINT_GAP: f32 = 1.5;
/// Width of lines here as a part of that in a full plot.
const WIDTH_PART: f32 = 0.72;

/// The curves of one pane in a small rectangle.
pub(super) struct Sparkline<'a> {
    pub(super) curves: &'a [BodeCurve],
    pub(super) pane: Pane,
    /// Frequencies in view, as `log10 omega`.
    pub(super) log_omega: Range,
    pub(super) rect: Rect,
}

impl Sparkline<'_> {
    /// The values in view: all of them, with a little space above and below.
    pub(super) fn values(&self) -> Option<Range> {
        let values = Range::of(
            self.curves
                .iter()
                .flat_map(|curve| curve.values(self.pane).iter().copied()),
        )?;
        Some(values.with_margin(0.06, 1.0))
    }

    /// Draws the curves; what matters most comes last, on top.
    pub(super) fn paint(&self, painter: &Painter, palette: &Palette) {
        let Some(values) = self.values() else { return };
        let mut curves: Vec<&BodeCurve> = self.curves.iter().collect();
        curves.sort_by_key(|curve| (curve.highlighted, curve.role.layer(curve.rejected)));
        for curve in curves {
            let mut look = curve.role.look(curve.rejected, palette);
            look.width *= WIDTH_PART;
            look.style = match look.style {
                LineStyle::Solid => LineStyle::Solid,
                LineStyle::Dashed { .. } => LineStyle::Dashed { length: 4.0 },
                LineStyle::Dotted { .. } => LineStyle::Dotted { spacing: 3.5 },
            };
            if curve.highlighted {
                look = look.emphasized();
            }
            let shapes = self
                .paths(curve, values)
                .into_iter()
                .flat_map(|path| look.shapes(&path));
            painter.extend(shapes.collect::<Vec<Shape>>());
        }
    }

    /// The finite runs of a curve on the screen, thinned to what can be told apart.
    fn paths(&self, curve: &BodeCurve, values: Range) -> Vec<Vec<Pos2>> {
        let (rect, log_omega) = (self.rect, self.log_omega);
        let position = |[x, y]: [f64; 2]| {
            let x = remap(
                x,
                log_omega.min..=log_omega.max,
                f64::from(rect.left())..=f64::from(rect.right()),
            );
            let y = remap(
                y,
                values.min..=values.max,
                f64::from(rect.bottom())..=f64::from(rect.top()),
            );
            pos2(x as f32, y as f32)
        };
        let mut paths = vec![Vec::new()];
        let mut previous: Option<Pos2> = None;
        for point in curve.points(self.pane) {
            if !point.iter().all(|c| c.is_finite()) {
                // The last point before a gap counts, however close it is to the one before.
                extend_last(&mut paths, previous.take());
                paths.push(Vec::new());
                continue;
            }
            let at = position(point);
            let is_far = paths
                .last()
                .and_then(|path| path.last())
                .is_none_or(|last: &Pos2| last.distance(at) >= POINT_GAP);
            if is_far {
                extend_last(&mut paths, Some(at));
                previous = None;
            } else {
                previous = Some(at);
            }
        }
        extend_last(&mut paths, previous);
        paths.retain(|path| path.len() > 1);
        paths
    }
}

fn extend_last(paths: &mut [Vec<Pos2>], point: Option<Pos2>) {
    if let Some(path) = paths.last_mut() {
        path.extend(point);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::view::plot::curve::CurveId;
    use crate::view::plot::role::Role;

    fn paths(magnitude_db: Vec<f64>) -> Vec<Vec<Pos2>> {
        let count = magnitude_db.len();
        let omega: Vec<f64> = (0..count).map(|k| 10f64.powf(k as f64 / (count - 1) as f64)).collect();
        let curve = BodeCurve {
            id: CurveId(0),
            label: String::new(),
            detail: String::new(),
            role: Role::Perturbed,
            rejected: false,
            highlighted: false,
            omega: omega.into(),
            magnitude_db: magnitude_db.into(),
            phase_deg: Vec::new().into(),
        };
        let rect = Rect::from_min_max(pos2(0.0, 0.0), pos2(100.0, 50.0));
        let curves = [curve];
        let line = Sparkline {
            curves: &curves,
            pane: Pane::Magnitude,
            log_omega: Range::new(0.0, 1.0),
            rect,
        };
        line.values()
            .map(|values| line.paths(&curves[0], values))
            .unwrap_or_default()
    }

    #[test]
    fn more_points_than_pixels_are_thinned_but_both_ends_stay() {
        let paths = paths(vec![1.0; 5000]);
        assert_eq!(paths.len(), 1);
        assert!(paths[0].len() <= 70, "{}", paths[0].len());
        assert!(paths[0][0].x.abs() < 0.01);
        assert!(paths[0].last().is_some_and(|end| (end.x - 100.0).abs() < 0.01));
    }

    #[test]
    fn a_gap_splits_a_sparkline() {
        let values = (0..200).map(|k| if k == 100 { f64::NAN } else { 0.0 }).collect();
        assert_eq!(paths(values).len(), 2);
    }
}
