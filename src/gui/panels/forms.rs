//! Forms in front of the window: draws the requested form. Short forms, such as questions, are
//! here; the others are in `path_forms.rs`, `record_dataset_form.rs`, `export_dialog.rs`,
//! `messages_page.rs`, `keys_page.rs`, `licences_page.rs` and the command palette.

use egui::{Context, Id, Modal, RichText, ScrollArea};

use gdcm_io::software::software;
use gdcm_study::Edit;
use gdcm_study::decisions::dataset_differences::Difference;
use gdcm_words::dataset_differences::dataset_difference_text;

use super::export_dialog::export_dialog_ui;
use super::form_parts::Form;
use super::keys_page::keys_page_ui;
use super::licences_page::licences_ui;
use super::messages_page::messages_ui;
use super::path_forms::path_ui;
use super::record_dataset_form::record_dataset_ui;
use crate::gui::commands::command::Command;
use crate::gui::commands::command_palette::command_palette_ui;
use crate::gui::commands::form::FormCommand;
use crate::gui::commands::output::OutputCommand;
use crate::gui::state::forms::FormKind;
use crate::gui::state::window_state::State;
use crate::gui::widgets::palette::Palette;

/// Draws the requested form, if any. Its text field, or else its first button, has the focus when
/// it opens; Enter submits the form; Escape and a click outside close it.
pub fn forms_ui(ctx: &Context, state: &mut State, palette: &Palette, commands: &mut Vec<Command>) {
    let Some(kind) = state.forms.shown else {
        state.forms.drawn = None;
        return;
    };
    let asks_to_overwrite = !state.forms.existing.is_empty();
    let drawn = Some((kind, asks_to_overwrite));
    let opens = state.forms.drawn != drawn;
    state.forms.drawn = drawn;
    if kind == FormKind::Export {
        return export_dialog_ui(ctx, state, opens, palette, commands);
    }
    // Each form has its own id, because egui stores the size by id.
    let modal = Modal::new(Id::unique(("form", kind, asks_to_overwrite))).show(ctx, |ui| {
        ui.set_width(460.0);
        let form = &mut Form {
            ui,
            opens,
            palette,
            commands,
        };
        if asks_to_overwrite {
            overwrite_ui(form, kind, &state.forms.existing);
            return;
        }
        match kind {
            FormKind::Messages => messages_ui(form, &state.notices),
            FormKind::Unsaved => unsaved_ui(form),
            FormKind::Differences => differences_ui(form, state),
            FormKind::Shortcuts => shortcuts_ui(form, state),
            FormKind::Palette => command_palette_ui(form.ui, state, opens, palette, form.commands),
            FormKind::Reason => reason_ui(form, state),
            FormKind::RecordDataset => record_dataset_ui(form, &mut state.records.dataset_form),
            FormKind::About => about_ui(form),
            FormKind::Licences => licences_ui(form),
            _ => path_ui(form, kind, state),
        }
    });
    if modal.should_close() {
        commands.push(FormCommand::ShowForm(None).into());
    }
}

fn shortcuts_ui(form: &mut Form<'_, '_>, state: &State) {
    form.title("Keys and gestures");
    keys_page_ui(form.ui, state, form.palette);
    form.button_ui("Close", true, FormCommand::ShowForm(None));
}

fn about_ui(form: &mut Form<'_, '_>) {
    form.title(&software());
    form.ui.label(
        "The Gain-Delay Correction Method: one gain and one delay for each input and output \
         channel, so that a physics-based helicopter model matches flight and holds the important \
         responses exactly.",
    );
    form.explain("The embedded example is simulated; nothing in it comes from a real aircraft.");
    form.explain(
        "The example Real aircraft: model and flights of the AscTec Pelican, © 2011-2013 Renzo De \
         Nardi, University College London, BSD-3-Clause; flights of the ANT-X drone, © 2025 \
         MattiaDiMauro, MIT. gdcm example --real writes the licences.",
    );
    form.explain("MIT OR Apache-2.0");
    form.line(|form| {
        form.button_ui("Close", true, FormCommand::ShowForm(None));
        form.button_ui(
            "Licences of the libraries",
            false,
            FormCommand::ShowForm(Some(FormKind::Licences)),
        );
    });
}

