//! Qualification requirements on every condition's models (M17) that need no flight records:
//! bandwidth and phase delay, modes, summary costs.

use std::collections::BTreeSet;

use serde::ser::SerializeStruct;
use serde::{Serialize, Serializer};

use gdcm_model::dataset::{ConditionId, Pair};
use gdcm_model::progress::Cancelled;

use super::analysis::Analysis;
use super::assessment_table::AssessedCorrection;
use super::condition_bandwidths::bandwidth_findings;
use super::missing_finding::{MissingFinding, MissingPart, MissingReason};
use super::requested_condition::RequestedCondition;
use super::required_bandwidth::BandwidthFinding;
use super::required_modes::{IdentifiedPoles, ModeFinding, mode_findings};
use super::required_summary::{SummaryFinding, summary_finding};
use super::requirement_role::RequirementRole;
use crate::execution::Execution;

/// Number of progress steps that a condition counts for.
const STEPS_PER_CONDITION: usize = 1;

/// A response whose phase at the band's lowest frequency suggests a reversed channel in these
/// roles' models: 45 to 135 deg, where that of an attitude that follows its stick is 0 to -90 deg
/// (`AttitudeResponse::reversed_phase_deg` in `gdcm-method`).
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

/// Writes the condition, and the code as the text: the export, whose cautions have these two fields,
/// replaces the code by a sentence. The sentence contains the pair and the roles; it needs the
/// dataset's channel names.
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
    /// Outputs with attitude command, by name; all other outputs have rate command.
    pub attitude_command: BTreeSet<String>,
    /// Bandwidth and phase delay for every on-axis response, condition and role.
    pub bandwidth: Vec<BandwidthFinding>,
    /// The physics modes against the identified modes.
    pub modes: Vec<ModeFinding>,
    /// The summary costs for every condition and every physics role.
    pub summary: Vec<SummaryFinding>,
    pub missing: Vec<MissingFinding>,
    pub cautions: Vec<ReversedPhase>,
}

impl Requirements {
    /// Returns why a condition has no modes to compare; `None` where it has modes.
    pub fn missing_modes_reason(&self, condition: ConditionId) -> Option<&MissingReason> {
        self.missing
            .iter()
            .find(|missing| {
                missing.condition == Some(condition)
                    && matches!(missing.what, MissingPart::Modes | MissingPart::All)
            })
            .map(|missing| &missing.why)
    }

    /// Returns a response's bandwidth in a condition's model.
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

/// A condition's part in [`Requirements`].
#[derive(Default)]
struct ConditionFindings {
    bandwidth: Vec<BandwidthFinding>,
    modes: Vec<ModeFinding>,
    summary: Vec<SummaryFinding>,
    missing: Vec<MissingFinding>,
    cautions: Vec<ReversedPhase>,
}

/// Computes the requirements that need no flight records, for every condition with a result (M17.1,
/// M17.3, M17.4). Each condition is a progress step.
///
/// Intervals are based on the analysis's error bars ([`Analysis::uncertainty`]). The uncertainty in
/// `identified_poles` determines whether the flight data suffice for a verdict on a mode. These
/// poles were kept from an earlier identification; no records are read here.
///
/// # Errors
/// [`Cancelled`] where `execution` is cancelled.
pub fn requirements_of(
    analysis: &Analysis,
    identified_poles: &IdentifiedPoles,
    execution: &Execution<'_>,
) -> Result<Requirements, Cancelled> {
    let settings = &analysis.study.settings;
    let ids: Vec<ConditionId> = analysis.study.dataset.ids().collect();
    let conditions = execution.each(ids.len(), STEPS_PER_CONDITION, |index| {
        condition_findings(analysis, identified_poles, ids[index])
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
            what: MissingPart::Scheduled,
            why: MissingReason::NoSchedule(*error),
        });
    }
    for condition in conditions {
        requirements.cautions.extend(condition.cautions);
        requirements.bandwidth.extend(condition.bandwidth);
        requirements.modes.extend(condition.modes);
        requirements.summary.extend(condition.summary);
        requirements.missing.extend(condition.missing);
    }
    Ok(requirements)
}

/// Computes a condition's findings; without a result, only the reason.
fn condition_findings(
    analysis: &Analysis,
    identified_poles: &IdentifiedPoles,
    id: ConditionId,
) -> ConditionFindings {
    let mut found = ConditionFindings::default();
    let result = match analysis.result(id) {
        Ok(result) => result,
        Err(why) => {
            found.missing.push(MissingFinding {
                condition: Some(id),
                what: MissingPart::All,
                why: MissingReason::NoResult(why),
            });
            return found;
        }
    };
    let requested = RequestedCondition {
        analysis,
        result,
        // A missing schedule is reported once, in `requirements_of`.
        scheduled: AssessedCorrection::Scheduled
            .correction(analysis, result)
            .ok(),
    };
    found.bandwidth = bandwidth_findings(&requested);
    match mode_findings(&requested, identified_poles) {
        Ok(modes) => found.modes = modes,
        Err(why) => found.missing.push(MissingFinding {
            condition: Some(id),
            what: MissingPart::Modes,
            why: MissingReason::NoModes(why),
        }),
    }
    for role in requested.roles() {
        if role != RequirementRole::Identified {
            found.summary.push(summary_finding(&requested, role));
        }
    }
    found.cautions = reversed_phases(&found.bandwidth);
    found
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
