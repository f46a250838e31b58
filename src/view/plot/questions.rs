//! "How was this computed?" about the figures of a plot, on a secondary click.

use egui::{Id, Response};

use crate::view::explanation::QUESTION;
use gdcm_core::study::ExplainTarget;

/// A figure that can be asked about, and its name.
pub type NamedFigure = (String, ExplainTarget);

/// Which figures a menu asks about, while it is open.
#[derive(Clone, Debug, Default)]
pub(super) struct Questions {
    /// The plot that was clicked, and the figures that were under the pointer.
    asked_of: Option<(Id, Vec<NamedFigure>)>,
}

impl Questions {
    /// Opens the menu of a plot on a secondary click on `pointed`, and gives the figure that was chosen in it.
    pub(super) fn ui(&mut self, response: &Response, pointed: &[NamedFigure]) -> Option<ExplainTarget> {
        if response.secondary_clicked() {
            self.asked_of = (!pointed.is_empty()).then(|| (response.id, pointed.to_vec()));
        }
        let (_, figures) = self.asked_of.as_ref().filter(|(plot, _)| *plot == response.id)?;
        let mut chosen = None;
        response.context_menu(|ui| {
            ui.label(QUESTION);
            for (name, asked) in figures {
                if ui.button(name).clicked() {
                    chosen = Some(asked.clone());
                    ui.close();
                }
            }
        });
        chosen
    }
}
