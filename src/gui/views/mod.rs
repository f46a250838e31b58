//! Views between the side panels, each with its header. A single list holds all views with their
//! contents, commands and needs.

use std::sync::Arc;

use egui::Ui;
use serde::{Deserialize, Serialize};

use gdcm_model::dataset::Pair;
use gdcm_plot::figure::FigureKind;
use gdcm_study::PhaseCorrection;
use gdcm_study::jobs::analysis_jobs::AssessmentJob;
use gdcm_study::jobs::analysis_jobs::CouplingsJob;
use gdcm_study::jobs::analysis_jobs::VariantJob;
use gdcm_study::jobs::curve_jobs::{AcrossJob, ModesJob};
use gdcm_study::jobs::identification_jobs::SimulationJob;
use gdcm_study::jobs::requirement_jobs::RequirementsJob;
use gdcm_study::jobs::requirement_jobs::TimeHistoriesJob;
use gdcm_study::jobs::requirement_jobs::{RecordHistoryJob, TestAnswersJob};

use super::commands::command::Command;
use super::state::display::ViewGroup;
use super::state::window_state::State;
use super::widgets::palette::Palette;

pub mod assembling;
pub mod assessment;
pub mod bode;
pub mod channels;
pub mod compare;
pub mod couplings;
pub mod evidence;
pub(in crate::gui) mod frequency;
pub mod histories;
pub mod leads;
pub mod net_gain;
pub mod poles;
pub mod records;
pub mod requirement_limits;
pub mod requirements;

pub use assessment::{AssessedFigures, assessment_choice};
pub use compare::overlay_job;
pub use couplings::{
    are_couplings_judged, assessed_correction, couplings_job, offered_couplings, used_couplings,
};
pub use net_gain::PairSet;
pub use requirements::{RequirementsPage, all_records, known_poles};

use assessment::{assessed_pairs, assessment_header_ui, assessment_view_ui};
use bode::{
    across_header_ui, across_job, across_view_ui, bode_view_ui, error_header_ui, error_view_ui,
    overview_view_ui,
};
use channels::{channels_header_ui, channels_view_ui};
use compare::{compare_view_ui, variant_jobs};
use couplings::{couplings_header_ui, couplings_view_ui};
use evidence::evidence_view_ui;
use histories::current;
use leads::leads_view_ui;
use net_gain::{
    NET_GAIN_CONTROLS, net_gain_header_ui, net_gain_pairs, net_gain_view_ui, net_gain_words,
};
use poles::{poles_header_ui, poles_view_ui};
use requirements::{
    NO_QUALIFICATION, requirements_header_ui, requirements_needs, requirements_view_ui,
};

/// Plot between the side panels.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize)]
pub enum View {
    /// Response in focus: magnitude and phase.
    Bode,
    /// Its errors as used by the fit.
    Error,
    /// Every response, small.
    Overview,
    /// A response in every condition.
    Across,
    /// Poles and modes of every model of the condition.
    Poles,
    /// Input mixing and output feedback (M16).
    Couplings,
    /// Channel gains over airspeed (Figures 3 and 4).
    Channels,
    /// Benefit of the correction (Figures 8 to 19).
    Assessment,
    /// Sources of the scatter of the gains, and the evidence for the schedule.
    Evidence,
    /// Variants, compared with the present decisions.
    Compare,
    /// Questions of a qualification: bandwidth, modes, summary (M17).
    Requirements,
    /// Net gains over airspeed (Figures 6 and 7).
    NetGain,
    /// Effect of delay or lead in each channel, up to ten times the band, and its price.
    Leads,
    /// Flight records of the condition, and models identified from them.
    Records,
}

impl View {
    /// Every view, in the order of the menu.
    pub const ALL: [Self; 14] = [
        Self::Bode,
        Self::Error,
        Self::Overview,
        Self::Across,
        Self::Poles,
        Self::Couplings,
        Self::Records,
        Self::NetGain,
        Self::Channels,
        Self::Leads,
        Self::Evidence,
        Self::Assessment,
        Self::Compare,
        Self::Requirements,
    ];

    /// Returns the views that the dock can show, with the leads only if these are requested.
    pub fn docked(state: &State) -> impl Iterator<Item = Self> {
        let has_leads = state.study.settings.phase == PhaseCorrection::Lead;
        Self::ALL
            .into_iter()
            .filter(move |view| view.kind().is_docked && (*view != Self::Leads || has_leads))
    }

