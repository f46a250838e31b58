//! Views between the side panels. [`view_content`] lists, for each view, its drawing function,
//! header, background jobs and figure; the panels around the view draw what it lists.

pub mod across;
mod across_chips;
mod across_curves;
mod across_readout;
pub mod assembling;
pub mod assessment;
mod assessment_bar_words;
pub mod assessment_content;
mod assessment_header;
mod assessment_plots;
mod automatic_settings;
mod axis_updates;
mod bandwidth;
mod bandwidth_settings;
pub mod bode;
pub mod captioned_settings;
pub mod channels;
pub mod compare;
mod correction_effect;
pub mod couplings;
pub mod couplings_use;
mod cursor_readout;
mod curve_chips;
pub mod error_bars;
pub mod evidence;
pub mod figure_button;
pub mod figures;
pub(in crate::gui) mod frequency_curves;
mod frequency_plot;
pub mod gain_plots;
pub mod leads;
mod limit_field;
mod mode_table;
mod mode_text;
pub mod model_error;
pub mod need;
pub mod net_gain;
mod net_gain_header;
pub mod net_gain_pairs;
pub mod overview;
pub mod physics;
pub mod poles;
pub mod records;
mod requirement_cards;
mod requirement_cells;
mod requirement_details;
mod requirement_edits;
mod requirement_grid;
mod requirement_grid_layout;
mod requirement_histories;
pub mod requirement_history_jobs;
mod requirement_limits;
mod requirement_limits_menu;
mod requirement_modes;
pub mod requirement_selection;
mod requirement_tables;
mod requirement_test_input;
pub mod requirements;
mod scatter_bars;
mod schedule_cost;
mod schedule_tables;
pub mod setting_controls;
pub mod shown_remarks;
pub mod variant_analyses;
mod variant_effects;

use std::sync::Arc;

use egui::Ui;

use gdcm_model::dataset::Pair;
use gdcm_study::jobs::analysis_jobs::AssessmentJob;
use gdcm_study::jobs::curve_jobs::ModesJob;

use crate::gui::commands::command::Command;
use crate::gui::commands::display::DisplayCommand;
use crate::gui::state::view::View;
use crate::gui::state::view_pages::ViewPage;
use crate::gui::state::window_state::State;
use crate::gui::widgets::choices::PageWords;
use crate::gui::widgets::palette::Palette;
use across::{across_header_ui, across_pages, across_view_ui};
use across_curves::across_job;
use assessment::assessment_view_ui;
use assessment_content::assessed_pairs;
use assessment_header::{assessment_header_ui, assessment_pages};
use bode::bode_view_ui;
use channels::{channels_header_ui, channels_pages, channels_view_ui};
use compare::{compare_pages, compare_view_ui};
use couplings::{couplings_header_ui, couplings_pages, couplings_view_ui};
use error_bars::error_bars_switch_ui;
use evidence::{evidence_pages, evidence_view_ui};
use leads::leads_view_ui;
use model_error::{error_header_ui, error_view_ui};
use need::{Need, current_analysis};
use net_gain::net_gain_view_ui;
use net_gain_header::{NET_GAIN_CONTROLS, net_gain_header_ui, net_gain_words};
use net_gain_pairs::net_gain_pairs;
use overview::{overview_pages, overview_view_ui};
use physics::{
    physics_evidence_ui, physics_header_ui, physics_job, physics_pages, physics_view_ui,
    unused_named,
};
use poles::{poles_header_ui, poles_pages, poles_view_ui};
use records::{
    records_header_ui, records_pages, records_side_ui, records_view_ui, simulation_jobs,
};
use requirements::{
    requirements_needs, requirements_tools_ui, requirements_view_ui, requirements_words,
};
use schedule_cost::{schedule_cost_view_ui, schedule_cost_words};
use variant_analyses::variant_jobs;

pub use couplings_use::{couplings_job, must_assess_couplings, offered_couplings, used_couplings};
pub use variant_analyses::overlay_job;

/// Returns a view's content: drawing function, header, background jobs and figure.
pub fn view_content(view: View) -> ViewContent {
    match view {
        View::Bode => BODE,
        View::Error => ERROR,
        View::Overview => OVERVIEW,
        View::Across => ACROSS,
        View::Poles => POLES,
        View::Physics => PHYSICS,
        View::Couplings => COUPLINGS,
        View::Records => RECORDS,
        View::Channels => CHANNELS,
        View::Assessment => ASSESSMENT,
        View::Evidence => EVIDENCE,
        View::Compare => COMPARE,
        View::Requirements => REQUIREMENTS,
        View::Leads => LEADS,
        View::NetGain => NET_GAIN,
        View::ScheduleCost => SCHEDULE_COST,
    }
}

