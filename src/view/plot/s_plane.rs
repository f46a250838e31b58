//! One plot of the s-plane: damping and frequency grid, poles and zeros as marks.

use egui::{Align2, FontId, Id, Painter, Pos2, Rect, Response, Sense, Stroke, Ui, UiBuilder, WidgetInfo, pos2, vec2};
use egui_plot::{Axis, HLine, Line, Plot, PlotBounds, PlotPoint, PlotTransform, PlotUi, VLine};
use gdcm_core::dataset::ModelId;
use gdcm_files::figure::{Range, step_above};

use super::axes::{LABELLED_HEIGHT, Ladder, VERTICAL_TICK_GAP, axis_hints, caption_font, quiet_plot, tick_text};
use super::curve_style::Role;
use super::navigation::turned;
use crate::view::palette::Palette;

const TITLE_HEIGHT: f32 = 18.0;
const VALUE_AXIS_WIDTH: f32 = 40.0;
const RIGHT_MARGIN: f32 = 8.0;
const TICK_GAP: f64 = 44.0;
/// How far from a mark the pointer may be to mean it \[pt\].
const PICK_RADIUS: f32 = 9.0;
/// Damping ratios of the rays.
const DAMPING_RATIOS: [f64; 6] = [0.1, 0.2, 0.4, 0.6, 0.8, 0.95];
/// Points of an arc of equal frequency.
const ARC_POINTS: usize = 60;
/// Widths of an axis that can be in view \[rad/s\].
const WIDTHS: Range = Range { min: 1e-4, max: 1e5 };
const GRID_FONT: FontId = FontId::proportional(10.0);

/// The part of the s-plane in view, and where it was drawn.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct PlaneView {
    /// Real and imaginary parts in view \[rad/s\]; none until there are marks to fit.
    pub(super) ranges: Option<(Range, Range)>,
    pub(super) transform: Option<PlotTransform>,
}

impl PlaneView {
    fn set(&mut self, real: Range, imaginary: Range) {
        if let Some(ranges) = real.limited(WIDTHS).zip(imaginary.limited(WIDTHS)) {
            self.ranges = Some(ranges);
        }
    }

    /// The mark nearest to `pointer`, if one is near; of equally near ones the one on top, which is drawn last.
    pub(super) fn nearest(&self, marks: &[PoleMark], pointer: Pos2) -> Option<usize> {
        let transform = self.transform.as_ref()?;
        let distance = |mark: &PoleMark| position(transform, mark.value).distance(pointer);
        let near = marks.iter().enumerate().map(|(index, mark)| (index, mark, distance(mark)));
        let near = near.filter(|(.., distance)| *distance <= PICK_RADIUS);
        let best = near.min_by(|(_, a, da), (_, b, db)| da.total_cmp(db).then(b.layer().cmp(&a.layer())));
        best.map(|(index, ..)| index)
    }
}

fn position(transform: &PlotTransform, [real, imaginary]: [f64; 2]) -> Pos2 {
    transform.position_from_point(&PlotPoint::new(real, imaginary))
}

