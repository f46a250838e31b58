//! The bar below: whether the results are up to date, and the message to the engineer.

use egui::{Align, Button, Layout, RichText, Ui};

use gdcm_core::dataset::BundleKind;
use gdcm_core::study::Assessed;

use super::command::Command;
use super::palette::{Palette, SMALL_SIZE};
use super::records::RecordsBench;
use super::results::{Background, bar_words};
use super::state::{NoticeKind, State};

/// State of the computation on the left, message or standing remark on the right.
pub fn status_bar_ui(ui: &mut Ui, state: &State, palette: &Palette, commands: &mut Vec<Command>) {
    ui.horizontal(|ui| {
        computation_ui(ui, state, palette, commands);
        ui.with_layout(Layout::right_to_left(Align::Center), |ui| match &state.notice {
            Some(notice) => {
                if ui.add(Button::new("Dismiss").small()).clicked() {
                    commands.push(Command::DismissNotice);
                }
                let color = if notice.kind == NoticeKind::Done { palette.good } else { palette.warning };
                let text = RichText::new(&notice.text).size(SMALL_SIZE).color(color);
                ui.add(egui::Label::new(text).truncate()).on_hover_text(&notice.text);
            }
            None => {
                let text = RichText::new(standing_remark(state)).size(SMALL_SIZE).color(palette.dim_text);
                ui.add(egui::Label::new(text).truncate());
            }
        });
    });
}

fn computation_ui(ui: &mut Ui, state: &State, palette: &Palette, commands: &mut Vec<Command>) {
    let now = ui.input(|input| input.time);
    let (text, color) = match (&state.opening, state.results.is_stale(now), state.results.progress) {
        (None, ..) if state.results.stopped => (format!("● stopped: {}", state.after_stop()), palette.warning),
        (Some(name), ..) => (format!("● reading {name} …"), palette.accent),
        (None, true, Some((done, total))) => {
            (format!("● computing, {} % …", 100 * done / total.max(1)), palette.warning)
        }
        (None, true, None) => ("● computing …".to_owned(), palette.warning),
        (None, false, _) => ("● up to date".to_owned(), palette.good),
    };
    ui.label(RichText::new(text).size(SMALL_SIZE).color(color));
    let beside =
        state.results.is_background_told(now).then(|| background_words(&state.results.background, &state.records));
    let is_stopped = state.results.background.stopped;
    let beside = if is_stopped { Some("the rest was stopped".to_owned()) } else { beside };
    if let Some(words) = &beside {
        ui.label(RichText::new(words).size(SMALL_SIZE).color(palette.dim_text));
    }
    if state.results.stopped || is_stopped {
        if ui.add(Button::new("Compute").small()).clicked() {
            commands.push(Command::Compute);
        }
    } else if (state.results.is_stale(now) || beside.is_some()) && ui.add(Button::new("Stop").small()).clicked() {
        commands.push(Command::StopComputing);
    }
    let dim = |text: String| RichText::new(text).size(SMALL_SIZE).color(palette.dim_text);
    let models: usize = state.dataset().conditions().iter().map(|condition| model_count(condition)).sum();
    ui.label(dim(format!("{models} responses · {} frequencies", state.study.settings.points)));
    if state.analysis().is_some() {
        ui.label(dim(format!("{:.1} ms", state.results.elapsed_ms))).on_hover_text("Time the newest analysis took");
    }
    if !state.file_cautions.is_empty() {
        let count = state.file_cautions.len();
        let text = if count == 1 { "1 caution".to_owned() } else { format!("{count} cautions") };
        let label = ui.label(RichText::new(text).size(SMALL_SIZE).color(palette.warning));
        label.on_hover_text(state.file_cautions.join("\n"));
    }
}

/// What is under way beside the live answer, the longest first.
fn background_words(background: &Background, records: &RecordsBench) -> String {
    if let Some((done, total)) = background.report {
        return format!("writing the report, {} % …", 100 * done / total.max(1));
    }
    if let Some((done, total)) = background.identification {
        let percent = 100 * done / total.max(1);
        return match (records.under_way(), records.running.len()) {
            (Some(job), jobs @ 2..) => {
                format!("identifying condition {}, {percent} %, {} more after it …", job.condition, jobs - 1)
            }
            _ => format!("identifying, {percent} % …"),
        };
    }
    match (background.proofs.len(), background.curves) {
        (1, _) => "proving the gains of 1 condition …".to_owned(),
        (2.., _) => format!("proving the gains of {} conditions …", background.proofs.len()),
        (0, Some((done, total))) if total > 0 => format!("curves, {} % …", 100 * done / total),
        (0, Some(_)) => "curves …".to_owned(),
        (0, None) if background.bars.is_some() => bar_words(background.bars.unwrap_or_default()),
        (0, None) if background.views > 0 => "what the views show …".to_owned(),
        (0, None) => "what holding and freeing would cost …".to_owned(),
    }
}

fn model_count(condition: &gdcm_core::dataset::Condition) -> usize {
    condition.bundle(BundleKind::Physics).len() + condition.bundle(BundleKind::Identified).len()
}

/// Why the condition shown is left out of the assessment, or what the data are.
fn standing_remark(state: &State) -> String {
    let assessed = state.analysis().and_then(|analysis| analysis.assessment.get(&state.condition().id()));
    let left_out = assessed.and_then(|assessed| match assessed {
        Assessed::LeftOut { why } => Some(why),
        Assessed::Nominal(_) => None,
    });
    match left_out {
        Some(why) => format!("condition {} is left out of the assessment: {why}", state.condition().id()),
        None => state.condition().flight_state().name.clone(),
    }
}
