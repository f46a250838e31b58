//! The numbers of a curve, to tell whether it still has them.

use std::sync::Arc;

use super::curve::{BodeCurve, Pane};

/// The numbers that a pane showed of a curve. They are held, so that no others can take their place in memory.
#[derive(Clone, Debug)]
pub(super) struct CurveNumbers {
    omega: Arc<[f64]>,
    values: Arc<[f64]>,
}

impl CurveNumbers {
    /// Those of a curve.
    pub(super) fn of(curve: &BodeCurve, pane: Pane) -> Self {
        Self { omega: Arc::clone(&curve.omega), values: Arc::clone(curve.shared_values(pane)) }
    }

    /// Whether `curve` still has them: without looking at any.
    pub(super) fn are_of(&self, curve: &BodeCurve, pane: Pane) -> bool {
        Arc::ptr_eq(&self.values, curve.shared_values(pane)) && Arc::ptr_eq(&self.omega, &curve.omega)
    }
}