/// Asks whether to overwrite files; Cancel returns to the form, except from
/// [`FormKind::Models`], which has no other form.
fn overwrite_ui(form: &mut Form<'_, '_>, kind: FormKind, existing: &[String]) {
    form.title(if existing.len() == 1 {
        "This file exists already"
    } else {
        "These files exist already"
    });
    for path in existing {
        form.ui.label(path);
    }
    form.ui.add_space(4.0);
    let before = if kind == FormKind::Models {
        None
    } else {
        Some(kind)
    };
    form.line(|form| {
        form.button_ui("Overwrite", false, FormCommand::Overwrite);
        // `true` focuses Cancel, so that Enter does not overwrite anything.
        form.button_ui("Cancel", true, FormCommand::ShowForm(before));
    });
}

fn unsaved_ui(form: &mut Form<'_, '_>) {
    form.title("Unsaved decisions");
    form.ui.label(
        "Without saving, all decisions since the last save are lost: rejected models, chosen \
        representatives, settings.",
    );
    form.ui.add_space(4.0);
    form.line(|form| {
        form.button_ui("Save study first", true, FormCommand::SaveAndGoOn);
        form.button_ui("Don't save", false, FormCommand::DiscardAndGoOn);
        form.cancel_ui(false);
    });
}

fn differences_ui(form: &mut Form<'_, '_>, state: &State) {
    form.title("The dataset differs from the study's dataset");
    form.explain("Every decision that still applies was kept. Differences:");
    let palette = form.palette;
    ScrollArea::vertical()
        .max_height(300.0)
        .show(form.ui, |ui| {
            for difference in &state.differences {
                let not_applied = matches!(difference, Difference::NotApplied { .. });
                let color = if not_applied {
                    palette.warning
                } else {
                    palette.text
                };
                ui.label(
                    RichText::new(format!("• {}", dataset_difference_text(difference)))
                        .color(color),
                );
            }
        });
    form.ui.add_space(4.0);
    let lines: Vec<String> = state
        .differences
        .iter()
        .map(dataset_difference_text)
        .collect();
    form.line(|form| {
        form.button_ui("Continue", true, FormCommand::ShowForm(None));
        form.button_ui(
            "Copy the list",
            false,
            OutputCommand::CopyText(lines.join("\n")),
        );
    });
}

/// Asks why a model is rejected; submitting the form rejects the model if it is still kept.
fn reason_ui(form: &mut Form<'_, '_>, state: &mut State) {
    let Some(model) = state.forms.rejected_model.clone() else {
        return;
    };
    let is_rejected = state.study.is_rejected(&model);
    form.title(if is_rejected {
        "Reason for the rejection"
    } else {
        "Reject with a reason"
    });
    let words = format!(
        "{} model {} of condition {}",
        model.bundle, model.name, model.condition
    );
    form.explain(&words);
    let reason = state.forms.typed_in(FormKind::Reason);
    let entered = form.text_ui(
        "Rejection reason",
        reason,
        "saved in the study and in the results",
    );
    let reason = reason.trim().to_owned();
    form.line(|form| {
        let edit = if is_rejected {
            Edit::SetReason(model, reason)
        } else if reason.is_empty() {
            Edit::Reject(model)
        } else {
            Edit::RejectBecause { model, reason }
        };
        form.submit_ui(
            if is_rejected {
                "Save the reason"
            } else {
                "Reject"
            },
            true,
            entered,
            Some(Command::Form(FormCommand::DecideInForm(edit))),
        );
        form.cancel_ui(false);
    });
}
