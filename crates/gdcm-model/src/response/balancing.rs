//! Balances a model: a diagonal similarity makes it independent of state units.

use nalgebra::DMatrix;

/// Balances A: for each state k, row k and column k then differ in norm by at most about a factor
/// of two, unless one is zero. The diagonal similarity `S` contains only powers of two, so that
/// nothing is rounded: `a <- S^-1 a S`, `b <- S^-1 b`, `c <- c S`.
pub(super) fn balance(a: &mut DMatrix<f64>, b: &mut DMatrix<f64>, c: &mut DMatrix<f64>) {
    let scales = balance_square(a);
    for (state, &scale) in scales.iter().enumerate() {
        b.row_mut(state).scale_mut(1.0 / scale);
        c.column_mut(state).scale_mut(scale);
    }
}

/// Balances A, `a <- S^-1 a S`, and returns the diagonal of `S`: powers of two.
///
/// Parlett and Reinsch's balancing with 2-norms (James, Langou & Lowery, arXiv:1401.5766, algorithm
/// 3). The sweep count is limited (the model remains similar after each sweep), and so is the
/// scale, to prevent overflow in B and C; both limits take effect only for entries far beyond any
/// aircraft's.
pub fn balance_square(a: &mut DMatrix<f64>) -> Vec<f64> {
    /// Maximum number of sweeps; a helicopter model needs three to six.
    const MOST_SWEEPS: usize = 100;
    /// Maximum scale, about 1e30 in either direction.
    const LARGEST_SCALE: f64 = (1_u128 << 100) as f64;
    let mut scales = vec![1.0; a.nrows()];
    for _ in 0..MOST_SWEEPS {
        let mut balanced = true;
        for (state, scale) in scales.iter_mut().enumerate() {
            let Some(factor) = balancing_factor(a, state) else {
                continue;
            };
            if (LARGEST_SCALE.recip()..=LARGEST_SCALE).contains(&(*scale * factor)) {
                balanced = false;
                *scale *= factor;
                a.column_mut(state).scale_mut(factor);
                a.row_mut(state).unscale_mut(factor);
            }
        }
        if balanced {
            break;
        }
    }
    scales
}

/// Returns the power of two that makes a column's norm and its row's norm most nearly equal; `None`
/// if it reduces the sum of their squares by at most 5 %, or if either is zero.
fn balancing_factor(a: &DMatrix<f64>, state: usize) -> Option<f64> {
    /// Ratio of the new to the old sum of squares below which the factor is worth a further sweep.
    const WORTHWHILE: f64 = 0.95;
    let column_square = a.column(state).norm_squared();
    let row_square = a.row(state).norm_squared();
    let mut column_norm = column_square.sqrt();
    let mut row_norm = row_square.sqrt();
    if column_norm == 0.0 || row_norm == 0.0 {
        return None;
    }
    let mut factor = 1.0;
    while column_norm < row_norm / 2.0 {
        column_norm *= 2.0;
        row_norm /= 2.0;
        factor *= 2.0;
    }
    while column_norm >= row_norm * 2.0 {
        column_norm /= 2.0;
        row_norm *= 2.0;
        factor /= 2.0;
    }
    let balanced_squares = column_norm * column_norm + row_norm * row_norm;
    if balanced_squares < WORTHWHILE * (column_square + row_square) {
        Some(factor)
    } else {
        None
    }
}

#[cfg(test)]
mod tests {
    use nalgebra::dmatrix;
    use nalgebra::linalg::balancing::balance_parlett_reinsch;

    use super::*;

    #[test]
    fn it_gives_the_bits_of_the_textbook_where_no_limit_is_met() {
        let a = DMatrix::from_fn(7, 7, |row, column| {
            (1.0 + 7.3 * row as f64 + 2.9 * column as f64).sin() * 10_f64.powi(3 * row as i32)
        });
        let mut ours = a.clone();
        let mut theirs = a;
        let mut b = DMatrix::from_element(7, 1, 1.0);
        let mut c = DMatrix::from_element(1, 7, 1.0);
        balance(&mut ours, &mut b, &mut c);
        let scales = balance_parlett_reinsch(&mut theirs);
        assert_eq!(ours, theirs);
        assert!(
            c.iter().eq(scales.iter()) && b.iter().zip(&scales).all(|(b, scale)| b * scale == 1.0)
        );
    }

    #[test]
    fn a_chain_of_couplings_of_1e_minus_60_does_not_carry_the_scales_away() {
        let mut a = DMatrix::from_fn(60, 60, |row, column| match column as i32 - row as i32 {
            1 => 1e-60,
            -1 => 1.0,
            _ => 0.0,
        });
        let mut b = DMatrix::from_element(60, 1, 1.0);
        let mut c = DMatrix::from_element(1, 60, 1.0);
        balance(&mut a, &mut b, &mut c);
        assert!(
            b.iter()
                .chain(c.iter())
                .all(|entry| (1e-31..=1e31).contains(entry))
        );
    }

    #[test]
    fn a_state_that_nothing_leads_to_is_left_as_it_is() {
        let mut a = dmatrix![-1.0, 0.0; 1e9, 0.0];
        let mut b = dmatrix![1.0; 1.0];
        let mut c = dmatrix![1.0, 1.0];
        balance(&mut a, &mut b, &mut c);
        assert!(a[(1, 0)] != 0.0 && b[1] == 1.0, "the second column is zero");
    }
}
