//! Files that are written completely or not at all, individually or as a set.

mod set_lock;
mod temporary_files;

use std::collections::BTreeSet;
use std::fs;
use std::io::{self, ErrorKind, Write};
use std::path::{Path, PathBuf};
#[cfg(unix)]
use std::sync::{Arc, atomic::AtomicBool};

use sha2::{Digest, Sha256};
use tempfile::NamedTempFile;

use self::set_lock::SetLock;
use self::temporary_files::{
    KeptAs, directory_of, kept_aside, read_temporary_file, remove_leftovers, write_temporary_file,
};
use super::file_error::FileError;
use super::file_reading::special_file_kind;

/// How files that exist at the output paths are treated.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Existing {
    /// If any of the files exists, it is kept, and nothing is written.
    Keep,
    /// The new files replace existing files.
    Replace,
}

/// Files that are renamed to their paths together, or not at all.
///
/// ```text
/// check    reject paths that must not be written to      (before any work)
/// add      write each file beside its path, to the disk  (a full disk shows here)
/// persist  wait for other sets in the same directory; keep the existing files aside;
///          rename the new files, in the order in which they were added;
///          on an error restore the existing files
/// ```
///
/// No file system renames several files at once. A process killed between two renames leaves new
/// files beside old ones; checksums, added last, reveal this.
///
/// A set dropped before it is persisted changes nothing. The next write into the directory removes
/// leftovers from a killed run.
#[derive(Debug)]
pub struct OutputSet {
    existing: Existing,
    inputs: Vec<PathBuf>,
    staged: Vec<Staged>,
}

/// A file that has been written beside its path, but not yet renamed to it.
#[derive(Debug)]
struct Staged {
    /// Requested path, for messages.
    path: PathBuf,
    /// Where the link at `path` leads; `path` itself if it is not a link.
    target: PathBuf,
    temporary: NamedTempFile,
}

impl OutputSet {
    /// Creates an empty set; the files `inputs`, from which the program reads, are never replaced.
    pub fn new(existing: Existing, inputs: Vec<PathBuf>) -> Self {
        Self {
            existing,
            inputs,
            staged: Vec::new(),
        }
    }

    /// Adds files from which the program reads and which are not replaced either.
    #[must_use]
    pub fn also_reading(mut self, inputs: impl IntoIterator<Item = PathBuf>) -> Self {
        self.inputs.extend(inputs);
        self
    }

    /// Rejects paths that cannot or must not be written to: special files, inputs, directories,
    /// read-only files and, with [`Existing::Keep`], existing files. To be called before any work
    /// is done.
    pub fn check<P: AsRef<Path>>(&self, places: &[P]) -> Result<(), FileError> {
        let mut existing = Vec::new();
        for path in places.iter().map(AsRef::as_ref) {
            let Ok(found) = fs::metadata(path) else {
                continue;
            };
            // The path is not opened: opening a pipe waits for its other end. Replacing a pipe or a
            // device by a file would break its other users.
            if let Some(kind) = special_file_kind(found.file_type()) {
                return Err(FileError::OutputNotAFile {
                    path: path.to_owned(),
                    kind,
                });
            }
            if self.inputs.iter().any(|input| is_same_file(path, input)) {
                return Err(FileError::Input {
                    path: path.to_owned(),
                });
            }
            if found.is_dir() {
                return Err(FileError::Directory {
                    path: path.to_owned(),
                });
            }
            if found.permissions().readonly() {
                return Err(FileError::unwritable(path, "it is read-only"));
            }
            existing.push(path.to_owned());
        }
        if existing.is_empty() || self.existing == Existing::Replace {
            Ok(())
        } else {
            Err(FileError::Exists { paths: existing })
        }
    }

    /// Checks `path` as [`OutputSet::check`] does, writes a temporary file beside it (beside the
    /// target if `path` is a link), and flushes it to the disk; [`OutputSet::persist`] renames it.
    /// Also removes leftovers from killed runs in that directory.
    pub fn add(
        &mut self,
        path: &Path,
        write: impl FnOnce(&mut dyn Write) -> io::Result<()>,
    ) -> Result<(), FileError> {
        self.check(&[path])?;
        let target = fs::canonicalize(path).unwrap_or_else(|_| path.to_owned());
        let directory = directory_of(&target);
        remove_leftovers(directory);
        let temporary = write_temporary_file(&target, directory, write)
            .map_err(|error| FileError::writing(path, &error))?;
        self.staged.push(Staged {
            path: path.to_owned(),
            target,
            temporary,
        });
        Ok(())
    }

