//! Placement of dot labels: around each dot, clear of the other dots, of bars and of the other
//! labels.
//!
//! ```text
//! three times, dot by dot:
//!     of 8 sides and 5 distances take the place of least cost:
//!         label and its leader over labels, dots, bars, the edge; the line beneath; nearness to another dot; distance
//! a label that still covers much of another one or of what is in its way is left out
//! ```
//!
//! The same on the screen and on paper, in points; y runs downwards.

use super::drawing::Area;

/// Directions tried around a dot, the preferred first: fractions of the label's width and height
/// before the anchor, and the position of the anchor.
const SIDES: [([f64; 2], [f64; 2]); 8] = [
    ([0.0, 1.0], [0.7, -0.7]),
    ([0.0, 0.0], [0.7, 0.7]),
    ([1.0, 1.0], [-0.7, -0.7]),
    ([1.0, 0.0], [-0.7, 0.7]),
    ([0.0, 0.5], [1.0, 0.0]),
    ([0.5, 1.0], [0.0, -1.0]),
    ([1.0, 0.5], [-1.0, 0.0]),
    ([0.5, 0.0], [0.0, 1.0]),
];
/// Distances tried, beyond the radius of the dot \[pt\]; from the second on, a leader connects the
/// dot to its label.
const GAPS: [f64; 6] = [1.5, 8.0, 15.0, 22.0, 30.0, 40.0];
/// Number of passes in which every label is placed again given the others: early labels make room
/// for late ones.
const SWEEPS: usize = 3;
/// With more dots, no labels are placed: they would be unreadable and slow to place.
const MOST_LABELS: usize = 300;

/// Cost of covering a square point of another label, of a dot, of a bar, or of the area outside,
/// and of a point of the path's length.
const ON_LABEL: f64 = 40.0;
const ON_DOT: f64 = 40.0;
const ON_BAR: f64 = 8.0;
const OUTSIDE: f64 = 30.0;
const ON_PATH: f64 = 1.0;
/// Cost per point of a leader's length on a label.
const LEADER_ON_LABEL: f64 = 20.0;
/// Cost of being nearer to another dot than to its own.
const AMBIGUOUS: f64 = 6.0;
/// Cost of a later side, and per point of distance.
const LATER_SIDE: f64 = 0.2;
const FARTHER: f64 = 0.6;
/// A label that covers more than this fraction of other labels, dots or the area outside is
/// unreadable, as are those it covers.
const MOST_COVERED: f64 = 0.12;

/// The place of a label.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LabelPlace {
    /// Area of the text.
    pub area: Area,
    /// The point of `area` at which the leader ends, if the label is away from its dot.
    pub leader: Option<[f64; 2]>,
}

/// A dot to be labelled.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LabelledDot {
    pub center: [f64; 2],
    /// Distance from the centre that labels keep \[pt\].
    pub radius: f64,
    /// Width and height of its label; no label is placed if its width is zero.
    pub size: [f64; 2],
}

/// Obstacles for labels, besides the dots.
#[derive(Clone, Debug, PartialEq)]
pub struct Surroundings {
    /// The area for labels.
    pub bounds: Area,
    /// A line that labels should not cover.
    pub path: Vec<[f64; 2]>,
    pub bars: Vec<Area>,
}

/// Places the labels of `dots`, in their order; `None` for a label without room.
pub fn place_labels(dots: &[LabelledDot], around: &Surroundings) -> Vec<Option<LabelPlace>> {
    let mut places: Vec<Option<LabelPlace>> = vec![None; dots.len()];
    let labelled: Vec<usize> = (0..dots.len())
        .filter(|&index| dots[index].size[0] > 0.0)
        .collect();
    if labelled.len() > MOST_LABELS {
        return places;
    }
    for _ in 0..SWEEPS {
        for &index in &labelled {
            places[index] = best_place(index, dots, &places, around);
        }
    }
    // The worst label goes first: labels that it covered may then stay.
    loop {
        let covered = labelled
            .iter()
            .map(|&index| (index, covered_part(index, dots, &places, around)));
        let worst = covered.max_by(|a, b| a.1.total_cmp(&b.1));
        match worst.filter(|(_, part)| *part > MOST_COVERED) {
            Some((index, _)) => places[index] = None,
            None => return places,
        }
    }
}

