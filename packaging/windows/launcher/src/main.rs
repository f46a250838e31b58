//! Opens the window of gdcm on Windows without a console beside it.
//!
//! Windows decides by a mark in the file whether a program gets a console. `gdcm.exe` has the mark
//! of a console program: the shell waits for it, shows what it prints and takes its exit status,
//! which a program marked as a window could not offer (an attached console prints, but the shell
//! does not wait). This program has the mark of a window; it starts `bin\gdcm.exe` with its own
//! arguments and a hidden console, and shows an error message if the window cannot be opened.
//! Python is installed on Windows in the same way, as `python.exe` and `pythonw.exe`.
#![cfg_attr(windows, windows_subsystem = "windows")]

use std::ffi::OsString;
use std::io;
use std::path::{Path, PathBuf};
use std::process::{Command, ExitCode, Stdio};

fn main() -> ExitCode {
    let arguments = std::env::args_os().skip(1).collect();
    let result = match program_path() {
        Ok(program) => open_window(&program, arguments),
        Err(error) => Err(format!("the program's folder is unknown: {error}")),
    };
    match result {
        Ok(()) => ExitCode::SUCCESS,
        Err(message) => {
            show_error(&message);
            ExitCode::FAILURE
        }
    }
}

/// Returns the path of the command-line program: in the folder `bin` beside this program.
fn program_path() -> io::Result<PathBuf> {
    let own = std::env::current_exe()?;
    let folder = own.parent().unwrap_or(Path::new("."));
    let name = format!("gdcm{}", std::env::consts::EXE_SUFFIX);
    Ok(folder.join("bin").join(name))
}

/// Runs the program until its window is closed. If it fails, returns what it printed on standard
/// error, or its exit status if it printed nothing.
fn open_window(program: &Path, arguments: Vec<OsString>) -> Result<(), String> {
    let mut command = Command::new(program);
    command
        .args(arguments)
        .stdin(Stdio::null())
        .stdout(Stdio::null())
        .stderr(Stdio::piped());
    hide_console(&mut command);
    let output = command
        .output()
        .map_err(|error| format!("{} could not be started: {error}", program.display()))?;
    if output.status.success() {
        return Ok(());
    }
    let printed = String::from_utf8_lossy(&output.stderr);
    if printed.trim().is_empty() {
        Err(format!("{}: {}", program.display(), output.status))
    } else {
        Err(printed.trim().to_owned())
    }
}

#[cfg(windows)]
fn hide_console(command: &mut Command) {
    use std::os::windows::process::CommandExt;
    /// `CREATE_NO_WINDOW` of the Windows API: the console of the new process has no window.
    const CREATE_NO_WINDOW: u32 = 0x0800_0000;
    command.creation_flags(CREATE_NO_WINDOW);
}

/// On other systems no program opens a console.
#[cfg(not(windows))]
fn hide_console(_: &mut Command) {}

#[cfg(windows)]
fn show_error(message: &str) {
    rfd::MessageDialog::new()
        .set_level(rfd::MessageLevel::Error)
        .set_title("gdcm")
        .set_description(message)
        .show();
}

#[cfg(not(windows))]
fn show_error(message: &str) {
    eprintln!("{message}");
}

#[cfg(all(test, unix))]
mod tests {
    use super::*;
    use std::os::unix::fs::PermissionsExt;
    use std::sync::{Mutex, MutexGuard, PoisonError};

    /// Lets one test at a time write and start programs: a program cannot be started while another
    /// test's new process still holds it open for writing.
    fn alone() -> MutexGuard<'static, ()> {
        static STARTING: Mutex<()> = Mutex::new(());
        STARTING.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Writes a program that behaves as `script` says.
    fn program(folder: &Path, script: &str) -> PathBuf {
        let path = folder.join("gdcm");
        std::fs::write(&path, format!("#!/bin/sh\n{script}\n")).unwrap();
        std::fs::set_permissions(&path, std::fs::Permissions::from_mode(0o755)).unwrap();
        path
    }

    #[test]
    fn the_arguments_are_passed_on_and_a_closed_window_is_a_success() {
        let _alone = alone();
        let folder = tempfile::tempdir().unwrap();
        let program = program(folder.path(), "test \"$1\" = 'a study.json' && test $# = 1");
        assert_eq!(open_window(&program, vec!["a study.json".into()]), Ok(()));
        assert!(open_window(&program, Vec::new()).is_err());
    }

    #[test]
    fn a_failure_returns_what_the_program_printed() {
        let _alone = alone();
        let folder = tempfile::tempdir().unwrap();
        let failing = program(folder.path(), "echo 'error: no OpenGL' >&2; exit 1");
        assert_eq!(
            open_window(&failing, Vec::new()),
            Err("error: no OpenGL".to_owned())
        );
        let silent = program(folder.path(), "exit 3");
        let message = open_window(&silent, Vec::new()).unwrap_err();
        assert!(message.contains('3'), "{message}");
        let missing = open_window(&folder.path().join("missing"), Vec::new()).unwrap_err();
        assert!(missing.contains("missing"), "{missing}");
    }
}
