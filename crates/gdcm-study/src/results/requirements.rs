//! Qualification requirements on the models of every condition (M17) that need no flight records:
//! bandwidth and phase delay, modes, summary costs; with their settings and model roles.

use std::collections::{BTreeMap, BTreeSet};
use std::sync::Arc;

use serde::{Deserialize, Serialize};

use gdcm_method::correction::corrected_model::CorrectedModelError;
use gdcm_method::correction::{ChannelCorrection, Pade};
use gdcm_method::couplings::CoupledModelError;
use gdcm_method::couplings::coupling_matrices::without_delays;
use gdcm_method::requirements::bandwidth::CommandType;
use gdcm_method::requirements::summary::{Summary, SummarySource};
use gdcm_method::requirements::{LevelBoundaries, ModeToleranceTable, TestInput, ToleranceTable};
use gdcm_method::schedule::ScheduleError;
use gdcm_model::dataset::{BundleKind, ConditionId, Dataset, Model, Pair, StateSpace};
use gdcm_model::progress::{Cancelled, Progress};
use gdcm_model::units::number;

use super::analysis::{Analysis, ConditionAnalysis};
use super::assessment_table::AssessedCorrection;
use super::required_bandwidth::{BandwidthFinding, bandwidth_findings};
use super::required_modes::{KnownPoles, ModeFinding, mode_findings};
use crate::decisions::settings::is_default;
use crate::stages::engine::Engine;
use crate::stages::execution::Execution;

/// Settings of the requirements; an omitted part has its default.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct RequirementSettings {
    /// Names of the outputs with attitude command; all other outputs have rate command.
    #[serde(skip_serializing_if = "BTreeSet::is_empty")]
    pub attitude_command: BTreeSet<String>,
    #[serde(skip_serializing_if = "is_default")]
    pub levels: LevelBoundaries,
    /// Tolerances of time histories about the measured ones.
    #[serde(skip_serializing_if = "is_default")]
    pub tolerances: ToleranceTable,
    /// Tolerances of modes about the identified ones.
    #[serde(skip_serializing_if = "is_default")]
    pub mode_tolerances: ModeToleranceTable,
    /// Limits beyond which the overview marks a corrected model as far from the identified one.
    #[serde(skip_serializing_if = "is_default")]
    pub overview: OverviewLimits,
    /// Test input of the models where no flight record is shown.
    #[serde(skip_serializing_if = "is_default")]
    pub test: TestInput,
}

/// Limits beyond which the overview marks a corrected model as far from the identified one. The
/// limits are the program's own, from no standard.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct OverviewLimits {
    /// Relative difference of the bandwidth from the identified one.
    pub bandwidth: f64,
    pub phase_delay_s: f64,
    /// Least share of time inside a tolerance, 0 to 1.
    pub share_inside: f64,
}

impl Default for OverviewLimits {
    fn default() -> Self {
        Self {
            bandwidth: 0.1,
            phase_delay_s: 0.02,
            share_inside: 0.9,
        }
    }
}

/// An invalid limit of the overview: not above zero.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[error("limits of the overview: expected {name} above zero, found {}", number(*found))]
pub struct OverviewLimitsError {
    pub name: &'static str,
    pub found: f64,
}

impl OverviewLimits {
    /// Checks the limits and returns them.
    ///
    /// # Errors
    /// [`OverviewLimitsError`] where a limit is not a number above zero.
    pub fn checked(self) -> Result<Self, OverviewLimitsError> {
        let Self {
            bandwidth,
            phase_delay_s,
            share_inside,
        } = self;
        let limits = [
            ("bandwidth", bandwidth),
            ("phase_delay_s", phase_delay_s),
            ("share_inside", share_inside),
        ];
        match limits
            .into_iter()
            .find(|(_, value)| !value.is_finite() || *value <= 0.0)
        {
            Some((name, found)) => Err(OverviewLimitsError { name, found }),
            None => Ok(self),
        }
    }
}

impl Analysis {
    /// Returns the same analysis with other requirement settings.
    pub fn asked_with(&self, settings: &Arc<RequirementSettings>) -> Self {
        let mut analysis = self.clone();
        analysis.study.requirements = Arc::clone(settings);
        analysis
    }
}

impl RequirementSettings {
    /// Returns the command type of an axis, by the name of its output.
    pub fn command_of(&self, output: &str) -> CommandType {
        if self.attitude_command.contains(output) {
            CommandType::Attitude
        } else {
            CommandType::Rate
        }
    }

    /// Describes the settings with outputs that the dataset does not have.
    pub fn without_channel(&self, dataset: &Dataset) -> Vec<String> {
        let (_, outputs) = dataset.names_of_channels();
        let unknown = |name: &&String| !outputs.contains(name);
        let commands = self.attitude_command.iter().filter(unknown);
        let commands = commands
            .map(|name| format!("attitude command of {name}: the dataset has no such output"));
        let levels = self.levels.unknown_axes(&outputs).into_iter();
        commands
            .chain(levels.map(|name| format!("levels of {name}: the dataset has no such output")))
            .collect()
    }
}

