//! Finding a command by some letters of its name.

use std::cmp::Reverse;

/// How well a name answers a query: greater is better; `None` where a word of the query is not in it.
///
/// Each word of the query, in any order, must be in the name: as a word of it (4), at the beginning of one (3), inside one (2), or
/// at least as letters in this order (1). Of names that answer equally well the shorter one is meant more likely.
pub fn answer_score(name: &str, query: &str) -> Option<(usize, Reverse<usize>)> {
    let name = name.to_lowercase();
    let mut score = 0;
    for word in query.to_lowercase().split_whitespace() {
        score += if words_of(&name).any(|whole| whole == word) {
            4
        } else if starts_a_word(&name, word) {
            3
        } else if name.contains(word) {
            2
        } else if has_letters(&name, word) {
            1
        } else {
            return None;
        };
    }
    Some((score, Reverse(name.chars().count())))
}

/// The places of the names that answer the query, the best first; all in their order for an empty one.
pub fn answers<'a>(names: impl Iterator<Item = &'a str>, query: &str) -> Vec<usize> {
    let scored = names.enumerate().filter_map(|(place, name)| Some((answer_score(name, query)?, place)));
    let mut found: Vec<_> = scored.collect();
    if !query.trim().is_empty() {
        found.sort_by_key(|(score, _)| Reverse(*score));
    }
    found.into_iter().map(|(_, place)| place).collect()
}

fn words_of(name: &str) -> impl Iterator<Item = &str> {
    name.split(|letter: char| !letter.is_alphanumeric())
}

fn starts_a_word(name: &str, word: &str) -> bool {
    let begins = |at: usize| name[..at].chars().next_back().is_none_or(|before| !before.is_alphanumeric());
    name.match_indices(word).any(|(at, _)| begins(at))
}

fn has_letters(name: &str, word: &str) -> bool {
    let mut letters = name.chars();
    word.chars().all(|wanted| letters.any(|letter| letter == wanted))
}

#[cfg(test)]
mod tests {
    use super::*;

    const NAMES: [&str; 5] =
        ["Open…", "Save study as…", "Hold LON → Q exactly", "Export corrections…", "Set the lower gain bound…"];

    fn found(query: &str) -> Vec<&'static str> {
        answers(NAMES.into_iter(), query).into_iter().map(|place| NAMES[place]).collect()
    }

    #[test]
    fn words_are_found_in_any_order_and_shortened() {
        assert_eq!(found("q lon hold"), ["Hold LON → Q exactly"]);
        assert_eq!(found("gain low"), ["Set the lower gain bound…"]);
        assert_eq!(found("expcor"), ["Export corrections…"]);
        assert_eq!(found("nothing like it"), [""; 0]);
    }

    #[test]
    fn the_beginning_of_a_word_comes_before_letters_inside_and_the_shorter_name_before_the_longer() {
        assert_eq!(found("ex"), ["Export corrections…", "Hold LON → Q exactly"]);
        assert_eq!(found("s")[..2], ["Save study as…", "Set the lower gain bound…"]);
    }

    #[test]
    fn without_a_query_every_name_is_there_in_its_order() {
        assert_eq!(found(" "), NAMES);
    }
}
