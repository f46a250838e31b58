//! Panel painter: frame, axes and grid, and the layers added by the scene. Draws every plot with
//! axes, and the frames for plots without axes.

use egui::{
    Color32, Id, Rect, Response, Sense, Stroke, StrokeKind, Ui, UiBuilder, Vec2, Vec2b, WidgetInfo,
};
use egui_plot::{Axis, Plot, PlotTransform, PlotUi};

use gdcm_plot::figure::Range;

use super::panel_axis::PanelAxis;
use super::ticks::GRID_SPACING;
use crate::gui::widgets::palette::Palette;

/// Panel on the screen, without its content.
pub(super) struct PanelPainter<'a> {
    pub(super) id: Id,
    /// Place for the panel with its axes.
    pub(super) rect: Rect,
    /// Accessible name.
    pub(super) name: &'a str,
    /// Horizontal axis.
    pub(super) across: PanelAxis,
    /// Vertical axis.
    pub(super) values: PanelAxis,
    pub(super) gestures: Gestures,
    /// Whether the background below already has the right colour: without a graphics processor,
    /// filling every pixel twice takes time.
    pub(super) is_transparent: bool,
    pub(super) palette: &'a Palette,
}

/// Gestures handled by the panel itself; its owner handles all others.
#[derive(Clone, Copy, Debug)]
pub(super) enum Gestures {
    /// None; clicks and drags are passed to the owner.
    Reported,
    /// None; only clicks are passed to the owner.
    Clicks,
    /// Dragging pans; pinching and dragging along an axis zoom.
    PanAndZoom,
    /// Dragging pans along the chosen axes, and dragging along an axis zooms. The ranges follow the
    /// data until a gesture changes them; after a double click they follow the data again.
    Following(Follow),
}

/// Behaviour of a panel whose ranges follow its data.
#[derive(Clone, Copy, Debug)]
pub(super) struct Follow {
    /// Axes along which dragging pans.
    pub(super) pans: Vec2b,
    /// Margin at either end, relative to the axis length.
    pub(super) margins: Vec2,
    /// Panels with the same group share their horizontal range.
    pub(super) group: Option<Id>,
    /// Horizontal range, in axis coordinates, if it is not the data range.
    pub(super) whole_across: Option<Range>,
    /// Vertical range, if it is not the data range.
    pub(super) values: Option<Range>,
}

/// Result of drawing a panel.
pub(super) struct PanelResponse<R> {
    pub(super) response: Response,
    /// Transform from axis coordinates to the screen.
    pub(super) transform: PlotTransform,
    /// Value returned by the content.
    pub(super) inner: R,
}

impl PanelPainter<'_> {
    /// Draws the panel; `content` sets its ranges and adds its layers, from bottom to top.
    pub(super) fn show<'p, R>(
        &self,
        ui: &mut Ui,
        content: impl FnOnce(&mut PlotUi<'p>) -> R + 'p,
    ) -> PanelResponse<R> {
        let builder = UiBuilder::new().id_salt(self.id).max_rect(self.rect);
        let shown = ui.scope_builder(builder, |ui| {
            if self.is_transparent {
                ui.visuals_mut().extreme_bg_color = Color32::TRANSPARENT;
            }
            self.empty_plot().show(ui, content)
        });
        let shown = shown.inner;
        shown
            .response
            .widget_info(|| WidgetInfo::labeled(egui::Role::Image, true, self.name));
        PanelResponse {
            response: shown.response,
            transform: shown.transform,
            inner: shown.inner,
        }
    }

    /// Returns the plot with axes, grid and gestures, but without content.
    fn empty_plot<'p>(&self) -> Plot<'p> {
        let plot = quiet_plot(self.id, self.palette)
            .width(self.rect.width())
            .height(self.rect.height())
            .show_grid([self.across.has_grid(), self.values.has_grid()])
            .x_grid_spacer(self.across.spacer())
            .y_grid_spacer(self.values.spacer())
            .custom_x_axes(self.across.hints(Axis::X, self.palette))
            .custom_y_axes(self.values.hints(Axis::Y, self.palette));
        match self.gestures {
            Gestures::Reported => plot,
            Gestures::Clicks => plot.sense(Sense::click()),
            Gestures::PanAndZoom => plot
                .sense(Sense::click_and_drag())
                .allow_drag(true)
                .allow_axis_zoom_drag(true),
            Gestures::Following(follow) => following(plot, follow),
        }
    }
}

/// Creates a plot without interaction; its content sets the ranges.
fn quiet_plot<'p>(id: Id, palette: &Palette) -> Plot<'p> {
    Plot::new(id)
        .id(id)
        .allow_drag(false)
        .allow_zoom(false)
        .allow_scroll(false)
        .allow_boxed_zoom(false)
        .allow_axis_zoom_drag(false)
        .allow_double_click_reset(false)
        .show_x(false)
        .show_y(false)
        .grid_spacing(GRID_SPACING)
        .grid_color(palette.grid)
        .auto_bounds(false)
}

fn following<'p>(plot: Plot<'p>, follow: Follow) -> Plot<'p> {
    let mut plot = plot
        .sense(Sense::click_and_drag())
        .auto_bounds(true)
        .allow_drag(follow.pans)
        .allow_axis_zoom_drag(true)
        .allow_double_click_reset(true)
        .set_margin_fraction(follow.margins);
    if let Some(range) = follow.whole_across {
        plot = plot.default_x_bounds(range.min, range.max);
    }
    if let Some(range) = follow.values {
        plot = plot.default_y_bounds(range.min, range.max);
    }
    match follow.group {
        Some(group) => plot
            .link_axis(group, Vec2b::new(true, false))
            .link_cursor(group, Vec2b::new(true, false)),
        None => plot,
    }
}

/// Corner radius of a frame \[pt\]; egui_plot uses the same for panels with axes.
const FRAME_RADIUS: f32 = 2.0;

/// Paints the frame for a plot without axes, like the frame that egui_plot paints for a panel with
/// axes.
pub(super) fn paint_frame(ui: &Ui, rect: Rect, fill: Color32, outline: Stroke) {
    ui.painter()
        .rect(rect, FRAME_RADIUS, fill, outline, StrokeKind::Inside);
}

/// Sets the frame colours in `ui` from the palette, regardless of the surrounding style.
pub(super) fn use_frame_colors(ui: &mut Ui, palette: &Palette) {
    let visuals = ui.visuals_mut();
    visuals.extreme_bg_color = palette.background;
    visuals.widgets.noninteractive.bg_stroke.color = palette.line;
}
