//! Display state; none of it changes a result.

use std::collections::{BTreeMap, BTreeSet};

use gdcm_model::dataset::{ConditionId, ModelId, Pair};
use gdcm_plot::figure::axis::FrequencyUnit;
use gdcm_plot::figure::error::ErrorCache;
use gdcm_plot::figure::gains::{Across, Measure};
use gdcm_plot::figure::responses::{AirspeedCache, ResponseCache};
use gdcm_study::{AcrossRole, ExplainTarget};

use super::arrangement::Arrangement;
use super::assessed_figures::AssessedFigures;
use super::channels_view::ChannelsView;
use super::curve_display::CurveDisplay;
use super::evidence_cache::CachedEvidence;
use super::mapped_cost::MappedCost;
use super::modes_cache::CachedModes;
use super::opens_with::OpensWith;
use super::pair_set::PairSet;
use super::requirements_page::RequirementsPage;
use super::sheet::Sheet;
use super::view::View;
use crate::gui::plot::overview::OverviewView;
use crate::gui::plot::{BodeCurve, BodeView, FigureView};
use crate::gui::widgets::palette::PlotStyle;
use crate::gui::widgets::tables::Sorting;

/// Display state; none of it changes a result.
#[derive(Debug, Default)]
pub struct Display {
    pub condition: ConditionId,
    /// Response in the large plot.
    pub pair: Pair,
    /// Model under the pointer.
    pub hovered: Option<ModelId>,
    /// Condition under the pointer, in the list or as a dot.
    pub hovered_condition: Option<ConditionId>,
    /// Description of the plot element under the pointer, in a single line: nothing floats over
    /// curves.
    pub told: Option<String>,
    /// The only model shown beside the representatives.
    pub isolated: Option<ModelId>,
    /// Value whose derivation is shown.
    pub asked: Option<ExplainTarget>,
    pub arrangement: Arrangement,
    /// Whether the window is wide enough for full names and words.
    pub is_wide: bool,
    /// What the program opens with.
    pub opens_with: OpensWith,
    /// Whether the left panel is shown in full; `None` follows the width of the window.
    pub left_open: Option<bool>,
    /// Sheet over the middle of the window.
    pub sheet: Option<Sheet>,
    /// Whether the settings are unfolded, over matrix and card.
    pub settings_open: bool,
    /// Whether the rarely changed settings are unfolded.
    pub advanced_open: bool,
    pub identified_open: bool,
    pub mapped_cost: MappedCost,
    pub unit: FrequencyUnit,
    pub looks: PlotStyle,
    pub curves: CurveDisplay,
    /// Ranges and transforms of the Bode plot.
    pub bode: BodeView,
    /// Ranges and transforms of the plot of errors.
    pub error: BodeView,
    pub net_gain_pairs: PairSet,
    /// Responses constrained at any time since the dataset was opened.
    pub once_held: BTreeSet<Pair>,
    /// Responses picked by the engineer for the net-gain plots.
    pub picked_pairs: BTreeSet<Pair>,
    pub channel_values: (Measure, Across),
    /// Transforms of the channel plots.
    pub channels: ChannelsView,
    /// Whether the zeros of the response in focus are shown among the poles.
    pub show_zeros: bool,
    /// Modes and zeros, cached between frames.
    pub modes: CachedModes,
    pub modes_sorting: Sorting,
    pub assessed: AssessedFigures,
    pub assessment_sorting: Sorting,
    /// Whether responses to a test input are shown although there are records.
    pub shows_test: bool,
    pub requirements_page: RequirementsPage,
    pub requirements_sorting: [Sorting; 2],
    /// Whether the plots of gains omit error bars and bands.
    pub hide_bars: bool,
    /// Orders of the evidence tables: differences, second variables, forms of the schedule.
    pub evidence_tables: [Sorting; 3],
    /// Whether the evidence for the schedule is shown beside the net gains.
    pub show_evidence: bool,
    /// Evidence for each form of the schedule, cached between frames.
    pub evidence: CachedEvidence,
    pub evidence_sorting: Sorting,
    /// Displayed role of the plot across conditions.
    pub across_role: AcrossRole,
    /// Ranges and transforms of the plot across conditions.
    pub across: BodeView,
    /// Response, and model of each condition, to which that plot was last fitted.
    pub across_fitted: Option<(Pair, AcrossRole)>,
    /// Shapes of the responses across conditions, cached between frames.
    pub across_shapes: AirspeedCache,
    /// Name for the present decisions as a variant, as typed.
    pub variant_name: String,
    /// Name of the variant whose corrected model and net gains are overlaid.
    pub overlaid: Option<String>,
    /// Orders of the comparison tables: differences, and their effects.
    pub compare_sorting: [Sorting; 2],
    pub overview: OverviewView,
    /// State of the views' figures between frames.
    pub figures: BTreeMap<View, FigureView>,
    /// Shapes of the drawn responses, cached between frames.
    pub shapes: BTreeMap<Pair, ResponseCache>,
    /// Curves shown by the Bode plot.
    pub drawn: Vec<BodeCurve>,
    /// Drawn errors, cached between frames.
    pub errors: ErrorCache,
    /// Curves shown by the plot of errors.
    pub drawn_errors: Vec<BodeCurve>,
}

impl Display {
    /// Fits the plots over frequency to all of their curves.
    pub fn fit_frequency_plots(&mut self) {
        self.bode.request_fit();
        self.error.request_fit();
        self.across.request_fit();
    }

    /// Fits the plots over frequency to other curves, except on axes that have been zoomed.
    pub fn refit_frequency_plots(&mut self) {
        self.bode.request_refit();
        self.error.request_refit();
    }
}
