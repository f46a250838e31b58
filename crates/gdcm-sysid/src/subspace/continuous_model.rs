//! Converts a model of the Laguerre projections to continuous time (M14.3).

use nalgebra::DMatrix;

use gdcm_model::dataset::StateSpace;

/// Converts `law`, a discrete model `Ao`, `Bo`, `Co`, `Do` of the Laguerre projections with the
/// pole `pole` \[rad/s\], to continuous time; `None` if `Ao + I` is singular or a matrix is not
/// finite.
///
/// ```text
/// xi_{k+1} = Ao xi_k + Bo u~_k + Ko e~_k,   y~_k = Co xi_k + Do u~_k + e~_k,   k = 0, 1, ...
///     xi_k states, u~_k, y~_k projections k of inputs and outputs, e~_k innovations
/// M = (Ao + I)^-1
/// A = pole M (Ao - I),   B = sqrt(2 pole) M Bo,   C = sqrt(2 pole) Co M,   D = Do - Co M Bo
/// ```
pub(crate) fn continuous(pole: f64, law: &StateSpace) -> Option<StateSpace> {
    let ao = law.a();
    let bo = law.b();
    let co = law.c();
    let do_ = law.d();
    let identity = DMatrix::identity(ao.nrows(), ao.nrows());
    let m = (ao + &identity).try_inverse()?;
    let mb = &m * bo;
    let cm = co * &m;
    let root = (2.0 * pole).sqrt();
    StateSpace::new(
        &m * (ao - &identity) * pole,
        &mb * root,
        cm * root,
        do_ - co * mb,
    )
    .ok()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::identification::known_answers_tests::{answers, matrix, number};

    #[test]
    fn the_continuous_model_is_that_of_independent_code() {
        let known = &answers()["laguerre_to_ct"];
        let [a, b, c, d] = ["Ao", "Bo", "Co", "Do"].map(|name| matrix(&known[name]));
        let matrices = StateSpace::new(a, b, c, d).unwrap();
        let model = continuous(number(&known["a"]), &matrices).unwrap();
        for (found, name) in [
            (model.a(), "A"),
            (model.b(), "B"),
            (model.c(), "C"),
            (model.d(), "D"),
        ] {
            // Expected values from independent numpy code; their file states the tolerance.
            assert!((found - matrix(&known[name])).amax() < 1e-12, "{name}");
        }
    }

    #[test]
    fn an_eigenvalue_of_minus_one_has_no_continuous_model() {
        let one = DMatrix::from_element(1, 1, 1.0);
        let matrices = StateSpace::new(-&one, one.clone(), one.clone(), one).unwrap();
        assert_eq!(continuous(2.0, &matrices), None);
    }
}
