//! Variants: decisions kept under names, beside the present ones.

use egui::{Align, Button, Layout, RichText, Role, TextEdit, Ui, WidgetInfo};

use crate::view::command::Command;
use crate::view::compare_scene::{difference_table, figure_table};
use crate::view::palette::{Palette, SMALL_SIZE};
use crate::view::state::State;
use crate::view::table_view::{TableLook, table_ui};
use gdcm_core::study::{Edit, Variant};

/// The variants of the study, what differs between them and the present decisions, and what it does.
pub fn compare_view_ui(ui: &mut Ui, state: &mut State, palette: &Palette, commands: &mut Vec<Command>) {
    keep_ui(ui, state, commands);
    if state.study.variants.is_empty() {
        let words = "A variant is a set of decisions under a name. Keep the present ones, go on deciding, and both stand here \
                     side by side, with what differs and what it does to J and to the net gains.";
        ui.label(RichText::new(words).color(palette.dim_text));
        return;
    }
    for variant in state.study.variants.clone() {
        variant_ui(ui, &variant, commands);
    }
    ui.add_space(4.0);
    let tables = [difference_table(state), figure_table(state)];
    let look = TableLook { color: &|_, _| None, selected: &|_| false };
    let half = 0.5 * ui.available_height();
    for (index, table) in tables.iter().enumerate() {
        ui.label(RichText::new(&table.title).size(SMALL_SIZE).strong());
        let room = if index == 0 { half } else { ui.available_height() };
        ui.allocate_ui(egui::vec2(ui.available_width(), room), |ui| {
            let mut sorting = state.display.compare_sorting[index];
            table_ui(ui, table, &mut sorting, &look, palette, commands);
            state.display.compare_sorting[index] = sorting;
        });
    }
}

/// The field for a name, and the button that keeps the present decisions under it.
fn keep_ui(ui: &mut Ui, state: &mut State, commands: &mut Vec<Command>) {
    ui.horizontal(|ui| {
        let name = &mut state.display.variant_name;
        let field = ui.add(TextEdit::singleline(name).hint_text("name of the variant").desired_width(200.0));
        field.widget_info(|| {
            let mut info = WidgetInfo::labeled(Role::TextInput, true, "Name of the variant");
            info.current_text_value = Some(name.clone());
            info
        });
        let entered = field.lost_focus() && ui.input(|input| input.key_pressed(egui::Key::Enter));
        let keep = ui.add_enabled(!name.trim().is_empty(), Button::new("Keep as variant"));
        if keep.on_hover_text("Keep the present decisions under this name").clicked() || entered {
            commands.push(Edit::KeepVariant { name: std::mem::take(name) }.into());
        }
    });
}

fn variant_ui(ui: &mut Ui, variant: &Variant, commands: &mut Vec<Command>) {
    ui.horizontal(|ui| {
        ui.label(RichText::new(&variant.name).strong());
        ui.with_layout(Layout::right_to_left(Align::Center), |ui| {
            let name = || variant.name.clone();
            let mut button = |text: &str, verb: &str, hint: &str, edit: Edit| {
                let label = format!("{verb} variant {}", variant.name);
                let button = ui.small_button(text);
                button.widget_info(|| WidgetInfo::labeled(Role::Button, true, &label));
                if button.on_hover_text(hint).clicked() {
                    commands.push(edit.into());
                }
            };
            button(
                "Remove",
                "Remove",
                "Forget this variant; undo brings it back",
                Edit::RemoveVariant { name: name() },
            );
            let hint = "Its decisions become the present ones; undo brings those back";
            button("Take", "Take", hint, Edit::TakeVariant { name: name() });
        });
    });
}
