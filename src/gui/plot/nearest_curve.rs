//! Curves under the pointer or in a selection box: the nearest curve, not the topmost, and all
//! curves through an area.

use egui::{Pos2, Rect, pos2, vec2};
use egui_plot::{PlotPoint, PlotTransform};

use gdcm_plot::figure::Range;

use super::drawn_curves::{BodeCurve, CurveId, LogFrequencies, Pane};
use super::thinning::is_finite;

/// Maximum distance between the pointer and a picked curve \[pt\].
pub const PICK_RADIUS: f32 = 8.0;

/// Curve under the pointer.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Hit {
    /// Index among the scene's curves.
    pub(super) curve: usize,
    /// Frequency at which the curve is nearest to the pointer \[rad/s\].
    pub(super) omega: f64,
    /// Distance from the pointer \[pt\].
    pub(super) distance: f32,
}

/// Returns the curve nearest to `pointer` within [`PICK_RADIUS`]; among equally near curves, the
/// topmost.
pub(super) fn nearest_curve(
    curves: &[BodeCurve],
    pane: Pane,
    pointer: Pos2,
    transform: &PlotTransform,
) -> Option<Hit> {
    // The best hit so far, and its curve's layer.
    let mut best: Option<(Hit, usize)> = None;
    let mut axis = LogFrequencies::default();
    let [min, max] = [-PICK_RADIUS, PICK_RADIUS]
        .map(|dx| transform.value_from_position(pointer + vec2(dx, 0.0)).x);
    for (index, curve) in curves.iter().enumerate() {
        let points = curve.points_between(&mut axis, pane, Range { min, max });
        let Some(closest) = closest_point(points, pointer, transform) else {
            continue;
        };
        let layer = curve.role.layer(curve.rejected);
        let is_better = match best {
            None => true,
            Some((hit, best_layer)) => {
                closest.distance < hit.distance
                    || (closest.distance == hit.distance && layer > best_layer)
            }
        };
        if closest.distance <= PICK_RADIUS && is_better {
            let omega = 10f64.powf(transform.value_from_position(closest.position).x);
            let hit = Hit {
                curve: index,
                omega,
                distance: closest.distance,
            };
            best = Some((hit, layer));
        }
    }
    best.map(|(hit, _)| hit)
}

/// Returns the curves that run through an area on the screen.
pub(super) fn curves_in(
    curves: &[BodeCurve],
    pane: Pane,
    area: Rect,
    transform: &PlotTransform,
) -> Vec<CurveId> {
    let mut axis = LogFrequencies::default();
    let [min, max] =
        [area.left(), area.right()].map(|x| transform.value_from_position(pos2(x, area.top())).x);
    let mut found = Vec::new();
    for curve in curves {
        let points = curve.points_between(&mut axis, pane, Range { min, max });
        if runs_through(points, area, transform) {
            found.push(curve.id.clone());
        }
    }
    found
}

/// Returns whether a line through `points`, with gaps at non-finite points, meets `area`.
fn runs_through(
    points: impl Iterator<Item = [f64; 2]>,
    area: Rect,
    transform: &PlotTransform,
) -> bool {
    let mut previous: Option<Pos2> = None;
    for point in points {
        let position = position_of(point, transform);
        if let (Some(from), Some(to)) = (previous, position)
            && meets(from, to, area)
        {
            return true;
        }
        previous = position;
    }
    false
}

/// Returns where a point lies on the screen; `None` for a gap.
fn position_of(point: [f64; 2], transform: &PlotTransform) -> Option<Pos2> {
    if is_finite(&point) {
        Some(transform.position_from_point(&PlotPoint::from(point)))
    } else {
        None
    }
}

/// Returns whether a segment passes through `area`.
///
/// Each pair of edges limits t in the segment `from + t (to - from)`, 0 <= t <= 1, to an interval
/// (Liang and Barsky, "A new concept and method for line clipping", ACM TOG 3(1), 1984); the
/// segment meets the area if these intervals intersect.
fn meets(from: Pos2, to: Pos2, area: Rect) -> bool {
    let along = to - from;
    let mut first = 0.0f32;
    let mut last = 1.0f32;
    for (start, step, low, high) in [
        (from.x, along.x, area.left(), area.right()),
        (from.y, along.y, area.top(), area.bottom()),
    ] {
        if step == 0.0 {
            if !(low..=high).contains(&start) {
                return false;
            }
            continue;
        }
        let ends = [(low - start) / step, (high - start) / step];
        first = first.max(ends[0].min(ends[1]));
        last = last.min(ends[0].max(ends[1]));
    }
    first <= last
}

/// Point nearest to the pointer.
#[derive(Clone, Copy, Debug)]
pub(super) struct ClosestPoint {
    pub(super) position: Pos2,
    /// Distance from the pointer \[pt\].
    pub(super) distance: f32,
}

