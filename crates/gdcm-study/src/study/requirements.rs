//! What a qualification asks of the models of every condition (M17), without flight records: bandwidth and phase delay, modes, summary
//! costs; what it is asked with, and of which models.

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
use super::engine::Engine;
use super::execution::Execution;
use super::required_bandwidth::{BandwidthFinding, bandwidth_findings};
use super::required_modes::{KnownPoles, ModeFinding, mode_findings};
use super::settings::is_default;

/// What requirements are asked with; a part that is left out is the default.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct RequirementSettings {
    /// Names of the outputs whose attitude the stick commands; of all others it commands the rate.
    #[serde(skip_serializing_if = "BTreeSet::is_empty")]
    pub attitude_command: BTreeSet<String>,
    /// Boundaries of levels over bandwidth and phase delay.
    #[serde(skip_serializing_if = "is_default")]
    pub levels: LevelBoundaries,
    /// How far a time history may be from the flown one.
    #[serde(skip_serializing_if = "is_default")]
    pub tolerances: ToleranceTable,
    /// How far a mode may be from the flown one.
    #[serde(skip_serializing_if = "is_default")]
    pub mode_tolerances: ModeToleranceTable,
    /// From where on the overview says that a corrected model is far from the identified one.
    #[serde(skip_serializing_if = "is_default")]
    pub overview: OverviewLimits,
    /// What the models answer to where no flight record is shown.
    #[serde(skip_serializing_if = "is_default")]
    pub test: TestInput,
}

/// From where on the overview of the corrected models says that one is far from the identified one: limits of the program, of no standard.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct OverviewLimits {
    /// Difference of the bandwidth, as a part of the identified one.
    pub bandwidth: f64,
    /// Difference of the phase delay \[s\].
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

/// A limit of the overview that is not above zero.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[error("limits of the overview: expected {name} above zero, found {}", number(*found))]
pub struct OverviewLimitsError {
    /// Which.
    pub name: &'static str,
    /// What stands there.
    pub found: f64,
}

impl OverviewLimits {
    /// The same, checked.
    ///
    /// # Errors
    /// [`OverviewLimitsError`] where one is not a number above zero.
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
    /// The same analysis, of which requirements are asked with other settings.
    pub fn asked_with(&self, settings: &Arc<RequirementSettings>) -> Self {
        let mut analysis = self.clone();
        analysis.study.requirements = Arc::clone(settings);
        analysis
    }
}

impl RequirementSettings {
    /// How an axis answers to its stick, by the name of its output.
    pub fn command_of(&self, output: &str) -> CommandType {
        if self.attitude_command.contains(output) {
            CommandType::Attitude
        } else {
            CommandType::Rate
        }
    }

    /// What names outputs that the dataset does not have, in words.
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

/// Which model of a condition a number is of.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum RequirementRole {
    /// The physics representative as it is.
    #[default]
    Physics,
    /// The same under the condition's own correction.
    Corrected,
    /// The same under the schedule at the condition's airspeed.
    Scheduled,
    /// The identified representative.
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

    /// The bundle whose representative it is of.
    pub fn bundle(self) -> BundleKind {
        if self == Self::Identified {
            BundleKind::Identified
        } else {
            BundleKind::Physics
        }
    }

    /// Its name.
    pub fn name(self) -> &'static str {
        match self {
            Self::Physics => "physics",
            Self::Corrected => "corrected",
            Self::Scheduled => "scheduled",
            Self::Identified => "identified",
        }
    }
}

/// The summary costs of a physics model against the identified representative (M17.4).
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct SummaryFinding {
    /// The condition.
    pub condition: ConditionId,
    /// Its true airspeed \[kt\].
    pub airspeed_kt: f64,
    /// Which model.
    pub role: RequirementRole,
    /// Its name.
    pub model: String,
    /// Mean J over the on-axis responses.
    pub mean_j_on_axis: Option<f64>,
    /// Mean J over all responses.
    pub mean_j_all: Option<f64>,
    /// Mean share of the band, in `ln omega`, inside the MUAD envelopes, over the on-axis responses: 0 to 1.
    pub muad_share_on_axis: Option<f64>,
    /// The same over all responses.
    pub muad_share_all: Option<f64>,
    /// Why a number is absent, by its name.
    #[serde(skip_serializing_if = "BTreeMap::is_empty")]
    pub absent: BTreeMap<&'static str, String>,
}

