//! Mouse and keyboard navigation of plots: panning and zooming, and picking the curve under the
//! pointer, the nearest and not the topmost.

use egui::{
    Context, EventFilter, Key, Modifiers, PointerButton, Pos2, Rect, Response, Stroke, StrokeKind,
    Ui, Vec2, pos2, vec2,
};
use egui_plot::{PlotPoint, PlotTransform};

use gdcm_plot::figure::{MarkId, Panel, Range};

use super::bode_view::BodeView;
use super::drawn_curves::{BodeCurve, CurveId, LogFrequencies, Pane};
use crate::gui::widgets::palette::Palette;

/// Share of the visible range by which an arrow key pans.
const STEP: f32 = 0.1;
/// Zoom factor of the + key.
const CLOSER: f64 = 1.25;

/// Handles the keys of a focused pane: arrows pan, + and − zoom (with Shift only the frequencies),
/// Home fits, Escape leaves the plot.
pub(super) fn plot_keys(ui: &Ui, pane: Pane, response: &Response, view: &mut BodeView) {
    if !response.has_focus() {
        return;
    }
    let arrows = EventFilter {
        horizontal_arrows: true,
        vertical_arrows: true,
        ..EventFilter::default()
    };
    ui.memory_mut(|memory| memory.set_focus_lock_filter(response.id, arrows));
    let Some(frame) = view.transform(pane).map(|transform| *transform.frame()) else {
        return;
    };
    let shift = ui.input(|input| input.modifiers.shift);
    let pressed =
        |key| ui.input_mut(|input| input.count_and_consume_key(Modifiers::NONE, key)) as f32;
    // The view moves in the direction of the arrow, and the drawing in the opposite direction.
    let along = pressed(Key::ArrowRight) - pressed(Key::ArrowLeft);
    let up = pressed(Key::ArrowUp) - pressed(Key::ArrowDown);
    let closer = pressed(Key::Plus) + pressed(Key::Equals) - pressed(Key::Minus);
    let is_fitted = pressed(Key::Home) > 0.0;
    if along != 0.0 || up != 0.0 {
        view.pan(
            pane,
            STEP * vec2(-along * frame.width(), up * frame.height()),
        );
    }
    if closer != 0.0 {
        let factor = CLOSER.powf(f64::from(closer));
        view.zoom(
            pane,
            frame.center(),
            factor,
            if shift { 1.0 } else { factor },
        );
    }
    if is_fitted {
        view.request_fit();
    }
    if along != 0.0 || up != 0.0 || closer != 0.0 || is_fitted {
        ui.ctx().request_repaint();
    }
}

/// Takes the digit from 1 to 9 that is pressed out of the input.
pub(super) fn pressed_digit(ui: &Ui) -> Option<usize> {
    let digits = [
        Key::Num1,
        Key::Num2,
        Key::Num3,
        Key::Num4,
        Key::Num5,
        Key::Num6,
        Key::Num7,
        Key::Num8,
        Key::Num9,
    ];
    let pressed = |key: &Key| ui.input_mut(|input| input.consume_key(Modifiers::NONE, *key));
    digits.iter().position(pressed).map(|place| place + 1)
}

/// Zoom factor of a notch of the wheel.
const NOTCH: f32 = 1.1;
/// Scroll distance of a notch \[pt\].
const NOTCH_PT: f32 = 40.0;
/// Zoom limit beyond the computed data, in decades of frequency.
const BEYOND: f64 = 1.0;

/// Zoom factors in x and y.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Turn {
    /// From the wheel, or from pinching.
    pub(super) both: Vec2,
    /// From the sideways wheel, and from any wheel with Shift: applies to x only.
    pub(super) sideways: f32,
}

impl Turn {
    /// Returns the combined zoom factor for a plot with a single zoomable axis.
    pub(super) fn along_one_axis(self) -> f32 {
        let pinched = (self.both.x * self.both.y).sqrt();
        pinched * self.sideways
    }
}

