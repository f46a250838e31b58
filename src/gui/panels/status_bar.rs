//! Status bar at the foot of the window: computation status, description for the element under the
//! pointer, remarks on the data.
//!
//! The live analysis is that with the current settings; all other computations are background work.

use egui::{Align, Button, Color32, Label, Layout, RichText, Ui};

use gdcm_model::dataset::BundleKind;
use gdcm_model::number_format::counted;
use gdcm_words::assessment::not_assessed_text;

use crate::gui::commands::command::Command;
use crate::gui::commands::computing::ComputingCommand;
use crate::gui::state::background::{Background, Steps, error_bar_progress};
use crate::gui::state::records::RecordsState;
use crate::gui::state::view::View;
use crate::gui::state::window_state::State;
use crate::gui::widgets::controls::button_ui;
use crate::gui::widgets::palette::{Palette, SMALL_SIZE};

/// Draws the computation status on the left. On the right: the description for the element under
/// the pointer, else, while a setting is dragged, a note about the error bars, else a remark on the
/// data. Messages are toasts in the top bar.
pub fn status_bar_ui(ui: &mut Ui, state: &State, palette: &Palette, commands: &mut Vec<Command>) {
    ui.horizontal_centered(|ui| {
        computation_ui(ui, state, palette, commands);
        ui.with_layout(Layout::right_to_left(Align::Center), |ui| {
            if let Some(pointed) = &state.display.selection.pointed_words {
                let text = RichText::new(pointed).size(SMALL_SIZE);
                ui.add(Label::new(text).truncate());
            } else if state.is_setting_dragged() {
                let words = "error bars update when the slider rests";
                ui.add(Label::new(palette.small(words)).truncate());
            } else {
                ui.add(Label::new(palette.small(data_remark(state))).truncate());
            }
        });
    });
}

fn small_button_ui(ui: &mut Ui, text: &str, command: Command, commands: &mut Vec<Command>) {
    button_ui(ui, Button::new(text).small(), "", command, commands);
}

/// Draws status, other work, *Compute* or *Stop*, the size of the data, and cautions. *Compute* is
/// offered after a stop, *Stop* while files are read, the analysis runs or background work runs.
fn computation_ui(ui: &mut Ui, state: &State, palette: &Palette, commands: &mut Vec<Command>) {
    let now = ui.input(|input| input.time);
    let status = Status::new(state, now, palette);
    ui.label(RichText::new("●").size(SMALL_SIZE).color(status.dot));
    let text = RichText::new(status.text)
        .size(SMALL_SIZE)
        .color(status.color);
    let label = ui.label(text);
    if state.analysis().is_some() {
        let elapsed_ms = state.results.elapsed_ms;
        label.on_hover_text(format!("The latest analysis took {elapsed_ms:.1} ms"));
    }
    let other_work = other_work_text(state, now);
    if let Some(words) = &other_work {
        ui.label(palette.small(words));
    }
    let is_reading = state.opening.is_some() || state.records.reading.is_some();
    let is_stopped = state.results.stopped || state.results.background.stopped;
    if !is_reading && is_stopped {
        small_button_ui(ui, "Compute", ComputingCommand::Compute.into(), commands);
    } else if is_reading || state.results.is_stale(now) || stops_background(state, now) {
        let stop = ComputingCommand::StopComputing.into();
        small_button_ui(ui, "Stop", stop, commands);
    }
    ui.label(palette.small(format!(
        "{} models · {} frequencies",
        count_models(state),
        state.study.settings.points
    )));
    if !state.file_cautions.is_empty() {
        let label = ui.label(palette.small_warning(counted(state.file_cautions.len(), "caution")));
        let lines: Vec<String> = state
            .file_cautions
            .iter()
            .map(ToString::to_string)
            .collect();
        label.on_hover_text(lines.join("\n"));
    }
}

/// Text and colours that show whether the live analysis is up to date.
struct Status {
    text: String,
    color: Color32,
    dot: Color32,
}

impl Status {
    /// Returns the first status that applies: a file is being opened; the analysis was stopped; the
    /// results are up to date, or have been pending only briefly; the analysis is running.
    fn new(state: &State, now: f64, palette: &Palette) -> Self {
        if let Some(name) = &state.opening {
            return Self::colored(format!("reading {name} …"), palette.accent);
        }
        if state.results.stopped {
            let text = format!("stopped: {}", state.after_stop().text);
            return Self::colored(text, palette.warning);
        }
        if !state.results.is_stale(now) {
            // The text is not green: green would suggest that gains and phases are matched. The dot
            // is green only if no other work is under way.
            let dot = if other_work_text(state, now).is_some() {
                palette.accent
            } else {
                palette.good
            };
            return Self {
                text: "up to date".to_owned(),
                color: palette.dim_text,
                dot,
            };
        }
        let text = match state.results.background.analysis {
            Some(steps) if steps.total > 0 => format!("computing, {} % …", steps.percent()),
            _ => "computing …".to_owned(),
        };
        Self::colored(text, palette.warning)
    }

