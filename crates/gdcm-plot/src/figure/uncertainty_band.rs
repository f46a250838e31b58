//! Uncertainty bands about the identified models' curves.

use gdcm_model::dataset::model::ModelBands;
use gdcm_model::dataset::{BundleKind, Dataset, Pair};
use gdcm_sysid::diagnostics::bands::TWO_SIDED_95;

use super::bode_curve::{BodeCurve, CurveId};

/// Area between two lines over frequency: an uncertainty band about a curve, a range of errors, or
/// a remaining error, where either line may be the upper one.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct BodeBand {
    /// Frequencies \[rad/s\], ascending.
    pub omega: Vec<f64>,
    /// Magnitudes of both lines \[dB\], usually the lower first.
    pub magnitude_db: Vec<[f64; 2]>,
    /// Phases of both lines \[deg\], usually the lower first.
    pub phase_deg: Vec<[f64; 2]>,
}

/// Returns the 95 % band about every identified model among `curves` that is visible, is not
/// rejected, and has an uncertainty.
pub fn uncertainty_bands(dataset: &Dataset, pair: Pair, curves: &[BodeCurve]) -> Vec<BodeBand> {
    let mut bands = Vec::new();
    for curve in curves {
        if let CurveId::Model(id) = &curve.id
            && id.bundle == BundleKind::Identified
            && !curve.rejected
            && !curve.hidden
            && let Some(model) = dataset.model(id)
            && let Some(deviations) = &model.bands
        {
            bands.push(band_about(curve, deviations, pair));
        }
    }
    bands
}

/// Returns the band about a curve, at those frequencies that lie within the grid of the standard
/// deviations.
fn band_about(curve: &BodeCurve, deviations: &ModelBands, pair: Pair) -> BodeBand {
    let sd_db = &deviations.sd_db()[pair];
    let sd_deg = &deviations.sd_deg()[pair];
    let mut band = BodeBand::default();
    for (index, omega) in curve.omega.iter().enumerate() {
        let Some(place) = GridPlace::find(deviations.omega(), *omega) else {
            continue;
        };
        let db = curve.magnitude_db[index];
        let half_db = TWO_SIDED_95 * place.interpolate(sd_db);
        let deg = curve.phase_deg[index];
        let half_deg = TWO_SIDED_95 * place.interpolate(sd_deg);
        band.omega.push(*omega);
        band.magnitude_db.push([db - half_db, db + half_db]);
        band.phase_deg.push([deg - half_deg, deg + half_deg]);
    }
    band
}

/// Position of a frequency between two neighbouring grid points.
#[derive(Clone, Copy, Debug, PartialEq)]
struct GridPlace {
    /// Index of the lower neighbour.
    lower: usize,
    /// Distance from the lower neighbour in `log omega`, as a fraction of the grid interval.
    part: f64,
}

impl GridPlace {
    /// Finds `omega` in an ascending frequency grid; `None` outside the grid.
    fn find(grid: &[f64], omega: f64) -> Option<Self> {
        let upper = grid.partition_point(|at| *at <= omega);
        let lower = upper.checked_sub(1)?;
        match grid.get(upper) {
            Some(next) => Some(Self {
                lower,
                part: (omega / grid[lower]).ln() / (next / grid[lower]).ln(),
            }),
            // The grid's last frequency counts as the end of the last interval.
            None if grid[lower] == omega && lower > 0 => Some(Self {
                lower: lower - 1,
                part: 1.0,
            }),
            None => None,
        }
    }

    /// Interpolates linearly between values given on the grid.
    fn interpolate(self, values: &[f64]) -> f64 {
        let low = values[self.lower];
        low + self.part * (values[self.lower + 1] - low)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_frequency_lies_between_two_by_its_logarithm_and_nowhere_outside() {
        let grid = [1.0, 10.0, 100.0];
        let exact = GridPlace {
            lower: 1,
            part: 0.0,
        };
        assert_eq!(GridPlace::find(&grid, 10.0), Some(exact));
        let between = GridPlace::find(&grid, 10f64.powf(1.5)).unwrap();
        assert!(between.lower == 1 && (between.part - 0.5).abs() < 1e-12);
        let last = GridPlace {
            lower: 1,
            part: 1.0,
        };
        assert_eq!(GridPlace::find(&grid, 100.0), Some(last));
        assert_eq!(GridPlace::find(&grid, 0.9), None);
        assert_eq!(GridPlace::find(&grid, 101.0), None);
    }
}
