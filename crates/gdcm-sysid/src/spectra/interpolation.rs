//! Linear interpolation between ascending values.

/// Neighbours of a value in an ascending list.
pub(crate) struct Neighbours {
    pub(crate) before: usize,
    pub(crate) after: usize,
    /// Weight of `after`: 0 at `before`, 1 at `after`.
    pub(crate) share: f64,
}

impl Neighbours {
    /// Finds the neighbours of `x` in `ascending`; beyond an end, the value at the end applies.
    pub(crate) fn find(ascending: &[f64], x: f64) -> Self {
        let after = ascending
            .partition_point(|at| *at <= x)
            .min(ascending.len() - 1);
        let before = after.saturating_sub(1);
        let from = ascending[before];
        let to = ascending[after];
        let share = if to > from {
            ((x - from) / (to - from)).clamp(0.0, 1.0)
        } else {
            0.0
        };
        Self {
            before,
            after,
            share,
        }
    }
}