/// Returns the zoom requested of the widget under the pointer by wheel or pinching, and the
/// pointer's position; `None` without input.
pub(super) fn turned(ctx: &Context, response: &Response) -> Option<(Turn, Pos2)> {
    let pointer = response.hover_pos()?;
    let (scrolled, pinched) =
        ctx.input(|input| (input.smooth_scroll_delta(), input.zoom_delta_2d()));
    if scrolled == Vec2::ZERO && pinched == Vec2::splat(1.0) {
        return None;
    }
    // A touchpad scrolls by fractions of a notch.
    let closer = |points: f32| NOTCH.powf(points / NOTCH_PT);
    Some((
        Turn {
            both: closer(scrolled.y) * pinched,
            sideways: closer(scrolled.x),
        },
        pointer,
    ))
}

/// Visible part of an axis. The engineer's choice persists until a fit of everything is requested.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct ViewedRange {
    range: Range,
    is_chosen: bool,
    /// Permitted widths.
    widths: Range,
    /// Permitted values.
    ends: Range,
}

impl ViewedRange {
    /// Shows `range` until something is fitted; always a part of `ends` with a width in `widths`
    /// after that.
    pub(super) fn new(range: Range, widths: Range, ends: Range) -> Self {
        Self {
            range,
            is_chosen: false,
            widths,
            ends,
        }
    }

    /// Limits the view to a decade beyond the computed range, where `computed` is in decades.
    pub(super) fn reach(&mut self, computed: Range) {
        self.ends = Range::new(computed.min - BEYOND, computed.max + BEYOND);
    }

    /// Zooms by `factor` about `fixed`, within the limits.
    pub(super) fn zoom(&mut self, factor: f64, fixed: f64) {
        let Range { min, max } = self.range.zoomed(factor, fixed);
        if min < self.ends.max && max > self.ends.min {
            self.choose(Range::new(min.max(self.ends.min), max.min(self.ends.max)));
        }
    }

    /// Returns the visible range.
    pub(super) fn range(&self) -> Range {
        self.range
    }

    /// Returns whether the engineer chose the visible range.
    pub(super) fn is_chosen(&self) -> bool {
        self.is_chosen
    }

    /// Sets the range chosen by the engineer, within the limits.
    pub(super) fn choose(&mut self, range: Range) {
        if let Some(range) = self.allowed(range).filter(|range| *range != self.range) {
            self.range = range;
            self.is_chosen = true;
        }
    }

    /// Sets the range that fits the data, unless the engineer chose another.
    pub(super) fn fit(&mut self, range: Range) {
        if let Some(range) = self.allowed(range).filter(|_| !self.is_chosen) {
            self.range = range;
        }
    }

    /// Drops the engineer's choice: the next fit applies.
    pub(super) fn release(&mut self) {
        self.is_chosen = false;
    }

    fn allowed(&self, range: Range) -> Option<Range> {
        let range = range.limited(self.widths)?;
        (self.ends.contains(range.min) && self.ends.contains(range.max)).then_some(range)
    }
}

/// Greatest distance of the pointer from a curve under it \[pt\].
pub const PICK_RADIUS: f32 = 8.0;

/// Curve under the pointer.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Hit {
    pub curve: usize,
    /// Frequency of its point nearest to the pointer \[rad/s\].
    pub omega: f64,
    /// Distance from the pointer \[pt\].
    pub distance: f32,
}

/// Returns the curve nearest to `pointer` within [`PICK_RADIUS`]; of equally near curves, the
/// topmost.
pub fn nearest(
    curves: &[BodeCurve],
    pane: Pane,
    pointer: Pos2,
    transform: &PlotTransform,
) -> Option<Hit> {
    let mut best: Option<(Hit, usize)> = None;
    let mut axis = LogFrequencies::default();
    let [low, high] = [-PICK_RADIUS, PICK_RADIUS]
        .map(|dx| transform.value_from_position(pointer + vec2(dx, 0.0)).x);
    for (index, curve) in curves.iter().enumerate() {
        let points = curve.points_between(&mut axis, pane, (low, high));
        let Some((distance, at)) = distance_to(points, pointer, transform) else {
            continue;
        };
        let layer = curve.role.layer(curve.rejected);
        let is_better = best.is_none_or(|(hit, top)| {
            distance < hit.distance || (distance == hit.distance && layer > top)
        });
        if distance <= PICK_RADIUS && is_better {
            let omega = 10f64.powf(transform.value_from_position(at).x);
            best = Some((
                Hit {
                    curve: index,
                    omega,
                    distance,
                },
                layer,
            ));
        }
    }
    best.map(|(hit, _)| hit)
}

