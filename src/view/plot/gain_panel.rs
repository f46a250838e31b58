//! One small plot of gains or delays: the optimum of each condition as a dot, and the schedule as a line.

use std::sync::Arc;

use egui::{
    Align2, Color32, FontId, Galley, Id, Mesh, Painter, Pos2, Rect, Response, Sense, Shape, Stroke, Ui, UiBuilder,
    Vec2, WidgetInfo, pos2, vec2,
};
use egui_plot::{Axis, HLine, Line, LineStyle, Plot, PlotBounds, PlotPoint, PlotTransform, PlotUi};
use gdcm_core::dataset::ConditionId;
pub use gdcm_files::figure::{Across, Measure};
use gdcm_files::figure::{LabelledDot, Range, Surroundings};

use super::axes::{LABELLED_HEIGHT, Ladder, axis_hints, caption_font, quiet_plot, tick_text};
use super::curve_style::{LinePattern, Role};
use super::dot::{DOT_RADIUS, Dot, PlacedLabels, area, point, position};
use crate::view::palette::Palette;

const TITLE_HEIGHT: f32 = 18.0;
const GAIN_AXIS_WIDTH: f32 = 30.0;
const RIGHT_MARGIN: f32 = 8.0;
const AIRSPEED_TICK_GAP: f64 = 25.0;
const GAIN_TICK_GAP: f64 = 26.0;
/// How far from a dot the pointer may be to mean it \[pt\].
const PICK_RADIUS: f32 = 10.0;
/// How far bars and bands may widen the range of the dots, as a part of it.
const OF_BARS: f64 = 0.35;
const LABEL_FONT: FontId = FontId::proportional(10.5);
/// Height that a row of label text has above and below its figures \[pt\].
const LABEL_LEADING: f32 = 4.0;

/// One small plot: dots over airspeed or over conditions, with the schedule.
#[derive(Clone, Debug, Default)]
pub struct GainPanel {
    /// What the figure is of: "LAT → P", "LON".
    pub title: String,
    /// What the dots measure.
    pub measure: Measure,
    /// What the horizontal axis stands for.
    pub across: Across,
    /// One dot for each condition; one whose place or value is not finite is left out.
    pub dots: Vec<Dot>,
    /// The schedule, sampled: place on the horizontal axis, and value. Empty where there is none.
    pub schedule: Vec<[f64; 2]>,
    /// The bands of the schedule, rising along the horizontal axis. Empty where there are none.
    pub bands: Vec<GainBand>,
    /// Differences at one airspeed.
    pub brackets: Vec<Bracket>,
}

impl GainPanel {
    /// The scheduled value at a place of the horizontal axis, linear between samples; nothing outside them.
    pub fn scheduled(&self, x: f64) -> Option<f64> {
        let value = |pair: &[[f64; 2]]| {
            let ([from_x, from], [to_x, to]) = (pair[0], pair[1]);
            let fraction = (x - from_x) / (to_x - from_x);
            (0.0..=1.0).contains(&fraction).then_some(from + fraction * (to - from))
        };
        self.schedule.windows(2).find_map(value)
    }

    fn drawable_schedule(&self) -> impl Iterator<Item = [f64; 2]> {
        self.schedule.iter().copied().filter(|point| point.iter().all(|c| c.is_finite()))
    }

    fn drawable_dots(&self) -> impl Iterator<Item = &Dot> {
        self.dots.iter().filter(|dot| dot.x.is_finite() && dot.value.is_finite())
    }
}

/// The ranges that all panels of a group share, so that they can be compared.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct SharedRanges {
    pub(super) x: Range,
    pub(super) value: Range,
}

