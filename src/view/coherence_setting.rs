//! Whether the coherence of measured responses counts, and from which on (M4a).

use egui::{RichText, Role, Ui, WidgetInfo};

use gdcm_core::study::{DEFAULT_COHERENCE, Edit, Setting};

use super::command::Command;
use super::number_field::NumberField;
use super::palette::Palette;
use super::state::State;

const NAME: &str = "Coherence counts";

/// A row of the settings: a box that lets coherence count, and the least that does. Nothing where no model is measured with
/// coherence.
pub fn coherence_ui(ui: &mut Ui, state: &State, palette: &Palette, commands: &mut Vec<Command>) {
    let threshold = state.study.settings.coherence_threshold;
    if threshold.is_none() && !state.dataset().has_coherence() {
        return;
    }
    ui.label(RichText::new("Coherence").color(palette.dim_text));
    let mut counts = threshold.is_some();
    let (clicked, entered) = ui
        .horizontal(|ui| {
            let response = ui.checkbox(&mut counts, "from");
            let clicked = response.changed();
            response.widget_info(|| WidgetInfo::selected(Role::CheckBox, true, counts, NAME));
            response.on_hover_text(
                "Where flight is measured with coherence, weigh J, G and D with it and leave out frequencies below the least; \
                 off: every frequency counts alike",
            );
            let hint = "Least coherence γ² of a frequency that counts [-]";
            let field = NumberField::new("Least coherence", hint, 0.0..=1.0);
            let shown = threshold.unwrap_or(DEFAULT_COHERENCE);
            (clicked, ui.add_enabled_ui(counts, |ui| field.ui(ui, shown)).inner)
        })
        .inner;
    if clicked {
        commands.push(Edit::Set(Setting::Coherence(counts.then_some(DEFAULT_COHERENCE))).into());
    } else if let Some(least) = entered.value {
        commands.push(Edit::Set(Setting::Coherence(Some(least))).into());
    }
    commands.extend(entered.refusal.map(Command::Refuse));
    // Two clicks are two decisions.
    if entered.is_ended || clicked {
        commands.push(Command::EndEdit);
    }
    ui.end_row();
}
