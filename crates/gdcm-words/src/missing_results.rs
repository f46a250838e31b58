//! Sentences about missing results: why a condition, a model, a record or a value has none. A role
//! is a version of a condition's model: physics, corrected, scheduled or identified.

use gdcm_model::dataset::Dataset;
use gdcm_study::jobs::identification_jobs::SimulationFailure;
use gdcm_study::results::analysis::NoResult;
use gdcm_study::results::missing_finding::{
    MissingFinding, MissingPart, MissingReason, NoModes, NoRoleModel, NotCompared,
};
use gdcm_study::results::record_history::{NoRecordHistory, NotInHistory};
use gdcm_study::results::required_bandwidth::NoBandwidth;
use gdcm_study::results::required_modes::NoModeValue;
use gdcm_study::results::required_summary::NoSummary;
use gdcm_study::results::requirement_role::RequirementRole;
use gdcm_study::results::requirements::ReversedPhase;
use gdcm_study::results::test_input_responses::NoTestAnswer;

/// Returns why an analysis contains no result for a condition.
pub fn no_result_text(why: &NoResult) -> String {
    match why {
        NoResult::NotAnalysed => "the condition was not analysed".to_owned(),
        NoResult::Failed(failure) => failure.to_string(),
    }
}

/// Returns what is missing among the requirements, and why.
pub fn missing_finding_text(finding: &MissingFinding) -> String {
    let missing = match finding.what {
        MissingPart::All => "results",
        MissingPart::Scheduled => "values with the schedule",
        MissingPart::Modes => "modes",
        MissingPart::TimeHistories => "time histories",
    };
    format!("no {missing}: {}", missing_reason_text(&finding.why))
}

/// Returns why a requirement has no result.
pub fn missing_reason_text(why: &MissingReason) -> String {
    match why {
        MissingReason::NoSchedule(error) => error.to_string(),
        MissingReason::NoResult(why) => no_result_text(why),
        MissingReason::NoModes(why) => no_modes_text(why),
        MissingReason::NoRecord => {
            "no flight record was given; add records (Records view, or --records)".to_owned()
        }
        MissingReason::NoRecordOfCondition => {
            "no flight record of this condition was given".to_owned()
        }
        MissingReason::ToleranceNotApplied(error) => error.to_string(),
        MissingReason::RecordNotPrepared { record, why } => format!("record \"{record}\": {why}"),
        MissingReason::NoRoleModel(why) => no_role_model_text(why),
        MissingReason::NotCompared { role, record, why } => format!(
            "{} model, record \"{record}\": {}",
            role.name(),
            not_compared_text(*why)
        ),
    }
}

fn no_modes_text(why: &NoModes) -> String {
    match why {
        NoModes::Measured { model } => {
            format!("\"{model}\" is a measured response, which has no poles")
        }
        NoModes::NotComputed {
            model,
            is_coupled: false,
            why,
        } => format!("\"{model}\": {why}"),
        NoModes::NotComputed {
            model,
            is_coupled: true,
            why,
        } => format!("\"{model}\" with couplings: {why}"),
        NoModes::NotCoupled { model, why } => format!("\"{model}\" with couplings: {why}"),
    }
}

fn no_role_model_text(why: &NoRoleModel) -> String {
    format!("{} model: {}", why.role.name(), why.why)
}

fn not_compared_text(why: NotCompared) -> String {
    match why {
        NotCompared::NotSimulated(error) => error.to_string(),
        NotCompared::NotChecked(error) => error.to_string(),
        NotCompared::NoSamples => "there are no samples to compare".to_owned(),
    }
}

/// Returns why a record is not compared with a condition's models.
pub fn no_record_history_text(why: &NoRecordHistory) -> String {
    match why {
        NoRecordHistory::NoResult(why) => no_result_text(why),
        NoRecordHistory::NotPrepared(error) => error.to_string(),
    }
}

/// Returns why the comparison with a record lacks a model or a quantity.
pub fn not_in_history_text(why: &NotInHistory) -> String {
    match why {
        NotInHistory::NoRoleModel(why) => no_role_model_text(why),
        NotInHistory::NotSimulated { role, why } => format!("{} model: {why}", role.name()),
        NotInHistory::ToleranceNotApplied(error) => error.to_string(),
    }
}

/// Returns why a model has no response to a test input.
pub fn no_test_answer_text(why: &NoTestAnswer) -> String {
    match why {
        NoTestAnswer::NoModel(error) => error.to_string(),
        NoTestAnswer::NotSimulated(error) => error.to_string(),
    }
}

/// Returns why a model is not simulated with a record.
pub fn simulation_failure_text(why: &SimulationFailure) -> String {
    match why {
        SimulationFailure::NotPrepared(error) => error.to_string(),
        SimulationFailure::NotSimulated(error) => error.to_string(),
    }
}

/// Returns why a bandwidth, a phase delay or an interval is missing.
pub fn no_bandwidth_text(why: &NoBandwidth) -> String {
    match why {
        NoBandwidth::NetGainNotPositive => "the net gain is not positive".to_owned(),
        NoBandwidth::NotCoupled => {
            "the physics model has no matrices to which couplings can be applied".to_owned()
        }
        NoBandwidth::NoAttitudeResponse(error) => error.to_string(),
        NoBandwidth::NoMetric(error) => error.to_string(),
        NoBandwidth::NoOtherModel => "no spread: the bundles contain no other models".to_owned(),
        NoBandwidth::BarsNotComputed => "the error bars have not been computed".to_owned(),
        NoBandwidth::ScheduleNotRefitted => {
            "no error bar: the schedule is not refitted for each exchange of models".to_owned()
        }
        NoBandwidth::DeviationsTooNarrow => {
            "the standard deviations of the identified model do not extend to this frequency"
                .to_owned()
        }
        NoBandwidth::MeasuredWithoutDeviations => {
            "the measured response has no standard deviations".to_owned()
        }
        NoBandwidth::ModelWithoutDeviations => {
            "the identified model has no standard deviations".to_owned()
        }
    }
}

/// Returns why a value for a mode is missing.
pub fn no_mode_value_text(why: NoModeValue) -> &'static str {
    match why {
        NoModeValue::NotOscillating => "the mode does not oscillate",
        NoModeValue::NoDecay => "the mode neither decays nor grows",
        NoModeValue::PoleAtZero => "the pole of the mode is at zero",
    }
}

/// Returns why a summary cost is missing.
pub fn no_summary_text(why: NoSummary) -> &'static str {
    match why {
        NoSummary::NoOnAxisResponse => "no on-axis response of the two models can be compared",
        NoSummary::NoResponse => "no response of the two models can be compared",
    }
}

/// Returns the caution that a response's phase suggests a reversed channel.
pub fn reversed_phase_text(phase: &ReversedPhase, dataset: &Dataset) -> String {
    let roles: Vec<&str> = phase
        .roles
        .iter()
        .map(|role: &RequirementRole| role.name())
        .collect();
    format!(
        "{} ({}): the phase of the attitude at the lowest frequency of the band lies within 45 \
        deg of +90 deg, which suggests that the stick or the output has the opposite sign; the \
        bandwidth is then wrong, and that sign should be reversed",
        dataset.pair_name(phase.pair),
        roles.join(", ")
    )
}
