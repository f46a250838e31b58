//! Menu with the identified models that can replace a condition's present models.

use egui::Ui;

use gdcm_study::decisions::adopted_models::AdoptionChoice;

/// Choice of models, and its name in menus.
#[derive(Clone, Copy)]
pub(super) struct Offer {
    pub(super) words: &'static str,
    pub(super) models: AdoptionChoice,
}

pub(super) const OFFERS: [Offer; 3] = [
    Offer {
        words: "The refined models",
        models: AdoptionChoice::REFINED,
    },
    Offer {
        words: "The refined models, and CT-PBSID (unrefined)",
        models: AdoptionChoice::WITH_UNREFINED,
    },
    Offer {
        words: "The measured response",
        models: AdoptionChoice::MEASURED,
    },
];

/// Shows a menu button; returns the chosen models.
pub(super) fn offered_models_ui(ui: &mut Ui, text: &str, hint: &str) -> Option<AdoptionChoice> {
    let menu = ui.menu_button(text, |ui| {
        for offer in OFFERS {
            if ui.button(offer.words).clicked() {
                ui.close();
                return Some(offer.models);
            }
        }
        None
    });
    menu.response.on_hover_text(hint);
    menu.inner.flatten()
}
