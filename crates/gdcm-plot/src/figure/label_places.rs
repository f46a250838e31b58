//! Places labels around dots, clear of other dots, bars and labels.
//!
//! ```text
//! more than 300 labels: place none
//! three times, for each dot:
//!     try 8 directions at 6 distances; keep the cheapest place. Cost, given the other labels:
//!         area over other labels, dots, bars, and outside the bounds
//!         length of leaders across labels
//!         length of the path under the label
//!         number of other dots that are nearer to the label than the labelled dot
//!         rank of the direction, and distance
//! remove labels that cover too much, the worst first
//! ```
//!
//! A *leader* is the line from a dot to a label that does not touch it.
//!
//! The screen and paper use the same method, in points; y runs downwards.

use super::drawing::Area;

/// Direction in which a label lies from its dot.
#[derive(Clone, Copy)]
struct Direction {
    /// Fractions of the label's width and height that lie to the left of its anchor and above it.
    before: [f64; 2],
    /// Unit vector from the dot's centre to the anchor, y downwards; rounded on the diagonals.
    offset: [f64; 2],
}

/// Directions in which a label may lie from its dot, the preferred first: above right, below right,
/// above left, below left, right, above, left, below.
const DIRECTIONS: [Direction; 8] = [
    Direction {
        before: [0.0, 1.0],
        offset: [0.7, -0.7],
    },
    Direction {
        before: [0.0, 0.0],
        offset: [0.7, 0.7],
    },
    Direction {
        before: [1.0, 1.0],
        offset: [-0.7, -0.7],
    },
    Direction {
        before: [1.0, 0.0],
        offset: [-0.7, 0.7],
    },
    Direction {
        before: [0.0, 0.5],
        offset: [1.0, 0.0],
    },
    Direction {
        before: [0.5, 1.0],
        offset: [0.0, -1.0],
    },
    Direction {
        before: [1.0, 0.5],
        offset: [-1.0, 0.0],
    },
    Direction {
        before: [0.5, 0.0],
        offset: [0.0, 1.0],
    },
];
/// Tried distances from the dot's edge \[pt\]; at all but the first, a leader connects the dot to
/// its label.
const GAPS: [f64; 6] = [1.5, 8.0, 15.0, 22.0, 30.0, 40.0];
/// Number of passes; each pass places every label again, given the other labels, since a label
/// placed early does not know the later ones.
const SWEEPS: usize = 3;
/// With more labels than this, no label is placed, because they would be unreadable and slow to
/// place.
const MOST_LABELS: usize = 300;

// Costs of a place. One square point over text or a dot (40) costs more than the last direction at
// the largest distance (0.2 * 7 + 0.6 * 40 = 25.4), so that any free place is preferred to one
// that covers text or dots; bars and the path cost less.

/// Cost per square point that a label covers on another label.
const ON_LABEL: f64 = 40.0;
/// Cost per square point that a label covers on a dot.
const ON_DOT: f64 = 40.0;
/// Cost per square point that a label covers on a bar.
const ON_BAR: f64 = 8.0;
/// Cost per square point of a label outside the bounds.
const OUTSIDE: f64 = 30.0;
/// Cost per point of a path's length under a label.
const ON_PATH: f64 = 1.0;
/// Cost per point of a leader's length across a label.
const LEADER_ON_LABEL: f64 = 20.0;
/// Cost of each other dot that is nearer to a label than the labelled dot.
const AMBIGUOUS: f64 = 6.0;
/// Cost of each direction that precedes the chosen direction in [`DIRECTIONS`].
const LATER_DIRECTION: f64 = 0.2;
/// Cost per point of distance from the dot's edge.
const FARTHER: f64 = 0.6;
/// Maximum sum of the fractions of a label's area over other labels, over dots and outside the
/// bounds. A label with a larger sum is removed as unreadable; bars and the path do not count,
/// because text across a line remains readable.
const MOST_COVERED: f64 = 0.12;
/// Side of the square that approximates a dot, relative to the dot's radius: slightly more than the
/// 1.77 at which it has the area of a circle.
const DOT_SIDE: f64 = 1.9;
/// Margin around other labels \[pt\].
const LABEL_MARGIN: f64 = 1.0;
/// Distance between sampled points along a line \[pt\].
const STEP: f64 = 2.0;
/// Tolerance \[pt\]: another dot that is nearer to a label by less than this is not mistaken for
/// the labelled dot.
const SLACK: f64 = 0.5;

/// Place for a label, and for the end of its leader.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LabelPlace {
    /// Area that the text covers.
    pub area: Area,
    /// Point of `area` at which the leader ends; `None` for a label without a leader.
    pub leader: Option<[f64; 2]>,
}