impl SharedRanges {
    /// What holds all dots and schedules of `panels`, and no correction; nothing where there is no dot.
    pub(super) fn of(panels: &[GainPanel]) -> Option<Self> {
        let first = panels.first()?;
        let dots = || panels.iter().flat_map(GainPanel::drawable_dots);
        let scheduled = panels.iter().flat_map(|panel| panel.schedule.iter().map(|point| point[1]));
        let x = Range::of(dots().map(|dot| dot.x))?;
        let x = match first.across {
            Across::Airspeed => x.with_margin(0.07, 10.0),
            Across::Conditions => Range::new(x.min - 0.6, x.max + 0.6),
        };
        let value = Range::of(dots().map(|dot| dot.value).chain(scheduled))?;
        // Bars and bands are seen as far as they leave the dots their room.
        let spare = OF_BARS * (value.max - value.min);
        let bars = dots().filter_map(|dot| dot.bar).flat_map(|bar| bar.outer);
        let bands = panels.iter().flat_map(|panel| panel.bands.iter().flat_map(|band| band.confidence));
        let beyond = bars.chain(bands).map(|end| end.clamp(value.min - spare, value.max + spare));
        let value = beyond.filter(|end| end.is_finite()).fold(value, Range::including);
        let value = value.including(first.measure.null()).with_margin(0.09, first.measure.least_height());
        Some(Self { x, value })
    }

    /// The least ranges that hold both.
    pub(super) fn union(self, other: Self) -> Self {
        let union = |a: Range, b: Range| a.including(b.min).including(b.max);
        Self { x: union(self.x, other.x), value: union(self.value, other.value) }
    }
}

/// What a panel found out in a frame.
pub(super) struct PanelAnswer {
    pub(super) response: Response,
    pub(super) transform: PlotTransform,
    /// The condition under the pointer.
    pub(super) hovered: Option<ConditionId>,
    /// The condition that was clicked, and whether with the key for commands held.
    pub(super) clicked: Option<(ConditionId, bool)>,
}

/// Draws a panel into `rect`; `hovered` is the condition to emphasise, whichever panel the pointer is in, and `labels` are those of
/// the last frame.
pub(super) fn gain_panel_ui(
    ui: &mut Ui,
    (id, rect): (Id, Rect),
    panel: &GainPanel,
    ranges: SharedRanges,
    (hovered, labels): (Option<ConditionId>, &mut PlacedLabels),
    palette: &Palette,
) -> PanelAnswer {
    let plot_rect = Rect::from_min_max(rect.min + vec2(0.0, TITLE_HEIGHT), rect.max - vec2(RIGHT_MARGIN, 0.0));
    let (response, transform) = frame_ui(ui, (id, plot_rect), panel, ranges, palette);
    let frame = *transform.frame();
    let title_place = pos2(frame.center().x, rect.top() + 0.5 * TITLE_HEIGHT);
    ui.painter().text(title_place, Align2::CENTER_CENTER, &panel.title, caption_font(), palette.text);
    let position = |dot: &Dot| transform.position_from_point(&PlotPoint::new(dot.x, dot.value));
    let placed: Vec<(&Dot, Pos2)> = panel.drawable_dots().map(|dot| (dot, position(dot))).collect();
    let inside = ui.painter().with_clip_rect(frame);
    paint_bands(&inside, &panel.bands, ranges.x, &transform, palette);
    for (dot, center) in &placed {
        if let Some(bar) = &dot.bar {
            bar.paint(&inside, center.x, |value| transform.position_from_point_y(value), dot.color(palette));
        }
    }
    panel.brackets.iter().for_each(|bracket| bracket.paint(&inside, &transform, palette));
    paint_labels(ui, &placed, panel, (&transform, labels), palette);
    let painter = ui.painter().with_clip_rect(frame.expand(DOT_RADIUS));
    paint_bounds(&painter.with_clip_rect(frame), &placed, &transform, palette);
    for (dot, center) in &placed {
        dot.paint(&painter, *center, hovered == Some(dot.condition), palette);
        name_dot(ui, id, panel, dot, *center);
    }
    let condition_at = |pointer: Pos2| Some(nearest_dot(&placed, pointer)?.condition);
    let hovered = response.hover_pos().and_then(condition_at);
    let clicked = response.interact_pointer_pos().filter(|_| response.clicked()).and_then(condition_at);
    let clicked = clicked.map(|condition| (condition, ui.input(|input| input.modifiers.command)));
    PanelAnswer { response, transform, hovered, clicked }
}

