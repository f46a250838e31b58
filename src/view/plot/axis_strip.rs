//! An axis taken hold of: the wheel over it zooms it, dragging it pans it, a double click or a secondary click asks for its limits.

use egui::{
    CursorIcon, Popup, PopupCloseBehavior, Rect, Response, RichText, Role, Sense, TextEdit, Ui, Vec2, WidgetInfo,
};

use super::bode::BodeScene;
use super::bode_view::BodeView;
use super::curve::Pane;
use super::plot_axis::PlotAxis;
use super::wheel::turned;
use crate::view::palette::{Palette, SMALL_SIZE};

/// Limits of an axis being typed.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct LimitsForm {
    axis: PlotAxis,
    /// The pane whose axis was asked.
    pane: Pane,
    texts: [String; 2],
    /// Why they are not shown.
    trouble: Option<String>,
    is_new: bool,
}

/// Lets the axes of a pane, drawn into `rect`, be taken hold of.
pub(super) fn axis_strips_ui(
    ui: &Ui,
    (pane, rect): (Pane, Rect),
    scene: &BodeScene<'_>,
    view: &mut BodeView,
    palette: &Palette,
) {
    let Some(frame) = view.transform(pane).map(|transform| *transform.frame()) else { return };
    let below = Rect::from_x_y_ranges(frame.x_range(), frame.bottom()..=rect.bottom());
    let beside = Rect::from_x_y_ranges(rect.left()..=frame.left(), frame.y_range());
    for (axis, strip, icon) in [
        (PlotAxis::Frequency, below, CursorIcon::ResizeHorizontal),
        (PlotAxis::Values(pane), beside, CursorIcon::ResizeVertical),
    ] {
        let name = axis.name(scene, pane);
        // Not a stop of the Tab key: the plot itself takes all of these wishes from the keyboard.
        let response = ui.interact(strip, ui.scope_id().with(&name), Sense::CLICK | Sense::DRAG);
        response.widget_info(|| WidgetInfo::labeled(Role::ScrollBar, true, &name));
        let response = response.on_hover_cursor(icon);
        take_hold(ui, (axis, pane), &response, view);
        if response.double_clicked() || response.secondary_clicked() {
            let texts = axis.texts(scene, view.axis(axis));
            view.limits = Some(LimitsForm { axis, pane, texts, trouble: None, is_new: true });
        }
        limits_ui(ui, (axis, pane), &response, scene, view, palette);
    }
}

fn take_hold(ui: &Ui, (axis, pane): (PlotAxis, Pane), response: &Response, view: &mut BodeView) {
    let drag = response.drag_delta();
    if drag != Vec2::ZERO {
        view.pan_axis(axis, pane, drag);
        ui.ctx().request_repaint();
    }
    if let Some((turn, pointer)) = turned(ui.ctx(), response) {
        view.zoom_axis(axis, pane, pointer, f64::from(turn.along_one_axis()));
        ui.ctx().request_repaint();
    }
}

/// The form for the limits, beside the axis, where it is this axis that was asked.
fn limits_ui(
    ui: &Ui,
    (axis, pane): (PlotAxis, Pane),
    strip: &Response,
    scene: &BodeScene<'_>,
    view: &mut BodeView,
    palette: &Palette,
) {
    let Some(mut form) = view.limits.take_if(|form| (form.axis, form.pane) == (axis, pane)) else { return };
    let mut is_open = true;
    let popup = Popup::from_response(strip)
        .open_bool(&mut is_open)
        .close_behavior(PopupCloseBehavior::CloseOnClickOutside)
        .accessible_name("Limits of the axis");
    let answer = popup.show(|ui| form_ui(ui, &mut form, scene, palette)).map(|shown| shown.inner).unwrap_or_default();
    if answer != FormAnswer::Waiting {
        ui.ctx().request_repaint();
    }
    match answer {
        FormAnswer::Waiting => {}
        FormAnswer::Fit => {
            view.fit_axis(axis);
            is_open = false;
        }
        FormAnswer::Show => match axis.range(scene, &form.texts) {
            Ok(range) => {
                view.choose(axis, range);
                is_open = false;
            }
            Err(refusal) => form.trouble = Some(refusal.to_string()),
        },
    }
    if is_open {
        view.limits = Some(form);
    }
}

/// What was decided in the form.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
enum FormAnswer {
    #[default]
    Waiting,
    Show,
    Fit,
}

fn form_ui(ui: &mut Ui, form: &mut LimitsForm, scene: &BodeScene<'_>, palette: &Palette) -> FormAnswer {
    let mut answer = FormAnswer::Waiting;
    let unit = form.axis.unit(scene);
    ui.set_max_width(190.0);
    for (text, name) in form.texts.iter_mut().zip(["Lower limit", "Upper limit"]) {
        ui.horizontal(|ui| {
            ui.label(format!("{name}{unit}"));
            let field = ui.add(TextEdit::singleline(text).desired_width(70.0));
            field.widget_info(|| WidgetInfo::labeled(Role::TextInput, true, name));
            if form.is_new {
                field.request_focus();
                form.is_new = false;
            }
            if field.lost_focus() && ui.input(|input| input.key_pressed(egui::Key::Enter)) {
                answer = FormAnswer::Show;
            }
            field.on_hover_text(format!("The {} of what is in view{unit}; Enter shows it", name.to_lowercase()));
        });
    }
    if let Some(trouble) = &form.trouble {
        ui.label(RichText::new(trouble).size(SMALL_SIZE).color(palette.warning));
    }
    ui.horizontal(|ui| {
        if ui.button("Show limits").on_hover_text("Show what lies between the limits").clicked() {
            answer = FormAnswer::Show;
        }
        if ui.button("Fit axis").on_hover_text("Show all of the curves on this axis").clicked() {
            answer = FormAnswer::Fit;
        }
    });
    answer
}
