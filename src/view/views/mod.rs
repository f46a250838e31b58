//! The plots between the side panels, each with its header: what is drawn, and which commands its events stand for. Which there are,
//! and what each needs, stands in one list.

use std::sync::Arc;

use egui::Ui;
use serde::{Deserialize, Serialize};

use gdcm_model::dataset::Pair;
use gdcm_plot::figure::FigureKind;
use gdcm_study::study::PhaseCorrection;
use gdcm_study::study::assessment_table::AssessmentJob;
use gdcm_study::study::condition_answers::{RecordHistoryJob, TestAnswersJob};
use gdcm_study::study::couplings_assessment::CouplingsJob;
use gdcm_study::study::job::{AcrossJob, ModesJob, SimulationJob, VariantJob};
use gdcm_study::study::requirements_tables::RequirementsJob;
use gdcm_study::study::time_histories::TimeHistoriesJob;

use super::command::Command;
use super::display::ViewGroup;
use super::palette::Palette;
use super::state::State;

pub mod assessment;
pub mod bode;
pub mod channels;
pub mod compare;
pub mod couplings;
pub mod evidence;
pub(in crate::view) mod frequency;
pub mod histories;
pub mod leads;
pub mod net_gain;
pub mod poles;
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

/// One of the plots between the side panels.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize)]
pub enum View {
    /// The focused response: magnitude and phase.
    Bode,
    /// What the fit sees of it.
    Error,
    /// Every response, small.
    Overview,
    /// One response in every condition.
    Across,
    /// Poles and modes of every model of the condition.
    Poles,
    /// What mixes the inputs and feeds outputs back (M16).
    Couplings,
    /// Channel gains against airspeed (Figures 3 and 4).
    Channels,
    /// What the correction is worth (Figures 8 to 19).
    Assessment,
    /// What the scatter of the gains is made of, and what speaks for the schedule.
    Evidence,
    /// Decisions kept under names, beside the present ones.
    Compare,
    /// What a qualification asks: bandwidth, modes, summary (M17).
    Requirements,
    /// Net gains against airspeed (Figures 6 and 7).
    NetGain,
    /// What delay or lead does in each channel, to ten times the band, and its price.
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

    /// Those that the dock may show: that of leads where these are asked for.
    pub fn docked(state: &State) -> impl Iterator<Item = Self> {
        let has_leads = state.study.settings.phase == PhaseCorrection::Lead;
        Self::ALL
            .into_iter()
            .filter(move |view| view.kind().is_docked && (*view != Self::Leads || has_leads))
    }

    /// What its tab says.
    pub fn name(self) -> &'static str {
        self.kind().name
    }

    /// Which figure it is on paper, where it is one.
    pub fn figure(self) -> Option<FigureKind> {
        Some(self.kind().figure?.kind)
    }

    /// All that the window knows of it: tabs, menus, the palette, background jobs and figures read this list.
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
                draw: super::records::records_view_ui,
                group: ViewGroup::Models,
                takes_dock: true,
                title: ViewTitle::Condition,
                tools: |ui, state, _, commands| {
                    super::records::records_header_ui(ui, state, commands)
                },
                tools_width: 380.0,
                needs: |state| {
                    super::records::simulation_jobs(state)
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
            // The button of its figure stands in its first line: it has no tools.
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

/// One kind of view: what it shows, which background results it needs, and its tools.
#[derive(Clone, Copy)]
pub struct ViewKind {
    /// What its tab says.
    pub name: &'static str,
    /// What it shows, in a sentence.
    pub purpose: &'static str,
    /// Draws it.
    pub draw: fn(&mut Ui, &mut State, &Palette, &mut Vec<Command>),
    /// What its header says besides.
    pub title: ViewTitle,
    /// The controls in its header, laid out from right to left.
    pub tools: fn(&mut Ui, &State, &Palette, &mut Vec<Command>),
    /// The width that they need \[pt\]; the title takes what is left.
    pub tools_width: f32,
    /// What has to be computed for it beside the live answer.
    pub needs: fn(&State) -> Vec<Need>,
    /// Whether it shows results of every condition: it is said where those are of older settings.
    pub is_of_all_conditions: bool,
    /// The group that it stands in.
    pub group: ViewGroup,
    /// Whether the dock may show it.
    pub is_docked: bool,
    /// Whether it takes the room of the dock.
    pub takes_dock: bool,
    /// What its heading in the dock says, where that is more than its tab does.
    pub long_name: Option<&'static str>,
    /// What it is on paper. Variants are tables, which are saved as such; of records what is identified is saved.
    pub figure: Option<ViewFigure>,
}

impl ViewKind {
    /// One that shows nothing, has no tools and needs nothing.
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

/// A view on paper.
#[derive(Clone, Copy)]
pub struct ViewFigure {
    /// Which figure it is.
    pub kind: FigureKind,
    /// The responses that it is of; none of a figure that is of all or of no response.
    pub pairs: fn(&State) -> Vec<Pair>,
}

impl ViewFigure {
    /// Of the response in focus.
    fn of_focus(kind: FigureKind) -> Self {
        Self {
            kind,
            pairs: |state| vec![state.display.pair],
        }
    }

    /// Of all responses, or of none.
    fn of_all(kind: FigureKind) -> Self {
        Self {
            kind,
            pairs: |_| Vec::new(),
        }
    }
}

/// What the header of a view says of what is shown.
#[derive(Clone, Copy, Debug)]
pub enum ViewTitle {
    /// Nothing.
    None,
    /// The condition.
    Condition,
    /// The response in focus, and the condition.
    Response,
    /// The response in focus.
    Focus,
    /// These words.
    Words(fn(&State) -> String),
}

/// What a view has to have computed beside the live answer.
#[derive(Clone, Debug, PartialEq)]
pub enum Need {
    /// Modes of the models of the condition.
    Modes(ModesJob),
    /// An assessment.
    Assessment(AssessmentJob),
    /// One model of each condition.
    Across(AcrossJob),
    /// The analysis of a variant.
    Variant(VariantJob),
    /// A model against a record in time.
    Simulation(SimulationJob),
    /// What couplings do.
    Couplings(CouplingsJob),
    /// What a qualification asks.
    Requirements(RequirementsJob),
    /// What models answer to the test input.
    TestAnswers(TestAnswersJob),
    /// What they answer to a flight record.
    RecordHistory(RecordHistoryJob),
    /// What they answer to all of them.
    TimeHistories(TimeHistoriesJob),
}
