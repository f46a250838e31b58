//! Conditions and responses that options name in a dataset, with the failure if the dataset lacks
//! them; and lists of what the dataset has, for messages.

use gdcm_model::dataset::{BundleKind, Channel, Condition, ConditionId, Dataset, Pair};
use gdcm_sysid::records::record_table::shortened_list;

use super::failure::Failure;
use super::option_values::PairName;

/// Returns the condition with the id given by an option; an error if the dataset lacks it.
pub(super) fn condition_of(dataset: &Dataset, id: i64) -> Result<ConditionId, Failure> {
    match dataset.condition(ConditionId(id)) {
        Some(condition) => Ok(condition.id()),
        None => {
            let ids = condition_ids(dataset);
            let reason = format!("the dataset has no condition {id}; conditions are {ids}");
            Err(Failure::coded_option(
                "--condition",
                "unknown-condition",
                reason,
            ))
        }
    }
}

/// Lists all condition ids, separated by commas.
pub(super) fn condition_ids(dataset: &Dataset) -> String {
    let ids: Vec<String> = dataset
        .conditions()
        .iter()
        .map(|condition| condition.id().to_string())
        .collect();
    ids.join(", ")
}

/// Lists the names of a condition's models of one kind, shortened after 20; "none" without models.
pub(super) fn model_names(condition: &Condition, bundle: BundleKind) -> String {
    let names: Vec<&str> = condition
        .bundle(bundle)
        .iter()
        .map(|model| model.name.as_str())
        .collect();
    if names.is_empty() {
        "none".to_owned()
    } else {
        shortened_list(&names)
    }
}

/// Returns the responses listed in an option.
pub(super) fn pairs_of(
    dataset: &Dataset,
    list: &[PairName],
    option: &'static str,
) -> Result<Vec<Pair>, Failure> {
    let mut pairs = Vec::new();
    for PairName { output, input } in list {
        let pair = dataset.find_pair(output, input).ok_or_else(|| {
            let reason = format!(
                "the dataset has no response {output}/{input}; outputs are {}; inputs are {}",
                channel_names(dataset.outputs()),
                channel_names(dataset.inputs())
            );
            Failure::coded_option(option, "unknown-response", reason)
        })?;
        pairs.push(pair);
    }
    Ok(pairs)
}

/// Lists all channel names, separated by commas.
pub(super) fn channel_names(channels: &[Channel]) -> String {
    let names: Vec<&str> = channels
        .iter()
        .map(|channel| channel.name.as_str())
        .collect();
    names.join(", ")
}