    /// Adds the SHA-256 of every file so far, in `sha256sum` format. To be called after all other
    /// files are added: the checksums are renamed last, and reveal whether the other files belong
    /// together.
    pub fn add_checksums(&mut self, path: &Path) -> Result<(), FileError> {
        let mut lines = String::new();
        for staged in &self.staged {
            let bytes = read_temporary_file(&staged.temporary)
                .map_err(|error| FileError::writing(path, &error))?;
            let name = staged.path.file_name().unwrap_or_default();
            lines.push_str(&checksum(&name.to_string_lossy(), &bytes));
        }
        self.add(path, |file| file.write_all(lines.as_bytes()))
    }

    /// Renames all temporary files to their paths; on an error, restores the previous files.
    pub fn persist(self) -> Result<(), FileError> {
        let _locks = self.directory_locks();
        let mut placed: Vec<Placed> = Vec::new();
        for Staged {
            path,
            target,
            temporary,
        } in self.staged
        {
            // Tests end the process here, as if it were killed.
            #[cfg(test)]
            tests::end_here(&path);
            match Placed::at(target, temporary, self.existing) {
                Ok(file) => placed.push(file),
                Err(error) => {
                    for file in placed.into_iter().rev() {
                        file.take_back();
                    }
                    return Err(match error.kind() {
                        ErrorKind::AlreadyExists => FileError::Exists { paths: vec![path] },
                        _ => FileError::writing(&path, &error),
                    });
                }
            }
        }
        Ok(())
    }

    /// Locks a set's directories. A single file needs no lock: the last writer wins.
    fn directory_locks(&self) -> Vec<SetLock> {
        if self.staged.len() <= 1 {
            return Vec::new();
        }
        // Each directory once, even if it has several paths: a set must not wait for its own lock.
        let mut directories = BTreeSet::new();
        for staged in &self.staged {
            let directory = directory_of(&staged.target);
            directories
                .insert(fs::canonicalize(directory).unwrap_or_else(|_| directory.to_owned()));
        }
        let mut locks = Vec::new();
        for directory in &directories {
            locks.extend(SetLock::acquire(directory));
        }
        locks
    }
}

/// Returns whether an output path leads to an input file, through any links. An input that is a
/// pipe or a device does not count, and is not opened.
fn is_same_file(path: &Path, input: &Path) -> bool {
    let Ok(found) = fs::metadata(input) else {
        return false;
    };
    special_file_kind(found.file_type()).is_none()
        && same_file::is_same_file(path, input).unwrap_or(false)
}

/// Returns a file's line in `sha256sum` format.
fn checksum(name: &str, bytes: &[u8]) -> String {
    format!("{:x}  {name}\n", Sha256::digest(bytes))
}

/// A file that has been renamed to its path.
struct Placed {
    target: PathBuf,
    /// The file that it replaced, under a second name or as a copy.
    earlier: Option<NamedTempFile>,
}

impl Placed {
    /// Renames a temporary file to `target`; before, keeps aside an existing file that is replaced.
    fn at(target: PathBuf, temporary: NamedTempFile, existing: Existing) -> io::Result<Self> {
        if existing == Existing::Keep {
            temporary.persist_noclobber(&target)?;
            return Ok(Self {
                target,
                earlier: None,
            });
        }
        let earlier = if target.exists() {
            Some(kept_aside(&target, KeptAs::of_system())?)
        } else {
            None
        };
        temporary.persist(&target)?;
        Ok(Self { target, earlier })
    }

    /// Restores the previous file, or removes the new file if there was none; if this fails,
    /// nothing more can be done.
    fn take_back(self) {
        match self.earlier {
            Some(earlier) => drop(earlier.persist(&self.target)),
            None => drop(fs::remove_file(&self.target)),
        }
    }
}

/// Writes a file, replacing an existing file; on an error, the existing file is unchanged. A link
/// is followed: its target is replaced.
pub(super) fn write_whole(
    path: &Path,
    write: impl FnOnce(&mut dyn Write) -> io::Result<()>,
) -> Result<(), FileError> {
    let mut set = OutputSet::new(Existing::Replace, Vec::new());
    set.add(path, write)?;
    set.persist()
}

/// Creates a directory and its missing parents.
pub fn make_directory(path: &Path) -> Result<(), FileError> {
    fs::create_dir_all(path).map_err(|error| match error.kind() {
        ErrorKind::AlreadyExists | ErrorKind::NotADirectory => FileError::NotADirectory {
            path: path.to_owned(),
        },
        _ => FileError::writing(path, &error),
    })
}

