//! Qualification requirements on every condition's models (M17) that need no flight records:
//! bandwidth and phase delay, modes, summary costs.

use std::collections::{BTreeMap, BTreeSet};

use serde::ser::SerializeStruct;
use serde::{Serialize, Serializer};

use gdcm_method::requirements::summary::{Summary, SummarySource};
use gdcm_model::dataset::{ConditionId, Pair};
use gdcm_model::progress::Cancelled;
use gdcm_model::response::GainDelay;

use super::analysis::Analysis;
use super::asked_condition::AskedCondition;
use super::assessment_table::AssessedCorrection;
use super::missing_finding::{MissingFinding, MissingReason};
use super::required_bandwidth::{BandwidthFinding, bandwidth_findings};
use super::required_modes::{KnownPoles, ModeFinding, mode_findings};
use super::requirement_role::RequirementRole;
use crate::execution::Execution;

/// Summary costs of a physics model against the identified representative (M17.4).
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct SummaryFinding {
    pub condition: ConditionId,
    /// True airspeed of the condition \[kt\].
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
    pub absent: BTreeMap<&'static str, NoSummary>,
}

impl SummaryFinding {
    /// Returns the values with their names.
    pub fn quantities(&self) -> [(&'static str, Option<f64>); 4] {
        [
            ("mean_j_on_axis", self.mean_j_on_axis),
            ("mean_j_all", self.mean_j_all),
            ("muad_share_on_axis", self.muad_share_on_axis),
            ("muad_share_all", self.muad_share_all),
        ]
    }
}

/// Why a summary cost is missing.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum NoSummary {
    /// No on-axis response of the two models can be compared.
    NoOnAxisResponse,
    /// No response of the two models can be compared.
    NoResponse,
}

impl NoSummary {
    /// Returns the stable code, for programs and tests.
    pub fn code(self) -> &'static str {
        match self {
            Self::NoOnAxisResponse => "no-on-axis-response",
            Self::NoResponse => "no-response",
        }
    }
}

/// A response of a condition whose phase at the lowest frequency of the band suggests a reversed
/// channel in the models of these roles.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ReversedPhase {
    pub condition: ConditionId,
    pub pair: Pair,
    pub roles: Vec<RequirementRole>,
}

impl ReversedPhase {
    /// Stable code, for programs and tests.
    pub const CODE: &'static str = "reversed-phase";
}

/// Writes the condition, and the code as the text, which the export replaces by a sentence.
impl Serialize for ReversedPhase {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let mut caution = serializer.serialize_struct("ReversedPhase", 2)?;
        caution.serialize_field("condition", &self.condition)?;
        caution.serialize_field("text", Self::CODE)?;
        caution.end()
    }
}

/// Qualification requirements on every condition's models, in the export's format, with codes where
/// the export writes sentences.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Requirements {
    /// Comparison band \[rad/s\].
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
    pub cautions: Vec<ReversedPhase>,
}

impl Requirements {
    /// Returns why a condition has no modes to compare; `None` where it has modes.
    pub fn no_modes(&self, condition: ConditionId) -> Option<&MissingReason> {
        self.missing
            .iter()
            .find(|missing| {
                missing.condition == Some(condition) && matches!(missing.what, "modes" | "all")
            })
            .map(|missing| &missing.why)
    }

    /// Returns the bandwidth of a response of a condition's model.
    pub fn bandwidth_of(
        &self,
        condition: ConditionId,
        pair: Pair,
        role: RequirementRole,
    ) -> Option<&BandwidthFinding> {
        self.bandwidth.iter().find(|finding| {
            finding.condition == condition && finding.pair == pair && finding.role == role
        })
    }
}

/// Computes the requirements without flight records on every condition with a result (M17.1, M17.3,
/// M17.4). Each condition is a step.
///
/// Intervals are based on the error bars of the analysis ([`Analysis::uncertainty`]). The
/// uncertainty of the `known` poles determines whether the flight data suffice for a verdict on a
/// mode.
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
        condition_requirements(analysis, known, ids[index])
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
            why: MissingReason::NoSchedule(*error),
        });
    }
    for condition in found {
        requirements.cautions.extend(condition.cautions);
        requirements.bandwidth.extend(condition.bandwidth);
        requirements.modes.extend(condition.modes);
        requirements.summary.extend(condition.summary);
        requirements.missing.extend(condition.missing);
    }
    Ok(requirements)
}

/// Computes a condition's findings.
fn condition_requirements(
    analysis: &Analysis,
    known: &KnownPoles,
    id: ConditionId,
) -> Requirements {
    let mut found = Requirements::default();
    let result = match analysis.result(id) {
        Ok(result) => result,
        Err(why) => {
            found.missing.push(MissingFinding {
                condition: Some(id),
                what: "all",
                why: MissingReason::NoResult(why),
            });
            return found;
        }
    };
    let asked = AskedCondition {
        analysis,
        result,
        scheduled: AssessedCorrection::Scheduled
            .correction(analysis, result)
            .ok(),
    };
    found.bandwidth = bandwidth_findings(&asked);
    match mode_findings(&asked, known) {
        Ok(modes) => found.modes = modes,
        Err(why) => found.missing.push(MissingFinding {
            condition: Some(id),
            what: "modes",
            why: MissingReason::NoModes(why),
        }),
    }
    for role in asked.roles() {
        if role != RequirementRole::Identified {
            found.summary.push(summary_finding(&asked, role));
        }
    }
    found.cautions = reversed_phases(&found.bandwidth);
    found
}

/// Computes the summary costs of the model in a role against the identified representative.
fn summary_finding(asked: &AskedCondition<'_>, role: RequirementRole) -> SummaryFinding {
    let study = &asked.analysis.study;
    let correction = asked.correction(role);
    let multiplier = |pair: Pair| match correction {
        Some(correction) => correction.on(pair),
        None => Some(GainDelay::NONE),
    };
    let summary = Summary::compute(&SummarySource {
        mismatch: &asked.result.comparison.representative.mismatch,
        correction: &multiplier,
        on_axis: &study.dataset.measuring_pairs(),
        omega: &asked.analysis.omega,
        average: study.settings.cost_average,
        validation: None,
        outputs: study.dataset.outputs(),
    });
    let mut finding = SummaryFinding {
        condition: asked.id(),
        airspeed_kt: asked.airspeed_kt(),
        role,
        model: asked.model_name(role),
        mean_j_on_axis: summary.cost.on_axis,
        mean_j_all: summary.cost.all,
        muad_share_on_axis: summary.muad.on_axis,
        muad_share_all: summary.muad.all,
        absent: BTreeMap::new(),
    };
    for (name, value) in finding.quantities() {
        if value.is_none() {
            let why = if name.ends_with("on_axis") {
                NoSummary::NoOnAxisResponse
            } else {
                NoSummary::NoResponse
            };
            finding.absent.insert(name, why);
        }
    }
    finding
}

/// Returns a caution for each response whose phase indicates a reversed channel.
fn reversed_phases(findings: &[BandwidthFinding]) -> Vec<ReversedPhase> {
    let mut reversed: Vec<ReversedPhase> = Vec::new();
    for finding in findings {
        if finding.reversed_phase_deg.is_none() {
            continue;
        }
        match reversed.iter_mut().find(|known| known.pair == finding.pair) {
            Some(known) => known.roles.push(finding.role),
            None => reversed.push(ReversedPhase {
                condition: finding.condition,
                pair: finding.pair,
                roles: vec![finding.role],
            }),
        }
    }
    reversed
}
