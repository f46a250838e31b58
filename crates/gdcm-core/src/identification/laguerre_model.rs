//! The law that Laguerre projections obey, and the model in continuous time behind it.

use super::StateSpaceMatrices;
use nalgebra::DMatrix;

/// `xi_{k+1} = Ao xi_k + Bo u~_k + Ko e~_k`, `y~_k = Co xi_k + Do u~_k + e~_k` for the projections k = 0, 1, ... with the pole `a`.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct LaguerreModel {
    /// `a` \[rad/s\].
    pub(super) pole: f64,
    /// `Ao`, `Bo`, `Co`, `Do` \[-\].
    pub(super) matrices: StateSpaceMatrices,
}

impl LaguerreModel {
    /// The model in continuous time; none where `Ao` has the eigenvalue -1.
    ///
    /// ```text
    /// M = (Ao + I)^-1,   A = a M (Ao - I),   B = sqrt(2a) M Bo,   C = sqrt(2a) Co M,   D = Do - Co M Bo
    /// ```
    pub(super) fn continuous(&self) -> Option<StateSpaceMatrices> {
        let StateSpaceMatrices { a, b, c, d } = &self.matrices;
        let identity = DMatrix::identity(a.nrows(), a.nrows());
        let m = (a + &identity).try_inverse()?;
        let (mb, cm) = (&m * b, c * &m);
        let root = (2.0 * self.pole).sqrt();
        let model =
            StateSpaceMatrices { a: &m * (a - &identity) * self.pole, b: &mb * root, c: cm * root, d: d - c * mb };
        model.is_finite().then_some(model)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::identification::known_answers::{answers, matrix, number};

    #[test]
    fn the_continuous_model_is_that_of_independent_code() {
        let known = &answers()["laguerre_to_ct"];
        let of = |name: &str| matrix(&known[name]);
        let matrices = StateSpaceMatrices { a: of("Ao"), b: of("Bo"), c: of("Co"), d: of("Do") };
        let model = LaguerreModel { pole: number(&known["a"]), matrices }.continuous().unwrap();
        for (found, name) in [(&model.a, "A"), (&model.b, "B"), (&model.c, "C"), (&model.d, "D")] {
            // Independent numpy code; the tolerance stands in its file.
            assert!((found - of(name)).amax() < 1e-12, "{name}");
        }
    }

    #[test]
    fn an_eigenvalue_of_minus_one_has_no_continuous_model() {
        let one = DMatrix::from_element(1, 1, 1.0);
        let matrices = StateSpaceMatrices { a: -&one, b: one.clone(), c: one.clone(), d: one };
        assert_eq!(LaguerreModel { pole: 2.0, matrices }.continuous(), None);
    }
}
