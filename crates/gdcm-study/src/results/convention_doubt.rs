//! Apparent sign and unit differences between the two bundles, reported first: before a delay, zero
//! or mode is blamed for their effect.

use gdcm_method::correction::Channel;
use gdcm_model::dataset::{ConditionId, Pair};

/// The difference of convention between the two bundles.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Convention {
    Sign,
    /// The unit: ratio of the identified models' values to the physics models' values.
    Factor(f64),
}

/// A channel with an apparent difference of convention between the identified and the physics
/// models.
#[derive(Clone, Debug, PartialEq)]
pub struct ConventionDoubt {
    pub convention: Convention,
    /// The responsible channel.
    pub channel: Channel,
    /// The measuring responses with the difference.
    pub pairs: Vec<Pair>,
    /// Whether all the channel's responses show it.
    pub all_responses: bool,
    /// The conditions with the difference, in file order.
    pub conditions: Vec<ConditionId>,
}

impl ConventionDoubt {
    /// Returns the channel to reverse, where the sign is in doubt.
    pub fn turns(&self) -> Option<Channel> {
        match self.convention {
            Convention::Sign => Some(self.channel),
            Convention::Factor(_) => None,
        }
    }
}
