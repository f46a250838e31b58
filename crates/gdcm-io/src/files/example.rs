//! Examples embedded in the program.

use std::borrow::Cow;
use std::path::{Path, PathBuf};

use crate::file_error::FileError;
use crate::file_reading::Source;
use crate::output_set::{Existing, OutputSet, make_directory};
use crate::reading_budget::ReadingBudget;

/// An example embedded in the program: a dataset with its flight records.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Example {
    /// A synthetic UH-60A-class helicopter at eleven flight conditions.
    Simulated,
    /// An AscTec Pelican quadrotor: its published physics model and two flights from 2011. The
    /// written folder also contains a physics model and flight data from an ANT-X drone, as a
    /// second aircraft.
    RealAircraft,
}

/// An example file, as written into a folder.
struct ExampleFile {
    /// Path in the folder, with `/` between its parts.
    path: &'static str,
    content: &'static [u8],
    /// Whether the content is unpacked before it is written.
    is_packed: bool,
}

impl ExampleFile {
    const fn plain(path: &'static str, content: &'static [u8]) -> Self {
        Self {
            path,
            content,
            is_packed: false,
        }
    }

    const fn packed(path: &'static str, content: &'static [u8]) -> Self {
        Self {
            path,
            content,
            is_packed: true,
        }
    }

    /// Returns the content as it is written, unpacked if necessary.
    fn written(&self) -> Result<Cow<'static, [u8]>, FileError> {
        if !self.is_packed {
            return Ok(Cow::Borrowed(self.content));
        }
        let source = Source::from_bytes(
            self.content,
            Path::new(self.path),
            &ReadingBudget::default(),
        )?;
        Ok(Cow::Owned(source.text().to_vec()))
    }
}

const SIMULATED_DATASET: &[u8] = include_bytes!("../../../../assets/example-dataset.json.gz");
/// CSV files for conditions 3 and 10, each with simulated sweeps and a validation record.
const SIMULATED_RECORDS: &[u8] = include_bytes!("../../../../assets/example-records-3-and-10.zip");
const PELICAN_DATASET: &[u8] =
    include_bytes!("../../../../assets/real-aircraft/pelican/real-aircraft.json.gz");
/// CSV files with two parts of a flight for each condition; the second is held out.
const PELICAN_RECORDS: &[u8] =
    include_bytes!("../../../../assets/real-aircraft/pelican/records.zip");

const SIMULATED_FILES: [ExampleFile; 1] = [ExampleFile::packed(
    "example-dataset.json",
    SIMULATED_DATASET,
)];
/// Each aircraft's data are next to their licence.
const REAL_AIRCRAFT_FILES: [ExampleFile; 8] = [
    ExampleFile::packed("pelican/real-aircraft.json", PELICAN_DATASET),
    ExampleFile::plain(
        "pelican/physics.json",
        include_bytes!("../../../../assets/real-aircraft/pelican/physics.json"),
    ),
    ExampleFile::plain("pelican/records.zip", PELICAN_RECORDS),
    ExampleFile::plain(
        "pelican/LICENSE",
        include_bytes!("../../../../assets/real-aircraft/pelican/LICENSE"),
    ),
    ExampleFile::plain(
        "antx/physics.json",
        include_bytes!("../../../../assets/real-aircraft/antx/physics.json"),
    ),
    ExampleFile::plain(
        "antx/prbs.mat",
        include_bytes!("../../../../assets/real-aircraft/antx/prbs.mat"),
    ),
    ExampleFile::plain(
        "antx/sweep.mat",
        include_bytes!("../../../../assets/real-aircraft/antx/sweep.mat"),
    ),
    ExampleFile::plain(
        "antx/LICENSE",
        include_bytes!("../../../../assets/real-aircraft/antx/LICENSE"),
    ),
];

impl Example {
    /// Every example, in menu order.
    pub const ALL: [Self; 2] = [Self::Simulated, Self::RealAircraft];

    /// Returns the name by which studies and messages refer to the example.
    pub fn name(self) -> &'static str {
        match self {
            Self::Simulated => "embedded example",
            Self::RealAircraft => "embedded real aircraft",
        }
    }

    /// Returns the file name stem proposed for the example's studies and results.
    pub fn file_stem(self) -> &'static str {
        match self {
            Self::Simulated => "example",
            Self::RealAircraft => "real-aircraft",
        }
    }

    /// Returns the example with this name, or the simulated example if no example has it: older
    /// program versions, which had no other example, opened it for every study without a dataset
    /// path.
    pub(crate) fn from_name(name: &str) -> Self {
        for example in Self::ALL {
            if example.name() == name {
                return example;
            }
        }
        Self::Simulated
    }

    /// Returns the dataset, packed with gzip.
    pub(super) fn dataset(self) -> &'static [u8] {
        match self {
            Self::Simulated => SIMULATED_DATASET,
            Self::RealAircraft => PELICAN_DATASET,
        }
    }

    /// Returns the archive with the flight records for [`Self::record_conditions`].
    pub fn records(self) -> &'static [u8] {
        match self {
            Self::Simulated => SIMULATED_RECORDS,
            Self::RealAircraft => PELICAN_RECORDS,
        }
    }

    /// Returns the ids of the conditions with embedded flight records.
    pub fn record_conditions(self) -> &'static [i64] {
        match self {
            Self::Simulated => &[3, 10],
            Self::RealAircraft => &[1, 2],
        }
    }

    fn files(self) -> &'static [ExampleFile] {
        match self {
            Self::Simulated => &SIMULATED_FILES,
            Self::RealAircraft => &REAL_AIRCRAFT_FILES,
        }
    }

    /// Writes the example's files into a directory, which is created if missing; all or none. The
    /// simulated example's records are not among them; [`Self::records`] returns them. Returns the
    /// paths, the dataset's first.
    ///
    /// # Errors
    /// [`FileError`] if a file exists and is to be kept, or cannot be written.
    pub fn write(self, directory: &Path, existing: Existing) -> Result<Vec<PathBuf>, FileError> {
        let mut paths = Vec::new();
        for file in self.files() {
            paths.push(directory.join(file.path));
        }
        let mut outputs = OutputSet::new(existing, Vec::new());
        outputs.check(&paths)?;
        for (file, path) in self.files().iter().zip(&paths) {
            let content = file.written()?;
            make_directory(path.parent().unwrap_or(directory))?;
            outputs.add(path, |output| output.write_all(&content))?;
        }
        outputs.persist()?;
        Ok(paths)
    }
}
