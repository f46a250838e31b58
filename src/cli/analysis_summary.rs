//! Summary printed by `gdcm analyze`: the verdict first, then the details.
//!
//! A section is a text of labelled lines and tables; texts from files are `sanitized`, which
//! removes control characters. With `--json` all output becomes one JSON object: sections add their
//! cautions to it with `keep_caution`, because the printed text contains them anyway.

use std::path::Path;

use gdcm_io::LoadedDataset;
use gdcm_io::files::corrections_file::{PHYSICS_FILE, RESULT_FILES};
use gdcm_io::report::assessment_sentence;
use gdcm_method::correction::delta::GainSource;
use gdcm_model::dataset::Dataset;
use gdcm_model::message_text::{sanitized, sanitized_path};
use gdcm_model::units::six_digits;
use gdcm_study::results::convention_doubt::ConventionDoubt;
use gdcm_study::results::coupling_remark_search::analysis_coupling_remarks;
use gdcm_study::results::remark_kind::RemarkKind;
use gdcm_study::{Analysis, AssessedCorrection, AssessmentTable, PhaseCorrection};
use gdcm_words::assessment::{held_out_verdict, not_assessed_text};
use gdcm_words::convention_doubt::doubt_text;
use gdcm_words::coupling_remark::coupling_remark_text;
use gdcm_words::couplings::{coupling_cost_table, coupling_matrix_tables, couplings_heading};
use gdcm_words::gain_source::gain_source_text;
use gdcm_words::verdict::{study_verdict_text, verdict_table};

use super::condition_summary::condition_section;
use super::evidence_summary::evidence_section;
use super::leave_one_out::nominal_choice;
use super::physics_summary::physics_section;
use super::printed_lines::{detail, indented, line};
use super::schedule_summary::schedule_section;
use super::shared_cautions::{cautions_section, coded_cautions};
use super::terminal::keep_caution;

/// Summary of an analysis, as printed.
pub(super) struct Summary {
    /// Verdict on the study and on each condition, one line each; assessment; caution codes.
    pub(super) verdict: String,
    /// Settings, each condition's results, cautions, schedule, and evidence.
    pub(super) details: String,
    /// Line that lists the output files.
    pub(super) written: String,
}

/// Returns the summary without the output files; adds its cautions to the JSON object.
pub(super) fn result_summary(analysis: &Analysis, loaded: &LoadedDataset) -> String {
    verdict_section(analysis, loaded) + &details(analysis)
}

impl Summary {
    /// Forms the summary, and adds the cautions to the JSON object.
    pub(super) fn new(analysis: &Analysis, loaded: &LoadedDataset, out: &Path) -> Self {
        Self {
            verdict: verdict_section(analysis, loaded),
            details: details(analysis),
            written: written_line(analysis, out),
        }
    }
}

/// Returns the summary's first half, which `--brief` prints alone.
fn verdict_section(analysis: &Analysis, loaded: &LoadedDataset) -> String {
    let dataset = &analysis.study.dataset;
    let name = format!("{}, {}", sanitized(dataset.name()), loaded.origin);
    let mut text = line("Dataset", &name);
    text += &line("Verdict", &study_verdict_text(analysis));
    let mut table = verdict_table(analysis);
    for cell in table.rows.iter_mut().flatten() {
        *cell = sanitized(cell);
    }
    text += &indented(&table, 2);
    text += &line("Assessment", &sanitized(&assessment_sentence(analysis)));
    text += &held_out_line(analysis);
    text + &caution_codes_line(analysis)
}

/// Returns the summary's second half, which `--brief` omits.
fn details(analysis: &Analysis) -> String {
    let mut text = "\n".to_owned();
    text += &settings_lines(analysis);
    text += &doubts_section(analysis);
    for condition in analysis.study.dataset.conditions() {
        text += "\n";
        text += &condition_section(analysis, condition);
    }
    text += &physics_section(analysis);
    text += &couplings_section(analysis);
    text += "\n";
    text += &cautions_section(analysis);
    text += &schedule_section(analysis);
    text += &left_out_lines(analysis);
    text + &evidence_section(analysis)
}

fn written_line(analysis: &Analysis, out: &Path) -> String {
    let mut names = RESULT_FILES.to_vec();
    if analysis.applied_physics().is_some() {
        names.push(PHYSICS_FILE);
    }
    let files = format!("{} in {}", names.join(", "), sanitized_path(out));
    line("Written", &files)
}

/// Lists the caution codes, each with its conditions; empty without cautions.
fn caution_codes_line(analysis: &Analysis) -> String {
    let mut entries = Vec::new();
    for coded in coded_cautions(analysis) {
        let ids: Vec<String> = coded.conditions.iter().map(ToString::to_string).collect();
        entries.push(match ids.as_slice() {
            [] => coded.code.to_owned(),
            [id] => format!("{} in condition {id}", coded.code),
            _ => format!("{} in conditions {}", coded.code, ids.join(", ")),
        });
    }
    if entries.is_empty() {
        return String::new();
    }
    line("Cautions", &format!("{}.", entries.join("; ")))
}

