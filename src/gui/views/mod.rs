//! Views between the side panels, each with its header. A single list holds all views with their
//! contents, commands and needs.

use std::sync::Arc;

use egui::Ui;

use gdcm_model::dataset::Pair;
use gdcm_study::jobs::analysis_jobs::AssessmentJob;
use gdcm_study::jobs::curve_jobs::ModesJob;

use super::commands::command::Command;
use super::state::window_state::State;
use super::widgets::palette::Palette;
pub mod assembling;
pub mod assessment;
pub mod bode;
pub mod channels;
pub mod compare;
pub mod couplings;
pub mod evidence;
pub mod figure_button;
pub mod figures;
pub(in crate::gui) mod frequency;
pub mod gain_plots;
pub mod histories;
pub mod leads;
pub mod need;
pub mod net_gain;
pub mod over_time;
pub mod poles;
pub mod records;
pub mod requirement_limits;
pub mod requirements;
pub mod setting_controls;

use crate::gui::state::view::View;
use assessment::{assessed_pairs, assessment_header_ui, assessment_view_ui};
use bode::{
    across_header_ui, across_job, across_view_ui, bode_view_ui, error_header_ui, error_view_ui,
    overview_view_ui,
};
use channels::{channels_header_ui, channels_view_ui};
use compare::{compare_view_ui, variant_jobs};
use couplings::{couplings_header_ui, couplings_view_ui};
use evidence::evidence_view_ui;
use gain_plots::net_gain_pairs;
use leads::leads_view_ui;
use need::Need;
use net_gain::{NET_GAIN_CONTROLS, net_gain_header_ui, net_gain_view_ui, net_gain_words};
use over_time::current;
use poles::{poles_header_ui, poles_view_ui};
use requirements::{
    NO_QUALIFICATION, requirements_header_ui, requirements_needs, requirements_view_ui,
};

pub use compare::overlay_job;
pub use couplings::{are_couplings_judged, couplings_job, offered_couplings, used_couplings};

