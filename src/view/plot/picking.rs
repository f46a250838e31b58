//! Which curve the pointer means: the nearest one, not the topmost.

use egui::{PointerButton, Pos2, Rect, Response, Stroke, StrokeKind, Ui, pos2, vec2};
use egui_plot::{PlotPoint, PlotTransform};

use super::curve::{BodeCurve, CurveId, LogFrequencies, Pane};
use crate::view::palette::Palette;

/// How far from a curve the pointer may be to mean it \[pt\].
pub const PICK_RADIUS: f32 = 8.0;

/// The curve that the pointer means.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Hit {
    /// Index of the curve.
    pub curve: usize,
    /// The frequency of its point nearest to the pointer \[rad/s\].
    pub omega: f64,
    /// Distance from the pointer \[pt\].
    pub distance: f32,
}

/// The curve nearest to `pointer`, if one is within [`PICK_RADIUS`]. Of equally near ones, the one drawn on top.
pub fn nearest(curves: &[BodeCurve], pane: Pane, pointer: Pos2, transform: &PlotTransform) -> Option<Hit> {
    let mut best: Option<(Hit, usize)> = None;
    let mut axis = LogFrequencies::default();
    let [low, high] = [-PICK_RADIUS, PICK_RADIUS].map(|dx| transform.value_from_position(pointer + vec2(dx, 0.0)).x);
    for (index, curve) in curves.iter().enumerate() {
        let points = curve.points_between(&mut axis, pane, (low, high));
        let Some((distance, at)) = distance_to(points, pointer, transform) else {
            continue;
        };
        let layer = curve.role.layer(curve.rejected);
        let is_better =
            best.is_none_or(|(hit, top)| distance < hit.distance || (distance == hit.distance && layer > top));
        if distance <= PICK_RADIUS && is_better {
            let omega = 10f64.powf(transform.value_from_position(at).x);
            best = Some((Hit { curve: index, omega, distance }, layer));
        }
    }
    best.map(|(hit, _)| hit)
}

/// The curves that run through `area` of the screen.
pub(super) fn touched(curves: &[BodeCurve], pane: Pane, area: Rect, transform: &PlotTransform) -> Vec<CurveId> {
    let mut axis = LogFrequencies::default();
    let [low, high] = [area.left(), area.right()].map(|x| transform.value_from_position(pos2(x, area.top())).x);
    let runs_through = |curve: &&BodeCurve| {
        let mut previous: Option<Pos2> = None;
        curve.points_between(&mut axis, pane, (low, high)).any(|[x, y]| {
            let is_point = x.is_finite() && y.is_finite();
            let here = is_point.then(|| transform.position_from_point(&PlotPoint::new(x, y)));
            let before = std::mem::replace(&mut previous, here);
            before.zip(here).is_some_and(|(from, to)| meets(from, to, area))
        })
    };
    curves.iter().filter(runs_through).map(|curve| curve.id.clone()).collect()
}

