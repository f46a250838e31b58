//! Altitude and weight classes, and the dot shapes that distinguish them.

use std::collections::BTreeSet;

use gdcm_model::dataset::Dataset;
use gdcm_model::dataset::condition::FlightState;
use gdcm_study::decisions::choices::ConditionChoice;

/// Class names that precede all others.
const FIRST: [&str; 2] = ["low", "light"];

/// Classes in a dataset. Conditions in the first altitude class are circles, others diamonds;
/// conditions in the first weight class are filled, others open.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Classes {
    /// `low` first if present, then in alphabetical order.
    pub altitudes: Vec<String>,
    /// `light` first if present, then in alphabetical order.
    pub weights: Vec<String>,
}

impl Classes {
    /// Collects and sorts the classes that occur in a dataset.
    pub fn from_dataset(dataset: &Dataset) -> Self {
        let mut altitudes = BTreeSet::new();
        let mut weights = BTreeSet::new();
        for condition in dataset.conditions() {
            let state = condition.flight_state();
            altitudes.extend(state.altitude.clone());
            weights.extend(state.weight.clone());
        }
        Self {
            altitudes: ordered(altitudes),
            weights: ordered(weights),
        }
    }

    /// Returns whether a condition is in the first altitude class, and therefore drawn as a circle.
    pub fn is_first_altitude(&self, state: &FlightState) -> bool {
        state.altitude.as_ref() == self.altitudes.first()
    }

    /// Returns whether a condition is in the first weight class, and therefore drawn filled.
    pub fn is_first_weight(&self, state: &FlightState) -> bool {
        state.weight.as_ref() == self.weights.first()
    }
}

fn ordered(names: BTreeSet<String>) -> Vec<String> {
    let mut names: Vec<String> = names.into_iter().collect();
    // The sort is stable: the other names keep their alphabetical order.
    names.sort_by_key(|name| !FIRST.contains(&name.as_str()));
    names
}

/// Returns the names of a condition's classes, such as `low altitude` and `high weight`; `None` for
/// a missing class.
pub fn class_names(state: &FlightState) -> [Option<String>; 2] {
    let altitude = state.altitude.as_ref();
    let weight = state.weight.as_ref();
    [
        altitude.map(|name| format!("{name} altitude")),
        weight.map(|name| format!("{name} weight")),
    ]
}

/// Returns the name of a condition's group of dots, the optima of its class: `low altitude, high
/// weight`, or just `optimum` without classes; if applicable, followed by `held out` or `not in the
/// schedule`.
pub(super) fn class_words(state: &FlightState, choice: &ConditionChoice) -> String {
    let mut words: Vec<String> = class_names(state).into_iter().flatten().collect();
    if words.is_empty() {
        words.push("optimum".to_owned());
    }
    if choice.held_out {
        words.push("held out".to_owned());
    } else if !choice.scheduled {
        words.push("not in the schedule".to_owned());
    }
    words.join(", ")
}