/// Draws the right panel below the verdict.
pub type SideUi = fn(&mut Ui, &State, &Palette, &mut Vec<Command>);

#[derive(Clone, Copy)]
pub struct ViewContent {
    pub draw: fn(&mut Ui, &mut State, &Palette, &mut Vec<Command>),
    /// Additional text in the header.
    pub title: ViewTitle,
    /// Pages, in the order of the segmented control; empty for a view without pages.
    pub pages: fn(&State) -> Vec<PageEntry>,
    /// Controls in the header, laid out from right to left.
    pub tools: fn(&mut Ui, &State, &Palette, &mut Vec<Command>),
    /// Width for the tools \[pt\]; the title takes the rest.
    pub tools_width: f32,
    /// Computations needed in addition to the analysis of the current settings.
    pub needs: fn(&State) -> Vec<Need>,
    /// Content in the right panel below the verdict; `None` for the result and the constraint
    /// matrix.
    pub side: Option<SideUi>,
    /// Whether the page bar has the primary button, because the view has results that are not used.
    pub has_primary: fn(&State) -> bool,
    /// Responses in the figure on paper; empty if it shows all responses or none.
    pub figure_pairs: fn(&State) -> Vec<Pair>,
}

impl ViewContent {
    /// Empty view, on which the views' constants are based.
    const PLAIN: Self = Self {
        draw: |_, _, _, _| {},
        title: ViewTitle::None,
        pages: |_| Vec::new(),
        tools: |_, _, _, _| {},
        tools_width: 0.0,
        has_primary: |_| false,
        needs: |_| Vec::new(),
        side: None,
        figure_pairs: |_| Vec::new(),
    };
}

/// Page of a view, and the command that shows it.
#[derive(Clone, Debug)]
pub struct PageEntry {
    pub words: PageWords,
    pub is_shown: bool,
    pub command: Command,
}

impl PageEntry {
    fn new(page: ViewPage, is_shown: bool) -> Self {
        Self {
            words: page.words(),
            is_shown,
            command: DisplayCommand::ShowPage(page).into(),
        }
    }
}

