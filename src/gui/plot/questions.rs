//! Menu of the values under the pointer whose derivations can be displayed.

use egui::{Id, Response};

use gdcm_words::derivation::ExplainTarget;

use crate::gui::widgets::controls::QUESTION;

/// Name of a value, and the target of its derivation.
pub type NamedFigure = (String, ExplainTarget);

/// Plot and listed values of the open menu, if any.
#[derive(Clone, Debug, Default)]
pub(super) struct Questions {
    open: Option<OpenMenu>,
}

#[derive(Clone, Debug)]
struct OpenMenu {
    plot: Id,
    values: Vec<NamedFigure>,
}

impl Questions {
    /// Opens the menu of a plot on a secondary click, listing the values `pointed`; returns the
    /// value chosen in the menu.
    pub(super) fn ui(
        &mut self,
        response: &Response,
        pointed: &[NamedFigure],
    ) -> Option<ExplainTarget> {
        if response.secondary_clicked() {
            self.open = None;
            if !pointed.is_empty() {
                self.open = Some(OpenMenu {
                    plot: response.id,
                    values: pointed.to_vec(),
                });
            }
        }
        let menu = self.open.as_ref()?;
        if menu.plot != response.id {
            return None;
        }
        let mut chosen = None;
        response.context_menu(|ui| {
            ui.label(QUESTION);
            for (name, target) in &menu.values {
                if ui.button(name).clicked() {
                    chosen = Some(target.clone());
                    ui.close();
                }
            }
        });
        chosen
    }
}