/// Where each optimum was looked for, as a faint bar behind its dot.
fn paint_bounds(painter: &Painter, placed: &[(&Dot, Pos2)], transform: &PlotTransform, palette: &Palette) {
    for (dot, center) in placed {
        if let Some([lower, upper]) = dot.bounds {
            let [y0, y1] = [lower, upper].map(|value| transform.position_from_point_y(value));
            let bar = Rect::from_x_y_ranges(center.x - 3.0..=center.x + 3.0, y1.min(y0)..=y0.max(y1));
            let bar = bar.intersect(*transform.frame());
            if bar.is_positive() {
                painter.rect_filled(bar, 0.0, palette.accent.gamma_multiply(0.16));
            }
        }
    }
}

/// The axes, the line of no correction and the schedule.
fn frame_ui(
    ui: &mut Ui,
    (id, rect): (Id, Rect),
    panel: &GainPanel,
    ranges: SharedRanges,
    palette: &Palette,
) -> (Response, PlotTransform) {
    let (x, value) = (ranges.x, ranges.value);
    let bounds = PlotBounds::from_min_max([x.min, value.min], [x.max, value.max]);
    let shown = ui.scope_builder(UiBuilder::new().id_salt(id).max_rect(rect), |ui| {
        gain_plot(id, rect.size(), panel.across, palette).show(ui, |plot| {
            plot.set_plot_bounds(bounds);
            draw_lines(plot, panel, palette);
        })
    });
    let description = format!("{}, {} conditions", panel.title, panel.dots.len());
    let response = shown.inner.response;
    response.widget_info(|| WidgetInfo::labeled(egui::Role::Image, true, description.clone()));
    (response, shown.inner.transform)
}

fn gain_plot<'a>(id: Id, size: Vec2, across: Across, palette: &Palette) -> Plot<'a> {
    let (label, gap) = match across {
        Across::Airspeed => ("Airspeed [kt]", AIRSPEED_TICK_GAP),
        Across::Conditions => ("Condition", f64::INFINITY),
    };
    let horizontal = move |input: egui_plot::GridInput| match across {
        Across::Airspeed => Ladder::Decimal.marks(input.bounds, input.base_step_size, gap),
        Across::Conditions => Vec::new(),
    };
    quiet_plot(id, palette)
        .sense(Sense::click())
        .width(size.x)
        .height(size.y)
        .x_grid_spacer(horizontal)
        .y_grid_spacer(Ladder::Decimal.spacer(GAIN_TICK_GAP))
        .custom_x_axes(vec![axis_hints(Axis::X, label, LABELLED_HEIGHT, palette, tick_text)])
        .custom_y_axes(vec![axis_hints(Axis::Y, "", GAIN_AXIS_WIDTH, palette, tick_text)])
}

fn draw_lines(plot: &mut PlotUi<'_>, panel: &GainPanel, palette: &Palette) {
    let reference = palette.dim_text.gamma_multiply(0.8);
    plot.hline(
        HLine::new("", panel.measure.null()).color(reference).width(1.0).style(LineStyle::Dashed { length: 3.0 }),
    );
    let look = palette.role_style(Role::Scheduled, false);
    let schedule: Vec<[f64; 2]> = panel.drawable_schedule().collect();
    let style = match look.pattern {
        LinePattern::Dashed { length } => LineStyle::Dashed { length },
        _ => LineStyle::Solid,
    };
    plot.line(Line::new("", schedule).color(look.color).width(look.width).style(style));
}