/// Greatest distance of the pointer from a dot under it \[pt\].
const DOT_RADIUS: f32 = 10.0;

/// Returns the nearest dot with an id; of equally near dots, the topmost, which is drawn last.
pub(super) fn nearest_dot(
    panel: &Panel,
    transform: &PlotTransform,
    pointer: Pos2,
) -> Option<(MarkId, [f64; 2])> {
    let mut near: Option<(f32, (&MarkId, [f64; 2]))> = None;
    for (dot, id) in panel.dots().filter_map(|dot| Some((dot, dot.id.as_ref()?))) {
        let distance = transform
            .position_from_point(&PlotPoint::new(dot.x, dot.y))
            .distance(pointer);
        if distance <= DOT_RADIUS && near.is_none_or(|(least, _)| distance <= least) {
            near = Some((distance, (id, [dot.x, dot.y])));
        }
    }
    near.map(|(_, (id, at))| (id.clone(), at))
}

/// Returns the curves that run through `area` of the screen.
pub(super) fn touched(
    curves: &[BodeCurve],
    pane: Pane,
    area: Rect,
    transform: &PlotTransform,
) -> Vec<CurveId> {
    let mut axis = LogFrequencies::default();
    let [low, high] =
        [area.left(), area.right()].map(|x| transform.value_from_position(pos2(x, area.top())).x);
    let runs_through = |curve: &&BodeCurve| {
        let mut previous: Option<Pos2> = None;
        curve
            .points_between(&mut axis, pane, (low, high))
            .any(|[x, y]| {
                let is_point = x.is_finite() && y.is_finite();
                let here = is_point.then(|| transform.position_from_point(&PlotPoint::new(x, y)));
                let before = std::mem::replace(&mut previous, here);
                before
                    .zip(here)
                    .is_some_and(|(from, to)| meets(from, to, area))
            })
    };
    curves
        .iter()
        .filter(runs_through)
        .map(|curve| curve.id.clone())
        .collect()
}

/// Returns whether part of the segment between two points lies in `area`.
///
/// Of the segment `from + t (to - from)`, 0 <= t <= 1, each pair of edges leaves an interval of t
/// (Liang and Barsky, "A new concept and method for line clipping", ACM TOG 3(1), 1984); the
/// segment meets the area if the intervals intersect.
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

/// Returns the distance from `pointer` to a curve and the nearest point of the curve; `None` if no
/// part is near.
pub(super) fn distance_to(
    points: impl Iterator<Item = [f64; 2]>,
    pointer: Pos2,
    transform: &PlotTransform,
) -> Option<(f32, Pos2)> {
    let near = pointer.x - PICK_RADIUS..=pointer.x + PICK_RADIUS;
    let positions = points.map(|[x, y]| {
        (x.is_finite() && y.is_finite())
            .then(|| transform.position_from_point(&PlotPoint::new(x, y)))
    });
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

/// Least width and height of a box; a smaller box is accidental \[pt\].
const LEAST_SIDE: f32 = 5.0;

/// Draws the selection box while it is dragged over `frame` with `button`; returns it when it is
/// finished.
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
    let (origin, now) =
        ui.input(|input| (input.pointer.press_origin(), input.pointer.latest_pos()));
    // When the button is released, the drag origin is already gone: the last frame's is stored.
    let memory = plot.id.with("box origin");
    let origin = origin.or_else(|| ui.data(|data| data.get_temp(memory)))?;
    ui.data_mut(|data| data.insert_temp(memory, origin));
    let area = Rect::from_two_pos(origin, now?).intersect(frame);
    let is_wanted = area.width() >= LEAST_SIDE && area.height() >= LEAST_SIDE;
    if is_done {
        return is_wanted.then_some(area);
    }
    let fill = palette.accent.gamma_multiply(0.12);
    let stroke = Stroke::new(1.0, palette.accent);
    ui.painter()
        .with_clip_rect(frame)
        .rect(area, 0.0, fill, stroke, StrokeKind::Inside);
    None
}

#[cfg(test)]
mod tests {
    use egui_plot::PlotBounds;

