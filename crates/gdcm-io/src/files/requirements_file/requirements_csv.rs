//! `requirements.csv`: a row for each value.
//!
//! A *finding* holds the values for one of four questions (bandwidth, modes, summary costs, time
//! histories) in a condition. Its *role* is the model version: the physics representative,
//! uncorrected, under the condition's own correction or under the schedule, or the identified
//! representative (M17). A finding on a mode holds values for up to three roles.
//!
//! A *swap* repeats the analysis with another model of a bundle, for the intervals (M13.1).

use std::io::{self, Write};

use gdcm_method::requirements::level_boundary::AssessedLevel;
use gdcm_method::requirements::{BandwidthRule, LevelBoundaries};
use gdcm_model::dataset::ConditionId;
use gdcm_study::results::required_bandwidth::BandwidthFinding;
use gdcm_study::results::required_modes::{ModeFinding, ModeNumbers};
use gdcm_study::results::required_summary::SummaryFinding;
use gdcm_study::results::requirement_role::RequirementRole;
use gdcm_study::results::requirements::Requirements;
use gdcm_study::results::time_histories::{HistoryFinding, TimeHistories, ToleranceFinding};
use gdcm_words::missing_results::{no_bandwidth_text, no_mode_value_text, no_summary_text};

use crate::csv_text::write_records;

/// Column names in the CSV file, separated by blanks.
const HEADING: &str = "question condition airspeed_kt role model output input mode record \
    tolerance quantity value low high remark";

/// Writes the CSV file: bandwidths, modes, summary costs, then time histories.
pub(super) fn write_rows(
    requirements: &Requirements,
    time_histories: &TimeHistories,
    levels: &LevelBoundaries,
    file: &mut dyn Write,
) -> io::Result<()> {
    let mut rows: Vec<Vec<String>> = vec![HEADING.split(' ').map(str::to_owned).collect()];
    for finding in &requirements.bandwidth {
        rows.extend(bandwidth_rows(finding, levels));
    }
    for finding in &requirements.modes {
        rows.extend(mode_rows(finding));
    }
    for finding in &requirements.summary {
        rows.extend(summary_rows(finding));
    }
    for finding in &time_histories.records {
        rows.extend(history_rows(finding));
    }
    write_records(file, rows.into_iter())
}