    fn colored(text: String, color: Color32) -> Self {
        Self {
            text,
            color,
            dot: color,
        }
    }
}

/// Describes the work other than the live analysis: first the reading of records, else that
/// background work was stopped, else the background work, unless it began only recently. `None` if
/// there is none.
fn other_work_text(state: &State, now: f64) -> Option<String> {
    let background = &state.results.background;
    if let Some(reading) = &state.records.reading {
        return Some(format!("reading {reading} …"));
    }
    if background.stopped {
        return Some("background work stopped".to_owned());
    }
    if state.results.shows_background(now) {
        return Some(background_words(background, &state.records));
    }
    None
}

/// Returns whether the *Stop* in the status bar stops background work: work started in a view in
/// front has its *Stop* there.
fn stops_background(state: &State, now: f64) -> bool {
    let mut background = state.results.background.clone();
    if state.shows_view(View::Records) {
        background.identification = None;
    }
    background.is_busy() && state.results.shows_background(now)
}

/// Counts the models in both bundles over all conditions.
fn count_models(state: &State) -> usize {
    let mut count = 0;
    for condition in state.dataset().conditions() {
        for kind in BundleKind::BOTH {
            count += condition.bundle(kind).len();
        }
    }
    count
}

/// Describes the background work other than the live analysis; if there are several jobs, the first
/// in the order below.
fn background_words(background: &Background, records: &RecordsState) -> String {
    if let Some(steps) = background.report {
        return format!("writing the report, {} % …", steps.percent());
    }
    if let Some(steps) = background.report_contents {
        return format!("preparing the report, {} % …", steps.percent());
    }
    if let Some(steps) = background.identification {
        return identification_words(records, steps.percent());
    }
    if !background.proofs.is_empty() {
        let conditions = counted(background.proofs.len(), "condition");
        return format!("proving the gains optimal in {conditions} …");
    }
    match background.curves {
        Some(Steps { total: 0, .. }) => return "computing curves …".to_owned(),
        Some(steps) => return format!("computing curves, {} % …", steps.percent()),
        None => {}
    }
    if let Some(steps) = background.error_bars {
        return error_bar_progress(steps);
    }
    if let Some(steps) = background.time_histories {
        return format!(
            "simulating models with flight records, {} % …",
            steps.percent()
        );
    }
    if let Some(steps) = background.couplings {
        return format!(
            "testing couplings on left-out conditions, {} % …",
            steps.percent()
        );
    }
    if let Some(steps) = background.physics {
        return format!("fitting physics parameters, {} % …", steps.percent());
    }
    if background.views > 0 {
        "preparing the views …".to_owned()
    } else {
        "computing the costs of holding and releasing responses …".to_owned()
    }
}

/// Formats, for example, "identifying condition 10, 40 %, 8 of 11 finished · correction unchanged
/// until the fits are used".
fn identification_words(records: &RecordsState, percent: usize) -> String {
    let mut words = match records.running_job() {
        Some(job) => format!("identifying condition {}, {percent} %", job.condition),
        None => format!("identifying, {percent} %"),
    };
    let requested = records.requested_count;
    if requested > 1 {
        let finished = requested.saturating_sub(records.jobs.len());
        words.push_str(&format!(", {finished} of {requested} finished"));
    }
    words.push_str(" · correction unchanged until the fits are used");
    words
}

/// Returns why the assessment leaves out the displayed condition, or else its flight state.
fn data_remark(state: &State) -> String {
    let id = state.condition().id();
    if let Some(analysis) = state.analysis()
        && let Some(Err(why)) = analysis.assessment.get(&id)
    {
        let why = not_assessed_text(why, state.dataset());
        return format!("condition {id} is left out of the assessment: {why}");
    }
    state.condition().flight_state().name.clone()
}

#[cfg(test)]
mod tests {
    use gdcm_io::embedded_example;
    use gdcm_study::Study;

    use super::*;

    #[test]
    fn the_dot_is_green_only_while_nothing_is_computed() {
        let study = Study::new(embedded_example().unwrap().dataset);
        let mut state = State::new(study, "study".to_owned(), Vec::new());
        let palette = Palette::dark();
        assert_eq!(Status::new(&state, 9.0, &palette).dot, palette.good);
        state.results.background.views = 1;
        state.results.background_since = Some(0.0);
        let status = Status::new(&state, 9.0, &palette);
        assert_eq!(status.dot, palette.accent);
        assert_eq!(status.color, palette.dim_text);
    }

    #[test]
    fn the_progress_of_a_couplings_assessment_is_reported() {
        let background = Background {
            couplings: Some(Steps {
                done: 300,
                total: 1000,
            }),
            ..Background::default()
        };
        assert!(background.is_busy());
        let words = background_words(&background, &RecordsState::default());
        assert!(words.ends_with(" 30 % …"), "{words}");
    }
}
