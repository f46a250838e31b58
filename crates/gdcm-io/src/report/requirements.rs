//! Report section on the qualification requirements (M17), with the same values as `gdcm
//! requirements`.
//!
//! Each value is for a condition and a *role*: the physics representative, uncorrected, under the
//! condition's own correction or under the schedule, or the identified representative. The *grid*
//! has the verdict on each requirement in each condition.

use std::collections::BTreeMap;

use gdcm_model::dataset::ConditionId;
use gdcm_model::progress::{Cancelled, Progress};
use gdcm_plot::figure::requirements::requirements_figure;
use gdcm_study::results::grid_source::GridSource;
use gdcm_study::results::required_bandwidth::BandwidthFinding;
use gdcm_study::results::requirement_grid::RequirementGrid;
use gdcm_study::results::requirement_role::RequirementRole;
use gdcm_study::results::requirements::Requirements;
use gdcm_study::results::time_histories::TimeHistories;
use gdcm_study::{Engine, Study};
use gdcm_words::Table;
use gdcm_words::missing_results::{
    missing_finding_text, missing_reason_text, no_bandwidth_text, reversed_phase_text,
};
use gdcm_words::requirement_grid::{GRID_HEADS, RequirementNames, grid_table};
use gdcm_words::requirements::{bandwidth_table, mode_table, summary_table};
use gdcm_words::time_histories::{record_table, share_table};

use super::page::Page;
use super::{CancellationOnly, ReportSubject};

/// Maximum number of columns in a table that fits on a page, beside the columns that each part of a
/// wide table repeats.
const COLUMNS: usize = 9;
/// Columns that each part of the summary table repeats: condition, airspeed and model.
const SUMMARY_HEADS: usize = 3;
/// Maximum number of other columns in the summary table, two fewer than in the other tables.
const SUMMARY_COLUMNS: usize = COLUMNS - 2;
/// Maximum number of plots per row in the figure of bandwidths.
const BANDWIDTH_COLUMNS: usize = 4;

/// Evaluates the study's requirements.
///
/// # Errors
/// [`Cancelled`] soon after `progress` requests it.
pub(super) fn evaluate(
    subject: ReportSubject<'_>,
    engine: &Engine,
    progress: &dyn Progress,
) -> Result<Requirements, Cancelled> {
    engine.requirements(subject.analysis, subject.known, &CancellationOnly(progress))
}

/// Adds the section on the requirements: bandwidths as a figure, summary costs, and the grid with
/// all requirements.
pub(super) fn add_requirements(
    page: &mut Page,
    requirements: &Requirements,
    subject: ReportSubject<'_>,
) {
    let study = &subject.analysis.study;
    page.section("Requirements");
    page.paragraph(
        "Criteria used to accept simulators and flight control laws, evaluated for the physics \
        representative (uncorrected, with its own correction, and with the schedule) and for the \
        identified representative. These values do not replace a qualification, which requires \
        flight tests at specified conditions with specified inputs, and a pilot's assessment.",
    );
    if requirements.bandwidth.iter().any(is_defined) {
        let figure = requirements_figure(requirements, &study.dataset, &study.requirements.levels);
        let caption = "Phase delay over bandwidth; arrows lead from physics to corrected models.";
        let title = figure.title.clone();
        page.figure(&figure.columns(BANDWIDTH_COLUMNS), &title, caption);
    }
    page.paragraph(
        "Mean J relative to the identified representative (M4), and mean share of the band (in ln \
        \u{3c9}) in which the difference from it lies inside the envelopes of maximum unnoticeable \
        added dynamics (MIL-STD-1797A, appendix A, 4.2.1.2).",
    );
    page.wide_table_behind(
        &summary_table(requirements, subject.histories),
        SUMMARY_HEADS,
        SUMMARY_COLUMNS,
    );
    add_grids(page, requirements, subject.histories, study);
}