/// Returns the fraction of a label that covers other labels, dots and the area outside.
fn covered_part(
    index: usize,
    dots: &[LabelledDot],
    places: &[Option<LabelPlace>],
    around: &Surroundings,
) -> f64 {
    let Some(place) = places[index] else {
        return 0.0;
    };
    let labels: f64 = others(index, places)
        .map(|other| place.area.overlap(&other.area))
        .sum();
    let on_dots: f64 = dots.iter().map(|dot| place.area.overlap(&dot.area())).sum();
    (labels + on_dots + outside(&place.area, around)) / place.area.size()
}

fn others(index: usize, places: &[Option<LabelPlace>]) -> impl Iterator<Item = LabelPlace> + '_ {
    places
        .iter()
        .enumerate()
        .filter(move |(other, _)| *other != index)
        .filter_map(|(_, place)| *place)
}

fn outside(area: &Area, around: &Surroundings) -> f64 {
    area.size() - area.overlap(&around.bounds)
}

fn best_place(
    index: usize,
    dots: &[LabelledDot],
    places: &[Option<LabelPlace>],
    around: &Surroundings,
) -> Option<LabelPlace> {
    let others: Vec<(LabelPlace, [f64; 2])> = places
        .iter()
        .zip(dots)
        .enumerate()
        .filter(|(other, _)| *other != index)
        .filter_map(|(_, (place, dot))| Some(((*place)?, dot.center)))
        .collect();
    let mut best: Option<(LabelPlace, f64)> = None;
    for (place, preference) in candidates(dots[index]) {
        // The distance alone makes most places worse than the best.
        if best.is_none_or(|(_, least)| preference < least) {
            let ambiguity = AMBIGUOUS * nearer_dots(&place.area, index, dots) as f64;
            let leaders = leaders_on_labels(&place, dots[index].center, &others);
            let cost =
                preference + ambiguity + leaders + obstruction(&place.area, &others, dots, around);
            if best.is_none_or(|(_, least)| cost < least) {
                best = Some((place, cost));
            }
        }
    }
    best.map(|(place, _)| place)
}

fn candidates(dot: LabelledDot) -> impl Iterator<Item = (LabelPlace, f64)> {
    GAPS.into_iter().enumerate().flat_map(move |(ring, gap)| {
        SIDES
            .into_iter()
            .enumerate()
            .map(move |(side, (before, direction))| {
                let anchor: [f64; 2] =
                    std::array::from_fn(|at| dot.center[at] + direction[at] * (dot.radius + gap));
                let [left, top] = std::array::from_fn(|at| anchor[at] - before[at] * dot.size[at]);
                let leader = (ring > 0).then_some(anchor);
                let preference = side as f64 * LATER_SIDE + gap * FARTHER;
                (
                    LabelPlace {
                        area: Area::new(left, top, dot.size[0], dot.size[1]),
                        leader,
                    },
                    preference,
                )
            })
    })
}

fn obstruction(
    area: &Area,
    others: &[(LabelPlace, [f64; 2])],
    dots: &[LabelledDot],
    around: &Surroundings,
) -> f64 {
    let on_labels: f64 = others
        .iter()
        .map(|(other, _)| area.overlap(&other.area.expanded(1.0)))
        .sum();
    let on_dots: f64 = dots.iter().map(|dot| area.overlap(&dot.area())).sum();
    let on_bars: f64 = around.bars.iter().map(|bar| area.overlap(bar)).sum();
    let on_path: f64 = around
        .path
        .windows(2)
        .map(|ends| length_inside(area, ends[0], ends[1]))
        .sum();
    ON_LABEL * on_labels
        + ON_DOT * on_dots
        + ON_BAR * on_bars
        + OUTSIDE * outside(area, around)
        + ON_PATH * on_path
}

