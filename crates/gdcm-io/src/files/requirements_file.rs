//! Files of requirements (M17): `requirements.json` and `requirements.csv`, with the same numbers.

use std::collections::BTreeMap;
use std::io::{self, Write};
use std::path::{Path, PathBuf};

use serde::{Deserialize, Serialize};

use gdcm_method::requirements::tolerance::ToleranceError;
use gdcm_method::requirements::{BandwidthRule, LevelBoundaries, Tolerance, ToleranceTable};
use gdcm_model::dataset::ConditionId;
use gdcm_model::dataset::location::Location;
use gdcm_study::results::required_bandwidth::BandwidthFinding;
use gdcm_study::results::required_modes::{ModeFinding, ModeNumbers};
use gdcm_study::results::requirements::{Requirements, SummaryFinding};
use gdcm_study::results::time_histories::{HistoryFinding, TimeHistories, ToleranceFinding};

use crate::csv_text::write_records;
use crate::file_error::{ContentError, ContentFault, FileError};
use crate::json_text::{Format, json_error, write_pretty};
use crate::output_set::{OutputSet, make_directory};
use crate::reading_budget::ReadingBudget;
use crate::source::Source;

const NAME: &str = "gdcm-requirements";
const VERSION: u64 = 1;

/// Names of the files of requirements.
pub const REQUIREMENT_FILES: [&str; 2] = ["requirements.json", "requirements.csv"];

/// Returns the paths of the files of requirements in a directory.
pub fn requirement_paths(directory: &Path) -> [PathBuf; 2] {
    REQUIREMENT_FILES.map(|name| directory.join(name))
}

/// `requirements.json`: the findings, preceded by their subject.
#[derive(Serialize)]
struct RequirementsDocument<'a> {
    format: &'static str,
    version: u64,
    software: &'static str,
    dataset: DatasetName<'a>,
    #[serde(flatten)]
    requirements: &'a Requirements,
    time_histories: &'a TimeHistories,
}

#[derive(Serialize)]
struct DatasetName<'a> {
    name: &'a str,
    sha256: &'a str,
}

/// Writes both files into a directory, created if missing: both, or none.
///
/// `dataset` is the name of the dataset and the SHA-256 of its file.
pub fn write_requirements(
    (requirements, time_histories): (&Requirements, &TimeHistories),
    (name, sha256): (&str, &str),
    directory: &Path,
    mut outputs: OutputSet,
) -> Result<(), FileError> {
    let [json, table] = requirement_paths(directory);
    outputs.check(&[&json, &table])?;
    make_directory(directory)?;
    let document = RequirementsDocument {
        format: NAME,
        version: VERSION,
        software: concat!("gdcm ", env!("CARGO_PKG_VERSION")),
        dataset: DatasetName { name, sha256 },
        requirements,
        time_histories,
    };
    outputs.add(&json, |file| write_pretty(&document, file))?;
    outputs.add(&table, |file| {
        write_rows(requirements, time_histories, file)
    })?;
    outputs.persist()
}

/// Headings of the columns.
const HEADING: &str = "question condition airspeed_kt role model output input mode record tolerance quantity value low high remark";

/// Writes a row for each number.
fn write_rows(
    requirements: &Requirements,
    time_histories: &TimeHistories,
    file: &mut dyn Write,
) -> io::Result<()> {
    let heading: Vec<String> = HEADING.split(' ').map(str::to_owned).collect();
    let bandwidth = requirements.bandwidth.iter().flat_map(bandwidth_rows);
    let modes = requirements.modes.iter().flat_map(mode_rows);
    let summary = requirements.summary.iter().flat_map(summary_rows);
    let histories = time_histories.records.iter().flat_map(history_rows);
    write_records(
        file,
        std::iter::once(heading)
            .chain(bandwidth)
            .chain(modes)
            .chain(summary)
            .chain(histories),
    )
}

/// Subject of a number: the first ten cells of a row.
#[derive(Clone, Copy, Default)]
struct Subject<'a> {
    question: &'a str,
    condition: ConditionId,
    airspeed_kt: f64,
    role: &'a str,
    model: &'a str,
    output: &'a str,
    input: &'a str,
    mode: &'a str,
    record: &'a str,
    tolerance: &'a str,
}

impl Subject<'_> {
    fn row(
        &self,
        name: &str,
        value: Option<f64>,
        interval: Option<[f64; 2]>,
        remark: String,
    ) -> Vec<String> {
        let cell = |value: Option<f64>| value.map_or_else(String::new, |value| value.to_string());
        vec![
            self.question.to_owned(),
            self.condition.to_string(),
            self.airspeed_kt.to_string(),
            self.role.to_owned(),
            self.model.to_owned(),
            self.output.to_owned(),
            self.input.to_owned(),
            self.mode.to_owned(),
            self.record.to_owned(),
            self.tolerance.to_owned(),
            name.to_owned(),
            cell(value),
            cell(interval.map(|[low, _]| low)),
            cell(interval.map(|[_, high]| high)),
            remark,
        ]
    }
}

