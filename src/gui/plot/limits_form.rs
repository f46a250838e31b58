//! Form for axis limits.

use egui::{RichText, Role, TextEdit, Ui, WidgetInfo};

use super::bode_axis::BodeAxis;
use super::bode_scene::BodeScene;
use super::drawn_curves::Pane;
use crate::gui::widgets::palette::{Palette, SMALL_SIZE};

/// Form with a field for each axis limit, and buttons that apply them or fit the axis.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct LimitsForm {
    axis: BodeAxis,
    /// Pane beside which the form is open.
    pane: Pane,
    /// Lower and upper limit, as typed so far.
    texts: [String; 2],
    /// Reason why the limits are refused.
    trouble: Option<String>,
    /// Whether the form has not been drawn yet; its first field then takes the focus.
    is_new: bool,
}

/// Request from the form in a frame.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) enum FormAnswer {
    /// Nothing was requested in this frame.
    #[default]
    Waiting,
    /// The typed limits are to be shown.
    Show,
    /// The axis is to be fitted to its curves.
    Fit,
}

impl LimitsForm {
    /// Opens the form beside a pane, with the current limits as text.
    pub(super) fn new(axis: BodeAxis, pane: Pane, texts: [String; 2]) -> Self {
        Self {
            axis,
            pane,
            texts,
            trouble: None,
            is_new: true,
        }
    }

    /// Returns whether the form is open for an axis beside a pane.
    pub(super) fn is_for(&self, axis: BodeAxis, pane: Pane) -> bool {
        self.axis == axis && self.pane == pane
    }

    pub(super) fn texts(&self) -> &[String; 2] {
        &self.texts
    }

    /// Shows why the limits are refused.
    pub(super) fn refuse(&mut self, trouble: String) {
        self.trouble = Some(trouble);
    }

    /// Draws the form; returns whether to show the typed limits, to fit the axis, or to wait.
    pub(super) fn ui(
        &mut self,
        ui: &mut Ui,
        scene: &BodeScene<'_>,
        palette: &Palette,
    ) -> FormAnswer {
        let unit = self.axis.unit(scene);
        ui.set_max_width(190.0);
        let mut answer = FormAnswer::Waiting;
        for (index, name) in ["Lower limit", "Upper limit"].into_iter().enumerate() {
            if self.limit_ui(ui, index, name, &unit) {
                answer = FormAnswer::Show;
            }
        }
        if let Some(trouble) = &self.trouble {
            let trouble = RichText::new(trouble).size(SMALL_SIZE);
            ui.label(trouble.color(palette.warning));
        }
        ui.horizontal(|ui| {
            let show = ui.button("Show limits");
            if show.on_hover_text("Enter").clicked() {
                answer = FormAnswer::Show;
            }
            let fit = ui.button("Fit axis");
            if fit.on_hover_text("All curves on this axis").clicked() {
                answer = FormAnswer::Fit;
            }
        });
        answer
    }

    /// Draws a limit's field; returns whether Enter was pressed in it.
    fn limit_ui(&mut self, ui: &mut Ui, index: usize, name: &str, unit: &str) -> bool {
        let mut is_entered = false;
        ui.horizontal(|ui| {
            ui.label(format!("{name}{unit}"));
            let text = &mut self.texts[index];
            let field = ui.add(TextEdit::singleline(text).desired_width(70.0));
            field.widget_info(|| WidgetInfo::labeled(Role::TextInput, true, name));
            if self.is_new {
                field.request_focus();
                self.is_new = false;
            }
            is_entered =
                field.lost_focus() && ui.input(|input| input.key_pressed(egui::Key::Enter));
            field.on_hover_text(format!(
                "Limit of the visible range{unit}; Enter applies it"
            ));
        });
        is_entered
    }
}
