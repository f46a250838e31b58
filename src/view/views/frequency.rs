//! What the engineer does in a plot over frequency, as commands: the same in all of them.

use crate::dataset::Band;
use crate::study::{Edit, Setting};
use crate::view::command::Command;
use crate::view::plot::{BodeEvent, CurveId};
use crate::view::state::State;

/// Pushes what `events` of a plot stand for, and that the model of the curve `hovered` is pointed at.
pub(super) fn carry_over(
    state: &State,
    events: Vec<BodeEvent>,
    hovered: Option<&CurveId>,
    commands: &mut Vec<Command>,
) {
    commands.extend(events.into_iter().filter_map(|event| command_of(state, event)));
    if let Some(CurveId::Model(id)) = hovered {
        commands.push(Command::Hover(id.clone()));
    }
}

fn command_of(state: &State, event: BodeEvent) -> Option<Command> {
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
