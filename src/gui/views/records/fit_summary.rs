//! Summary of the displayed condition's identification, at the top of the right panel: the
//! recommended model's costs and order, its use, and progress or failure.
//!
//! χ²/dof is the cost of the fit for each degree of freedom, 1 if the model leaves only noise
//! (M14.4: docs/identification.md). The *past window* and the *Laguerre pole* are the settings with
//! which CT-PBSID has found the model (M14.3); the identification tries several of both.

use egui::{Color32, Label, ProgressBar, Rect, RichText, Role, Sense, Ui, UiBuilder, vec2};

use gdcm_model::dataset::BundleKind;
use gdcm_model::number_format::{counted, decimals};
use gdcm_study::jobs::identification_jobs::IdentifyJob;
use gdcm_sysid::diagnostics::model_cautions::{NOT_PREDICTED, PREDICTED_WELL};
use gdcm_sysid::identification::Identification;

use super::caution_list::remedy_ui;
use super::caution_remedies::{band_remedy, study_band_remedy};
use super::offered_models::offered_models_ui;
use super::page::Page;
use super::record_list::{BAD_FIT, CHI_SQUARED};
use super::value_range::value_text;
use crate::gui::commands::command::Command;
use crate::gui::commands::records::RecordsCommand;
use crate::gui::state::condition_records::EndedIdentification;
use crate::gui::widgets::controls::{Asks, named};
use crate::gui::widgets::painted_text::{AT_RIGHT_END, painted_text};
use crate::gui::widgets::palette::{BODY_SIZE, Palette, body, medium, small};

/// Summary height \[pt\], independent of the content.
const SUMMARY: f32 = 4.0 * LINE + USE_LINE + 8.0;
/// Line height \[pt\].
const LINE: f32 = 20.0;
/// Height of the line about use in the study \[pt\].
const USE_LINE: f32 = 26.0;
/// Tooltip on the held-out records' cost.
const HELD_OUT_HINT: &str = "χ²/dof of the held-out records for the identified model, unchanged";

/// Shows the summary; only the reason for a failure may need more than the reserved height.
pub(super) fn fit_summary_ui(ui: &mut Ui, page: Page<'_>, commands: &mut Vec<Command>) {
    let size = vec2(ui.available_width(), SUMMARY);
    ui.allocate_ui(size, |ui| {
        ui.set_min_size(size);
        ui.spacing_mut().item_spacing.y = 2.0;
        lines_ui(ui, page, commands);
    });
}

/// Draws the heading, and below it: first, the progress of a running identification; else the
/// reason for a failure, with the band that would let it succeed; else the figures of the finished
/// one (or that there is none), its use in the study, and the band.
fn lines_ui(ui: &mut Ui, page: Page<'_>, commands: &mut Vec<Command>) {
    let Page {
        state,
        records,
        palette,
    } = page;
    let condition = state.condition().id();
    let heading = line_ui(ui, LINE);
    let title = format!("Fit of condition {condition}");
    painted_text(ui, heading, 0.0, &title, medium(BODY_SIZE), palette.text);
    if let Some(job) = state.records.job_of(condition) {
        progress_ui(ui, page, job);
        return;
    }
    match &records.latest {
        None => {
            let text = "No identification yet: choose Identify";
            let line = line_ui(ui, 2.0 * LINE);
            painted_text(ui, line, 0.0, text, body(), palette.dim_text);
        }
        Some(EndedIdentification {
            job,
            outcome: Err(error),
        }) => {
            let text = RichText::new(error.to_string()).color(palette.warning);
            ui.add(Label::new(text).wrap());
            if let Some(remedy) = band_remedy(error, job.request.options.band) {
                remedy_ui(ui, &remedy, commands);
            }
            return;
        }
        Some(EndedIdentification {
            job,
            outcome: Ok(identification),
        }) => {
            let models = counted(1 + identification.bundle.len(), "model");
            let is_outdated = state.is_fit_outdated(condition);
            let words = if is_outdated {
                "outdated".to_owned()
            } else {
                match job.news().duration_s {
                    Some(duration_s) => format!("{} s, {models}", decimals(duration_s, 1)),
                    None => models,
                }
            };
            let color = if is_outdated {
                palette.warning
            } else {
                palette.dim_text
            };
            painted_text(ui, heading, AT_RIGHT_END, &words, small(), color);
            figures_ui(ui, identification, palette);
        }
    }
    use_ui(ui, page, commands);
    band_ui(ui, page, commands);
}

/// Allocates a line over the whole width.
fn line_ui(ui: &mut Ui, height: f32) -> Rect {
    let size = vec2(ui.available_width(), height);
    ui.allocate_exact_size(size, Sense::hover()).0
}

/// Number in the summary, drawn in half a line.
struct Figure<'a> {
    name: &'a str,
    value: String,
    color: Color32,
    hint: String,
}