/// Whether the segment between two points has a part in `area`.
///
/// Of the segment `from + t (to - from)`, 0 <= t <= 1, each pair of edges leaves an interval of t (Liang and Barsky, "A new concept
/// and method for line clipping", ACM TOG 3(1), 1984); it meets the area where the intervals have something in common.
fn meets(from: Pos2, to: Pos2, area: Rect) -> bool {
    let along = to - from;
    let (mut first, mut last) = (0.0f32, 1.0f32);
    for (start, step, low, high) in
        [(from.x, along.x, area.left(), area.right()), (from.y, along.y, area.top(), area.bottom())]
    {
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

/// Distance from `pointer` to a curve and the point of the curve that has it; nothing where no part comes near.
fn distance_to(
    points: impl Iterator<Item = [f64; 2]>,
    pointer: Pos2,
    transform: &PlotTransform,
) -> Option<(f32, Pos2)> {
    let near = pointer.x - PICK_RADIUS..=pointer.x + PICK_RADIUS;
    let positions = points
        .map(|[x, y]| (x.is_finite() && y.is_finite()).then(|| transform.position_from_point(&PlotPoint::new(x, y))));
    let mut previous: Option<Pos2> = None;
    let mut best: Option<(f32, Pos2)> = None;
    for position in positions {
        if let (Some(from), Some(to)) = (previous, position)
            && from.x <= *near.end()
            && to.x >= *near.start()
        {
            let candidate = closest_on_segment(pointer, from, to);
            let distance = candidate.distance(pointer);
            if best.is_none_or(|(least, _)| distance < least) {
                best = Some((distance, candidate));
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

/// A box less wide or high than this is a slip of the hand \[pt\].
const LEAST_SIDE: f32 = 5.0;

/// Draws the box while it is being drawn over `frame` with `button`, and gives it when it is done.
pub(super) fn drawn_box_ui(
    ui: &Ui,
    plot: &Response,
    frame: Rect,
    button: PointerButton,
    palette: &Palette,
) -> Option<Rect> {
    let is_done = plot.drag_stopped_by(button);
    if !(is_done || plot.dragged_by(button)) {
        return None;
    }
    let (origin, now) = ui.input(|input| (input.pointer.press_origin(), input.pointer.latest_pos()));
    // By the time the button is let go, there is no origin any more: the last frame's is kept.
    let memory = plot.id.with("box origin");
    let origin = origin.or_else(|| ui.data(|data| data.get_temp(memory)))?;
    ui.data_mut(|data| data.insert_temp(memory, origin));
    let area = Rect::from_two_pos(origin, now?).intersect(frame);
    let is_wanted = area.width() >= LEAST_SIDE && area.height() >= LEAST_SIDE;
    if is_done {
        return is_wanted.then_some(area);
    }
    let (fill, stroke) = (palette.accent.gamma_multiply(0.12), Stroke::new(1.0, palette.accent));
    ui.painter().with_clip_rect(frame).rect(area, 0.0, fill, stroke, StrokeKind::Inside);
    None
}

#[cfg(test)]
mod tests {
    use super::super::curve_style::Role;
    use super::*;
    use crate::view::plot::curve::numbered;
    use egui_plot::PlotBounds;

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

    /// One decade and 100 dB on 100 by 100 points: a decibel is a point.
    fn transform() -> PlotTransform {
        let frame = Rect::from_min_max(pos2(0.0, 0.0), pos2(100.0, 100.0));
        PlotTransform::new(frame, PlotBounds::from_min_max([0.0, 0.0], [1.0, 100.0]), false)
    }

    #[test]
    fn the_nearest_curve_is_meant_wherever_it_stands_in_the_list() {
        let curves = [flat(1, 50.0, Role::Perturbed), flat(2, 54.0, Role::Corrected), flat(3, 60.0, Role::Nominal)];
        let hit = |y| nearest(&curves, Pane::Magnitude, pos2(50.0, y), &transform()).map(|hit| hit.curve);
        assert_eq!(hit(49.0), Some(0));
        assert_eq!(hit(47.0), Some(1));
        assert_eq!(hit(42.0), Some(2));
        assert_eq!(hit(31.0), None);
    }

    #[test]
    fn of_equally_near_curves_the_one_on_top_is_meant() {
        let curves = [flat(1, 50.0, Role::Corrected), flat(2, 50.0, Role::Perturbed)];
        let hit = nearest(&curves, Pane::Magnitude, pos2(50.0, 50.0), &transform());
        assert_eq!(hit.map(|hit| hit.curve), Some(0));
    }

    #[test]
    fn the_frequency_is_that_under_the_pointer() {
        let curves = [flat(1, 50.0, Role::Nominal)];
        let hit = nearest(&curves, Pane::Magnitude, pos2(50.0, 48.0), &transform());
        assert!(hit.is_some_and(|hit| (hit.omega - 10f64.sqrt()).abs() < 1e-4));
    }

    #[test]
    fn a_box_touches_the_curves_that_run_through_it_without_a_point_in_it_too() {
        let curves = [flat(1, 50.0, Role::Perturbed), flat(2, 54.0, Role::Corrected), flat(3, 60.0, Role::Nominal)];
        // Between the points at 3 and 10 rad/s.
        let area = Rect::from_min_max(pos2(70.0, 44.0), pos2(75.0, 52.0));
        assert_eq!(touched(&curves, Pane::Magnitude, area, &transform()), [numbered(1), numbered(2)]);
        assert!(touched(&curves, Pane::Phase, area, &transform()).is_empty(), "a lone point is no curve");
    }

    #[test]
    fn a_segment_meets_a_box_that_it_cuts_a_corner_of() {
        let area = Rect::from_min_max(pos2(0.0, 0.0), pos2(10.0, 10.0));
        assert!(meets(pos2(-5.0, 2.0), pos2(4.0, -1.0), area));
        assert!(!meets(pos2(-5.0, 2.0), pos2(2.0, -5.0), area));
        assert!(meets(pos2(2.0, 2.0), pos2(3.0, 3.0), area), "inside");
        assert!(!meets(pos2(11.0, -5.0), pos2(11.0, 20.0), area), "upright, beside it");
    }

    #[test]
    fn gaps_cannot_be_meant() {
        let curves = [flat(1, 50.0, Role::Nominal)];
        assert_eq!(nearest(&curves, Pane::Phase, pos2(50.0, 100.0), &transform()), None);
    }
}
