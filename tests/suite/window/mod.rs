//! The window, operated by accessible labels: no display, no GPU.

mod assembling;
mod commands;
mod computing;
mod controls;
mod couplings;
mod curves;
mod decisions;
mod edges;
mod exporting;
mod figures;
mod files;
mod foreign;
mod forms;
mod frame;
mod hands;
mod keyboard;
mod layout;
mod lead;
mod lists;
mod logs;
mod memory;
mod physics;
mod pictures;
mod plots;
mod pointing;
mod record_cautions;
pub(crate) mod records;
mod recovery;
mod reload;
mod requirements;
mod settings;
mod start;
mod toasts;
mod views;
mod walk;

use std::path::Path;
use std::process::Command;
use std::sync::{Arc, LazyLock};
use std::time::{Duration, Instant};

use egui::accesskit::Role;
use egui::{Event, Key, Modifiers, PointerButton, Pos2, pos2, vec2};
use egui_kittest::Harness;
use egui_kittest::kittest::{NodeT, Queryable};

use gdcm::executor::Pool;
use gdcm::gui::app::{GdcmApp, Setup};
use gdcm::gui::panels::derivation_sheet::toggle_cost_texts;
use gdcm::gui::panels::matrix_panel::MatrixMarks;
use gdcm::gui::plot::{BodeCurve, Pane, Role as CurveRole};
use gdcm::gui::state::notices::{MessageBar, NoticeKind};
use gdcm::gui::state::record_change::RecordChange;
use gdcm::gui::state::view::View;
use gdcm::gui::state::window_state::State;
use gdcm::gui::views::channels::channel_plots;
use gdcm::gui::views::shown_remarks::remarks_shown;
use gdcm_io::export::EXPORTERS;
use gdcm_io::files::study_file::{OpenedStudy, open_study};
use gdcm_io::{Opened, load_any};
use gdcm_model::dataset::{BundleKind, ConditionId, ModelId, Pair};
use gdcm_model::number_format::counted;
use gdcm_model::progress::Unobserved;
use gdcm_plot::figure::gains::{Across, Measure};
use gdcm_plot::figure::marks::MarkId;
use gdcm_study::decisions::history::Change;
use gdcm_study::results::remark::Remark;
use gdcm_study::stages::engine::LIVE_PROOF;
use gdcm_study::{Engine, Study};

pub(crate) type Window = Harness<'static, GdcmApp>;

/// Far above the time needed on the slowest machine, so that only a hang exceeds it.
const LIMIT: Duration = Duration::from_secs(900);

const CONDITION_10: &str = "Condition 10: 60 kt, low altitude, high weight";

/// Opens the example and waits for its first results.
pub(crate) fn window() -> Window {
    window_with(example(), warm())
}

fn example() -> Opened {
    Opened::Dataset(crate::EXAMPLE.clone())
}

/// Engine that has already analysed the example, including error bars. Most tests start with it, so
/// that they need not wait for these results.
static WARM: LazyLock<Engine> = LazyLock::new(|| {
    let mut engine = Engine::default().with_proofs_within(LIVE_PROOF);
    let analysis = engine
        .analyze(&Study::new(crate::EXAMPLE.dataset.clone()), &Unobserved)
        .expect("nothing stops it");
    engine
        .uncertainty(&analysis, &Unobserved)
        .expect("nothing stops it");
    engine
});

fn warm() -> Setup {
    Setup {
        engine: Arc::new(|| WARM.fork(Box::new(Pool))),
        ..Setup::default()
    }
}

/// Opens a few conditions of the example and waits for their first results.
pub(crate) fn few_window() -> Window {
    window_with(Opened::Dataset(crate::FEW.clone()), Setup::default())
}

/// Opens the example without any results.
fn cold_example(creation: &mut eframe::CreationContext<'static>) -> GdcmApp {
    GdcmApp::with_setup(&creation.egui_ctx, example(), Setup::default())
        .expect("a thread can be started")
}

/// Opens the example with an engine that has analysed it.
fn warm_example(creation: &mut eframe::CreationContext<'static>) -> GdcmApp {
    GdcmApp::with_setup(&creation.egui_ctx, example(), warm()).expect("a thread can be started")
}

fn window_with(opened: Opened, setup: Setup) -> Window {
    let build = |creation: &mut eframe::CreationContext<'static>| {
        GdcmApp::with_setup(&creation.egui_ctx, opened, setup).expect("a thread can be started")
    };
    let mut window = Harness::builder()
        .with_size(vec2(1600.0, 1000.0))
        .build_eframe(build);
    settle(&mut window);
    window
}

