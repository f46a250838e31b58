//! The pure delay that fits a phase difference best (M6b).

use nalgebra::Complex;

/// Delays from -600 to 600 steps are compared.
const STEPS: i32 = 600;
/// Step between two compared delays \[s\].
const STEP_S: f64 = 1e-3;
/// Steps between neighbouring delays in the coarse grid: with more, fewer coarse and more fine
/// delays are evaluated.
const COARSE: i32 = 16;

/// Returns the delay \[s\] among -0.600, -0.599 ... 0.600 that agrees best with a phase, by the
/// agreement `L = sum cos(phase - omega delay)`; the first, if several are equal (M6b).
///
/// ```text
/// 1  L at every 16th delay (coarse grid)
/// 2  L at each of the 16 delays around a coarse delay (fine grid), unless L cannot rise to the
///    maximum of step 1 there: it rises by at most sum omega per second, because
///    |dL / d delay| <= sum omega
/// ```
pub(super) fn nearest_pure_delay_s(phase: &[f64], omega: &[f64]) -> f64 {
    // Step 1: up to half a coarse step beyond the end, so that every delay is near a coarse one.
    let coarse_steps: Vec<i32> = (-STEPS..=STEPS + COARSE / 2)
        .step_by(COARSE as usize)
        .collect();
    let coarse_grid = DelayGrid {
        first_s: delay_s(-STEPS),
        step_s: delay_s(COARSE),
        count: coarse_steps.len(),
    };
    let coarse = agreements(phase, omega, &coarse_grid);
    let greatest = coarse.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    // Maximum rise in L within half a coarse step; the added 1e-9 per term exceeds the sums'
    // rounding error.
    let rise = delay_s(COARSE / 2) * omega.iter().map(|omega| omega.abs()).sum::<f64>()
        + 1e-9 * phase.len() as f64;
    // Step 2
    let mut best_agreement = f64::NEG_INFINITY;
    let mut best_s = 0.0;
    for (step, agreement) in coarse_steps.into_iter().zip(coarse) {
        if agreement + rise < greatest {
            continue;
        }
        // Fine grid: half a coarse step to either side.
        let first = (step - COARSE / 2).max(-STEPS);
        let end = (step + COARSE / 2).min(STEPS + 1);
        let fine_grid = DelayGrid {
            first_s: delay_s(first),
            step_s: STEP_S,
            count: (end - first) as usize,
        };
        let fine = agreements(phase, omega, &fine_grid);
        for (step, agreement) in (first..end).zip(fine) {
            if agreement > best_agreement {
                best_agreement = agreement;
                best_s = delay_s(step);
            }
        }
    }
    best_s
}

/// Delays on a grid: `first_s`, `first_s + step_s`, ...
struct DelayGrid {
    first_s: f64,
    step_s: f64,
    count: usize,
}

/// Returns the delay \[s\] at a step.
fn delay_s(step: i32) -> f64 {
    STEP_S * f64::from(step)
}

/// Computes `L = sum cos(phase - omega delay)` for each delay in a grid, as the real part of
/// `sum e^(j (phase - omega delay))`.
fn agreements(phase: &[f64], omega: &[f64], grid: &DelayGrid) -> Vec<f64> {
    // The summands are rotated from each delay to the next: computing every cosine takes a dozen
    // times as long.
    let mut summands = Vec::with_capacity(phase.len());
    for (phase, omega) in phase.iter().zip(omega) {
        summands.push(Complex::from_polar(1.0, phase - omega * grid.first_s));
    }
    let rotations: Vec<Complex<f64>> = omega
        .iter()
        .map(|omega| Complex::from_polar(1.0, -omega * grid.step_s))
        .collect();
    let mut agreements = Vec::with_capacity(grid.count);
    for _ in 0..grid.count {
        agreements.push(summands.iter().map(|summand| summand.re).sum());
        for (summand, rotation) in summands.iter_mut().zip(&rotations) {
            *summand *= rotation;
        }
    }
    agreements
}

#[cfg(test)]
mod tests {
    use super::*;

    fn agreement(phase: &[f64], omega: &[f64], delay_s: f64) -> f64 {
        phase
            .iter()
            .zip(omega)
            .map(|(phase, omega)| (phase - omega * delay_s).cos())
            .sum()
    }

    proptest::proptest! {
        #[test]
        fn no_delay_of_all_is_more_like_the_phase(
            phase in proptest::collection::vec(-20.0..20.0, 1..60),
            most in 0.5..40.0,
            slope in -0.7..0.7,
        ) {
            let omega: Vec<f64> = (1..=phase.len()).map(|k| most * k as f64 / phase.len() as f64).collect();
            for scatter in [1.0, 0.05] {
                let phase: Vec<f64> = phase.iter().zip(&omega).map(|(phase, omega)| scatter * phase + slope * omega).collect();
                let greatest = (-600..=600)
                    .map(|step| agreement(&phase, &omega, 1e-3 * f64::from(step)))
                    .fold(f64::NEG_INFINITY, f64::max);
                let found = nearest_pure_delay_s(&phase, &omega);
                // Two sums of at most 60 cosines, of angles in the hundreds, differ in their last
                // digits.
                let best = agreement(&phase, &omega, found);
                proptest::prop_assert!(best >= greatest - 1e-10, "{} s", found);
            }
        }
    }
}