/// Returns the cost of crossings between a label and leaders.
fn leaders_on_labels(
    place: &LabelPlace,
    center: [f64; 2],
    others: &[(LabelPlace, [f64; 2])],
) -> f64 {
    let across = |(other, from): &(LabelPlace, [f64; 2])| {
        let own = place
            .leader
            .map_or(0.0, |end| length_inside(&other.area, center, end));
        own + other
            .leader
            .map_or(0.0, |end| length_inside(&place.area, *from, end))
    };
    LEADER_ON_LABEL * others.iter().map(across).sum::<f64>()
}

/// Estimates the length of a segment inside `area` \[pt\].
fn length_inside(area: &Area, from: [f64; 2], to: [f64; 2]) -> f64 {
    /// Distance between the sampled points \[pt\].
    const STEP: f64 = 2.0;
    let apart =
        |at: usize, low: f64, high: f64| from[at].max(to[at]) < low || from[at].min(to[at]) > high;
    if apart(0, area.left, area.right()) || apart(1, area.top, area.bottom()) {
        return 0.0;
    }
    let length = (to[0] - from[0]).hypot(to[1] - from[1]);
    let steps = (length / STEP).ceil().max(1.0);
    let at = |k: usize| {
        let part = (k as f64 + 0.5) / steps;
        std::array::from_fn(|at| from[at] + part * (to[at] - from[at]))
    };
    let inside = (0..steps as usize)
        .filter(|&k| area.contains(at(k)))
        .count();
    inside as f64 * length / steps
}

/// Counts the other dots that are nearer to the label of a dot than the dot itself.
fn nearer_dots(label: &Area, index: usize, dots: &[LabelledDot]) -> usize {
    /// A dot that is nearer by less than this does not mislead \[pt\].
    const SLACK: f64 = 0.5;
    let distance = |dot: &LabelledDot| label.distance(dot.center) - dot.radius;
    let own = distance(&dots[index]);
    dots.iter()
        .enumerate()
        .filter(|(k, dot)| *k != index && distance(dot) + SLACK < own)
        .count()
}

