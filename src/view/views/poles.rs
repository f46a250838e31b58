//! Poles in the s-plane, and the modes of the physics bundle in a table.

use egui::{Panel, Ui};

use crate::view::command::Command;
use crate::view::modes_scene::pole_marks;
use crate::view::palette::Palette;
use crate::view::plot::{PoleEvent, PolesScene, poles_ui};
use crate::view::state::State;
use crate::view::table_view::{TableLook, table_ui};
use gdcm_core::study::Edit;

/// Part of the height that the table has at first.
const TABLE_PART: f32 = 0.3;

/// Whether zeros are shown. Laid out from right to left.
pub fn poles_header_ui(ui: &mut Ui, state: &State, commands: &mut Vec<Command>) {
    let mut shown = state.display.show_zeros;
    let name = format!("zeros of {}", state.dataset().pair_name(state.display.pair));
    let hint = "Transmission zeros of the response in focus, of the nominal model and of both representatives";
    if ui.checkbox(&mut shown, name).on_hover_text(hint).changed() {
        commands.push(Command::ShowZeros(shown));
    }
}

/// Poles of every model of the condition shown; a click rejects or restores a model.
pub fn poles_view_ui(ui: &mut Ui, state: &mut State, palette: &Palette, commands: &mut Vec<Command>) {
    let mut modes = std::mem::take(&mut state.display.modes);
    modes.refresh(state);
    state.display.modes = modes;
    let height = ui.available_height();
    if !state.display.modes.table().0.rows.is_empty() {
        let panel = Panel::bottom("modes").resizable(true).default_size(TABLE_PART * height).min_size(60.0);
        panel.show(ui, |ui| modes_ui(ui, state, palette, commands));
    }
    let marks = pole_marks(state);
    let message = match state.modes() {
        Some(_) => "No model of this condition has poles: they are known by measured responses",
        None => state.results.absence(),
    };
    let scene = PolesScene { marks: &marks, message: Some(message) };
    for event in poles_ui(ui, &scene, &mut state.display.poles, palette) {
        commands.push(match event {
            PoleEvent::Hovered(id) => Command::Hover(id),
            PoleEvent::Isolated(id) => Command::Isolate(id),
            PoleEvent::Clicked(id) if state.study.is_rejected(&id) => Edit::Restore(id).into(),
            PoleEvent::Clicked(id) => Edit::Reject(id).into(),
        });
    }
}

/// The table of modes; a click on a row points at the model that jumps.
fn modes_ui(ui: &mut Ui, state: &mut State, palette: &Palette, commands: &mut Vec<Command>) {
    let (table, jumping) = state.display.modes.table();
    let look = TableLook {
        color: &|row, _| jumping.get(row).and_then(Option::as_ref).map(|_| palette.warning),
        selected: &|row| jumping.get(row).is_some_and(|id| id.is_some() && *id == state.display.hovered),
    };
    let mut sorting = state.display.modes_sorting;
    let clicked = table_ui(ui, table, &mut sorting, &look, palette, commands);
    let model = clicked.and_then(|click| jumping.get(click.row)?.clone());
    commands.extend(model.map(Command::Isolate));
    state.display.modes_sorting = sorting;
}
