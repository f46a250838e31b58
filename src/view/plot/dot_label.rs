//! Where the labels of dots go: around each dot, clear of the other dots and labels.

use egui::{Align2, Pos2, Rect, Vec2, vec2};

/// Directions tried around a dot, the preferred one first: the label's corner or side that faces the dot.
const SIDES: [(Align2, Vec2); 8] = [
    (Align2::LEFT_BOTTOM, vec2(0.7, -0.7)),
    (Align2::LEFT_TOP, vec2(0.7, 0.7)),
    (Align2::RIGHT_BOTTOM, vec2(-0.7, -0.7)),
    (Align2::RIGHT_TOP, vec2(-0.7, 0.7)),
    (Align2::LEFT_CENTER, vec2(1.0, 0.0)),
    (Align2::CENTER_BOTTOM, vec2(0.0, -1.0)),
    (Align2::RIGHT_CENTER, vec2(-1.0, 0.0)),
    (Align2::CENTER_TOP, vec2(0.0, 1.0)),
];
/// Distances tried, beyond the dot's own radius \[pt\]; from the second on, a line leads from the dot to its label.
const GAPS: [f32; 5] = [1.5, 9.0, 17.0, 25.0, 33.0];
/// How often every label is placed anew, given the others: early labels make room for late ones.
const SWEEPS: usize = 3;

/// Cost of covering a square point of another label, of a dot, or of what lies outside, and a point of the path's length.
const ON_LABEL: f32 = 40.0;
const ON_DOT: f32 = 40.0;
const OUTSIDE: f32 = 30.0;
const ON_PATH: f32 = 1.0;
/// Cost of standing nearer to another dot than to one's own.
const AMBIGUOUS: f32 = 6.0;
/// Cost of a later side, and of a point of distance.
const LATER_SIDE: f32 = 0.2;
const FARTHER: f32 = 0.6;

/// The place of a label.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LabelPlace {
    /// Where the text goes.
    pub rect: Rect,
    /// The point of `rect` a line should lead to, where the label stands away from its dot.
    pub leader: Option<Pos2>,
}

/// A dot to be labelled.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LabelledDot {
    /// Its centre.
    pub center: Pos2,
    /// How far from the centre labels stay \[pt\].
    pub radius: f32,
    /// Size of its label.
    pub label: Vec2,
}

/// What labels keep clear of, beside the dots.
#[derive(Clone, Copy, Debug)]
pub struct Surroundings<'a> {
    /// The area labels stay in.
    pub bounds: Rect,
    /// A line that labels had better not cover.
    pub path: &'a [Pos2],
}

/// Labels as they were placed last: placing them costs more than drawing them, and from frame to frame little moves.
#[derive(Clone, Debug, Default)]
pub struct PlacedLabels {
    /// The dots, the bounds and the path that the places are for.
    placed_for: Option<(Vec<LabelledDot>, Rect, Vec<Pos2>)>,
    places: Vec<LabelPlace>,
}

impl PlacedLabels {
    /// The places of the labels of `dots`, in their order.
    pub fn places(&mut self, dots: &[LabelledDot], around: Surroundings<'_>) -> &[LabelPlace] {
        let same = |(of, bounds, path): &(Vec<LabelledDot>, Rect, Vec<Pos2>)| {
            of == dots && *bounds == around.bounds && path == around.path
        };
        if !self.placed_for.as_ref().is_some_and(same) {
            self.places = place_labels(dots, around);
            self.placed_for = Some((dots.to_vec(), around.bounds, around.path.to_vec()));
        }
        &self.places
    }
}

/// The places of the labels of `dots`, in their order.
fn place_labels(dots: &[LabelledDot], around: Surroundings<'_>) -> Vec<LabelPlace> {
    let mut places: Vec<Option<LabelPlace>> = vec![None; dots.len()];
    for _ in 0..SWEEPS {
        for index in 0..dots.len() {
            places[index] = best_place(index, dots, &places, around);
        }
    }
    let fallback =
        |index: usize| LabelPlace { rect: Rect::from_min_size(dots[index].center, dots[index].label), leader: None };
    places.into_iter().enumerate().map(|(index, place)| place.unwrap_or_else(|| fallback(index))).collect()
}

