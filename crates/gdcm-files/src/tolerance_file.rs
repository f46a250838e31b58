//! Tables of tolerances as files of their own, `*.json`: the engineer's, for any study (M17.2).

use std::path::Path;

use gdcm_core::dataset::Location;
use gdcm_core::requirements::{Tolerance, ToleranceError, ToleranceTable};
use serde::{Deserialize, Serialize};

use crate::file_error::{ContentError, ContentFault, FileError};
use crate::json_text::Format;
use crate::output_set::OutputSet;
use crate::source::Source;

const FORMAT: Format = Format { name: "gdcm-tolerances", version: 1 };

#[derive(Serialize, Deserialize)]
struct TolerancesText {
    format: String,
    version: u64,
    #[serde(default)]
    source: String,
    tolerances: Vec<Tolerance>,
}

/// Reads a table of tolerances; whole, or not at all. Keys that are not known are cautions.
pub fn load_tolerances(path: &Path) -> Result<(ToleranceTable, Vec<String>), FileError> {
    let source = Source::read(path)?;
    let (text, cautions) = FORMAT.decode::<TolerancesText>(source.text(), path)?;
    FORMAT.check_read(&text.format, text.version, path)?;
    let refused = |error: ToleranceError| ContentError::new(Location::default(), ContentFault::from(error));
    let table = ToleranceTable::new(text.source, text.tolerances);
    Ok((table.map_err(|error| FileError::content(path, refused(error)))?, cautions))
}

/// Writes a table of tolerances beside others of `outputs`.
pub fn add_tolerances(table: &ToleranceTable, path: &Path, outputs: &mut OutputSet) -> Result<(), FileError> {
    let text = TolerancesText {
        format: FORMAT.name.to_owned(),
        version: FORMAT.version,
        source: table.source().to_owned(),
        tolerances: table.rows().to_vec(),
    };
    outputs.add(path, |file| {
        serde_json::to_writer_pretty(&mut *file, &text)?;
        file.write_all(b"\n")
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::output_set::Existing;

    fn written(table: &ToleranceTable) -> (tempfile::TempDir, std::path::PathBuf) {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("tolerances.json");
        let mut outputs = OutputSet::new(Existing::Keep, Vec::new());
        add_tolerances(table, &path, &mut outputs).unwrap();
        outputs.persist().unwrap();
        (folder, path)
    }

    #[test]
    fn a_table_is_read_as_it_is_written() {
        let table = ToleranceTable::default();
        let (_folder, path) = written(&table);
        assert_eq!(load_tolerances(&path).unwrap(), (table, Vec::new()));
    }

    #[test]
    fn what_is_wrong_with_a_table_is_said_with_its_row() {
        let (_folder, path) = written(&ToleranceTable::default());
        let right = std::fs::read_to_string(&path).unwrap();
        for (from, to, words) in [
            (
                "\"absolute\": 3.0",
                "\"absolute\": 0.0",
                "tolerance 1, \"roll rate\": expected absolute above zero, found 0",
            ),
            ("\"channel\": \"P\"", "\"channel\": \"\"", "tolerance 1, \"roll rate\": expected the name of an output"),
            ("\"absolute\": 3.0,", "", "\"absolute\" is missing"),
            ("gdcm-tolerances", "gdcm-rules", "gdcm-tolerances"),
        ] {
            std::fs::write(&path, right.replacen(from, to, 1)).unwrap();
            let error = load_tolerances(&path).unwrap_err().to_string();
            assert!(error.contains(words), "{error}");
        }
        std::fs::write(&path, right.replacen("\"source\"", "\"sauce\"", 1)).unwrap();
        let (table, cautions) = load_tolerances(&path).unwrap();
        assert!(table.source().is_empty() && cautions.len() == 1 && cautions[0].contains("sauce"), "{cautions:?}");
    }
}