/// Draws frames until a condition is met; fails after [`LIMIT`].
pub(crate) fn wait_until(window: &mut Window, what: &str, is_so: impl Fn(&Window) -> bool) {
    let limit = Instant::now() + LIMIT;
    while !is_so(window) {
        window.run_steps(1);
        let results = &state(window).results;
        assert!(
            Instant::now() < limit,
            "never came: {what} ({} of {})",
            results.received,
            results.requested
        );
        std::thread::sleep(Duration::from_millis(5));
    }
    window.run_steps(1);
}

/// Draws frames until nothing is being computed or read, and the curves of the displayed condition
/// are available.
pub(crate) fn settle(window: &mut Window) {
    window.run_steps(2);
    wait_until(window, "the results", |window| {
        let state = state(window);
        let drawn = !state.display.frequency.drawn.is_empty()
            || !state.display.layout.arrangement.is_shown(View::Bode);
        let shown = state.responses().is_some() && drawn;
        !state.results.is_waiting() && shown && state.opening.is_none()
    });
    window.run_steps(2);
}

/// Draws frames until the values have their error bars, which [`settle`] does not wait for.
pub(crate) fn wait_for_bars(window: &mut Window) {
    wait_until(window, "the error bars", |window| {
        state(window).uncertainty().is_some()
    });
}

pub(crate) fn click(window: &mut Window, label: &str) {
    window.get_by_label(label).click();
    settle(window);
}

/// Asserts that the notice has this kind and code, and that it contains these names and numbers.
#[track_caller]
pub(crate) fn assert_notice(window: &Window, kind: NoticeKind, code: &str, names: &[&str]) {
    let notice = state(window)
        .notices
        .newest()
        .cloned()
        .expect("there is a notice");
    assert_eq!((notice.kind, notice.code), (kind, code), "{}", notice.text);
    for name in names {
        assert!(notice.text.contains(name), "{name} in {}", notice.text);
    }
}

/// Returns the codes of the message bars, oldest first.
pub(crate) fn bar_codes(window: &Window) -> Vec<&'static str> {
    let bars = state(window).notices.bars();
    bars.map(MessageBar::code).collect()
}

/// Returns the places of the main plot, of a cell of the matrix, of the verdict and of a button,
/// which no message may move.
pub(crate) fn fixed_places(window: &Window) -> [egui::Rect; 4] {
    let bode = &state(window).display.frequency.bode;
    let plot = bode.transform(Pane::Magnitude).expect("the plot is drawn");
    let matrix = window.get_by_label("Response LON → Q").rect();
    let verdict = window.query_all_by_label_contains("Gain: ").next();
    let verdict = verdict.expect("there is a verdict").rect();
    let button = window.get_by_role_and_label(Role::Button, "Export corrections…");
    [*plot.frame(), matrix, verdict, button.rect()]
}

/// Returns the codes of the remarks about the displayed condition.
pub(crate) fn remark_codes(window: &Window) -> Vec<&'static str> {
    let shown = state(window).shown().expect("there is a result");
    let remarks = remarks_shown(state(window), shown);
    remarks.iter().map(Remark::code).collect()
}

/// Returns the change that undo would take back.
pub(crate) fn last_change(window: &Window) -> Option<&Change<RecordChange>> {
    let step = state(window).history.undo_step();
    step.map(|step| &step.change)
}

pub(crate) fn state(window: &Window) -> &State {
    window.state().state()
}

fn pair(window: &Window, output: &str, input: &str) -> Pair {
    state(window)
        .dataset()
        .find_pair(output, input)
        .expect("the example has this response")
}

fn net_gain(window: &Window, output: &str, input: &str) -> f64 {
    let pair = pair(window, output, input);
    state(window)
        .shown()
        .expect("the condition has a result")
        .correction
        .net_gain(pair)
}

fn drawn(window: &Window, role: CurveRole) -> BodeCurve {
    let mut curves = state(window).display.frequency.drawn.iter();
    curves
        .find(|curve| curve.role == role)
        .expect("a curve of this role is drawn")
        .clone()
}

fn choose_condition_10(window: &mut Window) {
    click(window, CONDITION_10);
    click(window, "Response LON → Q");
}

