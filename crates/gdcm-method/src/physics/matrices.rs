//! A model's four matrices, or a change in them.

use nalgebra::DMatrix;

use gdcm_model::dataset::StateSpace;

/// A model's A, B, C and D, or a change in them.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Matrices {
    /// n x n.
    pub(super) a: DMatrix<f64>,
    /// n x m.
    pub(super) b: DMatrix<f64>,
    /// p x n.
    pub(super) c: DMatrix<f64>,
    /// p x m.
    pub(super) d: DMatrix<f64>,
}

impl Matrices {
    pub(super) fn from_model(model: &StateSpace) -> Self {
        Self {
            a: model.a().clone(),
            b: model.b().clone(),
            c: model.c().clone(),
            d: model.d().clone(),
        }
    }

    /// Returns whether the matrices have the same shape as a model's.
    pub(super) fn has_shape_of(&self, model: &StateSpace) -> bool {
        self.a.nrows() == model.order() && self.d.shape() == (model.outputs(), model.inputs())
    }

    /// Returns `(changed - base) / z`.
    pub(super) fn slope(changed: &StateSpace, base: &StateSpace, z: f64) -> Self {
        Self {
            a: (changed.a() - base.a()) / z,
            b: (changed.b() - base.b()) / z,
            c: (changed.c() - base.c()) / z,
            d: (changed.d() - base.d()) / z,
        }
    }

    /// Adds `factor` times `other`.
    pub(super) fn add(&mut self, other: &Self, factor: f64) {
        add_scaled(&mut self.a, &other.a, factor);
        add_scaled(&mut self.b, &other.b, factor);
        add_scaled(&mut self.c, &other.c, factor);
        add_scaled(&mut self.d, &other.d, factor);
    }

    pub(super) fn scale(&mut self, factor: f64) {
        self.a *= factor;
        self.b *= factor;
        self.c *= factor;
        self.d *= factor;
    }

    /// Returns `S^-1 A S`, `S^-1 B`, `C S`, `D`, where `S` is the diagonal matrix with the entries
    /// `scales`.
    pub(super) fn balanced(&self, scales: &[f64]) -> Self {
        let mut balanced = self.clone();
        for (state, &scale) in scales.iter().enumerate() {
            balanced.a.row_mut(state).unscale_mut(scale);
            balanced.b.row_mut(state).unscale_mut(scale);
        }
        for (state, &scale) in scales.iter().enumerate() {
            balanced.a.column_mut(state).scale_mut(scale);
            balanced.c.column_mut(state).scale_mut(scale);
        }
        balanced
    }
}

/// Adds `factor` times `other` to `sum`.
fn add_scaled(sum: &mut DMatrix<f64>, other: &DMatrix<f64>, factor: f64) {
    for (value, other) in sum.iter_mut().zip(other.iter()) {
        *value += factor * other;
    }
}