fn best_place(
    index: usize,
    dots: &[LabelledDot],
    places: &[Option<LabelPlace>],
    around: Surroundings<'_>,
) -> Option<LabelPlace> {
    let others: Vec<Rect> =
        places.iter().enumerate().filter(|(k, _)| *k != index).filter_map(|(_, place)| Some((*place)?.rect)).collect();
    let mut best: Option<(LabelPlace, f32)> = None;
    for (place, preference) in candidates(dots[index]) {
        // Most places are worse than the best one by their distance alone.
        if best.is_none_or(|(_, least)| preference < least) {
            let ambiguity = AMBIGUOUS * nearer_dots(place.rect, index, dots) as f32;
            let cost = preference + ambiguity + obstruction(place.rect, &others, dots, around);
            if best.is_none_or(|(_, least)| cost < least) {
                best = Some((place, cost));
            }
        }
    }
    best.map(|(place, _)| place)
}

fn candidates(dot: LabelledDot) -> impl Iterator<Item = (LabelPlace, f32)> {
    GAPS.into_iter().enumerate().flat_map(move |(ring, gap)| {
        SIDES.into_iter().enumerate().map(move |(side, (align, direction))| {
            let anchor = dot.center + direction * (dot.radius + gap);
            let leader = (ring > 0).then_some(anchor);
            let preference = side as f32 * LATER_SIDE + gap * FARTHER;
            (LabelPlace { rect: align.anchor_size(anchor, dot.label), leader }, preference)
        })
    })
}

fn obstruction(rect: Rect, labels: &[Rect], dots: &[LabelledDot], around: Surroundings<'_>) -> f32 {
    let on_labels: f32 = labels.iter().map(|label| common_area(rect, label.expand(1.0))).sum();
    let dot_rect = |dot: &LabelledDot| Rect::from_center_size(dot.center, Vec2::splat(1.9 * dot.radius));
    let on_dots: f32 = dots.iter().map(|dot| common_area(rect, dot_rect(dot))).sum();
    let outside = rect.area() - common_area(rect, around.bounds);
    let on_path: f32 = around.path.windows(2).map(|ends| length_inside(rect, ends[0], ends[1])).sum();
    ON_LABEL * on_labels + ON_DOT * on_dots + OUTSIDE * outside + ON_PATH * on_path
}

/// About how much of a segment lies in `rect` \[pt\].
fn length_inside(rect: Rect, from: Pos2, to: Pos2) -> f32 {
    if !rect.intersects(Rect::from_two_pos(from, to)) {
        return 0.0;
    }
    /// Distance between the points that are tried \[pt\].
    const STEP: f32 = 2.0;
    let length = from.distance(to);
    let steps = (length / STEP).ceil().max(1.0);
    let inside = (0..steps as usize).filter(|k| rect.contains(from.lerp(to, (*k as f32 + 0.5) / steps))).count();
    inside as f32 * length / steps
}

/// How many other dots are nearer to the label of a dot than the dot itself.
fn nearer_dots(label: Rect, index: usize, dots: &[LabelledDot]) -> usize {
    /// Nearer by less than this does not mislead \[pt\].
    const SLACK: f32 = 0.5;
    let distance = |dot: &LabelledDot| label.distance_to_pos(dot.center) - dot.radius;
    let own = distance(&dots[index]);
    dots.iter().enumerate().filter(|(k, dot)| *k != index && distance(dot) + SLACK < own).count()
}

fn common_area(a: Rect, b: Rect) -> f32 {
    let common = a.intersect(b);
    common.width().max(0.0) * common.height().max(0.0)
}

#[cfg(test)]
mod tests {
    use super::*;
    use egui::pos2;

