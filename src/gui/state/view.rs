//! Views between the side panels: their groups, and for each view a row with name, purpose and
//! properties.
//!
//! Views with a group are in the view bar; the others are pages of the dock, the area below the
//! views. M16: docs/couplings.md, M17: docs/requirements.md, M18: docs/physics.md; figures are
//! numbered as in the paper (docs/figures.md).

use serde::{Deserialize, Serialize};

use gdcm_plot::figure::FigureKind;
use gdcm_study::PhaseCorrection;

/// Views on the same subject.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
pub enum ViewGroup {
    /// Responses over frequency.
    #[default]
    Response,
    /// Models and the data behind them.
    Models,
    /// Quantities over airspeed.
    Schedule,
    /// Benefit of the correction.
    Judge,
}

impl ViewGroup {
    /// Every group, from left to right.
    pub const ALL: [Self; 4] = [Self::Response, Self::Models, Self::Schedule, Self::Judge];

    /// Returns the button text.
    pub fn name(self) -> &'static str {
        match self {
            Self::Response => "Response",
            Self::Models => "Models",
            Self::Schedule => "Schedule",
            Self::Judge => "Judge",
        }
    }

    /// Returns the group's views, from left to right.
    pub fn views(self) -> impl Iterator<Item = View> {
        View::ALL
            .into_iter()
            .filter(move |view| view.facts().group == Some(self))
    }
}

/// Content shown between the side panels.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize)]
pub enum View {
    /// Response in focus: magnitude and phase.
    Bode,
    /// The models' magnitude ratio and phase difference in the response in focus, as used by the
    /// fit.
    Error,
    /// Every response, in small plots.
    Overview,
    /// The response in focus, in every condition.
    Across,
    /// Every model's poles and modes in the condition.
    Poles,
    /// Named physics parameters: which would have to move, and by how much (M18).
    Physics,
    /// Input mixing and output feedback (M16).
    Couplings,
    /// Channel gains or delays over airspeed (Figures 3 and 4).
    Channels,
    /// Benefit of the correction (Figures 8 to 19).
    Assessment,
    /// Sources of scatter in the gains, and the evidence for the schedule.
    Evidence,
    /// Variants, compared with the current decisions.
    Compare,
    /// Qualification requirements: bandwidth, time histories, modes, summary (M17).
    Requirements,
    /// Net gains over airspeed (Figures 6 and 7).
    NetGain,
    /// Phase change by delay or lead in each channel, and the gain that leads add above the band,
    /// up to ten times the band's upper end.
    Leads,
    /// Net gain over airspeed for the response in focus, and its J before the correction, at each
    /// optimum and under the schedule.
    ScheduleCost,
    /// Flight records in the condition, and models identified from them.
    Records,
}

impl View {
    /// Every view, in menu order.
    pub const ALL: [Self; 16] = [
        Self::Bode,
        Self::Error,
        Self::Overview,
        Self::Across,
        Self::Records,
        Self::Physics,
        Self::Couplings,
        Self::Poles,
        Self::NetGain,
        Self::ScheduleCost,
        Self::Channels,
        Self::Leads,
        Self::Evidence,
        Self::Requirements,
        Self::Assessment,
        Self::Compare,
    ];

    /// Returns the dock's pages; the leads only if the study requests them.
    pub fn docked(phase: PhaseCorrection) -> impl Iterator<Item = Self> {
        let has_leads = phase == PhaseCorrection::Lead;
        Self::ALL
            .into_iter()
            .filter(move |view| view.is_dock_page() && (*view != Self::Leads || has_leads))
    }

    /// Returns whether the view is a page in the dock, and therefore absent from the view bar.
    pub fn is_dock_page(self) -> bool {
        self.facts().group.is_none()
    }

    /// Returns the tab text.
    pub fn name(self) -> &'static str {
        self.facts().name
    }

    /// Returns which figure the view exports, if any.
    pub fn figure(self) -> Option<FigureKind> {
        self.facts().figure
    }
}

/// Returns the views that have a figure.
pub fn views_with_figure() -> impl Iterator<Item = View> {
    View::ALL.into_iter().filter(|view| view.figure().is_some())
}

/// View properties that do not depend on the study.
#[derive(Clone, Copy, Debug)]
pub struct ViewFacts {
    /// Tab text.
    pub name: &'static str,
    /// Purpose, in a sentence.
    pub purpose: &'static str,
    /// Whether the view shows results from every condition. Such a view displays a notice while its
    /// results belong to older settings.
    pub is_of_all_conditions: bool,
    /// Group in the view bar; `None` for pages in the dock.
    pub group: Option<ViewGroup>,
    /// Whether the dock is hidden while this view is in front.
    pub takes_dock: bool,
    /// Kind of exported figure; `None` for the Records and Compare views, which have none.
    pub figure: Option<FigureKind>,
}

impl ViewFacts {
    /// Default properties, in the first group; name and purpose must be added.
    const PLAIN: Self = Self {
        name: "",
        purpose: "",
        is_of_all_conditions: false,
        group: Some(ViewGroup::Response),
        takes_dock: false,
        figure: None,
    };
}

