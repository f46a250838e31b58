//! Temporary files beside the files that they replace: new content before it is renamed, and second
//! names or copies of existing files.
//!
//! Each is locked while its process runs. A temporary file without a lock is a leftover from a
//! killed run, and is removed by the next write into its directory.

use std::fs::{self, File};
use std::io::{self, BufWriter, ErrorKind, Read, Seek, SeekFrom, Write};
use std::path::Path;

use tempfile::NamedTempFile;

// Beginning and end of the names of temporary files.
pub(super) const PREFIX: &str = ".gdcm-";
pub(super) const SUFFIX: &str = ".tmp";

/// Writes a temporary file, flushed to the disk, that will replace `target`.
pub(super) fn write_temporary_file(
    target: &Path,
    directory: &Path,
    write: impl FnOnce(&mut dyn Write) -> io::Result<()>,
) -> io::Result<NamedTempFile> {
    let mut temporary = temporary_file(target, directory)?;
    let mut buffered = BufWriter::new(temporary.as_file_mut());
    write(&mut buffered)?;
    buffered.flush()?;
    drop(buffered);
    temporary.as_file().sync_all()?;
    Ok(temporary)
}

/// Creates a temporary file, locked as long as it is open. The system releases the lock when the
/// process ends, for whatever reason.
fn temporary_file(target: &Path, directory: &Path) -> io::Result<NamedTempFile> {
    let mut builder = temporary_name();
    set_permissions(&mut builder, target);
    loop {
        // Keep only the error kind: the builder's message would name the temporary file.
        let temporary = builder
            .tempfile_in(directory)
            .map_err(|error| io::Error::from(error.kind()))?;
        // Ignore a failure: on a file system without locks, `remove_leftovers` cannot lock a file
        // either and removes nothing.
        let _ = temporary.as_file().lock();
        // Try again if another process removed the file as a leftover before it was locked.
        if temporary.path().exists() {
            return Ok(temporary);
        }
    }
}

/// Gives a new file the permissions of the file that it replaces; if it replaces none, reading and
/// writing for all, reduced by the process's mask.
#[cfg(unix)]
fn set_permissions(builder: &mut tempfile::Builder<'_, '_>, target: &Path) {
    use std::os::unix::fs::PermissionsExt;
    let permissions = match fs::metadata(target) {
        Ok(found) => found.permissions(),
        Err(_) => fs::Permissions::from_mode(0o666),
    };
    builder.permissions(permissions);
}

/// Does nothing on other systems, where a new file inherits its directory's permissions.
#[cfg(not(unix))]
fn set_permissions(_: &mut tempfile::Builder<'_, '_>, _: &Path) {}

/// How the content of a file that is about to be replaced is kept.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum KeptAs {
    /// A second name for the file, or a copy if the file system has no hard links.
    SecondName,
    /// A copy. Windows does not replace a file that is open under any of its names, and the lock
    /// keeps a second name open.
    Copy,
}

impl KeptAs {
    /// Returns the way that works on this system.
    pub(super) fn of_system() -> Self {
        if cfg!(windows) {
            Self::Copy
        } else {
            Self::SecondName
        }
    }
}

/// Keeps the content of `target` in a temporary file, removed when dropped.
pub(super) fn kept_aside(target: &Path, way: KeptAs) -> io::Result<NamedTempFile> {
    temporary_name().make_in(directory_of(target), |path| {
        match way {
            KeptAs::SecondName => match fs::hard_link(target, path) {
                Err(error) if error.kind() != ErrorKind::AlreadyExists => {
                    fs::copy(target, path)?;
                }
                linked => linked?,
            },
            KeptAs::Copy => {
                fs::copy(target, path)?;
            }
        }
        // Before the lock is taken, another process may remove the file as a leftover. Its absence
        // is returned as `AlreadyExists`, so that `make_in` tries another name.
        let removed = ErrorKind::AlreadyExists;
        let file = match File::open(path) {
            Err(error) if error.kind() == ErrorKind::NotFound => return Err(removed.into()),
            opened => opened?,
        };
        let _ = file.try_lock();
        if path.exists() {
            Ok(file)
        } else {
            Err(removed.into())
        }
    })
}

/// Reads a whole temporary file through its own handle: on Windows the lock keeps every other
/// handle from reading it, even one of the same process.
pub(super) fn read_temporary_file(temporary: &NamedTempFile) -> io::Result<Vec<u8>> {
    let mut file = temporary.as_file();
    file.seek(SeekFrom::Start(0))?;
    let mut bytes = Vec::new();
    file.read_to_end(&mut bytes)?;
    Ok(bytes)
}

fn temporary_name() -> tempfile::Builder<'static, 'static> {
    let mut builder = tempfile::Builder::new();
    builder.prefix(PREFIX).suffix(SUFFIX);
    builder
}

/// Returns a file's directory; a file name alone is in the current directory.
pub(super) fn directory_of(file: &Path) -> &Path {
    match file.parent() {
        Some(parent) if !parent.as_os_str().is_empty() => parent,
        _ => Path::new("."),
    }
}

/// Removes temporary files from killed runs, recognised by the missing lock.
pub(super) fn remove_leftovers(directory: &Path) {
    for entry in fs::read_dir(directory).into_iter().flatten().flatten() {
        let is_ours = entry
            .file_name()
            .to_str()
            .is_some_and(|name| name.starts_with(PREFIX) && name.ends_with(SUFFIX));
        if is_ours
            && entry.file_type().is_ok_and(|kind| kind.is_file())
            && let Ok(file) = File::options().write(true).open(entry.path())
            && file.try_lock().is_ok()
        {
            let _ = fs::remove_file(entry.path());
        }
    }
}
