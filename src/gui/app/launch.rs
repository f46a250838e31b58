//! Starts the program: from the command line to a window on the screen.

use std::error::Error;
use std::ops::RangeInclusive;
use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::sync::{Arc, OnceLock};
use std::thread::JoinHandle;
use std::time::Duration;

use eframe::{App, NativeOptions};
use egui::ViewportBuilder;

use gdcm_io::files::study_file::holds_models;
use gdcm_io::files::user_state::recent_files;
use gdcm_io::reading_budget::ReadingBudget;
use gdcm_io::source::file_exists;
use gdcm_io::{FileError, Opened, embedded_example, load_any};
use gdcm_model::message_text::{sanitized, sanitized_path, shortened_message};
use gdcm_study::Engine;
use gdcm_study::stages::engine::LIVE_PROOF;

use super::autosave::Autosave;
use super::recovery::{LAST_WAIT, end_words};
use super::threads::{Fault, caught};
use super::window::PREFERENCES;
use super::{EngineMaker, GdcmApp, threads};
use crate::executor::{Pool, start_threads};
use crate::gui::commands::assembling::AssemblingCommand;
use crate::gui::commands::file::FileCommand;
use crate::gui::state::opens_with::OpensWith;
use crate::gui::state::preferences::Preferences;

/// Application id on the desktop, and name of the data directory.
pub(super) const APP_ID: &str = "gdcm";
/// Exit status if the window could not be opened or panicked.
const NO_WINDOW: u8 = 1;
/// Exit status for a wrong file.
const WRONG_FILE: u8 = 2;

/// Setup of a window; tests use other values than the program.
#[derive(Clone)]
pub struct Setup {
    pub engine: EngineMaker,
    /// Directory of the recovery files and of the list of recent files; `None` keeps neither.
    pub directory: Option<PathBuf>,
    /// Expansion of `~` in typed paths; without it, `~` stays.
    pub home: Option<PathBuf>,
    /// Whether the first start offers the guided tour.
    pub offers_tour: bool,
    /// Maximum delay between a change and its copy in the recovery file.
    pub keep_after: Duration,
    /// Interval between checks of the dataset's file.
    pub look_every: Duration,
    pub preferences: Preferences,
    /// Problem found before the window was opened; shown first.
    pub trouble: Option<String>,
}

impl Default for Setup {
    fn default() -> Self {
        Self {
            engine: Arc::new(|| {
                Engine::with_executor(Box::new(Pool)).with_proofs_within(LIVE_PROOF)
            }),
            directory: None,
            home: None,
            offers_tour: false,
            keep_after: Duration::from_secs(2),
            look_every: Duration::from_millis(1500),
            preferences: Preferences::default(),
            trouble: None,
        }
    }
}

impl Setup {
    /// Returns the setup of the program, with the directories given by the platform.
    pub(super) fn of_program() -> Self {
        Self {
            directory: eframe::storage_dir(APP_ID),
            home: std::env::home_dir(),
            offers_tour: true,
            ..Self::default()
        }
    }
}

/// Opens the window on a dataset or a study, or on the embedded example, and returns once it is
/// closed.
///
/// Without a display, or if the window cannot be created, one line on standard error reports it and
/// names the headless command.
///
/// A folder, or a file of another program, is opened to import its models.
pub fn open(path: Option<PathBuf>) -> ExitCode {
    let models = path.clone().filter(|path| holds_models(path));
    let command = headless(path.as_deref(), models.is_some());
    let dataset = path.filter(|_| models.is_none());
    if let Some(reason) = missing_display() {
        if told(load(dataset)).1.is_some() {
            return ExitCode::from(WRONG_FILE);
        }
        eprintln!("error: {}", no_window(&reason, &command));
        return ExitCode::from(NO_WINDOW);
    }
    // The file is read while the window is created.
    let reading = std::thread::Builder::new()
        .name("file".to_owned())
        .spawn(|| told(load(dataset)));
    let reading = match start_threads()
        .map_err(|error| error.to_string())
        .and(reading.map_err(|error| error.to_string()))
    {
        Ok(reading) => reading,
        Err(reason) => {
            eprintln!(
                "error: {}",
                no_window(&format!("no thread is to be had ({reason})"), &command)
            );
            return ExitCode::from(NO_WINDOW);
        }
    };
    let mended =
        eframe::storage_dir(APP_ID).and_then(|directory| mend_zoom(&directory.join("app.ron")));
    mended
        .iter()
        .for_each(|words| eprintln!("caution: {words}"));
    std::panic::set_hook(Box::new(threads::note));
    let opening = Arc::new(OnceLock::new());
    match ending(
        caught(|| run(reading, models, &opening)),
        opening.get(),
        &command,
    ) {
        Ok(()) => ExitCode::SUCCESS,
        Err(words) => {
            eprintln!("error: {words}");
            ExitCode::from(NO_WINDOW)
        }
    }
}

