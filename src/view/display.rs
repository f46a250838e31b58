//! What is shown, and how: nothing of it changes a result. Which views the middle of the window shows, and where: one at a time in groups,
//! another one beside it, and the dock below. What of it is kept from one day to the next.

use std::collections::{BTreeMap, BTreeSet};

use serde::{Deserialize, Serialize};

use gdcm_model::dataset::{ConditionId, ModelId, Pair};
use gdcm_plot::figure::axis::FrequencyUnit;
use gdcm_plot::figure::error::ErrorCache;
use gdcm_plot::figure::gains::{Across, Measure};
use gdcm_plot::figure::responses::{AirspeedCache, ResponseCache};
use gdcm_study::study::{AcrossRole, ExplainTarget};

use super::cost_map::MappedCost;
use super::curve_display::CurveDisplay;
use super::explanation::Sheet;
use super::palette::PlotStyle;
use super::plot::{BodeCurve, BodeView, FigureView, Role};
use super::start_page::OpensWith;
use super::tables::Sorting;
use super::views::{AssessedFigures, PairSet, RequirementsPage, View};
use crate::view::plot::overview::OverviewView;
use crate::view::plot::quantity::{MagnitudeUnit, PhaseErrorUnit, PhaseUnit};
use crate::view::views::channels::ChannelsView;
use crate::view::views::evidence::CachedEvidence;
use crate::view::views::poles::CachedModes;

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
    /// The response, and the model of each condition, that this plot was fitted to last.
    pub across_fitted: Option<(Pair, AcrossRole)>,
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
    /// Shows all of the curves in the plots over frequency.
    pub fn fit_frequency_plots(&mut self) {
        self.bode.request_fit();
        self.error.request_fit();
        self.across.request_fit();
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

/// What the views are about.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
pub enum ViewGroup {
    /// Responses over frequency.
    #[default]
    Response,
    /// Models, and what they are identified from.
    Models,
    /// What changes with airspeed.
    Schedule,
    /// What the correction is worth.
    Judge,
}

impl ViewGroup {
    /// Every group, from left to right.
    pub const ALL: [Self; 4] = [Self::Response, Self::Models, Self::Schedule, Self::Judge];

    /// What its button says.
    pub fn name(self) -> &'static str {
        match self {
            Self::Response => "Response",
            Self::Models => "Models",
            Self::Schedule => "Schedule",
            Self::Judge => "Judge",
        }
    }

    /// Its views, from left to right.
    pub fn views(self) -> impl Iterator<Item = View> {
        View::ALL
            .into_iter()
            .filter(move |view| view.kind().group == self)
    }
}

/// What the middle of the window shows.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(default)]
pub struct Arrangement {
    /// The group in front.
    group: ViewGroup,
    /// The view that each group shows, in the order of the groups.
    of_groups: [View; 4],
    /// The view beside it, where there is one.
    beside: Option<View>,
    /// The view in the dock.
    dock: View,
    /// Whether the dock is unfolded; by the height of the window where that was not chosen.
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
    /// The group in front.
    pub fn group(&self) -> ViewGroup {
        self.group
    }

    /// The view in front.
    pub fn view(&self) -> View {
        self.of_groups[self.group as usize]
    }

    /// The view beside it.
    pub fn beside(&self) -> Option<View> {
        self.beside.filter(|beside| *beside != self.view())
    }

    /// The view that the dock shows; none where the view in front takes its room.
    pub fn dock(&self) -> Option<View> {
        let is_free = !self.view().kind().takes_dock
            && self.view() != self.dock
            && self.beside() != Some(self.dock);
        is_free.then_some(self.dock)
    }

    /// Whether the dock is unfolded in a window that has room for it, or has not.
    pub fn is_dock_open(&self, has_room: bool) -> bool {
        self.dock_open.unwrap_or(has_room)
    }

    /// Folds or unfolds the dock.
    pub fn open_dock(&mut self, is_open: bool) {
        self.dock_open = Some(is_open);
    }

    /// Brings a group to the front, with the view that it showed last.
    pub fn show_group(&mut self, group: ViewGroup) {
        self.group = group;
    }

    /// Brings a view to the front; one of the dock is unfolded there, unless it is in front already.
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

    /// Shows a view beside the one in front, or none.
    pub fn show_beside(&mut self, view: Option<View>) {
        self.beside = view.filter(|view| *view != self.view());
    }

    /// The view so many places further in the group in front, round about.
    pub fn neighbour(&self, by: isize) -> View {
        let views: Vec<View> = self.group.views().collect();
        let here = views
            .iter()
            .position(|view| *view == self.view())
            .unwrap_or(0);
        views[(here as isize + by).rem_euclid(views.len() as isize) as usize]
    }

    /// Whether a view can be seen.
    pub fn is_shown(&self, view: View) -> bool {
        self.view() == view || self.beside() == Some(view) || self.dock() == Some(view)
    }

    /// This arrangement, kept from another day, where every group shows a view of its own.
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