/// Text in a view's header.
#[derive(Clone, Copy, Debug)]
pub enum ViewTitle {
    None,
    Condition,
    /// The response in focus, and the condition.
    ResponseAndCondition,
    /// The response in focus without the condition, for views that show all conditions.
    ResponseOnly,
    /// The given name, and the condition.
    NameAndCondition(&'static str),
    Words(fn(&State) -> String),
    /// A name, and additional text, which is cut first.
    Named(&'static str, fn(&State) -> String),
}

const BODE: ViewContent = ViewContent {
    draw: bode_view_ui,
    title: ViewTitle::ResponseAndCondition,
    figure_pairs: focused_pair,
    ..ViewContent::PLAIN
};

const ERROR: ViewContent = ViewContent {
    draw: error_view_ui,
    title: ViewTitle::ResponseAndCondition,
    tools: error_header_ui,
    tools_width: 160.0,
    figure_pairs: focused_pair,
    ..ViewContent::PLAIN
};

const OVERVIEW: ViewContent = ViewContent {
    draw: overview_view_ui,
    title: ViewTitle::Condition,
    pages: overview_pages,
    ..ViewContent::PLAIN
};

const ACROSS: ViewContent = ViewContent {
    draw: across_view_ui,
    title: ViewTitle::ResponseOnly,
    tools: across_header_ui,
    tools_width: 190.0,
    pages: across_pages,
    needs: |state| vec![Need::Across(across_job(state))],
    figure_pairs: focused_pair,
    ..ViewContent::PLAIN
};

const POLES: ViewContent = ViewContent {
    draw: poles_view_ui,
    title: ViewTitle::Condition,
    pages: poles_pages,
    tools: |ui, state, _, commands| poles_header_ui(ui, state, commands),
    tools_width: 180.0,
    needs: modes_needs,
    ..ViewContent::PLAIN
};

const PHYSICS: ViewContent = ViewContent {
    draw: physics_view_ui,
    title: ViewTitle::Words(|_| "common to all conditions".to_owned()),
    pages: physics_pages,
    tools: physics_header_ui,
    tools_width: 240.0,
    side: Some(physics_evidence_ui),
    has_primary: |state| unused_named(state) > 0,
    needs: |state| vec![Need::Physics(physics_job(state))],
    ..ViewContent::PLAIN
};

const COUPLINGS: ViewContent = ViewContent {
    draw: couplings_view_ui,
    title: ViewTitle::Words(|_| "all conditions".to_owned()),
    pages: couplings_pages,
    tools: couplings_header_ui,
    tools_width: 220.0,
    needs: |state| vec![Need::Couplings(couplings_job(state))],
    ..ViewContent::PLAIN
};

const RECORDS: ViewContent = ViewContent {
    draw: records_view_ui,
    title: ViewTitle::NameAndCondition("Records"),
    tools: |ui, state, _, commands| records_header_ui(ui, state, commands),
    tools_width: 380.0,
    pages: records_pages,
    side: Some(records_side_ui),
    has_primary: |state| !state.unused_fits().is_empty(),
    needs: |state| {
        simulation_jobs(state)
            .into_iter()
            .map(Need::Simulation)
            .collect()
    },
    ..ViewContent::PLAIN
};

const CHANNELS: ViewContent = ViewContent {
    draw: channels_view_ui,
    title: ViewTitle::Words(|_| "inputs above outputs, on the same axis".to_owned()),
    pages: channels_pages,
    tools: channels_header_ui,
    tools_width: 240.0,
    ..ViewContent::PLAIN
};

const ASSESSMENT: ViewContent = ViewContent {
    draw: assessment_view_ui,
    title: ViewTitle::Words(|_| "change of J, condition by condition".to_owned()),
    pages: assessment_pages,
    tools: assessment_header_ui,
    tools_width: 500.0,
    needs: assessment_needs,
    figure_pairs: assessed_pairs,
    ..ViewContent::PLAIN
};

const EVIDENCE: ViewContent = ViewContent {
    draw: evidence_view_ui,
    title: ViewTitle::Words(|_| "net gains at equal airspeed".to_owned()),
    pages: evidence_pages,
    figure_pairs: |state| state.dataset().measuring_pairs().marked().collect(),
    ..ViewContent::PLAIN
};

const COMPARE: ViewContent = ViewContent {
    draw: compare_view_ui,
    title: ViewTitle::Words(|_| "variants against the current decisions".to_owned()),
    pages: compare_pages,
    needs: |state| variant_jobs(state).into_iter().map(Need::Variant).collect(),
    ..ViewContent::PLAIN
};

const REQUIREMENTS: ViewContent = ViewContent {
    draw: requirements_view_ui,
    title: ViewTitle::Named("Requirements", requirements_words),
    tools: requirements_tools_ui,
    tools_width: 290.0,
    needs: requirements_needs,
    ..ViewContent::PLAIN
};

const LEADS: ViewContent = ViewContent {
    draw: leads_view_ui,
    title: ViewTitle::ResponseAndCondition,
    figure_pairs: focused_pair,
    ..ViewContent::PLAIN
};

const NET_GAIN: ViewContent = ViewContent {
    draw: net_gain_view_ui,
    title: ViewTitle::Words(net_gain_words),
    tools: net_gain_header_ui,
    tools_width: NET_GAIN_CONTROLS,
    figure_pairs: net_gain_pairs,
    ..ViewContent::PLAIN
};

const SCHEDULE_COST: ViewContent = ViewContent {
    draw: schedule_cost_view_ui,
    title: ViewTitle::Words(schedule_cost_words),
    tools: |ui, state, _, commands| {
        error_bars_switch_ui(ui, state, "error bars of the schedule cost", commands);
    },
    tools_width: 60.0,
    figure_pairs: focused_pair,
    ..ViewContent::PLAIN
};

fn focused_pair(state: &State) -> Vec<Pair> {
    vec![state.display.selection.pair]
}

fn modes_needs(state: &State) -> Vec<Need> {
    match state.dataset().condition(state.condition().id()) {
        Some(condition) => vec![Need::Modes(ModesJob {
            condition: Arc::clone(condition).into(),
        })],
        None => Vec::new(),
    }
}

/// Returns the job that assesses the newest analysis; none without an analysis, or while a setting
/// is dragged.
fn assessment_needs(state: &State) -> Vec<Need> {
    if state.is_setting_dragged() {
        return Vec::new();
    }
    match current_analysis(state) {
        Some(analysis) => vec![Need::Assessment(AssessmentJob {
            analysis: analysis.into(),
            choice: state.assessment_choice(),
        })],
        None => Vec::new(),
    }
}