/// Adds the appendix on the requirements: bandwidths, modes, time histories if flight records are
/// available, the reasons for missing values, and cautions.
pub(super) fn add_requirement_details(
    page: &mut Page,
    requirements: &Requirements,
    subject: ReportSubject<'_>,
) {
    let study = &subject.analysis.study;
    page.appendix("Details of the requirements");
    add_bandwidth(page, requirements, study);
    add_modes(page, requirements);
    if let Some(histories) = subject.histories {
        add_histories(page, histories);
    }
    let mut remarks = ConditionRemarks::default();
    for missing in &requirements.missing {
        remarks.add(missing.condition, missing_finding_text(missing));
    }
    for caution in &requirements.cautions {
        let words = reversed_phase_text(caution, &study.dataset);
        remarks.add(Some(caution.condition), words);
    }
    page.list(remarks.lines());
}

/// Adds the grid with all requirements for the conditions' own corrections and, if there is one,
/// for the schedule.
fn add_grids(
    page: &mut Page,
    requirements: &Requirements,
    histories: Option<&TimeHistories>,
    study: &Study,
) {
    let names = RequirementNames {
        dataset: &study.dataset,
        tolerances: &study.requirements.tolerances,
    };
    for role in [RequirementRole::Corrected, RequirementRole::Scheduled] {
        let has_model = requirements
            .summary
            .iter()
            .any(|finding| finding.role == role);
        if !has_model {
            continue;
        }
        let grid = RequirementGrid::new(&GridSource {
            requirements,
            histories,
            dataset: &study.dataset,
            settings: &study.requirements,
            role,
        });
        page.wide_table_behind(&grid_table(&grid, names), GRID_HEADS, COLUMNS);
    }
}

/// Adds bandwidth and phase delay for the responses where either is defined, and the reasons why
/// the other responses have none.
fn add_bandwidth(page: &mut Page, requirements: &Requirements, study: &Study) {
    let dataset = &study.dataset;
    page.subsection("Bandwidth and phase delay");
    page.paragraph(
        "For the attitude response to a stick (ADS-33E-PRF 3.3.2, 3.4.1; MIL-DTL-32742): the \
        bandwidth is the lower of the frequencies with 45\u{b0} of phase margin and with 6 dB of \
        gain margin; the phase delay is the phase lost from \u{3c9}180 to 2 \u{3c9}180, divided \
        by 2 \u{3c9}180. Levels depend on the mission task and the category; only those chosen by \
        the engineer are drawn.",
    );
    for source in level_sources(study) {
        page.paragraph(&source);
    }
    let mut with_bandwidth = requirements.clone();
    with_bandwidth.bandwidth.retain(is_defined);
    page.table(&bandwidth_table(
        &with_bandwidth,
        dataset,
        &study.requirements.levels,
    ));
    let mut remarks = ConditionRemarks::default();
    for finding in &requirements.bandwidth {
        if !is_defined(finding) {
            let why = finding.absent.get("omega_bw_rad_s");
            let words = format!(
                "{}: {}",
                dataset.pair_name(finding.pair),
                why.map(no_bandwidth_text).unwrap_or_default()
            );
            remarks.add(Some(finding.condition), words);
        }
    }
    page.list(remarks.lines());
}

/// Returns a line for each source of level boundaries, such as "Level 1 of R, Level 2 of R: …";
/// boundaries without a source are omitted.
fn level_sources(study: &Study) -> Vec<String> {
    let mut names_by_source: BTreeMap<&str, Vec<String>> = BTreeMap::new();
    for boundary in study.requirements.levels.as_slice() {
        if !boundary.source.is_empty() {
            let name = format!("{} of {}", boundary.name, boundary.axis);
            names_by_source
                .entry(&boundary.source)
                .or_default()
                .push(name);
        }
    }
    let mut lines = Vec::new();
    for (source, names) in names_by_source {
        lines.push(format!("{}: {source}", names.join(", ")));
    }
    lines
}

