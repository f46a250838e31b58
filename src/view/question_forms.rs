//! The forms that ask something, or tell something that has to be read.

use egui::{RichText, ScrollArea};

use gdcm_core::study::{Difference, Edit};

use super::command::{Command, FormKind};
use super::form::Form;
use super::palette::Palette;
use super::state::State;

/// Asks whether to overwrite files; a cancel goes back to the form that would.
pub(super) fn overwrite_ui(form: &mut Form<'_, '_>, kind: FormKind, existing: &[String]) {
    form.title(if existing.len() == 1 { "This file exists already" } else { "These files exist already" });
    for path in existing {
        form.ui.label(path);
    }
    form.ui.add_space(4.0);
    form.line(|form| {
        form.button_ui("Overwrite", false, Command::Overwrite);
        // Enter loses nothing.
        form.button_ui("Cancel", true, Command::ShowForm(Some(kind)));
    });
}

pub(super) fn unsaved_ui(form: &mut Form<'_, '_>) {
    form.title("There are decisions that are not saved");
    form.ui.label("Going on loses the rejected and pinned models and the settings of this study.");
    form.ui.add_space(4.0);
    form.line(|form| {
        form.button_ui("Save study first", true, Command::SaveAndGoOn);
        form.button_ui("Lose them", false, Command::DiscardAndGoOn);
        form.button_ui("Cancel", false, Command::ShowForm(None));
    });
}

pub(super) fn differences_ui(form: &mut Form<'_, '_>, state: &State, palette: &Palette) {
    form.title("The dataset is not the one the study was made with");
    let words = "Every decision that still applies was kept. What is different:";
    form.ui.label(RichText::new(words).color(palette.dim_text));
    ScrollArea::vertical().max_height(300.0).show(form.ui, |ui| {
        for difference in &state.differences {
            let not_applied = matches!(difference, Difference::NotApplied { .. });
            let color = if not_applied { palette.warning } else { palette.text };
            ui.label(RichText::new(format!("• {difference}")).color(color));
        }
    });
    form.ui.add_space(4.0);
    let lines: Vec<String> = state.differences.iter().map(|difference| difference.to_string()).collect();
    form.line(|form| {
        form.button_ui("Go on", true, Command::ShowForm(None));
        form.button_ui("Copy the list", false, Command::CopyText(lines.join("\n")));
    });
}

/// Why a model is rejected; one that is kept is rejected with it.
pub(super) fn reason_ui(form: &mut Form<'_, '_>, state: &mut State, palette: &Palette) {
    let Some(model) = state.forms.rejected_model.clone() else { return };
    let is_rejected = state.study.is_rejected(&model);
    let (title, button) =
        if is_rejected { ("Why is it rejected?", "Keep the reason") } else { ("Reject with a reason", "Reject") };
    form.title(title);
    let words = format!("{} model {} of condition {}", model.bundle, model.name, model.condition);
    form.ui.label(RichText::new(words).color(palette.dim_text));
    let reason = &mut state.forms.reason;
    let entered =
        form.text_ui("Reason of the rejection", reason, "in words; it is kept in the study and in the results");
    let reason = reason.trim().to_owned();
    form.line(|form| {
        let edit = || match is_rejected {
            true => Edit::SetReason(model, reason),
            false if reason.is_empty() => Edit::Reject(model),
            false => Edit::RejectBecause { model, reason },
        };
        form.submit_ui(button, true, entered, || Command::DecideInForm(edit()));
        form.button_ui("Cancel", false, Command::ShowForm(None));
    });
}
