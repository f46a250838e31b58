//! Display options for gains and delays over airspeed, and for the evidence beside them.

use std::collections::BTreeSet;

use gdcm_model::dataset::Pair;
use gdcm_plot::figure::gains::{Across, Measure};

use super::channels_view::ChannelsView;
use super::evidence_cache::CachedEvidence;
use super::pair_set::PairSet;
use crate::gui::widgets::tables::Sorting;

/// Options for displaying the channel plots, the net-gain plots and the evidence.
#[derive(Debug, Default)]
pub struct GainDisplay {
    /// Responses shown in the net-gain plots.
    pub net_gain_pairs: PairSet,
    /// Responses that were constrained at any time since the dataset was opened.
    pub once_held: BTreeSet<Pair>,
    /// Responses picked by the engineer for the net-gain plots.
    pub picked_pairs: BTreeSet<Pair>,
    /// Quantity in the channel plots, and whether it is drawn over airspeed or over conditions.
    pub channel_values: (Measure, Across),
    /// Ranges and transforms in the channel plots.
    pub channels: ChannelsView,
    /// Whether gain plots omit error bars and bands.
    pub hide_bars: bool,
    /// Sort order for the tables in the Evidence view: differences, second variables, schedule
    /// forms.
    pub evidence_tables: [Sorting; 3],
    /// Whether the evidence for the schedule is shown beside the net gains.
    pub show_evidence: bool,
    /// Evidence for each schedule form, cached between frames.
    pub evidence: CachedEvidence,
    /// Sort order for the evidence beside the net gains.
    pub evidence_sorting: Sorting,
}
