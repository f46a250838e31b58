//! Interactive axes: the wheel zooms, dragging pans, a double click or a secondary click opens the
//! form for the limits.

use egui::{
    CursorIcon, Popup, PopupCloseBehavior, Rect, Response, RichText, Role, Sense, TextEdit, Ui,
    Vec2, WidgetInfo, vec2,
};

use gdcm_model::number_format::compact;
use gdcm_plot::figure::Range;

use super::axes::Ticks;
use super::bode::BodeScene;
use super::bode_view::BodeView;
use super::drawn_curves::Pane;
use super::navigation::turned;
use crate::gui::widgets::palette::{Palette, SMALL_SIZE};

/// Form for the limits of an axis.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct LimitsForm {
    axis: PlotAxis,
    /// Pane of the axis.
    pane: Pane,
    texts: [String; 2],
    /// Reason why the limits are refused.
    trouble: Option<String>,
    is_new: bool,
}

/// Makes the axes of a pane, drawn into `rect`, interactive.
pub(super) fn axis_strips_ui(
    ui: &Ui,
    (pane, rect): (Pane, Rect),
    scene: &BodeScene<'_>,
    view: &mut BodeView,
    palette: &Palette,
) {
    let Some(frame) = view.transform(pane).map(|transform| *transform.frame()) else {
        return;
    };
    let below = Rect::from_x_y_ranges(frame.x_range(), frame.bottom()..=rect.bottom());
    let beside = Rect::from_x_y_ranges(rect.left()..=frame.left(), frame.y_range());
    for (axis, strip, icon) in [
        (PlotAxis::Frequency, below, CursorIcon::ResizeHorizontal),
        (PlotAxis::Values(pane), beside, CursorIcon::ResizeVertical),
    ] {
        let name = axis.name(scene, pane);
        // Not focusable by Tab: the plot itself offers the same actions on the keyboard.
        let response = ui.interact(strip, ui.scope_id().with(&name), Sense::CLICK | Sense::DRAG);
        response.widget_info(|| WidgetInfo::labeled(Role::ScrollBar, true, &name));
        let response = response.on_hover_cursor(icon);
        take_hold(ui, (axis, pane), &response, view);
        if response.double_clicked() || response.secondary_clicked() {
            let texts = axis.texts(scene, view.axis_mut(axis).range());
            view.limits = Some(LimitsForm {
                axis,
                pane,
                texts,
                trouble: None,
                is_new: true,
            });
        }
        limits_ui(ui, (axis, pane), &response, scene, view, palette);
    }
}

fn take_hold(ui: &Ui, (axis, pane): (PlotAxis, Pane), response: &Response, view: &mut BodeView) {
    let is_across = axis == PlotAxis::Frequency;
    let drag = response.drag_delta();
    if drag != Vec2::ZERO {
        view.pan(
            pane,
            if is_across {
                vec2(drag.x, 0.0)
            } else {
                vec2(0.0, drag.y)
            },
        );
        ui.ctx().request_repaint();
    }
    if let Some((turn, pointer)) = turned(ui.ctx(), response) {
        let factor = f64::from(turn.along_one_axis());
        let (frequencies, values) = if is_across {
            (factor, 1.0)
        } else {
            (1.0, factor)
        };
        view.zoom(pane, pointer, frequencies, values);
        ui.ctx().request_repaint();
    }
}

/// Draws the form for the limits beside the axis, if it is open for this axis.
fn limits_ui(
    ui: &Ui,
    (axis, pane): (PlotAxis, Pane),
    strip: &Response,
    scene: &BodeScene<'_>,
    view: &mut BodeView,
    palette: &Palette,
) {
    let Some(mut form) = view
        .limits
        .take_if(|form| (form.axis, form.pane) == (axis, pane))
    else {
        return;
    };
    let mut is_open = true;
    let popup = Popup::from_response(strip)
        .open_bool(&mut is_open)
        .close_behavior(PopupCloseBehavior::CloseOnClickOutside)
        .accessible_name("Limits of the axis");
    let answer = popup
        .show(|ui| form_ui(ui, &mut form, scene, palette))
        .map(|shown| shown.inner)
        .unwrap_or_default();
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
                view.axis_mut(axis).choose(range);
                is_open = false;
            }
            Err(refusal) => form.trouble = Some(refusal),
        },
    }
    if is_open {
        view.limits = Some(form);
    }
}

/// Answer of the form.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
enum FormAnswer {
    #[default]
    Waiting,
    Show,
    Fit,
}

fn form_ui(
    ui: &mut Ui,
    form: &mut LimitsForm,
    scene: &BodeScene<'_>,
    palette: &Palette,
) -> FormAnswer {
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
            field.on_hover_text(format!(
                "The {} of what is in view{unit}; Enter shows it",
                name.to_lowercase()
            ));
        });
    }
    if let Some(trouble) = &form.trouble {
        ui.label(
            RichText::new(trouble)
                .size(SMALL_SIZE)
                .color(palette.warning),
        );
    }
    ui.horizontal(|ui| {
        if ui
            .button("Show limits")
            .on_hover_text("Show what lies between the limits")
            .clicked()
        {
            answer = FormAnswer::Show;
        }
        if ui
            .button("Fit axis")
            .on_hover_text("Show all of the curves on this axis")
            .clicked()
        {
            answer = FormAnswer::Fit;
        }
    });
    answer
}

