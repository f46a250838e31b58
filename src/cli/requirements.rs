//! `gdcm requirements`: the quantities required for a qualification, computed for the models of
//! every condition; written as files, with a short table.

use std::collections::BTreeSet;

use gdcm_io::files::requirements_file::{
    REQUIREMENT_FILES, RequirementResults, add_tolerances, requirement_paths, write_requirements,
};
use gdcm_io::output_set::make_directory;
use gdcm_method::requirements::ModeVerdict;
use gdcm_model::message_text::{sanitized, sanitized_path};
use gdcm_model::units::s_to_ms;
use gdcm_study::results::required_bandwidth::BandwidthFinding;
use gdcm_study::results::required_modes::KnownPoles;
use gdcm_study::results::requirements::{
    MissingFinding, RequirementRole, Requirements, SummaryFinding,
};
use gdcm_study::results::time_histories::TimeHistories;
use gdcm_study::{Analysis, Table};

use super::arguments::RequirementsArguments;
use super::flight_records::time_histories;
use super::models::counted;
use super::study_options::{analysis_of, study_of};
use super::terminal::{
    Failure, TerminalProgress, by_words, caution_of, indented, line, note, of_conditions, say,
};

/// Writes the table of tolerances if requested; analyses, writes the requirements, and prints a
/// short table.
pub(super) fn requirements(arguments: &RequirementsArguments) -> Result<(), Failure> {
    let histories = &arguments.histories;
    let (study, loaded, outputs) = study_of(&arguments.study, arguments.force)?;
    let mut outputs = outputs.also_reading(histories.records.iter().cloned());
    let written = match &arguments.write_tolerances {
        Some(path) => {
            let tolerances = &study.requirements.tolerances;
            add_tolerances(tolerances, path, &mut outputs)?;
            let rows = counted(tolerances.rows().len(), "row");
            line("Tolerances", &format!("{rows} in {}", sanitized_path(path)))
        }
        None => String::new(),
    };
    let Some(out) = &arguments.out else {
        outputs.persist()?;
        return say(&written);
    };
    outputs.check(&requirement_paths(out))?;
    make_directory(out)?;
    let records = histories.read(&study.dataset, study.settings.band)?;
    let (analysis, engine) = analysis_of(study, &arguments.study, true)?;
    let requirements = engine.requirements(
        &analysis,
        &KnownPoles::default(),
        &TerminalProgress::new("reading bandwidths"),
    )?;
    let histories = time_histories(&analysis, &records)?;
    let results = RequirementResults {
        requirements: &requirements,
        time_histories: &histories,
        dataset: analysis.study.dataset.name(),
        sha256: &loaded.sha256,
    };
    write_requirements(results, out, outputs)?;
    tell_cautions(&requirements, &histories);
    let files = format!(
        "{} in {}",
        REQUIREMENT_FILES.join(", "),
        sanitized_path(out)
    );
    let text = bandwidth_section(&analysis, &requirements)
        + &summary_section(&requirements)
        + &mode_section(&requirements)
        + &history_section(&histories)
        + &line("", "these numbers are no qualification")
        + &line("Written", &files);
    say(&(text + &written))?;
    records.ended()
}

/// Reports cautions and missing results; missing records are not reported if none were given.
fn tell_cautions(requirements: &Requirements, histories: &TimeHistories) {
    for (conditions, words) in by_words(
        requirements
            .cautions
            .iter()
            .map(|of| (of.condition, of.text.clone())),
    ) {
        caution_of(&conditions, &words);
    }
    let of_records = histories
        .missing
        .iter()
        .filter(|_| !histories.records.is_empty());
    // Conditions without a result have already been reported.
    let missing = requirements
        .missing
        .iter()
        .filter(|of| of.what != "all")
        .chain(of_records);
    let mut missing: Vec<&MissingFinding> = missing.collect();
    missing.sort_by_key(|of| of.condition.is_some());
    for (conditions, words) in by_words(
        missing
            .iter()
            .map(|of| (of.condition, format!("no {}: {}", of.what, of.why))),
    ) {
        note(&of_conditions(&conditions, &words));
    }
}

