//! Starts the program: from the command line to a window on the screen, or to a message if no
//! window can be opened.
//!
//! The requested file is read in a thread while the window library starts (`first_file.rs`).
//! Whether an error means "no window" or "the window has ended" depends on whether a frame was
//! drawn: the first frame hands over the autosave, which then knows where the unsaved decisions
//! are.

use std::error::Error;
use std::path::PathBuf;
use std::sync::{Arc, OnceLock};
use std::thread::JoinHandle;

use eframe::NativeOptions;
use eframe::icon_data::from_png_bytes;
use egui::{IconData, ViewportBuilder};

use gdcm_io::Opened;
use gdcm_io::files::opened_file::holds_models;
use gdcm_model::message_text::sanitized_path;

use super::GdcmApp;
use super::autosave::Autosave;
use super::faults::{Fault, caught, record_panic};
use super::first_file::{Loaded, last_opened, load_and_report};
use super::recovery::{LAST_WAIT, end_words};
use super::setup::{APP_ID, Setup};
use super::window::PREFERENCES;
use super::zoom_repair::repair_zoom;
use crate::executor::start_threads;
use crate::gui::commands::assembling::AssemblingCommand;
use crate::gui::commands::file::FileCommand;

/// Exit status if the window could not be opened, or ended by an error or a panic.
const NO_WINDOW: u8 = 1;
/// Exit status if there is no display and the requested file cannot be read either.
const WRONG_FILE: u8 = 2;

/// Opens the window on a dataset or a study, or on the embedded example, and returns once the
/// window is closed. A folder, or a file from another program, opens the model import. Returns the
/// exit status.
///
/// 1. Without a display, only report whether the file can be read.
/// 2. Read the file in a thread.
/// 3. Repair a stored zoom factor with which the window would be unusable.
/// 4. Run the window (`run`); a panic counts as its end.
/// 5. Report why it ended (`ending`), unless it was closed.
///
/// Without a display, or if the window cannot be created, prints one line on standard error, which
/// names the command that works without a window.
pub fn open(path: Option<PathBuf>) -> u8 {
    let request = Request::new(path);
    let command = request.headless_command();
    let Request { dataset, models } = request;
    // Step 1.
    if let Some(reason) = missing_display() {
        if load_and_report(dataset).trouble.is_some() {
            return WRONG_FILE;
        }
        return fail(&no_window(&reason, &command));
    }
    // Step 2.
    let reading = match start_reading(dataset) {
        Ok(reading) => reading,
        Err(reason) => {
            let reason = format!("no thread is available ({reason})");
            return fail(&no_window(&reason, &command));
        }
    };
    // Step 3.
    if let Some(directory) = eframe::storage_dir(APP_ID)
        && let Some(caution) = repair_zoom(&directory.join("app.ron"))
    {
        eprintln!("caution: {caution}");
    }
    // Step 4.
    std::panic::set_hook(Box::new(record_panic));
    let drawn = Arc::new(OnceLock::new());
    let outcome = caught(|| run(reading, models, &drawn));
    // Step 5.
    match ending(outcome, drawn.get(), &command) {
        Ok(()) => 0,
        Err(message) => fail(&message),
    }
}

/// Prints an error that prevented or ended the window; returns the exit status.
fn fail(message: &str) -> u8 {
    eprintln!("error: {message}");
    NO_WINDOW
}

/// Path from the command line: a dataset or study, or models to import.
struct Request {
    /// Dataset or study; `None` opens the example.
    dataset: Option<PathBuf>,
    /// Folder, or file from another program, from which to import models.
    models: Option<PathBuf>,
}

impl Request {
    fn new(path: Option<PathBuf>) -> Self {
        match path {
            Some(path) if holds_models(&path) => Self {
                dataset: None,
                models: Some(path),
            },
            dataset => Self {
                dataset,
                models: None,
            },
        }
    }

    /// Returns the command that can replace the window; without a file it uses the embedded
    /// example.
    fn headless_command(&self) -> String {
        if let Some(models) = &self.models {
            let path = sanitized_path(models);
            format!("gdcm assemble \"{path}\" --out dataset.json.gz")
        } else if let Some(dataset) = &self.dataset {
            let path = sanitized_path(dataset);
            format!("gdcm analyze \"{path}\" --out results")
        } else {
            "gdcm analyze --out results".to_owned()
        }
    }
}

/// Starts the thread pool, and a thread that reads the file while the window is created.
fn start_reading(dataset: Option<PathBuf>) -> Result<JoinHandle<Loaded>, String> {
    let reading = std::thread::Builder::new()
        .name("file".to_owned())
        .spawn(|| load_and_report(dataset));
    start_threads()?;
    reading.map_err(|error| error.to_string())
}

/// Returns the reason why the window ended; `Ok` if it was closed. `kept` is the autosave,
/// available once a frame is drawn; `command` is the command that can replace the window.
fn ending(
    run: Result<eframe::Result, Fault>,
    kept: Option<&Autosave>,
    command: &str,
) -> Result<(), String> {
    match (run, kept) {
        (Ok(Ok(())), _) => Ok(()),
        // A missing system library causes a panic in the window library, not an error.
        (Ok(Err(error)), None) => Err(no_window(&error.to_string(), command)),
        (Err(fault), None) => Err(no_window(&fault.message, command)),
        (Ok(Err(error)), Some(autosave)) => {
            Err(end_words(&error.to_string(), &autosave.flush(LAST_WAIT)))
        }
        (Err(fault), Some(autosave)) => Err(end_words(&fault.words(), &autosave.flush(LAST_WAIT))),
    }
}

