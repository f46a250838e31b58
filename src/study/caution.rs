//! What the engineer has to know about a result that could be had all the same.

use crate::dataset::Pair;
use crate::fidelity::DiscontinuityError;
use crate::units::number;

/// A caution that travels with a result.
#[derive(Clone, Debug, PartialEq)]
pub enum Caution {
    /// A held response has no G and no D in this condition, and is not held there.
    HeldButUndefined {
        /// The response.
        pair: Pair,
    },
    /// No outliers could be suggested.
    NoSuggestions(DiscontinuityError),
    /// Measured data do not reach over the whole band, and the model has no response there.
    BandNotCovered {
        /// The identified model.
        model: String,
        /// First measured frequency \[rad/s\].
        min: f64,
        /// Last measured frequency \[rad/s\].
        max: f64,
    },
}

impl Caution {
    /// The caution in words; `pair_name` names a response.
    pub fn words(&self, pair_name: impl Fn(Pair) -> String) -> String {
        match self {
            Caution::HeldButUndefined { pair } => {
                format!("{} is not held: its response is zero or not finite somewhere in the band", pair_name(*pair))
            }
            Caution::NoSuggestions(error) => error.to_string(),
            Caution::BandNotCovered { model, min, max } => format!(
                "identified model \"{model}\" is measured from {} to {} rad/s only: narrow the band or reject it",
                number(*min),
                number(*max)
            ),
        }
    }
}