/// Turns the signal for exceeding the system's file size limit (`ulimit -f`), which would end the
/// program, into an ordinary error.
pub fn report_size_limit() {
    // If the registration fails, the signal still ends the program, which leaves no partial file
    // either.
    #[cfg(unix)]
    let _ = signal_hook::flag::register(signal_hook::consts::SIGXFSZ, Arc::<AtomicBool>::default());
}

#[cfg(test)]
mod tests {
    use super::temporary_files::PREFIX;
    use super::*;

    fn names(directory: &Path) -> Vec<String> {
        let names = fs::read_dir(directory)
            .unwrap()
            .map(|entry| entry.unwrap().file_name().into_string().unwrap());
        let mut names: Vec<String> = names.collect();
        names.sort();
        names
    }

    fn set_of(existing: Existing, files: &[(&Path, &str)]) -> Result<OutputSet, FileError> {
        let mut set = OutputSet::new(existing, Vec::new());
        for (path, text) in files {
            set.add(path, |file| file.write_all(text.as_bytes()))?;
        }
        Ok(set)
    }

    /// Environment variable with the name of a file: a test process ends just before it renames
    /// that file, as if it were killed.
    const END: &str = "GDCM_TEST_END_BEFORE";

    /// Ends the process if a test requests it before `path` is renamed.
    pub(super) fn end_here(path: &Path) {
        if std::env::var_os(END).is_some_and(|name| path.file_name() == Some(&name)) {
            std::process::abort();
        }
    }

    const SET: [&str; 3] = ["a.json", "b.csv", "c.csv"];
    const CHECKSUMS: &str = "a.sha256";

    fn write_set(directory: &Path, text: &str) -> Result<(), FileError> {
        let paths = SET.map(|name| directory.join(name));
        let mut set = set_of(
            Existing::Replace,
            &paths.each_ref().map(|path| (path.as_path(), text)),
        )?;
        set.add_checksums(&directory.join(CHECKSUMS))?;
        set.persist()
    }

    /// Returns the text in the first file of a set; `None` if the checksums do not match.
    fn whole_set(directory: &Path) -> Option<String> {
        let read = |name: &str| fs::read_to_string(directory.join(name)).unwrap();
        let lines = SET.map(|name| checksum(name, read(name).as_bytes()));
        (read(CHECKSUMS) == lines.concat()).then(|| read(SET[0]))
    }

    #[test]
    fn checksums_reveal_a_set_whose_process_was_killed_and_the_next_set_is_whole() {
        // In the process that is to be killed, which runs this same test.
        if let Some(directory) = std::env::var_os("GDCM_TEST_DIRECTORY") {
            write_set(Path::new(&directory), "after").unwrap();
        }
        let module = module_path!().split_once("::").unwrap().1;
        let name = format!(
            "{module}::checksums_reveal_a_set_whose_process_was_killed_and_the_next_set_is_whole"
        );
        for (end, whole) in [
            (SET[0], Some("before")),
            (SET[1], None),
            (SET[2], None),
            (CHECKSUMS, None),
        ] {
            let directory = tempfile::tempdir().unwrap();
            write_set(directory.path(), "before").unwrap();
            let mut process = std::process::Command::new(std::env::current_exe().unwrap());
            process
                .args(["--exact", &name])
                .env(END, end)
                .env("GDCM_TEST_DIRECTORY", directory.path());
            assert!(!process.output().unwrap().status.success());
            assert!(
                names(directory.path()).len() > 4,
                "the process left temporary files: it ended before {end}"
            );
            assert_eq!(
                whole_set(directory.path()).as_deref(),
                whole,
                "killed before {end}"
            );
            write_set(directory.path(), "again").unwrap();
            assert_eq!(whole_set(directory.path()).as_deref(), Some("again"));
            assert_eq!(
                names(directory.path()),
                [SET[0], CHECKSUMS, SET[1], SET[2]],
                "nothing is left behind"
            );
        }
    }

    #[test]
    fn a_copy_kept_aside_leaves_the_replaced_file_closed_and_can_take_its_place_again() {
        let directory = tempfile::tempdir().unwrap();
        let path = directory.path().join("a.json");
        for (way, is_same) in [(KeptAs::SecondName, true), (KeptAs::Copy, false)] {
            fs::write(&path, "before").unwrap();
            let kept = kept_aside(&path, way).unwrap();
            assert_eq!(
                same_file::is_same_file(kept.path(), &path).unwrap(),
                is_same,
                "{way:?}"
            );
            fs::remove_file(&path).unwrap();
            fs::write(&path, "after").unwrap();
            let placed = Placed {
                target: path.clone(),
                earlier: Some(kept),
            };
            placed.take_back();
            assert_eq!(fs::read_to_string(&path).unwrap(), "before", "{way:?}");
            assert_eq!(names(directory.path()), ["a.json"], "{way:?}");
        }
    }