/// Returns the reason why the window ended, unless it was closed. `kept` is the autosave, once a
/// frame is drawn; `command` is the headless alternative.
fn ending(
    run: Result<eframe::Result, Fault>,
    kept: Option<&Autosave>,
    command: &str,
) -> Result<(), String> {
    match (run, kept) {
        (Ok(Ok(())), _) => Ok(()),
        // A missing system library causes a panic during the window library's start-up, not an
        // error.
        (Ok(Err(error)), None) => Err(no_window(&error.to_string(), command)),
        (Err(fault), None) => Err(no_window(&fault.message, command)),
        (Ok(Err(error)), Some(autosave)) => {
            Err(end_words(&error.to_string(), &autosave.flush(LAST_WAIT)))
        }
        (Err(fault), Some(autosave)) => Err(end_words(&fault.words(), &autosave.flush(LAST_WAIT))),
    }
}

/// The study to open, and the fault in the requested file, in which case the window opens the
/// example.
type Loaded = (Result<Opened, String>, Option<String>);

fn load(path: Option<PathBuf>) -> Loaded {
    let words = |error: FileError| shortened_message(&sanitized(&error.to_string()));
    let example = || embedded_example().map(Opened::Dataset).map_err(words);
    match path.map(|path| load_any(&path, &ReadingBudget::default()).map_err(words)) {
        None => (example(), None),
        Some(Ok(opened)) => (Ok(opened), None),
        Some(Err(trouble)) => (example(), Some(trouble)),
    }
}

/// Reports a faulty file on the terminal too: without a window that is the only report.
fn told(loaded: Loaded) -> Loaded {
    loaded
        .1
        .iter()
        .for_each(|words| eprintln!("error: {words}"));
    loaded
}

fn run(
    reading: JoinHandle<Loaded>,
    models: Option<PathBuf>,
    opening: &Arc<OnceLock<Autosave>>,
) -> eframe::Result {
    let viewport = ViewportBuilder::default()
        .with_title("gdcm")
        .with_app_id(APP_ID)
        .with_inner_size([1440.0, 900.0])
        .with_min_inner_size([900.0, 560.0]);
    // There are no gradients to smooth, and without a graphics processor dithering would cost time
    // for every pixel.
    let options = NativeOptions {
        viewport,
        dithering: false,
        ..NativeOptions::default()
    };
    let opening = Arc::clone(opening);
    let build = move |creation: &eframe::CreationContext<'_>| -> Result<Box<dyn App>, Box<dyn Error + Send + Sync>> {
        let (opened, trouble) = reading.join().unwrap_or_else(|panic| std::panic::resume_unwind(panic));
        let opened = opened?;
        let is_unasked = models.is_none()
            && trouble.is_none()
            && matches!(&opened, Opened::Dataset(loaded) if loaded.path().is_none());
        let kept = creation.storage.and_then(|storage| eframe::get_value(storage, PREFERENCES));
        let setup = Setup { preferences: kept.unwrap_or_default(), trouble, ..Setup::of_program() };
        let last = last_opened(&setup).filter(|_| is_unasked);
        let mut app = GdcmApp::with(&creation.egui_ctx, opened, setup)?;
        if let Some(path) = last {
            app.dispatch(FileCommand::Open(path));
        }
        if let Some(models) = models {
            app.dispatch(AssemblingCommand::Add(vec![models]));
        }
        app.recovery.drawn = opening;
        Ok(Box::new(app))
    };
    eframe::run_native(APP_ID, options, Box::new(build))
}

/// Returns the file that was open last, if the engineer prefers to start with it and it exists.
fn last_opened(setup: &Setup) -> Option<PathBuf> {
    let directory = setup
        .directory
        .as_deref()
        .filter(|_| setup.preferences.opens_with == OpensWith::LastStudy)?;
    recent_files(directory)
        .into_iter()
        .find(|path| file_exists(path))
}

/// Usable zoom factors of a window.
const ZOOM: RangeInclusive<f64> = 0.2..=5.0;

/// Replaces an unusable zoom factor in the preferences with 1; returns a message about it.
fn mend_zoom(preferences: &Path) -> Option<String> {
    const KEY: &str = "zoom_factor:";
    let text = std::fs::read_to_string(preferences).ok()?;
    let start = text.find(KEY)? + KEY.len();
    let end = start + text[start..].find([',', ')'])?;
    let stored = &text[start..end];
    if stored
        .trim()
        .parse::<f64>()
        .is_ok_and(|zoom| ZOOM.contains(&zoom))
    {
        return None;
    }
    let path = sanitized_path(preferences);
    let least = ZOOM.start();
    let most = ZOOM.end();
    let why = format!(
        "{path}: expected a zoom factor from {least} to {most}, found {}",
        sanitized(stored)
    );
    Some(
        match std::fs::write(
            preferences,
            format!("{}1.0{}", &text[..start], &text[end..]),
        ) {
            Ok(()) => format!("{why}; it is 1 now"),
            Err(error) => format!("{why}; it cannot be mended: {error}"),
        },
    )
}

