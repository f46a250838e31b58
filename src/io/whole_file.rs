//! Files that are replaced whole, or not at all.

use std::fs;
use std::io::{BufWriter, ErrorKind, Write};
use std::path::Path;

use super::file_error::FileError;

/// Writes a file through a temporary one beside it, which takes its place only when everything is on the disk.
///
/// On an error the file that was there before is untouched. A link is followed: what it leads to is replaced.
pub(super) fn write_whole(
    path: &Path,
    write: impl FnOnce(&mut dyn Write) -> std::io::Result<()>,
) -> Result<(), FileError> {
    let target = fs::canonicalize(path).unwrap_or_else(|_| path.to_owned());
    match fs::metadata(&target) {
        Ok(there) if there.is_dir() => return Err(FileError::Directory { path: path.to_owned() }),
        Ok(there) if there.permissions().readonly() => return Err(FileError::writing(path, "it is read-only")),
        // Replacing a device or a pipe by a file would break what others use it for.
        Ok(there) if !there.is_file() => return Err(FileError::writing(path, "this is not an ordinary file")),
        _ => {}
    }
    let replace = || -> std::io::Result<()> {
        let directory = target.parent().filter(|parent| !parent.as_os_str().is_empty()).unwrap_or(Path::new("."));
        let mut temporary = temporary_file(&target).tempfile_in(directory)?;
        let mut buffered = BufWriter::new(temporary.as_file_mut());
        write(&mut buffered)?;
        buffered.flush()?;
        drop(buffered);
        temporary.as_file().sync_all()?;
        temporary.persist(&target).map_err(|error| error.error)?;
        Ok(())
    };
    replace().map_err(|error| match error.kind() {
        ErrorKind::NotFound => FileError::writing(path, "its directory does not exist"),
        _ => FileError::writing(path, error),
    })
}

/// A temporary file with the mode that the finished file is to have: that of the file it replaces, or what the process's mask
/// leaves of reading and writing for all.
#[cfg(unix)]
fn temporary_file(target: &Path) -> tempfile::Builder<'static, 'static> {
    use std::os::unix::fs::PermissionsExt;
    let permissions = fs::metadata(target).map(|there| there.permissions());
    let mut builder = named();
    builder.permissions(permissions.unwrap_or(fs::Permissions::from_mode(0o666)));
    builder
}

/// A temporary file with the rights that its directory gives it.
#[cfg(not(unix))]
fn temporary_file(_: &Path) -> tempfile::Builder<'static, 'static> {
    named()
}

fn named() -> tempfile::Builder<'static, 'static> {
    let mut builder = tempfile::Builder::new();
    builder.prefix(".gdcm-").suffix(".tmp");
    builder
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_failed_write_leaves_the_file_as_it_was_and_nothing_beside_it() {
        let directory = tempfile::tempdir().unwrap();
        let path = directory.path().join("corrections.json");
        fs::write(&path, "before").unwrap();
        let result = write_whole(&path, |file| {
            file.write_all(b"half of it")?;
            Err(std::io::Error::other("the disk is full"))
        });
        assert!(result.unwrap_err().to_string().ends_with("corrections.json: cannot be written: the disk is full"));
        assert_eq!(fs::read_to_string(&path).unwrap(), "before");
        assert_eq!(fs::read_dir(directory.path()).unwrap().count(), 1);
    }

    #[cfg(unix)]
    #[test]
    fn the_mode_of_a_replaced_file_stays_and_a_link_still_leads_to_it() {
        use std::os::unix::fs::{PermissionsExt, symlink};
        let directory = tempfile::tempdir().unwrap();
        let (path, link) = (directory.path().join("a"), directory.path().join("link"));
        fs::write(&path, "before").unwrap();
        fs::set_permissions(&path, fs::Permissions::from_mode(0o640)).unwrap();
        symlink(&path, &link).unwrap();
        write_whole(&link, |file| file.write_all(b"after")).unwrap();
        assert_eq!(fs::read_to_string(&path).unwrap(), "after");
        assert_eq!(fs::metadata(&path).unwrap().permissions().mode() & 0o777, 0o640);
        assert!(fs::symlink_metadata(&link).unwrap().is_symlink());
    }

    #[test]
    fn a_directory_that_is_not_there_is_told() {
        let directory = tempfile::tempdir().unwrap();
        let error = write_whole(&directory.path().join("no/such/file"), |_| Ok(())).unwrap_err();
        assert!(error.to_string().ends_with("file: cannot be written: its directory does not exist"));
    }
}
