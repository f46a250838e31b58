//! `gdcm requirements`: computes the metrics required for a qualification for the models of every
//! condition, writes them to files and prints a short table.

use std::collections::BTreeSet;

use gdcm_io::files::requirements_file::{
    REQUIREMENT_FILES, RequirementResults, add_tolerances, requirement_paths, write_requirements,
};
use gdcm_io::output_set::{OutputSet, make_directory};
use gdcm_method::requirements::ModeVerdict;
use gdcm_model::dataset::Dataset;
use gdcm_model::message_text::{sanitized, sanitized_path};
use gdcm_model::units::s_to_ms;
use gdcm_study::Study;
use gdcm_study::results::missing_finding::MissingFinding;
use gdcm_study::results::required_bandwidth::BandwidthFinding;
use gdcm_study::results::required_modes::KnownPoles;
use gdcm_study::results::requirement_role::RequirementRole;
use gdcm_study::results::requirements::Requirements;
use gdcm_study::results::time_histories::TimeHistories;
use gdcm_words::Table;
use gdcm_words::missing_results::{missing_reason_text, no_bandwidth_text, reversed_phase_text};
use gdcm_words::time_histories::{history_cost_table, output_weights_text, share_table};

use super::failure::Failure;
use super::histories::{read_histories, simulated_histories};
use super::progress::TerminalProgress;
use super::result_arguments::RequirementsArguments;
use super::study_options::{CommandStudy, ErrorBars, StudyAnalysis, analyze_study};
use super::terminal::{caution_for, note, print};
use super::text::{ConditionMessage, counted, indented, indented_untitled, line, shared_messages};

/// Writes the tolerance table if requested; analyses the study, writes the requirements, and prints
/// a short table.
pub(super) fn requirements(arguments: &RequirementsArguments) -> Result<(), Failure> {
    let CommandStudy {
        study,
        loaded,
        outputs,
    } = CommandStudy::open(&arguments.study, arguments.force)?;
    let mut outputs = outputs.also_reading(arguments.histories.records.iter().cloned());
    let tolerances = tolerance_line(arguments, &study, &mut outputs)?;
    let Some(out) = &arguments.out else {
        outputs.persist()?;
        return print(&tolerances);
    };
    outputs.check(&requirement_paths(out))?;
    make_directory(out)?;
    let records = read_histories(&arguments.histories, &study.dataset, study.settings.band)?;
    let StudyAnalysis { analysis, engine } =
        analyze_study(study, &arguments.study, ErrorBars::Computed)?;
    let requirements = engine.requirements(
        &analysis,
        &KnownPoles::default(),
        &TerminalProgress::new("computing bandwidths"),
    )?;
    let histories = simulated_histories(&analysis, &records)?;
    let results = RequirementResults {
        requirements: &requirements,
        time_histories: &histories,
        dataset: &analysis.study.dataset,
        sha256: &loaded.sha256,
    };
    write_requirements(results, out, outputs)?;
    report_cautions(&requirements, &analysis.study.dataset);
    report_missing(&requirements, &histories);
    let files = format!(
        "{} in {}",
        REQUIREMENT_FILES.join(", "),
        sanitized_path(out)
    );
    let mut text = bandwidth_section(&analysis.study, &requirements);
    text += &summary_section(&requirements);
    text += &mode_section(&requirements);
    text += &history_section(&histories);
    text += &line("", "these values do not replace a qualification");
    text += &line("Written", &files);
    text += &tolerances;
    print(&text)?;
    records.into_outcome()
}

/// Adds the tolerance file to the outputs if requested, and returns a line about it.
fn tolerance_line(
    arguments: &RequirementsArguments,
    study: &Study,
    outputs: &mut OutputSet,
) -> Result<String, Failure> {
    let Some(path) = &arguments.write_tolerances else {
        return Ok(String::new());
    };
    let tolerances = &study.requirements.tolerances;
    add_tolerances(tolerances, path, outputs)?;
    let rows = counted(tolerances.rows().len(), "row");
    let words = format!("{rows} in {}", sanitized_path(path));
    Ok(line("Tolerances", &words))
}

fn report_cautions(requirements: &Requirements, dataset: &Dataset) {
    let messages = requirements.cautions.iter().map(|caution| {
        ConditionMessage::new(caution.condition, reversed_phase_text(caution, dataset))
    });
    for message in shared_messages(messages) {
        caution_for(&message.conditions, &message.text);
    }
}