/// Returns the doubts about signs and units, and adds them to the JSON object.
fn doubts_section(analysis: &Analysis) -> String {
    let mut text = String::new();
    for doubt in &analysis.doubts {
        let words = doubt_words(doubt, &analysis.study.dataset);
        keep_caution("convention-doubt", &doubt.conditions, &words);
        text += &line("Caution", &sanitized(&words));
    }
    text
}

/// Describes a doubt about a channel's sign or unit, with the option that inverts the sign.
pub(super) fn doubt_words(doubt: &ConventionDoubt, dataset: &Dataset) -> String {
    let mut words = doubt_text(doubt, dataset);
    if let Some(channel) = doubt.channel_to_reverse() {
        let (inputs, outputs) = dataset.input_and_output_names();
        words += &format!(" (--sign {}=-1)", channel.name(&inputs, &outputs));
    }
    words
}

fn settings_lines(analysis: &Analysis) -> String {
    let study = &analysis.study;
    let settings = &study.settings;
    let band = format!(
        "{} to {} rad/s, {} frequencies; alpha {} (gains), {} (delays)",
        six_digits(settings.band.min()),
        six_digits(settings.band.max()),
        settings.points,
        six_digits(settings.alpha_gain),
        six_digits(settings.alpha_delay)
    );
    let mut text = line("Band", &band);
    if settings.gain_source != GainSource::default() {
        text += &line("G from", &gain_source_text(settings));
    }
    for reversed in study.reversed_channels() {
        let channel = sanitized(&reversed.channel);
        let words = format!(
            "the sign of {channel} is reversed in the {}",
            reversed.role.models()
        );
        text += &line("Sign", &words);
    }
    text += &line("Phase", &phase_words(analysis));
    text + &line("Held", &held_words(analysis))
}

/// Describes the phase correction: none, delays, or delays and lead filters.
fn phase_words(analysis: &Analysis) -> String {
    let settings = &analysis.study.settings;
    match settings.phase {
        PhaseCorrection::None => "not corrected".to_owned(),
        PhaseCorrection::Delay => {
            format!("corrected by delays; D is the {}", settings.delay_from)
        }
        PhaseCorrection::Lead => format!(
            "corrected by a delay or a lead filter per channel: order {}, n {} (--lead-n), R_max {} \
            (--lead-r-max)",
            settings.lead.order.number(),
            six_digits(settings.lead.pole),
            six_digits(settings.lead.limit)
        ),
    }
}

/// Lists the constrained responses.
fn held_words(analysis: &Analysis) -> String {
    let study = &analysis.study;
    let held: Vec<String> = study
        .settings
        .constrained
        .marked()
        .map(|pair| sanitized(&study.dataset.pair_name(pair)))
        .collect();
    if held.is_empty() {
        "none".to_owned()
    } else {
        held.join(", ")
    }
}

/// Explains the couplings, with their benefit and cost, and adds the cautions to the JSON object;
/// empty without couplings.
fn couplings_section(analysis: &Analysis) -> String {
    let remarks = analysis_coupling_remarks(analysis);
    if remarks.is_empty() {
        return String::new();
    }
    let mut text = "\n".to_owned();
    if let Some(assessment) = &analysis.coupling_assessment {
        text += &line("Couplings", &sanitized(&couplings_heading(assessment)));
        text += &indented(&coupling_cost_table(assessment), 2);
        for mut table in coupling_matrix_tables(assessment, &analysis.study.dataset) {
            for row in &mut table.rows {
                if let Some(name) = row.first_mut() {
                    *name = sanitized(name);
                }
            }
            for name in &mut table.columns {
                *name = sanitized(name);
            }
            text += &indented(&table, 2);
        }
    }
    for remark in &remarks {
        let sentence = coupling_remark_text(remark, &analysis.study.dataset);
        let label = match remark.kind() {
            RemarkKind::Good => "couplings",
            RemarkKind::Caution | RemarkKind::Trouble => {
                keep_caution(remark.code(), &[], &sentence);
                "caution"
            }
        };
        text += &detail(label, &sanitized(&sentence));
    }
    text
}

/// Lists the conditions that were not assessed, with the reasons.
fn left_out_lines(analysis: &Analysis) -> String {
    let mut text = String::new();
    let choice = nominal_choice(analysis, AssessedCorrection::Scheduled);
    for left_out in AssessmentTable::assess(analysis, choice).left_out {
        let why = sanitized(&not_assessed_text(&left_out.why, &analysis.study.dataset));
        let words = format!("condition {}: {why}", left_out.condition);
        text += &line("Left out", &words);
    }
    text
}

/// Returns the verdict on the schedule in the held-out conditions; empty without one.
fn held_out_line(analysis: &Analysis) -> String {
    let choice = nominal_choice(analysis, AssessedCorrection::Scheduled);
    match held_out_verdict(analysis, choice) {
        Some(words) => line("Held out", &words),
        None => String::new(),
    }
}