/// Returns whether the bandwidth or the phase delay is defined.
fn is_defined(finding: &BandwidthFinding) -> bool {
    finding.omega_bw_rad_s.is_some() || finding.phase_delay_s.is_some()
}

fn add_modes(page: &mut Page, requirements: &Requirements) {
    page.subsection("Modes");
    page.paragraph(
        "Modes of the identified representative and the corresponding modes of the physics \
        representative, with the tolerances of 14 CFR part 60, appendix C, table C2A, 2.c.3.a \
        and 2.d.3.a. Gains and delays do not move poles. Couplings do: if there are any, the \
        modes of the corrected model are also listed.",
    );
    let modes = requirements.modes.iter();
    let mut conditions: Vec<ConditionId> = modes.map(|finding| finding.condition).collect();
    conditions.dedup();
    for id in conditions {
        page.wide_table(&mode_table(requirements, id), COLUMNS);
    }
}

/// Compares time histories with the tolerances, and lists the records that are not compared.
fn add_histories(page: &mut Page, histories: &TimeHistories) {
    page.subsection("Time histories");
    let source = match histories.tolerance_table.source() {
        "" => "the engineer's table",
        source => source,
    };
    page.paragraph(&format!(
        "Share of time for which the models, driven by the recorded stick inputs, remain within \
        the tolerances ({source}) about the flight data: in windows of at most 10 s, each from \
        an estimated initial state and offsets, over all records of a condition. Attitudes are \
        integrals of body rates from the start of each window, which is valid for small angles."
    ));
    page.table(&tolerance_table(histories));
    if !histories.records.is_empty() {
        page.table(&share_table(histories));
        for (id, _) in histories.conditions() {
            page.table(&record_table(histories, id));
        }
    }
    let mut remarks = ConditionRemarks::default();
    for missing in &histories.missing {
        remarks.add(missing.condition, missing_reason_text(&missing.why));
    }
    page.list(remarks.lines());
}

/// Tabulates the tolerances with which the time histories were compared.
fn tolerance_table(histories: &TimeHistories) -> Table {
    let mut table = Table::new(
        "Tolerances",
        ["quantity", "from", "absolute", "relative [%]", "entry"],
    );
    for row in histories.tolerance_table.rows() {
        let from = if row.integrated {
            format!("integral of {}", row.channel)
        } else {
            row.channel.clone()
        };
        let absolute = format!("\u{b1}{} {}", row.absolute, row.unit);
        let relative = match row.relative {
            Some(share) => format!("\u{b1}{}", 100.0 * share),
            None => String::new(),
        };
        table.row([
            row.quantity.clone(),
            from,
            absolute,
            relative,
            row.entry.clone(),
        ]);
    }
    table
}

/// Distinct remarks, each with the conditions to which it applies; no conditions if it applies to
/// all.
#[derive(Default)]
struct ConditionRemarks {
    conditions_by_words: BTreeMap<String, Vec<ConditionId>>,
}

impl ConditionRemarks {
    /// Adds a remark on a condition, or on all conditions.
    fn add(&mut self, condition: Option<ConditionId>, words: String) {
        let conditions = self.conditions_by_words.entry(words).or_default();
        if let Some(id) = condition
            && !conditions.contains(&id)
        {
            conditions.push(id);
        }
    }

    /// Returns a line for each remark, in alphabetical order.
    fn lines(&self) -> Vec<String> {
        let mut lines = Vec::with_capacity(self.conditions_by_words.len());
        for (words, conditions) in &self.conditions_by_words {
            let ids: Vec<String> = conditions.iter().map(ToString::to_string).collect();
            lines.push(match ids.as_slice() {
                [] => format!("{words}."),
                [id] => format!("Condition {id}: {words}."),
                _ => format!("Conditions {}: {words}.", ids.join(", ")),
            });
        }
        lines
    }
}
