//! Pairs a model's modes with flown modes: close in the s-plane and similar in shape over the
//! outputs (M17.3). A *flown* mode is a mode of the model identified from flight.
//!
//! ```text
//! 1  mode: a real pole, or the upper pole of a conjugate pair
//! 2  output scale:  s_i^2 = sum_k |r_ki|^2 / max(|lambda_k|, omega_min)^2 over all flown poles,
//!    both of a pair;  r_k = (C v_k) |w_k B|
//! 3  distance  d = |lambda - lambda'| / max(|lambda|, |lambda'|, omega_min)
//!    likeness  c = |sum_i r_i* r'_i / s_i^2|^2 / (sum_i |r_i|^2 / s_i^2  sum_i |r'_i|^2 / s_i^2)
//! 4  a pair has d <= 1/2 and c >= 1/2; the sum of d + 1 - c is minimised,
//!    an unpaired flown mode counts as 1
//! ```
//!
//! `r_k` are mode k's residues in the outputs, with `v_k` and `w_k` the right and the left
//! eigenvector for its pole `lambda_k`, and `C` and `B` the output and the input matrix; primes
//! mark the other model. `omega_min` is the lower end of the band: below it flight resolves poles
//! only by their absolute difference. `c` is the modal assurance criterion, 1 for equal shapes and
//! 0 for orthogonal shapes: Allemang & Brown, "A correlation coefficient for modal vector
//! analysis", Proc. 1st International Modal Analysis Conference, 1982. Assignment: see
//! `fidelity/assignment.rs`.

use nalgebra::Complex;

use gdcm_model::response::Mode;

use crate::fidelity::assignment::cheapest_assignment;

/// Maximum s-plane distance within a pair, relative to the larger modulus: real poles in a pair
/// differ by a factor of two at most. A compromise: a larger value pairs modes of different kinds,
/// a smaller one leaves modes that the physics model has elsewhere unpaired.
pub const LARGEST_PAIR_DISTANCE: f64 = 0.5;
/// Minimum likeness `c` between the shapes in a pair, halfway between orthogonal and equal shapes.
pub const LEAST_PAIR_LIKENESS: f64 = 0.5;
/// Cost for a flown mode without a partner: equals the cost of the worst admissible pair, so that a
/// pair never costs more than leaving its flown mode alone.
const UNPAIRED_COST: f64 = LARGEST_PAIR_DISTANCE + 1.0 - LEAST_PAIR_LIKENESS;
/// Cost for an inadmissible pair: exceeds the cost for leaving all modes unpaired.
const BARRED_COST: f64 = 1e9;

/// A model's counterpart to a flown mode.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct ModePair {
    /// Index among the model's modes.
    pub(super) mode: usize,
    /// `d + 1 - c`: 0 for equal poles and shapes, at most 1.
    pub(super) cost: f64,
}

/// Returns mode indices, each conjugate pair once (step 1).
pub(super) fn single_modes(modes: &[Mode]) -> Vec<usize> {
    (0..modes.len())
        .filter(|&index| modes[index].pole.im >= 0.0)
        .collect()
}

/// Returns a partner in `model` for each of the [`single_modes`] in `flown` (step 4); `None` if
/// unpaired. No mode is a partner twice. `omega_min` is in rad/s.
pub(super) fn mode_pairs(flown: &[Mode], model: &[Mode], omega_min: f64) -> Vec<Option<ModePair>> {
    let rows = single_modes(flown);
    let columns = single_modes(model);
    let scales = output_scales(flown, omega_min);
    // Each flown mode has an additional column, which leaves it unpaired.
    let assigned =
        cheapest_assignment(
            rows.len(),
            columns.len() + rows.len(),
            |row, column| match columns.get(column) {
                Some(&mode) => pair_cost(&flown[rows[row]], &model[mode], &scales, omega_min)
                    .unwrap_or(BARRED_COST),
                None => UNPAIRED_COST,
            },
        );
    let mut pairs = Vec::with_capacity(rows.len());
    for (row, column) in assigned.into_iter().enumerate() {
        let pair = columns.get(column).and_then(|&mode| {
            let cost = pair_cost(&flown[rows[row]], &model[mode], &scales, omega_min)?;
            Some(ModePair { mode, cost })
        });
        pairs.push(pair);
    }
    pairs
}

/// Returns `d + 1 - c` for two modes (step 3); `None` if they cannot be a pair.
fn pair_cost(flown: &Mode, model: &Mode, scales: &[f64], omega_min: f64) -> Option<f64> {
    let largest = flown
        .frequency_rad_s
        .max(model.frequency_rad_s)
        .max(omega_min);
    let distance = (flown.pole - model.pole).norm() / largest;
    // If a shape is unavailable, only the distance counts.
    let likeness = likeness(flown, model, scales).unwrap_or(LEAST_PAIR_LIKENESS);
    let is_pair = distance <= LARGEST_PAIR_DISTANCE && likeness >= LEAST_PAIR_LIKENESS;
    if is_pair {
        Some(distance + 1.0 - likeness)
    } else {
        None
    }
}

/// Step 2: returns `s_i` for each output, over all flown poles: both poles in a conjugate pair
/// count. Zero if no pole has a residue in the output.
fn output_scales(flown: &[Mode], omega_min: f64) -> Vec<f64> {
    let mut squares: Vec<f64> = Vec::new();
    for mode in flown {
        let residues = mode.residues.as_deref().unwrap_or_default();
        squares.resize(squares.len().max(residues.len()), 0.0);
        for (square, residue) in squares.iter_mut().zip(residues) {
            *square += (residue.norm() / mode.frequency_rad_s.max(omega_min)).powi(2);
        }
    }
    squares.into_iter().map(f64::sqrt).collect()
}

