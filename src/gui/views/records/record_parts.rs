//! Record parts that are used as separate records: the field for typed parts, and the displayed
//! record's time span. Parts are dragged in `parts_lane.rs`.

use egui::{Label, Ui};

use gdcm_model::units::telling;

use super::page::Page;
use super::typed_lists::numbers;
use crate::gui::commands::command::Command;
use crate::gui::commands::form::FormCommand;
use crate::gui::commands::records::RecordsCommand;
use crate::gui::widgets::text_fields::entry_ui;
use crate::message::Message;

/// Draws the field that makes a typed part a separate record.
pub(super) fn part_ui(ui: &mut Ui, page: Page<'_>, commands: &mut Vec<Command>) {
    let Page {
        records, palette, ..
    } = page;
    ui.label(palette.small("part [s]"));
    let text = entry_ui(ui, "Part of the record", "", "from to", 70.0);
    if let Some(text) = text
        && !text.trim().is_empty()
    {
        let row = records.rows.get(records.chosen);
        let span_s = row.and_then(|row| row.span_s());
        commands.push(match typed_part(&text, span_s) {
            Some(part_s) => RecordsCommand::AddPart(records.chosen, part_s).into(),
            None => Command::Form(FormCommand::Refuse(Message::new("wrong-part", format!(
                "part of the record: expected two times in s, the earlier first, as in \"12 40\", \
                or \"+5 +34\" from the start of the record, found \"{text}\""
            )))),
        });
    }
}

/// Parses a typed part \[s\]: two times on the record's time axis or, with `+` before both, two
/// times from the start of the record. `None` for other texts.
fn typed_part(text: &str, span_s: Option<[f64; 2]>) -> Option<[f64; 2]> {
    let [from, to] = numbers(text).ok()?[..] else {
        return None;
    };
    let signs = text
        .split_whitespace()
        .filter(|time| time.starts_with('+'))
        .count();
    let start_s = match signs {
        0 => 0.0,
        2 => span_s?[0],
        _ => return None,
    };
    let part_s = [start_s + from, start_s + to];
    if part_s[0] < part_s[1] {
        Some(part_s)
    } else {
        None
    }
}

/// Shows the displayed record's time span on its time axis, and counted from the whole record's
/// start.
pub(super) fn span_ui(ui: &mut Ui, page: Page<'_>) {
    let Page {
        records, palette, ..
    } = page;
    let Some(row) = records.rows.get(records.chosen) else {
        return;
    };
    let Some(span_s) = row.span_s() else { return };
    let whole = records
        .rows
        .iter()
        .find(|other| other.table.part_s.is_none() && other.table.source == row.table.source);
    let whole_s = whole.and_then(|whole| whole.span_s());
    let start_s = whole_s.unwrap_or(span_s)[0];
    let [from, to] = span_s.map(|time_s| telling(time_s, 2));
    let [first, last] = span_s.map(|time_s| telling(time_s - start_s, 2));
    let words = format!(
        "{from} s to {to} s on the record's time axis, +{first} s to +{last} s from its start"
    );
    ui.add(Label::new(palette.small(words)).truncate());
}
