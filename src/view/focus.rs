//! The keyboard's focus: the parts of the window that F6 goes through, and the ring around what has the focus.

use std::collections::BTreeMap;

use egui::{Context, Id, Key, Modifiers, Rect, Stroke, StrokeKind, Ui, pos2};

use super::palette::Palette;

/// A part of the window, in the order of the F6 key.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Region {
    /// The plots of the view in front.
    Plots,
    /// The plots below them.
    Dock,
    /// What is to be done.
    Verdict,
    /// The result.
    Result,
    /// The constraint matrix.
    Matrix,
    /// The settings.
    Settings,
    /// The way to the export.
    Export,
    /// The list of conditions.
    Conditions,
    /// The bundles of the condition shown.
    Models,
}

/// What the regions were found to hold when they were drawn.
#[derive(Clone, Default)]
struct Regions {
    parts: BTreeMap<Region, Part>,
    /// The rows that are selected, and the pass in which they were drawn: a region that was not visited yet begins with its own.
    selected: (u64, Vec<Id>),
}

#[derive(Clone, Default)]
struct Part {
    /// The pass in which it was drawn last.
    pass: u64,
    /// What in it can have the focus, in the order of the Tab key.
    controls: Vec<Id>,
    /// What had the focus last.
    visited: Option<Id>,
    /// Where it is, as far as it is in view.
    place: Option<Rect>,
}

fn key() -> Id {
    Id::unique("regions")
}

/// Draws a region, or one more piece of it, and keeps in mind what in it can have the focus. What gets the focus by the keyboard
/// is brought into view.
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
        let part = data
            .get_temp_mut_or_default::<Regions>(key())
            .parts
            .entry(region)
            .or_default();
        if part.pass != pass {
            part.controls.clear();
            part.place = None;
        }
        part.pass = pass;
        part.controls.extend(controls);
        part.place = part
            .place
            .map_or(Some(place), |others| Some(others.union(place)));
        part.visited = focused.or(part.visited);
    });
    let arrived = focused
        .and_then(|focused| ctx.read_response(focused))
        .filter(|response| response.gained_focus());
    if let Some(response) = arrived {
        ui.scroll_to_rect(response.rect, None);
    }
    inner
}

/// Says that a row is the selected one of its list, in each frame that draws it.
pub fn begin_with(ctx: &Context, row: Id) {
    let pass = ctx.cumulative_pass_nr();
    ctx.data_mut(|data| {
        let (last, rows) = &mut data.get_temp_mut_or_default::<Regions>(key()).selected;
        if std::mem::replace(last, pass) != pass {
            rows.clear();
        }
        rows.push(row);
    });
}

/// Where a region is in the window, as far as it is in view.
pub fn region_place(ctx: &Context, region: Region) -> Option<Rect> {
    let place = ctx.data_mut(|data| {
        data.get_temp_mut_or_default::<Regions>(key())
            .parts
            .get(&region)?
            .place
    });
    place.filter(|place| place.is_positive())
}

/// Gives the focus to the next region that has a control, or to the one before: to the control that had it last there, else to the
/// selected row, or to the first control.
pub fn leave_region(ctx: &Context, forward: bool) {
    let focused = ctx.memory(|memory| memory.focused());
    let regions = ctx.data_mut(|data| data.get_temp_mut_or_default::<Regions>(key()).clone());
    let parts: Vec<&Part> = regions
        .parts
        .values()
        .filter(|part| !part.controls.is_empty())
        .collect();
    let Some(last) = parts.len().checked_sub(1) else {
        return;
    };
    let here = parts
        .iter()
        .position(|part| focused.is_some_and(|focused| part.controls.contains(&focused)));
    let next = match (here, forward) {
        (None, true) => 0,
        (None, false) => last,
        (Some(here), true) => (here + 1) % parts.len(),
        (Some(here), false) => (here + last) % parts.len(),
    };
    let part = parts[next];
    let visited = part
        .visited
        .filter(|visited| part.controls.contains(visited));
    let selected = part
        .controls
        .iter()
        .find(|control| regions.selected.1.contains(control));
    if let Some(id) = visited
        .or(selected.copied())
        .or(part.controls.first().copied())
    {
        ctx.memory_mut(|memory| memory.request_focus(id));
    }
}

fn had_focus() -> Id {
    Id::unique("had anything the focus")
}

/// Whether a control had the focus when the last frame ended: the Escape key has taken it away by now, and was meant for it.
pub fn was_focused(ctx: &Context) -> bool {
    ctx.data(|data| data.get_temp(had_focus()).unwrap_or(false))
}

/// Takes the Escape key for something that it closes, unless it was meant for a control.
pub fn take_escape(ctx: &Context) -> bool {
    !was_focused(ctx) && ctx.input_mut(|input| input.consume_key(Modifiers::NONE, Key::Escape))
}

/// Width of the ring \[pt\].
const WIDTH: f32 = 2.0;
/// Between the ring and what it surrounds \[pt\].
const GAP: f32 = 1.0;

/// Draws the ring over all that was drawn before: the same around every control, list row, cell and plot.
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

    /// Relative luminance as the Web Content Accessibility Guidelines 2.2 define it.
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
