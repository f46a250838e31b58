//! Command palette: finds every command by a few letters from its name.

use std::cmp::Reverse;

use egui::text::{CCursor, CCursorRange};
use egui::{Key, Modifiers, Role, ScrollArea, TextEdit, Ui, WidgetInfo};

use super::command::Command;
use super::command_table::every_command;
use super::entry::Entry;
use crate::gui::commands::form::FormCommand;
use crate::gui::state::forms::PaletteForm;
use crate::gui::state::window_state::State;
use crate::gui::widgets::list_row::row_ui;
use crate::gui::widgets::painted_text::{Room, row_text, row_text_within};
use crate::gui::widgets::palette::{BODY_SIZE, Palette, SMALL_SIZE};

/// List height \[pt\].
const HEIGHT: f32 = 340.0;
/// Maximum number of drawn rows; typing further letters shortens a longer list.
const MOST_ROWS: usize = 60;

/// Draws the search field and the matching commands; `opens` clears the search. Up and Down select
/// a command; Enter or a click carries it out and closes the palette, unless it is disabled.
pub fn command_palette_ui(
    ui: &mut Ui,
    state: &mut State,
    opens: bool,
    palette: &Palette,
    commands: &mut Vec<Command>,
) {
    let entries = every_command(state);
    let form = &mut state.forms.palette;
    if opens {
        *form = PaletteForm::default();
    }
    let down = count_presses(ui, Key::ArrowDown);
    let up = count_presses(ui, Key::ArrowUp);
    let is_entered = count_presses(ui, Key::Enter) > 0;
    if field_ui(ui, &mut form.query, opens) {
        form.chosen = 0;
    }
    let mut found = matching_names(entries.iter().map(|entry| entry.name.as_str()), &form.query);
    found.truncate(MOST_ROWS);
    form.chosen = (form.chosen + down)
        .saturating_sub(up)
        .min(found.len().saturating_sub(1));
    let chosen = form.chosen;
    let has_moved = down + up > 0;
    ui.add_space(4.0);
    let mut taken = if is_entered {
        found.get(chosen).copied()
    } else {
        None
    };
    // The height is fixed, so that the field does not move while letters are typed.
    ScrollArea::vertical()
        .max_height(HEIGHT)
        .min_scrolled_height(HEIGHT)
        .auto_shrink(false)
        .show(ui, |ui| {
            if found.is_empty() {
                ui.label(palette.dim("No matching command"));
            }
            for (row, &place) in found.iter().enumerate() {
                let response = entry_ui(ui, &entries[place], row == chosen, palette);
                if response.clicked() {
                    taken = Some(place);
                }
                if row == chosen && has_moved {
                    response.scroll_to_me(None);
                }
            }
        });
    if let Some(place) = taken
        && entries[place].enabled
    {
        commands.push(FormCommand::ShowForm(None).into());
        commands.push(entries[place].command.clone());
    }
}

/// Returns how often a key was pressed, and consumes these events.
fn count_presses(ui: &Ui, key: Key) -> usize {
    ui.input_mut(|input| input.count_and_consume_key(Modifiers::NONE, key))
}

/// Draws the search field; returns whether its text has changed.
fn field_ui(ui: &mut Ui, query: &mut String, opens: bool) -> bool {
    let shown = TextEdit::singleline(query)
        .hint_text("name of a command")
        .desired_width(f32::INFINITY)
        .show(ui);
    let response = shown.response.response;
    response.widget_info(|| {
        let mut info = WidgetInfo::labeled(Role::TextInput, true, "Command palette");
        info.current_text_value = Some(query.clone());
        info
    });
    if opens || !response.has_focus() {
        let mut edited = shown.state;
        edited
            .cursor
            .set_char_range(Some(CCursorRange::one(CCursor::new(query.chars().count()))));
        edited.store(ui.ctx(), response.id);
        response.request_focus();
    }
    response.changed()
}

/// Draws a row with an entry's name and shortcut.
fn entry_ui(ui: &mut Ui, entry: &Entry, chosen: bool, palette: &Palette) -> egui::Response {
    let (row, response) = row_ui(ui, palette, chosen, false, &entry.name);
    let color = if entry.enabled {
        palette.text
    } else {
        palette.quiet_text
    };
    let keys = match entry.shortcuts.first() {
        Some(shortcut) => ui.ctx().format_shortcut(shortcut),
        None => String::new(),
    };
    let keys = row_text(ui, row, -6.0, &keys, SMALL_SIZE, palette.dim_text);
    let room = Room {
        left: 8.0,
        right: keys.left() - row.left() - 10.0,
    };
    row_text_within(ui, row, room, &entry.name, BODY_SIZE, color);
    response.on_hover_text(entry.meaning)
}

