//! From the command line to a window on the screen.

use std::path::PathBuf;
use std::process::ExitCode;

use eframe::NativeOptions;
use egui::ViewportBuilder;

use crate::io::{FileError, Opened, embedded_example, load_any};

use super::window::GdcmApp;

/// Exit status where the window could not be opened.
const NO_WINDOW: u8 = 1;
/// Exit status where the file is wrong.
const WRONG_FILE: u8 = 2;

/// Opens the window on a dataset or a study, or on the embedded example, and returns when it is closed.
///
/// Where there is no display, or the window cannot be made, one line on standard error says so and names the headless command.
pub fn open(path: Option<PathBuf>) -> ExitCode {
    let opened = match load(path) {
        Ok(opened) => opened,
        Err(error) => {
            eprintln!("gdcm: {error}");
            return ExitCode::from(WRONG_FILE);
        }
    };
    if let Some(reason) = missing_display() {
        return no_window(&reason);
    }
    // A missing system library is a panic inside the window library's start-up, not an error.
    let run = std::panic::catch_unwind(std::panic::AssertUnwindSafe(|| run(opened)));
    match run {
        Ok(Ok(())) => ExitCode::SUCCESS,
        Ok(Err(error)) => no_window(&error.to_string()),
        Err(panic) => no_window(panic_text(panic.as_ref())),
    }
}

fn load(path: Option<PathBuf>) -> Result<Opened, FileError> {
    match path {
        Some(path) => load_any(&path),
        None => embedded_example().map(Opened::Dataset),
    }
}

fn run(opened: Opened) -> eframe::Result {
    let viewport = ViewportBuilder::default()
        .with_title("gdcm")
        .with_app_id("gdcm")
        .with_inner_size([1440.0, 900.0])
        .with_min_inner_size([900.0, 560.0]);
    let options = NativeOptions { viewport, ..NativeOptions::default() };
    eframe::run_native("gdcm", options, Box::new(|creation| Ok(Box::new(GdcmApp::new(&creation.egui_ctx, opened)?))))
}

/// Why no window can be had, where that can be told beforehand: on Linux, neither Wayland nor X11.
fn missing_display() -> Option<String> {
    if !cfg!(target_os = "linux") {
        return None;
    }
    let set = |name: &str| std::env::var_os(name).is_some_and(|value| !value.is_empty());
    let found = set("WAYLAND_DISPLAY") || set("WAYLAND_SOCKET") || set("DISPLAY");
    (!found).then(|| "there is no display (neither WAYLAND_DISPLAY nor DISPLAY is set)".to_owned())
}

fn panic_text(panic: &(dyn std::any::Any + Send)) -> &str {
    panic
        .downcast_ref::<String>()
        .map(String::as_str)
        .or_else(|| panic.downcast_ref::<&str>().copied())
        .unwrap_or("the window library stopped without a reason")
}

fn no_window(reason: &str) -> ExitCode {
    let reason = reason.lines().next().unwrap_or(reason).trim_end_matches('.');
    eprintln!("gdcm: the window could not be opened: {reason}. Without a window: gdcm analyze [FILE] --out DIR");
    ExitCode::from(NO_WINDOW)
}
