//! The points of a pane's curves that have to be drawn.

use crate::view::plot::RoleLook;
use egui_plot::{PlotBounds, PlotPoint};

use super::curve::{BodeCurve, LogFrequencies, Pane, runs_in_view};
use super::curve_numbers::CurveNumbers;
use super::pixel::Pixel;
use super::thinning::thinned;
use crate::view::palette::Palette;

/// How far outside the view a point may be to be drawn, as a part of the view: a line has a width.
const LINE_MARGIN: f64 = 0.02;
/// The same for dashes and dots: panning a little is not to change where they begin.
const PATTERN_MARGIN: f64 = 1.0;

/// The points of a pane's curves that have to be drawn, kept as long as they would come out the same: with a thousand
/// models, finding them costs more than drawing them.
#[derive(Clone, Debug, Default)]
pub(super) struct DrawnCurves {
    /// The part in view, and its least detail.
    drawn: Option<(PlotBounds, Pixel)>,
    /// In the order of the curves.
    curves: Vec<DrawnCurve>,
    /// How many curves were made so far.
    made: u64,
}

/// The points of one curve, and from what they were made.
#[derive(Clone, Debug)]
struct DrawnCurve {
    numbers: CurveNumbers,
    margin: f64,
    runs: Vec<Vec<PlotPoint>>,
    /// Which of all that were made it is.
    serial: u64,
}

impl DrawnCurves {
    /// Makes the points anew of what changed since the last frame.
    pub(super) fn update(
        &mut self,
        curves: &[BodeCurve],
        pane: Pane,
        (bounds, pixel): (PlotBounds, Pixel),
        palette: &Palette,
    ) {
        let is_same = |(drawn, curve): (&DrawnCurve, &BodeCurve)| drawn.is_of(curve, pane, margin(curve, palette));
        if self.drawn == Some((bounds, pixel))
            && self.curves.len() == curves.len()
            && self.curves.iter().zip(curves).all(is_same)
        {
            return;
        }
        let mut kept = std::mem::take(&mut self.curves).into_iter().map(Some).collect::<Vec<_>>();
        if self.drawn != Some((bounds, pixel)) {
            kept.clear();
        }
        self.drawn = Some((bounds, pixel));
        let mut axis = LogFrequencies::default();
        let made = &mut self.made;
        let drawn = |(index, curve): (usize, &BodeCurve)| {
            let margin = margin(curve, palette);
            let is_same = |kept: &Option<DrawnCurve>| kept.as_ref().is_some_and(|kept| kept.is_of(curve, pane, margin));
            // Mostly the curves are those of the last frame, in the same order.
            let here = kept.get(index).is_some_and(is_same).then_some(index);
            let place = here.or_else(|| kept.iter().position(is_same));
            place.and_then(|place| kept[place].take()).unwrap_or_else(|| {
                let runs = runs_in_view(curve.points_on(&mut axis, pane), &bounds, margin);
                let points = |run: &Vec<[f64; 2]>| thinned(run, pixel).into_iter().map(PlotPoint::from).collect();
                *made += 1;
                let (numbers, runs) = (CurveNumbers::of(curve, pane), runs.iter().map(points).collect());
                DrawnCurve { numbers, margin, runs, serial: *made }
            })
        };
        self.curves = curves.iter().enumerate().map(drawn).collect();
    }

    /// The lines of the curve at an index.
    pub(super) fn runs(&self, index: usize) -> &[Vec<PlotPoint>] {
        self.curves.get(index).map_or(&[], |curve| &curve.runs)
    }

    /// The number of the lines of the curve at an index: another one as soon as they are made anew.
    pub(super) fn serial(&self, index: usize) -> u64 {
        self.curves.get(index).map_or(0, |curve| curve.serial)
    }
}

impl DrawnCurve {
    fn is_of(&self, curve: &BodeCurve, pane: Pane, margin: f64) -> bool {
        self.margin == margin && self.numbers.are_of(curve, pane)
    }
}

fn margin(curve: &BodeCurve, palette: &Palette) -> f64 {
    if curve.role.look(curve.rejected, palette).is_broken() { PATTERN_MARGIN } else { LINE_MARGIN }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::view::plot::curve::sample_curve as curve;

    const PIXEL: Pixel = Pixel { width: 0.01, tolerance: 0.01 };

    fn view(height: f64) -> (PlotBounds, Pixel) {
        (PlotBounds::from_min_max([0.0, 0.0], [1.0, height]), PIXEL)
    }

    fn update(drawn: &mut DrawnCurves, curves: &[BodeCurve], height: f64) {
        drawn.update(curves, Pane::Magnitude, view(height), &Palette::dark());
    }

    /// Where the points are in memory: elsewhere once they are made anew.
    fn places(drawn: &DrawnCurves) -> Vec<*const PlotPoint> {
        drawn.curves.iter().map(|curve| curve.runs[0].as_ptr()).collect()
    }

    #[test]
    fn points_are_kept_until_their_curve_or_the_view_changes() {
        let (mut drawn, mut curves) = (DrawnCurves::default(), vec![curve(0, &[1.0, 9.0, 5.0]), curve(1, &[1.0; 3])]);
        update(&mut drawn, &curves, 10.0);
        let first = places(&drawn);
        curves[0].highlighted = true;
        update(&mut drawn, &curves, 10.0);
        assert_eq!(places(&drawn), first, "a look is no matter of points");
        curves.swap(0, 1);
        update(&mut drawn, &curves, 10.0);
        assert_eq!(places(&drawn), [first[1], first[0]], "nor is the order");
        curves[0] = curve(1, &[2.0; 3]);
        update(&mut drawn, &curves, 10.0);
        assert_eq!(places(&drawn)[1], first[0]);
        assert_eq!(drawn.runs(0)[0][0].y, 2.0);
        assert_eq!([drawn.serial(0), drawn.serial(1)], [3, 1], "what is made anew has a number of its own");
        // Of the curve that goes up to 9 and back to 5, the steps up to 6 and farther are out of sight.
        update(&mut drawn, &curves[1..], 0.5);
        assert!(drawn.runs(0).is_empty());
    }

    #[test]
    fn what_is_not_there_has_no_points() {
        assert!(DrawnCurves::default().runs(3).is_empty());
    }
}