/// Shows costs, order and Laguerre pole in two lines. The held-out records' cost is that of the
/// model as it is; its colour judges the cost of the model adapted within its uncertainty, if that
/// is known.
fn figures_ui(ui: &mut Ui, identification: &Identification, palette: &Palette) {
    let held_out = match (
        identification.held_out_cost,
        identification.held_out_normalised,
    ) {
        (Some(raw), Some(normalised)) => Figure {
            name: "held out",
            value: decimals(raw, 2),
            color: limit_color(normalised, NOT_PREDICTED, palette),
            hint: format!(
                "{HELD_OUT_HINT}; {} for this model adapted within its uncertainty, where values \
                up to {PREDICTED_WELL} are good",
                decimals(normalised, 2)
            ),
        },
        (raw, _) => Figure {
            name: "held out",
            value: value_text(raw, 2),
            color: palette.text,
            hint: match raw {
                Some(_) => HELD_OUT_HINT.to_owned(),
                None => {
                    "No cost of held-out records: hold out a record to test the model".to_owned()
                }
            },
        },
    };
    let order = match identification.refined.order() {
        Some(order) => order.to_string(),
        None => "–".to_owned(),
    };
    let lines = [
        [
            Figure {
                name: "χ²/dof",
                value: decimals(identification.cost, 2),
                color: limit_color(identification.cost, BAD_FIT, palette),
                hint: CHI_SQUARED.to_owned(),
            },
            held_out,
        ],
        [
            Figure {
                name: "order",
                value: order,
                color: palette.text,
                hint: format!("CT-PBSID, refined; past window {}", identification.past),
            },
            Figure {
                name: "Laguerre, rad/s",
                value: decimals(identification.laguerre_pole, 1),
                color: palette.text,
                hint: "Best of the Laguerre poles that were tried [rad/s]".to_owned(),
            },
        ],
    ];
    for figures in lines {
        let line = line_ui(ui, LINE);
        let width = 0.5 * (line.width() - 20.0);
        for (number, figure) in figures.into_iter().enumerate() {
            let left = line.left() + number as f32 * (width + 20.0);
            let place = line.with_min_x(left).with_max_x(left + width);
            painted_text(ui, place, 0.0, figure.name, body(), palette.dim_text);
            painted_text(
                ui,
                place,
                AT_RIGHT_END,
                &figure.value,
                medium(BODY_SIZE),
                figure.color,
            );
            let response = ui.interact(place, ui.scope_id().with(figure.name), Sense::hover());
            let sentence = format!("{} {}", figure.name, figure.value);
            named(response, Role::Label, sentence).on_hover_text(figure.hint);
        }
    }
}

fn limit_color(value: f64, limit: f64, palette: &Palette) -> Color32 {
    if value <= limit {
        palette.text
    } else {
        palette.warning
    }
}

/// Shows the button that uses the models in the study, and which models are in use; if they come
/// from the records, also the button that restores the file's models.
fn use_ui(ui: &mut Ui, page: Page<'_>, commands: &mut Vec<Command>) {
    let Page {
        state,
        records,
        palette,
    } = page;
    let condition = state.condition().id();
    let is_taken = state.study.adopted_models().any(|(id, _)| id == condition);
    let size = vec2(ui.available_width(), USE_LINE);
    ui.allocate_ui(size, |ui| {
        ui.set_min_size(size);
        ui.horizontal_centered(|ui| {
            ui.spacing_mut().item_spacing.x = 8.0;
            if records.identification().is_some() {
                let text = "Use this fit";
                let hint =
                    "Replaces the identified models of this condition; can be undone in one step";
                if let Some(offered) = offered_models_ui(ui, text, hint) {
                    commands.push(RecordsCommand::Adopt(offered).into());
                }
            }
            let words = if is_taken {
                "in use: from these records"
            } else if state.condition().bundle(BundleKind::Identified).is_empty() {
                "in use: no identified model"
            } else {
                "in use: models of the file"
            };
            ui.label(palette.small(words));
            if is_taken {
                ui.small_button("Restore")
                    .on_hover_text("Restores the models of the file; can be undone in one step")
                    .asks(RecordsCommand::RestoreFileModels, commands);
            }
        });
    });
}

/// Shows the identification band; if the condition has a band of its own, also a button that
/// returns to the study's band.
fn band_ui(ui: &mut Ui, page: Page<'_>, commands: &mut Vec<Command>) {
    let Page {
        state,
        records,
        palette,
    } = page;
    let study_band = state.study.settings.band;
    let [low, high] = records.band.unwrap_or([study_band.min(), study_band.max()]);
    let line = line_ui(ui, LINE);
    let whose = if records.band.is_some() {
        "own band"
    } else {
        "band of the study"
    };
    let words = format!(
        "{whose}, {} to {} rad/s",
        decimals(low, 2),
        decimals(high, 1)
    );
    let shown = painted_text(ui, line, 0.0, &words, small(), palette.dim_text);
    if records.band.is_some() {
        let place = line.with_min_x(shown.right() + 10.0);
        ui.scope_builder(UiBuilder::new().max_rect(place), |ui| {
            ui.spacing_mut().button_padding.y = 0.0;
            remedy_ui(ui, &study_band_remedy(), commands);
        });
        ui.advance_cursor_after_rect(line);
    }
}

/// Shows the completed share and the current step or, while waiting, the condition that is being
/// identified.
fn progress_ui(ui: &mut Ui, page: Page<'_>, job: &IdentifyJob) {
    let Page { state, palette, .. } = page;
    let news = job.news();
    let mut share = 0.0;
    let mut words = String::new();
    // A waiting job has no step yet.
    if !news.step.is_empty() {
        let steps = state.results.background.identification.unwrap_or_default();
        share = steps.done as f32 / steps.total.max(1) as f32;
        words = format!("{}, {:.0} %", news.step, 100.0 * share);
    } else if let Some(earlier) = state.records.running_job() {
        words = format!("Waiting for condition {}", earlier.condition);
    }
    ui.add(ProgressBar::new(share).desired_height(6.0));
    ui.label(palette.small(words));
    if news.first_model.is_some() {
        ui.label(palette.small("The first model is drawn; it is being refined"));
    }
}
