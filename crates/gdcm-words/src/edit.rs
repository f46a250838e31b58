//! Short descriptions of decisions, for the undo list and for the report on decisions that were
//! made with another dataset and do not apply to the present one.

use gdcm_model::dataset::{Dataset, ModelId};
use gdcm_model::number_format::counted;
use gdcm_study::Edit;
use gdcm_study::decisions::dataset_differences::CarriedDecision;
use gdcm_study::decisions::physics_settings::ParameterDecision;
use gdcm_study::decisions::requirement_settings::{OutputRequirement, RequirementPart};
use gdcm_study::decisions::settings::ResponseMark;

/// Names a decision about a study of `dataset`: "reject nominal (condition 10)".
pub fn edit_text(edit: &Edit, dataset: &Dataset) -> String {
    match edit {
        Edit::Reject(id) => format!("reject {}", model_name(id)),
        Edit::RejectBecause { model, .. } => format!("reject {}", model_name(model)),
        Edit::SetReason(id, _) => format!("set the reason for rejecting {}", model_name(id)),
        Edit::Restore(id) => format!("restore {}", model_name(id)),
        Edit::RestoreAll { condition } => format!("restore all models (condition {condition})"),
        Edit::RejectEach(models) => format!("reject {}", counted(models.len(), "model")),
        Edit::RestoreEach(models) => format!("restore {}", counted(models.len(), "model")),
        Edit::Pin(id) => format!("use {} as representative", model_name(id)),
        Edit::Unpin { condition, bundle } => {
            format!(
                "use the medoid of the {bundle} models as representative (condition {condition})"
            )
        }
        Edit::SetScheduled {
            condition,
            scheduled: true,
        } => format!("use condition {condition} in the schedule"),
        Edit::SetScheduled { condition, .. } => format!(
            "leave condition {condition} out of \
            the schedule"
        ),
        Edit::SetHeldOut {
            condition,
            held_out: true,
        } => format!("hold condition {condition} out"),
        Edit::SetHeldOut { condition, .. } => {
            format!("no longer hold condition {condition} out")
        }
        Edit::ConstrainOnAxis => "hold the on-axis responses".to_owned(),
        Edit::Hold(pair, held) => {
            let verb = if *held { "hold" } else { "release" };
            format!("{verb} {}", dataset.pair_name(*pair))
        }
        Edit::Fit(pair, fitted) => {
            let verb = if *fitted { "fit" } else { "ignore" };
            format!("{verb} {}", dataset.pair_name(*pair))
        }
        Edit::Set(setting, _) => setting.name.to_owned(),
        Edit::SetSign {
            channel,
            role: reversed,
        } => {
            let name = channel.name_in(dataset);
            match reversed {
                Some(role) => format!("reverse the sign of {name} ({})", role.word()),
                None => format!("restore the sign of {name}"),
            }
        }
        Edit::AdoptModels(taken) => match taken.as_slice() {
            [(condition, _)] => format!("use identified models (condition {condition})"),
            _ => format!("use identified models ({} conditions)", taken.len()),
        },
        Edit::RestoreFileModels { condition } => {
            format!("restore the identified models of the file (condition {condition})")
        }
        Edit::SetRequirements(part, _) => {
            format!("set the {}", requirement_part_text(*part))
        }
        Edit::DecideParameter { name, decision } => match decision {
            ParameterDecision::Value(Some(_)) => format!("set {name} by hand"),
            ParameterDecision::Value(None) => format!("fit {name}"),
            ParameterDecision::On(true) => format!("switch {name} on"),
            ParameterDecision::On(false) => format!("switch {name} off"),
            ParameterDecision::PlausibleSd(_) => format!("set the plausible change of {name}"),
        },
        Edit::StoreVariant { name } => format!("keep variant {name}"),
        Edit::ApplyVariant { name } => format!("use variant {name}"),
        Edit::RemoveVariant { name } => format!("remove variant {name}"),
        Edit::RenameVariant { from, to } => format!("rename variant {from} to {to}"),
    }
}

fn model_name(id: &ModelId) -> String {
    format!("{} (condition {})", id.name, id.condition)
}

fn requirement_part_text(part: RequirementPart) -> &'static str {
    match part {
        RequirementPart::AttitudeCommand => "attitude command",
        RequirementPart::Levels => "level boundaries",
        RequirementPart::Tolerances => "tolerances in time",
        RequirementPart::ModeTolerances => "tolerances of modes",
        RequirementPart::OverviewLimits => "limits of bandwidth and summary",
        RequirementPart::TestShape => "shape of the test input",
        RequirementPart::TestSize => "size of the test input",
        RequirementPart::TestDuration => "duration of the test input",
        RequirementPart::Options => "options of the requirements",
    }
}

/// Names a decision that was made with another dataset and does not apply to the present one.
pub(crate) fn carried_decision_text(decision: &CarriedDecision) -> String {
    match decision {
        CarriedDecision::Edit { edit, dataset } => edit_text(edit, dataset),
        CarriedDecision::Response {
            mark,
            output,
            input,
        } => {
            let verb = match mark {
                ResponseMark::Held => "hold",
                ResponseMark::Ignored => "ignore",
            };
            format!("{verb} {input} → {output}")
        }
        CarriedDecision::Sign { channel } => format!("reverse the sign of {channel}"),
        CarriedDecision::Requirement(OutputRequirement::AttitudeCommand(name)) => {
            format!("attitude command of output {name}")
        }
        CarriedDecision::Requirement(OutputRequirement::Levels(name)) => {
            format!("levels of output {name}")
        }
    }
}
