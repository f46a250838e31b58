//! Compare view: variants (named decision sets), with buttons that keep, use, overlay and remove
//! them, and differences from the current decisions.

use egui::{Align, Button, Layout, RichText, Role, Ui};

use gdcm_study::Edit;
use gdcm_study::decisions::study::Variant;
use gdcm_words::Table;
use gdcm_words::decision_differences::decision_differences;

use super::PageEntry;
use super::variant_effects::effect_table;
use crate::gui::commands::command::Command;
use crate::gui::commands::display::DisplayCommand;
use crate::gui::state::view_pages::{ComparePage, ViewPage};
use crate::gui::state::window_state::State;
use crate::gui::widgets::choices::Toggle;
use crate::gui::widgets::controls::named;
use crate::gui::widgets::number_field::remember_field;
use crate::gui::widgets::palette::{Palette, SMALL_SIZE};
use crate::gui::widgets::tables::{TableLook, table_ui};
use crate::gui::widgets::text_fields::{is_entered, text_field_ui};

/// Draws all variants, and below them a page: differences from the current decisions, or effects.
pub fn compare_view_ui(
    ui: &mut Ui,
    state: &mut State,
    palette: &Palette,
    commands: &mut Vec<Command>,
) {
    keep_ui(ui, state, commands);
    if state.study.variants.is_empty() {
        let words = "A variant is a named set of decisions. Keep the current decisions as a \
            variant and continue: the differences, and their effect on J and on the net gains, \
            are then listed here.";
        ui.label(RichText::new(words).color(palette.dim_text));
        return;
    }
    for variant in state.study.variants.clone() {
        let is_overlaid = state.display.judging.overlaid.as_ref() == Some(&variant.name);
        variant_ui(ui, &variant, is_overlaid, commands);
    }
    ui.add_space(4.0);
    let page = state.display.pages.compare;
    let table = match page {
        ComparePage::Decisions => difference_table(state),
        ComparePage::Effects => effect_table(state),
    };
    ui.label(RichText::new(&table.title).size(SMALL_SIZE).strong());
    let sorting = &mut state.display.judging.compare_sorting[page as usize];
    table_ui(ui, &table, sorting, &TableLook::PLAIN, palette, commands);
}

pub fn compare_pages(state: &State) -> Vec<PageEntry> {
    [ComparePage::Decisions, ComparePage::Effects]
        .map(|page| PageEntry::new(ViewPage::Compare(page), page == state.display.pages.compare))
        .into()
}

/// Accessible name of the field for the name of a new variant.
pub const VARIANT_NAME: &str = "Name of the variant";

/// Draws the name field and the button that stores the current decisions under that name.
fn keep_ui(ui: &mut Ui, state: &mut State, commands: &mut Vec<Command>) {
    ui.horizontal(|ui| {
        let name = &mut state.display.judging.variant_name;
        let field = text_field_ui(ui, VARIANT_NAME, name, "name of the variant", 200.0);
        remember_field(ui, VARIANT_NAME, field.id);
        let entered = is_entered(ui, &field);
        let keep = ui.add_enabled(!name.trim().is_empty(), Button::new("Keep as variant"));
        if keep
            .on_hover_text("Stores the current decisions under this name")
            .clicked()
            || entered
        {
            let name = std::mem::take(name);
            commands.push(Edit::StoreVariant { name }.into());
        }
    });
}

/// Draws a variant's name and, from right to left, its buttons.
fn variant_ui(ui: &mut Ui, variant: &Variant, is_overlaid: bool, commands: &mut Vec<Command>) {
    ui.horizontal(|ui| {
        ui.label(RichText::new(&variant.name).strong());
        ui.with_layout(Layout::right_to_left(Align::Center), |ui| {
            let name = variant.name.clone();
            if variant_button_ui(ui, "Remove", &name, "Can be undone") {
                commands.push(Edit::RemoveVariant { name: name.clone() }.into());
            }
            let hint = "Replaces the current decisions; can be undone";
            if variant_button_ui(ui, "Use", &name, hint) {
                commands.push(Edit::ApplyVariant { name: name.clone() }.into());
            }
            let label = format!("Overlay variant {name}");
            let hint = "Draws the variant's corrected model in the Bode view (dotted) and its net \
                gains (hollow squares)";
            let toggle = Toggle {
                text: "Overlay",
                name: &label,
                hint,
            };
            if toggle.ui(ui, is_overlaid) {
                let overlaid = if is_overlaid { None } else { Some(name) };
                commands.push(DisplayCommand::Overlay(overlaid).into());
            }
        });
    });
}

/// Draws a button for a variant; returns whether it was clicked.
fn variant_button_ui(ui: &mut Ui, verb: &str, name: &str, hint: &str) -> bool {
    let button = ui.small_button(verb);
    named(button, Role::Button, format!("{verb} variant {name}"))
        .on_hover_text(hint)
        .clicked()
}

/// Tabulates all decisions in which each variant differs from the current decisions.
fn difference_table(state: &State) -> Table {
    let columns = ["variant", "decision", "in the variant", "now"];
    let mut table = Table::new("Different decisions", columns);
    for variant in &state.study.variants {
        let Some(study) = state.study.of_variant(&variant.name) else {
            continue;
        };
        let differences = decision_differences(&study, &state.study);
        if differences.is_empty() {
            table.row([variant.name.as_str(), "none: the same decisions"]);
        }
        for difference in differences {
            table.row([
                variant.name.clone(),
                difference.what,
                difference.before,
                difference.after,
            ]);
        }
    }
    table
}
