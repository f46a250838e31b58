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

/// "condition 3", "conditions 3, 4, 7", "conditions 1 to 3, 7": three in a row or more by their ends.
pub(super) fn listed_conditions(conditions: &[ConditionId]) -> String {
    let runs = conditions.chunk_by(|one, next| one.0.checked_add(1) == Some(next.0));
    let words = runs.flat_map(|run| match run {
        [first, _, .., last] => vec![format!("{first} to {last}")],
        few => few.iter().map(ToString::to_string).collect(),
    });
    let several = if conditions.len() == 1 { "" } else { "s" };
    format!("condition{several} {}", words.collect::<Vec<_>>().join(", "))
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
        let listed = |ids: &[i64]| listed_conditions(&ids.iter().copied().map(ConditionId).collect::<Vec<_>>());
        assert_eq!(listed(&[1, 2, 4, 5, 6, 9]), "conditions 1, 2, 4 to 6, 9");
        assert_eq!(listed(&[i64::MAX, i64::MIN, 3]), format!("conditions {}, {}, 3", i64::MAX, i64::MIN));
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
