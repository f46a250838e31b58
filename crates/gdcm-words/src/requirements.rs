//! Requirements as tables (M17): bandwidths, modes and summary costs.
//!
//! ```text
//! ω_BW       bandwidth
//! ω_phase    frequency with 45 deg of phase margin
//! ω_gain     frequency with 6 dB of gain margin
//! ω180, τ_p  frequency where the phase is -180 deg; phase delay
//! λ, ζ       pole and damping ratio of a mode
//! MUAD       maximum unnoticeable added dynamics: envelopes of a model's error
//! ```
//!
//! A *role* is a version of a condition's model: physics, corrected, scheduled or identified; a
//! *finding* is the result for a role.

use gdcm_method::requirements::{BandwidthRule, LevelBoundaries, ModeVerdict, NamedBy};
use gdcm_model::dataset::{ConditionId, Dataset};
use gdcm_model::number_format::{NO_VALUE, decimals_or_dash};
use gdcm_model::units::{s_to_ms, telling};
use gdcm_study::results::required_bandwidth::BandwidthFinding;
use gdcm_study::results::required_modes::{ModeFinding, ModeNumbers};
use gdcm_study::results::required_summary::SummaryFinding;
use gdcm_study::results::requirement_role::RequirementRole;
use gdcm_study::results::requirements::Requirements;
use gdcm_study::results::time_histories::TimeHistories;

use crate::missing_results::no_bandwidth_text;
use crate::requirement_grid::level_text;
use crate::table::Table;
use crate::time_histories::{cost_cells, cost_heads, output_weights_text};

/// Heading for the columns with a pole's modulus.
const MODULUS: &str = "|\u{3bb}| [rad/s]";

/// Tabulates every on-axis bandwidth and phase delay, with cautions; with the level if boundaries
/// give levels for any axis.
pub fn bandwidth_table(
    requirements: &Requirements,
    dataset: &Dataset,
    levels: &LevelBoundaries,
) -> Table {
    let has_levels = has_levels(requirements, levels);
    let mut columns = vec![
        "condition",
        "airspeed [kt]",
        "response",
        "model",
        "ω_BW [rad/s]",
        "ω_phase [rad/s]",
        "ω_gain [rad/s]",
        "ω180 [rad/s]",
        "τ_p [ms]",
    ];
    if has_levels {
        columns.push("level");
    }
    columns.push("remark");
    let mut table = Table::new("Bandwidth and phase delay of the attitudes", columns);
    for finding in &requirements.bandwidth {
        let mut cells = vec![
            finding.condition.to_string(),
            telling(finding.airspeed_kt, 0),
            dataset.pair_name(finding.pair),
            finding.role.name().to_owned(),
            decimals_or_dash(finding.omega_bw_rad_s, 2),
            decimals_or_dash(finding.omega_phase_rad_s, 2),
            decimals_or_dash(finding.omega_gain_rad_s, 2),
            decimals_or_dash(finding.omega_180_rad_s, 2),
            decimals_or_dash(finding.phase_delay_s.map(s_to_ms), 0),
        ];
        if has_levels {
            cells.push(level_text(finding.level(levels)));
        }
        cells.push(bandwidth_remark(finding));
        table.row(cells);
    }
    table
}

/// Returns whether boundaries give levels for any axis with a finding.
pub fn has_levels(requirements: &Requirements, levels: &LevelBoundaries) -> bool {
    requirements
        .bandwidth
        .iter()
        .any(|finding| levels.assesses(&finding.output))
}

/// Joins the remarks on a bandwidth: why it or the phase delay has no value; the rule that gives
/// it, if both have values or the gain margin limits it; that it depends on the model outside the
/// band; that the phase delay is from the least-squares line.
fn bandwidth_remark(finding: &BandwidthFinding) -> String {
    let mut words: Vec<String> = Vec::new();
    // By the names of the quantities in the file.
    let absent = finding
        .absent
        .get("omega_bw_rad_s")
        .or_else(|| finding.absent.get("phase_delay_s"));
    if let Some(why) = absent {
        words.push(no_bandwidth_text(why));
    }
    if let Some(rule) = finding.rule
        && (finding.gain_limited || words.is_empty())
    {
        let text = match rule {
            BandwidthRule::Gain => "gain-limited, which ADS-33E-PRF warns against",
            BandwidthRule::Phase => "from the phase margin",
            BandwidthRule::PhaseGainUnknown => "from the phase margin; the gain margin is unknown",
        };
        words.push(text.to_owned());
    }
    if !finding.rests_above_band.is_empty() {
        words.push("depends on the model above the band".to_owned());
    }
    if !finding.rests_below_band.is_empty() {
        words.push("depends on the model below the band".to_owned());
    }
    if finding.phase_delay_of_line {
        words.push("τ_p from the least-squares line".to_owned());
    }
    words.join("; ")
}

/// Tabulates a condition's modes: identified, physics, and physics with the study's couplings, if
/// any.
pub fn mode_table(requirements: &Requirements, condition: ConditionId) -> Table {
    let modes: Vec<&ModeFinding> = requirements
        .modes
        .iter()
        .filter(|mode| mode.condition == condition)
        .collect();
    let is_coupled = modes.iter().any(|mode| mode.corrected_verdict.is_some());
    let has_deviations = modes.iter().any(|mode| mode.identified_deviation.is_some());
    let deviations = if has_deviations {
        "standard deviations of the identified modes are available"
    } else {
        "standard deviations of the identified modes are unavailable (only models identified in the \
        window since it opened have them); modes below the band count as not determined"
    };
    let title = format!("Modes of condition {condition}; {deviations}");
    let mut table = Table::new(title, mode_columns(is_coupled));
    for mode in modes {
        table.row(mode_row(mode));
    }
    table
}

