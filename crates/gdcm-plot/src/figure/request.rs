//! Requests for figures, from the window and the command line, and the figure for each request.

use std::sync::Arc;

use gdcm_method::correction::Channel;
use gdcm_model::dataset::{ConditionId, ModelId, Pair};
use gdcm_model::progress::Unobserved;
use gdcm_study::jobs::across_role::AcrossRole;
use gdcm_study::jobs::curve_jobs::ConditionModes;
use gdcm_study::results::analysis::Analysis;
use gdcm_study::results::assessment_table::AssessmentChoice;
use gdcm_study::results::couplings_assessment::CouplingsAssessment;
use gdcm_study::results::physics_assessment::PhysicsAssessment;
use gdcm_study::results::record_history::RecordHistory;
use gdcm_study::results::requirements::Requirements;
use gdcm_study::results::test_input_responses::TestAnswers;

use super::airspeeds::airspeeds_figure;
use super::assessment::{assessment_figure, evidence_figure, usual_choice};
use super::bode::{BodeOptions, bode_figure, overview_figure};
use super::condition_source::ConditionSource;
use super::error::error_figure;
use super::figure::Figure;
use super::gains::{Across, GainAxes, Measure, channels_figure, net_gain_figure};
use super::leads::leads_figure;
use super::physics::physics_figure;
use super::physics_change::physics_change_figure;
use super::poles::{PoleContents, couplings_figure, poles_figure, zeros_of_model};
use super::requirements::{record_history_figure, requirements_figure, test_answers_figure};
use super::schedule_cost::schedule_cost_figure;

/// Maximum number of responses that [`FigureKind::PhysicsChange`] shows.
const CHANGED_RESPONSES: usize = 5;

/// Kinds of figure.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum FigureKind {
    /// Responses in a condition (Figures 2 and 5).
    #[default]
    Bode,
    /// Deviations between a condition's responses and the reference, as used by the fit.
    Error,
    /// Every response's magnitude in a condition: outputs in rows, inputs in columns.
    Overview,
    /// Net gains against airspeed (Figures 6 and 7).
    NetGain,
    /// Channel gains or delays (Figures 3 and 4).
    Channels,
    /// Contributions to the scatter of net gains.
    Evidence,
    /// Change in J due to the correction (Figures 8 to 19).
    Assessment,
    /// Every model's poles in a condition.
    Poles,
    /// Each channel's delay or lead in a condition, up to ten times the band's upper end.
    Leads,
    /// Effect that couplings have on the loop that they close, and on the poles in a condition.
    Couplings,
    /// A physics parameter in every condition, and the misfit that remains as parameters are added.
    Physics,
    /// Most improved responses and poles in a condition, with unchanged and with changed physics
    /// parameters.
    PhysicsChange,
    /// Phase delay over bandwidth for attitude responses, or model responses over time.
    Requirements,
    /// One response in every condition, coloured by airspeed, with the schedule's error.
    Airspeeds,
    /// A response's net gain over airspeed, and its J before the correction, at each condition's
    /// optimum and under the schedule.
    ScheduleCost,
}

impl FigureKind {
    pub const ALL: [Self; 15] = [
        Self::Bode,
        Self::Error,
        Self::Overview,
        Self::NetGain,
        Self::Channels,
        Self::Evidence,
        Self::Assessment,
        Self::Poles,
        Self::Leads,
        Self::Couplings,
        Self::Physics,
        Self::PhysicsChange,
        Self::Requirements,
        Self::Airspeeds,
        Self::ScheduleCost,
    ];

