//! Menu of the identified models that can replace the present models of a condition.

use egui::Ui;

use gdcm_study::decisions::adopted_models::OfferedModels;

const CHOICES: [(&str, OfferedModels); 3] = [
    ("The refined models", OfferedModels::REFINED),
    (
        "The refined models, and CT-PBSID (unrefined)",
        OfferedModels::WITH_UNREFINED,
    ),
    ("The measured response", OfferedModels::MEASURED),
];

/// Shows a menu button; returns the chosen models.
pub(super) fn offered_models_ui(ui: &mut Ui, text: &str, hint: &str) -> Option<OfferedModels> {
    let menu = ui.menu_button(text, |ui| {
        for (words, models) in CHOICES {
            if ui.button(words).clicked() {
                ui.close();
                return Some(models);
            }
        }
        None
    });
    menu.response.on_hover_text(hint);
    menu.inner.flatten()
}
