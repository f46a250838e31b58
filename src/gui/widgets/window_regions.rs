//! Window regions: F6 moves the keyboard focus from region to region, and each remembers its
//! focused control.

use std::collections::BTreeMap;

use egui::{Context, Id, Rect, Ui, pos2};

/// Window region, in the order in which F6 visits them.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Region {
    /// Plots in the front view.
    Plots,
    /// Plots in the dock.
    Dock,
    /// Verdict and its steps.
    Verdict,
    Result,
    /// Constraint matrix.
    Matrix,
    Settings,
    /// The export button.
    Export,
    /// Conditions list.
    Conditions,
    /// Bundles in the displayed condition; in the records view, the records.
    Models,
}

/// Regions and selected rows from the last frames, kept in egui's memory.
#[derive(Clone, Default)]
struct Regions {
    drawn: BTreeMap<Region, DrawnRegion>,
    selected: SelectedRows,
}

/// Selected rows. The focus enters an unvisited region at its selected row.
#[derive(Clone, Default)]
struct SelectedRows {
    /// egui pass in which the rows were drawn.
    pass: u64,
    rows: Vec<Id>,
}

/// Region as last drawn.
#[derive(Clone, Default)]
struct DrawnRegion {
    /// egui pass in which the region was last drawn.
    pass: u64,
    /// Focusable controls, in Tab order.
    controls: Vec<Id>,
    /// Control that had the focus last.
    visited: Option<Id>,
    /// Visible rectangle.
    place: Option<Rect>,
}

/// Key for [`Regions`] in egui's memory.
fn key() -> Id {
    Id::unique("regions")
}

/// Draws a region, or another piece of a region, and records its focusable controls:
///
/// 1. count the widgets drawn before, draw the region with `add`, and take the later ones;
/// 2. record them, the visible rectangle, and the focused control if it is among them;
/// 3. scroll to a control that has just received the focus.
pub fn region_ui<R>(ui: &mut Ui, region: Region, add: impl FnOnce(&mut Ui) -> R) -> R {
    // Step 1.
    let layer = ui.layer_id();
    let ctx = ui.ctx().clone();
    let earlier_count =
        ctx.viewport(|viewport| viewport.this_pass.widgets.get_layer(layer).count());
    let top = ui.cursor().top();
    let inner = add(ui);
    let drawn = ui.min_rect();
    let place = Rect::from_min_max(pos2(drawn.left(), top), drawn.max).intersect(ui.clip_rect());
    let controls: Vec<Id> = ctx.viewport(|viewport| {
        let later = viewport
            .this_pass
            .widgets
            .get_layer(layer)
            .skip(earlier_count);
        later
            .filter(|widget| widget.enabled && widget.sense.is_focusable())
            .map(|widget| widget.id)
            .collect()
    });
    // Step 2.
    let focused = ctx
        .memory(|memory| memory.focused())
        .filter(|focused| controls.contains(focused));
    let pass = ctx.cumulative_pass_nr();
    ctx.data_mut(|data| {
        let known = data
            .get_temp_mut_or_default::<Regions>(key())
            .drawn
            .entry(region)
            .or_default();
        // The first piece in this pass replaces what the previous pass recorded.
        if known.pass != pass {
            known.controls.clear();
            known.place = None;
        }
        known.pass = pass;
        known.controls.extend(controls);
        known.place = match known.place {
            Some(others) => Some(others.union(place)),
            None => Some(place),
        };
        known.visited = focused.or(known.visited);
    });
    // Step 3.
    if let Some(focused) = focused
        && let Some(response) = ctx.read_response(focused)
        && response.gained_focus()
    {
        ui.scroll_to_rect(response.rect, None);
    }
    inner
}

/// Marks a row as selected in its list; called in each frame that draws the row.
pub fn mark_selected_row(ctx: &Context, row: Id) {
    let pass = ctx.cumulative_pass_nr();
    ctx.data_mut(|data| {
        let selected = &mut data.get_temp_mut_or_default::<Regions>(key()).selected;
        if selected.pass != pass {
            selected.pass = pass;
            selected.rows.clear();
        }
        selected.rows.push(row);
    });
}

/// Returns a region's visible rectangle as last drawn; `None` if it has not been drawn or no part
/// was visible.
pub fn region_place(ctx: &Context, region: Region) -> Option<Rect> {
    let place = ctx.data_mut(|data| {
        data.get_temp_mut_or_default::<Regions>(key())
            .drawn
            .get(&region)?
            .place
    });
    place.filter(|place| place.is_positive())
}

/// Focuses the next or previous region that has a control: its last focused control, else its
/// selected row, else its first control.
pub fn leave_region(ctx: &Context, forward: bool) {
    let focused = ctx.memory(|memory| memory.focused());
    let regions = ctx.data_mut(|data| data.get_temp_mut_or_default::<Regions>(key()).clone());
    // The key is handled before or after the regions of the same pass are drawn.
    let previous_pass = ctx.cumulative_pass_nr().saturating_sub(1);
    let targets: Vec<&DrawnRegion> = regions
        .drawn
        .values()
        .filter(|target| target.pass >= previous_pass && !target.controls.is_empty())
        .collect();
    let Some(last) = targets.len().checked_sub(1) else {
        return;
    };
    let here = targets
        .iter()
        .position(|target| focused.is_some_and(|focused| target.controls.contains(&focused)));
    let next = match (here, forward) {
        (None, true) => 0,
        (None, false) => last,
        (Some(here), true) => (here + 1) % targets.len(),
        // A step back: `last` is the region count minus 1.
        (Some(here), false) => (here + last) % targets.len(),
    };
    let target = targets[next];
    let visited = target
        .visited
        .filter(|visited| target.controls.contains(visited));
    let selected = target
        .controls
        .iter()
        .find(|control| regions.selected.rows.contains(control));
    if let Some(id) = visited
        .or(selected.copied())
        .or(target.controls.first().copied())
    {
        ctx.memory_mut(|memory| memory.request_focus(id));
    }
}
