//! The step between two samples: its median, and its longest plausible value.

/// Longest plausible time between two samples in a manoeuvre \[s\].
pub(super) const LONGEST_STEP_S: f64 = 1.5;

/// Returns the median step between consecutive stamps; `None` without finite steps.
pub fn median_step(stamps: &[f64]) -> Option<f64> {
    let mut steps: Vec<f64> = stamps
        .windows(2)
        .map(|pair| pair[1] - pair[0])
        .filter(|step| step.is_finite())
        .collect();
    if steps.is_empty() {
        return None;
    }
    let middle = steps.len() / 2;
    let (_, median, _) = steps.select_nth_unstable_by(middle, f64::total_cmp);
    Some(*median)
}
