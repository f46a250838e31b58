//! A comparison with independent figures, and the deviations it finds.

use crate::reference_study::ReferenceStudy;

/// Comparison between the program's results and independent figures.
#[derive(Clone, Copy, Debug)]
pub struct Check {
    /// Stable code, for scripts and tests.
    pub code: &'static str,
    /// Sections in `docs/method.md` and the pages beside it: "M8", "M3, M6, M7".
    pub sections: &'static str,
    /// Compared quantities, as a noun phrase.
    pub what: &'static str,
    /// Independent code, closed form or publication that gives the expected values.
    pub source: &'static str,
    /// Unit for deviation and tolerance, or the quantity they are relative to.
    pub measure: &'static str,
    /// Maximum deviation, in the unit that `measure` names.
    pub tolerance: f64,
    /// Reason for the tolerance.
    pub reason: &'static str,
    /// Computes the deviations.
    pub run: fn(&mut ReferenceStudy) -> Result<Found, CheckFault>,
}

/// Deviations from the expected values.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Found {
    /// Count of compared problems, models or conditions.
    pub instances: usize,
    pub values: usize,
    /// Maximum deviation, in the unit that [`Check::measure`] names; infinite if a value is not a
    /// number or a yes-or-no result differs.
    pub worst: f64,
}

impl Found {
    /// Counts a problem, model or condition.
    pub fn instance(&mut self) {
        self.instances += 1;
    }

    /// Adds a deviation; its sign does not matter, and NaN counts as infinite.
    pub fn deviation(&mut self, deviation: f64) {
        self.values += 1;
        let size = deviation.abs();
        if size.is_nan() {
            self.worst = f64::INFINITY;
        } else {
            self.worst = self.worst.max(size);
        }
    }

    /// Compares a value with its reference, relative to the reference.
    pub fn relative(&mut self, found: f64, expected: f64) {
        self.deviation((found - expected) / expected);
    }

    /// Compares a value with its reference, relative to the reference or to `scale` if the reference
    /// is smaller.
    pub fn scaled(&mut self, found: f64, expected: f64, scale: f64) {
        self.deviation((found - expected) / expected.abs().max(scale));
    }

    /// Compares two lists as [`Self::scaled`] does; lists with different lengths disagree.
    pub fn all_scaled(&mut self, found: &[f64], expected: &[f64], scale: f64) {
        if found.len() != expected.len() {
            self.agree(false);
        }
        for (found, expected) in found.iter().zip(expected) {
            self.scaled(*found, *expected, scale);
        }
    }

    /// Adds a yes-or-no result; a difference is an infinite deviation.
    pub fn agree(&mut self, agrees: bool) {
        self.values += 1;
        if !agrees {
            self.worst = f64::INFINITY;
        }
    }
}

/// Reason why a comparison could not be made.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum CheckFault {
    #[error("reference {file}: {member} is missing or of the wrong kind")]
    Reference { file: &'static str, member: String },
    #[error("no result: {reason}")]
    NoResult { reason: String },
}

impl CheckFault {
    /// Returns the fault for a computation that ended without a result.
    pub fn no_result(reason: impl ToString) -> Self {
        Self::NoResult {
            reason: reason.to_string(),
        }
    }

    /// Returns the stable code for scripts.
    pub fn code(&self) -> &'static str {
        match self {
            Self::Reference { .. } => "wrong-reference",
            Self::NoResult { .. } => "no-result",
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_value_that_is_not_a_number_is_an_infinite_deviation() {
        let mut found = Found::default();
        found.relative(1.0 + 1e-9, 1.0);
        assert!(found.worst < 2e-9);
        found.relative(f64::NAN, 1.0);
        assert_eq!(found.worst, f64::INFINITY);
        found.deviation(0.0);
        assert_eq!((found.worst, found.values), (f64::INFINITY, 3));
    }

    #[test]
    fn lists_of_different_lengths_disagree() {
        let mut found = Found::default();
        found.all_scaled(&[1.0], &[1.0, 2.0], 1.0);
        assert_eq!(found.worst, f64::INFINITY);
    }
}
