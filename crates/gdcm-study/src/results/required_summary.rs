//! Summary costs for the physics models against the identified representative (M17.4): mean J, the
//! mismatch cost (M4), and the share of the band inside the MUAD envelopes, the limits of *maximum
//! unnoticeable added dynamics* between which pilots do not notice a difference.

use std::collections::BTreeMap;

use serde::Serialize;

use gdcm_method::requirements::summary::{Summary, SummarySource};
use gdcm_model::dataset::{ConditionId, Pair};
use gdcm_model::response::GainDelay;

use super::requested_condition::RequestedCondition;
use super::requirement_role::RequirementRole;

/// Summary costs for a physics model against the identified representative (M17.4).
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct SummaryFinding {
    pub condition: ConditionId,
    /// The condition's true airspeed \[kt\].
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
    /// Returns the values with their export names.
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
    /// The two models have no on-axis response that can be compared.
    NoOnAxisResponse,
    /// The two models have no response that can be compared.
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

/// Computes the summary costs for a role's model against the identified representative.
pub(super) fn summary_finding(
    requested: &RequestedCondition<'_>,
    role: RequirementRole,
) -> SummaryFinding {
    let study = &requested.analysis.study;
    let correction = requested.correction(role);
    let multiplier = |pair: Pair| match correction {
        Some(correction) => correction.on(pair),
        None => Some(GainDelay::NONE),
    };
    let summary = Summary::compute(&SummarySource {
        mismatch: &requested.result.comparison.representative.mismatch,
        correction: &multiplier,
        on_axis: &study.dataset.measuring_pairs(),
        omega: &requested.analysis.omega,
        average: study.settings.cost_average,
        validation: None,
        outputs: study.dataset.outputs(),
    });
    let mut finding = SummaryFinding {
        condition: requested.id(),
        airspeed_kt: requested.airspeed_kt(),
        role,
        model: requested.model_name(role),
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