/// A dot, with the size of the label to be placed beside it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LabelledDot {
    pub center: [f64; 2],
    /// Radius \[pt\] of the dot or of the ring around it, which labels should not cover.
    pub radius: f64,
    /// Label width and height; no label is placed if its width is zero.
    pub size: [f64; 2],
}

impl LabelledDot {
    /// Returns a square that approximates the area covered by the dot.
    fn area(&self) -> Area {
        let width = DOT_SIDE * self.radius;
        Area::new(
            self.center[0] - 0.5 * width,
            self.center[1] - 0.5 * width,
            width,
            width,
        )
    }

    /// Returns the distance from the dot's edge to a label; negative if they overlap.
    fn distance_to(&self, label: &Area) -> f64 {
        label.distance(self.center) - self.radius
    }
}

/// Obstacles to labels, in addition to the dots.
#[derive(Clone, Debug, PartialEq)]
pub struct Surroundings {
    /// Area in which labels should lie.
    pub bounds: Area,
    /// A line that labels should not cover.
    pub path: Vec<[f64; 2]>,
    pub bars: Vec<Area>,
}

/// Places labels for `dots`, and returns the places in the same order; `None` for a label without
/// room or of zero width. With more than 300 labels, all places are `None`.
pub fn place_labels(dots: &[LabelledDot], around: &Surroundings) -> Vec<Option<LabelPlace>> {
    let mut placing = Placing {
        dots,
        around,
        places: vec![None; dots.len()],
    };
    let labelled: Vec<usize> = (0..dots.len())
        .filter(|&index| dots[index].size[0] > 0.0)
        .collect();
    if labelled.len() > MOST_LABELS {
        return placing.places;
    }
    for _ in 0..SWEEPS {
        for &index in &labelled {
            placing.places[index] = placing.best_place(index);
        }
    }
    // The label with the largest covered part is removed first: labels that it overlaps may then
    // remain.
    while let Some(worst) = placing.most_covered(&labelled) {
        placing.places[worst] = None;
    }
    placing.places
}

/// Labels placed so far.
struct Placing<'a> {
    dots: &'a [LabelledDot],
    around: &'a Surroundings,
    /// In the same order as `dots`.
    places: Vec<Option<LabelPlace>>,
}

/// Another dot's label, at its present place.
struct OtherLabel {
    place: LabelPlace,
    /// Centre of the dot that it labels.
    center: [f64; 2],
}

/// A possible place for a label. `cost` covers direction and distance alone as returned by
/// [`candidates`]; in [`Placing::best_place`] the best candidate has its full cost.
struct Candidate {
    place: LabelPlace,
    cost: f64,
}

impl Placing<'_> {
    /// Returns the cheapest place for a dot's label, given the other labels.
    fn best_place(&self, index: usize) -> Option<LabelPlace> {
        let others = self.other_labels(index);
        let mut best: Option<Candidate> = None;
        for candidate in candidates(self.dots[index]) {
            // Direction and distance alone already rule out most places.
            if !is_better(candidate.cost, &best) {
                continue;
            }
            let cost = self.cost(&candidate, index, &others);
            if is_better(cost, &best) {
                let place = candidate.place;
                best = Some(Candidate { place, cost });
            }
        }
        best.map(|candidate| candidate.place)
    }

    fn other_labels(&self, index: usize) -> Vec<OtherLabel> {
        let mut others = Vec::new();
        for (other, (place, dot)) in self.places.iter().zip(self.dots).enumerate() {
            if let Some(place) = place
                && other != index
            {
                others.push(OtherLabel {
                    place: *place,
                    center: dot.center,
                });
            }
        }
        others
    }

    /// Returns a candidate's full cost for a dot's label.
    fn cost(&self, candidate: &Candidate, index: usize, others: &[OtherLabel]) -> f64 {
        let place = &candidate.place;
        let ambiguity = AMBIGUOUS * self.nearer_dots(&place.area, index) as f64;
        let leaders = leaders_on_labels(place, self.dots[index].center, others);
        candidate.cost + ambiguity + leaders + self.obstruction(&place.area, others)
    }

    /// Returns the cost for everything that a label covers, and for its part outside the bounds.
    fn obstruction(&self, area: &Area, others: &[OtherLabel]) -> f64 {
        let on_labels: f64 = others
            .iter()
            .map(|other| area.overlap(&other.place.area.expanded(LABEL_MARGIN)))
            .sum();
        let on_bars: f64 = self.around.bars.iter().map(|bar| area.overlap(bar)).sum();
        let on_path: f64 = self
            .around
            .path
            .windows(2)
            .map(|ends| length_inside(area, ends[0], ends[1]))
            .sum();
        ON_LABEL * on_labels
            + ON_DOT * self.on_dots(area)
            + ON_BAR * on_bars
            + OUTSIDE * self.outside(area)
            + ON_PATH * on_path
    }

    /// Returns the area \[pt²\] that a label shares with dots.
    fn on_dots(&self, label: &Area) -> f64 {
        self.dots.iter().map(|dot| label.overlap(&dot.area())).sum()
    }

    /// Returns how much of a label's area \[pt²\] lies outside the bounds.
    fn outside(&self, label: &Area) -> f64 {
        label.size() - label.overlap(&self.around.bounds)
    }

    /// Counts the other dots that are nearer to a dot's label than the dot itself.
    fn nearer_dots(&self, label: &Area, index: usize) -> usize {
        let own = self.dots[index].distance_to(label);
        self.dots
            .iter()
            .enumerate()
            .filter(|(other, dot)| *other != index && dot.distance_to(label) + SLACK < own)
            .count()
    }

    /// Returns the index of the dot whose label has the largest covered part; `None` if no part
    /// exceeds [`MOST_COVERED`].
    fn most_covered(&self, labelled: &[usize]) -> Option<usize> {
        let mut worst = None;
        let mut most = MOST_COVERED;
        for &index in labelled {
            let part = self.covered_part(index);
            if part > MOST_COVERED && part >= most {
                worst = Some(index);
                most = part;
            }
        }
        worst
    }

    /// Returns the sum of the fractions of a label's area over other labels, over dots and outside
    /// the bounds.
    fn covered_part(&self, index: usize) -> f64 {
        let Some(place) = self.places[index] else {
            return 0.0;
        };
        let mut on_labels = 0.0;
        for (other, label) in self.places.iter().enumerate() {
            if let Some(label) = label
                && other != index
            {
                on_labels += place.area.overlap(&label.area);
            }
        }
        (on_labels + self.on_dots(&place.area) + self.outside(&place.area)) / place.area.size()
    }
}