/// Role of a model in a condition.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum RequirementRole {
    /// The uncorrected physics representative.
    #[default]
    Physics,
    /// The physics representative under the condition's own correction.
    Corrected,
    /// The physics representative under the schedule at the condition's airspeed.
    Scheduled,
    Identified,
}

impl RequirementRole {
    /// Every role, in the order of tables.
    pub const ALL: [Self; 4] = [
        Self::Physics,
        Self::Corrected,
        Self::Scheduled,
        Self::Identified,
    ];

    /// Returns the bundle of the role's representative.
    pub fn bundle(self) -> BundleKind {
        if self == Self::Identified {
            BundleKind::Identified
        } else {
            BundleKind::Physics
        }
    }

    /// Returns the name of the role.
    pub fn name(self) -> &'static str {
        match self {
            Self::Physics => "physics",
            Self::Corrected => "corrected",
            Self::Scheduled => "scheduled",
            Self::Identified => "identified",
        }
    }
}

/// Summary costs of a physics model against the identified representative (M17.4).
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct SummaryFinding {
    pub condition: ConditionId,
    /// Its true airspeed \[kt\].
    pub airspeed_kt: f64,
    pub role: RequirementRole,
    pub model: String,
    /// Mean J over the on-axis responses.
    pub mean_j_on_axis: Option<f64>,
    /// Mean J over all responses.
    pub mean_j_all: Option<f64>,
    /// Mean share of the band, in `ln omega`, inside the MUAD envelopes, over the on-axis
    /// responses: 0 to 1.
    pub muad_share_on_axis: Option<f64>,
    /// Mean share of the band inside the MUAD envelopes over all responses: 0 to 1.
    pub muad_share_all: Option<f64>,
    #[serde(skip_serializing_if = "BTreeMap::is_empty")]
    pub absent: BTreeMap<&'static str, String>,
}

impl SummaryFinding {
    /// Returns the numbers with their names.
    pub fn quantities(&self) -> [(&'static str, Option<f64>); 4] {
        [
            ("mean_j_on_axis", self.mean_j_on_axis),
            ("mean_j_all", self.mean_j_all),
            ("muad_share_on_axis", self.muad_share_on_axis),
            ("muad_share_all", self.muad_share_all),
        ]
    }
}

/// A missing answer, in one condition or in all.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct MissingFinding {
    /// The condition; `None` for all conditions.
    pub condition: Option<ConditionId>,
    /// Missing item: "all", "scheduled" or "modes".
    pub what: &'static str,
    pub why: String,
}

/// A caution about the numbers of a condition.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct RequirementCaution {
    pub condition: ConditionId,
    pub text: String,
}

/// Qualification requirements on the models of every condition, in the format of the export.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Requirements {
    /// The identified band \[rad/s\].
    pub band_rad_s: [f64; 2],
    pub interval_level: f64,
    /// Names of the outputs with attitude command; all other outputs have rate command.
    pub attitude_command: BTreeSet<String>,
    /// Bandwidth and phase delay of every on-axis response of every condition and role.
    pub bandwidth: Vec<BandwidthFinding>,
    /// The physics modes against the identified modes.
    pub modes: Vec<ModeFinding>,
    /// The summary costs of every condition and role.
    pub summary: Vec<SummaryFinding>,
    pub missing: Vec<MissingFinding>,
    pub cautions: Vec<RequirementCaution>,
}

/// One condition with the models and results for its requirements.
pub(crate) struct AskedCondition<'a> {
    pub(crate) analysis: &'a Analysis,
    pub(crate) result: &'a ConditionAnalysis,
    pub(crate) scheduled: Option<ChannelCorrection>,
}