/// Reports missing results, first those that concern all conditions. Missing records are not
/// reported if none were given.
fn report_missing(requirements: &Requirements, histories: &TimeHistories) {
    // Skip conditions without a result, which have already been reported.
    let mut missing: Vec<&MissingFinding> = requirements
        .missing
        .iter()
        .filter(|finding| finding.what != "all")
        .collect();
    if !histories.records.is_empty() {
        missing.extend(&histories.missing);
    }
    missing.sort_by_key(|finding| finding.condition.is_some());
    let messages = missing.into_iter().map(|finding| {
        let why = missing_reason_text(&finding.why);
        let words = format!("no {}: {why}", finding.what);
        ConditionMessage::new(finding.condition, words)
    });
    for message in shared_messages(messages) {
        note(&message.words());
    }
}

/// Formats a number with `digits` decimals; a dash for `None`.
fn cell(value: Option<f64>, digits: usize) -> String {
    match value {
        Some(value) => format!("{value:.digits$}"),
        None => "-".to_owned(),
    }
}

/// Bandwidth results of a response, one per role.
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

/// Returns a table of bandwidth and phase delay of the responses for which either is defined, and
/// the reasons why the other responses have none.
fn bandwidth_section(study: &Study, requirements: &Requirements) -> String {
    let responses: Vec<ResponseBandwidths> = requirements
        .bandwidth
        .chunk_by(|a, b| (a.condition, a.pair) == (b.condition, b.pair))
        .map(|findings| ResponseBandwidths {
            name: study.dataset.pair_name(findings[0].pair),
            findings,
        })
        .collect();
    let table = bandwidth_table(&responses);
    let is_marked = table.rows.iter().flatten().any(|cell| cell.contains('*'));
    let star = if is_marked {
        "; * depends on the response above the band"
    } else {
        ""
    };
    let mut text = line(
        "Bandwidth",
        &format!("of the attitude [rad/s] / phase delay [ms]{star}:"),
    );
    if !table.rows.is_empty() {
        text += &indented(&table, 2);
    }
    text += &absent_lines("No bandwidth", absent_bandwidths(&responses));
    text + &absent_lines("No delay", absent_delays(&responses))
}

/// Returns the reasons for missing bandwidths.
fn absent_bandwidths(responses: &[ResponseBandwidths]) -> Vec<ConditionMessage> {
    responses
        .iter()
        .flat_map(|response| absent_reasons(response, "omega_bw_rad_s"))
        .map(AbsentReason::into_message)
        .collect()
}

/// Returns the reasons for missing phase delays. A reason is omitted if the first result to which
/// it applies also lacks the bandwidth, for which a reason is given anyway.
fn absent_delays(responses: &[ResponseBandwidths]) -> Vec<ConditionMessage> {
    responses
        .iter()
        .flat_map(|response| absent_reasons(response, "phase_delay_s"))
        .filter(|reason| has_number(reason.finding))
        .map(AbsentReason::into_message)
        .collect()
}

fn absent_lines(label: &str, messages: Vec<ConditionMessage>) -> String {
    let mut text = String::new();
    for message in shared_messages(messages) {
        text += &line(label, &sanitized(&message.words()));
    }
    text
}

/// Reason why a bandwidth or phase delay is missing.
struct AbsentReason<'a> {
    /// First result to which the reason applies.
    finding: &'a BandwidthFinding,
    /// Response, roles and reason: "LON → Q (physics, corrected): …".
    words: String,
}

impl AbsentReason<'_> {
    fn into_message(self) -> ConditionMessage {
        ConditionMessage::new(self.finding.condition, self.words)
    }
}

/// Returns the distinct reasons why a quantity is missing in the results of a response. Each names
/// its roles, unless it applies to all.
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
        absent.push(AbsentReason {
            finding: without[0],
            words: format!("{}{roles}: {reason}", response.name),
        });
    }
    absent
}

/// Returns a table with a row for each response that has a bandwidth or a phase delay, and a column
/// for each role.
fn bandwidth_table(responses: &[ResponseBandwidths]) -> Table {
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
                Some(finding) => bandwidth_cell(finding),
                None => "-".to_owned(),
            });
        }
        table.row(cells);
    }
    table
}

/// Formats "2.13 / 112*": bandwidth \[rad/s\] and phase delay \[ms\] of a response; a star marks a
/// value that depends on the response above the band.
fn bandwidth_cell(finding: &BandwidthFinding) -> String {
    format!(
        "{}{} / {}{}",
        cell(finding.omega_bw_rad_s, 2),
        above_mark(finding, "omega_bw_rad_s"),
        cell(finding.phase_delay_s.map(s_to_ms), 0),
        above_mark(finding, "phase_delay_s")
    )
}