    use super::*;
    use crate::gui::plot::curve_style::Role;
    use crate::gui::plot::tests::numbered;

    fn viewed() -> ViewedRange {
        ViewedRange::new(
            Range::new(0.0, 1.0),
            Range::new(0.1, 50.0),
            Range::new(-100.0, 100.0),
        )
    }

    #[test]
    fn what_was_chosen_stays_until_it_is_released() {
        let mut viewed = viewed();
        viewed.fit(Range::new(2.0, 3.0));
        assert_eq!(
            (viewed.range(), viewed.is_chosen()),
            (Range::new(2.0, 3.0), false)
        );
        viewed.choose(Range::new(4.0, 5.0));
        viewed.fit(Range::new(2.0, 3.0));
        assert_eq!(
            (viewed.range(), viewed.is_chosen()),
            (Range::new(4.0, 5.0), true)
        );
        viewed.release();
        viewed.fit(Range::new(2.0, 3.0));
        assert_eq!(viewed.range(), Range::new(2.0, 3.0));
    }

    #[test]
    fn zooming_out_ends_a_decade_beyond_what_is_computed() {
        let mut viewed = viewed();
        viewed.reach(Range::new(-0.5, 1.25));
        (0..100).for_each(|_| viewed.zoom(1.0 / 1.1, 0.3));
        assert_eq!(viewed.range(), Range::new(-1.5, 2.25));
        viewed.zoom(1.1, 0.3);
        assert!(viewed.range().width() < 3.75, "and back");
    }

    #[test]
    fn choosing_what_is_in_view_already_is_no_choice() {
        let mut viewed = viewed();
        viewed.choose(Range::new(0.0, 1.0));
        assert!(!viewed.is_chosen());
    }

    #[test]
    fn a_range_beyond_the_ends_is_not_shown() {
        let mut viewed = viewed();
        viewed.choose(Range::new(99.0, 101.0));
        viewed.choose(Range {
            min: f64::NAN,
            max: 1.0,
        });
        assert_eq!(viewed, self::viewed());
    }

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

    /// A decade and 100 dB on 100 by 100 points: a decibel is a point.
    fn transform() -> PlotTransform {
        let frame = Rect::from_min_max(pos2(0.0, 0.0), pos2(100.0, 100.0));
        PlotTransform::new(
            frame,
            PlotBounds::from_min_max([0.0, 0.0], [1.0, 100.0]),
            false,
        )
    }

    #[test]
    fn the_nearest_curve_is_meant_wherever_it_stands_in_the_list() {
        let curves = [
            flat(1, 50.0, Role::Perturbed),
            flat(2, 54.0, Role::Corrected),
            flat(3, 60.0, Role::Nominal),
        ];
        let hit =
            |y| nearest(&curves, Pane::Magnitude, pos2(50.0, y), &transform()).map(|hit| hit.curve);
        assert_eq!(hit(49.0), Some(0));
        assert_eq!(hit(47.0), Some(1));
        assert_eq!(hit(42.0), Some(2));
        assert_eq!(hit(31.0), None);
    }

    #[test]
    fn of_equally_near_curves_the_one_on_top_is_meant() {
        let curves = [
            flat(1, 50.0, Role::Corrected),
            flat(2, 50.0, Role::Perturbed),
        ];
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
        let curves = [
            flat(1, 50.0, Role::Perturbed),
            flat(2, 54.0, Role::Corrected),
            flat(3, 60.0, Role::Nominal),
        ];
        // Between the points at 3 and 10 rad/s.
        let area = Rect::from_min_max(pos2(70.0, 44.0), pos2(75.0, 52.0));
        assert_eq!(
            touched(&curves, Pane::Magnitude, area, &transform()),
            [numbered(1), numbered(2)]
        );
        assert!(
            touched(&curves, Pane::Phase, area, &transform()).is_empty(),
            "a lone point is no curve"
        );
    }

    #[test]
    fn a_segment_meets_a_box_that_it_cuts_a_corner_of() {
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
    fn gaps_cannot_be_meant() {
        let curves = [flat(1, 50.0, Role::Nominal)];
        assert_eq!(
            nearest(&curves, Pane::Phase, pos2(50.0, 100.0), &transform()),
            None
        );
    }
}