/// Runs the window until it is closed; `drawn` receives the autosave once a frame is drawn.
fn run(
    reading: JoinHandle<Loaded>,
    models: Option<PathBuf>,
    drawn: &Arc<OnceLock<Autosave>>,
) -> eframe::Result {
    let viewport = ViewportBuilder::default()
        .with_title("gdcm")
        .with_app_id(APP_ID)
        .with_icon(icon())
        .with_inner_size([1440.0, 900.0])
        .with_min_inner_size([900.0, 560.0]);
    // Dithering is off: there are no colour gradients to smooth, and without a graphics processor
    // it would cost time for every pixel.
    let options = NativeOptions {
        viewport,
        dithering: false,
        ..NativeOptions::default()
    };
    let drawn = Arc::clone(drawn);
    eframe::run_native(
        APP_ID,
        options,
        Box::new(move |creation| {
            let loaded = reading
                .join()
                .unwrap_or_else(|panic| std::panic::resume_unwind(panic));
            let mut app = create_window(creation, loaded, models)?;
            app.recovery.autosave_once_drawn = drawn;
            Ok(Box::new(app))
        }),
    )
}

/// Returns the program's icon, for the window frame and the desktop's window list.
fn icon() -> Arc<IconData> {
    let icon = from_png_bytes(include_bytes!("../../../assets/icon/gdcm-256.png"));
    // Without pixels, the window gets the desktop's default icon.
    Arc::new(icon.unwrap_or_default())
}

/// Creates the window with the loaded file; then opens the last file, or imports the models, if so
/// requested.
fn create_window(
    creation: &eframe::CreationContext<'_>,
    loaded: Loaded,
    models: Option<PathBuf>,
) -> Result<GdcmApp, Box<dyn Error + Send + Sync>> {
    let opened = loaded.opened?;
    let is_example = matches!(&opened, Opened::Dataset(dataset) if dataset.path().is_none());
    let is_file_requested = models.is_some() || loaded.trouble.is_some() || !is_example;
    let preferences = creation
        .storage
        .and_then(|storage| eframe::get_value(storage, PREFERENCES));
    let setup = Setup {
        preferences: preferences.unwrap_or_default(),
        trouble: loaded.trouble,
        ..Setup::of_program()
    };
    let last = if is_file_requested {
        None
    } else {
        last_opened(&setup)
    };
    let mut app = GdcmApp::with_setup(&creation.egui_ctx, opened, setup)?;
    if let Some(path) = last {
        app.dispatch(FileCommand::Open(path));
    }
    if let Some(models) = models {
        app.dispatch(AssemblingCommand::Add(vec![models]));
    }
    Ok(app)
}

/// Returns why no window can be opened, as far as can be detected in advance: on Linux, if neither
/// Wayland nor X11 is available.
fn missing_display() -> Option<String> {
    if !cfg!(target_os = "linux") {
        return None;
    }
    for variable in ["WAYLAND_DISPLAY", "WAYLAND_SOCKET", "DISPLAY"] {
        if std::env::var_os(variable).is_some_and(|value| !value.is_empty()) {
            return None;
        }
    }
    Some("there is no display (neither WAYLAND_DISPLAY nor DISPLAY is set)".to_owned())
}

/// Returns the error message if a window cannot be opened; it names the command that can replace
/// the window.
fn no_window(reason: &str, command: &str) -> String {
    let reason = reason
        .lines()
        .next()
        .unwrap_or(reason)
        .trim_end_matches('.');
    // winit's message begins with the location in its source: "os error at src/linux.rs:788: no
    // connection".
    let located = reason.split_once("os error at ");
    let reason = match located.and_then(|(_, located)| located.split_once(": ")) {
        Some((_, reason)) => reason,
        None => reason,
    };
    format!("the window could not be opened: {reason}. Without a window: {command}")
}

#[cfg(test)]
mod tests {
    use std::time::Duration;

    use super::super::autosave::Remains;
    use super::*;

    fn fault() -> Fault {
        Fault {
            message: "no libxkbcommon".to_owned(),
            place: None,
        }
    }

    #[test]
    fn the_icon_is_a_picture_with_transparent_corners() {
        let icon = icon();
        assert_eq!((icon.width, icon.height), (256, 256));
        assert_eq!(icon.rgba[3], 0, "the corner is transparent");
        let middle = 4 * (128 * 256 + 128);
        assert_eq!(icon.rgba[middle + 3], 255, "the middle is not");
    }

    #[test]
    fn a_panic_before_the_first_frame_means_that_no_window_could_be_opened() {
        let command = Request::new(Some("a.json".into())).headless_command();
        let words = ending(Err(fault()), None, &command).unwrap_err();
        assert!(
            words.contains("no libxkbcommon") && words.ends_with(&command),
            "{words}"
        );
        let words = no_window(
            "winit EventLoopError: os error at /a/linux/mod.rs:788: no connection",
            "gdcm analyze",
        );
        assert!(
            words.contains("no connection") && words.ends_with("gdcm analyze"),
            "{words}"
        );
        assert!(!words.contains("mod.rs"), "{words}");
    }

    #[test]
    fn a_panic_after_the_first_frame_reports_the_decisions() {
        let folder = tempfile::tempdir().unwrap();
        let autosave = Autosave::start(
            Some(folder.path()),
            Duration::from_secs(3),
            crate::gui::app::threads::ReplySender::new(&egui::Context::default()).0,
        )
        .unwrap();
        let words = ending(Err(fault()), Some(&autosave), "").unwrap_err();
        assert_eq!(words, end_words(&fault().words(), &Remains::Saved));
    }
}
