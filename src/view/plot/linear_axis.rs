//! Ticks of linear axes: decibels, degrees, and everything else.

use egui_plot::{GridInput, GridMark};

use super::grid_strength::labelled_mark;
use super::number::compact;
use gdcm_files::figure::{degree_step, step_above};

/// The steps that ticks may have.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Ladder {
    /// 1, 2, 5 times a power of ten: decibels, knots, gains.
    Decimal,
    /// Parts of a turn: 1, 2, 5, 10, 15, 30, 45, 60, 90, 180, 360 degrees and multiples of a turn.
    Degrees,
}

impl Ladder {
    /// The least step of this ladder that is not below `least`.
    pub fn step(self, least: f64) -> f64 {
        match self {
            Self::Degrees => degree_step(least),
            Self::Decimal => step_above(least),
        }
    }

    /// Labelled ticks between `bounds`, at least `gap` points apart on an axis of `units_per_point`.
    pub fn marks(self, bounds: (f64, f64), units_per_point: f64, gap: f64) -> Vec<GridMark> {
        if !(units_per_point > 0.0 && units_per_point.is_finite() && bounds.0 < bounds.1) {
            return Vec::new();
        }
        let step = self.step(gap * units_per_point);
        let slack = 1e-6;
        let indices = (bounds.0 / step - slack).ceil() as i64..=(bounds.1 / step + slack).floor() as i64;
        indices.map(|k| labelled_mark(k as f64 * step, units_per_point)).collect()
    }

    /// [`Self::marks`] as egui_plot asks for them, where the base step is one point.
    pub fn spacer(self, gap: f64) -> impl Fn(GridInput) -> Vec<GridMark> {
        move |input| self.marks(input.bounds, input.base_step_size, gap)
    }
}

/// The text of a tick of a linear axis.
pub fn tick_text(mark: GridMark) -> String {
    compact(mark.value)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn values(ladder: Ladder, bounds: (f64, f64), points: f64) -> Vec<f64> {
        let marks = ladder.marks(bounds, (bounds.1 - bounds.0) / points, 28.0);
        marks.into_iter().map(|mark| mark.value).collect()
    }

    #[test]
    fn magnitudes_are_labelled_at_five_ten_or_twenty_decibels() {
        assert_eq!(values(Ladder::Decimal, (-26.0, 10.0), 290.0), [-25.0, -20.0, -15.0, -10.0, -5.0, 0.0, 5.0, 10.0]);
        assert_eq!(
            values(Ladder::Decimal, (-80.0, 20.0), 290.0),
            [-80.0, -70.0, -60.0, -50.0, -40.0, -30.0, -20.0, -10.0, 0.0, 10.0, 20.0]
        );
    }

    #[test]
    fn phases_are_labelled_at_parts_of_a_turn() {
        assert_eq!(values(Ladder::Degrees, (-330.0, 60.0), 200.0), [-300.0, -240.0, -180.0, -120.0, -60.0, 0.0, 60.0]);
        assert_eq!(values(Ladder::Degrees, (-200.0, 10.0), 250.0), [-180.0, -150.0, -120.0, -90.0, -60.0, -30.0, 0.0]);
        assert_eq!(values(Ladder::Degrees, (-900.0, 0.0), 200.0), [-900.0, -720.0, -540.0, -360.0, -180.0, 0.0]);
    }

    #[test]
    fn a_step_is_the_next_round_number() {
        for (least, step) in [(0.011, 0.02), (0.2, 0.2), (3.0, 5.0), (6.0, 10.0), (1e-7, 1e-7)] {
            assert!((step_above(least) / step - 1.0).abs() < 1e-9, "{least}: {}", step_above(least));
        }
    }

    #[test]
    fn bounds_that_are_no_range_give_no_ticks() {
        assert!(Ladder::Decimal.marks((1.0, 1.0), 0.0, 28.0).is_empty());
        assert!(Ladder::Degrees.marks((0.0, f64::NAN), f64::NAN, 28.0).is_empty());
    }
}