fn bandwidth_rows(finding: &BandwidthFinding) -> Vec<Vec<String>> {
    let subject = Subject {
        question: "bandwidth",
        condition: finding.condition,
        airspeed_kt: finding.airspeed_kt,
        role: finding.role.name(),
        model: &finding.model,
        output: &finding.output,
        input: &finding.input,
        ..Subject::default()
    };
    let row = |(name, value)| {
        let interval = finding.interval.get(name).copied();
        subject.row(
            name,
            value,
            interval,
            bandwidth_remark(finding, name, value.is_some()),
        )
    };
    finding.quantities().into_iter().map(row).collect()
}

/// Returns the reason why a number is missing, or its basis.
fn bandwidth_remark(finding: &BandwidthFinding, name: &'static str, is_known: bool) -> String {
    if !is_known {
        return finding.absent.get(name).cloned().unwrap_or_default();
    }
    let mut remarks: Vec<String> = Vec::new();
    if name == "omega_bw_rad_s" && finding.gain_limited {
        remarks.push("gain-limited".to_owned());
    }
    if name == "omega_bw_rad_s" && finding.rule == Some(BandwidthRule::PhaseGainUnknown) {
        remarks.push("of the phase margin; the gain margin is not known".to_owned());
    }
    if name == "phase_delay_s" && finding.phase_delay_of_line {
        remarks.push("of the least-squares line".to_owned());
    }
    if finding.rests_above(name) {
        remarks.push("rests on the response above the band".to_owned());
    }
    if finding.rests_below_band.contains(&name) {
        remarks.push("rests on the response below the band".to_owned());
    }
    if let Some(count) = finding.swaps_left_out.get(name) {
        remarks.push(format!("{count} swaps without it"));
    }
    remarks.join("; ")
}

fn mode_rows(finding: &ModeFinding) -> Vec<Vec<String>> {
    let name = finding
        .name
        .map_or_else(String::new, |name| format!(" {name}"));
    let mode = format!("{}{name}", finding.number);
    let rows = |role: &str, numbers: &ModeNumbers| -> Vec<Vec<String>> {
        let subject = Subject {
            question: "modes",
            condition: finding.condition,
            airspeed_kt: finding.airspeed_kt,
            role,
            model: &numbers.model,
            mode: &mode,
            ..Subject::default()
        };
        let why = |name: &str| {
            numbers
                .absent
                .get(name)
                .copied()
                .unwrap_or_default()
                .to_owned()
        };
        numbers
            .quantities()
            .into_iter()
            .map(|(name, value)| subject.row(name, value, None, why(name)))
            .collect()
    };
    let physics = finding
        .physics
        .iter()
        .flat_map(|numbers| rows("physics", numbers));
    let corrected = finding
        .corrected
        .iter()
        .flat_map(|numbers| rows("corrected", numbers));
    rows("identified", &finding.identified)
        .into_iter()
        .chain(physics)
        .chain(corrected)
        .collect()
}

fn summary_rows(finding: &SummaryFinding) -> Vec<Vec<String>> {
    let subject = Subject {
        question: "summary",
        condition: finding.condition,
        airspeed_kt: finding.airspeed_kt,
        role: finding.role.name(),
        model: &finding.model,
        ..Subject::default()
    };
    let absent: &BTreeMap<&'static str, String> = &finding.absent;
    let why = |name: &str| absent.get(name).cloned().unwrap_or_default();
    finding
        .quantities()
        .into_iter()
        .map(|(name, value)| subject.row(name, value, None, why(name)))
        .collect()
}

/// Returns rows for values without a tolerance first, then for each tolerance.
fn history_rows(finding: &HistoryFinding) -> Vec<Vec<String>> {
    let subject = Subject {
        question: "time_histories",
        condition: finding.condition,
        airspeed_kt: finding.airspeed_kt,
        role: finding.role.name(),
        model: &finding.model,
        input: finding.moved_input.as_deref().unwrap_or_default(),
        record: &finding.record,
        ..Subject::default()
    };
    let remark = match (finding.j_rms, finding.j_rms_left_out.as_slice()) {
        (None, _) => "no output is an angle, a rate, a speed or an acceleration".to_owned(),
        (Some(_), []) => String::new(),
        (Some(_), left_out) => format!("without {}", left_out.join(", ")),
    };
    let rms = subject.row("j_rms", finding.j_rms, None, remark);
    let theil = finding.theil.iter().map(|(output, theil)| {
        Subject { output, ..subject }.row("theil", Some(*theil), None, String::new())
    });
    let against = finding.tolerances.iter().flat_map(|of| {
        let subject = Subject {
            output: &of.output,
            tolerance: &of.quantity,
            ..subject
        };
        let row = |(name, value): (&str, Option<f64>)| {
            subject.row(name, value, None, tolerance_remark(of, name))
        };
        of.quantities().map(row)
    });
    std::iter::once(rms).chain(theil).chain(against).collect()
}

