//! Display state, which never changes a result: the views in the middle of the window and their
//! places (one at a time in groups, a second view beside it, and the dock below), and the
//! preferences that persist between sessions.

use std::collections::{BTreeMap, BTreeSet};

use serde::{Deserialize, Serialize};

use gdcm_model::dataset::{ConditionId, ModelId, Pair};
use gdcm_plot::figure::axis::FrequencyUnit;
use gdcm_plot::figure::error::ErrorCache;
use gdcm_plot::figure::gains::{Across, Measure};
use gdcm_plot::figure::responses::{AirspeedCache, ResponseCache};
use gdcm_study::AcrossRole;
use gdcm_words::ExplainTarget;

use super::curve_display::CurveDisplay;
use crate::gui::panels::cost_map::MappedCost;
use crate::gui::panels::explanation::Sheet;
use crate::gui::panels::start_page::OpensWith;
use crate::gui::plot::overview::OverviewView;
use crate::gui::plot::quantity::{MagnitudeUnit, PhaseErrorUnit, PhaseUnit};
use crate::gui::plot::{BodeCurve, BodeView, FigureView, Role};
use crate::gui::views::channels::ChannelsView;
use crate::gui::views::evidence::CachedEvidence;
use crate::gui::views::poles::CachedModes;
use crate::gui::views::{AssessedFigures, PairSet, RequirementsPage, View};
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

/// Preferences of the engineer for the window. Fields missing from the text of an earlier version
/// get their defaults.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct Preferences {
    pub arrangement: Option<Arrangement>,
    /// What the program opens with.
    pub opens_with: OpensWith,
    /// Whether the left panel is shown in full, if chosen.
    pub left_open: Option<bool>,
    pub frequency_unit: FrequencyUnit,
    pub magnitude: MagnitudeUnit,
    pub phase: PhaseUnit,
    pub phase_error: PhaseErrorUnit,
    /// Roles whose visibility differs from the default, which later versions may change.
    pub hidden_roles: BTreeSet<Role>,
    /// Whether Bode and the plot of errors show the envelopes of maximum unnoticeable added
    /// dynamics.
    pub shows_muad: bool,
    pub shows_bands: bool,
    /// Whether the values at the cursor are not listed.
    pub lists_no_values: bool,
    pub looks: PlotStyle,
}

impl Preferences {
    /// Returns the current preferences of a window.
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

    /// Applies these preferences to a window.
    pub fn apply(&self, display: &mut Display) {
        display.arrangement = self
            .arrangement
            .clone()
            .and_then(Arrangement::if_whole)
            .unwrap_or_default();
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

/// Group of views by subject.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
pub enum ViewGroup {
    /// Responses over frequency.
    #[default]
    Response,
    /// Models and the data behind them.
    Models,
    /// Quantities over airspeed.
    Schedule,
    /// Value of the correction.
    Judge,
}

impl ViewGroup {
    /// Every group, from left to right.
    pub const ALL: [Self; 4] = [Self::Response, Self::Models, Self::Schedule, Self::Judge];

    /// Returns the text of the group's button.
    pub fn name(self) -> &'static str {
        match self {
            Self::Response => "Response",
            Self::Models => "Models",
            Self::Schedule => "Schedule",
            Self::Judge => "Judge",
        }
    }

    /// Returns the views of the group, from left to right.
    pub fn views(self) -> impl Iterator<Item = View> {
        View::ALL
            .into_iter()
            .filter(move |view| view.kind().group == self)
    }
}

/// Arrangement of the views in the middle of the window.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(default)]
pub struct Arrangement {
    /// Group in front.
    group: ViewGroup,
    /// View shown by each group, in the order of the groups.
    of_groups: [View; 4],
    /// View beside the view in front.
    beside: Option<View>,
    /// View in the dock.
    dock: View,
    /// Whether the dock is unfolded; `None` follows the height of the window.
    dock_open: Option<bool>,
}

impl Default for Arrangement {
    fn default() -> Self {
        let of_groups = [View::Bode, View::Poles, View::Channels, View::Assessment];
        Self {
            group: ViewGroup::Response,
            of_groups,
            beside: None,
            dock: View::NetGain,
            dock_open: None,
        }
    }
}

impl Arrangement {
    /// Returns the group in front.
    pub fn group(&self) -> ViewGroup {
        self.group
    }

    /// Returns the view in front.
    pub fn view(&self) -> View {
        self.of_groups[self.group as usize]
    }

    /// Returns the view beside the view in front.
    pub fn beside(&self) -> Option<View> {
        self.beside.filter(|beside| *beside != self.view())
    }

