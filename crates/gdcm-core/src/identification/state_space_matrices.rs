//! Four matrices of a model in continuous time.

use nalgebra::{Complex, DMatrix};

/// `dx/dt = A x + B u`, `y = C x + D u`.
#[derive(Clone, Debug, PartialEq)]
pub struct StateSpaceMatrices {
    /// `A`, n x n.
    pub a: DMatrix<f64>,
    /// `B`, n x inputs.
    pub b: DMatrix<f64>,
    /// `C`, outputs x n.
    pub c: DMatrix<f64>,
    /// `D`, outputs x inputs.
    pub d: DMatrix<f64>,
}

impl StateSpaceMatrices {
    /// Number of states n.
    #[must_use]
    pub fn order(&self) -> usize {
        self.a.nrows()
    }

    /// `C (j omega - A)^-1 B + D`, outputs x inputs; none where `j omega` is a pole.
    #[must_use]
    pub fn response(&self, omega: f64) -> Option<DMatrix<Complex<f64>>> {
        let order = self.order();
        let shifted = DMatrix::from_fn(order, order, |row, column| {
            Complex::new(-self.a[(row, column)], if row == column { omega } else { 0.0 })
        });
        let states = shifted.lu().solve(&self.b.map(Complex::from))?;
        let response = self.c.map(Complex::from) * states + self.d.map(Complex::from);
        response.iter().all(|value| value.re.is_finite() && value.im.is_finite()).then_some(response)
    }

    /// The poles, as the Schur iteration gives them; none where it does not end.
    #[must_use]
    pub fn poles(&self) -> Option<Vec<Complex<f64>>> {
        let schur = nalgebra::Schur::try_new(self.a.clone(), f64::EPSILON, 100 * (self.order() + 1))?;
        Some(schur.complex_eigenvalues().iter().copied().collect())
    }

    /// Whether every entry is finite.
    #[must_use]
    pub fn is_finite(&self) -> bool {
        [&self.a, &self.b, &self.c, &self.d].iter().all(|matrix| matrix.iter().all(|entry| entry.is_finite()))
    }

    /// The model with every input and output in other units: `scale[output, input]` times the response.
    #[must_use]
    pub(super) fn in_units(&self, inputs: &[f64], outputs: &[f64]) -> Self {
        let mut scaled = self.clone();
        for (input, scale) in inputs.iter().enumerate() {
            scaled.b.column_mut(input).unscale_mut(*scale);
            scaled.d.column_mut(input).unscale_mut(*scale);
        }
        for (output, scale) in outputs.iter().enumerate() {
            scaled.c.row_mut(output).scale_mut(*scale);
            scaled.d.row_mut(output).scale_mut(*scale);
        }
        scaled
    }
}