/// Returns the unit of an excess, and the trend indicated by a correlation.
fn tolerance_remark(finding: &ToleranceFinding, name: &str) -> String {
    match (name, finding.correlation, finding.trend) {
        ("largest_excess", ..) => finding.unit.clone(),
        ("correlation", None, _) => "flown or simulated does not move".to_owned(),
        ("correlation", _, Some(trend)) => format!("off-axis, trend {}", trend.name()),
        _ => String::new(),
    }
}

// The engineer's own tables for requirements, each a separate file, for any study (M17): levels of
// bandwidth and phase delay, tolerances of time histories.

const TOLERANCES: Format = Format {
    name: "gdcm-tolerances",
    version: 1,
};

#[derive(Serialize, Deserialize)]
struct TolerancesText {
    format: String,
    version: u64,
    #[serde(default)]
    source: String,
    tolerances: Vec<Tolerance>,
}

/// Reads the boundaries of levels from a file, `[{"name": "Level 1", "axis": "P", "points":
/// [[rad/s, s], ...]}]` (M17.1).
///
/// # Errors
/// [`FileError`] with the line if the file cannot be read, or a boundary is invalid.
pub fn read_levels(path: &Path) -> Result<LevelBoundaries, FileError> {
    let source = Source::read(path, &ReadingBudget::default())?;
    let text = source.text();
    serde_json::from_slice(text)
        .map_err(|error| json_error(text, path, Location::default(), &error))
}

/// Reads a table of tolerances; whole, or not at all. Unknown keys are cautions.
pub fn load_tolerances(path: &Path) -> Result<(ToleranceTable, Vec<String>), FileError> {
    let budget = ReadingBudget::default();
    let source = Source::read(path, &budget)?;
    let (text, cautions) = TOLERANCES.decode::<TolerancesText>(source.text(), path, &budget)?;
    let refused =
        |error: ToleranceError| ContentError::new(Location::default(), ContentFault::from(error));
    let table = ToleranceTable::new(text.source, text.tolerances);
    Ok((
        table.map_err(|error| FileError::content(path, refused(error)))?,
        cautions,
    ))
}

/// Adds a table of tolerances to `outputs`.
pub fn add_tolerances(
    table: &ToleranceTable,
    path: &Path,
    outputs: &mut OutputSet,
) -> Result<(), FileError> {
    let text = TolerancesText {
        format: TOLERANCES.name.to_owned(),
        version: TOLERANCES.version,
        source: table.source().to_owned(),
        tolerances: table.rows().to_vec(),
    };
    outputs.add(path, |file| write_pretty(&text, file))
}

#[cfg(test)]
mod table_tests {
    use super::*;
    use crate::output_set::Existing;

    #[test]
    fn levels_are_read_and_what_is_wrong_with_them_is_said_with_its_place() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("levels.json");
        let read = |text: &str| {
            std::fs::write(&path, text).unwrap();
            read_levels(&path).map_err(|error| error.to_string())
        };
        let levels =
            read(r#"[{"name": "Level 1", "axis": "P", "points": [[2, 0], [2.5, 0.2]]}]"#).unwrap();
        assert_eq!(
            levels.of_axis("P").next().unwrap().points,
            [[2.0, 0.0], [2.5, 0.2]]
        );
        let cases = [
            (
                r#"[{"name": "L", "axis": "P", "points": [[2, 0]]}]"#,
                "expected at least 2 points, found 1",
            ),
            (r#"[{"name": "L", "points": [[2, 0], [1, 1]]}]"#, "axis"),
            (r#"{"levels": []}"#, "a list"),
            ("[{", "end"),
        ];
        for (text, words) in cases {
            let error = read(text).unwrap_err();
            assert!(
                error.contains("levels.json") && error.contains(words),
                "{error}"
            );
        }
    }

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
            (
                "\"channel\": \"P\"",
                "\"channel\": \"\"",
                "tolerance 1, \"roll rate\": expected the name of an output",
            ),
            ("\"absolute\": 3.0,", "", "\"absolute\" is missing"),
            ("gdcm-tolerances", "gdcm-rules", "gdcm-tolerances"),
        ] {
            std::fs::write(&path, right.replacen(from, to, 1)).unwrap();
            let error = load_tolerances(&path).unwrap_err().to_string();
            assert!(error.contains(words), "{error}");
        }
        std::fs::write(&path, right.replacen("\"source\"", "\"sauce\"", 1)).unwrap();
        let (table, cautions) = load_tolerances(&path).unwrap();
        assert!(
            table.source().is_empty() && cautions.len() == 1 && cautions[0].contains("sauce"),
            "{cautions:?}"
        );
    }
}
