//! Contents of the plots across conditions.
//!
//! A plot across conditions draws the response in focus in each condition, with one model for each
//! role ([`AcrossRole`]): identified, scheduled, corrected, representative, nominal.

use gdcm_model::dataset::{ConditionId, Pair};
use gdcm_study::{AcrossRole, Study};

/// Models and conditions in the plots across conditions.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct AcrossDisplay {
    /// Models drawn for each condition, ordered as [`AcrossRole::ALL`].
    pub roles: Vec<AcrossRole>,
    pub conditions: AcrossConditions,
    /// Page shown while the window has no room for both pages.
    pub page: AcrossPage,
}

impl Default for AcrossDisplay {
    fn default() -> Self {
        Self {
            roles: AcrossRole::SHOWN_AT_FIRST.to_vec(),
            conditions: AcrossConditions::default(),
            page: AcrossPage::default(),
        }
    }
}

impl AcrossDisplay {
    /// Shows or hides a role's models.
    pub fn show(&mut self, role: AcrossRole, is_shown: bool) {
        self.roles.retain(|known| *known != role);
        if is_shown {
            self.roles.push(role);
            self.roles.sort();
        }
    }
}

/// Conditions in the plots across conditions.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum AcrossConditions {
    #[default]
    All,
    /// Conditions to which the schedule is fitted.
    InSchedule,
}

impl AcrossConditions {
    pub const ALL: [Self; 2] = [Self::All, Self::InSchedule];

    /// Returns the text in the list of choices.
    pub fn name(self) -> &'static str {
        match self {
            Self::All => "all",
            Self::InSchedule => "in the schedule",
        }
    }

    /// Returns these conditions in a study.
    pub fn of_study(self, study: &Study) -> Vec<ConditionId> {
        study
            .dataset
            .ids()
            .filter(|id| self == Self::All || study.choice(*id).is_in_schedule())
            .collect()
    }
}

/// Page with plots across conditions.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum AcrossPage {
    #[default]
    Response,
    Error,
}

/// Content to which the axes were last fitted in the plots across conditions.
#[derive(Clone, Debug, PartialEq)]
pub struct AcrossFit {
    pub pair: Pair,
    pub condition: ConditionId,
    pub roles: Vec<AcrossRole>,
    pub conditions: AcrossConditions,
}