/// Draws one plot into `rect` and takes over what panning and zooming made of it.
pub(super) fn plane_ui(
    ui: &mut Ui,
    (title, rect): (&str, Rect),
    marks: &[PoleMark],
    (view, hovered): (&mut PlaneView, Option<usize>),
    palette: &Palette,
) -> Response {
    let (real, imaginary) = view.ranges.unwrap_or((Range::new(-1.0, 1.0), Range::new(-1.0, 1.0)));
    let plot_rect = Rect::from_min_max(rect.min + vec2(0.0, TITLE_HEIGHT), rect.max - vec2(RIGHT_MARGIN, 0.0));
    let id = ui.make_persistent_id(title);
    let bounds = PlotBounds::from_min_max([real.min, imaginary.min], [real.max, imaginary.max]);
    let shown = ui.scope_builder(UiBuilder::new().id_salt(id).max_rect(plot_rect), |ui| {
        plane_plot(id, plot_rect, palette).show(ui, |plot| {
            plot.set_plot_bounds(bounds);
            draw_grid(plot, (real, imaginary), palette);
        })
    });
    let shown = shown.inner;
    let transform = shown.transform;
    let (min, max) = (transform.bounds().min(), transform.bounds().max());
    view.set(Range::new(min[0], max[0]), Range::new(min[1], max[1]));
    view.transform = Some(transform);
    let frame = *transform.frame();
    ui.painter().text(
        pos2(frame.center().x, rect.top() + 0.5 * TITLE_HEIGHT),
        Align2::CENTER_CENTER,
        title,
        caption_font(),
        palette.text,
    );
    let painter = ui.painter().with_clip_rect(frame);
    paint_ray_labels(&painter, &transform, palette);
    paint_marks(&painter, &transform, marks, hovered, palette);
    zoom_by_scrolling(ui, &shown.response, view);
    let description = format!("{title}: {} poles and zeros", marks.len());
    shown.response.widget_info(|| WidgetInfo::labeled(egui::Role::Image, true, description.clone()));
    shown.response
}

fn plane_plot<'a>(id: Id, rect: Rect, palette: &Palette) -> Plot<'a> {
    quiet_plot(id, palette)
        .sense(Sense::click_and_drag())
        .width(rect.width())
        .height(rect.height())
        .allow_drag(true)
        .allow_zoom(true)
        .allow_axis_zoom_drag(true)
        .x_grid_spacer(Ladder::Decimal.spacer(TICK_GAP))
        .y_grid_spacer(Ladder::Decimal.spacer(VERTICAL_TICK_GAP))
        .custom_x_axes(vec![axis_hints(Axis::X, "Re λ [rad/s]", LABELLED_HEIGHT, palette, tick_text)])
        .custom_y_axes(vec![axis_hints(Axis::Y, "Im λ [rad/s]", VALUE_AXIS_WIDTH, palette, tick_text)])
}

/// Rays of equal damping ratio, arcs of equal frequency, and the border of stability.
fn draw_grid(plot: &mut PlotUi<'_>, (real, imaginary): (Range, Range), palette: &Palette) {
    let reach =
        [real.min, real.max, imaginary.min, imaginary.max].into_iter().fold(0.0f64, |far, end| far.max(end.abs()));
    let line = |points: Vec<[f64; 2]>| Line::new("", points).color(palette.line).width(0.8).allow_hover(false);
    for ratio in DAMPING_RATIOS {
        for side in [-1.0, 1.0] {
            let end = [-2.0 * reach * ratio, side * 2.0 * reach * (1.0 - ratio * ratio).sqrt()];
            plot.line(line(vec![[0.0, 0.0], end]));
        }
    }
    let step = step_above(reach / 4.0);
    for radius in (1..=8).map(|k| step * f64::from(k)).take_while(|radius| *radius < 2.0 * reach) {
        let angle = |k: usize| std::f64::consts::PI * (0.5 + k as f64 / ARC_POINTS as f64);
        plot.line(line((0..=ARC_POINTS).map(|k| [radius * angle(k).cos(), radius * angle(k).sin()]).collect()));
    }
    plot.hline(HLine::new("", 0.0).color(palette.line).width(1.0));
    plot.vline(VLine::new("", 0.0).color(palette.dim_text).width(1.2));
}

/// The damping ratio of each ray, where it leaves the upper half of the plot.
fn paint_ray_labels(painter: &Painter, transform: &PlotTransform, palette: &Palette) {
    let frame = transform.frame().shrink(3.0);
    let (left, top) =
        (transform.value_from_position(frame.left_top()).x, transform.value_from_position(frame.left_top()).y);
    if left >= 0.0 || top <= 0.0 {
        return;
    }
    for ratio in DAMPING_RATIOS {
        let slope = (1.0 - ratio * ratio).sqrt() / ratio;
        let length = (-left).min(top / slope);
        let at = position(transform, [-length, length * slope]);
        let align = if length < -left { Align2::LEFT_TOP } else { Align2::LEFT_BOTTOM };
        painter.text(at, align, format!("ζ {ratio}"), GRID_FONT, palette.dim_text);
    }
}

