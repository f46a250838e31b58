//! The bands of identified models around their curves.

use gdcm_core::dataset::{BundleKind, ModelBands, Pair};
use gdcm_core::identification::TWO_SIDED_95;

use super::plot::{BodeBand, BodeCurve, CurveId};
use super::state::State;

/// The 95 % band of every identified model that is drawn, is kept, and says how uncertain it is.
pub fn uncertainty_bands(state: &State, pair: Pair, curves: &[BodeCurve]) -> Vec<BodeBand> {
    let band = |curve: &BodeCurve| {
        let CurveId::Model(id) = &curve.id else { return None };
        let is_shown = id.bundle == BundleKind::Identified && !curve.rejected && !curve.hidden;
        let bands = state.dataset().model(id).filter(|_| is_shown)?.bands.as_ref()?;
        Some(band_around(curve, bands, pair))
    };
    curves.iter().filter_map(band).collect()
}

fn band_around(curve: &BodeCurve, bands: &ModelBands, pair: Pair) -> BodeBand {
    let (db, deg) = (&bands.sd_db()[pair], &bands.sd_deg()[pair]);
    let mut band = BodeBand::default();
    for (index, omega) in curve.omega.iter().enumerate() {
        let Some((at, part)) = place(bands.omega(), *omega) else { continue };
        let sd = |values: &[f64]| TWO_SIDED_95 * (values[at] + part * (values[at + 1] - values[at]));
        let around = |value: f64, half: f64| [value - half, value + half];
        band.omega.push(*omega);
        band.magnitude_db.push(around(curve.magnitude_db[index], sd(db)));
        band.phase_deg.push(around(curve.phase_deg[index], sd(deg)));
    }
    band
}

/// Between which two of `omegas` a frequency lies, and how far by its logarithm; none outside of them.
fn place(omegas: &[f64], omega: f64) -> Option<(usize, f64)> {
    let above = omegas.partition_point(|of| *of <= omega);
    let at = above.checked_sub(1)?;
    match omegas.get(above) {
        Some(next) => Some((at, (omega / omegas[at]).ln() / (next / omegas[at]).ln())),
        None if omegas[at] == omega && at > 0 => Some((at - 1, 1.0)),
        None => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_frequency_lies_between_two_by_its_logarithm_and_nowhere_outside() {
        let omegas = [1.0, 10.0, 100.0];
        assert_eq!(place(&omegas, 10.0), Some((1, 0.0)));
        let (at, part) = place(&omegas, 10f64.powf(1.5)).unwrap();
        assert!(at == 1 && (part - 0.5).abs() < 1e-12);
        assert_eq!(place(&omegas, 100.0), Some((1, 1.0)), "the last one belongs to the band");
        assert_eq!((place(&omegas, 0.9), place(&omegas, 101.0)), (None, None));
    }
}
