//! Horizontal range selected by dragging in a group of charts.

use egui::{Id, Pos2, Ui};
use egui_plot::PlotUi;

/// Horizontal range selected by dragging.
#[derive(Clone, Copy, Debug)]
struct DraggedStretch {
    /// Start and current coordinate.
    ends: [f64; 2],
    has_ended: bool,
}

/// Returns the id under which the selected range of a group is stored.
fn stretch_id(group: Id) -> Id {
    group.with("stretch")
}

/// Stores the range that is being selected in a panel.
pub(super) fn choose_by_dragging(plot: &PlotUi<'_>, group: Id) {
    let response = plot.response();
    if !response.dragged() && !response.drag_stopped() {
        return;
    }
    let place = |at: Pos2| plot.plot_from_screen(at).x;
    // egui recognises a drag only after a movement of some points, so the range begins at the press
    // position.
    let pressed_at = plot.ctx().input(|input| input.pointer.press_origin());
    let pointer = plot.ctx().input(|input| input.pointer.latest_pos());
    let id = stretch_id(group);
    plot.ctx().data_mut(|data| {
        let known = data.get_temp::<DraggedStretch>(id);
        let from = match (pressed_at, known) {
            (Some(at), _) => place(at),
            (None, Some(known)) => known.ends[0],
            (None, None) => return,
        };
        let stretch = DraggedStretch {
            ends: [from, pointer.map_or(from, place)],
            has_ended: response.drag_stopped(),
        };
        data.insert_temp(id, stretch);
    });
}

/// Returns the range selected by dragging in a group of charts, lower end first, and whether the
/// drag has ended; a finished selection is returned once.
pub fn chosen_stretch(ui: &Ui, group: Id) -> Option<([f64; 2], bool)> {
    let id = stretch_id(group);
    let stretch = ui.data(|data| data.get_temp::<DraggedStretch>(id))?;
    if stretch.has_ended {
        ui.data_mut(|data| data.remove::<DraggedStretch>(id));
    }
    let [from, to] = stretch.ends;
    Some(([from.min(to), from.max(to)], stretch.has_ended))
}