    #[test]
    fn checksums_are_read_through_the_handles_that_hold_the_locks() {
        let directory = tempfile::tempdir().unwrap();
        let path = directory.path().join("a.json");
        let mut set = set_of(Existing::Keep, &[(&path, "text")]).unwrap();
        // No other handle can be opened: the names are gone.
        for name in names(directory.path()) {
            fs::remove_file(directory.path().join(name)).unwrap();
        }
        let checksums = directory.path().join(CHECKSUMS);
        set.add_checksums(&checksums).unwrap();
        let written = read_temporary_file(&set.staged[1].temporary).unwrap();
        assert_eq!(
            String::from_utf8(written).unwrap(),
            checksum("a.json", b"text")
        );
    }

    #[cfg(unix)]
    #[test]
    fn a_set_with_an_existing_file_and_two_names_for_its_directory_takes_its_place() {
        let directory = tempfile::tempdir().unwrap();
        let real = directory.path().join("real");
        let link = directory.path().join("link");
        fs::create_dir(&real).unwrap();
        std::os::unix::fs::symlink(&real, &link).unwrap();
        fs::write(real.join(SET[1]), "before").unwrap();
        write_set(&link, "after").unwrap();
        assert_eq!(whole_set(&real).as_deref(), Some("after"));
    }

    #[test]
    fn one_of_two_simultaneous_sets_is_whole() {
        let directory = tempfile::tempdir().unwrap();
        for _ in 0..200 {
            let start = std::sync::Barrier::new(2);
            std::thread::scope(|scope| {
                for text in ["one", "other"] {
                    scope.spawn(|| {
                        start.wait();
                        write_set(directory.path(), text).unwrap();
                    });
                }
            });
            assert!(whole_set(directory.path()).is_some(), "files of both");
        }
        assert_eq!(names(directory.path()).len(), 4, "nothing is left behind");
    }

    #[test]
    fn a_failed_write_leaves_the_file_as_it_was_and_nothing_beside_it() {
        let directory = tempfile::tempdir().unwrap();
        let path = directory.path().join("corrections.json");
        fs::write(&path, "before").unwrap();
        let result = write_whole(&path, |file| {
            file.write_all(b"half of it")?;
            Err(io::Error::from(ErrorKind::StorageFull))
        });
        let error = result.unwrap_err();
        assert_eq!(error.code(), "not-writable");
        assert!(
            matches!(
                &error,
                FileError::Unwritable { path: named, reason }
                    if *named == path && *reason == crate::file_error::system_words(&ErrorKind::StorageFull.into())
            ),
            "{error:?}"
        );
        assert_eq!(fs::read_to_string(&path).unwrap(), "before");
        assert_eq!(names(directory.path()), ["corrections.json"]);
    }

    #[test]
    fn a_set_that_cannot_be_placed_leaves_the_earlier_files() {
        let directory = tempfile::tempdir().unwrap();
        let [old, new, blocked] = ["old", "new", "blocked"].map(|name| directory.path().join(name));
        fs::write(&old, "before").unwrap();
        let set = set_of(
            Existing::Replace,
            &[(&old, "after"), (&new, "after"), (&blocked, "after")],
        )
        .unwrap();
        fs::create_dir(&blocked).unwrap();
        let error = set.persist().unwrap_err();
        assert!(
            matches!(&error, FileError::Unwritable { path, .. } if *path == blocked),
            "{error:?}"
        );
        assert!(!error.to_string().contains(PREFIX), "{error}");
        assert_eq!(fs::read_to_string(&old).unwrap(), "before");
        assert_eq!(names(directory.path()), ["blocked", "old"]);
    }

    #[test]
    fn a_file_that_appears_while_the_others_are_written_stays_as_it_is() {
        let directory = tempfile::tempdir().unwrap();
        let [first, second] = ["first", "second"].map(|name| directory.path().join(name));
        let set = set_of(Existing::Keep, &[(&first, "ours"), (&second, "ours")]).unwrap();
        fs::write(&second, "theirs").unwrap();
        assert!(
            matches!(set.persist(), Err(FileError::Exists { paths }) if paths == [second.clone()])
        );
        assert_eq!(fs::read_to_string(&second).unwrap(), "theirs");
        assert_eq!(names(directory.path()), ["second"]);
    }

