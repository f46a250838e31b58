//! Commands and progress in the page bar of the Records view.

use egui::containers::menu::MenuButton;
use egui::{Align, Button, Layout, RichText, Role, Sense, Ui, vec2};

use gdcm_model::dataset::ConditionId;
use gdcm_model::number_format::counted;
use gdcm_study::decisions::adopted_models::AdoptionChoice;

use super::offered_models::OFFERS;
use crate::gui::commands::command::Command;
use crate::gui::commands::records::RecordsCommand;
use crate::gui::state::condition_fit::BatchProgress;
use crate::gui::state::window_state::State;
use crate::gui::widgets::controls::{Asks, entries_ui, named};
use crate::gui::widgets::palette::Palette;

/// Width of the progress bar \[pt\].
const BAR: f32 = 72.0;
/// Width for the progress text \[pt\].
const BAR_WORDS: f32 = 112.0;
const IDENTIFY_HINT: &str = "Identifies models from the records: CT-PBSID, refined, with \
    confidence bands (docs/identification.md)";

/// Draws the commands, from right to left: *Use n fits*, then *Identify* or the progress with
/// *Stop*.
pub fn records_header_ui(ui: &mut Ui, state: &State, commands: &mut Vec<Command>) {
    let palette = Palette::from_visuals(ui.visuals());
    let fits = state.unused_fits();
    use_ui(ui, &fits, &palette, commands);
    match state.batch_progress() {
        Some(progress) => progress_ui(ui, state, progress, &palette, commands),
        None => identify_ui(ui, state, commands),
    }
}

/// Draws the menu with further commands beside a button; `name` is its accessible name.
fn more_ui(ui: &mut Ui, name: &str, entries: Vec<(String, Command)>, commands: &mut Vec<Command>) {
    let (response, _) = MenuButton::from_button(Button::new("▾")).ui(ui, |ui| {
        entries_ui(ui, entries, commands);
    });
    named(response, Role::Button, name);
}

/// Draws the button that uses the refined models of `fits`, and a menu with other models of these
/// fits; nothing without any. (The right panel has the command that uses only the displayed
/// condition's fit.)
fn use_ui(ui: &mut Ui, fits: &[ConditionId], palette: &Palette, commands: &mut Vec<Command>) {
    if fits.is_empty() {
        return;
    }
    let mut entries: Vec<(String, Command)> = Vec::new();
    for offer in OFFERS {
        let command = RecordsCommand::AdoptAll(offer.models);
        entries.push((offer.words.to_owned(), command.into()));
    }
    more_ui(ui, "Other models of the fits", entries, commands);
    let text = format!("Use {}", counted(fits.len(), "fit"));
    let names: Vec<String> = fits.iter().map(ToString::to_string).collect();
    let conditions = if fits.len() == 1 {
        "condition"
    } else {
        "conditions"
    };
    let hint = format!(
        "Replaces the identified models of {conditions} {} with the refined models; can be undone \
            in one step",
        names.join(", ")
    );
    let text = RichText::new(text).color(palette.on_accent());
    ui.add(Button::new(text).fill(palette.accent))
        .on_hover_text(hint)
        .asks(RecordsCommand::AdoptAll(AdoptionChoice::REFINED), commands);
}

/// Draws the command that identifies all conditions with records, or only those whose fit is
/// missing or outdated; with several conditions, a menu offers the displayed one alone.
fn identify_ui(ui: &mut Ui, state: &State, commands: &mut Vec<Command>) {
    let condition = state.condition().id();
    let in_use = state.records.conditions_in_use();
    let to_identify = state.conditions_to_identify();
    if in_use.len() > 1 && in_use.contains(&condition) {
        let text = format!("Identify condition {condition} only");
        let entries = vec![(text, RecordsCommand::Identify.into())];
        more_ui(ui, "More ways to identify", entries, commands);
    }
    let text = if in_use.len() < 2 {
        "Identify".to_owned()
    } else if to_identify.len() == in_use.len() {
        format!("Identify all {}", in_use.len())
    } else {
        format!("Identify {} of {}", to_identify.len(), in_use.len())
    };
    ui.add_enabled(!in_use.is_empty(), Button::new(text))
        .on_hover_text(IDENTIFY_HINT)
        .asks(RecordsCommand::IdentifyAll, commands);
}

/// Draws the progress at the left of the button that stops it.
fn progress_ui(
    ui: &mut Ui,
    state: &State,
    progress: BatchProgress,
    palette: &Palette,
    commands: &mut Vec<Command>,
) {
    // The status bar may show a Stop for other work at the same time, so this one has its own name.
    named(ui.button("Stop"), Role::Button, "Stop identifying")
        .on_hover_text("Stops identifying; finished fits are kept")
        .asks(RecordsCommand::StopIdentifying, commands);
    let mut words = format!("{} of {}", progress.finished, progress.requested);
    if let Some(remaining_s) = progress.remaining_s {
        words.push_str(&format!(", {remaining_s:.0} s left"));
    }
    let size = vec2(BAR_WORDS, ui.spacing().interact_size.y);
    let step = match state.records.running_job() {
        Some(job) => format!("condition {}: {}", job.condition, job.news().step),
        None => "waiting".to_owned(),
    };
    ui.allocate_ui_with_layout(size, Layout::left_to_right(Align::Center), |ui| {
        ui.set_min_width(BAR_WORDS);
        ui.label(palette.dim(words)).on_hover_text(step);
    });
    bar_ui(ui, progress.share, palette);
}

/// Draws a bar that is filled to `share`, 0 to 1.
fn bar_ui(ui: &mut Ui, share: f32, palette: &Palette) {
    let (place, _) = ui.allocate_exact_size(vec2(BAR, 6.0), Sense::hover());
    ui.painter().rect_filled(place, 3.0, palette.line);
    let filled = place.with_max_x(place.left() + share.clamp(0.0, 1.0) * BAR);
    ui.painter().rect_filled(filled, 3.0, palette.accent);
}
