//! Progress, summary and cautions of an identification, with a button for each available remedy.

use std::sync::Arc;

use egui::{Color32, Label, ProgressBar, RichText, Ui};

use gdcm_model::dataset::BundleKind;
use gdcm_study::jobs::identification_jobs::IdentifyJob;
use gdcm_study::results::channel_time_skew::ChannelTimeSkew;
use gdcm_sysid::diagnostics::model_doubts::HELD_OUT;
use gdcm_sysid::identification::Identification;
use gdcm_words::channel_time_skew::time_skew_text;
use gdcm_words::flight_plan::caution_with_advice;

use super::caution_remedies::{
    Remedy, band_remedy, caution_remedies, remove_common_delay, study_band_remedy,
};
use super::frame_cache::{Source, cached};
use super::next_flight::planned_channels;
use super::page::Page;
use super::record_list::{BAD_FIT, CHI_SQUARED};
use crate::gui::commands::command::Command;
use crate::gui::widgets::controls::Asks;
use crate::gui::widgets::palette::{Palette, SMALL_SIZE};

/// Shows the progress while an identification runs, then its outcome.
pub(super) fn outcome_ui(ui: &mut Ui, page: Page<'_>, commands: &mut Vec<Command>) {
    let Page {
        state,
        records,
        palette,
    } = page;
    ui.add_space(6.0);
    if let Some([low, high]) = records.band {
        ui.label(palette.small(format!(
            "Band from {low:.2} to {high:.1} rad/s, instead of the study's band"
        )));
        remedies_ui(ui, vec![study_band_remedy()], commands);
    }
    if let Some(job) = state.records.job_of(state.condition().id()) {
        progress_ui(ui, page, job);
        return;
    }
    match &records.found {
        None => {}
        Some((job, Err(error))) => {
            let text = RichText::new(error.to_string()).color(palette.warning);
            ui.add(Label::new(text).wrap());
            let remedy = band_remedy(error, job.request.options.band);
            remedies_ui(ui, remedy.into_iter().collect(), commands);
        }
        Some((_, Ok(found))) => {
            if records.changed {
                ui.label(palette.small_warning("Outdated: records or settings have changed"));
            }
            summary_ui(ui, found, palette);
            let channels = planned_channels(state.dataset());
            for caution in &found.cautions {
                let remedies = caution_remedies(ui, records, caution);
                let words = caution_with_advice(caution, &found.advice, &channels);
                caution_ui(ui, &words, remedies, palette, commands);
            }
            late_channel_ui(ui, page, commands);
        }
    }
}

/// Shows the completed share and the current step, or the condition that is identified first.
fn progress_ui(ui: &mut Ui, page: Page<'_>, job: &IdentifyJob) {
    let Page { state, palette, .. } = page;
    let news = job.news();
    let mut share = 0.0;
    let mut words = String::new();
    if !news.step.is_empty() {
        let steps = state.results.background.identification.unwrap_or_default();
        share = steps.done as f32 / steps.total.max(1) as f32;
        words = news.step;
    } else if let Some(earlier) = state.records.under_way() {
        words = format!("Waiting for condition {}", earlier.condition);
    }
    ui.add(ProgressBar::new(share).desired_height(6.0));
    ui.label(palette.small(words));
    if news.first_model.is_some() {
        ui.label(palette.small("The first model is drawn; it is being refined"));
    }
}

/// Shows the order, the costs and the settings of the recommended model.
fn summary_ui(ui: &mut Ui, found: &Identification, palette: &Palette) {
    let order = found.refined.order().unwrap_or_default();
    ui.label(RichText::new(format!("CT-PBSID, refined: order {order}")).strong());
    ui.horizontal_wrapped(|ui| {
        ui.label("χ²/dof");
        let color = limit_color(found.cost, BAD_FIT, palette);
        ui.label(RichText::new(format!("{:.2}", found.cost)).color(color))
            .on_hover_text(CHI_SQUARED);
        if let Some(raw) = found.held_out_cost
            && let Some(adapted) = found.held_out_normalised
        {
            ui.label("· held out");
            let color = limit_color(adapted, HELD_OUT[1], palette);
            ui.label(RichText::new(format!("{adapted:.2} ({raw:.2})")).color(color))
                .on_hover_text(
                    "χ²/dof of the held-out records for the model adapted within its uncertainty; \
                    in brackets, for the model as it is. The most sensitive test: values up to \
                    1.3 are good",
                );
        }
    });
    ui.label(palette.small(format!(
        "Laguerre pole {:.2} rad/s, past window {}; {} models in the bundle",
        found.laguerre_pole,
        found.past,
        1 + found.bundle.len(),
    )));
}

fn limit_color(value: f64, limit: f64, palette: &Palette) -> Color32 {
    if value <= limit {
        palette.text
    } else {
        palette.warning
    }
}

fn caution_ui(
    ui: &mut Ui,
    words: &str,
    remedies: Vec<Remedy>,
    palette: &Palette,
    commands: &mut Vec<Command>,
) {
    ui.add_space(3.0);
    let text = RichText::new(format!("⚠ {words}"))
        .size(SMALL_SIZE)
        .color(palette.text);
    ui.add(Label::new(text).wrap());
    remedies_ui(ui, remedies, commands);
}

fn remedies_ui(ui: &mut Ui, remedies: Vec<Remedy>, commands: &mut Vec<Command>) {
    ui.horizontal_wrapped(|ui| {
        for remedy in remedies {
            ui.small_button(remedy.label).asks(remedy.command, commands);
        }
    });
}

/// Shows a caution about a channel that is delayed equally in all records, which only a comparison
/// with a physics model can reveal.
fn late_channel_ui(ui: &mut Ui, page: Page<'_>, commands: &mut Vec<Command>) {
    let Page {
        state,
        records,
        palette,
    } = page;
    let Some((job, Ok(found))) = &records.found else {
        return;
    };
    let condition = state.condition();
    let physics_models = condition.bundle(BundleKind::Physics);
    let Some(physics) = physics_models.get(condition.nominal()) else {
        return;
    };
    let sources: [Source; 2] = [Arc::clone(found) as _, Arc::clone(condition) as _];
    let late = cached(ui, "late channel", &sources, (), || {
        ChannelTimeSkew::of_condition(&found.measured, job.request.options.band, condition)
    });
    let Some(late) = *late else {
        return;
    };
    let Some(signal) = late.signal(state.dataset()) else {
        return;
    };
    let words = time_skew_text(&late, &signal.name, &physics.name);
    let remedy = remove_common_delay(records, &signal, late.delay_s);
    caution_ui(ui, &words, vec![remedy], palette, commands);
}
