//! Response shown in a cell of the overview.

use gdcm_model::dataset::Pair;

use super::drawn_curves::BodeCurve;

/// Response in an overview cell.
#[derive(Clone, Debug)]
pub struct OverviewCell<'a> {
    pub pair: Pair,
    pub curves: &'a [BodeCurve],
    /// Whether the response is held: the correction must match it exactly.
    pub constrained: bool,
    /// Whether the pair is in focus.
    pub selected: bool,
    /// Short text in the corner, such as J; may be empty.
    pub note: String,
}
