//! Part about physics parameters in the summary printed by `gdcm analyze` (M18).
//!
//! A *run* is a physics model linearised with one parameter changed, from which the diagnosis finds
//! the change that each parameter needs; a *rerun* has several changed, to check the prediction. A
//! *pull* is the change in a value if a condition is left out of the fit.

use gdcm_method::physics::OfferedParameter;
use gdcm_model::message_text::sanitized;
use gdcm_model::number_format::counted;
use gdcm_study::Analysis;
use gdcm_study::results::physics_findings::PhysicsFindings;
use gdcm_words::Table;
use gdcm_words::physics::{
    BARS_KEEP_VALUES, applied_value_list, channel_delay_table, diagnosis_cautions, left_out_lines,
    parameter_table, paste_block, physics_cost_table, pull_lines, rerun_text, verdict_text,
};

use super::printed_lines::{detail, indented, line};
use super::terminal::keep_caution;

/// Code for the caution about a value set by hand for a parameter that the dataset lacks.
const UNKNOWN_PARAMETER: &str = "unknown-parameter";
/// Code for the cautions about the diagnosis.
const DIAGNOSIS: &str = "physics-diagnosis";

/// Returns the section on the physics parameters:
///
/// - if the study applies none, a hint that the dataset has runs; empty without runs;
/// - if the parameters are unavailable, the reason, and the data that were left out;
/// - else diagnosis or "set by hand", applied values, benefit, reruns, and the values to paste into
///   the input of the physics model.
pub(super) fn physics_section(analysis: &Analysis) -> String {
    let applied = match &analysis.physics {
        None => return unused_runs_line(analysis),
        Some(Err(failure)) => {
            let words = failure.to_string();
            keep_caution(failure.code(), &[], &words);
            let mut text = format!("\n{}", line("Physics", &sanitized(&words)));
            for words in failure.left_out().map(left_out_lines).unwrap_or_default() {
                text += &detail("", &sanitized(&words));
            }
            return text;
        }
        Some(Ok(applied)) => applied,
    };
    let mut text = "\n".to_owned();
    match &applied.findings {
        Some(findings) => text += &findings_section(analysis, findings),
        None => text += &line("Physics", "values set by hand; nothing is fitted"),
    }
    let values = applied_value_list(applied);
    let words = if values.is_empty() {
        "none: the physics models are those of the dataset".to_owned()
    } else {
        values.join(", ")
    };
    text += &detail("applied", &sanitized(&words));
    for name in &applied.unknown {
        let words = format!(
            "the dataset has no physics model linearised with {name} changed; its value has no effect"
        );
        keep_caution(UNKNOWN_PARAMETER, &[], &words);
        text += &detail("caution", &sanitized(&words));
    }
    if let Some(assessment) = &analysis.physics_assessment {
        text += &indented(&physics_cost_table(assessment), 2);
        let (inputs, outputs) = analysis.study.dataset.input_and_output_names();
        let delays = channel_delay_table(assessment, &inputs, &outputs);
        text += &indented(&sanitized_table(delays), 2);
        for check in &assessment.reruns {
            text += &detail("rerun", &sanitized(&rerun_text(check)));
        }
    }
    if !values.is_empty() {
        text += &detail("bars", BARS_KEEP_VALUES);
        text += "\nTo paste into the input of the physics model:\n";
        for block_line in paste_block(applied).lines() {
            text += &format!("  {}\n", sanitized(block_line));
        }
    }
    text
}

/// Returns the codes of all cautions in the section on the physics parameters.
pub(super) fn physics_caution_codes(analysis: &Analysis) -> Vec<&'static str> {
    let applied = match &analysis.physics {
        None => return Vec::new(),
        Some(Err(failure)) => return vec![failure.code()],
        Some(Ok(applied)) => applied,
    };
    let mut codes = Vec::new();
    if let Some(findings) = &applied.findings
        && !diagnosis_cautions(findings).is_empty()
    {
        codes.push(DIAGNOSIS);
    }
    if !applied.unknown.is_empty() {
        codes.push(UNKNOWN_PARAMETER);
    }
    codes
}

/// Returns verdict, parameter table, cautions, the data that take no part in the fit, and the
/// conditions that change a value most.
fn findings_section(analysis: &Analysis, findings: &PhysicsFindings) -> String {
    let level = analysis.study.settings.uncertainty.level;
    let mut text = line("Physics", &sanitized(&verdict_text(findings)));
    text += &indented(&sanitized_table(parameter_table(findings, level)), 2);
    for words in diagnosis_cautions(findings) {
        keep_caution(DIAGNOSIS, &[], &words);
        text += &detail("caution", &sanitized(&words));
    }
    for words in left_out_lines(&findings.left_out) {
        text += &detail("not used", &sanitized(&words));
    }
    for words in pull_lines(findings) {
        text += &detail("pull", &sanitized(&words));
    }
    text
}

/// Returns the table with printable cells.
fn sanitized_table(mut table: Table) -> Table {
    for row in &mut table.rows {
        for cell in row {
            *cell = sanitized(cell);
        }
    }
    table
}

/// Returns a hint that the dataset has runs; empty if it has none.
fn unused_runs_line(analysis: &Analysis) -> String {
    let count = OfferedParameter::list(&analysis.study.dataset).len();
    if count == 0 {
        return String::new();
    }
    let words = format!(
        "the dataset has physics models with {} changed, which are not used; --physics named shows which need a change",
        counted(count, "parameter")
    );
    format!("\n{}", line("Physics", &words))
}
