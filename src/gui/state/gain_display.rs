//! Display of gains and delays over airspeed, and of the evidence for their schedule.

use std::collections::BTreeSet;

use gdcm_model::dataset::Pair;
use gdcm_plot::figure::gains::{Across, Measure};

use super::channels_view::ChannelsView;
use super::evidence_cache::CachedEvidence;
use super::pair_set::PairSet;
use crate::gui::widgets::tables::Sorting;

/// Content of the channel and net-gain plots and of the evidence beside them.
#[derive(Debug, Default)]
pub struct GainDisplay {
    pub net_gain_pairs: PairSet,
    /// Responses constrained at any time since the dataset was opened.
    pub once_held: BTreeSet<Pair>,
    /// Responses picked by the engineer for the net-gain plots.
    pub picked_pairs: BTreeSet<Pair>,
    pub channel_values: (Measure, Across),
    /// Transforms of the channel plots.
    pub channels: ChannelsView,
    /// Whether the plots of gains omit error bars and bands.
    pub hide_bars: bool,
    /// Orders of the evidence tables: differences, second variables, forms of the schedule.
    pub evidence_tables: [Sorting; 3],
    /// Whether the evidence for the schedule is shown beside the net gains.
    pub show_evidence: bool,
    /// Evidence for each form of the schedule, cached between frames.
    pub evidence: CachedEvidence,
    pub evidence_sorting: Sorting,
}