impl AskedCondition<'_> {
    pub(crate) fn id(&self) -> ConditionId {
        self.result.condition.id()
    }

    pub(crate) fn airspeed_kt(&self) -> f64 {
        self.result.condition.flight_state().airspeed_kt
    }

    /// Returns the name of the model of a role.
    pub(crate) fn model_name(&self, role: RequirementRole) -> String {
        self.result.representative_name(role.bundle()).to_owned()
    }

    /// Returns the correction of a role; `None` for roles without a correction.
    pub(crate) fn correction(&self, role: RequirementRole) -> Option<&ChannelCorrection> {
        match role {
            RequirementRole::Corrected => Some(&self.result.correction),
            RequirementRole::Scheduled => self.scheduled.as_ref(),
            RequirementRole::Physics | RequirementRole::Identified => None,
        }
    }

    /// Returns the roles that have a model.
    pub(crate) fn roles(&self) -> impl Iterator<Item = RequirementRole> + use<> {
        let has_schedule = self.scheduled.is_some();
        RequirementRole::ALL
            .into_iter()
            .filter(move |role| has_schedule || *role != RequirementRole::Scheduled)
    }

    fn summary(&self, role: RequirementRole) -> SummaryFinding {
        let on_axis = self.analysis.study.dataset.measuring_pairs();
        let correction = self.correction(role);
        let multiplier = |pair: Pair| {
            correction.map_or(Some(gdcm_model::response::GainDelay::NONE), |of| {
                of.on(pair)
            })
        };
        let summary = Summary::of(&SummarySource {
            mismatch: &self.result.comparison.representative.mismatch,
            correction: &multiplier,
            on_axis: &on_axis,
            omega: &self.analysis.omega,
            average: self.analysis.study.settings.cost_average,
            validation: None,
            outputs: self.analysis.study.dataset.outputs(),
        });
        let mut finding = SummaryFinding {
            condition: self.id(),
            airspeed_kt: self.airspeed_kt(),
            role,
            model: self.model_name(role),
            mean_j_on_axis: summary.cost.on_axis,
            mean_j_all: summary.cost.all,
            muad_share_on_axis: summary.muad.on_axis,
            muad_share_all: summary.muad.all,
            absent: BTreeMap::new(),
        };
        let absent = finding
            .quantities()
            .into_iter()
            .filter(|(_, value)| value.is_none());
        let why = |name: &str| {
            let which = if name.ends_with("on_axis") {
                "no on-axis response"
            } else {
                "no response"
            };
            format!("{which} of the two models can be compared")
        };
        finding.absent = absent.map(|(name, _)| (name, why(name))).collect();
        finding
    }
}

/// Computes the findings of one condition.
fn findings_of(analysis: &Analysis, known: &KnownPoles, id: ConditionId) -> Requirements {
    let mut found = Requirements::default();
    let missing = |what, why: String| MissingFinding {
        condition: Some(id),
        what,
        why,
    };
    let result = match analysis.result(id) {
        Ok(result) => result,
        Err(why) => {
            return Requirements {
                missing: vec![missing("all", why)],
                ..found
            };
        }
    };
    let scheduled = AssessedCorrection::Scheduled.of(analysis, result).ok();
    let asked = AskedCondition {
        analysis,
        result,
        scheduled,
    };
    found.bandwidth = bandwidth_findings(&asked);
    match mode_findings(&asked, known) {
        Ok(modes) => found.modes = modes,
        Err(why) => found.missing.push(missing("modes", why)),
    }
    let against_flight = asked
        .roles()
        .filter(|role| *role != RequirementRole::Identified);
    found.summary = against_flight.map(|role| asked.summary(role)).collect();
    found.cautions = reversed_phases(analysis, &found.bandwidth);
    found
}

/// Computes the requirements on the models of every condition with a result (M17.1, M17.3, M17.4),
/// without records. Each condition is a step. Intervals use the error bars of the analysis
/// ([`Analysis::uncertainty`]); whether flight determines a mode is judged from the `known` poles.
///
/// # Errors
/// [`Cancelled`] where `execution` is cancelled.
pub fn requirements_of(
    analysis: &Analysis,
    known: &KnownPoles,
    execution: &Execution<'_>,
) -> Result<Requirements, Cancelled> {
    let settings = &analysis.study.settings;
    let ids: Vec<ConditionId> = analysis.study.dataset.ids().collect();
    let found = execution.each(ids.len(), 1, |index| {
        findings_of(analysis, known, ids[index])
    })?;
    let mut requirements = Requirements {
        band_rad_s: [settings.band.min(), settings.band.max()],
        interval_level: settings.uncertainty.level,
        attitude_command: analysis.study.requirements.attitude_command.clone(),
        ..Requirements::default()
    };
    if let Err(error) = &analysis.schedule {
        requirements.missing.push(MissingFinding {
            condition: None,
            what: "scheduled",
            why: error.to_string(),
        });
    }
    for of_condition in found {
        requirements.cautions.extend(of_condition.cautions);
        requirements.bandwidth.extend(of_condition.bandwidth);
        requirements.modes.extend(of_condition.modes);
        requirements.summary.extend(of_condition.summary);
        requirements.missing.extend(of_condition.missing);
    }
    Ok(requirements)
}

impl Engine {
    /// Computes the requirements on the models of every condition; see [`requirements_of`].
    ///
    /// # Errors
    /// [`Cancelled`] soon after `progress` requests it.
    pub fn requirements(
        &self,
        analysis: &Analysis,
        known: &KnownPoles,
        progress: &dyn Progress,
    ) -> Result<Requirements, Cancelled> {
        requirements_of(
            analysis,
            known,
            &Execution::new(self.executor(), progress, analysis.conditions.len()),
        )
    }
}