/// The numbers of the conditions, and the factors of the brackets beside them: each where it covers nothing else.
fn paint_labels(
    ui: &Ui,
    placed: &[(&Dot, Pos2)],
    panel: &GainPanel,
    (transform, labels): (&PlotTransform, &mut PlacedLabels),
    palette: &Palette,
) {
    let frame = *transform.frame();
    let painter = ui.painter().with_clip_rect(frame);
    let of_dots = placed.iter().map(|(dot, center)| {
        let color = if dot.selected { palette.text } else { palette.dim_text };
        (painter.layout_no_wrap(dot.label.clone(), LABEL_FONT, color), *center, dot.clearance())
    });
    let spines: Vec<(&Bracket, [Pos2; 2])> =
        panel.brackets.iter().map(|bracket| (bracket, bracket.spine(transform))).collect();
    let of_brackets = spines.iter().filter(|(bracket, _)| bracket.beyond).map(|(bracket, [from, to])| {
        let galley = painter.layout_no_wrap(bracket.label.clone(), LABEL_FONT, palette.warning);
        (galley, from.lerp(*to, 0.5), 1.0)
    });
    let texts: Vec<(Arc<Galley>, Pos2, f32)> = of_dots.chain(of_brackets).collect();
    let labelled = |(galley, center, radius): &(Arc<Galley>, Pos2, f32)| LabelledDot {
        center: point(*center),
        radius: (*radius).into(),
        // What a row of text leaves free above and below its figures need not be kept clear.
        size: [galley.size().x.into(), (galley.size().y - LABEL_LEADING).into()],
    };
    let path = panel.drawable_schedule().map(|[x, y]| transform.position_from_point(&PlotPoint::new(x, y)));
    let y = |value: f64| transform.position_from_point_y(value);
    let of_bars = placed.iter().filter_map(|(dot, center)| Some(dot.bar?.areas(center.x, y)));
    let of_spines = spines.iter().map(|(_, [from, to])| Rect::from_two_pos(*from, *to).expand2(vec2(1.5, 0.0)));
    let around = Surroundings {
        bounds: area(frame.shrink(1.0)),
        path: path.map(point).collect(),
        bars: of_bars.flatten().chain(of_spines).map(|rect| area(rect.intersect(frame))).collect(),
    };
    let places = labels.places(texts.iter().map(labelled).collect(), around);
    for (place, (galley, center, _)) in places.iter().zip(texts) {
        let Some(place) = place else { continue };
        if let Some(end) = place.leader {
            painter.line_segment([center, position(end)], Stroke::new(0.8, palette.dim_text.gamma_multiply(0.6)));
        }
        let corner = position([place.area.left, place.area.top]);
        painter.galley(corner - vec2(0.0, 0.5 * LABEL_LEADING), galley, palette.dim_text);
    }
}

/// A name for screen readers and tests; pointing and clicking are the plot's, which takes the nearest dot.
fn name_dot(ui: &Ui, id: Id, panel: &GainPanel, dot: &Dot, center: Pos2) {
    let place = Rect::from_center_size(center, vec2(2.0, 2.0) * DOT_RADIUS);
    let response = ui.interact(place, id.with(("dot", dot.condition)), Sense::hover());
    let value = match panel.measure {
        Measure::Gain => format!("{:.3}", dot.value),
        Measure::Delay => format!("{:.1} ms", dot.value),
    };
    let text = format!("{}, condition {}: {value} at {:.0} kt", panel.title, dot.label, dot.airspeed_kt);
    response.widget_info(|| WidgetInfo::labeled(egui::Role::Label, true, text.clone()));
}

fn nearest_dot<'a>(placed: &[(&'a Dot, Pos2)], pointer: Pos2) -> Option<&'a Dot> {
    let distances = placed.iter().map(|(dot, center)| (*dot, center.distance(pointer)));
    let nearest = distances.min_by(|(_, a), (_, b)| a.total_cmp(b))?;
    (nearest.1 <= PICK_RADIUS).then_some(nearest.0)
}

/// How much fainter a band is where no condition supports it.
const FADED: f32 = 0.4;
/// Distance of a bracket from its dots, and length of its ends \[pt\].
const BRACKET: [f32; 2] = [9.0, 3.0];

/// The bands of a schedule at one place of the horizontal axis.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct GainBand {
    /// The place.
    pub x: f64,
    /// Where the schedule may lie.
    pub confidence: [f64; 2],
    /// Where another condition would fall.
    pub scatter: [f64; 2],
}

/// The difference of two conditions at one airspeed.
#[derive(Clone, Debug, PartialEq)]
pub struct Bracket {
    /// Where both stand on the horizontal axis.
    pub x: f64,
    /// Their figures.
    pub ends: [f64; 2],
    /// multiple of what is expected: "5.4×".
    pub label: String,
    /// Whether it is more than they explain.
    pub beyond: bool,
}