/// Returns the point on a line nearest to `pointer`; `None` if no part lies within [`PICK_RADIUS`]
/// horizontally.
pub(super) fn closest_point(
    points: impl Iterator<Item = [f64; 2]>,
    pointer: Pos2,
    transform: &PlotTransform,
) -> Option<ClosestPoint> {
    let near = pointer.x - PICK_RADIUS..=pointer.x + PICK_RADIUS;
    let mut previous: Option<Pos2> = None;
    let mut best: Option<ClosestPoint> = None;
    for point in points {
        let position = position_of(point, transform);
        if let (Some(from), Some(to)) = (previous, position)
            && from.x <= *near.end()
            && to.x >= *near.start()
        {
            let candidate = closest_on_segment(pointer, from, to);
            let distance = candidate.distance(pointer);
            if best.is_none_or(|best| distance < best.distance) {
                best = Some(ClosestPoint {
                    position: candidate,
                    distance,
                });
            }
        }
        previous = position;
    }
    best
}

fn closest_on_segment(pointer: Pos2, from: Pos2, to: Pos2) -> Pos2 {
    let along = to - from;
    let length_sq = along.length_sq();
    if length_sq == 0.0 {
        return from;
    }
    from + along * ((pointer - from).dot(along) / length_sq).clamp(0.0, 1.0)
}

#[cfg(test)]
mod tests {
    use egui_plot::PlotBounds;

    use super::*;
    use crate::gui::plot::curve_style::Role;
    use crate::gui::plot::tests::numbered;

    fn flat(id: u64, level_db: f64, role: Role) -> BodeCurve {
        BodeCurve {
            id: numbered(id),
            label: format!("curve {id}"),
            detail: String::new(),
            role,
            rejected: false,
            highlighted: false,
            hidden: false,
            omega: vec![1.0, 3.0, 10.0].into(),
            magnitude_db: vec![level_db; 3].into(),
            phase_deg: vec![f64::NAN, 0.0, f64::NAN].into(),
        }
    }

    /// Returns a transform of one decade and 100 dB to 100 by 100 points: a decibel is one point
    /// high.
    fn transform() -> PlotTransform {
        let frame = Rect::from_min_max(pos2(0.0, 0.0), pos2(100.0, 100.0));
        PlotTransform::new(
            frame,
            PlotBounds::from_min_max([0.0, 0.0], [1.0, 100.0]),
            false,
        )
    }

    #[test]
    fn the_nearest_curve_is_picked_whatever_the_order() {
        let curves = [
            flat(1, 50.0, Role::Perturbed),
            flat(2, 54.0, Role::Corrected),
            flat(3, 60.0, Role::Nominal),
        ];
        let hit = |y| {
            nearest_curve(&curves, Pane::Magnitude, pos2(50.0, y), &transform())
                .map(|hit| hit.curve)
        };
        assert_eq!(hit(49.0), Some(0));
        assert_eq!(hit(47.0), Some(1));
        assert_eq!(hit(42.0), Some(2));
        assert_eq!(hit(31.0), None);
    }

    #[test]
    fn the_topmost_of_equally_near_curves_is_picked() {
        let curves = [
            flat(1, 50.0, Role::Corrected),
            flat(2, 50.0, Role::Perturbed),
        ];
        let hit = nearest_curve(&curves, Pane::Magnitude, pos2(50.0, 50.0), &transform());
        assert_eq!(hit.map(|hit| hit.curve), Some(0));
    }

    #[test]
    fn a_hit_has_the_frequency_under_the_pointer() {
        let curves = [flat(1, 50.0, Role::Nominal)];
        let hit = nearest_curve(&curves, Pane::Magnitude, pos2(50.0, 48.0), &transform());
        assert!(hit.is_some_and(|hit| (hit.omega - 10f64.sqrt()).abs() < 1e-4));
    }

    #[test]
    fn a_box_touches_curves_that_have_no_point_in_it() {
        let curves = [
            flat(1, 50.0, Role::Perturbed),
            flat(2, 54.0, Role::Corrected),
            flat(3, 60.0, Role::Nominal),
        ];
        // The area lies between the curve points at 3 and 10 rad/s.
        let area = Rect::from_min_max(pos2(70.0, 44.0), pos2(75.0, 52.0));
        assert_eq!(
            curves_in(&curves, Pane::Magnitude, area, &transform()),
            [numbered(1), numbered(2)]
        );
        assert!(
            curves_in(&curves, Pane::Phase, area, &transform()).is_empty(),
            "a lone point is no curve"
        );
    }

    #[test]
    fn a_segment_meets_a_box_whose_corner_it_cuts() {
        let area = Rect::from_min_max(pos2(0.0, 0.0), pos2(10.0, 10.0));
        assert!(meets(pos2(-5.0, 2.0), pos2(4.0, -1.0), area));
        assert!(!meets(pos2(-5.0, 2.0), pos2(2.0, -5.0), area));
        assert!(meets(pos2(2.0, 2.0), pos2(3.0, 3.0), area), "inside");
        assert!(
            !meets(pos2(11.0, -5.0), pos2(11.0, 20.0), area),
            "upright, beside it"
        );
    }

    #[test]
    fn gaps_cannot_be_picked() {
        let curves = [flat(1, 50.0, Role::Nominal)];
        assert_eq!(
            nearest_curve(&curves, Pane::Phase, pos2(50.0, 100.0), &transform()),
            None
        );
    }
}
