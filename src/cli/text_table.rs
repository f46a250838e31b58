//! Tables and words behind labels, as a terminal shows them.

use gdcm_core::dataset::ConditionId;
use gdcm_core::message_text::{shortened, shortened_message};
use gdcm_core::study::Table;

/// A table as lines, each behind so many spaces; long names are cut.
pub(super) fn indented(table: &Table, indent: usize) -> String {
    let mut table = table.clone();
    table.rows.iter_mut().flatten().for_each(|cell| *cell = shortened(cell));
    table.text().lines().map(|line| format!("{:indent$}{line}\n", "")).collect()
}

/// Most columns of a page.
pub(super) const PAGE: usize = 110;

/// Words behind a label, broken between words into lines of at most [`PAGE`] columns that stand under one another.
pub(super) fn labelled(indent: usize, label: &str, width: usize, words: &str) -> String {
    hanging(indent, label, width, shortened_message(words).split(' '))
}

/// A list behind a label, with commas, broken between its entries.
pub(super) fn listed(indent: usize, label: &str, width: usize, entries: &[String]) -> String {
    let last = entries.len().saturating_sub(1);
    let with_comma = |(index, entry): (usize, &String)| {
        let entry = shortened_message(entry);
        if index < last { format!("{entry},") } else { entry }
    };
    let entries: Vec<String> = entries.iter().enumerate().map(with_comma).collect();
    hanging(indent, label, width, entries.iter().map(String::as_str))
}

fn hanging<'w>(indent: usize, label: &str, width: usize, pieces: impl Iterator<Item = &'w str>) -> String {
    let mut text = format!("{:indent$}{label:<width$}", "");
    let start = text.chars().count();
    let mut column = start;
    for piece in pieces {
        let length = piece.chars().count();
        if column > start && column + 1 + length > PAGE {
            text.push_str(&format!("\n{:start$}", ""));
            column = start;
        }
        if column > start {
            text.push(' ');
            column += 1;
        }
        text.push_str(piece);
        column += length;
    }
    text.truncate(text.trim_end().len());
    text.push('\n');
    text
}

/// "condition 3", "conditions 3, 4, 7".
pub(super) fn listed_conditions(conditions: &[ConditionId]) -> String {
    let ids: Vec<String> = conditions.iter().map(ToString::to_string).collect();
    format!("condition{} {}", if ids.len() == 1 { "" } else { "s" }, ids.join(", "))
}

/// Words about conditions, each once with all conditions that it is said of, in the order in which they were said first.
pub(super) fn by_words(said: impl IntoIterator<Item = (ConditionId, String)>) -> Vec<(Vec<ConditionId>, String)> {
    let mut grouped: Vec<(Vec<ConditionId>, String)> = Vec::new();
    for (condition, words) in said {
        match grouped.iter_mut().find(|(_, known)| *known == words) {
            Some((conditions, _)) if conditions.contains(&condition) => {}
            Some((conditions, _)) => conditions.push(condition),
            None => grouped.push((vec![condition], words)),
        }
    }
    grouped
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_same_words_of_many_conditions_are_said_once_with_the_conditions_named() {
        let said = [(3, "late"), (4, "noisy"), (7, "late"), (7, "late")];
        let said = by_words(said.map(|(id, words)| (ConditionId(id), words.to_owned())));
        let lines: Vec<String> = said.iter().map(|(of, words)| format!("{}: {words}", listed_conditions(of))).collect();
        assert_eq!(lines, ["conditions 3, 7: late", "condition 4: noisy"]);
    }

    #[test]
    fn long_words_hang_under_their_start() {
        let text = labelled(2, "rejected", 10, &"model ".repeat(40));
        assert!(text.lines().all(|line| line.chars().count() <= PAGE));
        assert!(
            text.lines().skip(1).all(|line| line.starts_with(&" ".repeat(12)) && line.chars().nth(12) == Some('m'))
        );
        assert_eq!(text.matches("model").count(), 40);
    }
}
