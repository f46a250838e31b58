//! Removes modes far above the band, but keeps their static gain: such modes are images of the
//! Laguerre filters, whose poles are within the band (M14.3).
//!
//! ```text
//! (A, B, C, D) the model; a mode is fast if its eigenvalue has a modulus above the limit
//! without fast modes the model is returned as it is
//! 1  Q = [Q1 Q2] orthonormal, Q1 spans the slow modes:   Q' A Q = [A1 A12; 0 A2]
//! 2  A1 X - X A2 = -A12:  the states x1 - X x2 and x2 are decoupled
//! 3  B1 = Q1' B - X Q2' B,  B2 = Q2' B,   C1 = C Q1,  C2 = C (Q1 X + Q2)
//! 4  slow part (A1, B1, C1),   D - C2 A2^-1 B2: the fast part at omega = 0
//! ```

use nalgebra::{Complex, DMatrix, DVector, Dyn, SymmetricEigen};

use gdcm_model::dataset::StateSpace;
use gdcm_model::response::schur_form::SchurForm;

/// Removes the modes with `|lambda| > limit` \[rad/s\], eight times the upper end of the band; the
/// response at omega = 0 does not change.
///
/// Returns `None` if an iteration does not converge, if fast and slow modes cannot be separated, or
/// if no mode is slow.
pub(crate) fn without_fast_modes(model: &StateSpace, limit: f64) -> Option<StateSpace> {
    let a = model.a();
    let b = model.b();
    let c = model.c();
    let order = model.order();
    let mut schur = SchurForm::new(a)?;
    let slow = schur.order_by(|eigenvalue| eigenvalue.norm() <= limit);
    if slow == order {
        return Some(model.clone());
    }
    if slow == 0 {
        return None;
    }
    // Step 1.
    let basis = real_basis(&schur.q, slow);
    let q1 = basis.columns(0, slow);
    let q2 = basis.columns(slow, order - slow);
    let a1 = q1.transpose() * a * q1;
    let a2 = q2.transpose() * a * q2;
    // Step 2.
    let x = solve_sylvester(&a1, &a2, &(q1.transpose() * a * q2))?;
    // Steps 3 and 4.
    let b2 = q2.transpose() * b;
    let c2 = c * (q1 * &x + q2);
    let b1 = q1.transpose() * b - &x * &b2;
    StateSpace::new(a1, b1, c * q1, model.d() - c2 * a2.lu().solve(&b2)?).ok()
}

/// Returns a real orthonormal basis whose first `count` columns span the same space as the first
/// `count` columns of `q`. Among these, complex vectors come only with their conjugates.
fn real_basis(q: &DMatrix<Complex<f64>>, count: usize) -> DMatrix<f64> {
    let order = q.nrows();
    // The projector on the span is real, with the eigenvalues 1 and 0.
    let leading = q.columns(0, count);
    let projector = DMatrix::from_fn(order, order, |row, column| {
        leading
            .row(row)
            .iter()
            .zip(leading.row(column).iter())
            .map(|(x, y)| (x * y.conj()).re)
            .sum()
    });
    let eigen = SymmetricEigen::<f64, Dyn>::new(projector);
    let mut by_size: Vec<usize> = (0..order).collect();
    by_size.sort_by(|&i, &j| eigen.eigenvalues[j].total_cmp(&eigen.eigenvalues[i]));
    eigen.eigenvectors.select_columns(&by_size)
}

/// Solves `A1 X - X A2 = -A12` for `X`; `None` if `A1` and `A2` share an eigenvalue.
fn solve_sylvester(
    a1: &DMatrix<f64>,
    a2: &DMatrix<f64>,
    a12: &DMatrix<f64>,
) -> Option<DMatrix<f64>> {
    let (rows, columns) = a12.shape();
    let left = DMatrix::<f64>::identity(columns, columns).kronecker(a1);
    let right = a2
        .transpose()
        .kronecker(&DMatrix::<f64>::identity(rows, rows));
    let stacked = DVector::from_column_slice((-a12).as_slice());
    let x = (left - right).lu().solve(&stacked)?;
    Some(DMatrix::from_column_slice(rows, columns, x.as_slice()))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::identification::known_answers_tests::{
        answers, matrix, number, numbers, response, response_at,
    };

    fn known_model(known: &serde_json::Value) -> StateSpace {
        let [a, b, c, d] = ["A", "B", "C", "D"].map(|name| matrix(&known[name]));
        StateSpace::new(a, b, c, d).unwrap()
    }

    fn sample(size: usize) -> DMatrix<f64> {
        DMatrix::from_fn(size, size, |row, column| {
            ((1.0 + 7.3 * row as f64) * (1.0 + 2.9 * column as f64)).sin()
        })
    }

    #[test]
    fn a_model_of_fast_modes_alone_has_no_slow_part() {
        let [fast, slow] = [-100.0, -10.0].map(|pole| {
            let a = DMatrix::identity(2, 2) * pole;
            StateSpace::new(a, sample(2), sample(2), sample(2)).unwrap()
        });
        assert!(without_fast_modes(&fast, 50.0).is_none());
        assert_eq!(without_fast_modes(&slow, 50.0).unwrap().order(), 2);
    }

    #[test]
    fn the_form_still_gives_the_matrix_after_its_reordering() {
        let a = sample(9);
        let mut form = SchurForm::new(&a).unwrap();
        let before: Vec<_> = form.t.diagonal().iter().copied().collect();
        let count = form.order_by(|eigenvalue| eigenvalue.re > 0.0);
        assert_eq!(
            count,
            before
                .iter()
                .filter(|eigenvalue| eigenvalue.re > 0.0)
                .count()
        );
        assert!((0..9).all(|at| (form.t[(at, at)].re > 0.0) == (at < count)));
        // 1e-13: a few dozen rotations, each of them backward stable.
        assert!(
            (&form.q * &form.t * form.q.adjoint() - a.map(Complex::from)).norm() < 1e-13 * a.norm()
        );
    }

    #[test]
    fn the_slow_part_matches_independent_code() {
        let known = &answers()["drop_fast"];
        let model = known_model(known);
        let slow = without_fast_modes(&model, number(&known["wmax"])).unwrap();
        assert_eq!(slow.order() as f64, number(&known["order"]));
        for (omega, expected) in numbers(&known["w"]).into_iter().zip(response(&known["H"])) {
            // Expected values from independent numpy code; their file states the tolerance.
            assert!((response_at(&slow, omega) - expected).camax() < 1e-9);
        }
    }

    #[test]
    fn a_model_without_fast_modes_stays_as_it_is() {
        let known = &answers()["drop_fast"];
        let model = known_model(known);
        assert_eq!(without_fast_modes(&model, 1000.0).unwrap(), model);
    }
}
