//! What the engineer does in a plot over frequency, as commands: the same in all of them.

use std::collections::BTreeSet;
use std::fmt::Write as _;

use crate::view::command::Command;
use crate::view::curve_display::CurveCommand;
use crate::view::plot::{BodeCurve, BodeEvent, BodeQuantity, BodeView, Chip, CurveId, CurveWish, Pane};
use crate::view::state::State;
use gdcm_core::dataset::{Band, ModelId};
use gdcm_core::study::{Edit, Setting};

/// A plot over frequency after it was drawn.
pub(super) struct Drawn<'a> {
    pub(super) quantity: BodeQuantity<'a>,
    pub(super) curves: &'a [BodeCurve],
    pub(super) view: &'a BodeView,
    pub(super) events: Vec<BodeEvent>,
}

/// Pushes what was done in a plot, and what the pointer means in it.
pub(super) fn carry_over(state: &State, drawn: Drawn<'_>, commands: &mut Vec<Command>) {
    let Drawn { quantity, curves, view, events } = drawn;
    for event in events {
        commands.extend(match event {
            BodeEvent::Wished(id, CurveWish::CopyValues) => {
                curves.iter().find(|curve| curve.id == id).map(|curve| Command::CopyText(values(quantity, curve)))
            }
            BodeEvent::ChipClicked(index) => chips(state).into_iter().nth(index).map(|(_, command)| command),
            event => command_of(state, event),
        });
    }
    if let Some(CurveId::Model(id)) = view.hovered() {
        commands.push(Command::Hover(id.clone()));
    }
    commands.extend(view.pointed_omega().map(|omega| CurveCommand::PointAt(omega).into()));
}

fn command_of(state: &State, event: BodeEvent) -> Option<Command> {
    match event {
        BodeEvent::Clicked(CurveId::Model(id)) => Some(reject_or_restore(state, id)),
        BodeEvent::TakenBack(CurveId::Model(id)) => {
            let rejected = state.study.is_rejected(&id);
            Some(Command::Forget(if rejected { Edit::Reject(id) } else { Edit::Restore(id) }))
        }
        BodeEvent::Isolated(CurveId::Model(id)) => Some(Command::Isolate(id)),
        BodeEvent::BandDragged { min, max } => {
            Band::new(min, max).ok().map(|band| Edit::Set(Setting::Band(band)).into())
        }
        BodeEvent::BandReleased => Some(Command::EndEdit),
        BodeEvent::RoleToggled(role) => Some(CurveCommand::ToggleRole(role).into()),
        BodeEvent::RejectedBecause(CurveId::Model(model), reason) => Some(Edit::RejectBecause { model, reason }.into()),
        BodeEvent::Wished(id, wish) => wished(state, id, wish),
        BodeEvent::Boxed(curves) => {
            let models = curves.into_iter().filter_map(|curve| match curve {
                CurveId::Model(id) => Some(id),
                CurveId::Corrected | CurveId::Scheduled | CurveId::WithoutLeads => None,
            });
            Some(CurveCommand::Select(models.collect()).into())
        }
        BodeEvent::CursorPinned(omega) => Some(CurveCommand::PinCursor(omega).into()),
        BodeEvent::CursorsUnpinned => Some(CurveCommand::UnpinCursors.into()),
        BodeEvent::Hovered(_)
        | BodeEvent::Clicked(_)
        | BodeEvent::TakenBack(_)
        | BodeEvent::Isolated(_)
        | BodeEvent::RejectedBecause(..)
        | BodeEvent::ChipClicked(_) => None,
    }
}

fn reject_or_restore(state: &State, id: ModelId) -> Command {
    if state.study.is_rejected(&id) { Edit::Restore(id) } else { Edit::Reject(id) }.into()
}

/// What a wish about a curve asks for.
pub(super) fn wished(state: &State, id: CurveId, wish: CurveWish) -> Option<Command> {
    match (wish, id) {
        (CurveWish::Turn(by), id) => {
            Some(CurveCommand::Turn(state.condition().id(), state.display.pair, id, by).into())
        }
        (CurveWish::RejectOrRestore, CurveId::Model(id)) => Some(reject_or_restore(state, id)),
        (CurveWish::Pin, CurveId::Model(id)) => Some(Edit::Pin(id).into()),
        (CurveWish::Isolate, CurveId::Model(id)) => Some(Command::Isolate(id)),
        (CurveWish::Hide, CurveId::Model(id)) => Some(CurveCommand::HideModel(id).into()),
        (_, CurveId::Model(_) | CurveId::Corrected | CurveId::Scheduled | CurveId::WithoutLeads) => None,
    }
}

/// The numbers of a curve as text: a heading, then a line for each frequency, with tabs between.
fn values(quantity: BodeQuantity<'_>, curve: &BodeCurve) -> String {
    let mut text = format!(
        "{}\nω [rad/s]\t{}\t{}\n",
        curve.label,
        quantity.drawn_label(Pane::Magnitude),
        quantity.drawn_label(Pane::Phase)
    );
    let numbers = curve.omega.iter().zip(curve.magnitude_db.iter().zip(curve.phase_deg.iter()));
    for (omega, (magnitude, phase)) in numbers {
        // Writing to a string cannot fail.
        let _ = writeln!(text, "{omega}\t{magnitude}\t{phase}");
    }
    text
}

/// What holds for the plots over frequency now, with the command that ends it or acts on it.
pub(super) fn chips(state: &State) -> Vec<(Chip, Command)> {
    let chip = |text: String, hint: &str, command: Command| (Chip { text, hint: hint.to_owned() }, command);
    let mut chips = Vec::new();
    if let Some(id) = &state.display.isolated {
        let hint = "Only this model is shown beside the representatives. Click, or Escape: show all";
        chips.push(chip(format!("Only {} ×", id.name), hint, Command::EndIsolation));
    }
    let curves = &state.display.curves;
    let of_condition = |id: &&ModelId| id.condition == state.condition().id();
    let selected: Vec<ModelId> = curves.selected.iter().filter(of_condition).cloned().collect();
    let (rejected, kept): (Vec<ModelId>, Vec<ModelId>) =
        selected.into_iter().partition(|id| state.study.is_rejected(id));
    let any_selected = !(rejected.is_empty() && kept.is_empty());
    if !kept.is_empty() {
        let hint = "Take the models that the box was drawn over out of their bundles";
        chips.push(chip(format!("Reject {}", counted(kept.len())), hint, Edit::RejectEach(kept).into()));
    }
    if !rejected.is_empty() {
        let hint = "Put the rejected models that the box was drawn over back";
        chips.push(chip(format!("Restore {}", counted(rejected.len())), hint, Edit::RestoreEach(rejected).into()));
    }
    if any_selected {
        let hint = "Leave them as they are (Escape)";
        chips.push(chip("Select none ×".to_owned(), hint, CurveCommand::Select(BTreeSet::new()).into()));
    }
    let hidden = curves.hidden_models.iter().filter(of_condition).count();
    if hidden > 0 {
        let hint = "Draw every model again";
        chips.push(chip(format!("{} hidden ×", counted(hidden)), hint, CurveCommand::ShowHidden.into()));
    }
    chips
}

fn counted(models: usize) -> String {
    if models == 1 { "1 model".to_owned() } else { format!("{models} models") }
}
