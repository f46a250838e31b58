//! Horizontal range selected by dragging in a group of charts. A chart of the group stores the
//! range while it is drawn; the view takes it from there.

use egui::{Id, Pos2, Ui};
use egui_plot::PlotUi;

/// Horizontal range selected by dragging.
#[derive(Clone, Copy, Debug)]
pub struct DraggedRange {
    /// Lower and upper end.
    pub ends: [f64; 2],
    /// Whether the drag has ended; otherwise the range still changes.
    pub has_ended: bool,
}

/// Drag in a chart, stored in the memory of egui.
#[derive(Clone, Copy, Debug)]
struct Drag {
    /// Start and current coordinate, in either order.
    from: f64,
    to: f64,
    has_ended: bool,
}

/// Returns the id under which the drag in a group is stored.
fn drag_id(group: Id) -> Id {
    group.with("stretch")
}

/// Stores the range that is being selected in a panel.
pub(super) fn store_dragged_range(plot: &PlotUi<'_>, group: Id) {
    let response = plot.response();
    if !response.dragged() && !response.drag_stopped() {
        return;
    }
    let place = |at: Pos2| plot.plot_from_screen(at).x;
    // egui recognises a drag only after a movement of some points, so the range begins at the press
    // position.
    let pressed_at = plot.ctx().input(|input| input.pointer.press_origin());
    let pointer = plot.ctx().input(|input| input.pointer.latest_pos());
    let id = drag_id(group);
    plot.ctx().data_mut(|data| {
        let known = data.get_temp::<Drag>(id);
        let from = match (pressed_at, known) {
            (Some(at), _) => place(at),
            (None, Some(known)) => known.from,
            (None, None) => return,
        };
        let drag = Drag {
            from,
            to: pointer.map_or(from, place),
            has_ended: response.drag_stopped(),
        };
        data.insert_temp(id, drag);
    });
}

/// Returns the range selected by dragging in a group of charts, and removes it if the drag has
/// ended, so that a finished selection is returned once.
pub fn take_dragged_range(ui: &Ui, group: Id) -> Option<DraggedRange> {
    let id = drag_id(group);
    let drag = ui.data(|data| data.get_temp::<Drag>(id))?;
    if drag.has_ended {
        ui.data_mut(|data| data.remove::<Drag>(id));
    }
    Some(DraggedRange {
        ends: [drag.from.min(drag.to), drag.from.max(drag.to)],
        has_ended: drag.has_ended,
    })
}
