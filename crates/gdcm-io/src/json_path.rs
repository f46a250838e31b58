//! Paths from the top level of a JSON text to a value.

/// A step on the path from the top level of a JSON text to a value.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) enum Step {
    /// To the value under this key in an object.
    Key(String),
    /// To the list entry with this index, counted from 0.
    Entry(usize),
}

// Keys on the paths to the conditions and models in a dataset.
pub(super) const CONDITIONS: &str = "conditions";
pub(super) const PHYSICS_MODELS: &str = "physics_models";
pub(super) const IDENTIFIED_MODELS: &str = "identified_models";
