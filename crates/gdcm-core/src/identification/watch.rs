//! Who watches a long computation: hears how far it is, and may stop it.

use super::StateSpaceMatrices;

/// Hears how far a computation is, and may stop it between two steps.
pub trait Watch: Sync {
    /// `done` (0 to 1) of the work is done; the next step is `what`.
    fn progress(&self, done: f64, what: &str);
    /// Whether the computation is to stop.
    fn is_stopped(&self) -> bool;
    /// A first model is there, in the units of the records; a better one follows.
    fn first_model(&self, _model: &StateSpaceMatrices) {}
}

/// Nobody watches: progress is not told, and nothing stops.
#[derive(Clone, Copy, Debug, Default)]
pub struct Unwatched;

impl Watch for Unwatched {
    fn progress(&self, _done: f64, _what: &str) {}

    fn is_stopped(&self) -> bool {
        false
    }
}