/// Returns the content of a view: drawing, background jobs and figures.
pub fn view_content(view: View) -> ViewContent {
    match view {
        View::Bode => ViewContent {
            draw: bode_view_ui,
            title: ViewTitle::Response,
            figure_pairs: |state| vec![state.display.selection.pair],
            ..ViewContent::PLAIN
        },
        View::Error => ViewContent {
            draw: error_view_ui,
            title: ViewTitle::Response,
            tools: |ui, state, _, commands| error_header_ui(ui, state, commands),
            tools_width: 160.0,
            figure_pairs: |state| vec![state.display.selection.pair],
            ..ViewContent::PLAIN
        },
        View::Overview => ViewContent {
            draw: overview_view_ui,
            title: ViewTitle::Condition,
            ..ViewContent::PLAIN
        },
        View::Across => ViewContent {
            draw: across_view_ui,
            title: ViewTitle::Focus,
            tools: across_header_ui,
            tools_width: 330.0,
            needs: |state| vec![Need::Across(across_job(state))],
            figure_pairs: |state| vec![state.display.selection.pair],
            ..ViewContent::PLAIN
        },
        View::Poles => ViewContent {
            draw: poles_view_ui,
            title: ViewTitle::Condition,
            tools: |ui, state, _, commands| poles_header_ui(ui, state, commands),
            tools_width: 180.0,
            needs: |state| {
                let condition = state.dataset().condition(state.condition().id());
                condition
                    .map(|of| {
                        Need::Modes(ModesJob {
                            condition: Arc::clone(of).into(),
                        })
                    })
                    .into_iter()
                    .collect()
            },
            ..ViewContent::PLAIN
        },
        View::Couplings => ViewContent {
            draw: couplings_view_ui,
            title: ViewTitle::Condition,
            tools: |ui, state, _, commands| couplings_header_ui(ui, state, commands),
            tools_width: 220.0,
            needs: |state| vec![Need::Couplings(couplings_job(state))],
            ..ViewContent::PLAIN
        },
        View::Records => ViewContent {
            draw: self::records::records_view_ui,
            title: ViewTitle::Condition,
            tools: |ui, state, _, commands| self::records::records_header_ui(ui, state, commands),
            tools_width: 380.0,
            needs: |state| {
                self::records::simulation_jobs(state)
                    .into_iter()
                    .map(Need::Simulation)
                    .collect()
            },
            ..ViewContent::PLAIN
        },
        View::Channels => ViewContent {
            draw: channels_view_ui,
            tools: |ui, state, _, commands| channels_header_ui(ui, state, commands),
            tools_width: 410.0,
            ..ViewContent::PLAIN
        },
        View::Assessment => ViewContent {
            draw: assessment_view_ui,
            tools: |ui, state, _, commands| assessment_header_ui(ui, state, commands),
            tools_width: 640.0,
            needs: |state| {
                let choice = state.assessment_choice();
                let job = current(state).map(|analysis| AssessmentJob {
                    analysis: analysis.into(),
                    choice,
                });
                job.map(Need::Assessment).into_iter().collect()
            },
            figure_pairs: assessed_pairs,
            ..ViewContent::PLAIN
        },
        // The figure button is in the first line of the view, so the view has no tools.
        View::Evidence => ViewContent {
            draw: evidence_view_ui,
            figure_pairs: |state| state.dataset().measuring_pairs().marked().collect(),
            ..ViewContent::PLAIN
        },
        View::Compare => ViewContent {
            draw: compare_view_ui,
            needs: |state| variant_jobs(state).into_iter().map(Need::Variant).collect(),
            ..ViewContent::PLAIN
        },
        View::Requirements => ViewContent {
            draw: requirements_view_ui,
            title: ViewTitle::Words(|_| NO_QUALIFICATION.to_owned()),
            tools: |ui, state, _, commands| requirements_header_ui(ui, state, commands),
            tools_width: 270.0,
            needs: requirements_needs,
            ..ViewContent::PLAIN
        },
        View::Leads => ViewContent {
            draw: leads_view_ui,
            title: ViewTitle::Response,
            figure_pairs: |state| vec![state.display.selection.pair],
            ..ViewContent::PLAIN
        },
        View::NetGain => ViewContent {
            draw: net_gain_view_ui,
            title: ViewTitle::Words(net_gain_words),
            tools: net_gain_header_ui,
            tools_width: NET_GAIN_CONTROLS,
            figure_pairs: net_gain_pairs,
            ..ViewContent::PLAIN
        },
    }
}

/// Content of a view.
#[derive(Clone, Copy)]
pub struct ViewContent {
    pub draw: fn(&mut Ui, &mut State, &Palette, &mut Vec<Command>),
    /// Additional text of the header.
    pub title: ViewTitle,
    /// Controls in the header, laid out from right to left.
    pub tools: fn(&mut Ui, &State, &Palette, &mut Vec<Command>),
    /// Width of the tools \[pt\]; the title takes the rest.
    pub tools_width: f32,
    /// Computations needed besides the live answer.
    pub needs: fn(&State) -> Vec<Need>,
    /// Responses in the figure on paper; empty for a figure of all responses or of none.
    pub figure_pairs: fn(&State) -> Vec<Pair>,
}

impl ViewContent {
    /// View without content, tools and needs.
    const PLAIN: Self = Self {
        draw: |_, _, _, _| {},
        title: ViewTitle::None,
        tools: |_, _, _, _| {},
        tools_width: 0.0,
        needs: |_| Vec::new(),
        figure_pairs: |_| Vec::new(),
    };
}

/// Text in the header of a view.
#[derive(Clone, Copy, Debug)]
pub enum ViewTitle {
    None,
    /// The condition.
    Condition,
    /// The response in focus, and the condition.
    Response,
    /// The response in focus.
    Focus,
    Words(fn(&State) -> String),
}
