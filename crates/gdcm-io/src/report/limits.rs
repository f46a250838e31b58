//! Maximum numbers of conditions, responses and models in the report, which keep it printable; the
//! result files contain all of them.

/// Maximum number of conditions with figures; the tables list all conditions.
pub(super) const CONDITIONS_DRAWN: usize = 60;
/// Maximum number of responses with figures, for on-axis and for off-axis responses each.
pub(super) const PAIRS_DRAWN: usize = 40;
/// Maximum number of responses for which all are listed in a table; if there are more, only on-axis
/// and constrained responses are listed.
pub(super) const PAIRS_LISTED: usize = 48;
/// Maximum number of models of a bundle that are listed and drawn.
pub(super) const MODELS_SHOWN: usize = 40;