/// Returns the headings above [`mode_row`].
fn mode_columns(is_coupled: bool) -> Vec<String> {
    let heads = |model: &str| {
        [MODULUS, "\u{3b6}", "period [s]"].map(|quantity| format!("{model} {quantity}"))
    };
    let mut columns = vec!["mode".to_owned(), "named by".to_owned()];
    columns.extend(heads("flown"));
    columns.extend(heads("physics"));
    columns.push("physics: tolerance".to_owned());
    if is_coupled {
        columns.extend(heads("corrected"));
        columns.push("corrected: tolerance".to_owned());
    }
    columns
}

fn mode_row(mode: &ModeFinding) -> Vec<String> {
    let name = match mode.name {
        Some(name) => name.to_string(),
        None => format!("mode {}", mode.number),
    };
    let named_by = match mode.named_by {
        NamedBy::States => "states",
        _ => "frequency",
    };
    let entry = match &mode.tolerance {
        Some(tolerance) => format!(" ({})", tolerance.entry),
        None => String::new(),
    };
    let mut cells = vec![name, named_by.to_owned()];
    cells.extend(mode_cells(Some(&mode.identified)));
    cells.extend(mode_cells(mode.physics.as_ref()));
    cells.push(format!("{}{entry}", mode_verdict_words(mode.verdict)));
    if let Some(verdict) = mode.corrected_verdict {
        cells.extend(mode_cells(mode.corrected.as_ref()));
        cells.push(format!("{}{entry}", mode_verdict_words(verdict)));
    }
    cells
}

/// Formats a mode's modulus, damping ratio and period; dashes for missing values.
fn mode_cells(mode: Option<&ModeNumbers>) -> [String; 3] {
    [
        decimals_or_dash(
            mode.map(|mode| mode.pole_real_rad_s.hypot(mode.pole_imaginary_rad_s)),
            2,
        ),
        decimals_or_dash(mode.and_then(|mode| mode.values.damping_ratio), 2),
        decimals_or_dash(mode.and_then(|mode| mode.values.period_s), 1),
    ]
}

/// Returns the words for the verdict on a mode.
#[must_use]
pub fn mode_verdict_words(verdict: ModeVerdict) -> &'static str {
    match verdict {
        ModeVerdict::Within => "within",
        ModeVerdict::Outside => "outside",
        ModeVerdict::NotDetermined => "not determined by the flight data",
        ModeVerdict::NoTolerance => "no tolerance",
        ModeVerdict::NotPaired => "unpaired",
    }
}

/// Tabulates, for every condition and model, mean J and the share of the band inside the
/// unnoticeable envelopes; with flight records, also `J_rms` and Theil's coefficients.
pub fn summary_table(requirements: &Requirements, histories: Option<&TimeHistories>) -> Table {
    let histories = histories.filter(|histories| !histories.records.is_empty());
    let mut columns = [
        "condition",
        "airspeed [kt]",
        "model",
        "J, on-axis",
        "J, all responses",
        "in MUAD, on-axis [%]",
        "in MUAD, all responses [%]",
    ]
    .map(str::to_owned)
    .to_vec();
    let mut title = "Summary: models against flight".to_owned();
    if let Some(histories) = histories {
        columns.extend(cost_heads(histories));
        title.push_str(&format!(
            "; J_rms over all records of a condition, {}",
            output_weights_text(histories)
        ));
    }
    let mut table = Table::new(title, columns);
    for finding in &requirements.summary {
        let mut cells = summary_cells(finding);
        if let Some(histories) = histories {
            cells.extend(cost_cells(histories, finding.condition, finding.role));
        }
        table.row(cells);
    }
    if let Some(histories) = histories {
        add_identified_rows(&mut table, histories);
    }
    // By condition, the first column: the identified models' rows come last so far.
    table
        .rows
        .sort_by_key(|row| row[0].parse::<i64>().unwrap_or(i64::MAX));
    table
}

fn summary_cells(finding: &SummaryFinding) -> Vec<String> {
    let percent = |share: Option<f64>| decimals_or_dash(share.map(|share| 100.0 * share), 0);
    vec![
        finding.condition.to_string(),
        telling(finding.airspeed_kt, 0),
        finding.role.name().to_owned(),
        decimals_or_dash(finding.mean_j_on_axis, 1),
        decimals_or_dash(finding.mean_j_all, 1),
        percent(finding.muad_share_on_axis),
        percent(finding.muad_share_all),
    ]
}

/// Adds rows for the identified models. These are the reference for the other models, so that only
/// their time histories have results.
fn add_identified_rows(table: &mut Table, histories: &TimeHistories) {
    let role = RequirementRole::Identified;
    for finding in &histories.records {
        if finding.role != role {
            continue;
        }
        let mut row = vec![
            finding.condition.to_string(),
            telling(finding.airspeed_kt, 0),
            role.name().to_owned(),
        ];
        row.extend([NO_VALUE; 4].map(str::to_owned));
        row.extend(cost_cells(histories, finding.condition, role));
        if !table.rows.contains(&row) {
            table.row(row);
        }
    }
}

/// Returns the summary for a row in [`summary_table`]; `None` for the identified model, which is
/// the reference for the others.
pub fn summary_of_row<'a>(
    requirements: &'a Requirements,
    row: &[String],
) -> Option<&'a SummaryFinding> {
    let [condition, _, role, ..] = row else {
        return None;
    };
    requirements
        .summary
        .iter()
        .find(|finding| finding.condition.to_string() == *condition && finding.role.name() == role)
}