impl View {
    /// Returns the view's properties, from which tabs, menus and the palette are built.
    pub fn facts(self) -> ViewFacts {
        match self {
            Self::Bode => BODE,
            Self::Error => ERROR,
            Self::Overview => OVERVIEW,
            Self::Across => ACROSS,
            Self::Poles => POLES,
            Self::Physics => PHYSICS,
            Self::Couplings => COUPLINGS,
            Self::Records => RECORDS,
            Self::NetGain => NET_GAIN,
            Self::ScheduleCost => SCHEDULE_COST,
            Self::Channels => CHANNELS,
            Self::Leads => LEADS,
            Self::Evidence => EVIDENCE,
            Self::Assessment => ASSESSMENT,
            Self::Compare => COMPARE,
            Self::Requirements => REQUIREMENTS,
        }
    }
}

const BODE: ViewFacts = ViewFacts {
    name: "Bode",
    purpose: "Magnitude and phase of the response in focus",
    figure: Some(FigureKind::Bode),
    ..ViewFacts::PLAIN
};

const ERROR: ViewFacts = ViewFacts {
    name: "Error",
    purpose: "Magnitude ratio and phase difference between identified and physics \
                    models in the response in focus, with G, D and bounds",
    figure: Some(FigureKind::Error),
    ..ViewFacts::PLAIN
};

const OVERVIEW: ViewFacts = ViewFacts {
    name: "Overview",
    purpose: "Small plots of all responses of the condition",
    figure: Some(FigureKind::Overview),
    ..ViewFacts::PLAIN
};

const ACROSS: ViewFacts = ViewFacts {
    name: "Airspeeds",
    purpose: "The response in focus in every condition, coloured by airspeed",
    figure: Some(FigureKind::Airspeeds),
    ..ViewFacts::PLAIN
};

const POLES: ViewFacts = ViewFacts {
    name: "Poles",
    purpose: "Poles of every model of the condition in the s-plane, and the modes in a table",
    group: Some(ViewGroup::Models),
    figure: Some(FigureKind::Poles),
    ..ViewFacts::PLAIN
};

const PHYSICS: ViewFacts = ViewFacts {
    name: "Physics",
    purpose: "Changes of named physics parameters that make the physics models agree with flight",
    group: Some(ViewGroup::Models),
    takes_dock: true,
    is_of_all_conditions: true,
    figure: Some(FigureKind::Physics),
};

const COUPLINGS: ViewFacts = ViewFacts {
    name: "Couplings",
    purpose: "Input mixing and output feedback, their benefit, and their effect on the loop",
    group: Some(ViewGroup::Models),
    takes_dock: true,
    is_of_all_conditions: true,
    figure: Some(FigureKind::Couplings),
};

const RECORDS: ViewFacts = ViewFacts {
    name: "Records",
    purpose: "Flight records of the condition, and models identified from them",
    group: Some(ViewGroup::Models),
    takes_dock: true,
    ..ViewFacts::PLAIN
};

const NET_GAIN: ViewFacts = ViewFacts {
    name: "Net gain",
    purpose: "Net gain of the selected responses over airspeed, with the schedule",
    group: None,
    is_of_all_conditions: true,
    figure: Some(FigureKind::NetGain),
    ..ViewFacts::PLAIN
};

const SCHEDULE_COST: ViewFacts = ViewFacts {
    name: "Schedule cost",
    purpose: "Net gain of the response in focus over airspeed, and its J before the correction, \
              at the optimum of each condition and under the schedule",
    group: None,
    is_of_all_conditions: true,
    figure: Some(FigureKind::ScheduleCost),
    ..ViewFacts::PLAIN
};

const CHANNELS: ViewFacts = ViewFacts {
    name: "Channels",
    purpose: "Gain or delay of every channel over airspeed",
    group: Some(ViewGroup::Schedule),
    takes_dock: true,
    is_of_all_conditions: true,
    figure: Some(FigureKind::Channels),
};

const LEADS: ViewFacts = ViewFacts {
    name: "Leads",
    purpose: "Effect of the leads in each channel, and the gain that they add above \
                    the band",
    group: None,
    figure: Some(FigureKind::Leads),
    ..ViewFacts::PLAIN
};

const EVIDENCE: ViewFacts = ViewFacts {
    name: "Evidence",
    purpose: "Net gains: sources of their scatter, significant differences at equal airspeed, \
        and variables that the schedule needs",
    group: Some(ViewGroup::Schedule),
    takes_dock: true,
    is_of_all_conditions: true,
    figure: Some(FigureKind::Evidence),
};

const ASSESSMENT: ViewFacts = ViewFacts {
    name: "Assessment",
    purpose: "Benefit of the correction, condition by condition",
    group: Some(ViewGroup::Judge),
    is_of_all_conditions: true,
    figure: Some(FigureKind::Assessment),
    ..ViewFacts::PLAIN
};

const COMPARE: ViewFacts = ViewFacts {
    name: "Compare",
    purpose: "Variants (named sets of decisions) compared with the current decisions",
    group: Some(ViewGroup::Judge),
    ..ViewFacts::PLAIN
};

const REQUIREMENTS: ViewFacts = ViewFacts {
    name: "Requirements",
    purpose: "Requirements as in a qualification: bandwidth, phase delay and modes, \
                    with a summary of J",
    group: Some(ViewGroup::Judge),
    takes_dock: true,
    is_of_all_conditions: true,
    figure: Some(FigureKind::Requirements),
};
