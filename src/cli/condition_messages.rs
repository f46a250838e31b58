//! Messages about conditions; messages with equal text are merged, so that each is printed once with
//! all its conditions.

use gdcm_model::dataset::ConditionId;

use crate::message::Message;

/// A message about a condition, or about the whole result.
pub(super) struct ConditionMessage {
    condition: Option<ConditionId>,
    message: Message,
}

impl ConditionMessage {
    pub(super) fn new(
        condition: impl Into<Option<ConditionId>>,
        code: &'static str,
        text: String,
    ) -> Self {
        Self {
            condition: condition.into(),
            message: Message { code, text },
        }
    }
}

/// A message with all conditions to which it applies; without conditions, it concerns the whole
/// result.
pub(super) struct SharedMessage {
    pub(super) conditions: Vec<ConditionId>,
    pub(super) message: Message,
}

impl SharedMessage {
    /// Returns the message, prefixed with its conditions.
    pub(super) fn words(&self) -> String {
        with_conditions(&self.conditions, &self.message.text)
    }
}

/// Merges equal messages, ordered by first occurrence.
pub(super) fn shared_messages(
    messages: impl IntoIterator<Item = ConditionMessage>,
) -> Vec<SharedMessage> {
    let mut shared: Vec<SharedMessage> = Vec::new();
    for ConditionMessage { condition, message } in messages {
        let known = shared.iter().position(|known| known.message == message);
        let place = known.unwrap_or_else(|| {
            shared.push(SharedMessage {
                conditions: Vec::new(),
                message,
            });
            shared.len() - 1
        });
        let conditions = &mut shared[place].conditions;
        if let Some(condition) = condition
            && !conditions.contains(&condition)
        {
            conditions.push(condition);
        }
    }
    shared
}

/// Returns "condition 3", "conditions 3, 4, 7", "conditions 1 to 3, 7": three or more consecutive
/// conditions are given as a range.
pub(super) fn listed_conditions(conditions: &[ConditionId]) -> String {
    let mut entries: Vec<String> = Vec::new();
    for run in conditions.chunk_by(|id, next| id.0.checked_add(1) == Some(next.0)) {
        match run {
            [first, _, .., last] => entries.push(format!("{first} to {last}")),
            few => entries.extend(few.iter().map(ToString::to_string)),
        }
    }
    let several = if conditions.len() == 1 { "" } else { "s" };
    format!("condition{several} {}", entries.join(", "))
}

/// Prefixes a message with its conditions; no prefix if the list is empty.
pub(super) fn with_conditions(conditions: &[ConditionId], words: &str) -> String {
    if conditions.is_empty() {
        words.to_owned()
    } else {
        format!("{}: {words}", listed_conditions(conditions))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn listed(ids: &[i64]) -> String {
        let ids: Vec<ConditionId> = ids.iter().copied().map(ConditionId).collect();
        listed_conditions(&ids)
    }

    #[test]
    fn equal_messages_are_printed_once_with_all_their_conditions() {
        let messages = [(3, "late"), (4, "noisy"), (7, "late"), (7, "late")];
        let messages = messages
            .map(|(id, text)| ConditionMessage::new(ConditionId(id), text, text.to_owned()));
        let shared: Vec<(&str, Vec<i64>)> = shared_messages(messages)
            .iter()
            .map(|shared| {
                let ids = shared.conditions.iter().map(|id| id.0);
                (shared.message.code, ids.collect())
            })
            .collect();
        assert_eq!(shared, [("late", vec![3, 7]), ("noisy", vec![4])]);
    }

    #[test]
    fn conditions_in_a_row_are_listed_by_their_ends() {
        assert_eq!(listed(&[1, 2, 4, 5, 6, 9]), "conditions 1, 2, 4 to 6, 9");
        assert_eq!(
            listed(&[i64::MAX, i64::MIN, 3]),
            format!("conditions {}, {}, 3", i64::MAX, i64::MIN)
        );
    }
}