/// Formats a number, or a dash.
fn cell(value: Option<f64>, digits: usize) -> String {
    value.map_or_else(|| "-".to_owned(), |value| format!("{value:.digits$}"))
}

/// Formats "2.13 / 112*": bandwidth \[rad/s\] and phase delay \[ms\] of a response, each marked if
/// it depends on the response above the band.
fn both_numbers(finding: &BandwidthFinding) -> String {
    let mark = |name: &str| if finding.rests_above(name) { "*" } else { "" };
    format!(
        "{}{} / {}{}",
        cell(finding.omega_bw_rad_s, 2),
        mark("omega_bw_rad_s"),
        cell(finding.phase_delay_s.map(s_to_ms), 0),
        mark("phase_delay_s")
    )
}

/// Returns bandwidth and phase delay of every response that has one of them, by role; for the
/// others the reason, once.
fn bandwidth_section(analysis: &Analysis, requirements: &Requirements) -> String {
    let same_response =
        |a: &BandwidthFinding, b: &BandwidthFinding| (a.condition, a.pair) == (b.condition, b.pair);
    let has_number =
        |of: &BandwidthFinding| of.omega_bw_rad_s.is_some() || of.phase_delay_s.is_some();
    let responses = || requirements.bandwidth.chunk_by(same_response);
    let name = |of: &[BandwidthFinding]| analysis.study.dataset.pair_name(of[0].pair);
    let known = responses().filter(|of| of.iter().any(has_number));
    let table = bandwidth_table(known.map(|of| (name(of), of)));
    let is_marked = table.rows.iter().flatten().any(|cell| cell.contains('*'));
    let star = if is_marked {
        "; * rests on the response above the band"
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
    for (label, quantity) in [
        ("No bandwidth", "omega_bw_rad_s"),
        ("No delay", "phase_delay_s"),
    ] {
        let absent = responses().flat_map(|of| absent_words(&name(of), of, quantity));
        // A response without any number needs only one reason.
        let absent = absent.filter(|(of, _)| quantity == "omega_bw_rad_s" || has_number(of));
        for (conditions, words) in by_words(absent.map(|(of, words)| (of.condition, words))) {
            text += &line(label, &sanitized(&of_conditions(&conditions, &words)));
        }
    }
    text
}

/// Returns the reasons for missing numbers of a response, each once, with its roles unless it
/// applies to all: "LON → Q (physics, corrected): …".
fn absent_words<'a>(
    name: &str,
    findings: &'a [BandwidthFinding],
    quantity: &str,
) -> Vec<(&'a BandwidthFinding, String)> {
    let reasons: BTreeSet<&String> = findings
        .iter()
        .filter_map(|of| of.absent.get(quantity))
        .collect();
    let told = |why: &String| {
        let of: Vec<&BandwidthFinding> = findings
            .iter()
            .filter(|of| of.absent.get(quantity) == Some(why))
            .collect();
        let roles = match of.len() == findings.len() {
            true => String::new(),
            false => format!(
                " ({})",
                of.iter()
                    .map(|of| of.role.name())
                    .collect::<Vec<_>>()
                    .join(", ")
            ),
        };
        (of[0], format!("{name}{roles}: {why}"))
    };
    reasons.into_iter().map(told).collect()
}

/// Returns a table with a row for each response: its name and the numbers of each role.
fn bandwidth_table<'a>(responses: impl Iterator<Item = (String, &'a [BandwidthFinding])>) -> Table {
    let headings = ["condition", "response"]
        .into_iter()
        .chain(RequirementRole::ALL.map(RequirementRole::name));
    let mut table = Table::new("", headings);
    for (name, findings) in responses {
        let numbers = |role| {
            findings
                .iter()
                .find(|of| of.role == role)
                .map_or_else(|| "-".to_owned(), both_numbers)
        };
        let cells = [findings[0].condition.to_string(), sanitized(&name)];
        table.row(cells.into_iter().chain(RequirementRole::ALL.map(numbers)));
    }
    table
}

