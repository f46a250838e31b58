//! Models shared by several benches, and a plain method for their responses.

use nalgebra::{Complex, DMatrix};

use gdcm_model::dataset::StateSpace;

/// Number of outputs of the random models.
pub const OUTPUTS: usize = 6;
/// Number of inputs of the random models.
pub const INPUTS: usize = 4;

/// Returns a stable model without structure: a random matrix whose eigenvalues fill a disc of
/// radius 8 rad/s about -9 rad/s.
pub fn model(order: usize) -> StateSpace {
    let mut state = 88_172_645_463_325_252_u64;
    let mut uniform = || {
        state ^= state << 13;
        state ^= state >> 7;
        state ^= state << 17;
        (state >> 11) as f64 / (1_u64 << 53) as f64 * 2.0 - 1.0
    };
    // The sum of three uniform numbers in (-1, 1) has variance 1.
    let mut matrix =
        |rows, columns| DMatrix::from_fn(rows, columns, |_, _| uniform() + uniform() + uniform());
    let a = matrix(order, order) * (8.0 / (order as f64).sqrt())
        - DMatrix::identity(order, order) * 9.0;
    let b = matrix(order, INPUTS);
    let c = matrix(OUTPUTS, order);
    let d = matrix(OUTPUTS, INPUTS);
    StateSpace::new(a, b, c, d).expect("the shapes agree")
}

/// Computes the responses by a plain method: a dense complex LU decomposition at each frequency.
pub fn dense_responses(model: &StateSpace, omega: &[f64]) -> Vec<DMatrix<Complex<f64>>> {
    let [a, b, c, d] =
        [model.a(), model.b(), model.c(), model.d()].map(|matrix| matrix.map(Complex::from));
    let identity = DMatrix::<Complex<f64>>::identity(a.nrows(), a.nrows());
    let at = |omega: &f64| {
        let states = (&identity * Complex::new(0.0, *omega) - &a).lu().solve(&b);
        &c * states.expect("no pole on the imaginary axis") + &d
    };
    omega.iter().map(at).collect()
}
