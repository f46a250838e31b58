//! Recorded references: signals that drove a closed loop from outside. With them, gusts fed back
//! into the inputs do not bias the identified response (M14.15: docs/identification.md).

use std::sync::Arc;

use egui::{ComboBox, PopupCloseBehavior, RichText, Role, Ui};

use super::frame_cache::cached;
use super::page::Page;
use crate::gui::commands::command::Command;
use crate::gui::commands::records::RecordsCommand;
use crate::gui::state::records::ConditionRecords;
use crate::gui::widgets::controls::named;

/// Name by which cautions refer to this setting.
pub(super) const REFERENCES: &str = "references";

/// Column that may hold a reference.
pub(super) struct PossibleReference {
    pub(super) column: String,
    /// Whether the column's name suggests a reference.
    pub(super) is_suggested: bool,
}

/// Draws the selector for the columns that hold recorded references.
pub(super) fn references_ui(
    ui: &mut Ui,
    page: Page<'_>,
    width: f32,
    is_focused: bool,
    commands: &mut Vec<Command>,
) {
    let Page {
        records, palette, ..
    } = page;
    ui.label(palette.small(REFERENCES));
    let text = if records.references.is_empty() {
        "none".to_owned()
    } else {
        records.references.join(", ")
    };
    let list = ComboBox::from_id_salt(REFERENCES)
        .width(width)
        .selected_text(text)
        .truncate()
        .close_behavior(PopupCloseBehavior::CloseOnClickOutside)
        .show_ui(ui, |ui| reference_list_ui(ui, records, commands));
    if is_focused {
        list.response.request_focus();
    }
    let hint = "Columns with recorded external inputs of the closed loop, used as instrumental \
        variables (docs/identification.md)";
    named(
        list.response.on_hover_text(hint),
        Role::ComboBox,
        "Identification: references",
    );
    ui.end_row();
}

/// Lists the chosen references that are no possible columns of the first used record, then every
/// possible column.
fn reference_list_ui(ui: &mut Ui, records: &ConditionRecords, commands: &mut Vec<Command>) {
    let possible = possible_references(ui, records);
    for name in &records.references {
        if possible.iter().all(|known| known.column != *name) {
            reference_ui(ui, records, name, true, commands);
        }
    }
    for reference in possible.iter() {
        reference_ui(
            ui,
            records,
            &reference.column,
            reference.is_suggested,
            commands,
        );
    }
}

fn reference_ui(
    ui: &mut Ui,
    records: &ConditionRecords,
    column: &String,
    is_strong: bool,
    commands: &mut Vec<Command>,
) {
    let mut is_chosen = records.references.contains(column);
    let text = if is_strong {
        RichText::new(column).strong()
    } else {
        RichText::new(column)
    };
    if ui.checkbox(&mut is_chosen, text).changed() {
        let mut references = records.references.clone();
        references.retain(|other| other != column);
        if is_chosen {
            references.push(column.clone());
        }
        commands.push(RecordsCommand::SetReferences(references).into());
    }
}

/// Returns the columns in the first used record that may hold references, suggested ones first.
pub(super) fn possible_references(
    ui: &Ui,
    records: &ConditionRecords,
) -> Arc<Vec<PossibleReference>> {
    let Some((_, row)) = records.used_rows().next() else {
        return Arc::default();
    };
    let source = Arc::clone(&row.table) as _;
    let key = format!("{:?}", row.layout);
    cached(ui, "possible references", &[source], key, || {
        let mut references = Vec::new();
        for (column, is_suggested) in row.possible_references() {
            references.push(PossibleReference {
                column: column.to_owned(),
                is_suggested,
            });
        }
        references
    })
}