/// Returns mean J and the share of the band inside the envelopes, on-axis, by role.
fn summary_section(requirements: &Requirements) -> String {
    let roles = [
        RequirementRole::Physics,
        RequirementRole::Corrected,
        RequirementRole::Scheduled,
    ];
    let of_roles = |quantity: &str| roles.map(|role| format!("{quantity} {}", role.name()));
    let headings = ["J", "MUAD [%]"].into_iter().flat_map(of_roles);
    let mut table = Table::new("", std::iter::once("condition".to_owned()).chain(headings));
    for findings in requirements
        .summary
        .chunk_by(|a, b| a.condition == b.condition)
    {
        let of_role = |role| findings.iter().find(|of| of.role == role);
        let value = |role, of: fn(&SummaryFinding) -> Option<f64>| of_role(role).and_then(of);
        let mut cells = vec![findings[0].condition.to_string()];
        cells.extend(roles.map(|role| cell(value(role, |of| of.mean_j_on_axis), 1)));
        cells.extend(roles.map(|role| {
            cell(
                value(role, |of| of.muad_share_on_axis.map(|share| 100.0 * share)),
                0,
            )
        }));
        table.row(cells);
    }
    line(
        "Summary",
        "on-axis mean of J, and of the share of the band inside the MUAD envelopes:",
    ) + &indented(&table, 2)
}

/// Returns how many modes are within their tolerances, for the physics models and, where couplings
/// change the modes, for the corrected models.
fn mode_section(requirements: &Requirements) -> String {
    let counted = |model: &str, verdicts: &[ModeVerdict]| {
        let count = |verdict: ModeVerdict| verdicts.iter().filter(|of| **of == verdict).count();
        let counts = [
            (ModeVerdict::Within, "within the tolerance"),
            (ModeVerdict::Outside, "outside"),
            (ModeVerdict::NotDetermined, "not determined by flight"),
            (ModeVerdict::NoTolerance, "without a tolerance"),
            (ModeVerdict::NotPaired, "unpaired"),
        ];
        let counts = counts.map(|(verdict, words)| format!("{} {words}", count(verdict)));
        format!("of {model} against identified: {}", counts.join(", "))
    };
    let physics: Vec<ModeVerdict> = requirements.modes.iter().map(|mode| mode.verdict).collect();
    let corrected: Vec<ModeVerdict> = requirements
        .modes
        .iter()
        .filter_map(|mode| mode.corrected_verdict)
        .collect();
    let mut text = line("Modes", &counted("physics", &physics));
    if !corrected.is_empty() {
        text += &line("", &counted("corrected with its couplings", &corrected));
    }
    text
}

/// Returns the share of time inside the tolerances for models that leave them, by condition, and
/// the rms errors.
fn history_section(histories: &TimeHistories) -> String {
    const HEADING: &str = "Time history";
    if histories.records.is_empty() {
        let why = histories
            .missing
            .first()
            .map_or("no record was compared", |of| of.why.as_str());
        return line(HEADING, &sanitized(why));
    }
    let mut table = histories.share_table();
    let all = table.rows.len();
    table.rows.retain(|row| {
        row[3..]
            .iter()
            .any(|share| !matches!(share.as_str(), "100.0" | "-"))
    });
    table
        .rows
        .iter_mut()
        .for_each(|row| row[2] = sanitized(&row[2]));
    let source = match histories.tolerance_table.source() {
        "" => String::new(),
        source => format!(" of {}", sanitized(source)),
    };
    let words = format!(
        "share of time inside the tolerances{source}, over all records of a condition; attitudes are integrals of rates; {} of {all} \
         rows, in which every model is always inside, are left out:",
        all - table.rows.len()
    );
    let costs = format!(
        "rms error J_rms and Theil's coefficients, over all records of a condition, {}:",
        histories.weights_words().replace('\u{b2}', "^2")
    );
    line(HEADING, &words)
        + &indented(
            &Table {
                title: String::new(),
                ..table
            },
            2,
        )
        + &line("", &costs)
        + &indented(
            &Table {
                title: String::new(),
                ..histories.cost_table()
            },
            2,
        )
}
