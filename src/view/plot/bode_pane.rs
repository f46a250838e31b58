//! One of the two stacked plots: axes, band, curves and cursor.

use crate::view::plot::LogAxis;
use crate::view::plot::RoleLook;
use egui::{Context, Id, PointerButton, Rect, Response, Ui, UiBuilder, WidgetInfo};
use egui_plot::{Axis, LineStyle, PlotTransform, PlotUi, Span, VLine};

use super::axes::{LABELLED_HEIGHT, TICKS_HEIGHT, axis_hints, keep_ground, quiet_plot};
use super::axis_strip::axis_strips_ui;
use super::bode::BodeScene;
use super::bode_view::BodeView;
use super::curve::{BodeCurve, CurveId, Pane};
use super::curve_item::CurveItem;
use super::drawn_box::drawn_box_ui;
use super::drawn_curves::DrawnCurves;
use super::pixel::Pixel;
use super::plot_keys::plot_keys;
use super::role::Role;
use super::rule::{rules_ui, strips_ui};
use super::still_image::{CachedRaster, ImageItem, MANY, StillScene};
use super::wheel::{Turn, turned};
use crate::view::palette::Palette;

/// Width of the vertical axes \[pt\]: the same above and below, so that the frequencies stand under one another.
const VALUE_AXIS_WIDTH: f32 = 52.0;
/// How far from a curve its drawn line may be \[pt\].
const TOLERANCE: f64 = 0.1;

/// What is left of the strength of curves that are being computed anew.
const STALE: f32 = 0.5;

/// What the panes draw beside the scene's own.
pub(super) struct Emphasis {
    /// The curve that the pointer means.
    pub(super) curve: Option<CurveId>,
    /// The `log10 omega` under the pointer, in whichever pane it is.
    pub(super) cursor: Option<f64>,
}

/// Draws a pane into `rect`, and pans and zooms it as the pointer says.
pub(super) fn pane_ui(
    ui: &mut Ui,
    (pane, rect): (Pane, Rect),
    scene: &BodeScene<'_>,
    view: &mut BodeView,
    emphasis: &Emphasis,
    palette: &Palette,
) -> Response {
    let name = scene.quantity.name(pane);
    let id = ui.make_persistent_id(name);
    let builder = UiBuilder::new().id_salt(name).max_rect(rect);
    let (drawn, image) = view.drawn(pane);
    let (mut kept, mut kept_image) = (std::mem::take(drawn), std::mem::take(image));
    let (drawn, image) = (&mut kept, &mut kept_image);
    let shown = ui.scope_builder(builder, |ui| {
        keep_ground(ui);
        let bounds = view.bounds(pane);
        pane_plot(id, pane, rect, scene, palette).show(ui, move |plot| {
            plot.set_plot_bounds(bounds);
            band_shade(plot, scene.band, palette);
            let transform = PlotTransform::new(*plot.transform().frame(), bounds, false);
            let pixel = Pixel::of(&transform, plot.ctx().pixels_per_point(), TOLERANCE);
            drawn.update(scene.curves, pane, (bounds, pixel), palette);
            scene.bands.iter().for_each(|band| band.draw(plot, pane, &bounds, palette));
            let image = image_of_many(plot.ctx(), scene, drawn, image, &transform, palette);
            draw_curves(plot, scene, drawn, image, emphasis, palette);
            outside_shade(plot, scene.band, palette);
            draw_cursors(plot, scene.pinned, emphasis.cursor, palette);
        })
    });
    let shown = shown.inner;
    (*view.drawn(pane).0, *view.drawn(pane).1) = (kept, kept_image);
    view.remember(pane, shown.transform);
    drag(ui, pane, &shown.response, view, palette);
    zoom_by_scrolling(ui, pane, &shown.response, view);
    plot_keys(ui, pane, &shown.response, view);
    axis_strips_ui(ui, (pane, rect), scene, view, palette);
    rules_ui(ui, scene.rules, pane, &shown.transform, palette);
    strips_ui(ui, scene.strips, &shown.transform, palette);
    let description = format!("{name} of {}, {} curves", scene.pair_title, scene.curves.len());
    shown.response.widget_info(|| WidgetInfo::labeled(egui::Role::Image, true, description.clone()));
    shown.response
}

/// The primary button pans, with Shift it draws a box over curves; the secondary one draws a box to zoom into.
fn drag(ui: &Ui, pane: Pane, response: &Response, view: &mut BodeView, palette: &Palette) {
    let Some(frame) = view.transform(pane).map(|transform| *transform.frame()) else { return };
    if response.drag_started_by(PointerButton::Primary) {
        view.is_selecting = ui.input(|input| input.modifiers.shift);
    }
    if view.is_selecting {
        let area = drawn_box_ui(ui, response, frame, PointerButton::Primary, palette);
        view.selection = area.map(|area| (pane, area)).or(view.selection);
    } else if response.dragged_by(PointerButton::Primary) {
        view.pan(pane, response.drag_delta());
        ui.ctx().request_repaint();
    }
    if let Some(area) = drawn_box_ui(ui, response, frame, PointerButton::Secondary, palette) {
        view.zoom_to(pane, area);
        ui.ctx().request_repaint();
    }
}