    /// Returns the name used in commands and file names.
    pub fn name(self) -> &'static str {
        match self {
            Self::Bode => "bode",
            Self::Error => "error",
            Self::Overview => "overview",
            Self::NetGain => "net-gain",
            Self::Channels => "channels",
            Self::Evidence => "evidence",
            Self::Assessment => "assessment",
            Self::Poles => "poles",
            Self::Leads => "leads",
            Self::Couplings => "couplings",
            Self::Physics => "physics",
            Self::PhysicsChange => "physics-change",
            Self::Requirements => "requirements",
            Self::Airspeeds => "airspeeds",
            Self::ScheduleCost => "schedule-cost",
        }
    }

    /// Returns whether the figure requires error bars, so that they must be computed for it.
    pub fn needs_bars(self) -> bool {
        matches!(self, Self::Evidence | Self::Requirements)
    }

    /// Returns whether the figure shows error bars if these are available, but does not require
    /// them.
    pub fn takes_bars(self) -> bool {
        matches!(self, Self::NetGain | Self::Channels | Self::ScheduleCost)
    }

    /// Returns whether the figure shows a single condition.
    pub fn is_of_condition(self) -> bool {
        matches!(
            self,
            Self::Bode
                | Self::Error
                | Self::Overview
                | Self::Poles
                | Self::Leads
                | Self::PhysicsChange
        )
    }
}

/// Model responses over time, with their excitation.
#[derive(Clone, Debug, PartialEq)]
pub enum OverTime {
    /// Responses to a test input.
    Test(Arc<TestAnswers>),
    /// Responses to the inputs in a flight record; the index selects the drawn input.
    Record(Arc<RecordHistory>, usize),
}

/// A request for a figure: its kind, contents and options. Each kind uses only the fields relevant
/// to it.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct FigureRequest {
    pub kind: FigureKind,
    pub pairs: Vec<Pair>,
    pub channels: Vec<Channel>,
    /// Quantity drawn for each channel: gain or delay.
    pub measure: Measure,
    /// Quantity on the horizontal axis when channels are plotted.
    pub across: Across,
    /// Choice for [`FigureKind::Assessment`]; [`usual_choice`] if `None`.
    pub assessed: Option<AssessmentChoice>,
    /// Roles of the models drawn for each condition in [`FigureKind::Airspeeds`]; if empty,
    /// [`AcrossRole::SHOWN_AT_FIRST`].
    pub across_roles: Vec<AcrossRole>,
    /// Conditions in [`FigureKind::Airspeeds`]; if empty, all.
    pub across_conditions: Vec<ConditionId>,
    pub bode: BodeOptions,
    pub couplings: Option<Arc<CouplingsAssessment>>,
    pub physics: Option<Arc<PhysicsAssessment>>,
    /// Parameter name in [`FigureKind::Physics`]; if `None` or not enabled, the first parameter in
    /// the ranking.
    pub parameter: Option<String>,
    pub requirements: Option<Arc<Requirements>>,
    /// Model responses that [`FigureKind::Requirements`] shows instead of bandwidths.
    pub over_time: Option<OverTime>,
}

impl FigureRequest {
    /// Creates a request for these responses and channels with default options.
    pub fn new(kind: FigureKind, pairs: Vec<Pair>, channels: Vec<Channel>) -> Self {
        Self {
            kind,
            pairs,
            channels,
            ..Self::default()
        }
    }

