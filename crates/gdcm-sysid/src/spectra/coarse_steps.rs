//! Recognises channels that are logged in coarse steps, over half their standard deviation
//! (M14.18).

/// A channel is coarse if its smallest step between values exceeds this share of the standard
/// deviation.
pub(crate) const COARSE: f64 = 0.5;
/// Differences between two values below this share of the standard deviation are no steps.
const NO_STEP: f64 = 1e-3;

/// Returns whether a channel has so few distinct values that equal consecutive samples are normal.
pub(crate) fn is_coarse(values: &[f64]) -> bool {
    coarseness(values).is_some_and(|steps| steps > COARSE)
}

/// Returns the smallest step between two values divided by the standard deviation; `None` if the
/// channel is constant, or if all steps are below a thousandth of the standard deviation.
pub(crate) fn coarseness(values: &[f64]) -> Option<f64> {
    let count = values.len().max(1) as f64;
    let mean = values.iter().sum::<f64>() / count;
    let variance = values.iter().map(|x| (x - mean).powi(2)).sum::<f64>() / count;
    let deviation = variance.sqrt();
    let mut sorted = values.to_vec();
    sorted.sort_by(f64::total_cmp);
    let least = sorted
        .windows(2)
        .map(|pair| pair[1] - pair[0])
        .filter(|step| *step > NO_STEP * deviation)
        .fold(f64::INFINITY, f64::min);
    if deviation > 0.0 && least.is_finite() {
        Some(least / deviation)
    } else {
        None
    }
}
