//! Runs all comparisons.

use gdcm_model::progress::{Cancelled, Progress};

use crate::check::{Check, CheckFault, Found};
use crate::checks::CHECKS;
use crate::reference_study::ReferenceStudy;

/// Outcomes of all comparisons.
#[derive(Clone, Debug)]
pub struct Verification {
    pub results: Vec<CheckResult>,
}

/// Outcome for one [`Check`].
#[derive(Clone, Debug)]
pub struct CheckResult {
    pub check: &'static Check,
    pub outcome: Result<Found, CheckFault>,
}

impl CheckResult {
    /// Returns whether values were compared and the worst deviation is within the tolerance.
    pub fn passed(&self) -> bool {
        match &self.outcome {
            Ok(found) => found.values > 0 && found.worst <= self.check.tolerance,
            Err(_) => false,
        }
    }
}

impl Verification {
    /// Runs all comparisons. Each is a progress step.
    ///
    /// # Errors
    /// [`Cancelled`] between comparisons if `progress` requests it.
    pub fn new(progress: &dyn Progress) -> Result<Self, Cancelled> {
        let mut study = ReferenceStudy::default();
        let mut results = Vec::with_capacity(CHECKS.len());
        for (index, check) in CHECKS.iter().enumerate() {
            if progress.cancelled() {
                return Err(Cancelled);
            }
            results.push(CheckResult {
                check,
                outcome: (check.run)(&mut study),
            });
            progress.advanced(index + 1, CHECKS.len());
        }
        Ok(Self { results })
    }

    /// Counts the comparisons that passed.
    pub fn passed(&self) -> usize {
        self.results.iter().filter(|result| result.passed()).count()
    }
}