/// Axis of a Bode plot.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum PlotAxis {
    /// Frequency axis, shared by both panes.
    Frequency,
    /// Vertical axis of a pane.
    Values(Pane),
}

impl PlotAxis {
    /// Returns the accessible name: "Frequency axis, magnitude plot".
    pub(super) fn name(self, scene: &BodeScene<'_>, pane: Pane) -> String {
        let kind = match self {
            Self::Frequency => "Frequency",
            Self::Values(_) => "Value",
        };
        format!("{kind} axis, {}", scene.quantity.place(pane))
    }

    /// Returns the unit in brackets; empty without a unit.
    pub(super) fn unit(self, scene: &BodeScene<'_>) -> String {
        let symbol = match self {
            Self::Frequency => scene.unit.symbol(),
            Self::Values(pane) => scene.quantity.unit(pane).suffix().trim(),
        };
        if symbol.is_empty() {
            String::new()
        } else {
            format!(" [{symbol}]")
        }
    }

    /// Returns the kind of tick labels.
    fn ticks(self, scene: &BodeScene<'_>) -> Ticks {
        match self {
            Self::Frequency => Ticks::Frequency(scene.unit),
            Self::Values(pane) => scene.quantity.unit(pane).ticks(),
        }
    }

    /// Formats the ends of a range for typing.
    pub(super) fn texts(self, scene: &BodeScene<'_>, range: Range) -> [String; 2] {
        [range.min, range.max].map(|place| compact(self.ticks(scene).number(place)))
    }

    /// Parses the range between two typed numbers, or returns the reason why it cannot be shown.
    pub(super) fn range(self, scene: &BodeScene<'_>, texts: &[String; 2]) -> Result<Range, String> {
        let [min, max] = [self.place(scene, &texts[0])?, self.place(scene, &texts[1])?];
        let range = (min < max).then_some(Range { min, max });
        range.ok_or_else(|| "the lower limit has to be below the upper one".to_owned())
    }

    /// Parses a typed number, with either minus sign, to a place on the axis.
    fn place(self, scene: &BodeScene<'_>, text: &str) -> Result<f64, String> {
        let number = text.trim().replace('\u{2212}', "-").parse::<f64>().ok();
        let what = if self == Self::Frequency {
            "frequency"
        } else {
            "value"
        };
        let place = number.map(|number| self.ticks(scene).place(number));
        place
            .filter(|place| place.is_finite())
            .ok_or_else(|| format!("\"{}\" is no {what}", text.trim()))
    }
}

#[cfg(test)]
mod tests {
    use gdcm_plot::figure::axis::FrequencyUnit;

    use super::*;

    fn texts(min: &str, max: &str) -> [String; 2] {
        [min.to_owned(), max.to_owned()]
    }

    #[test]
    fn typed_frequencies_are_places_on_the_logarithmic_axis() {
        let scene = BodeScene::of("", &[], (0.5, 12.0));
        let range = PlotAxis::Frequency
            .range(&scene, &texts("0.1", " 100 "))
            .unwrap();
        assert_eq!(
            range,
            Range {
                min: -1.0,
                max: 2.0
            }
        );
        assert_eq!(
            PlotAxis::Frequency.texts(&scene, range),
            texts("0.1", "100")
        );
        let hertz = BodeScene {
            unit: FrequencyUnit::Hertz,
            ..scene
        };
        let range = PlotAxis::Frequency.range(&hertz, &texts("1", "2")).unwrap();
        assert!((10f64.powf(range.min) - std::f64::consts::TAU).abs() < 1e-12);
    }

    #[test]
    fn limits_that_are_none_are_refused_with_a_word() {
        let scene = BodeScene::of("", &[], (0.5, 12.0));
        let frequencies = |min, max| {
            PlotAxis::Frequency
                .range(&scene, &texts(min, max))
                .unwrap_err()
                .to_string()
        };
        assert_eq!(
            frequencies("3", "2"),
            "the lower limit has to be below the upper one"
        );
        assert_eq!(
            frequencies("2", "2"),
            "the lower limit has to be below the upper one"
        );
        assert_eq!(frequencies("0", "2"), "\"0\" is no frequency");
        assert_eq!(frequencies("1", "two"), "\"two\" is no frequency");
        let values = PlotAxis::Values(Pane::Magnitude);
        assert_eq!(
            values.range(&scene, &texts("\u{2212}20", "5")),
            Ok(Range {
                min: -20.0,
                max: 5.0
            })
        );
        assert!(values.range(&scene, &texts("NaN", "5")).is_err());
    }
}
