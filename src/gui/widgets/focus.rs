//! Keyboard focus: the window regions that F6 visits, and the focus ring.

use std::collections::BTreeMap;

use egui::{Context, Id, Key, Modifiers, Rect, Stroke, StrokeKind, Ui, pos2};

use super::palette::Palette;

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
    /// Bundles in the displayed condition.
    Models,
}

/// Regions and selected rows of the last frames, kept in egui's memory.
#[derive(Clone, Default)]
struct Regions {
    drawn: BTreeMap<Region, DrawnRegion>,
    selected: SelectedRows,
}

/// Selected rows: the focus enters an unvisited region at its selected row.
#[derive(Clone, Default)]
struct SelectedRows {
    /// egui pass in which the rows were drawn.
    pass: u64,
    rows: Vec<Id>,
}

/// A region as last drawn.
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

/// Key of [`Regions`] in egui's memory.
fn key() -> Id {
    Id::unique("regions")
}

/// Draws a region, or a further piece of a region, and records its focusable controls. Scrolls to a
/// control focused by the keyboard.
pub fn region_ui<R>(ui: &mut Ui, region: Region, add: impl FnOnce(&mut Ui) -> R) -> R {
    let layer = ui.layer_id();
    let ctx = ui.ctx().clone();
    let before = ctx.viewport(|viewport| viewport.this_pass.widgets.get_layer(layer).count());
    let top = ui.cursor().top();
    let inner = add(ui);
    let drawn = ui.min_rect();
    let place = Rect::from_min_max(pos2(drawn.left(), top), drawn.max).intersect(ui.clip_rect());
    let controls: Vec<Id> = ctx.viewport(|viewport| {
        let drawn = viewport.this_pass.widgets.get_layer(layer).skip(before);
        drawn
            .filter(|widget| widget.enabled && widget.sense.is_focusable())
            .map(|widget| widget.id)
            .collect()
    });
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
    if let Some(focused) = focused
        && let Some(response) = ctx.read_response(focused)
        && response.gained_focus()
    {
        ui.scroll_to_rect(response.rect, None);
    }
    inner
}

/// Marks a row as the selected row of its list, in each frame that draws it.
pub fn begin_with(ctx: &Context, row: Id) {
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

/// Returns the visible rectangle of a region; `None` if it has not been drawn.
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
    let targets: Vec<&DrawnRegion> = regions
        .drawn
        .values()
        .filter(|target| !target.controls.is_empty())
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
        // One step back: `last` is the number of regions minus 1.
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

/// Key, in egui's memory, of whether a control had the focus after the last frame.
fn had_focus() -> Id {
    Id::unique("had anything the focus")
}

/// Returns whether a control had the focus after the last frame. Such a control has already used
/// Escape, and lost its focus.
pub fn was_focused(ctx: &Context) -> bool {
    ctx.data(|data| data.get_temp(had_focus()).unwrap_or(false))
}

/// Consumes Escape in order to close something, unless a focused control has used the key.
pub fn take_escape(ctx: &Context) -> bool {
    !was_focused(ctx) && ctx.input_mut(|input| input.consume_key(Modifiers::NONE, Key::Escape))
}

/// Ring width \[pt\].
const WIDTH: f32 = 2.0;
/// Gap between the ring and its control \[pt\].
const GAP: f32 = 1.0;

/// Draws the same focus ring around controls, list rows, cells and plots, above all other content.
pub fn focus_ring_ui(ctx: &Context, palette: &Palette) {
    let focused = ctx.memory(|memory| memory.focused());
    ctx.data_mut(|data| data.insert_temp(had_focus(), focused.is_some()));
    let Some(focused) = focused.and_then(|id| ctx.read_response(id)) else {
        return;
    };
    let in_view = focused.interact_rect;
    if !in_view.is_positive() {
        return;
    }
    let painter = ctx
        .layer_painter(focused.layer_id)
        .with_clip_rect(in_view.expand(GAP + WIDTH));
    painter.rect_stroke(
        focused.rect.expand(GAP),
        3.0,
        Stroke::new(WIDTH, palette.accent),
        StrokeKind::Outside,
    );
}

#[cfg(test)]
mod tests {
    use egui::Color32;

    use super::*;

    /// Computes the relative luminance defined by the Web Content Accessibility Guidelines 2.2.
    fn luminance(color: Color32) -> f32 {
        let [r, g, b, _] = egui::Rgba::from(color).to_array();
        0.2126 * r + 0.7152 * g + 0.0722 * b
    }

    #[test]
    fn the_ring_stands_out_from_every_surface_by_three_to_one() {
        for palette in [Palette::dark(), Palette::light()] {
            let ring = luminance(palette.accent);
            for surface in [
                palette.background,
                palette.panel,
                palette.raised,
                palette.selected,
            ] {
                let surface = luminance(surface);
                let contrast = (ring.max(surface) + 0.05) / (ring.min(surface) + 0.05);
                assert!(contrast >= 3.0, "{contrast} in {palette:?}");
            }
        }
    }
}