/// Returns a caution for each response whose phase indicates a reversed channel, with the affected
/// models.
fn reversed_phases(analysis: &Analysis, findings: &[BandwidthFinding]) -> Vec<RequirementCaution> {
    let mut reversed: Vec<(Pair, ConditionId, Vec<&str>)> = Vec::new();
    for finding in findings
        .iter()
        .filter(|finding| finding.reversed_phase_deg.is_some())
    {
        match reversed.iter_mut().find(|(pair, ..)| *pair == finding.pair) {
            Some((_, _, roles)) => roles.push(finding.role.name()),
            None => reversed.push((finding.pair, finding.condition, vec![finding.role.name()])),
        }
    }
    let caution = |(pair, condition, roles): (Pair, ConditionId, Vec<&str>)| RequirementCaution {
        condition,
        text: format!(
            "{} ({}): the phase of the attitude at the lowest frequency of the band lies within 45 deg of +90 deg, as where the stick or the \
             output counts the other way round; the bandwidth is then wrong",
            analysis.study.dataset.pair_name(pair),
            roles.join(", ")
        ),
    };
    reversed.into_iter().map(caution).collect()
}

/// Why the model of a role cannot be simulated.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum RoleModelError {
    /// The model is a measured response.
    #[error("\"{model}\" is a measured response: without matrices it answers to no record")]
    Measured { model: String },
    /// The model is discrete-time.
    #[error("\"{model}\" acts in discrete time: records are simulated in continuous time")]
    Discrete { model: String },
    #[error(transparent)]
    NoSchedule(#[from] ScheduleError),
    #[error(transparent)]
    Delays(#[from] CorrectedModelError),
    /// Couplings or a correction cannot be applied to the model.
    #[error(transparent)]
    Coupled(#[from] CoupledModelError),
}

impl Analysis {
    /// Returns the model of a role of a condition in continuous time, with delays as states: the
    /// uncorrected physics representative, with the couplings of the study and a correction (`M_O
    /// H~ M_I`), or the identified representative.
    ///
    /// # Errors
    /// [`RoleModelError`] where the model has no matrices or is discrete-time, there is no
    /// schedule, or the matrices cannot be used in computations.
    pub fn role_model(
        &self,
        of: &ConditionAnalysis,
        role: RequirementRole,
    ) -> Result<StateSpace, RoleModelError> {
        let representative = |kind: BundleKind| {
            continuous(&of.condition.bundle(kind)[of.representative(kind).model])
        };
        let corrected = |by: AssessedCorrection| -> Result<StateSpace, RoleModelError> {
            let correction = by.of(self, of)?;
            Ok(of
                .corrected_model(
                    representative(BundleKind::Physics)?,
                    &correction,
                    Pade::default(),
                )?
                .model)
        };
        match role {
            RequirementRole::Physics | RequirementRole::Identified => Ok(without_delays(
                representative(role.bundle())?,
                Pade::default(),
            )?),
            RequirementRole::Corrected => corrected(AssessedCorrection::Own),
            RequirementRole::Scheduled => corrected(AssessedCorrection::Scheduled),
        }
    }
}

/// Returns the matrices of a continuous-time model.
fn continuous(model: &Model) -> Result<&StateSpace, RoleModelError> {
    let name = || model.name.clone();
    let matrices = model
        .state_space()
        .ok_or_else(|| RoleModelError::Measured { model: name() })?;
    match matrices.timing().sample_time_s {
        None => Ok(matrices),
        Some(_) => Err(RoleModelError::Discrete { model: name() }),
    }
}

#[cfg(test)]
mod tests {
    use gdcm_method::requirements::{TestInputShape, Tolerance};

    use super::*;

    #[test]
    fn what_was_not_decided_is_not_written_and_what_was_comes_back() {
        assert_eq!(
            serde_json::to_string(&RequirementSettings::default()).unwrap(),
            "{}"
        );
        let row = Tolerance {
            absolute: 4.0,
            ..ToleranceTable::default().rows()[0].clone()
        };
        let settings = RequirementSettings {
            attitude_command: BTreeSet::from(["Q".to_owned()]),
            tolerances: ToleranceTable::new("our own", vec![row]).unwrap(),
            overview: OverviewLimits {
                bandwidth: 0.15,
                ..OverviewLimits::default()
            },
            test: TestInput {
                shape: TestInputShape::Doublet,
                ..TestInput::default()
            },
            ..RequirementSettings::default()
        };
        let text = serde_json::to_string(&settings).unwrap();
        assert_eq!(
            serde_json::from_str::<RequirementSettings>(&text).unwrap(),
            settings,
            "{text}"
        );
        assert_eq!(
            (settings.command_of("Q"), settings.command_of("P")),
            (CommandType::Attitude, CommandType::Rate)
        );
    }
}
