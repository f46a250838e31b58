//! How much mixing and feedback change each response, which matters above the band (M16.4).

use gdcm_model::dataset::PairTable;
use gdcm_model::response::FrequencyResponse;
use gdcm_model::units::ratio_to_db;

/// Returns `20 log10 |H~ - H| / |H|` for every response at frequency index `k`, p x m; `None` if a
/// value is not finite or `H` is zero, minus infinity if nothing changes.
pub fn relative_change_db(
    physics: &FrequencyResponse,
    coupled: &FrequencyResponse,
    k: usize,
) -> PairTable<Option<f64>> {
    physics.curves().map(|pair, curve| {
        let before = curve.get(k)?;
        let after = coupled.curve(pair).get(k)?;
        let ratio = (after - before).norm() / before.norm();
        if ratio.is_finite() {
            Some(ratio_to_db(ratio))
        } else {
            None
        }
    })
}
