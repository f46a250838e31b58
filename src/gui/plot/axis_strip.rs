//! Interactive axes: the wheel zooms, dragging pans, a double click or a secondary click opens the
//! form for the axis limits.
//!
//! A strip is the area of an axis beside a pane's frame that reacts to the pointer: values at the
//! left, frequencies below the frame. Where the axis is not drawn, as below the magnitudes, the
//! strip has no extent.

use egui::{
    CursorIcon, Popup, PopupCloseBehavior, Rect, Response, Role, Sense, Ui, Vec2, WidgetInfo, vec2,
};

use super::bode_axis::BodeAxis;
use super::bode_view::BodeView;
use super::limits_form::{FormAnswer, LimitsForm};
use super::pane_scene::PaneScene;
use super::zoom_gesture::ZoomGesture;

/// Screen strip along an axis.
struct AxisStrip<'a> {
    axis: BodeAxis,
    pane: PaneScene<'a>,
    place: Rect,
    icon: CursorIcon,
}

/// Makes both axes in a pane interactive.
pub(super) fn axis_strips_ui(ui: &Ui, pane: PaneScene<'_>, view: &mut BodeView) {
    let Some(frame) = view.frame(pane.pane) else {
        return;
    };
    let below = frame.bottom()..=pane.rect.bottom();
    let beside = pane.rect.left()..=frame.left();
    let strips = [
        AxisStrip {
            axis: BodeAxis::Frequency,
            pane,
            place: Rect::from_x_y_ranges(frame.x_range(), below),
            icon: CursorIcon::ResizeHorizontal,
        },
        AxisStrip {
            axis: BodeAxis::Values(pane.pane),
            pane,
            place: Rect::from_x_y_ranges(beside, frame.y_range()),
            icon: CursorIcon::ResizeVertical,
        },
    ];
    for strip in strips {
        strip.ui(ui, view);
    }
}

impl AxisStrip<'_> {
    fn ui(&self, ui: &Ui, view: &mut BodeView) {
        let PaneScene { pane, scene, .. } = self.pane;
        let name = self.axis.name(scene, pane);
        // The sense is not focusable by Tab: the plot itself has the same actions on the keyboard.
        let sense = Sense::CLICK | Sense::DRAG;
        let response = ui.interact(self.place, ui.scope_id().with(&name), sense);
        response.widget_info(|| WidgetInfo::labeled(Role::ScrollBar, true, &name));
        let response = response.on_hover_cursor(self.icon);
        self.pan_and_zoom(&response, view);
        if response.double_clicked() || response.secondary_clicked() {
            let texts = self.axis.texts(scene, view.axis_mut(self.axis).range());
            view.limits_form = Some(LimitsForm::new(self.axis, pane, texts));
        }
        self.limits_ui(ui, &response, view);
    }

    /// Pans and zooms this axis only.
    fn pan_and_zoom(&self, response: &Response, view: &mut BodeView) {
        let drag = response.drag_delta();
        if drag != Vec2::ZERO {
            let along = match self.axis {
                BodeAxis::Frequency => vec2(drag.x, 0.0),
                BodeAxis::Values(_) => vec2(0.0, drag.y),
            };
            view.pan(self.pane.pane, along);
            response.ctx.request_repaint();
        }
        if let Some(gesture) = ZoomGesture::find(&response.ctx, response) {
            let factor = gesture.along_one_axis();
            match self.axis {
                BodeAxis::Frequency => view.zoom(self.pane.pane, gesture.pointer, factor, 1.0),
                BodeAxis::Values(_) => view.zoom(self.pane.pane, gesture.pointer, 1.0, factor),
            }
            response.ctx.request_repaint();
        }
    }

    /// Draws the limits form beside the axis, if it is open for this axis, and carries out its
    /// answer. Refused limits leave the form open with the reason; accepted limits, a fit and a
    /// click outside close it.
    fn limits_ui(&self, ui: &Ui, strip: &Response, view: &mut BodeView) {
        let PaneScene {
            pane,
            scene,
            palette,
            ..
        } = self.pane;
        let Some(mut form) = view
            .limits_form
            .take_if(|form| form.is_for(self.axis, pane))
        else {
            return;
        };
        // The form is taken out of the view while it is drawn, and put back if it stays open.
        let mut is_open = true;
        let popup = Popup::from_response(strip)
            .open_bool(&mut is_open)
            .close_behavior(PopupCloseBehavior::CloseOnClickOutside)
            .accessible_name("Limits of the axis");
        let answer = match popup.show(|ui| form.ui(ui, scene, palette)) {
            Some(shown) => shown.inner,
            None => FormAnswer::Waiting,
        };
        if answer != FormAnswer::Waiting {
            ui.ctx().request_repaint();
        }
        match answer {
            FormAnswer::Waiting => {}
            FormAnswer::Fit => {
                view.request_axis_fit(self.axis);
                is_open = false;
            }
            FormAnswer::Show => match self.axis.range(scene, form.texts()) {
                Ok(range) => {
                    let viewed = view.axis_mut(self.axis);
                    if viewed.choose(range) {
                        is_open = false;
                    } else {
                        let refusal = self.axis.beyond_ends(scene, viewed.permitted_values());
                        form.refuse(refusal.text);
                    }
                }
                Err(refusal) => form.refuse(refusal.text),
            },
        }
        if is_open {
            view.limits_form = Some(form);
        }
    }
}
