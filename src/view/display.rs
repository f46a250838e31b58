//! What is shown, and how: nothing of it changes a result. What of it is kept from one day to the next.

use std::collections::{BTreeMap, BTreeSet};

use serde::{Deserialize, Serialize};

use gdcm_core::dataset::{ConditionId, ModelId, Pair};
use gdcm_core::study::{AcrossRole, ExplainTarget};

use gdcm_files::figure::{AirspeedCache, ErrorCache, ResponseCache};

use super::cost_map::MappedCost;
use super::plot::{
    Across, BodeCurve, BodeView, FigureView, FrequencyUnit, MagnitudeUnit, Measure, OverviewView, PhaseErrorUnit,
    PhaseUnit, Role,
};
use super::start_page::OpensWith;
use super::views::{AssessedFigures, CachedEvidence, CachedModes, ChannelsView, PairSet, RequirementsPage, View};
use super::{Arrangement, CurveDisplay, PlotStyle, Sheet, Sorting};

/// What is shown, none of which changes a result.
#[derive(Debug, Default)]
pub struct Display {
    /// The condition shown.
    pub condition: ConditionId,
    /// The response in the large plot.
    pub pair: Pair,
    /// The model pointed at.
    pub hovered: Option<ModelId>,
    /// The condition that is pointed at, in the list or as a dot.
    pub hovered_condition: Option<ConditionId>,
    /// What the pointer means in a plot, in one line: nothing floats over curves.
    pub told: Option<String>,
    /// The only model shown beside the representatives.
    pub isolated: Option<ModelId>,
    /// The value whose derivation is shown.
    pub asked: Option<ExplainTarget>,
    /// How the plots share the middle of the window.
    pub arrangement: Arrangement,
    /// Whether the window is so wide that names and words have all of their room.
    pub is_wide: bool,
    /// What the program opens with.
    pub opens_with: OpensWith,
    /// Whether the left panel is shown in full; by the width of the window where that was not chosen.
    pub left_open: Option<bool>,
    /// The sheet over the middle of the window.
    pub sheet: Option<Sheet>,
    /// Whether the settings are unfolded, over matrix and card.
    pub settings_open: bool,
    /// Whether the settings that are seldom changed are unfolded.
    pub advanced_open: bool,
    /// Whether the identified models are unfolded.
    pub identified_open: bool,
    /// What the map of costs shows.
    pub mapped_cost: MappedCost,
    /// Unit of frequencies.
    pub unit: FrequencyUnit,
    /// How curves are drawn.
    pub looks: PlotStyle,
    /// How the plots over frequency show their curves.
    pub curves: CurveDisplay,
    /// Ranges and transforms of the Bode plot.
    pub bode: BodeView,
    /// Ranges and transforms of the plot of errors.
    pub error: BodeView,
    /// Which responses the net-gain plots show.
    pub net_gain_pairs: PairSet,
    /// Responses held since the dataset was opened.
    pub once_held: BTreeSet<Pair>,
    /// Responses that the engineer picked for the net-gain plots.
    pub picked_pairs: BTreeSet<Pair>,
    /// What the channel plots measure, and over what.
    pub channel_values: (Measure, Across),
    /// Transforms of the channel plots.
    pub channels: ChannelsView,
    /// Whether zeros of the response in focus are shown among the poles.
    pub show_zeros: bool,
    /// Modes and zeros, kept from frame to frame.
    pub modes: CachedModes,
    /// Order of the table of modes.
    pub modes_sorting: Sorting,
    /// What the assessment shows.
    pub assessed: AssessedFigures,
    /// Order of the table of the assessment.
    pub assessment_sorting: Sorting,
    /// Whether models answer to a test input over time although there are records.
    pub shows_test: bool,
    /// Which page of requirements is shown.
    pub requirements_page: RequirementsPage,
    /// Orders of its tables.
    pub requirements_sorting: [Sorting; 2],
    /// Whether the plots of gains show no error bars and bands.
    pub hide_bars: bool,
    /// Orders of the tables of the evidence: differences, second variables, forms of the schedule.
    pub evidence_tables: [Sorting; 3],
    /// Whether the evidence for the schedule stands beside the net gains.
    pub show_evidence: bool,
    /// What speaks for each form of the schedule, kept from frame to frame.
    pub evidence: CachedEvidence,
    /// Order of the table of the evidence.
    pub evidence_sorting: Sorting,
    /// What is shown of several conditions at once.
    pub across_role: AcrossRole,
    /// Ranges and transforms of the plot of several conditions.
    pub across: BodeView,
    /// Shapes of several conditions' responses, kept from frame to frame.
    pub across_shapes: AirspeedCache,
    /// The name that the present decisions are to be kept under, as typed.
    pub variant_name: String,
    /// The variant whose corrected model and net gains are laid over those shown, by its name.
    pub overlaid: Option<String>,
    /// Orders of the tables of the comparison: what differs, and what it does.
    pub compare_sorting: [Sorting; 2],
    /// Cells of the overview.
    pub overview: OverviewView,
    /// What the figures of the views remember between frames.
    pub figures: BTreeMap<View, FigureView>,
    /// Shapes of the responses drawn, kept from frame to frame.
    pub shapes: BTreeMap<Pair, ResponseCache>,
    /// The curves that the Bode plot shows.
    pub drawn: Vec<BodeCurve>,
    /// Errors drawn, kept from frame to frame.
    pub errors: ErrorCache,
    /// The curves that the plot of errors shows.
    pub drawn_errors: Vec<BodeCurve>,
}

