//! Decides which parameters are named, and how much they explain together (step 12 in `physics`,
//! M18.4).
//!
//! `z` is a parameter's change in plausible standard deviations. The *ratio* is the misfit of
//! conditions that are left out of the fit, over that misfit without any parameter; the *stepwise
//! list* adds the parameters one by one, and the *explained* share is 1 minus its least ratio
//! (`score`). *Learned* is the share of the prior variance that the data remove.
//!
//! A parameter is named if all of these are true: its interval excludes 0; its step in the stepwise
//! list lowers the ratio by 0.01 or more; `|z| < 3`; explained is 0.1 or more; four conditions or
//! more are in the fit. The thresholds were set by trial on simulated helicopters with known
//! parameters; `docs/physics.md`, M18.7, shows the success on others.

use super::intervals::LEAST_CONDITIONS;
use super::problem::GREATEST_VALUE;

/// Minimum by which a parameter's step must lower the ratio.
pub const LEAST_GAIN: f64 = 0.01;
/// Minimum explained share for naming any parameter.
pub const LEAST_EXPLAINED: f64 = 0.1;
/// Minimum explained share for the verdict that the parameters account for the misfit.
pub const MOSTLY_EXPLAINED: f64 = 0.5;
/// Maximum misfit, relative to the spread, for which the remaining misfit counts as spread between
/// the identified models.
pub const SPREAD_RATIO: f64 = 1.75;
/// Minimum learned share for a parameter that the data determine.
pub const LEAST_LEARNED: f64 = 0.5;

/// How much the parameters explain together.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Verdict {
    /// The parameters explain less than a tenth of the misfit that gains and delays leave.
    None,
    /// The parameters explain a tenth or more of the misfit that gains and delays leave; something
    /// else is also at work.
    InPart,
    /// The parameters explain half or more of the misfit that gains and delays leave, and the
    /// remaining misfit is at most 1.75 times the spread between identified models.
    Accounts,
}

impl Verdict {
    /// Decides from the explained share, the misfit and the spread between identified models; the
    /// spread is `None` if each condition has only one identified model, which rules out
    /// [`Self::Accounts`].
    pub fn new(explained: f64, misfit: f64, spread: Option<f64>) -> Self {
        let is_near_spread = match spread {
            Some(spread) => misfit <= SPREAD_RATIO * spread,
            None => false,
        };
        if explained.is_nan() || explained < LEAST_EXPLAINED {
            Self::None
        } else if explained >= MOSTLY_EXPLAINED && is_near_spread {
            Self::Accounts
        } else {
            Self::InPart
        }
    }

    /// Returns the stable code used in files.
    pub fn code(self) -> &'static str {
        match self {
            Self::None => "none",
            Self::InPart => "in_part",
            Self::Accounts => "accounts",
        }
    }
}

/// Why a parameter is not named.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum WhyNotNamed {
    /// Its value was set by hand.
    Held,
    /// Fewer than four conditions are in the fit.
    FewConditions { found: usize },
    /// There are no scores: a condition left out cannot be predicted from the others, or there is
    /// no misfit to explain.
    NotPredicted,
    /// All parameters together explain less than a tenth.
    NothingExplained { explained: f64 },
    /// Its fitted change is at the bound, three plausible standard deviations; `z` is the change in
    /// these units.
    AtBound { z: f64 },
    /// Its interval contains zero, and the data remove less than half of its prior variance.
    DataSilent { learned: f64 },
    /// Its interval contains zero.
    IntervalContainsZero,
    /// Its step in the stepwise list lowers the ratio by less than 0.01.
    LittleGain { gain: f64 },
}

impl WhyNotNamed {
    /// Returns the stable code used in files.
    pub fn code(self) -> &'static str {
        match self {
            Self::Held => "held",
            Self::FewConditions { .. } => "few-conditions",
            Self::NotPredicted => "not-predicted",
            Self::NothingExplained { .. } => "nothing-explained",
            Self::AtBound { .. } => "at-bound",
            Self::DataSilent { .. } => "data-silent",
            Self::IntervalContainsZero => "interval-contains-zero",
            Self::LittleGain { .. } => "little-gain",
        }
    }
}

