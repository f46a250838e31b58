//! Printed bandwidths and phase delays, and the reasons why responses have none.
//!
//! A *role* is a version of a condition's model: physics, corrected, scheduled or identified; a
//! *finding* is the result for a role. Bandwidth and phase delay are those of M17.1.

use std::collections::BTreeSet;

use gdcm_method::requirements::LevelBoundaries;
use gdcm_method::requirements::level_boundary::AssessedLevel;
use gdcm_model::message_text::sanitized;
use gdcm_model::number_format::NO_VALUE;
use gdcm_model::units::s_to_ms;
use gdcm_study::Study;
use gdcm_study::results::required_bandwidth::BandwidthFinding;
use gdcm_study::results::requirement_role::RequirementRole;
use gdcm_study::results::requirements::Requirements;
use gdcm_words::Table;
use gdcm_words::missing_results::no_bandwidth_text;
use gdcm_words::requirements::has_levels;

use super::condition_messages::{ConditionMessage, shared_messages};
use super::printed_lines::{decimals_or_dash, indented, line};

/// Returns a table with bandwidth and phase delay for the responses for which either is defined,
/// and the reasons for missing values.
pub(super) fn bandwidth_section(study: &Study, requirements: &Requirements) -> String {
    let responses: Vec<ResponseBandwidths> = requirements
        .bandwidth
        .chunk_by(|a, b| (a.condition, a.pair) == (b.condition, b.pair))
        .map(|findings| ResponseBandwidths {
            name: study.dataset.pair_name(findings[0].pair),
            findings,
        })
        .collect();
    let levels = &study.requirements.levels;
    let table = bandwidth_table(&responses, levels);
    let is_marked = table.rows.iter().flatten().any(|cell| cell.contains('*'));
    let star = if is_marked {
        "; * depends on the response above the band"
    } else {
        ""
    };
    let level = if has_levels(requirements, levels) {
        " / level"
    } else {
        ""
    };
    let end = if table.rows.is_empty() { ": none" } else { ":" };
    let mut text = line(
        "Bandwidth",
        &format!("of the attitude [rad/s] / phase delay [ms]{level}{star}{end}"),
    );
    if !table.rows.is_empty() {
        text += &indented(&table, 2);
    }
    text += &absent_lines("No bandwidth", absent_bandwidths(&responses));
    text + &absent_lines("No delay", absent_delays(&responses))
}

/// A response's bandwidth results, one per role.
struct ResponseBandwidths<'a> {
    name: String,
    findings: &'a [BandwidthFinding],
}

impl ResponseBandwidths<'_> {
    fn has_number(&self) -> bool {
        self.findings.iter().any(has_number)
    }
}

fn has_number(finding: &BandwidthFinding) -> bool {
    finding.omega_bw_rad_s.is_some() || finding.phase_delay_s.is_some()
}

fn absent_bandwidths(responses: &[ResponseBandwidths]) -> Vec<ConditionMessage> {
    responses
        .iter()
        .flat_map(|response| absent_reasons(response, "omega_bw_rad_s"))
        .map(AbsentReason::into_message)
        .collect()
}

/// Returns the reasons for missing phase delays, except where the bandwidth is missing too: the
/// reason for that is printed already. The first finding to which a reason applies decides.
fn absent_delays(responses: &[ResponseBandwidths]) -> Vec<ConditionMessage> {
    responses
        .iter()
        .flat_map(|response| absent_reasons(response, "phase_delay_s"))
        .filter(|reason| has_number(reason.finding))
        .map(AbsentReason::into_message)
        .collect()
}

/// Prints reasons with a label, each once with its conditions.
fn absent_lines(label: &str, messages: Vec<ConditionMessage>) -> String {
    let mut text = String::new();
    for message in shared_messages(messages) {
        text += &line(label, &sanitized(&message.words()));
    }
    text
}

/// Reason why a bandwidth or phase delay is missing.
struct AbsentReason<'a> {
    /// First finding to which the reason applies.
    finding: &'a BandwidthFinding,
    code: &'static str,
    /// Response, roles and reason: "LON → Q (physics, corrected): …".
    words: String,
}

impl AbsentReason<'_> {
    fn into_message(self) -> ConditionMessage {
        ConditionMessage::new(self.finding.condition, self.code, self.words)
    }
}

/// Returns the distinct reasons why a quantity, by its name in the file, is missing in a response's
/// findings. Each names its roles, unless it applies to all.
fn absent_reasons<'a>(response: &ResponseBandwidths<'a>, quantity: &str) -> Vec<AbsentReason<'a>> {
    let findings = response.findings;
    let reason_of =
        |finding: &BandwidthFinding| finding.absent.get(quantity).map(no_bandwidth_text);
    let reasons: BTreeSet<String> = findings.iter().filter_map(reason_of).collect();
    let mut absent = Vec::new();
    for reason in reasons {
        let without: Vec<&BandwidthFinding> = findings
            .iter()
            .filter(|finding| reason_of(finding).as_ref() == Some(&reason))
            .collect();
        let roles: Vec<&str> = without.iter().map(|finding| finding.role.name()).collect();
        let roles = if without.len() == findings.len() {
            String::new()
        } else {
            format!(" ({})", roles.join(", "))
        };
        let code = match without[0].absent.get(quantity) {
            Some(why) => why.code(),
            None => "",
        };
        absent.push(AbsentReason {
            finding: without[0],
            code,
            words: format!("{}{roles}: {reason}", response.name),
        });
    }
    absent
}

/// Returns a table with a row for each response that has a bandwidth or a phase delay, and a column
/// for each role.
fn bandwidth_table(responses: &[ResponseBandwidths], levels: &LevelBoundaries) -> Table {
    let mut headings = vec!["condition", "response"];
    headings.extend(RequirementRole::ALL.map(RequirementRole::name));
    let mut table = Table::new("", headings);
    for response in responses {
        if !response.has_number() {
            continue;
        }
        let findings = response.findings;
        let mut cells = vec![findings[0].condition.to_string(), sanitized(&response.name)];
        for role in RequirementRole::ALL {
            let finding = findings.iter().find(|finding| finding.role == role);
            cells.push(match finding {
                Some(finding) => bandwidth_cell(finding, levels),
                None => NO_VALUE.to_owned(),
            });
        }
        table.row(cells);
    }
    table
}

/// Formats "2.13 / 112* / 2": a response's bandwidth \[rad/s\] and phase delay \[ms\], and its
/// level if boundaries give one; a star marks a value that depends on the response above the band.
fn bandwidth_cell(finding: &BandwidthFinding, levels: &LevelBoundaries) -> String {
    let mut text = format!(
        "{}{} / {}{}",
        decimals_or_dash(finding.omega_bw_rad_s, 2),
        above_mark(finding, "omega_bw_rad_s"),
        decimals_or_dash(finding.phase_delay_s.map(s_to_ms), 0),
        above_mark(finding, "phase_delay_s")
    );
    if let Some(level) = finding.level(levels) {
        text += &format!(" / {}", level_cell(level));
    }
    text
}

fn level_cell(level: AssessedLevel) -> String {
    match level.number() {
        Some(number) => number.to_string(),
        None => NO_VALUE.to_owned(),
    }
}

/// Marks a value that depends on the response above the band.
fn above_mark(finding: &BandwidthFinding, quantity: &str) -> &'static str {
    if finding.rests_above(quantity) {
        "*"
    } else {
        ""
    }
}