    #[test]
    fn every_existing_file_is_named_and_none_is_written_unasked() {
        let directory = tempfile::tempdir().unwrap();
        let paths = ["a", "b", "c"].map(|name| directory.path().join(name));
        fs::write(&paths[0], "").unwrap();
        fs::write(&paths[2], "").unwrap();
        let there = [paths[0].clone(), paths[2].clone()];
        let refused = OutputSet::new(Existing::Keep, Vec::new()).check(&paths);
        assert!(matches!(refused, Err(FileError::Exists { paths }) if paths == there));
        assert!(
            OutputSet::new(Existing::Replace, Vec::new())
                .check(&paths)
                .is_ok()
        );
    }

    #[cfg(unix)]
    #[test]
    fn a_pipe_or_a_device_is_refused_before_it_is_opened_as_output_and_as_input() {
        let directory = tempfile::tempdir().unwrap();
        let [pipe, file] = ["pipe", "file"].map(|name| directory.path().join(name));
        assert!(
            std::process::Command::new("mkfifo")
                .arg(&pipe)
                .status()
                .unwrap()
                .success()
        );
        fs::write(&file, "before").unwrap();
        for existing in [Existing::Keep, Existing::Replace] {
            let mut set = OutputSet::new(existing, vec![file.clone()]);
            for (path, expected) in [
                (pipe.as_path(), "a named pipe"),
                (Path::new("/dev/null"), "a device"),
            ] {
                let error = set.check(&[path]).unwrap_err();
                assert!(
                    matches!(&error, FileError::OutputNotAFile { kind, .. } if *kind == expected),
                    "{error}"
                );
                assert_eq!(error.code(), "output-not-a-file");
                assert_eq!(set.add(path, |_| Ok(())).unwrap_err().code(), error.code());
            }
        }
        let reading_pipe = OutputSet::new(Existing::Replace, vec![pipe]);
        assert!(
            reading_pipe.check(&[&file]).is_ok(),
            "the pipe is not opened to see whether it is the file"
        );
    }

    #[cfg(unix)]
    #[test]
    fn an_input_is_never_replaced_by_whatever_name_it_is_called() {
        let directory = tempfile::tempdir().unwrap();
        let input = directory.path().join("data.json");
        fs::write(&input, "data").unwrap();
        let link = directory.path().join("link");
        std::os::unix::fs::symlink(&input, &link).unwrap();
        let around = directory
            .path()
            .join("..")
            .join(directory.path().file_name().unwrap())
            .join("data.json");
        for path in [&input, &link, &around] {
            let set = OutputSet::new(Existing::Replace, vec![input.clone()]);
            assert!(
                matches!(set.check(&[path]), Err(FileError::Input { .. })),
                "{}",
                path.display()
            );
        }
    }

    #[test]
    fn leftovers_of_killed_runs_are_removed_and_files_in_progress_are_not() {
        let directory = tempfile::tempdir().unwrap();
        let at = |name: &str| directory.path().join(name);
        fs::write(at(".gdcm-x1y2z3.tmp"), "half of it").unwrap();
        fs::write(at(".gdcm-notes.txt"), "somebody's own").unwrap();
        let underway = set_of(Existing::Keep, &[(&at("underway"), "text")]).unwrap();
        write_whole(&at("next"), |_| Ok(())).unwrap();
        underway.persist().unwrap();
        assert_eq!(
            names(directory.path()),
            [".gdcm-notes.txt", "next", "underway"]
        );
    }

    #[cfg(unix)]
    #[test]
    fn the_mode_of_a_replaced_file_stays_and_a_link_still_leads_to_it() {
        use std::os::unix::fs::{PermissionsExt, symlink};
        let directory = tempfile::tempdir().unwrap();
        let path = directory.path().join("a");
        let link = directory.path().join("link");
        fs::write(&path, "before").unwrap();
        fs::set_permissions(&path, fs::Permissions::from_mode(0o640)).unwrap();
        symlink(&path, &link).unwrap();
        write_whole(&link, |file| file.write_all(b"after")).unwrap();
        assert_eq!(fs::read_to_string(&path).unwrap(), "after");
        assert_eq!(
            fs::metadata(&path).unwrap().permissions().mode() & 0o777,
            0o640
        );
        assert!(fs::symlink_metadata(&link).unwrap().is_symlink());
    }

    #[test]
    fn a_missing_directory_is_reported() {
        let directory = tempfile::tempdir().unwrap();
        let missing = directory.path().join("no/such/file");
        let error = write_whole(&missing, |_| Ok(())).unwrap_err();
        assert!(
            matches!(&error, FileError::Unwritable { path, .. } if *path == missing),
            "{error:?}"
        );
    }
}
