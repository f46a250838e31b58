//! Models with a matrix E in front of the derivatives.

use nalgebra::DMatrix;

use gdcm_core::units::number;

/// Condition of E from which `E^-1` has lost most digits.
const WORST_CONDITION: f64 = 1e12;

/// `E^-1 A` and `E^-1 B` of `E x' = A x + B u` (M2a).
pub(super) fn solved(
    e: DMatrix<f64>,
    a: DMatrix<f64>,
    b: DMatrix<f64>,
) -> Result<(DMatrix<f64>, DMatrix<f64>), String> {
    let n = a.nrows();
    if e.shape() != (n, n) {
        return Err(format!("E: expected {n} x {n} as A, found {} x {}", e.nrows(), e.ncols()));
    }
    if e == DMatrix::identity(n, n) {
        return Ok((a, b));
    }
    let singular = e.singular_values();
    let (most, least) = (singular.max(), singular.min());
    if least <= 0.0 || most / least > WORST_CONDITION {
        let condition = if least > 0.0 { number(most / least) } else { "infinite".to_owned() };
        return Err(format!(
            "E is singular (condition {condition}): the model has no state-space form; export it without E"
        ));
    }
    let factored = e.lu();
    match (factored.solve(&a), factored.solve(&b)) {
        (Some(a), Some(b)) => Ok((a, b)),
        _ => Err("E is singular: the model has no state-space form; export it without E".to_owned()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_regular_e_is_solved_and_a_singular_one_refused() {
        let matrix = |values: [f64; 4]| DMatrix::from_row_slice(2, 2, &values);
        let b = DMatrix::from_row_slice(2, 1, &[2.0, 4.0]);
        let (a, b) = solved(matrix([2.0, 0.0, 0.0, 4.0]), matrix([2.0, 4.0, 4.0, 8.0]), b).unwrap();
        assert_eq!((a, b), (matrix([1.0, 2.0, 1.0, 2.0]), DMatrix::from_row_slice(2, 1, &[1.0, 1.0])));
        let b = DMatrix::from_row_slice(2, 1, &[2.0, 4.0]);
        assert!(solved(matrix([1.0, 1.0, 1.0, 1.0]), matrix([1.0; 4]), b).unwrap_err().contains("singular"));
    }
}
