//! `gdcm requirements`: what a qualification asks of the models of every condition, written as files, with a short table.

use gdcm_core::message_text::{sanitized, sanitized_path};
use gdcm_core::requirements::ModeVerdict;
use gdcm_core::study::{
    Analysis, BandwidthFinding, Execution, RequirementRole, Requirements, SummaryFinding, Table, requirements_of,
};
use gdcm_core::units::s_to_ms;
use gdcm_files::{REQUIREMENT_FILES, make_directory, requirement_paths, write_requirements};

use super::{
    Failure, LABEL, RequirementsArguments, TerminalProgress, analysis_of, by_words, caution_of, indented, labelled,
    note, say, study_of,
};
use crate::executor::Pool;

/// Analyses, writes the requirements, and prints a short table.
pub(super) fn requirements(arguments: &RequirementsArguments) -> Result<(), Failure> {
    let (study, loaded, outputs) = study_of(&arguments.study, arguments.force)?;
    outputs.check(&requirement_paths(&arguments.out))?;
    make_directory(&arguments.out)?;
    let (analysis, _) = analysis_of(study, &arguments.study, true)?;
    let progress = TerminalProgress::new("reading bandwidths");
    let requirements = requirements_of(&analysis, &Execution::new(&Pool, &progress, analysis.conditions.len()))?;
    drop(progress);
    let dataset = (analysis.study.dataset.name(), loaded.sha256.as_str());
    write_requirements(&requirements, dataset, &arguments.out, outputs)?;
    for caution in by_words(requirements.cautions.iter().map(|of| (of.condition, of.text.clone()))) {
        caution_of(&caution.0, &caution.1);
    }
    // Conditions without a result have been told already.
    let missing = requirements.missing.iter().filter(|of| of.what != "all");
    missing.for_each(|of| {
        let condition = of.condition.map_or_else(String::new, |id| format!("condition {id}: "));
        note(&format!("{condition}no {}: {}", of.what, of.why));
    });
    let written = format!("{} in {}", REQUIREMENT_FILES.join(", "), sanitized_path(&arguments.out));
    let text = bandwidth_section(&analysis, &requirements)
        + &summary_section(&requirements)
        + &mode_section(&requirements)
        + &labelled(0, "", LABEL, "these numbers are no qualification")
        + &labelled(0, "Written", LABEL, &written);
    say(&text)
}

/// A number, or a dash.
fn cell(value: Option<f64>, digits: usize) -> String {
    value.map_or_else(|| "-".to_owned(), |value| format!("{value:.digits$}"))
}

/// "2.13 / 112*": bandwidth \[rad/s\] and phase delay \[ms\] of a response, each marked where it rests on the response above the band.
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

/// Bandwidth and phase delay of every response that has one of them, role by role; of the others the reason, once.
fn bandwidth_section(analysis: &Analysis, requirements: &Requirements) -> String {
    let headings = ["condition", "response"].into_iter().chain(RequirementRole::ALL.map(RequirementRole::name));
    let mut table = Table::new("", headings);
    let (mut reasons, mut is_marked) = (Vec::new(), false);
    let same_response = |a: &BandwidthFinding, b: &BandwidthFinding| (a.condition, a.pair) == (b.condition, b.pair);
    for findings in requirements.bandwidth.chunk_by(same_response) {
        let name = analysis.study.dataset.pair_name(findings[0].pair);
        if findings.iter().all(|of| of.omega_bw_rad_s.is_none() && of.phase_delay_s.is_none()) {
            let why = findings[0].absent.get("omega_bw_rad_s").cloned().unwrap_or_default();
            reasons.push((findings[0].condition, format!("{name}: {why}")));
            continue;
        }
        let numbers = |role| findings.iter().find(|of| of.role == role).map_or_else(|| "-".to_owned(), both_numbers);
        let cells = [findings[0].condition.to_string(), sanitized(&name)];
        let cells: Vec<String> = cells.into_iter().chain(RequirementRole::ALL.map(numbers)).collect();
        is_marked |= cells.iter().any(|cell| cell.contains('*'));
        table.row(cells);
    }
    let star = if is_marked { "; * rests on the response above the band" } else { "" };
    let mut text = labelled(0, "Bandwidth", LABEL, &format!("of the attitude [rad/s] / phase delay [ms]{star}:"));
    if !table.rows.is_empty() {
        text.push_str(&indented(&table, 2));
    }
    for (conditions, words) in by_words(reasons) {
        let words = format!("{}: {words}", super::listed_conditions(&conditions));
        text.push_str(&labelled(0, "No bandwidth", LABEL, &sanitized(&words)));
    }
    text
}

/// Mean J and share of the band inside the envelopes, on-axis, role by role.
fn summary_section(requirements: &Requirements) -> String {
    let roles = [RequirementRole::Physics, RequirementRole::Corrected, RequirementRole::Scheduled];
    let of_roles = |quantity: &str| roles.map(|role| format!("{quantity} {}", role.name()));
    let headings = ["J", "MUAD [%]"].into_iter().flat_map(of_roles);
    let mut table = Table::new("", std::iter::once("condition".to_owned()).chain(headings));
    for findings in requirements.summary.chunk_by(|a, b| a.condition == b.condition) {
        let of_role = |role| findings.iter().find(|of| of.role == role);
        let value = |role, of: fn(&SummaryFinding) -> Option<f64>| of_role(role).and_then(of);
        let mut cells = vec![findings[0].condition.to_string()];
        cells.extend(roles.map(|role| cell(value(role, |of| of.mean_j_on_axis), 1)));
        cells.extend(roles.map(|role| cell(value(role, |of| of.muad_share_on_axis.map(|share| 100.0 * share)), 0)));
        table.row(cells);
    }
    labelled(0, "Summary", LABEL, "on-axis mean of J, and of the share of the band inside the MUAD envelopes:")
        + &indented(&table, 2)
}

/// How many modes of the physics models are within their tolerances.
fn mode_section(requirements: &Requirements) -> String {
    let count = |verdict: ModeVerdict| requirements.modes.iter().filter(|mode| mode.verdict == verdict).count();
    let words = format!(
        "of physics against identified: {} within the tolerance, {} outside, {} not determined by flight, {} without a tolerance, {} \
         without a counterpart",
        count(ModeVerdict::Within),
        count(ModeVerdict::Outside),
        count(ModeVerdict::NotDetermined),
        count(ModeVerdict::NoTolerance),
        count(ModeVerdict::NotPaired)
    );
    labelled(0, "Modes", LABEL, &words)
}