/// Draws the bands; beyond their first and last place the end values hold, fainter.
pub(super) fn paint_bands(
    painter: &Painter,
    bands: &[GainBand],
    x: Range,
    transform: &PlotTransform,
    palette: &Palette,
) {
    let (Some(first), Some(last)) = (bands.first(), bands.last()) else { return };
    let ends = [GainBand { x: x.min, ..*first }, *first, *last, GainBand { x: x.max, ..*last }];
    for (of, strength) in
        [((|band: &GainBand| band.scatter) as fn(&GainBand) -> [f64; 2], 0.13), (|band| band.confidence, 0.22)]
    {
        let color = palette.corrected.gamma_multiply(strength);
        painter.add(strip(bands, of, transform, color));
        for beyond in ends.chunks(2) {
            painter.add(strip(beyond, of, transform, color.gamma_multiply(FADED)));
        }
    }
}

fn strip(bands: &[GainBand], of: fn(&GainBand) -> [f64; 2], transform: &PlotTransform, color: Color32) -> Shape {
    let mut mesh = Mesh::default();
    for (place, band) in bands.iter().enumerate() {
        for value in of(band) {
            mesh.colored_vertex(transform.position_from_point(&PlotPoint::new(band.x, value)), color);
        }
        if place > 0 {
            let corner = 2 * place as u32;
            mesh.add_triangle(corner - 2, corner - 1, corner);
            mesh.add_triangle(corner - 1, corner, corner + 1);
        }
    }
    Shape::mesh(mesh)
}

impl Bracket {
    /// The ends of its upright line on the screen: at the left of its dots, or at their right where there is no room.
    pub(super) fn spine(&self, transform: &PlotTransform) -> [Pos2; 2] {
        let ends = self.ends.map(|value| transform.position_from_point(&PlotPoint::new(self.x, value)));
        let x = ends[0].x - BRACKET[0];
        let x = if x > transform.frame().left() + 1.0 { x } else { ends[0].x + BRACKET[0] };
        ends.map(|end| pos2(x, end.y))
    }

    /// Draws it; its factor stands among the numbers of the dots where it is more than the bundles explain, and pointing at a dot tells
    /// the others.
    pub(super) fn paint(&self, painter: &Painter, transform: &PlotTransform, palette: &Palette) {
        let color = if self.beyond { palette.warning } else { palette.dim_text };
        let stroke = Stroke::new(1.0, color);
        let [from, to] = self.spine(transform);
        let dots = transform.position_from_point_x(self.x);
        let hook = vec2(BRACKET[1] * (dots - from.x).signum(), 0.0);
        painter.line_segment([from, to], stroke);
        for end in [from, to] {
            painter.line_segment([end, end + hook], stroke);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_schedule_is_linear_between_its_samples() {
        let panel = GainPanel { schedule: vec![[40.0, 1.0], [60.0, 2.0], [80.0, 1.0]], ..GainPanel::default() };
        assert_eq!(panel.scheduled(50.0), Some(1.5));
        assert_eq!(panel.scheduled(80.0), Some(1.0));
        assert_eq!(panel.scheduled(81.0), None);
    }

    #[test]
    fn the_gain_one_is_always_in_view() {
        let dot = Dot {
            condition: ConditionId(0),
            label: "1".into(),
            x: 60.0,
            airspeed_kt: 60.0,
            value: 1.4,
            bounds: None,
            shape: Default::default(),
            filled: true,
            selected: false,
            chosen: true,
            held_out: false,
            bar: None,
            detail: String::new(),
            sentences: Vec::new(),
            figures: Vec::new(),
        };
        let panel = GainPanel { dots: vec![dot], ..GainPanel::default() };
        assert!(
            SharedRanges::of(&[panel]).is_some_and(|ranges| ranges.value.contains(1.0) && ranges.value.contains(1.4))
        );
        assert_eq!(SharedRanges::of(&[GainPanel::default()]), None);
    }
}
