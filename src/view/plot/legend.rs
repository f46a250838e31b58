//! The legend of a Bode plot: one switch for each role that is present.

use std::collections::BTreeSet;
use std::sync::Arc;

use egui::{Align2, CursorIcon, Galley, Painter, Rect, Sense, Stroke, StrokeKind, Ui, Vec2, WidgetInfo, pos2, vec2};

use super::axes::caption_font;
use super::curve::BodeCurve;
use super::curve_style::{CurveStyle, Role};
use crate::view::palette::Palette;

const ROW_HEIGHT: f32 = 16.5;
const SAMPLE_WIDTH: f32 = 26.0;
const SAMPLE_GAP: f32 = 8.0;
const PADDING: Vec2 = vec2(8.0, 6.0);
const MARGIN: f32 = 9.0;
/// Longest name of a single model shown beside its role, in characters.
const NAME_LENGTH: usize = 22;

/// One line of the legend: a switch.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct LegendEntry {
    pub(super) role: Role,
    pub(super) text: String,
    pub(super) look: CurveStyle,
    /// Whether the curves of the role are drawn.
    pub(super) shown: bool,
}

/// One line for each role among `curves`, drawn or `hidden`, in the order of [`Role::ALL`].
pub(super) fn entries(curves: &[BodeCurve], hidden: &BTreeSet<Role>, palette: &Palette) -> Vec<LegendEntry> {
    let of_role = |role: Role| {
        let members: Vec<&BodeCurve> = curves.iter().filter(|curve| curve.role.shown(curve.rejected) == role).collect();
        let first = members.first()?;
        // One line for kept and rejected nominal models: dotted only where none is kept.
        let rejected = members.iter().all(|curve| curve.rejected);
        let look = palette.role_style(first.role, rejected);
        Some(LegendEntry { role, text: text(role, &members, rejected), look, shown: !hidden.contains(&role) })
    };
    Role::ALL.into_iter().filter_map(of_role).collect()
}

fn text(role: Role, members: &[&BodeCurve], rejected: bool) -> String {
    let name = role.name();
    match (role, members) {
        (Role::Nominal, _) if rejected => format!("{name} (rejected)"),
        (Role::Representative, [only]) if !only.label.is_empty() => {
            let short: String = only.label.chars().take(NAME_LENGTH).collect();
            let ellipsis = if short.len() < only.label.len() { "…" } else { "" };
            format!("{name} {short}{ellipsis}")
        }
        _ => name.to_owned(),
    }
}

/// What the view remembers of a legend.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct LegendState {
    pub(super) is_open: bool,
    /// The corner of the frame it stands in, and the size of the frame it was chosen for.
    pub(super) corner: Option<(Align2, Vec2)>,
    /// Where it was drawn.
    pub(super) rect: Option<Rect>,
}

/// Draws the legend into a corner of `frame`, the one with the fewest of the points that `covered` counts in a place. `plot` tells
/// it from the legends of other plots. A click on its head folds and unfolds it; gives the role
/// whose switch was clicked.
pub(super) fn legend_ui(
    ui: &Ui,
    (frame, plot): (Rect, &str),
    entries: &[LegendEntry],
    state: &mut LegendState,
    covered: impl Fn(Rect) -> usize,
    palette: &Palette,
) -> Option<Role> {
    let painter = ui.painter().with_clip_rect(frame);
    let rows = Rows::new(&painter, entries, palette);
    let has_room = rows.size.x < 0.5 * frame.width() && rows.size.y < 0.75 * frame.height();
    let is_unfolded = state.is_open && has_room;
    let head = painter.layout_no_wrap("Legend".to_owned(), caption_font(), palette.dim_text);
    let size = if is_unfolded { rows.size } else { head.size() + PADDING };
    let room = frame.shrink(MARGIN);
    if entries.is_empty() || size.x > room.width() || size.y > room.height() {
        state.rect = None;
        return None;
    }
    let chosen = state.corner.filter(|(_, size)| *size == room.size());
    let (corner, _) = chosen.unwrap_or_else(|| (emptiest_corner(room, rows.size, covered), room.size()));
    let rect = corner.align_size_within_rect(size, room);
    state.corner = Some((corner, room.size()));
    state.rect = Some(rect);
    let fill = palette.raised.gamma_multiply(0.93);
    ui.painter().rect(rect, 4.0, fill, Stroke::new(1.0, palette.line), StrokeKind::Inside);
    let head_rect = if is_unfolded { rect.with_max_y(rect.top() + PADDING.y + ROW_HEIGHT) } else { rect };
    if head_ui(ui, (head_rect, plot), is_unfolded, palette) && has_room {
        state.is_open = !state.is_open;
    }
    painter.galley(rect.min + 0.5 * PADDING, head, palette.dim_text);
    if is_unfolded { rows.ui(ui, (rect, plot), entries, palette) } else { None }
}

/// The head of the legend, which folds and unfolds it; gives whether it was clicked.
fn head_ui(ui: &Ui, (rect, plot): (Rect, &str), is_unfolded: bool, palette: &Palette) -> bool {
    let response = ui.interact(rect, ui.scope_id().with("legend"), Sense::click());
    let name = if is_unfolded { "Fold the legend" } else { "Unfold the legend" };
    response.widget_info(|| WidgetInfo::selected(egui::Role::Button, true, is_unfolded, format!("{name}{plot}")));
    if response.hovered() || response.has_focus() {
        ui.painter().rect_stroke(rect, 4.0, Stroke::new(1.0, palette.accent), StrokeKind::Inside);
    }
    response.on_hover_cursor(CursorIcon::PointingHand).on_hover_text(name).clicked()
}

