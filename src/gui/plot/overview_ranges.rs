//! Ranges of the cells of the overview. All cells have the same frequencies; the cells of a row,
//! which show the same output, have the same magnitudes and the same phases, so that they can be
//! compared by eye.

use std::collections::BTreeMap;
use std::sync::Arc;

use gdcm_model::dataset::Pair;
use gdcm_plot::figure::Range;
use gdcm_plot::figure::responses::fitted_values;

use super::drawn_curves::{BodeCurve, PANES, Pane};
use super::overview_response::OverviewCell;
use super::steady_range::{AxisUpdate, changed_range, labelled_range};
use super::value_unit::ValueUnit;

/// Margin above and below the curves, relative to their height.
const MARGIN: f64 = 0.04;
/// Minimum visible height \[dB\] or \[deg\].
const LEAST_HEIGHT: f64 = 1.0;

/// Visible ranges, kept between frames so that the axes follow new curves with hysteresis
/// ([`changed_range`]).
#[derive(Clone, Debug, Default)]
pub(super) struct SharedRanges {
    /// Values in a row, by output and pane.
    rows: BTreeMap<(usize, Pane), Range>,
    /// Values that fit the curves of a cell.
    fitted: BTreeMap<(Pair, Pane), FittedCell>,
}

/// Range that fits the curves of a cell, with the curves and the band for which it was computed.
#[derive(Clone, Debug)]
struct FittedCell {
    values: Vec<Arc<[f64]>>,
    band: (f64, f64),
    range: Option<Range>,
}

impl FittedCell {
    fn new(curves: &[BodeCurve], pane: Pane, band: (f64, f64)) -> Self {
        Self {
            values: curves
                .iter()
                .map(|curve| Arc::clone(curve.shared_values(pane)))
                .collect(),
            band,
            range: fitted_values(curves, pane, Range::new(band.0, band.1)),
        }
    }

    fn is_of(&self, curves: &[BodeCurve], pane: Pane, band: (f64, f64)) -> bool {
        self.band == band
            && self.values.len() == curves.len()
            && self
                .values
                .iter()
                .zip(curves)
                .all(|(values, curve)| Arc::ptr_eq(values, curve.shared_values(pane)))
    }
}

impl SharedRanges {
    /// Adapts the ranges of all rows to their curves within `band` \[rad/s\].
    pub(super) fn follow(
        &mut self,
        cells: &[OverviewCell<'_>],
        band: (f64, f64),
        update: AxisUpdate,
    ) {
        for pane in PANES {
            let mut rows: BTreeMap<usize, Range> = BTreeMap::new();
            for cell in cells {
                if let Some(range) = self.fitted_range(cell, pane, band) {
                    rows.entry(cell.pair.output)
                        .and_modify(|row| *row = row.union(range))
                        .or_insert(range);
                }
            }
            for (output, values) in rows {
                let fitted = values.with_margin(MARGIN, LEAST_HEIGHT);
                let changed = match self.rows.get(&(output, pane)) {
                    Some(shown) => changed_range(*shown, fitted, update),
                    None => Some(fitted),
                };
                if let Some(changed) = changed {
                    let labelled = labelled_range(changed, value_unit(pane).scale());
                    self.rows.insert((output, pane), labelled);
                }
            }
        }
    }

    /// Returns the values that fit the curves of a cell, computed once for the same curves.
    fn fitted_range(
        &mut self,
        cell: &OverviewCell<'_>,
        pane: Pane,
        band: (f64, f64),
    ) -> Option<Range> {
        let key = (cell.pair, pane);
        let is_known = self
            .fitted
            .get(&key)
            .is_some_and(|known| known.is_of(cell.curves, pane, band));
        if !is_known {
            let fitted = FittedCell::new(cell.curves, pane, band);
            self.fitted.insert(key, fitted);
        }
        self.fitted.get(&key)?.range
    }

    /// Returns the visible values in the cells of an output; `None` without curves.
    pub(super) fn values(&self, output: usize, pane: Pane) -> Option<Range> {
        self.rows.get(&(output, pane)).copied()
    }
}

pub(super) fn value_unit(pane: Pane) -> ValueUnit {
    match pane {
        Pane::Magnitude => ValueUnit::Decibel,
        Pane::Phase => ValueUnit::Degree,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::gui::plot::tests::sample_curve as curve;

    const BAND: (f64, f64) = (0.5, 12.0);

    fn cell(output: usize, input: usize, curves: &[BodeCurve]) -> OverviewCell<'_> {
        OverviewCell {
            pair: Pair::new(output, input),
            curves,
            constrained: false,
            selected: false,
            note: String::new(),
        }
    }

    fn magnitudes(ranges: &SharedRanges, output: usize) -> Range {
        ranges.values(output, Pane::Magnitude).unwrap()
    }

    #[test]
    fn the_cells_of_a_row_have_the_range_of_all_their_curves() {
        let low = [curve(0, &[-31.0, -30.0, -29.0])];
        let high = [curve(1, &[0.0, 9.0, 5.0])];
        let mut ranges = SharedRanges::default();
        let cells = [cell(0, 0, &low), cell(0, 1, &high), cell(1, 0, &high)];
        ranges.follow(&cells, BAND, AxisUpdate::Complete);
        let first = magnitudes(&ranges, 0);
        assert!(first.min <= -31.0 && first.max >= 9.0, "{first:?}");
        let second = magnitudes(&ranges, 1);
        assert!(second.min > -10.0 && second.max >= 9.0, "{second:?}");
    }

    #[test]
    fn a_row_grows_with_a_curve_that_exceeds_it_and_stays_for_one_that_fits() {
        let mut ranges = SharedRanges::default();
        let before = [curve(0, &[0.0, 9.0, 5.0])];
        ranges.follow(&[cell(0, 0, &before)], BAND, AxisUpdate::Complete);
        let shown = magnitudes(&ranges, 0);
        let inside = [curve(0, &[0.5, 8.5, 5.0])];
        ranges.follow(&[cell(0, 0, &inside)], BAND, AxisUpdate::Complete);
        assert_eq!(magnitudes(&ranges, 0), shown);
        let beyond = [curve(0, &[0.0, 20.0, 5.0])];
        ranges.follow(&[cell(0, 0, &beyond)], BAND, AxisUpdate::Pending);
        assert_eq!(magnitudes(&ranges, 0), shown, "results are still computed");
        ranges.follow(&[cell(0, 0, &beyond)], BAND, AxisUpdate::Complete);
        assert!(magnitudes(&ranges, 0).max >= 20.0);
    }

    #[test]
    fn cells_without_values_have_no_range() {
        let empty = [curve(0, &[f64::NAN; 3])];
        let mut ranges = SharedRanges::default();
        ranges.follow(&[cell(0, 0, &empty)], BAND, AxisUpdate::Complete);
        assert_eq!(ranges.values(0, Pane::Magnitude), None);
    }
}
