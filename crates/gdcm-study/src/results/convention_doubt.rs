//! Apparent sign and unit differences between the two bundles. They are reported first, because
//! they can be mistaken for a delay, a zero or a mode.

use gdcm_method::correction::Channel;
use gdcm_model::dataset::{ConditionId, Pair};

/// Sign or unit convention in which the two bundles apparently differ.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Convention {
    Sign,
    /// The unit; the value is the ratio of the identified gains to the physics gains.
    Factor(f64),
}

/// A channel with an apparent difference of convention between the identified and the physics
/// models.
#[derive(Clone, Debug, PartialEq)]
pub struct ConventionDoubt {
    pub convention: Convention,
    /// The responsible channel.
    pub channel: Channel,
    /// On-axis responses (any responses if none is on-axis) with the difference.
    pub pairs: Vec<Pair>,
    /// Whether every response of the channel shows the difference, not only `pairs`.
    pub all_responses: bool,
    /// The conditions with the difference, in file order.
    pub conditions: Vec<ConditionId>,
}

impl ConventionDoubt {
    /// Returns the channel whose sign should be reversed; `None` if the unit is in doubt.
    pub fn channel_to_reverse(&self) -> Option<Channel> {
        match self.convention {
            Convention::Sign => Some(self.channel),
            Convention::Factor(_) => None,
        }
    }
}
