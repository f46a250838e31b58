//! Balances coordinates over the lines used, and removes states in them (M14.19).
//!
//! ```text
//! Wc = Re sum X X^H,         X = (j omega - A)^-1 B U
//! Wo = Re sum (W C R)^H W C R,   R = (j omega - A)^-1
//! U inputs at the lines, W whitening weights (`cost`);  sums over all lines of all segments
//! 1  Wc = L L',  Wo = M M', each with 1e-14 of its mean added to the diagonal
//! 2  M' L = Q S V',  S descending, at least 1e-9 of its largest value
//! 3  T = L V S^(-1/2),  T^-1 = S^(1/2) V' L^-1:   T^-1 Wc T^-T = T' Wo T = S
//! ```
//!
//! B. C. Moore, "Principal component analysis in linear systems: controllability, observability,
//! and model reduction", IEEE Trans. Automat. Contr. 26, 1981, with sums over the measured lines
//! instead of integrals.

use nalgebra::{DMatrix, DVector};

use gdcm_model::executor::each;

use super::cost::Likelihood;
use super::frequency_table::OutputResolvents;
use super::schur_model::SchurModel;
use super::spectral_lines::{SpectralLines, whiten};

/// Share of its mean that is added to a Gramian's diagonal, so that a state that the lines do not
/// excite or show remains in the model.
const FLOOR: f64 = 1e-14;

/// Minimum singular value relative to the largest: a state below it is scaled as if it had this
/// value, so that the transformation remains well-conditioned.
const LEAST_SINGULAR: f64 = 1e-9;

/// Gramians sampled at the lines.
#[derive(Clone, Debug)]
pub(crate) struct Gramians {
    /// `Wc`, n x n.
    pub(crate) controllability: DMatrix<f64>,
    /// `Wo`, n x n.
    pub(crate) observability: DMatrix<f64>,
}

impl Gramians {
    /// Sums the Gramians over all lines in all segments.
    pub(crate) fn sampled(likelihood: &Likelihood, model: &SchurModel) -> Self {
        let resolvents = likelihood.resolvents(model);
        let of_segments = each(likelihood.executor, &likelihood.segments, |lines| {
            Self::of_segment(lines, model, &resolvents)
        });
        let mut sums = Self::zeros(model.order());
        for gramians in of_segments {
            sums.controllability += gramians.controllability;
            sums.observability += gramians.observability;
        }
        sums
    }

    fn zeros(order: usize) -> Self {
        Self {
            controllability: DMatrix::zeros(order, order),
            observability: DMatrix::zeros(order, order),
        }
    }

    fn of_segment(
        lines: &SpectralLines,
        model: &SchurModel,
        resolvents: &OutputResolvents,
    ) -> Self {
        let order = model.order();
        let outputs = model.c().nrows();
        let count = lines.omega.len();
        // Real and imaginary parts side by side; the sums are then real products.
        let mut states = DMatrix::zeros(order, 2 * count);
        let mut weighted_outputs = DMatrix::zeros(2 * outputs * count, order);
        let at_lines = model.states(&lines.omega, &lines.inputs, &DVector::zeros(order));
        for (k, cr) in resolvents.at_lines(&lines.omega).into_iter().enumerate() {
            for (state, value) in at_lines.column(k).iter().enumerate() {
                states[(state, 2 * k)] = value.re;
                states[(state, 2 * k + 1)] = value.im;
            }
            for (state, column) in cr.chunks_exact(outputs).enumerate() {
                whiten(&lines.weights[k], column, |o, value| {
                    let row = 2 * (k * outputs + o);
                    weighted_outputs[(row, state)] = value.re;
                    weighted_outputs[(row + 1, state)] = value.im;
                });
            }
        }
        Self {
            controllability: &states * states.transpose(),
            observability: weighted_outputs.transpose() * &weighted_outputs,
        }
    }
}

/// A coordinate change `x = T z`.
pub(crate) struct Coordinates {
    /// `T`, n x n.
    pub(crate) transformation: DMatrix<f64>,
    /// `T^-1`, n x n.
    pub(crate) inverse: DMatrix<f64>,
}

/// Returns the coordinates in which both Gramians are equal and diagonal (steps 1 to 3); `None` if
/// a Gramian is not positive definite, or the iteration for the singular values does not converge.
pub(crate) fn balancing_coordinates(gramians: &Gramians) -> Option<Coordinates> {
    // Step 1: L and M.
    let controllability_factor = with_floor(gramians.controllability.clone())
        .cholesky()?
        .unpack();
    let observability_factor = with_floor(gramians.observability.clone())
        .cholesky()?
        .unpack();
    // Step 2.
    let decomposition = (observability_factor.transpose() * &controllability_factor).try_svd(
        false,
        true,
        f64::EPSILON,
        10_000,
    )?;
    let directions = decomposition.v_t?;
    let largest = decomposition.singular_values.max();
    let roots = decomposition
        .singular_values
        .map(|value| value.max(LEAST_SINGULAR * largest).sqrt());
    // Step 3.
    let mut transformation = &controllability_factor * directions.transpose();
    for (mut column, root) in transformation.column_iter_mut().zip(roots.iter()) {
        column.unscale_mut(*root);
    }
    let mut inverse = directions * controllability_factor.try_inverse()?;
    for (mut row, root) in inverse.row_iter_mut().zip(roots.iter()) {
        row.scale_mut(*root);
    }
    Some(Coordinates {
        transformation,
        inverse,
    })
}

/// Adds [`FLOOR`] times the diagonal's mean to the diagonal.
fn with_floor(mut gramian: DMatrix<f64>) -> DMatrix<f64> {
    let order = gramian.nrows();
    let added = FLOOR * gramian.trace() / order as f64 + f64::MIN_POSITIVE;
    for state in 0..order {
        gramian[(state, state)] += added;
    }
    gramian
}

/// Removes the last `count` states from a balanced model and returns two models: without and with
/// their static part.
///
/// ```text
/// A = [A11 A12; A21 A22]
/// without: (A11, B1, C1, D)
/// with:    (A11 - A12 A22^-1 A21, B1 - A12 A22^-1 B2, C1 - C2 A22^-1 A21, D - C2 A22^-1 B2)
/// ```
///
/// Only the first if A22 is singular; none if no state would remain.
pub(crate) fn without_last_states(model: &SchurModel, count: usize) -> Vec<SchurModel> {
    let order = model.order();
    if count >= order {
        return Vec::new();
    }
    let kept = order - count;
    let a = model.a();
    let a11 = a.view((0, 0), (kept, kept));
    let b1 = model.b().rows(0, kept);
    let c1 = model.c().columns(0, kept);
    let mut remaining: Vec<SchurModel> = SchurModel::new(
        a11.into_owned(),
        b1.into_owned(),
        c1.into_owned(),
        model.d().clone(),
    )
    .into_iter()
    .collect();
    if let Some(inverse) = a
        .view((kept, kept), (count, count))
        .into_owned()
        .try_inverse()
    {
        let a12_inverse = a.view((0, kept), (kept, count)) * &inverse;
        let c2_inverse = model.c().columns(kept, count) * inverse;
        let a21 = a.view((kept, 0), (count, kept));
        let b2 = model.b().rows(kept, count);
        remaining.extend(SchurModel::new(
            a11 - &a12_inverse * a21,
            b1 - a12_inverse * b2,
            c1 - &c2_inverse * a21,
            model.d() - c2_inverse * b2,
        ));
    }
    remaining
}