impl Display {
    /// A condition and a response, in plots that fit what they show.
    pub(super) fn of(condition: ConditionId, pair: Pair) -> Self {
        Self { condition, pair, ..Self::default() }
    }

    /// Shows all of the curves in the plots over frequency.
    pub fn fit_frequency_plots(&mut self) {
        self.bode.request_fit();
        self.error.request_fit();
    }

    /// Shows other curves in the plots over frequency: what nobody has zoomed is fitted to them.
    pub fn refit_frequency_plots(&mut self) {
        self.bode.request_refit();
        self.error.request_refit();
    }
}

/// How the engineer likes the window. What a later version adds has its usual value where a text of an earlier one is read.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct Preferences {
    /// How the plots share the middle of the window.
    pub arrangement: Option<Arrangement>,
    /// What the program opens with.
    pub opens_with: OpensWith,
    /// Whether the left panel is shown in full, where that was chosen.
    pub left_open: Option<bool>,
    /// Unit of frequencies.
    pub frequency_unit: FrequencyUnit,
    /// How magnitudes are read.
    pub magnitude: MagnitudeUnit,
    /// How phases are drawn.
    pub phase: PhaseUnit,
    /// How differences of phases are drawn.
    pub phase_error: PhaseErrorUnit,
    /// Roles that are hidden or shown otherwise than at first, whichever later versions hide at first.
    pub hidden_roles: BTreeSet<Role>,
    /// Whether Bode and the plot of errors show what a pilot does not notice.
    pub shows_muad: bool,
    /// Whether the bands of identified models are drawn.
    pub shows_bands: bool,
    /// Whether the values at the cursor are not listed.
    pub lists_no_values: bool,
    /// How curves are drawn.
    pub looks: PlotStyle,
}

impl Preferences {
    /// Those that the window has now.
    pub fn of(display: &Display) -> Self {
        Self {
            arrangement: Some(display.arrangement.clone()),
            opens_with: display.opens_with,
            left_open: display.left_open,
            frequency_unit: display.unit,
            magnitude: display.curves.magnitude,
            phase: display.curves.phase,
            phase_error: display.curves.phase_error,
            hidden_roles: &display.curves.hidden_roles ^ &CurveDisplay::hidden_at_first(),
            shows_muad: display.curves.shows_muad,
            shows_bands: display.curves.shows_bands,
            lists_no_values: !display.curves.lists_values,
            looks: display.looks,
        }
    }

    /// Gives a window these preferences.
    pub fn apply(&self, display: &mut Display) {
        display.arrangement = self.arrangement.clone().and_then(Arrangement::if_whole).unwrap_or_default();
        display.opens_with = self.opens_with;
        display.left_open = self.left_open;
        display.unit = self.frequency_unit;
        display.curves.magnitude = self.magnitude;
        display.curves.phase = self.phase;
        display.curves.phase_error = self.phase_error;
        display.curves.hidden_roles = &self.hidden_roles ^ &CurveDisplay::hidden_at_first();
        display.curves.shows_muad = self.shows_muad;
        display.curves.shows_bands = self.shows_bands;
        display.curves.lists_values = !self.lists_no_values;
        display.looks = self.looks.within_limits();
    }
}