fn is_better(cost: f64, best: &Option<Candidate>) -> bool {
    match best {
        Some(best) => cost < best.cost,
        None => true,
    }
}

/// Returns the possible places for a dot's label, each with the cost of its direction and distance.
fn candidates(dot: LabelledDot) -> Vec<Candidate> {
    let mut candidates = Vec::new();
    for (ring, gap) in GAPS.into_iter().enumerate() {
        for (rank, direction) in DIRECTIONS.into_iter().enumerate() {
            let distance = dot.radius + gap;
            let anchor = [0, 1].map(|axis| dot.center[axis] + direction.offset[axis] * distance);
            let [left, top] =
                [0, 1].map(|axis| anchor[axis] - direction.before[axis] * dot.size[axis]);
            let place = LabelPlace {
                area: Area::new(left, top, dot.size[0], dot.size[1]),
                leader: if ring > 0 { Some(anchor) } else { None },
            };
            let cost = rank as f64 * LATER_DIRECTION + gap * FARTHER;
            candidates.push(Candidate { place, cost });
        }
    }
    candidates
}

/// Returns the cost for leaders across labels: the label's own leader across other labels, and
/// other leaders across the label.
fn leaders_on_labels(place: &LabelPlace, center: [f64; 2], others: &[OtherLabel]) -> f64 {
    let mut length = 0.0;
    for other in others {
        let own_leader = match place.leader {
            Some(end) => length_inside(&other.place.area, center, end),
            None => 0.0,
        };
        let other_leader = match other.place.leader {
            Some(end) => length_inside(&place.area, other.center, end),
            None => 0.0,
        };
        length += own_leader + other_leader;
    }
    LEADER_ON_LABEL * length
}

/// Estimates the length \[pt\] of a segment inside `area`, from points sampled along it.
fn length_inside(area: &Area, from: [f64; 2], to: [f64; 2]) -> f64 {
    let is_left_or_right = from[0].max(to[0]) < area.left || from[0].min(to[0]) > area.right();
    let is_above_or_below = from[1].max(to[1]) < area.top || from[1].min(to[1]) > area.bottom();
    if is_left_or_right || is_above_or_below {
        return 0.0;
    }
    let length = (to[0] - from[0]).hypot(to[1] - from[1]);
    let steps = (length / STEP).ceil().max(1.0);
    let mut inside = 0;
    for k in 0..steps as usize {
        let part = (k as f64 + 0.5) / steps;
        let point = [0, 1].map(|axis| from[axis] + part * (to[axis] - from[axis]));
        if area.contains(point) {
            inside += 1;
        }
    }
    f64::from(inside) * length / steps
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
        // Net gains from PED to NY in the example: conditions 1, 4 and 8, and 2 and 9, nearly
        // coincide.
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