    /// Returns the figure, described from the analysis or, if it shows a single condition, from the
    /// condition's source. `None` if the source or the contents are missing.
    pub fn figure(
        &self,
        analysis: Option<&Analysis>,
        condition: Option<&ConditionSource<'_>>,
    ) -> Option<Figure> {
        match self.kind {
            FigureKind::Bode => Some(bode_figure(condition?, &self.pairs, &self.bode)),
            FigureKind::Error => Some(error_figure(condition?, &self.pairs, &self.bode)),
            FigureKind::Overview => Some(overview_figure(condition?, &self.bode)),
            FigureKind::NetGain => {
                let analysis = analysis?;
                let uncertainty = analysis.uncertainty.as_deref();
                Some(net_gain_figure(analysis, uncertainty, &self.pairs))
            }
            FigureKind::Channels => self.channels_figure(analysis?),
            FigureKind::Evidence => evidence_figure(analysis?, &self.pairs),
            FigureKind::Assessment => {
                let analysis = analysis?;
                let choice = self.assessed.unwrap_or_else(|| usual_choice(analysis));
                Some(assessment_figure(analysis, &self.pairs, choice))
            }
            FigureKind::Poles => self.poles_figure(condition?),
            FigureKind::Leads => Some(leads_figure(condition?, &self.pairs)),
            FigureKind::Requirements => self.requirements_figure(analysis?),
            FigureKind::Couplings => {
                let shown = condition.map(|source| source.curves.condition.id());
                couplings_figure(self.couplings.as_deref()?, shown, self.bode.unit)
            }
            FigureKind::Physics => self.physics_figure(analysis?),
            FigureKind::PhysicsChange => {
                let source = condition?;
                physics_change_figure(
                    self.physics.as_deref()?,
                    source.dataset(),
                    source.id(),
                    CHANGED_RESPONSES,
                    self.bode.unit,
                )
            }
            FigureKind::Airspeeds => self.airspeeds_figure(analysis?),
            FigureKind::ScheduleCost => {
                let analysis = analysis?;
                let uncertainty = analysis.uncertainty.as_deref();
                schedule_cost_figure(analysis, uncertainty, *self.pairs.first()?)
            }
        }
    }

    fn airspeeds_figure(&self, analysis: &Analysis) -> Option<Figure> {
        let roles = if self.across_roles.is_empty() {
            &AcrossRole::SHOWN_AT_FIRST[..]
        } else {
            &self.across_roles
        };
        let mut conditions = self.across_conditions.clone();
        if conditions.is_empty() {
            conditions.extend(analysis.study.dataset.ids());
        }
        airspeeds_figure(analysis, &self.pairs, roles, &conditions, &self.bode)
    }

    fn channels_figure(&self, analysis: &Analysis) -> Option<Figure> {
        Some(channels_figure(
            analysis,
            analysis.uncertainty.as_deref(),
            &self.channels,
            GainAxes {
                measure: self.measure,
                across: self.across,
            },
        ))
    }

    /// Plots a physics parameter in every condition, and the misfit that remains; `None` without a
    /// diagnosis of the parameters.
    fn physics_figure(&self, analysis: &Analysis) -> Option<Figure> {
        let assessment = self.physics.as_deref()?;
        let findings = assessment.applied.findings.as_deref()?;
        let shown = findings.selected(self.parameter.as_deref())?;
        physics_figure(findings, &analysis.study.dataset, assessment.level, shown)
    }

    /// Computes and plots every model's modes and zeros.
    fn poles_figure(&self, source: &ConditionSource<'_>) -> Option<Figure> {
        let modes = ConditionModes::compute(&source.curves.condition, &Unobserved).ok()?;
        let zeros = |id: &ModelId| match self.bode.zeros_of {
            Some(pair) => zeros_of_model(source, pair, id),
            None => Vec::new(),
        };
        let shifts = match source.analysis {
            Some(analysis) => analysis.pole_shifts(),
            None => Vec::new(),
        };
        let contents = PoleContents {
            modes: &modes,
            zeros_of: &zeros,
            shifts: &shifts,
        };
        Some(poles_figure(source, contents, &self.bode))
    }

    /// Plots model responses over time if requested, otherwise bandwidths; `None` if the request
    /// contains neither.
    fn requirements_figure(&self, analysis: &Analysis) -> Option<Figure> {
        let study = &analysis.study;
        match &self.over_time {
            Some(OverTime::Test(answers)) => Some(test_answers_figure(answers, &study.dataset)),
            Some(OverTime::Record(history, input)) => {
                Some(record_history_figure(history, &study.dataset, *input))
            }
            None => Some(requirements_figure(
                self.requirements.as_deref()?,
                &study.dataset,
                &study.requirements.levels,
            )),
        }
    }
}