/// The lines of the legend, laid out.
struct Rows {
    rows: Vec<(CurveStyle, Arc<Galley>)>,
    /// Size of the whole, with its head and the space around.
    size: Vec2,
}

impl Rows {
    fn new(painter: &Painter, entries: &[LegendEntry], palette: &Palette) -> Self {
        let layout = |entry: &LegendEntry| {
            let color = if entry.shown { palette.text } else { palette.dim_text };
            (entry.look, painter.layout_no_wrap(entry.text.clone(), caption_font(), color))
        };
        let rows: Vec<_> = entries.iter().map(layout).collect();
        let text_width = rows.iter().map(|(_, galley)| galley.size().x).fold(0.0, f32::max);
        let inner = vec2(SAMPLE_WIDTH + SAMPLE_GAP + text_width, ROW_HEIGHT * (rows.len() + 1) as f32);
        Self { rows, size: inner + 2.0 * PADDING }
    }

    /// One switch for each role.
    fn ui(self, ui: &Ui, (rect, plot): (Rect, &str), entries: &[LegendEntry], palette: &Palette) -> Option<Role> {
        let mut answer = None;
        let painter = ui.painter().with_clip_rect(rect);
        for (row, ((look, galley), entry)) in self.rows.into_iter().zip(entries).enumerate() {
            let top = rect.top() + PADDING.y + ROW_HEIGHT * (row + 1) as f32;
            let place = Rect::from_x_y_ranges(rect.shrink(2.0).x_range(), top..=top + ROW_HEIGHT);
            let response = ui.interact(place, ui.scope_id().with(("legend", entry.role)), Sense::click());
            let name = format!("Show {}{plot}", entry.role.name());
            response.widget_info(|| WidgetInfo::selected(egui::Role::CheckBox, true, entry.shown, &name));
            if response.hovered() || response.has_focus() {
                painter.rect_filled(place, 3.0, palette.selected.gamma_multiply(0.6));
            }
            paint_row(&painter, place, entry, look, galley, palette);
            let hint = if entry.shown { "Click: hide these curves" } else { "Click: show these curves" };
            if response.on_hover_cursor(CursorIcon::PointingHand).on_hover_text(hint).clicked() {
                answer = Some(entry.role);
            }
        }
        answer
    }
}

fn paint_row(
    painter: &Painter,
    place: Rect,
    entry: &LegendEntry,
    look: CurveStyle,
    galley: Arc<Galley>,
    palette: &Palette,
) {
    let (left, middle) = (place.left() + PADDING.x - 2.0, place.center().y);
    if entry.shown {
        let mut shapes = Vec::new();
        look.add_shapes(vec![pos2(left, middle), pos2(left + SAMPLE_WIDTH, middle)], &mut shapes);
        painter.extend(shapes);
    }
    let text = pos2(left + SAMPLE_WIDTH + SAMPLE_GAP, middle - 0.5 * galley.size().y);
    let end = text.x + galley.size().x;
    painter.galley(text, galley, palette.text);
    if !entry.shown {
        painter.hline(text.x..=end, middle, Stroke::new(1.0, palette.dim_text));
    }
}

/// The corner of `room` where something of `size` covers least; of equal ones the earlier.
fn emptiest_corner(room: Rect, size: Vec2, covered: impl Fn(Rect) -> usize) -> Align2 {
    let corners = [Align2::RIGHT_TOP, Align2::LEFT_BOTTOM, Align2::RIGHT_BOTTOM, Align2::LEFT_TOP];
    let least = corners.into_iter().min_by_key(|corner| covered(corner.align_size_within_rect(size, room)));
    least.unwrap_or(Align2::RIGHT_TOP)
}

/// What holds for a plot now, and what a click on it does.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Chip {
    /// What it says: "Only V+10kt ×".
    pub text: String,
    /// What a click does.
    pub hint: String,
}

/// Draws chips along the upper edge of `frame`, from left to right; gives the index of the one clicked. `plot` tells them from those
/// of other plots.
pub(super) fn chips_ui(ui: &Ui, (frame, plot): (Rect, &str), chips: &[Chip], palette: &Palette) -> Option<usize> {
    let mut clicked = None;
    let mut left = frame.left() + 8.0;
    for (index, chip) in chips.iter().enumerate() {
        let painter = ui.painter().with_clip_rect(frame);
        let galley = painter.layout_no_wrap(chip.text.clone(), caption_font(), palette.text);
        let size = galley.size() + vec2(14.0, 6.0);
        let place = Align2::LEFT_TOP.anchor_size(pos2(left, frame.top() + 7.0), size);
        left = place.right() + 5.0;
        let response = ui.interact(place, ui.scope_id().with(("chip", index)), Sense::click());
        response.widget_info(|| WidgetInfo::labeled(egui::Role::Button, true, format!("{}{plot}", chip.text)));
        let is_meant = response.hovered() || response.has_focus();
        let outline = if is_meant { palette.accent } else { palette.line };
        painter.rect(place, 0.5 * size.y, palette.selected, Stroke::new(1.0, outline), StrokeKind::Inside);
        painter.galley(place.min + vec2(7.0, 3.0), galley, palette.text);
        if response.on_hover_cursor(CursorIcon::PointingHand).on_hover_text(&chip.hint).clicked() {
            clicked = Some(index);
        }
    }
    clicked
}