fn pane_plot<'a>(id: Id, pane: Pane, rect: Rect, scene: &BodeScene<'_>, palette: &Palette) -> egui_plot::Plot<'a> {
    let unit = scene.unit;
    let (frequency_label, frequency_height) = match pane {
        Pane::Magnitude => (String::new(), TICKS_HEIGHT),
        Pane::Phase => (unit.axis_label(), LABELLED_HEIGHT),
    };
    let frequency_text = move |mark| unit.tick_text(mark);
    let (values, value_label) = (scene.quantity.unit(pane), scene.quantity.axis_label(pane));
    let value_text = move |mark| values.tick_text(mark);
    quiet_plot(id, palette)
        .width(rect.width())
        .height(rect.height())
        .x_grid_spacer(unit.spacer())
        .y_grid_spacer(values.spacer())
        .custom_x_axes(vec![axis_hints(Axis::X, &frequency_label, frequency_height, palette, frequency_text)])
        .custom_y_axes(vec![axis_hints(Axis::Y, &value_label, VALUE_AXIS_WIDTH, palette, value_text)])
}

fn band_shade(plot: &mut PlotUi<'_>, (min, max): (f64, f64), palette: &Palette) {
    let fill = palette.accent.gamma_multiply(if palette.is_dark { 0.055 } else { 0.075 });
    plot.span(Span::new("", min.log10()..=max.log10()).fill(fill).border_width(0.0));
}

/// Dims what lies outside the band: it is drawn, but does not count.
fn outside_shade(plot: &mut PlotUi<'_>, (min, max): (f64, f64), palette: &Palette) {
    let veil = palette.background.gamma_multiply(0.4);
    for range in [f64::NEG_INFINITY..=min.log10(), max.log10()..=f64::INFINITY] {
        plot.span(Span::new("", range).fill(veil).border_width(0.0));
    }
}

/// Draws the curves, what matters most on top. Where very many lie at the bottom, those are one image, and lines once more
/// while the pointer means them.
fn draw_curves<'a>(
    plot: &mut PlotUi<'a>,
    scene: &BodeScene<'_>,
    drawn: &'a DrawnCurves,
    image: Option<ImageItem>,
    emphasis: &Emphasis,
    palette: &Palette,
) {
    let is_emphasized = |curve: &BodeCurve| curve.highlighted || emphasis.curve.as_ref() == Some(&curve.id);
    let mut curves: Vec<(usize, &BodeCurve)> = scene.curves.iter().enumerate().collect();
    if let Some(image) = image {
        plot.add(image);
        curves.retain(|(_, curve)| !lies_at_the_bottom(curve) || is_emphasized(curve));
    }
    curves.sort_by_key(|(_, curve)| (is_emphasized(curve), curve.role.layer(curve.rejected)));
    for (index, curve) in curves {
        let mut look = curve.role.look(curve.rejected, palette);
        if is_emphasized(curve) {
            look = look.emphasized();
        } else if scene.stale {
            look.color = look.color.gamma_multiply(STALE);
        }
        plot.add(CurveItem::new(drawn.runs(index), look));
    }
}

/// The image of the curves at the bottom, if there are very many and they stand still.
fn image_of_many(
    ctx: &Context,
    scene: &BodeScene<'_>,
    drawn: &DrawnCurves,
    image: &mut CachedRaster,
    transform: &PlotTransform,
    palette: &Palette,
) -> Option<ImageItem> {
    let mut curves: Vec<_> = scene.curves.iter().enumerate().filter(|(_, curve)| lies_at_the_bottom(curve)).collect();
    if curves.len() < MANY {
        return None;
    }
    curves.sort_by_key(|(_, curve)| curve.role.layer(curve.rejected));
    let look = |curve: &BodeCurve| curve.role.look(curve.rejected, palette);
    let still = StillScene {
        frame: *transform.frame(),
        pixels_per_point: ctx.pixels_per_point(),
        curves: curves.iter().map(|(index, curve)| (drawn.serial(*index), look(curve))).collect(),
    };
    let image = image.of(ctx, still, || {
        let lines =
            |(index, curve): &(usize, &BodeCurve)| CurveItem::new(drawn.runs(*index), look(curve)).lines(transform);
        curves.iter().flat_map(lines).collect()
    });
    image.map(|image| if scene.stale { image.faded(STALE) } else { image })
}

/// Whether a curve is one of many that only say how far their bundle reaches.
fn lies_at_the_bottom(curve: &BodeCurve) -> bool {
    curve.role.layer(curve.rejected) <= Role::Perturbed.layer(false)
}

fn draw_cursors(plot: &mut PlotUi<'_>, pinned: &[f64], cursor: Option<f64>, palette: &Palette) {
    for omega in pinned {
        plot.vline(VLine::new("", omega.log10()).color(palette.text.gamma_multiply(0.7)).width(1.0));
    }
    if let Some(log_omega) = cursor {
        let color = palette.text.gamma_multiply(0.55);
        plot.vline(VLine::new("", log_omega).color(color).width(0.8).style(LineStyle::Dotted { spacing: 4.0 }));
    }
}

/// The wheel zooms about the pointer, and so do two fingers; the sideways wheel only along the frequency axis.
fn zoom_by_scrolling(ui: &Ui, pane: Pane, response: &Response, view: &mut BodeView) {
    if let Some((Turn { both, sideways }, pointer)) = turned(ui.ctx(), response) {
        view.zoom(pane, pointer, f64::from(both.x * sideways), f64::from(both.y));
        ui.ctx().request_repaint();
    }
}
