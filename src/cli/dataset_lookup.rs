//! Conditions and responses that options name in a dataset, with the failure if the dataset lacks
//! them.

use gdcm_model::dataset::{Channel, ConditionId, Dataset, Pair};

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

/// Returns the responses listed in an option; an error if the dataset lacks one.
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

/// Lists channel names, separated by commas.
pub(super) fn channel_names(channels: &[Channel]) -> String {
    let names: Vec<&str> = channels
        .iter()
        .map(|channel| channel.name.as_str())
        .collect();
    names.join(", ")
}
