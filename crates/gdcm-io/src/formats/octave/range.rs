//! GNU Octave ranges such as `0:0.5:2`, stored as three numbers.

use crate::formats::variables::Array;
use crate::reading_budget::{ReadingBudget, VariableFault};

/// Equally spaced numbers from a first number up, or for a negative step down, to a limit.
#[derive(Clone, Copy)]
pub(super) struct Range {
    pub(super) first: f64,
    pub(super) limit: f64,
    pub(super) step: f64,
}

impl Range {
    /// Converts the range to a row of numbers.
    pub(super) fn array(
        self,
        variable: &str,
        budget: &ReadingBudget<'_>,
    ) -> Result<Array, VariableFault> {
        // Number of steps = floor((limit - first) / step). The last factor includes the limit even
        // if rounding puts the last step just short of it, as in Octave.
        let steps = ((self.limit - self.first) / self.step * (1.0 + f64::EPSILON)).floor();
        let length = if steps >= 0.0 {
            (steps as usize).saturating_add(1)
        } else {
            0
        };
        budget.take(length as u64, 8, variable)?;
        let numbers = (0..length)
            .map(|index| self.first + index as f64 * self.step)
            .collect();
        Ok(Array::matrix(1, length, numbers))
    }
}
