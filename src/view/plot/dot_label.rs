//! The labels of a plot's dots from frame to frame.

use egui::{Pos2, Rect};

use gdcm_files::figure::{Area, LabelPlace, LabelledDot, Surroundings, place_labels};

/// Labels as they were placed last: placing them costs more than drawing them, and from frame to frame little moves.
#[derive(Clone, Debug, Default)]
pub struct PlacedLabels {
    /// The dots, and what is around them, that the places are for.
    placed_for: Option<(Vec<LabelledDot>, Surroundings)>,
    places: Vec<Option<LabelPlace>>,
}

impl PlacedLabels {
    /// The places of the labels of `dots`, in their order; none of a label without room.
    pub fn places(&mut self, dots: Vec<LabelledDot>, around: Surroundings) -> &[Option<LabelPlace>] {
        let asked = (dots, around);
        if self.placed_for.as_ref() != Some(&asked) {
            self.places = place_labels(&asked.0, &asked.1);
            self.placed_for = Some(asked);
        }
        &self.places
    }

    /// Whether a label has no room.
    pub fn leaves_some_out(&self) -> bool {
        self.places.iter().any(Option::is_none)
    }
}

/// A rectangle of the screen.
pub(super) fn area(rect: Rect) -> Area {
    Area::new(rect.left().into(), rect.top().into(), rect.width().into(), rect.height().into())
}

/// A place on the screen.
pub(super) fn point(at: Pos2) -> [f64; 2] {
    [at.x.into(), at.y.into()]
}

/// The place on the screen of a point.
pub(super) fn position([x, y]: [f64; 2]) -> Pos2 {
    Pos2::new(x as f32, y as f32)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn labels_are_placed_anew_where_a_dot_moved() {
        let mut labels = PlacedLabels::default();
        let mut placed = |x: f64| {
            let dots = vec![LabelledDot { center: [x, 80.0], radius: 4.0, size: [12.0, 12.0] }];
            let bounds = Area::new(0.0, 0.0, 140.0, 170.0);
            labels.places(dots, Surroundings { bounds, path: Vec::new(), bars: Vec::new() })[0].unwrap().area
        };
        let (first, again, moved) = (placed(70.0), placed(70.0), placed(75.0));
        assert_eq!(first, again);
        assert_eq!(moved, Area::new(first.left + 5.0, first.top, first.width, first.height));
    }
}