/// Returns `c` for two modes; `None` if a shape is unavailable, or no flown mode has a residue in
/// any output.
fn likeness(flown: &Mode, model: &Mode, scales: &[f64]) -> Option<f64> {
    let flown = mode_shape(flown)?;
    let model = mode_shape(model)?;
    let mut product = Complex::from(0.0);
    let mut flown_square = 0.0;
    let mut model_square = 0.0;
    let mut has_output = false;
    for ((flown, model), scale) in flown.iter().zip(model).zip(scales) {
        if *scale > 0.0 {
            let flown = flown / scale;
            let model = model / scale;
            product += flown.conj() * model;
            flown_square += flown.norm_sqr();
            model_square += model.norm_sqr();
            has_output = true;
        }
    }
    if !has_output {
        return None;
    }
    let likeness = product.norm_sqr() / (flown_square * model_square);
    // A mode that no input excites or no output observes has zero likeness to any other.
    Some(if likeness.is_finite() { likeness } else { 0.0 })
}

/// Returns a mode's residues by output, `r_i`.
fn mode_shape(mode: &Mode) -> Option<&[Complex<f64>]> {
    mode.residues.as_deref()
}

#[cfg(test)]
mod tests {
    use nalgebra::{DMatrix, dmatrix};

    use gdcm_model::dataset::StateSpace;
    use gdcm_model::response::modes;

    use super::*;

    /// Modes with poles `-rate`, with their output shapes by row.
    fn lags(rates: &[f64], shapes: &[[f64; 2]]) -> Vec<Mode> {
        let n = rates.len();
        let a = DMatrix::from_diagonal(&nalgebra::DVector::from_iterator(
            n,
            rates.iter().map(|rate| -rate),
        ));
        let c = DMatrix::from_fn(2, n, |output, state| shapes[state][output]);
        modes(
            &StateSpace::new(a, DMatrix::from_element(n, 1, 1.0), c, DMatrix::zeros(2, 1)).unwrap(),
        )
        .unwrap()
    }

    /// A conjugate mode pair, observed by two outputs.
    fn oscillation(re: f64, im: f64) -> Vec<Mode> {
        let model = StateSpace::new(
            dmatrix![re, im; -im, re],
            dmatrix![1.0; 0.0],
            dmatrix![1.0, 0.0; 0.0, 1.0],
            DMatrix::zeros(2, 1),
        );
        modes(&model.unwrap()).unwrap()
    }

    fn partners(flown: &[Mode], model: &[Mode]) -> Vec<Option<usize>> {
        mode_pairs(flown, model, 0.5)
            .into_iter()
            .map(|pair| pair.map(|pair| pair.mode))
            .collect()
    }

    #[test]
    fn among_equally_near_modes_the_partner_has_the_same_shape() {
        let roll = [1.0, 0.0];
        let pitch = [0.0, 1.0];
        let flown = lags(&[2.0, 3.0], &[pitch, roll]);
        // By distance alone the first flown mode would be paired with the first mode of the model.
        assert_eq!(
            partners(&flown, &lags(&[2.1, 2.9], &[roll, pitch])),
            [Some(1), Some(0)]
        );
        assert_eq!(
            partners(&flown, &lags(&[2.1, 2.9], &[pitch, roll])),
            [Some(0), Some(1)]
        );
    }

    #[test]
    fn units_of_the_outputs_do_not_matter() {
        let roll = [1.0, 0.2];
        let pitch = [0.1, 1.0];
        let [flown, model] = [[2.0, 3.0], [2.4, 2.6]];
        let before = mode_pairs(
            &lags(&flown, &[roll, pitch]),
            &lags(&model, &[pitch, roll]),
            0.5,
        );
        let [roll, pitch] = [roll, pitch].map(|shape| [shape[0], 1e-3 * shape[1]]);
        let after = mode_pairs(
            &lags(&flown, &[roll, pitch]),
            &lags(&model, &[pitch, roll]),
            0.5,
        );
        assert_eq!(before.iter().flatten().count(), 2);
        for (before, after) in before.iter().flatten().zip(after.iter().flatten()) {
            assert!(
                before.mode == after.mode && (before.cost - after.cost).abs() < 1e-12,
                "{before:?} {after:?}"
            );
        }
    }

    #[test]
    fn a_mode_farther_than_half_the_larger_modulus_is_unpaired() {
        let shape = [[1.0, 0.5]];
        assert_eq!(
            partners(&lags(&[2.8], &shape), &lags(&[0.28], &shape)),
            [None]
        );
        assert_eq!(
            partners(&lags(&[2.0], &shape), &lags(&[1.01], &shape)),
            [Some(0)]
        );
        assert_eq!(
            partners(&lags(&[2.0], &shape), &lags(&[0.99], &shape)),
            [None]
        );
        // Below the band, distances are relative to its lower end, 0.5 rad/s.
        assert_eq!(
            partners(&lags(&[0.2], &shape), &lags(&[0.01], &shape)),
            [Some(0)]
        );
    }

    #[test]
    fn a_conjugate_pair_is_partner_only_once() {
        let shape = [1.0, 1.0];
        let found = partners(
            &lags(&[0.26, 0.3], &[shape, shape]),
            &oscillation(-0.28, 0.05),
        );
        assert_eq!(found.iter().flatten().count(), 1, "{found:?}");
        assert_eq!(
            partners(&oscillation(-1.0, 2.0), &oscillation(-1.1, 2.1)),
            [Some(0)]
        );
    }

    #[test]
    fn a_mode_that_no_input_moves_is_no_partner() {
        let flown = lags(&[2.0], &[[1.0, 0.0]]);
        assert_eq!(
            partners(&flown, &lags(&[2.0, 2.6], &[[0.0, 0.0], [1.0, 0.0]])),
            [Some(1)]
        );
    }
}