    /// Returns the text of the tab.
    pub fn name(self) -> &'static str {
        self.kind().name
    }

    /// Returns the kind of the figure on paper, if there is one.
    pub fn figure(self) -> Option<FigureKind> {
        Some(self.kind().figure?.kind)
    }

    /// Returns the description of the view: the source of tabs, menus, the palette, background jobs
    /// and figures.
    pub fn kind(self) -> ViewKind {
        match self {
            Self::Bode => ViewKind {
                name: "Bode",
                purpose: "Magnitude and phase of the response in focus",
                draw: bode_view_ui,
                title: ViewTitle::Response,
                figure: Some(ViewFigure::of_focus(FigureKind::Bode)),
                ..ViewKind::PLAIN
            },
            Self::Error => ViewKind {
                name: "Error",
                purpose: "What the fit sees: the ratio and the phase difference of the response in focus, and G, D and bounds",
                draw: error_view_ui,
                title: ViewTitle::Response,
                tools: |ui, state, _, commands| error_header_ui(ui, state, commands),
                tools_width: 160.0,
                figure: Some(ViewFigure::of_focus(FigureKind::Error)),
                ..ViewKind::PLAIN
            },
            Self::Overview => ViewKind {
                name: "Overview",
                purpose: "Every response of the condition, small",
                draw: overview_view_ui,
                title: ViewTitle::Condition,
                figure: Some(ViewFigure::of_all(FigureKind::Overview)),
                ..ViewKind::PLAIN
            },
            Self::Across => ViewKind {
                name: "Airspeeds",
                purpose: "The response in focus in every condition, coloured by airspeed",
                draw: across_view_ui,
                title: ViewTitle::Focus,
                tools: across_header_ui,
                tools_width: 330.0,
                needs: |state| vec![Need::Across(across_job(state))],
                figure: Some(ViewFigure::of_focus(FigureKind::Airspeeds)),
                ..ViewKind::PLAIN
            },
            Self::Poles => ViewKind {
                name: "Poles",
                purpose: "Poles of every model of the condition in the s-plane, and the modes in a table",
                draw: poles_view_ui,
                group: ViewGroup::Models,
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
                figure: Some(ViewFigure::of_all(FigureKind::Poles)),
                ..ViewKind::PLAIN
            },
            Self::Couplings => ViewKind {
                name: "Couplings",
                purpose: "What mixes the inputs and feeds outputs back, what that is worth, and what it does to the loop",
                draw: couplings_view_ui,
                group: ViewGroup::Models,
                takes_dock: true,
                title: ViewTitle::Condition,
                tools: |ui, state, _, commands| couplings_header_ui(ui, state, commands),
                tools_width: 220.0,
                is_of_all_conditions: true,
                needs: |state| vec![Need::Couplings(couplings_job(state))],
                figure: Some(ViewFigure::of_all(FigureKind::Couplings)),
                ..ViewKind::PLAIN
            },
            Self::Records => ViewKind {
                name: "Records",
                purpose: "Flight records of the condition, and models identified from them",
                draw: self::records::records_view_ui,
                group: ViewGroup::Models,
                takes_dock: true,
                title: ViewTitle::Condition,
                tools: |ui, state, _, commands| {
                    self::records::records_header_ui(ui, state, commands)
                },
                tools_width: 380.0,
                needs: |state| {
                    self::records::simulation_jobs(state)
                        .into_iter()
                        .map(Need::Simulation)
                        .collect()
                },
                ..ViewKind::PLAIN
            },
            Self::Channels => ViewKind {
                name: "Channels",
                purpose: "Gain of every channel against airspeed",
                draw: channels_view_ui,
                group: ViewGroup::Schedule,
                tools: |ui, state, _, commands| channels_header_ui(ui, state, commands),
                tools_width: 410.0,
                is_of_all_conditions: true,
                figure: Some(ViewFigure::of_all(FigureKind::Channels)),
                ..ViewKind::PLAIN
            },
            Self::Assessment => ViewKind {
                name: "Assessment",
                purpose: "What the correction is worth, condition by condition",
                draw: assessment_view_ui,
                group: ViewGroup::Judge,
                tools: |ui, state, _, commands| assessment_header_ui(ui, state, commands),
                tools_width: 640.0,
                is_of_all_conditions: true,
                needs: |state| {
                    let choice = assessment_choice(state);
                    let job = current(state).map(|analysis| AssessmentJob {
                        analysis: analysis.into(),
                        choice,
                    });
                    job.map(Need::Assessment).into_iter().collect()
                },
                figure: Some(ViewFigure {
                    kind: FigureKind::Assessment,
                    pairs: assessed_pairs,
                }),
                ..ViewKind::PLAIN
            },
            // The figure button is in the first line of the view, so the view has no tools.
            Self::Evidence => ViewKind {
                name: "Evidence",
                purpose: "What the scatter of the net gains is made of, which differences are significant, and what the schedule needs",
                draw: evidence_view_ui,
                group: ViewGroup::Schedule,
                takes_dock: true,
                is_of_all_conditions: true,
                figure: Some(ViewFigure {
                    kind: FigureKind::Evidence,
                    pairs: |state| state.dataset().measuring_pairs().marked().collect(),
                }),
                ..ViewKind::PLAIN
            },
            Self::Compare => ViewKind {
                name: "Compare",
                purpose: "Variants: decisions kept under names, beside the present ones",
                draw: compare_view_ui,
                group: ViewGroup::Judge,
                needs: |state| variant_jobs(state).into_iter().map(Need::Variant).collect(),
                ..ViewKind::PLAIN
            },
            Self::Requirements => ViewKind {
                name: "Requirements",
                purpose: "What a qualification asks of the models: bandwidth and phase delay, modes, summary costs",
                draw: requirements_view_ui,
                group: ViewGroup::Judge,
                takes_dock: true,
                title: ViewTitle::Words(|_| NO_QUALIFICATION.to_owned()),
                tools: |ui, state, _, commands| requirements_header_ui(ui, state, commands),
                tools_width: 270.0,
                is_of_all_conditions: true,
                needs: requirements_needs,
                figure: Some(ViewFigure::of_all(FigureKind::Requirements)),
                ..ViewKind::PLAIN
            },
            Self::Leads => ViewKind {
                name: "Leads",
                purpose: "What leads do in each channel, and their price above the band",
                draw: leads_view_ui,
                group: ViewGroup::Schedule,
                is_docked: true,
                title: ViewTitle::Response,
                figure: Some(ViewFigure::of_focus(FigureKind::Leads)),
                ..ViewKind::PLAIN
            },
            Self::NetGain => ViewKind {
                name: "Net gain",
                purpose: "Net gain of the held responses against airspeed, with the schedule",
                draw: net_gain_view_ui,
                group: ViewGroup::Schedule,
                is_docked: true,
                long_name: Some("Net gain over airspeed"),
                title: ViewTitle::Words(net_gain_words),
                tools: net_gain_header_ui,
                tools_width: NET_GAIN_CONTROLS,
                is_of_all_conditions: true,
                figure: Some(ViewFigure {
                    kind: FigureKind::NetGain,
                    pairs: net_gain_pairs,
                }),
                ..ViewKind::PLAIN
            },
        }
    }
}