impl LabelledDot {
    /// Approximates the covered area.
    fn area(&self) -> Area {
        let width = 1.9 * self.radius;
        Area::new(
            self.center[0] - 0.5 * width,
            self.center[1] - 0.5 * width,
            width,
            width,
        )
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const SIZE: [f64; 2] = [12.0, 12.0];

    fn around() -> Surroundings {
        Surroundings {
            bounds: Area::new(0.0, 0.0, 140.0, 170.0),
            path: Vec::new(),
            bars: Vec::new(),
        }
    }

    fn dots(centers: &[[f64; 2]]) -> Vec<LabelledDot> {
        centers
            .iter()
            .map(|&center| LabelledDot {
                center,
                radius: 4.0,
                size: SIZE,
            })
            .collect()
    }

    fn places(centers: &[[f64; 2]]) -> Vec<LabelPlace> {
        let places = place_labels(&dots(centers), &around());
        places
            .into_iter()
            .map(|place| place.expect("there is room"))
            .collect()
    }

    fn assert_no_two_overlap(places: &[LabelPlace]) {
        for (k, a) in places.iter().enumerate() {
            for b in &places[k + 1..] {
                assert!(a.area.overlap(&b.area) < 1e-3, "{a:?} {b:?}");
            }
        }
    }

    #[test]
    fn a_lone_dot_is_labelled_above_to_its_right() {
        let place = places(&[[50.0, 50.0]])[0];
        assert!(place.area.left > 50.0 && place.area.bottom() < 50.0);
        assert_eq!(place.leader, None);
    }

    #[test]
    fn labels_of_the_example_do_not_overlap() {
        // PED to NY: conditions 1, 4, 8 and 2, 9 nearly coincide.
        let dots = [
            [120.0, 128.0],
            [136.0, 134.0],
            [12.0, 18.0],
            [120.0, 137.0],
            [12.0, 54.0],
            [50.0, 110.0],
        ];
        let more = [
            [80.0, 106.0],
            [120.0, 134.0],
            [136.0, 134.5],
            [50.0, 91.0],
            [80.0, 120.0],
        ];
        assert_no_two_overlap(&places(&[&dots[..], &more].concat()));
    }

    #[test]
    fn dots_in_one_place_get_labels_side_by_side() {
        assert_no_two_overlap(&places(&[[70.0, 80.0]; 6]));
    }

    #[test]
    fn a_label_stands_nearest_to_its_own_dot() {
        let places = places(&[[70.0, 80.0], [70.0, 89.0], [70.0, 98.0]]);
        let y: Vec<f64> = places.iter().map(|place| place.area.top).collect();
        assert!(y[0] < y[1] && y[1] < y[2], "{y:?}");
    }

    #[test]
    fn a_label_keeps_off_the_line_and_off_bars() {
        let dots = dots(&[[70.0, 80.0]]);
        let path = vec![[60.0, 90.0], [90.0, 60.0]];
        let off_path = place_labels(
            &dots,
            &Surroundings {
                path: path.clone(),
                ..around()
            },
        )[0]
        .unwrap();
        assert_eq!(length_inside(&off_path.area, path[0], path[1]), 0.0);
        let bars = vec![
            Area::new(76.0, 40.0, 3.0, 80.0),
            Area::new(61.0, 40.0, 3.0, 80.0),
        ];
        let off_bars = place_labels(
            &dots,
            &Surroundings {
                bars: bars.clone(),
                ..around()
            },
        )[0]
        .unwrap();
        assert!(
            bars.iter().all(|bar| bar.overlap(&off_bars.area) == 0.0),
            "{off_bars:?}"
        );
    }

    #[test]
    fn labels_stay_inside_the_plot() {
        for dot in [[1.0, 1.0], [139.0, 1.0], [139.0, 169.0], [1.0, 169.0]] {
            let area = places(&[dot])[0].area;
            assert!(
                area.left >= 0.0
                    && area.right() <= 140.0
                    && area.top >= 0.0
                    && area.bottom() <= 170.0
            );
        }
    }

    #[test]
    fn where_there_is_no_room_labels_are_left_out_and_those_that_stay_can_be_read() {
        let narrow = Surroundings {
            bounds: Area::new(40.0, 40.0, 60.0, 60.0),
            ..around()
        };
        let crowd = dots(&[[70.0, 70.0]; 40]);
        let places: Vec<LabelPlace> = place_labels(&crowd, &narrow)
            .into_iter()
            .flatten()
            .collect();
        assert!(places.len() > 4 && places.len() < 40, "{}", places.len());
        for (k, a) in places.iter().enumerate() {
            let covered: f64 = places[k + 1..]
                .iter()
                .map(|b| a.area.overlap(&b.area))
                .sum();
            assert!(covered <= MOST_COVERED * a.area.size(), "{a:?}");
        }
        assert!(
            place_labels(&dots(&vec![[70.0, 70.0]; 5000]), &around())
                .iter()
                .all(Option::is_none)
        );
    }

    #[test]
    fn a_dot_without_a_label_only_stands_in_the_way() {
        let mut crowd = dots(&[[70.0, 80.0], [76.0, 74.0]]);
        crowd[1].size = [0.0, 12.0];
        let places = place_labels(&crowd, &around());
        assert_eq!(places[1], None);
        assert_eq!(places[0].unwrap().area.overlap(&crowd[1].area()), 0.0);
    }
}
