//! Cells in the requirement grid: each model's value and verdict, or why it is missing.
//!
//! A row of the grid is a requirement, a column a condition (M17.5). A cell compares two models,
//! the corrected and the uncorrected one, with flight; a role is such a version of the model.

use super::grid_requirement::RequirementLimit;
use super::required_bandwidth::NoBandwidth;
use super::required_summary::NoSummary;
use super::requirement_role::RequirementRole;

/// Verdict on a value.
#[derive(Clone, Debug, PartialEq)]
pub enum CellVerdict {
    Met,
    Outside,
    /// The requirement has no limit.
    NoTolerance,
    NotDetermined(NotDetermined),
}

impl CellVerdict {
    /// Returns the stable code, for files and tests.
    pub fn code(&self) -> &'static str {
        match self {
            Self::Met => "met",
            Self::Outside => "outside",
            Self::NoTolerance => "no-tolerance",
            Self::NotDetermined(_) => "not-determined",
        }
    }
}

/// Why a cell has no value, or a value without a verdict.
#[derive(Clone, Debug, PartialEq)]
pub enum NotDetermined {
    /// There is no model in this role.
    NoModel(RequirementRole),
    Bandwidth {
        role: RequirementRole,
        why: NoBandwidth,
    },
    /// Bandwidth and phase delay lie beyond the upper end of a level boundary.
    AboveBoundaries(RequirementRole),
    /// The condition has no flight record held out from the identification.
    NoHeldOutRecord,
    /// The quantity could not be compared with the held-out records.
    NotCompared,
    /// Flight does not show this mode.
    NoMode,
    /// The models have no modes that could be compared.
    NoModes,
    ModeNotPaired,
    /// The mode is below the band, or its standard deviations exceed the tolerance.
    ModeUncertain,
    Summary(NoSummary),
}

impl NotDetermined {
    /// Returns the stable code, for files and tests.
    pub fn code(&self) -> &'static str {
        match self {
            Self::NoModel(_) => "no-model",
            Self::Bandwidth { why, .. } => why.code(),
            Self::AboveBoundaries(_) => "above-boundaries",
            Self::NoHeldOutRecord => "no-held-out-record",
            Self::NotCompared => "not-compared",
            Self::NoMode => "no-mode",
            Self::NoModes => "no-modes",
            Self::ModeNotPaired => "mode-not-paired",
            Self::ModeUncertain => "mode-uncertain",
            Self::Summary(why) => why.code(),
        }
    }
}

/// A model's value and its verdict.
#[derive(Clone, Debug, PartialEq)]
pub struct RoleCell {
    /// Fraction, seconds, cost or level
    /// ([`unit`](super::grid_requirement::Requirement::unit)); `None` where it is not determined.
    pub value: Option<f64>,
    pub verdict: CellVerdict,
}

impl RoleCell {
    pub(super) fn absent(why: NotDetermined) -> Self {
        Self {
            value: None,
            verdict: CellVerdict::NotDetermined(why),
        }
    }

    /// Compares a value with a row's limit.
    pub(super) fn judged(value: f64, limit: &RequirementLimit) -> Self {
        Self {
            value: Some(value),
            verdict: limit.verdict(value),
        }
    }
}

/// A requirement's result in a condition, for two models.
#[derive(Clone, Debug, PartialEq)]
pub struct GridCell {
    /// The corrected model, in the grid's role.
    pub corrected: RoleCell,
    /// The uncorrected physics model.
    pub physics: RoleCell,
}

impl RequirementLimit {
    fn verdict(&self, value: f64) -> CellVerdict {
        let is_met = match self {
            Self::Within(limit) => value.abs() <= *limit,
            Self::AtMost(limit) => value <= *limit,
            Self::AtLeast(limit) => value >= *limit,
            Self::Tolerance(_) => value <= 1.0,
            // `GridSource` judges levels and modes itself.
            Self::IdentifiedLevel | Self::Mode(_) | Self::None => return CellVerdict::NoTolerance,
        };
        if is_met {
            CellVerdict::Met
        } else {
            CellVerdict::Outside
        }
    }
}