    /// Returns the view in the dock; `None` if the view in front takes its room.
    pub fn dock(&self) -> Option<View> {
        let is_free = !self.view().kind().takes_dock
            && self.view() != self.dock
            && self.beside() != Some(self.dock);
        is_free.then_some(self.dock)
    }

    /// Returns whether the dock is unfolded, given whether the window has room for it.
    pub fn is_dock_open(&self, has_room: bool) -> bool {
        self.dock_open.unwrap_or(has_room)
    }

    /// Folds or unfolds the dock.
    pub fn open_dock(&mut self, is_open: bool) {
        self.dock_open = Some(is_open);
    }

    /// Brings a group to the front, with the view it showed last.
    pub fn show_group(&mut self, group: ViewGroup) {
        self.group = group;
    }

    /// Brings a view to the front; a view of the dock is unfolded there instead, unless it is in
    /// front already.
    pub fn show(&mut self, view: View) {
        let group = view.kind().group;
        self.group = group;
        self.of_groups[group as usize] = view;
        if self.beside == Some(view) {
            self.beside = None;
        }
    }

    /// Shows a view in the dock.
    pub fn dock_view(&mut self, view: View) {
        self.dock = view;
        self.dock_open = Some(true);
    }

    /// Shows a view beside the view in front, or none.
    pub fn show_beside(&mut self, view: Option<View>) {
        self.beside = view.filter(|view| *view != self.view());
    }

    /// Returns the view `by` places further in the group in front, wrapping around.
    pub fn neighbour(&self, by: isize) -> View {
        let views: Vec<View> = self.group.views().collect();
        let here = views
            .iter()
            .position(|view| *view == self.view())
            .unwrap_or(0);
        views[(here as isize + by).rem_euclid(views.len() as isize) as usize]
    }

    /// Returns whether a view is visible.
    pub fn is_shown(&self, view: View) -> bool {
        self.view() == view || self.beside() == Some(view) || self.dock() == Some(view)
    }

    /// Returns this stored arrangement if every group shows a view of its own.
    pub fn if_whole(self) -> Option<Self> {
        let is_of_group = |group: ViewGroup| self.of_groups[group as usize].kind().group == group;
        ViewGroup::ALL.into_iter().all(is_of_group).then_some(self)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_view_stands_in_one_group_and_every_group_has_views() {
        let views: Vec<View> = ViewGroup::ALL
            .into_iter()
            .flat_map(ViewGroup::views)
            .collect();
        assert_eq!(views.len(), View::ALL.len());
        assert!(
            ViewGroup::ALL
                .into_iter()
                .all(|group| group.views().count() > 1)
        );
    }

    #[test]
    fn a_group_remembers_its_view() {
        let mut arrangement = Arrangement::default();
        arrangement.show(View::Overview);
        arrangement.show_group(ViewGroup::Judge);
        assert_eq!(arrangement.view(), View::Assessment);
        arrangement.show_group(ViewGroup::Response);
        assert_eq!(arrangement.view(), View::Overview);
        assert_eq!(
            (arrangement.neighbour(1), arrangement.neighbour(-1)),
            (View::Across, View::Error)
        );
    }

    #[test]
    fn a_view_is_never_shown_twice() {
        let mut arrangement = Arrangement::default();
        assert_eq!(arrangement.dock(), Some(View::NetGain));
        arrangement.show(View::NetGain);
        assert_eq!(arrangement.dock(), None);
        arrangement.show(View::Bode);
        arrangement.show_beside(Some(View::NetGain));
        assert_eq!(
            (arrangement.dock(), arrangement.beside()),
            (None, Some(View::NetGain))
        );
        arrangement.show_beside(Some(View::Poles));
        arrangement.show(View::Poles);
        assert_eq!(arrangement.beside(), None);
        arrangement.show(View::Records);
        assert_eq!(arrangement.dock(), None, "it takes the room of the dock");
    }

    #[test]
    fn an_arrangement_is_kept_and_one_that_mixes_the_groups_up_is_not_taken() {
        let mut arrangement = Arrangement::default();
        arrangement.show(View::Evidence);
        arrangement.show_beside(Some(View::Bode));
        let text = serde_json::to_string(&arrangement).unwrap();
        assert_eq!(
            serde_json::from_str::<Arrangement>(&text)
                .unwrap()
                .if_whole(),
            Some(arrangement)
        );
        let mixed = Arrangement {
            of_groups: [View::Poles; 4],
            ..Arrangement::default()
        };
        assert_eq!(mixed.if_whole(), None);
    }
}
