//! Limits on conditions, responses and models in the report, which keep it printable; the result
//! files contain all of them.

/// Maximum number of conditions with figures, and in the tables of ΔJ; the other tables list all
/// conditions.
pub(super) const CONDITIONS_DRAWN: usize = 60;
/// Maximum number of responses with figures, separately for on-axis and off-axis responses.
pub(super) const PAIRS_DRAWN: usize = 40;
/// Maximum number of responses in tables that list all of them; if there are more, only on-axis and
/// constrained responses are listed.
pub(super) const PAIRS_LISTED: usize = 48;
/// Maximum number of models listed and drawn per bundle.
pub(super) const MODELS_SHOWN: usize = 40;