/// Identification of a value: the first ten cells of its CSV row.
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
    /// Returns the CSV row for the quantity `name`.
    fn row(
        &self,
        name: &str,
        value: Option<f64>,
        interval: Option<[f64; 2]>,
        remark: String,
    ) -> Vec<String> {
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

/// Formats a value with all digits; a missing value, or one that is not finite, becomes an empty
/// cell.
fn cell(value: Option<f64>) -> String {
    match value {
        Some(value) if value.is_finite() => value.to_string(),
        _ => String::new(),
    }
}

fn bandwidth_rows(finding: &BandwidthFinding, levels: &LevelBoundaries) -> Vec<Vec<String>> {
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
    let mut rows = Vec::new();
    for (name, value) in finding.quantities() {
        let interval = finding.interval.get(name).copied();
        let remark = bandwidth_remark(finding, name, value.is_some());
        rows.push(subject.row(name, value, interval, remark));
    }
    if let Some(level) = finding.level(levels) {
        let remark = match level {
            AssessedLevel::Level(_) => "",
            AssessedLevel::AboveBoundaries => {
                "level not determined: phase delay above the last point of a level boundary; \
                extend the boundary"
            }
        };
        let value = level.number().map(f64::from);
        rows.push(subject.row("level", value, None, remark.to_owned()));
    }
    rows
}

/// Returns the reason why a quantity is missing; otherwise remarks on how it was determined.
fn bandwidth_remark(finding: &BandwidthFinding, name: &'static str, is_known: bool) -> String {
    if !is_known {
        let why = finding.absent.get(name);
        return why.map(no_bandwidth_text).unwrap_or_default();
    }
    let mut remarks: Vec<String> = Vec::new();
    if name == "omega_bw_rad_s" && finding.gain_limited {
        remarks.push("gain-limited".to_owned());
    }
    if name == "omega_bw_rad_s" && finding.rule == Some(BandwidthRule::PhaseGainUnknown) {
        remarks.push("from the phase margin; the gain margin is unknown".to_owned());
    }
    if name == "phase_delay_s" && finding.phase_delay_of_line {
        remarks.push("from the least-squares line".to_owned());
    }
    if finding.rests_above(name) {
        remarks.push("depends on the response above the band".to_owned());
    }
    if finding.rests_below(name) {
        remarks.push("depends on the response below the band".to_owned());
    }
    if let Some(count) = finding.swaps_left_out.get(name) {
        remarks.push(match count {
            1 => "the interval leaves out 1 other model, in which the quantity is undefined"
                .to_owned(),
            _ => format!(
                "the interval leaves out {count} other models, in which the quantity is undefined"
            ),
        });
    }
    remarks.join("; ")
}

/// Returns the CSV rows for a mode in each model that has it. The corrected model is the physics
/// representative with the study's couplings: gains and delays move no pole.
fn mode_rows(finding: &ModeFinding) -> Vec<Vec<String>> {
    let mut rows = role_mode_rows(finding, RequirementRole::Identified, &finding.identified);
    if let Some(numbers) = &finding.physics {
        rows.extend(role_mode_rows(finding, RequirementRole::Physics, numbers));
    }
    if let Some(numbers) = &finding.corrected {
        rows.extend(role_mode_rows(finding, RequirementRole::Corrected, numbers));
    }
    rows
}

/// Returns the CSV rows for a mode in the model with this role.
fn role_mode_rows(
    finding: &ModeFinding,
    role: RequirementRole,
    numbers: &ModeNumbers,
) -> Vec<Vec<String>> {
    let mode = match finding.name {
        Some(name) => format!("{} {name}", finding.number),
        None => finding.number.to_string(),
    };
    let subject = Subject {
        question: "modes",
        condition: finding.condition,
        airspeed_kt: finding.airspeed_kt,
        role: role.name(),
        model: &numbers.model,
        mode: &mode,
        ..Subject::default()
    };
    let mut rows = Vec::new();
    for (name, value) in numbers.quantities() {
        let why = match numbers.absent.get(name) {
            Some(why) => no_mode_value_text(*why),
            None => "",
        };
        rows.push(subject.row(name, value, None, why.to_owned()));
    }
    rows
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
    let mut rows = Vec::new();
    for (name, value) in finding.quantities() {
        let why = match finding.absent.get(name) {
            Some(why) => no_summary_text(*why),
            None => "",
        };
        rows.push(subject.row(name, value, None, why.to_owned()));
    }
    rows
}

/// Returns the CSV rows for a time history: quantities without a tolerance, then those for each
/// tolerance.
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
        (None, _) => {
            "J_rms needs an output that is an angle, a rate, a speed or an acceleration".to_owned()
        }
        (Some(_), []) => String::new(),
        (Some(_), left_out) => format!("J_rms does not include {}", left_out.join(", ")),
    };
    let mut rows = vec![subject.row("j_rms", finding.j_rms, None, remark)];
    for (output, theil) in &finding.theil {
        let subject = Subject { output, ..subject };
        rows.push(subject.row("theil", Some(*theil), None, String::new()));
    }
    for tolerance in &finding.tolerances {
        let subject = Subject {
            output: &tolerance.output,
            tolerance: &tolerance.quantity,
            ..subject
        };
        for (name, value) in tolerance.quantities() {
            let remark = tolerance_remark(tolerance, name);
            rows.push(subject.row(name, value, None, remark));
        }
    }
    rows
}

/// Returns the remark on a value: the unit of an excess, the scale of a peak error, the trend that
/// a correlation indicates or why there is no correlation; empty for other values.
fn tolerance_remark(finding: &ToleranceFinding, name: &str) -> String {
    match (name, finding.correlation, finding.trend) {
        ("largest_excess", ..) => finding.unit.clone(),
        ("peak_error", ..) => "multiple of the tolerance".to_owned(),
        ("correlation", None, _) => "the flown or the simulated output is constant".to_owned(),
        ("correlation", _, Some(trend)) => format!("off-axis, trend {}", trend.name()),
        _ => String::new(),
    }
}