fn paint_marks(
    painter: &Painter,
    transform: &PlotTransform,
    marks: &[PoleMark],
    hovered: Option<usize>,
    palette: &Palette,
) {
    let model = hovered.and_then(|hovered| marks.get(hovered)).map(|mark| &mark.id);
    let is_emphasized = |mark: &PoleMark| mark.highlighted || model == Some(&mark.id);
    let mut order: Vec<&PoleMark> = marks.iter().collect();
    order.sort_by_key(|mark| (is_emphasized(mark), mark.layer()));
    for mark in order {
        mark.paint(painter, position(transform, mark.value), is_emphasized(mark), palette);
    }
    if let Some(mark) = hovered.and_then(|hovered| marks.get(hovered)) {
        painter.circle_stroke(position(transform, mark.value), 9.0, Stroke::new(1.2, palette.text));
    }
}

/// The wheel zooms about the pointer, and so do two fingers.
fn zoom_by_scrolling(ui: &Ui, response: &Response, view: &mut PlaneView) {
    let (Some((real, imaginary)), Some(transform)) = (view.ranges, view.transform) else { return };
    if let Some((turn, pointer)) = turned(ui.ctx(), response) {
        let (factor, fixed) = (f64::from(turn.along_one_axis()), transform.value_from_position(pointer));
        view.set(real.zoomed(factor, fixed.x), imaginary.zoomed(factor, fixed.y));
        ui.ctx().request_repaint();
    }
}

/// What a mark stands for.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum MarkShape {
    /// A pole of a physics model: ×.
    Cross,
    /// A pole of an identified model: +.
    Plus,
    /// A transmission zero: ○.
    Circle,
}

/// A pole or a zero of one model.
#[derive(Clone, Debug)]
pub struct PoleMark {
    /// Whose it is.
    pub id: ModelId,
    /// What hovering says first: the model's name.
    pub label: String,
    /// Further lines for hovering.
    pub details: Vec<String>,
    /// What it stands for.
    pub shape: MarkShape,
    /// The role of its model.
    pub role: Role,
    /// Whether its model is left out.
    pub rejected: bool,
    /// Whether another view points at its model.
    pub highlighted: bool,
    /// Real and imaginary part \[rad/s\].
    pub value: [f64; 2],
}

impl PoleMark {
    /// Place in the order of drawing: what matters most is drawn last, on top.
    pub(super) fn layer(&self) -> usize {
        self.role.layer(self.rejected)
    }

    /// Draws the mark at `center`.
    pub(super) fn paint(&self, painter: &Painter, center: Pos2, is_emphasized: bool, palette: &Palette) {
        let look = palette.role_style(self.role, self.rejected);
        let matters = matches!(self.role, Role::Nominal | Role::Representative | Role::IdentifiedRepresentative);
        let radius = match (matters, is_emphasized) {
            (_, true) => 6.0,
            (true, false) => 5.0,
            (false, false) => 3.2,
        };
        let width = if matters || is_emphasized { 2.0 } else { 1.2 };
        let stroke = Stroke::new(width, look.color.to_opaque());
        match self.shape {
            MarkShape::Cross => {
                for corner in [vec2(radius, radius), vec2(radius, -radius)] {
                    painter.line_segment([center - 0.75 * corner, center + 0.75 * corner], stroke);
                }
            }
            MarkShape::Plus => {
                for end in [vec2(radius, 0.0), vec2(0.0, radius)] {
                    painter.line_segment([center - end, center + end], stroke);
                }
            }
            MarkShape::Circle => {
                painter.circle_stroke(center, 0.8 * radius, stroke);
            }
        }
    }
}