/// Description of a view: its content, the background results it needs, and its tools.
#[derive(Clone, Copy)]
pub struct ViewKind {
    /// Text of the tab.
    pub name: &'static str,
    /// Purpose, in a sentence.
    pub purpose: &'static str,
    pub draw: fn(&mut Ui, &mut State, &Palette, &mut Vec<Command>),
    /// Additional text of the header.
    pub title: ViewTitle,
    /// Controls in the header, laid out from right to left.
    pub tools: fn(&mut Ui, &State, &Palette, &mut Vec<Command>),
    /// Width of the tools \[pt\]; the title takes the rest.
    pub tools_width: f32,
    /// Computations needed besides the live answer.
    pub needs: fn(&State) -> Vec<Need>,
    /// Whether the view shows results of every condition; it then reports results of older
    /// settings.
    pub is_of_all_conditions: bool,
    pub group: ViewGroup,
    pub is_docked: bool,
    /// Whether it takes the room of the dock.
    pub takes_dock: bool,
    /// Heading in the dock, if longer than the text of the tab.
    pub long_name: Option<&'static str>,
    /// Figure on paper. Variants are tables and are saved as such; for records, the identified
    /// models are saved.
    pub figure: Option<ViewFigure>,
}

impl ViewKind {
    /// View without content, tools and needs.
    const PLAIN: Self = Self {
        name: "",
        purpose: "",
        draw: |_, _, _, _| {},
        title: ViewTitle::None,
        tools: |_, _, _, _| {},
        tools_width: 0.0,
        needs: |_| Vec::new(),
        is_of_all_conditions: false,
        group: ViewGroup::Response,
        is_docked: false,
        takes_dock: false,
        long_name: None,
        figure: None,
    };
}

/// Figure of a view on paper.
#[derive(Clone, Copy)]
pub struct ViewFigure {
    pub kind: FigureKind,
    /// Responses in the figure; empty for a figure of all responses or of none.
    pub pairs: fn(&State) -> Vec<Pair>,
}

impl ViewFigure {
    /// Figure of the response in focus.
    fn of_focus(kind: FigureKind) -> Self {
        Self {
            kind,
            pairs: |state| vec![state.display.pair],
        }
    }

    /// Figure of all responses, or of none.
    fn of_all(kind: FigureKind) -> Self {
        Self {
            kind,
            pairs: |_| Vec::new(),
        }
    }
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

/// Computation needed by a view besides the live answer.
#[derive(Clone, Debug, PartialEq)]
pub enum Need {
    /// Modes of the condition's models.
    Modes(ModesJob),
    Assessment(AssessmentJob),
    /// A model of each condition.
    Across(AcrossJob),
    /// Analysis of a variant.
    Variant(VariantJob),
    /// Comparison of a model with a record in time.
    Simulation(SimulationJob),
    /// Effect of couplings.
    Couplings(CouplingsJob),
    Requirements(RequirementsJob),
    /// Models' responses to the test input.
    TestAnswers(TestAnswersJob),
    /// Models' responses to a flight record.
    RecordHistory(RecordHistoryJob),
    /// Models' responses to all flight records.
    TimeHistories(TimeHistoriesJob),
}