impl SummaryFinding {
    /// Its numbers by their names.
    pub fn quantities(&self) -> [(&'static str, Option<f64>); 4] {
        [
            ("mean_j_on_axis", self.mean_j_on_axis),
            ("mean_j_all", self.mean_j_all),
            ("muad_share_on_axis", self.muad_share_on_axis),
            ("muad_share_all", self.muad_share_all),
        ]
    }
}

/// A question that has no answer, in one condition or in all.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct MissingFinding {
    /// The condition; none where it is all of them.
    pub condition: Option<ConditionId>,
    /// What is missing: "all", "scheduled" or "modes".
    pub what: &'static str,
    /// The reason in words.
    pub why: String,
}

/// What has to be known about the numbers of a condition.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct RequirementCaution {
    /// The condition.
    pub condition: ConditionId,
    /// The caution in words.
    pub text: String,
}

/// What a qualification asks of the models of every condition, as it is written.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Requirements {
    /// The identified band \[rad/s\].
    pub band_rad_s: [f64; 2],
    /// Level of every interval.
    pub interval_level: f64,
    /// Names of the outputs whose attitude the stick commands; of all others it commands the rate.
    pub attitude_command: BTreeSet<String>,
    /// Bandwidth and phase delay of every on-axis response of every condition and role.
    pub bandwidth: Vec<BandwidthFinding>,
    /// The modes of physics against those identified.
    pub modes: Vec<ModeFinding>,
    /// The summary costs of every condition and role.
    pub summary: Vec<SummaryFinding>,
    /// What has no answer, and why.
    pub missing: Vec<MissingFinding>,
    /// What has to be known.
    pub cautions: Vec<RequirementCaution>,
}

/// One condition with what its questions are asked of.
pub(super) struct AskedCondition<'a> {
    pub(super) analysis: &'a Analysis,
    pub(super) result: &'a ConditionAnalysis,
    pub(super) scheduled: Option<ChannelCorrection>,
}

impl AskedCondition<'_> {
    pub(super) fn id(&self) -> ConditionId {
        self.result.condition.id()
    }

    pub(super) fn airspeed_kt(&self) -> f64 {
        self.result.condition.flight_state().airspeed_kt
    }

    /// The name of the model of a role.
    pub(super) fn model_name(&self, role: RequirementRole) -> String {
        self.result.representative_name(role.bundle()).to_owned()
    }

    /// The correction of a role; none of models that have none.
    pub(super) fn correction(&self, role: RequirementRole) -> Option<&ChannelCorrection> {
        match role {
            RequirementRole::Corrected => Some(&self.result.correction),
            RequirementRole::Scheduled => self.scheduled.as_ref(),
            RequirementRole::Physics | RequirementRole::Identified => None,
        }
    }

    /// The roles that there is a model for.
    pub(super) fn roles(&self) -> impl Iterator<Item = RequirementRole> + use<> {
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

/// What is found of one condition.
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

/// What a qualification asks of the models of every condition with a result (M17.1, M17.3, M17.4), without records. Each condition is
/// a step. Intervals take the bars of the analysis ([`Analysis::uncertainty`]); which modes flight determines takes the poles that are `known`.
///
/// # Errors
/// [`Cancelled`] where `execution` is stopped.
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
    /// What a qualification asks of the models of every condition; see [`requirements_of`].
    ///
    /// # Errors
    /// [`Cancelled`] soon after `progress` says so.
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

/// A caution for each response whose phase speaks for a reversed channel, with the models that it is of.
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
    /// It is a response that was measured.
    #[error("\"{model}\" is a measured response: without matrices it answers to no record")]
    Measured {
        /// Its name.
        model: String,
    },
    /// It acts in discrete time.
    #[error("\"{model}\" acts in discrete time: records are simulated in continuous time")]
    Discrete {
        /// Its name.
        model: String,
    },
    /// There is no schedule.
    #[error(transparent)]
    NoSchedule(#[from] ScheduleError),
    /// Delays or leads cannot become states.
    #[error(transparent)]
    Delays(#[from] CorrectedModelError),
    /// Couplings or a correction cannot be put on it.
    #[error(transparent)]
    Coupled(#[from] CoupledModelError),
}

impl Analysis {
    /// The model of a role of a condition in continuous time, its delays as states: the physics representative as it is, with the
    /// couplings of the study and a correction (`M_O H~ M_I`), or the identified representative.
    ///
    /// # Errors
    /// [`RoleModelError`] where the model has no matrices or acts in discrete time, there is no schedule, or matrices cannot be
    /// computed with.
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

/// The matrices of a model of continuous time.
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