/// Quality of the match between a name and a query; a better match compares greater.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct MatchScore {
    /// False for an undo or redo command, unless the query asks for it: its name contains the last
    /// decision, whose words would match otherwise. (`false` compares smaller than `true`.)
    is_asked: bool,
    /// Sum of the word scores.
    words: usize,
    /// Sum of the word scores in the name before the first `(` or `:`, that is, without arguments.
    words_of_command: usize,
    /// Letter count; the shorter name is better.
    length: Reverse<usize>,
}

/// Scores how well a name matches a query; `None` if a word in the query is missing from the name.
///
/// Every word in the query must occur in the name, in any order: as a whole word (4), at the
/// beginning of a word (3), inside a word (2), or at least as letters in the same order (1).
pub fn match_score(name: &str, query: &str) -> Option<MatchScore> {
    let name = name.to_lowercase();
    let query = query.to_lowercase();
    let command = name.split(['(', ':']).next().unwrap_or_default();
    let mut words = 0;
    let mut words_of_command = 0;
    for word in query.split_whitespace() {
        words += word_score(&name, word)?;
        words_of_command += word_score(command, word).unwrap_or_default();
    }
    Some(MatchScore {
        is_asked: is_asked(&name, &query),
        words,
        words_of_command,
        length: Reverse(name.chars().count()),
    })
}

/// Returns false for a name that begins with "undo" or "redo", unless a word in the query is a
/// prefix of that word.
fn is_asked(name: &str, query: &str) -> bool {
    match words_of(name).next() {
        Some(first @ ("undo" | "redo")) => {
            query.split_whitespace().any(|word| first.starts_with(word))
        }
        _ => true,
    }
}

/// Scores a query word from 4 (a whole word in the name) to 1 (only its letters, in order); `None`
/// without a match.
fn word_score(name: &str, word: &str) -> Option<usize> {
    if words_of(name).any(|whole| whole == word) {
        Some(4)
    } else if starts_a_word(name, word) {
        Some(3)
    } else if name.contains(word) {
        Some(2)
    } else if has_letters(name, word) {
        Some(1)
    } else {
        None
    }
}

/// Returns the indices of the names that match the query, best first; for an empty query, all
/// indices in order.
pub fn matching_names<'a>(names: impl Iterator<Item = &'a str>, query: &str) -> Vec<usize> {
    let mut found: Vec<(MatchScore, usize)> = names
        .enumerate()
        .filter_map(|(place, name)| Some((match_score(name, query)?, place)))
        .collect();
    if !query.trim().is_empty() {
        found.sort_by_key(|(score, _)| Reverse(*score));
    }
    found.into_iter().map(|(_, place)| place).collect()
}

fn words_of(name: &str) -> impl Iterator<Item = &str> {
    name.split(|letter: char| !letter.is_alphanumeric())
}

/// Returns whether a word in the name begins with `word`.
fn starts_a_word(name: &str, word: &str) -> bool {
    name.match_indices(word)
        .any(|(at, _)| match name[..at].chars().next_back() {
            Some(before) => !before.is_alphanumeric(),
            None => true,
        })
}

/// Returns whether the name contains the letters from `word` in the same order.
fn has_letters(name: &str, word: &str) -> bool {
    let mut letters = name.chars();
    word.chars()
        .all(|wanted| letters.any(|letter| letter == wanted))
}

#[cfg(test)]
mod tests {
    use super::*;

    const NAMES: [&str; 5] = [
        "Open…",
        "Save study as…",
        "Hold LON → Q exactly",
        "Export corrections…",
        "Set the lower gain bound…",
    ];

    fn found(query: &str) -> Vec<&'static str> {
        matching_names(NAMES.into_iter(), query)
            .into_iter()
            .map(|place| NAMES[place])
            .collect()
    }

    #[test]
    fn words_are_found_in_any_order_and_shortened() {
        assert_eq!(found("q lon hold"), ["Hold LON → Q exactly"]);
        assert_eq!(found("gain low"), ["Set the lower gain bound…"]);
        assert_eq!(found("expcor"), ["Export corrections…"]);
        assert_eq!(found("nothing like it"), [""; 0]);
    }

    #[test]
    fn the_beginning_of_a_word_comes_before_letters_inside_and_the_shorter_name_before_the_longer()
    {
        assert_eq!(found("ex"), ["Export corrections…", "Hold LON → Q exactly"]);
        assert_eq!(
            found("s")[..2],
            ["Save study as…", "Set the lower gain bound…"]
        );
    }

    #[test]
    fn undo_comes_last_unless_requested_and_a_command_comes_before_its_arguments() {
        let names = [
            "Undo reject 3 suggested (condition 10)",
            "Reject (condition 10)",
            "Condition 10: 60 kt, low altitude",
        ];
        let first = |query: &str| names[matching_names(names.into_iter(), query)[0]];
        assert_eq!(first("cond 10"), names[2]);
        assert_eq!(first("undo"), names[0]);
        assert_eq!(matching_names(names.into_iter(), "cond 10"), [2, 1, 0]);
    }

    #[test]
    fn without_a_query_every_name_is_found_in_its_order() {
        assert_eq!(found(" "), NAMES);
    }
}
