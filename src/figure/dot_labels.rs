//! Where the texts beside dots stand, so that they cover neither dots nor one another.

use super::drawing::Area;
use super::layout::SMALL_PT;
use super::letters::width;

/// Distance of a text from the middle of its dot \[pt\].
const GAP: f64 = 3.4;
/// Half the width of a dot \[pt\].
const DOT: f64 = 2.4;
/// Height of a line of figures as a part of their size: they have no descenders.
const HEIGHT: f64 = 0.74;

/// The area of each text beside its dot, within `frame` where that is possible: dot by dot the place of eight around it that covers
/// least of dots, of texts before it, and of what lies outside.
pub(super) fn places(dots: &[([f64; 2], &str)], frame: &Area) -> Vec<Area> {
    let mut taken: Vec<Area> =
        dots.iter().map(|([x, y], _)| Area::new(x - DOT, y - DOT, 2.0 * DOT, 2.0 * DOT)).collect();
    let mut places = Vec::with_capacity(dots.len());
    for (center, text) in dots {
        let size = [SMALL_PT * width(text), SMALL_PT * HEIGHT];
        let cost = |place: &Area| {
            let outside = size[0] * size[1] - place.overlap(frame);
            4.0 * outside + taken.iter().map(|other| place.overlap(other)).sum::<f64>()
        };
        // Of equal costs the first: the order is one of preference.
        let best = around(*center, size).into_iter().min_by(|a, b| cost(a).total_cmp(&cost(b)));
        places.extend(best);
        taken.extend(best);
    }
    places
}

fn around([x, y]: [f64; 2], [width, height]: [f64; 2]) -> [Area; 8] {
    let (right, left) = (x + GAP, x - GAP - width);
    let (above, below) = (y - GAP - height, y + GAP);
    let (middle_x, middle_y) = (x - 0.5 * width, y - 0.5 * height);
    [
        [right, above + 1.5],
        [right, middle_y],
        [middle_x, above],
        [left, middle_y],
        [right, below - 1.5],
        [middle_x, below],
        [left, above + 1.5],
        [left, below - 1.5],
    ]
    .map(|[left, top]| Area::new(left, top, width, height))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn texts_of_close_dots_do_not_cover_one_another() {
        let frame = Area::new(0.0, 0.0, 80.0, 60.0);
        let dots = [([40.0, 30.0], "1"), ([42.0, 36.0], "4"), ([41.0, 33.0], "8"), ([79.0, 1.0], "11")];
        let places = places(&dots, &frame);
        for (index, place) in places.iter().enumerate() {
            assert!(places[..index].iter().all(|other| place.overlap(other) == 0.0), "{place:?}");
            assert!(frame.contains([place.left, place.top]) && frame.contains([place.right(), place.bottom()]));
        }
    }
}