    const SIZE: Vec2 = vec2(12.0, 12.0);

    fn places(dots: &[Pos2]) -> Vec<LabelPlace> {
        let dot = |center: &Pos2| LabelledDot { center: *center, radius: 4.0, label: SIZE };
        let dots: Vec<LabelledDot> = dots.iter().map(dot).collect();
        let bounds = Rect::from_min_max(pos2(0.0, 0.0), pos2(140.0, 170.0));
        place_labels(&dots, Surroundings { bounds, path: &[] })
    }

    fn assert_no_two_overlap(places: &[LabelPlace]) {
        for (k, a) in places.iter().enumerate() {
            for b in &places[k + 1..] {
                assert!(common_area(a.rect, b.rect) < 1e-3, "{a:?} {b:?}");
            }
        }
    }

    #[test]
    fn a_lone_dot_is_labelled_above_to_its_right() {
        let dot = pos2(50.0, 50.0);
        let place = places(&[dot])[0];
        assert!(place.rect.left() > dot.x && place.rect.bottom() < dot.y);
        assert_eq!(place.leader, None);
    }

    #[test]
    fn labels_of_the_example_do_not_overlap() {
        // PED to NY: conditions 1, 4, 8 and 2, 9 nearly coincide.
        let dots = [(120.0, 128.0), (136.0, 134.0), (12.0, 18.0), (120.0, 137.0), (12.0, 54.0), (50.0, 110.0)];
        let more = [(80.0, 106.0), (120.0, 134.0), (136.0, 134.5), (50.0, 91.0), (80.0, 120.0)];
        let dots: Vec<Pos2> = dots.into_iter().chain(more).map(|(x, y)| pos2(x, y)).collect();
        assert_no_two_overlap(&places(&dots));
    }

    #[test]
    fn dots_in_one_place_get_labels_side_by_side() {
        let places = places(&[pos2(70.0, 80.0); 6]);
        assert_no_two_overlap(&places);
    }

    #[test]
    fn a_label_stands_nearest_to_its_own_dot() {
        let places = places(&[pos2(70.0, 80.0), pos2(70.0, 89.0), pos2(70.0, 98.0)]);
        let y: Vec<f32> = places.iter().map(|place| place.rect.center().y).collect();
        assert!(y[0] < y[1] && y[1] < y[2], "{y:?}");
    }

    #[test]
    fn labels_are_placed_anew_where_a_dot_moved() {
        let mut labels = PlacedLabels::default();
        let bounds = Rect::from_min_max(pos2(0.0, 0.0), pos2(140.0, 170.0));
        let mut placed = |x: f32| {
            let dots = [LabelledDot { center: pos2(x, 80.0), radius: 4.0, label: SIZE }];
            labels.places(&dots, Surroundings { bounds, path: &[] })[0].rect
        };
        let (first, again, moved) = (placed(70.0), placed(70.0), placed(75.0));
        assert_eq!(first, again);
        assert_eq!(moved, first.translate(vec2(5.0, 0.0)));
    }

    #[test]
    fn a_label_keeps_off_the_line() {
        let dots = [LabelledDot { center: pos2(70.0, 80.0), radius: 4.0, label: SIZE }];
        let path = [pos2(60.0, 90.0), pos2(90.0, 60.0)];
        let bounds = Rect::from_min_max(pos2(0.0, 0.0), pos2(140.0, 170.0));
        let place = place_labels(&dots, Surroundings { bounds, path: &path })[0];
        assert_eq!(length_inside(place.rect, path[0], path[1]), 0.0);
    }

    #[test]
    fn labels_stay_inside_the_plot() {
        for dot in [pos2(1.0, 1.0), pos2(139.0, 1.0), pos2(139.0, 169.0), pos2(1.0, 169.0)] {
            let rect = places(&[dot])[0].rect;
            assert!(rect.left() >= 0.0 && rect.right() <= 140.0 && rect.top() >= 0.0 && rect.bottom() <= 170.0);
        }
    }
}
