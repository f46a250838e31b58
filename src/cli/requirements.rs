//! `gdcm requirements`: computes the metrics required for a qualification from every condition's
//! models, writes them to files and prints a short table.

use gdcm_io::files::levels_and_tolerances::{add_levels, add_tolerances};
use gdcm_io::files::requirements_file::{
    REQUIREMENT_FILES, RequirementResults, requirement_paths, write_requirements,
};
use gdcm_io::output_set::{OutputSet, make_directory};
use gdcm_method::requirements::ModeVerdict;
use gdcm_model::dataset::Dataset;
use gdcm_model::message_text::{sanitized, sanitized_path};
use gdcm_model::number_format::{NO_VALUE, counted};
use gdcm_study::Study;
use gdcm_study::results::missing_finding::{MissingFinding, MissingPart};
use gdcm_study::results::required_modes::IdentifiedPoles;
use gdcm_study::results::requirement_role::RequirementRole;
use gdcm_study::results::requirements::Requirements;
use gdcm_study::results::time_histories::TimeHistories;
use gdcm_words::Table;
use gdcm_words::missing_results::{missing_finding_text, missing_reason_text, reversed_phase_text};
use gdcm_words::requirement_grid::{
    OUTSIDE_MARK, RequirementNames, count_details_text, grid_table, met_text,
};
use gdcm_words::time_histories::{history_cost_table, output_weights_text, share_table};

use super::bandwidth_summary::bandwidth_section;
use super::condition_messages::{ConditionMessage, shared_messages};
use super::failure::Failure;
use super::printed_lines::{decimals_or_dash, indented, indented_untitled, line};
use super::progress::TerminalProgress;
use super::result_arguments::RequirementsArguments;
use super::study_analysis::{ErrorBars, StudyAnalysis, analyze_study};
use super::study_options::CommandStudy;
use super::terminal::{caution_for, note, print};
use super::time_histories::{read_histories, simulated_histories};
use crate::message::Message;

/// Writes the requirements and prints a short table.
///
/// 1. Adds the tolerance table and the level boundaries to the output files, if requested; without
///    `--out`, writes these alone and ends.
/// 2. Reads the flight records for the comparison in time.
/// 3. Analyses the study; computes the requirements, and the responses to the records.
/// 4. Writes the files; reports cautions and missing results; prints grid, bandwidths, costs, modes
///    and time histories.
///
/// # Errors
/// An option or a file is wrong, no condition has a result, or the work was stopped. After all is
/// done: some records were not read.
pub(super) fn requirements(arguments: &RequirementsArguments) -> Result<(), Failure> {
    let CommandStudy {
        study,
        loaded,
        outputs,
    } = CommandStudy::open(&arguments.study, arguments.force)?;
    let mut outputs = outputs.also_reading(arguments.histories.records.iter().cloned());
    // Step 1.
    let mut tables = tolerance_line(arguments, &study, &mut outputs)?;
    tables += &level_line(arguments, &study, &mut outputs)?;
    let Some(out) = &arguments.out else {
        outputs.persist()?;
        return print(&tables);
    };
    outputs.check(&requirement_paths(out))?;
    make_directory(out)?;
    // Step 2.
    let records = read_histories(&arguments.histories, &study.dataset, study.settings.band)?;
    // Step 3.
    let StudyAnalysis { analysis, engine } =
        analyze_study(study, &arguments.study, ErrorBars::Computed)?;
    let requirements = engine.requirements(
        &analysis,
        &IdentifiedPoles::default(),
        &TerminalProgress::new("computing bandwidths"),
    )?;
    let histories = simulated_histories(&analysis, &records)?;
    // Step 4.
    let results = RequirementResults {
        requirements: &requirements,
        time_histories: &histories,
        dataset: &analysis.study.dataset,
        settings: &analysis.study.requirements,
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
    let mut text = grid_section(results);
    text += &bandwidth_section(&analysis.study, &requirements);
    text += &summary_section(&requirements);
    text += &mode_section(&requirements);
    text += &history_section(&histories);
    text += &line("", "these values do not replace a qualification");
    text += &line("Written", &files);
    text += &tables;
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

/// Adds the level-boundary file to the outputs if requested, and returns a line about it.
fn level_line(
    arguments: &RequirementsArguments,
    study: &Study,
    outputs: &mut OutputSet,
) -> Result<String, Failure> {
    let Some(path) = &arguments.write_levels else {
        return Ok(String::new());
    };
    let levels = &study.requirements.levels;
    add_levels(levels, path, outputs)?;
    let mut words = sanitized_path(path);
    for boundary in levels.as_slice() {
        words += &sanitized(&format!("; {} of {}", boundary.name, boundary.axis));
    }
    Ok(line("Levels", &words))
}

fn report_cautions(requirements: &Requirements, dataset: &Dataset) {
    let messages = requirements.cautions.iter().map(|caution| {
        let text = reversed_phase_text(caution, dataset);
        ConditionMessage::new(caution.condition, "reversed-phase", text)
    });
    for shared in shared_messages(messages) {
        let Message { code, text } = &shared.message;
        caution_for(code, &shared.conditions, text);
    }
}

/// Reports missing results, first those that concern all conditions. Missing time histories are
/// reported only if some record was compared: otherwise the printed section gives the reason.
fn report_missing(requirements: &Requirements, histories: &TimeHistories) {
    // Skip conditions without a result, which have already been reported.
    let mut missing: Vec<&MissingFinding> = requirements
        .missing
        .iter()
        .filter(|finding| finding.what != MissingPart::All)
        .collect();
    if !histories.records.is_empty() {
        missing.extend(&histories.missing);
    }
    missing.sort_by_key(|finding| finding.condition.is_some());
    let messages = missing.into_iter().map(|finding| {
        let words = missing_finding_text(finding);
        ConditionMessage::new(finding.condition, finding.why.code(), words)
    });
    for shared in shared_messages(messages) {
        note(shared.message.code, &shared.words());
    }
}

/// Counts the met requirements, and returns the grid for the conditions' own corrections; with a
/// schedule, also counts those met under it.
fn grid_section(results: RequirementResults<'_>) -> String {
    let mut text = String::new();
    let own = results.grid(RequirementRole::Corrected);
    let has_schedule = results
        .requirements
        .summary
        .iter()
        .any(|finding| finding.role == RequirementRole::Scheduled);
    let count = own.count();
    let words = format!(
        "{}, {}; {OUTSIDE_MARK} outside the limit:",
        met_text(count),
        count_details_text(count)
    );
    text += &line("Requirements", &words);
    let names = RequirementNames {
        dataset: results.dataset,
        tolerances: &results.settings.tolerances,
    };
    let mut table = grid_table(&own, names);
    table.title.clear();
    text += &indented(&table, 3);
    if has_schedule {
        let count = results.grid(RequirementRole::Scheduled).count();
        text += &line("", &format!("with the schedule: {}", met_text(count)));
    }
    text
}

/// Returns, by role, the on-axis means of J and of the band's share inside the MUAD envelopes.
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
            cells.push(decimals_or_dash(mean_j, 1));
        }
        for finding in of_roles {
            let share = finding.and_then(|finding| finding.muad_share_on_axis);
            cells.push(decimals_or_dash(share.map(|share| 100.0 * share), 0));
        }
        table.row(cells);
    }
    let words = "on-axis mean of J, and of the share of the band inside the envelopes of maximum unnoticeable \
        added dynamics (MUAD):";
    line("Summary", words) + &indented(&table, 2)
}

