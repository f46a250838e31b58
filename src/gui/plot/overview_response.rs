//! Response shown in a cell of the overview.

use gdcm_model::dataset::Pair;

use super::drawn_curves::BodeCurve;

#[derive(Clone, Debug)]
pub struct OverviewCell<'a> {
    pub pair: Pair,
    pub curves: &'a [BodeCurve],
    /// Whether the response is constrained: its gain is matched exactly, its delay as far as
    /// possible.
    pub constrained: bool,
    /// Whether the pair is in focus.
    pub selected: bool,
    /// Short text in the corner, such as J; may be empty.
    pub note: String,
}