/// Returns why no window can be opened, if known beforehand: on Linux, neither Wayland nor X11.
fn missing_display() -> Option<String> {
    if !cfg!(target_os = "linux") {
        return None;
    }
    let set = |name: &str| std::env::var_os(name).is_some_and(|value| !value.is_empty());
    let found = set("WAYLAND_DISPLAY") || set("WAYLAND_SOCKET") || set("DISPLAY");
    (!found).then(|| "there is no display (neither WAYLAND_DISPLAY nor DISPLAY is set)".to_owned())
}

fn no_window(reason: &str, command: &str) -> String {
    let reason = reason
        .lines()
        .next()
        .unwrap_or(reason)
        .trim_end_matches('.');
    // winit begins with the location in its own source: "os error at src/linux.rs:788: no
    // connection".
    let at = reason
        .split_once("os error at ")
        .and_then(|(_, at)| at.split_once(": "));
    let reason = at.map_or(reason, |(_, what)| what);
    format!("the window could not be opened: {reason}. Without a window: {command}")
}

/// Returns the headless command that replaces the window; without a file it uses the embedded
/// example.
fn headless(path: Option<&Path>, holds_models: bool) -> String {
    match path.map(sanitized_path) {
        Some(path) if holds_models => format!("gdcm assemble \"{path}\" --out dataset.json.gz"),
        Some(path) => format!("gdcm analyze \"{path}\" --out results"),
        None => "gdcm analyze --out results".to_owned(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_panic_before_the_first_frame_is_a_window_that_could_not_be_opened_and_one_after_it_is_not()
    {
        let fault = || {
            Err(Fault {
                message: "no libxkbcommon".to_owned(),
                place: None,
            })
        };
        let words = ending(fault(), None, &headless(Some(Path::new("a.json")), false)).unwrap_err();
        assert!(
            words.starts_with("the window could not be opened: no libxkbcommon"),
            "{words}"
        );
        assert!(
            words.ends_with("Without a window: gdcm analyze \"a.json\" --out results"),
            "{words}"
        );
        let words = no_window(
            "winit EventLoopError: os error at /a/linux/mod.rs:788: no connection",
            "gdcm analyze",
        );
        assert_eq!(
            words,
            "the window could not be opened: no connection. Without a window: gdcm analyze"
        );
        let folder = tempfile::tempdir().unwrap();
        let autosave = Autosave::start(
            Some(folder.path()),
            Duration::from_secs(3),
            crate::gui::app::threads::ReplySender::new(&egui::Context::default()).0,
        )
        .unwrap();
        let words = ending(fault(), Some(&autosave), "").unwrap_err();
        assert!(
            words.starts_with("stopped by a fault in its window: no libxkbcommon"),
            "{words}"
        );
        assert!(words.ends_with("every decision was saved"), "{words}");
    }

    #[test]
    fn a_file_that_is_wrong_opens_the_example_and_is_told() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("broken.json");
        std::fs::write(&path, "{\"format\": ").unwrap();
        let (opened, trouble) = load(Some(path));
        assert!(
            matches!(opened, Ok(Opened::Dataset(loaded)) if loaded.path().is_none()),
            "the example"
        );
        assert!(trouble.is_some_and(|words| words.contains("broken.json")));
        assert!(matches!(load(None), (Ok(_), None)));
    }

    #[test]
    fn a_zoom_factor_without_a_window_is_ignored_with_a_word_and_what_else_is_kept_stays() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("app.ron");
        let text = |zoom: &str| {
            format!(
                "{{\"egui\": \"(options:(sync:true,zoom_factor:{zoom},reduce_texture_memory:false))\"}}"
            )
        };
        for (stored, kept) in [
            ("0.0", "1.0"),
            ("NaN", "1.0"),
            ("5.5", "1.0"),
            ("0.2", "0.2"),
            ("1.25", "1.25"),
        ] {
            std::fs::write(&path, text(stored)).unwrap();
            let said = mend_zoom(&path);
            assert_eq!(said.is_some(), stored != kept, "{stored}: {said:?}");
            assert!(
                said.is_none_or(|words| words.contains(stored) && words.contains("from 0.2 to 5")),
                "{stored}"
            );
            assert_eq!(std::fs::read_to_string(&path).unwrap(), text(kept));
        }
        assert_eq!(mend_zoom(&folder.path().join("none.ron")), None);
    }
}