/// Counts the modes by verdict: for the physics models and, if couplings change the modes, for the
/// corrected models.
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
        (
            ModeVerdict::NotDetermined,
            "not determined by the flight data",
        ),
        (ModeVerdict::NoTolerance, "without a tolerance"),
        (ModeVerdict::NotPaired, "unpaired"),
    ];
    let counts = labels.map(|(verdict, label)| {
        let count = verdicts.iter().filter(|found| **found == verdict).count();
        format!("{count} {label}")
    });
    format!("{model} compared with identified: {}", counts.join(", "))
}

/// Index of the quantity in a row of the table of shares, after condition and record.
const QUANTITY: usize = 2;
/// Index of the first share of time in that row.
const FIRST_SHARE: usize = 3;

/// Returns a table with the shares of time within the tolerances, limited to quantities for which a
/// model leaves them, and a table with the rms errors; without records, the reasons.
fn history_section(histories: &TimeHistories) -> String {
    const HEADING: &str = "Time history";
    if histories.records.is_empty() {
        let messages = histories.missing.iter().map(|finding| {
            let words = missing_reason_text(&finding.why);
            ConditionMessage::new(finding.condition, finding.why.code(), words)
        });
        let mut text = String::new();
        for shared in shared_messages(messages) {
            text += &line(HEADING, &sanitized(&shared.words()));
        }
        if text.is_empty() {
            text = line(HEADING, "no record was compared");
        }
        return text;
    }
    let mut table = share_table(histories);
    let count = table.rows.len();
    table.rows.retain(|row| leaves_tolerances(row));
    for row in &mut table.rows {
        row[QUANTITY] = sanitized(&row[QUANTITY]);
    }
    let source = match histories.tolerance_table.source() {
        "" => String::new(),
        source => format!(" of {}", sanitized(source)),
    };
    let omission = match count - table.rows.len() {
        0 => String::new(),
        omitted => {
            format!("; omitting {omitted} of {count} rows, in which every model is always inside")
        }
    };
    let words = format!(
        "share of time inside the tolerances{source}, over all records of a condition; attitudes \
        are integrals of rates{omission}:"
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

/// Returns whether a model in the row leaves the tolerances: one of the shares of time, in percent
/// with one decimal, is not 100.
fn leaves_tolerances(row: &[String]) -> bool {
    row[FIRST_SHARE..]
        .iter()
        .any(|share| !matches!(share.as_str(), "100.0" | NO_VALUE))
}
