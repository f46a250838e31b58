//! The focused response, large.

use egui::Ui;

use crate::dataset::Band;
use crate::study::{Edit, Setting};
use crate::view::bode_scene::bode_curves;
use crate::view::command::Command;
use crate::view::palette::Palette;
use crate::view::plot::{BodeEvent, BodeScene, CurveId, bode_ui};
use crate::view::state::State;

/// Magnitude and phase of the response in focus, of every model of the condition shown.
pub fn bode_view_ui(ui: &mut Ui, state: &mut State, palette: &Palette, commands: &mut Vec<Command>) {
    let pair = state.display.pair;
    state.display.drawn = bode_curves(state, pair);
    let band = state.study.settings.band;
    let title = state.dataset().pair_name(state.display.pair);
    let stale = state.results.is_stale(ui.input(|input| input.time));
    let message = state.curves_message();
    let scene = BodeScene {
        pair_title: &title,
        curves: &state.display.drawn,
        band: (band.min(), band.max()),
        unit: state.display.unit,
        stale,
        message,
    };
    let events = bode_ui(ui, &scene, &mut state.display.bode, palette);
    for event in events {
        commands.extend(bode_command(state, event));
    }
    if let Some(CurveId::Model(id)) = state.display.bode.hovered() {
        commands.push(Command::Hover(id.clone()));
    }
}

fn bode_command(state: &State, event: BodeEvent) -> Option<Command> {
    let is_rejected = |id| state.study.is_rejected(id);
    match event {
        BodeEvent::Clicked(CurveId::Model(id)) => {
            Some(if is_rejected(&id) { Edit::Restore(id) } else { Edit::Reject(id) }.into())
        }
        BodeEvent::TakenBack(CurveId::Model(id)) => {
            Some(Command::Forget(if is_rejected(&id) { Edit::Reject(id) } else { Edit::Restore(id) }))
        }
        BodeEvent::Isolated(CurveId::Model(id)) => Some(Command::Isolate(id)),
        BodeEvent::Hovered(_) | BodeEvent::Clicked(_) | BodeEvent::TakenBack(_) | BodeEvent::Isolated(_) => None,
        BodeEvent::BandDragged { min, max } => {
            Band::new(min, max).ok().map(|band| Edit::Set(Setting::Band(band)).into())
        }
        BodeEvent::BandReleased => Some(Command::EndEdit),
    }
}