/// Unfolds the settings, including the rarely changed ones, or folds them.
pub(crate) fn unfold_settings(window: &mut Window, is_open: bool) {
    use gdcm::gui::commands::layout::LayoutCommand::{ShowAdvanced, ShowSettings};
    for command in [ShowSettings(is_open), ShowAdvanced(is_open)] {
        window.state_mut().dispatch(command);
    }
    window.run_steps(2);
}

/// Unfolds the settings and moves the slider of a setting.
pub(crate) fn slide(window: &mut Window, name: &str, value: f64) {
    unfold_settings(window, true);
    window
        .get_by_role_and_label(Role::Slider, &format!("{name} slider"))
        .set_value_accesskit(value);
    window.run_steps(2);
    unfold_settings(window, false);
}

pub(crate) fn fill(window: &mut Window, field: &str, path: &Path) {
    window.get_by_label(field).focus();
    window.run_steps(2);
    window.get_by_label(field).type_text(path.to_str().unwrap());
    window.run_steps(2);
}

/// Replaces the text of a field.
pub(crate) fn refill(window: &mut Window, field: &str, text: &str) {
    window.get_by_label(field).focus();
    window.run_steps(2);
    window.key_press_modifiers(Modifiers::COMMAND, Key::A);
    window.run_steps(2);
    window.key_press(Key::Backspace);
    window.run_steps(2);
    window.get_by_label(field).type_text(text);
    window.run_steps(2);
}

/// Opens the export dialog, types the folder and the prefix, and chooses exactly these formats, by
/// their names on the command line.
pub(crate) fn open_export(window: &mut Window, folder: &Path, prefix: &str, formats: &[&str]) {
    if state(window).forms.shown.is_none() {
        click(window, "Export corrections…");
    }
    refill(window, "Export folder", folder.to_str().unwrap());
    refill(window, "File prefix", prefix);
    for format in EXPORTERS {
        let is_chosen = state(window)
            .forms
            .export
            .choices
            .formats
            .contains(format.name);
        if is_chosen != formats.contains(&format.name) {
            let name = format!("Export {} .{}", format.title, format.extension);
            window.get_by_label(&name).click();
            window.run_steps(2);
        }
    }
    wait_for_export_plan(window);
}

/// Draws frames until the dry run of the export dialog has ended, and nothing is running that could
/// change the results and so request another one.
pub(crate) fn wait_for_export_plan(window: &mut Window) {
    wait_until(window, "the dry run of the export", |window| {
        let state = state(window);
        state.current_export_plan().is_some() && state.results.background_since.is_none()
    });
}

/// Presses the button of the export dialog that writes the files, and waits until the dialog is
/// closed or shows an error.
pub(crate) fn press_export(window: &mut Window) {
    loop {
        wait_for_export_plan(window);
        // Results that arrive in a later frame disable the button until the dry run is repeated.
        let Some(plan) = state(window).current_export_plan() else {
            continue;
        };
        let label = format!("Export {}", counted(plan.file_count(), "file"));
        click(window, &label);
        if is_export_taken(window) {
            break;
        }
    }
    wait_until(window, "the end of the export", is_export_ended);
}

/// Returns whether the program has written the files, has refused to, or will do either as soon as
/// the dry run has ended.
fn is_export_taken(window: &Window) -> bool {
    is_export_ended(window) || state(window).forms.export.is_awaited
}

fn is_export_ended(window: &Window) -> bool {
    let forms = &state(window).forms;
    forms.shown.is_none() || forms.export.error.is_some()
}

fn open_by_path(window: &mut Window, path: &Path) {
    window.key_press_modifiers(Modifiers::COMMAND | Modifiers::SHIFT, Key::O);
    window.run_steps(2);
    fill(window, "Path to open", path);
    click(window, "Open file");
}

/// Exports the values, channels and responses of all conditions into a folder.
pub(crate) fn export_to(window: &mut Window, folder: &Path) {
    open_export(window, folder, "", &["json", "csv", "assessment"]);
    press_export(window);
    assert_notice(window, NoticeKind::Done, "exported", &["3 files"]);
}

fn wait_for_toggles(window: &mut Window) {
    wait_until(window, "the costs", |window| {
        state(window).toggles().is_some()
    });
}

/// Draws frames until no background job is running.
fn wait_for_background(window: &mut Window) {
    wait_until(window, "what is computed beside", |window| {
        state(window).results.background_since.is_none()
    });
}

/// Saves the study at a path, as the form does.
pub(crate) fn save_as(window: &mut Window, path: &Path) {
    window.state_mut().save_study_as(path.to_owned());
    settle(window);
}
