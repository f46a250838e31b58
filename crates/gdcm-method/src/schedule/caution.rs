//! Cautions about a schedule, a correction as a function of airspeed fitted to the conditions' own
//! corrections (M11b, M12, M15.6), and when a scheduled correction is so much worse than the
//! condition's own that a caution says so ([`ScheduledCost::is_notable`]).

use gdcm_model::dataset::ConditionId;

use crate::correction::Channel;

/// Cautions about a schedule.
#[derive(Clone, Debug, PartialEq)]
pub enum ScheduleCaution {
    /// The requested degree needs more distinct airspeeds (M11b).
    DegreeLowered {
        /// Requested degree.
        asked: usize,
        /// Number of airspeed clusters, which count as distinct airspeeds.
        clusters: usize,
    },
    /// Between two clusters, a gain leaves the range of the conditions' gains by more than half
    /// that range's width (M11b).
    Overshoot {
        channel: Channel,
        /// Mean airspeeds \[kt\] in the neighbouring clusters.
        between_kt: [f64; 2],
        /// Airspeed at the maximum excursion \[kt\].
        airspeed_kt: f64,
        gain: f64,
        /// Minimum and maximum gain over the conditions.
        range: [f64; 2],
    },
    /// A channel's signed delay in a condition is more than 20 ms from its mean over all
    /// conditions, or some conditions need a lead and others a delay; the condition is the one
    /// farthest from the mean (M15.6).
    SignedDelayApart {
        channel: Channel,
        condition: ConditionId,
        /// Signed delay in this condition \[s\].
        tau_s: f64,
        /// Mean signed delay in the other conditions \[s\].
        elsewhere_s: f64,
    },
    /// A gain is not positive at some airspeed in the conditions' range; possible only if `k`
    /// itself is regressed.
    NotPositive,
    /// A condition's J under the schedule is above 1, and more than twice its J under the
    /// condition's own correction (M12).
    CostsMore(ScheduledCost),
}

/// Mean on-axis J for a physics model in a condition (M12).
#[derive(Clone, Debug, PartialEq)]
pub struct ScheduledCost {
    pub condition: ConditionId,
    /// The nominal model's name, or the representative's if the nominal model is rejected.
    pub model: String,
    /// J under the schedule.
    pub scheduled: f64,
    /// J under the condition's own correction.
    pub own: f64,
}

impl ScheduledCost {
    /// `scheduled / own` above which a caution is raised.
    const NOTABLE_RATIO: f64 = 2.0;
    /// `scheduled` up to which no caution is raised: 1 corresponds to a 0.22 dB error (M4).
    const LEAST_NOTABLE: f64 = 1.0;

    /// Returns whether the scheduled J is above 1 and more than twice the condition's own J.
    pub fn is_notable(&self) -> bool {
        self.scheduled > Self::LEAST_NOTABLE && self.scheduled > Self::NOTABLE_RATIO * self.own
    }
}

impl ScheduleCaution {
    /// Returns the only condition that the caution is about; `None` if it is about the schedule,
    /// and so about every condition.
    pub fn condition(&self) -> Option<ConditionId> {
        match self {
            ScheduleCaution::CostsMore(cost) => Some(cost.condition),
            ScheduleCaution::SignedDelayApart { condition, .. } => Some(*condition),
            ScheduleCaution::DegreeLowered { .. }
            | ScheduleCaution::Overshoot { .. }
            | ScheduleCaution::NotPositive => None,
        }
    }

    /// Returns whether the caution is about a condition; one without a condition of its own is
    /// about every condition.
    pub fn concerns(&self, condition: ConditionId) -> bool {
        self.condition().is_none_or(|own| own == condition)
    }

    /// Returns the stable code used in files.
    pub fn code(&self) -> &'static str {
        match self {
            ScheduleCaution::DegreeLowered { .. } => "degree-lowered",
            ScheduleCaution::Overshoot { .. } => "schedule-overshoots",
            ScheduleCaution::SignedDelayApart { .. } => "signed-delay-apart",
            ScheduleCaution::NotPositive => "scheduled-gain-not-positive",
            ScheduleCaution::CostsMore(_) => "scheduled-cost-doubled",
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_delay_apart_from_the_others_concerns_its_own_condition_only() {
        let apart = ScheduleCaution::SignedDelayApart {
            channel: Channel::Input(0),
            condition: ConditionId(4),
            tau_s: 0.069,
            elsewhere_s: -0.017,
        };
        assert!(apart.concerns(ConditionId(4)));
        assert!(!apart.concerns(ConditionId(5)));
        assert!(ScheduleCaution::NotPositive.concerns(ConditionId(5)));
    }
}
