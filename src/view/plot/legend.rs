//! The legend of a Bode plot: one line for each role that is present.

use std::sync::Arc;

use egui::{
    Align2, CursorIcon, Galley, Painter, Pos2, Rect, Response, Sense, Stroke, StrokeKind, Ui, Vec2, WidgetInfo, pos2,
    vec2,
};

use super::axes::caption_font;
use super::curve::BodeCurve;
use super::line_look::LineLook;
use super::role::Role;
use crate::view::palette::Palette;

const ROW_HEIGHT: f32 = 16.5;
const SAMPLE_WIDTH: f32 = 26.0;
const SAMPLE_GAP: f32 = 8.0;
const PADDING: Vec2 = vec2(8.0, 6.0);
const MARGIN: f32 = 9.0;
/// Longest name of a single model shown beside its role, in characters.
const NAME_LENGTH: usize = 22;

/// One line of the legend.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct LegendEntry {
    pub(super) text: String,
    pub(super) look: LineLook,
}

/// One line for each role among `curves`, in the order of [`Role::ALL`].
pub(super) fn entries(curves: &[BodeCurve], palette: &Palette) -> Vec<LegendEntry> {
    let of_role = |role: Role| {
        let members: Vec<&BodeCurve> = curves.iter().filter(|curve| curve.role.shown(curve.rejected) == role).collect();
        let first = members.first()?;
        // One line for kept and rejected nominal models: dotted only where none is kept.
        let rejected = members.iter().all(|curve| curve.rejected);
        Some(LegendEntry { text: text(role, &members, rejected), look: first.role.look(rejected, palette) })
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

/// Draws the legend into a corner of `frame`, the one with the fewest of the points that `covered` counts in a place.
/// A click folds and unfolds it.
pub(super) fn legend_ui(
    ui: &Ui,
    frame: Rect,
    entries: &[LegendEntry],
    state: &mut LegendState,
    covered: impl Fn(Rect) -> usize,
    palette: &Palette,
) {
    let painter = ui.painter().with_clip_rect(frame);
    let rows = Rows::new(&painter, entries, palette);
    let has_room = rows.size.x < 0.5 * frame.width() && rows.size.y < 0.75 * frame.height();
    let is_unfolded = state.is_open && has_room;
    let folded = painter.layout_no_wrap("Legend".to_owned(), caption_font(), palette.dim_text);
    let size = if is_unfolded { rows.size } else { folded.size() + PADDING };
    let room = frame.shrink(MARGIN);
    if entries.is_empty() || size.x > room.width() || size.y > room.height() {
        state.rect = None;
        return;
    }
    let chosen = state.corner.filter(|(_, size)| *size == room.size());
    let (corner, _) = chosen.unwrap_or_else(|| (emptiest_corner(room, rows.size, covered), room.size()));
    let rect = corner.align_size_within_rect(size, room);
    state.corner = Some((corner, room.size()));
    state.rect = Some(rect);
    let response = frame_ui(ui, rect, is_unfolded, entries, palette);
    if is_unfolded {
        rows.paint(&painter, rect.min + PADDING, palette);
    } else {
        painter.galley(rect.min + 0.5 * PADDING, folded, palette.dim_text);
    }
    if response.clicked() && has_room {
        state.is_open = !state.is_open;
    }
}

/// The ground of the legend, which can be clicked.
fn frame_ui(ui: &Ui, rect: Rect, is_unfolded: bool, entries: &[LegendEntry], palette: &Palette) -> Response {
    let response = ui.interact(rect, ui.scope_id().with("legend"), Sense::click());
    let names: Vec<&str> = entries.iter().map(|entry| entry.text.as_str()).collect();
    let description = format!("Legend: {}", names.join(", "));
    response.widget_info(|| WidgetInfo::selected(egui::Role::Button, true, is_unfolded, description.clone()));
    let outline = if response.hovered() || response.has_focus() { palette.accent } else { palette.line };
    let fill = palette.raised.gamma_multiply(0.93);
    ui.painter().rect(rect, 4.0, fill, Stroke::new(1.0, outline), StrokeKind::Inside);
    response.on_hover_cursor(CursorIcon::PointingHand)
}

/// The lines of the legend, laid out.
struct Rows {
    rows: Vec<(LineLook, Arc<Galley>)>,
    /// Size of the whole, with the space around.
    size: Vec2,
}

impl Rows {
    fn new(painter: &Painter, entries: &[LegendEntry], palette: &Palette) -> Self {
        let layout = |entry: &LegendEntry| {
            (entry.look, painter.layout_no_wrap(entry.text.clone(), caption_font(), palette.text))
        };
        let rows: Vec<_> = entries.iter().map(layout).collect();
        let text_width = rows.iter().map(|(_, galley)| galley.size().x).fold(0.0, f32::max);
        let inner = vec2(SAMPLE_WIDTH + SAMPLE_GAP + text_width, ROW_HEIGHT * rows.len() as f32);
        Self { rows, size: inner + 2.0 * PADDING }
    }

    fn paint(self, painter: &Painter, corner: Pos2, palette: &Palette) {
        for (row, (look, galley)) in self.rows.into_iter().enumerate() {
            let middle = corner.y + ROW_HEIGHT * (row as f32 + 0.5);
            let sample = [pos2(corner.x, middle), pos2(corner.x + SAMPLE_WIDTH, middle)];
            let mut shapes = Vec::new();
            look.add_shapes(sample.to_vec(), &mut shapes);
            painter.extend(shapes);
            let text = pos2(corner.x + SAMPLE_WIDTH + SAMPLE_GAP, middle - 0.5 * galley.size().y);
            painter.galley(text, galley, palette.text);
        }
    }
}

/// The corner of `room` where something of `size` covers least; of equal ones the earlier.
fn emptiest_corner(room: Rect, size: Vec2, covered: impl Fn(Rect) -> usize) -> Align2 {
    let corners = [Align2::RIGHT_TOP, Align2::LEFT_BOTTOM, Align2::RIGHT_BOTTOM, Align2::LEFT_TOP];
    let least = corners.into_iter().min_by_key(|corner| covered(corner.align_size_within_rect(size, room)));
    least.unwrap_or(Align2::RIGHT_TOP)
}