/// The facts that decide whether a fitted parameter is named.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct NamingFacts {
    /// Count of conditions with data in the fit.
    pub(super) conditions: usize,
    /// `None` without scores.
    pub(super) explained: Option<f64>,
    pub(super) z: f64,
    /// `None` without intervals.
    pub(super) half_width: Option<f64>,
    pub(super) learned: f64,
    /// How much the parameter's step lowers the ratio; `None` without scores.
    pub(super) gain: Option<f64>,
}

impl NamingFacts {
    /// Returns why the parameter is not named; `None` for a named parameter. The first reason that
    /// applies:
    ///
    /// ```text
    /// fewer than four conditions                                 few conditions
    /// no intervals or scores                                     not predicted
    /// |z| at its limit of 3                                      at bound
    /// interval contains 0, and learned below 0.5                 data silent
    /// interval contains 0                                        interval contains zero
    /// explained below 0.1                                        nothing explained
    /// gain below 0.01                                            little gain
    /// ```
    pub(super) fn why_not_named(&self) -> Option<WhyNotNamed> {
        if self.conditions < LEAST_CONDITIONS {
            return Some(WhyNotNamed::FewConditions {
                found: self.conditions,
            });
        }
        let (Some(half_width), Some(explained), Some(gain)) =
            (self.half_width, self.explained, self.gain)
        else {
            return Some(WhyNotNamed::NotPredicted);
        };
        if self.z.abs() >= GREATEST_VALUE {
            return Some(WhyNotNamed::AtBound { z: self.z });
        }
        if self.z.abs() <= half_width {
            return Some(if self.learned < LEAST_LEARNED {
                WhyNotNamed::DataSilent {
                    learned: self.learned,
                }
            } else {
                WhyNotNamed::IntervalContainsZero
            });
        }
        if explained < LEAST_EXPLAINED {
            return Some(WhyNotNamed::NothingExplained { explained });
        }
        if gain < LEAST_GAIN {
            return Some(WhyNotNamed::LittleGain { gain });
        }
        None
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const NAMED: NamingFacts = NamingFacts {
        conditions: 4,
        explained: Some(0.1),
        z: -1.0,
        half_width: Some(0.9),
        learned: 0.9,
        gain: Some(0.01),
    };

    #[test]
    fn every_rule_can_keep_a_parameter_from_being_named() {
        assert_eq!(NAMED.why_not_named(), None);
        let code = |facts: NamingFacts| facts.why_not_named().map(WhyNotNamed::code);
        for (facts, expected) in [
            (
                NamingFacts {
                    conditions: 3,
                    half_width: None,
                    ..NAMED
                },
                "few-conditions",
            ),
            (
                NamingFacts {
                    explained: Some(0.09),
                    ..NAMED
                },
                "nothing-explained",
            ),
            (
                NamingFacts {
                    explained: None,
                    gain: None,
                    ..NAMED
                },
                "not-predicted",
            ),
            (NamingFacts { z: 3.0, ..NAMED }, "at-bound"),
            (
                NamingFacts {
                    half_width: Some(1.0),
                    ..NAMED
                },
                "interval-contains-zero",
            ),
            (
                NamingFacts {
                    half_width: Some(1.8),
                    learned: 0.4,
                    ..NAMED
                },
                "data-silent",
            ),
            (
                NamingFacts {
                    gain: Some(0.009),
                    ..NAMED
                },
                "little-gain",
            ),
        ] {
            assert_eq!(code(facts), Some(expected));
        }
    }

    #[test]
    fn a_misfit_near_the_spread_is_accounted_for() {
        assert_eq!(Verdict::new(0.09, 0.1, Some(1.0)), Verdict::None);
        assert_eq!(Verdict::new(0.5, 0.175, Some(0.1)), Verdict::Accounts);
        assert_eq!(Verdict::new(0.5, 0.176, Some(0.1)), Verdict::InPart);
        assert_eq!(Verdict::new(0.49, 0.1, Some(0.1)), Verdict::InPart);
        assert_eq!(Verdict::new(0.9, 0.01, None), Verdict::InPart);
        assert_eq!(Verdict::new(f64::NAN, 0.01, None), Verdict::None);
    }
}
