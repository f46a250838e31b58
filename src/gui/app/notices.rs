/// Opens a folder with the program that the desktop uses for folders.
fn show_in_desktop(folder: &Path) -> io::Result<()> {
    let program = if cfg!(target_os = "windows") {
        "explorer"
    } else if cfg!(target_os = "macos") {
        "open"
    } else {
        "xdg-open"
    };
    let status = Process::new(program).arg(folder).status()?;
    // The file manager of Windows reports a failure even if it has shown the folder.
    if status.success() || cfg!(target_os = "windows") {
        Ok(())
    } else {
        Err(io::Error::other(format!("{program}: {status}")))
    }
}
