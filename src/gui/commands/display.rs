//! Commands about view contents.

use gdcm_model::dataset::Pair;
use gdcm_plot::figure::axis::FrequencyUnit;
use gdcm_plot::figure::gains::{Across, Measure};
use gdcm_study::AcrossRole;

use crate::gui::state::across_display::{AcrossConditions, AcrossPage};
use crate::gui::state::assessment_display::AssessmentDisplay;
use crate::gui::state::mapped_cost::MappedCost;
use crate::gui::state::pair_set::PairSet;
use crate::gui::state::physics_display::PhysicsPage;
use crate::gui::state::requirements_display::RequirementsDisplay;
use crate::gui::state::view_pages::ViewPage;
use crate::gui::widgets::palette::PlotStyle;

/// Changes what a view shows; no result depends on it.
#[derive(Clone, Debug, PartialEq)]
pub enum DisplayCommand {
    /// Selects the correction whose costs the map shows.
    MapCost(MappedCost),
    /// Selects the responses in the net-gain plots.
    ShowNetGains(PairSet),
    /// Adds a response to the picked responses, or removes it; the net-gain plots then show these.
    PickPair(Pair),
    /// Selects channel gains or delays, over airspeed or over conditions.
    ShowChannels(Measure, Across),
    /// Shows or hides zeros among the poles.
    ShowZeros(bool),
    /// Shows or hides error bars and bands in gain plots.
    ShowBars(bool),
    /// Overlays a variant on the current decisions in Bode and Net gain, or removes the overlay.
    Overlay(Option<String>),
    /// Shows or hides the evidence for the schedule beside the net gains.
    ShowEvidence(bool),
    /// Shows or hides a role's models in the plots across conditions.
    ShowAcross(AcrossRole, bool),
    /// Shows only this role's models in the plots across conditions.
    ShowAcrossAlone(AcrossRole),
    /// Selects the conditions in the plots across conditions.
    ShowAcrossConditions(AcrossConditions),
    /// Selects the page in the plots across conditions: responses or errors.
    ShowAcrossPage(AcrossPage),
    /// Changes the assessed model, correction, average or responses, or how the assessment is
    /// drawn.
    Assess(AssessmentDisplay),
    /// Selects a physics parameter by name.
    ShowParameter(String),
    /// Shows a page in the Physics view.
    ShowPhysics(PhysicsPage),
    /// Changes the selected requirement, its details, or the grid's order.
    ShowRequirements(RequirementsDisplay),
    /// Selects time responses to a test input (`true`) or to the recorded inputs.
    ShowTest(bool),
    /// Shows a view's page.
    ShowPage(ViewPage),
    SetFrequencyUnit(FrequencyUnit),
    SetLooks(PlotStyle),
    /// Fits the plots to their curves.
    FitPlots,
}
