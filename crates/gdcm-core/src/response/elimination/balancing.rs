//! Units of the states that make a model's rows and columns alike.

use nalgebra::DMatrix;

/// Brings row k and column k of `a`, for each state k, to norms within a factor of two of each other, by a diagonal similarity
/// of powers of two, so that nothing is rounded: `a <- S^-1 a S`, `b <- S^-1 b`, `c <- c S`.
///
/// Balancing of Parlett and Reinsch with 2-norms (James, Langou & Lowery, arXiv:1401.5766, algorithm 3). Entries far beyond
/// those of any machine in use can neither keep it busy (it ends after so many sweeps over the states, each of which leaves a
/// similar model) nor carry a scale to where B or C would overflow.
pub fn balance(a: &mut DMatrix<f64>, b: &mut DMatrix<f64>, c: &mut DMatrix<f64>) {
    /// A helicopter's model takes three to six.
    const MOST_SWEEPS: usize = 100;
    /// 30 decades to either side.
    const LARGEST_SCALE: f64 = (1_u128 << 100) as f64;
    let mut scales = vec![1.0; a.nrows()];
    for _ in 0..MOST_SWEEPS {
        let mut balanced = true;
        for (state, scale) in scales.iter_mut().enumerate() {
            let Some(factor) = factor(a, state) else { continue };
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
    for (state, &scale) in scales.iter().enumerate() {
        b.row_mut(state).scale_mut(1.0 / scale);
        c.column_mut(state).scale_mut(scale);
    }
}

/// The power of two that brings a column and its row closest together; `None` where that gains less than 5 % of their squares.
fn factor(a: &DMatrix<f64>, state: usize) -> Option<f64> {
    let (column, row) = (a.column(state).norm_squared(), a.row(state).norm_squared());
    let whole = column + row;
    let (mut column, mut row, mut factor) = (column.sqrt(), row.sqrt(), 1.0);
    if column == 0.0 || row == 0.0 {
        return None;
    }
    while column < row / 2.0 {
        (column, row, factor) = (column * 2.0, row / 2.0, factor * 2.0);
    }
    while column >= row * 2.0 {
        (column, row, factor) = (column / 2.0, row * 2.0, factor / 2.0);
    }
    (column * column + row * row < 0.95 * whole).then_some(factor)
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::{dmatrix, linalg::balancing::balance_parlett_reinsch};

    #[test]
    fn it_gives_the_bits_of_the_textbook_where_no_limit_is_met() {
        let a = DMatrix::from_fn(7, 7, |row, column| {
            (1.0 + 7.3 * row as f64 + 2.9 * column as f64).sin() * 10_f64.powi(3 * row as i32)
        });
        let (mut ours, mut theirs) = (a.clone(), a);
        let (mut b, mut c) = (DMatrix::from_element(7, 1, 1.0), DMatrix::from_element(1, 7, 1.0));
        balance(&mut ours, &mut b, &mut c);
        let scales = balance_parlett_reinsch(&mut theirs);
        assert_eq!(ours, theirs);
        assert!(c.iter().eq(scales.iter()) && b.iter().zip(&scales).all(|(b, scale)| b * scale == 1.0));
    }

    #[test]
    fn a_chain_of_couplings_of_1e_minus_60_does_not_carry_the_scales_away() {
        let mut a = DMatrix::from_fn(60, 60, |row, column| match column as i32 - row as i32 {
            1 => 1e-60,
            -1 => 1.0,
            _ => 0.0,
        });
        let (mut b, mut c) = (DMatrix::from_element(60, 1, 1.0), DMatrix::from_element(1, 60, 1.0));
        balance(&mut a, &mut b, &mut c);
        assert!(b.iter().chain(c.iter()).all(|entry| (1e-31..=1e31).contains(entry)));
    }

    #[test]
    fn a_state_that_nothing_leads_to_is_left_as_it_is() {
        let (mut a, mut b, mut c) = (dmatrix![-1.0, 0.0; 1e9, 0.0], dmatrix![1.0; 1.0], dmatrix![1.0, 1.0]);
        balance(&mut a, &mut b, &mut c);
        assert!(a[(1, 0)] != 0.0 && b[1] == 1.0, "the second column is zero");
    }
}