fn above_mark(finding: &BandwidthFinding, quantity: &str) -> &'static str {
    if finding.rests_above(quantity) {
        "*"
    } else {
        ""
    }
}

/// Returns, by role, the on-axis mean of J and the share of the band inside the envelopes.
fn summary_section(requirements: &Requirements) -> String {
    let roles = [
        RequirementRole::Physics,
        RequirementRole::Corrected,
        RequirementRole::Scheduled,
    ];
    let mut headings = vec!["condition".to_owned()];
    for quantity in ["J", "MUAD [%]"] {
        headings.extend(roles.map(|role| format!("{quantity} {}", role.name())));
    }
    let mut table = Table::new("", headings);
    for findings in requirements
        .summary
        .chunk_by(|a, b| a.condition == b.condition)
    {
        let of_roles = roles.map(|role| findings.iter().find(|finding| finding.role == role));
        let mut cells = vec![findings[0].condition.to_string()];
        for finding in of_roles {
            let mean_j = finding.and_then(|finding| finding.mean_j_on_axis);
            cells.push(cell(mean_j, 1));
        }
        for finding in of_roles {
            let share = finding.and_then(|finding| finding.muad_share_on_axis);
            cells.push(cell(share.map(|share| 100.0 * share), 0));
        }
        table.row(cells);
    }
    let words = "on-axis mean of J, and of the share of the band inside the MUAD envelopes:";
    line("Summary", words) + &indented(&table, 2)
}

/// Counts the modes within their tolerances: of the physics models and, if couplings change the
/// modes, of the corrected models.
fn mode_section(requirements: &Requirements) -> String {
    let modes = &requirements.modes;
    let physics: Vec<ModeVerdict> = modes.iter().map(|mode| mode.verdict).collect();
    let corrected: Vec<ModeVerdict> = modes
        .iter()
        .filter_map(|mode| mode.corrected_verdict)
        .collect();
    let mut text = line("Modes", &verdict_counts("physics", &physics));
    if !corrected.is_empty() {
        let words = verdict_counts("corrected with couplings", &corrected);
        text += &line("", &words);
    }
    text
}

fn verdict_counts(model: &str, verdicts: &[ModeVerdict]) -> String {
    let labels = [
        (ModeVerdict::Within, "within the tolerance"),
        (ModeVerdict::Outside, "outside"),
        (ModeVerdict::NotDetermined, "not determined by flight"),
        (ModeVerdict::NoTolerance, "without a tolerance"),
        (ModeVerdict::NotPaired, "unpaired"),
    ];
    let counts = labels.map(|(verdict, label)| {
        let count = verdicts.iter().filter(|found| **found == verdict).count();
        format!("{count} {label}")
    });
    format!("{model} compared with identified: {}", counts.join(", "))
}

/// Returns a table of the shares of time within the tolerances, limited to quantities for which a
/// model leaves them, and a table of the rms errors.
fn history_section(histories: &TimeHistories) -> String {
    const HEADING: &str = "Time history";
    if histories.records.is_empty() {
        let why = match histories.missing.first() {
            Some(finding) => missing_reason_text(&finding.why),
            None => "no record was compared".to_owned(),
        };
        return line(HEADING, &sanitized(&why));
    }
    let mut table = share_table(histories);
    let count = table.rows.len();
    table.rows.retain(|row| leaves_tolerances(row));
    for row in &mut table.rows {
        row[2] = sanitized(&row[2]);
    }
    let source = match histories.tolerance_table.source() {
        "" => String::new(),
        source => format!(" of {}", sanitized(source)),
    };
    let words = format!(
        "share of time inside the tolerances{source}, over all records of a condition; attitudes \
        are integrals of rates; omitting {} of {count} rows, in which every model is always \
        inside:",
        count - table.rows.len()
    );
    let costs = format!(
        "rms error J_rms and Theil's coefficients, over all records of a condition, {}:",
        output_weights_text(histories).replace('\u{b2}', "^2")
    );
    let mut text = line(HEADING, &words);
    text += &indented_untitled(table);
    text += &line("", &costs);
    text + &indented_untitled(history_cost_table(histories))
}

/// Returns whether a model in the row leaves the tolerances. The row gives condition, record and
/// quantity, then the shares of time in percent.
fn leaves_tolerances(row: &[String]) -> bool {
    row[3..]
        .iter()
        .any(|share| !matches!(share.as_str(), "100.0" | "-"))
}
