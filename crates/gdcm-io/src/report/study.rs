//! Report sections on the study as a whole: results, settings, sources, and excluded models.

use std::collections::BTreeMap;

use gdcm_method::fidelity::SUGGESTION_RATIO;
use gdcm_method::schedule::{ScheduleKind, ScheduleSettings};
use gdcm_model::dataset::model::Provenance;
use gdcm_model::dataset::{BundleKind, Channel, Condition, Dataset, ModelId, PairTable};
use gdcm_model::number_format::decimals;
use gdcm_model::units::{number, six_digits};
use gdcm_plot::figure::assessment::usual_choice;
use gdcm_plot::figure::condition_source::quantity_symbol;
use gdcm_study::decisions::setting;
use gdcm_study::decisions::setting::SETTINGS;
use gdcm_study::results::caution::Caution;
use gdcm_study::{Analysis, AssessmentTable, ConditionAnalysis, Study};
use gdcm_words::Table;
use gdcm_words::assessment::summary_text;
use gdcm_words::caution::{caution_text, failure_text};

use super::assessment::capital;
use super::conditions::proof_word;
use super::page::{NAMES_SHOWN, Page, names};
use super::{PROGRAM, ReportSource};

/// Adds the summary of the results.
pub(super) fn add_summary(page: &mut Page, analysis: &Analysis) {
    page.section("Summary");
    let conditions = analysis.study.dataset.conditions();
    let mut solved = 0;
    let mut rejected = 0;
    let mut failures = Vec::new();
    for condition in conditions {
        let id = condition.id();
        rejected += analysis.study.rejected_names(id).len();
        if analysis.condition(id).is_some() {
            solved += 1;
        }
        if let Some(Err(failure)) = analysis.conditions.get(&id) {
            let why = failure_text(failure, &analysis.study.dataset);
            failures.push(format!("Condition {id} has no result: {why}."));
        }
    }
    let scheduled = analysis.scheduled().len();
    page.paragraph(&format!(
        "{solved} of {} conditions have a result; the schedule is fitted to {scheduled} of them; \
        {rejected} models are rejected.",
        conditions.len()
    ));
    page.paragraph(&assessment_sentence(analysis));
    page.list(failures);
    page.table(&condition_table(analysis));
}

/// Returns a sentence on the change of J of the nominal models due to the schedule.
pub fn assessment_sentence(analysis: &Analysis) -> String {
    let dataset = &analysis.study.dataset;
    let measuring = dataset.measuring_pairs();
    let which = if dataset.on_axis().marked().next().is_some() {
        "on-axis responses"
    } else {
        "responses"
    };
    let table = AssessmentTable::of(analysis, usual_choice(analysis));
    let found = summary_text(&table.summary(&measuring), dataset);
    let fails_between = match &analysis.schedule {
        Ok(schedule) => schedule.interpolation_fails(),
        Err(_) => false,
    };
    let between = if fails_between {
        " Between the conditions' airspeeds the schedule must not be used (see its cautions)."
    } else {
        ""
    };
    format!(
        "J of the nominal models with the schedule, over the {which} of all assessed conditions: {found}.{between}"
    )
}

/// Placeholder for a missing value in tables.
const MISSING: &str = "–";

fn condition_table(analysis: &Analysis) -> Table {
    let title = "Conditions: kept models, matched held responses, and whether the gains are \
        proven optimal";
    let columns = [
        "condition",
        "name",
        "V [kt]",
        "physics",
        "identified",
        "gains",
        "delays",
        "optimum",
        "scheduled",
    ];
    let mut table = Table::new(title, columns);
    for condition in analysis.study.dataset.conditions() {
        let state = condition.flight_state();
        let result = analysis.condition(condition.id());
        let (gains, delays, optimum) = match result {
            Some(result) => (
                matched_words(result, result.gains.unmatched.len()),
                matched_words(result, result.delays.unmatched.len()),
                proof_word(result),
            ),
            None => (MISSING.to_owned(), MISSING.to_owned(), "no result"),
        };
        let scheduled = result.is_some() && analysis.study.choice(condition.id()).scheduled;
        table.row([
            state.id.to_string(),
            state.name.clone(),
            number(state.airspeed_kt),
            kept_words(&analysis.study, condition, BundleKind::Physics),
            kept_words(&analysis.study, condition, BundleKind::Identified),
            gains,
            delays,
            optimum.to_owned(),
            if scheduled { "yes" } else { "no" }.to_owned(),
        ]);
    }
    table
}

/// Returns how many models of a bundle are kept: "8 of 9".
fn kept_words(study: &Study, condition: &Condition, kind: BundleKind) -> String {
    let models = condition.bundle(kind);
    let rejected = &study.choice(condition.id()).bundle(kind).rejected;
    let kept = models
        .iter()
        .filter(|model| !rejected.contains(&model.name))
        .count();
    format!("{kept} of {}", models.len())
}

/// Returns how many of the constrained responses satisfy their constraint: "4 of 5".
fn matched_words(result: &ConditionAnalysis, unmatched: usize) -> String {
    let held = result.held().marked().count();
    format!("{} of {held}", held.saturating_sub(unmatched))
}

/// Adds the section on the settings: constrained and ignored responses, then every setting that
/// affects the results.
pub(super) fn add_settings(page: &mut Page, study: &Study) {
    page.section("Settings");
    let settings = &study.settings;
    let dataset = &study.dataset;
    page.facts([
        ("On-axis responses", pair_names(dataset, dataset.on_axis())),
        ("Held exactly", pair_names(dataset, &settings.constrained)),
        (
            "Ignored in the objective",
            pair_names(dataset, &settings.ignored),
        ),
    ]);
    let mut facts: Vec<(String, String)> = Vec::new();
    for row in SETTINGS {
        if !(row.control.applies)(study) {
            continue;
        }
        let words = if *row == setting::GAIN_SOURCE {
            settings.gain_source_words()
        } else {
            row.words(settings)
        };
        facts.push((capital(row.name), words));
    }
    page.facts(
        facts
            .iter()
            .map(|(name, words)| (name.as_str(), words.clone())),
    );
}

/// Lists the marked responses by name.
fn pair_names(dataset: &Dataset, marked: &PairTable<bool>) -> String {
    let pairs: Vec<String> = marked
        .marked()
        .map(|pair| dataset.pair_name(pair))
        .collect();
    if pairs.is_empty() {
        "none".to_owned()
    } else {
        names(&pairs)
    }
}

/// Describes the kind, degree and variables of a schedule.
pub(super) fn schedule_words(settings: &ScheduleSettings) -> String {
    let kind = match settings.kind {
        ScheduleKind::Polynomial { degree } => format!("polynomial of degree {degree} in airspeed"),
        ScheduleKind::Table => "table over airspeed, linear between its points".to_owned(),
    };
    let quantity = quantity_symbol(settings.quantity);
    let delays = if settings.delays {
        "delays are scheduled too"
    } else {
        "delays are not scheduled"
    };
    let second = match settings.second {
        Some(variable) => format!(" and {variable}"),
        None => String::new(),
    };
    format!(
        "{kind}{second}, of {quantity}; airspeeds within {} kt count as equal; {delays}",
        six_digits(settings.airspeed_tolerance_kt)
    )
}

/// Adds the section on the files of the study and the dataset.
pub(super) fn add_files(page: &mut Page, study: &Study, source: &ReportSource) {
    page.section("Provenance");
    let dataset = &study.dataset;
    let study_file = match &source.study {
        Some(file) => file.clone(),
        None => "not saved in a file".to_owned(),
    };
    page.facts([
        ("Dataset", dataset.name().to_owned()),
        ("Dataset file", source.dataset.clone()),
        ("SHA-256 of the dataset file", source.sha256.clone()),
        ("Study", study_file),
        ("Program", PROGRAM.to_owned()),
        ("Inputs", channel_words(dataset.inputs())),
        ("Outputs", channel_words(dataset.outputs())),
    ]);
    for line in dataset.description().lines() {
        if !line.trim().is_empty() {
            page.paragraph(line);
        }
    }
    let cautions = source.cautions.iter();
    page.list(cautions.map(|caution| format!("Caution about the file: {caution}.")));
}

/// Lists channels with their units: "LON [%], LAT [%]".
fn channel_words(channels: &[Channel]) -> String {
    let words: Vec<String> = channels
        .iter()
        .map(|channel| format!("{} [{}]", channel.name, channel.unit))
        .collect();
    words.join(", ")
}

/// Adds the section on the source files of the models, if the dataset records any.
pub(super) fn add_models(page: &mut Page, study: &Study) {
    let mut models: BTreeMap<[String; 5], Vec<String>> = BTreeMap::new();
    let mut unknown = 0;
    for condition in study.dataset.conditions() {
        for kind in BundleKind::BOTH {
            for model in condition.bundle(kind) {
                let Some(source) = &model.source else {
                    unknown += 1;
                    continue;
                };
                let models_of_file = models.entry(source_cells(source)).or_default();
                models_of_file.push(format!("{}: {}", condition.id(), model.name));
            }
        }
    }
    page.section("Sources of the models");
    if models.is_empty() {
        page.paragraph("The dataset does not state the source files of its models.");
        return;
    }
    let columns = [
        "file",
        "SHA-256",
        "variable",
        "made",
        "note",
        "models, by condition",
    ];
    let mut table = Table::new("Source files of the models", columns);
    for (cells, models) in models {
        table.row(cells.into_iter().chain([names(&models)]));
    }
    page.table(&table);
    if unknown > 0 {
        page.paragraph(&format!(
            "The dataset does not state the source of {unknown} models."
        ));
    }
}

/// Returns the table cells of a model's source: file, hash, variable (or records), date and note.
fn source_cells(source: &Provenance) -> [String; 5] {
    let Provenance {
        file,
        sha256,
        variable,
        made,
        note,
        records,
        ..
    } = source;
    let mut variable = variable.clone();
    if variable.is_none() && !records.is_empty() {
        variable = Some(format!("records {}", records.join(", ")));
    }
    [file, sha256, &variable, made, note].map(|part| part.clone().unwrap_or_default())
}

const NO_REASON: &str = "no reason was given";

/// Adds the section on excluded models: rejected ones with the analyst's reasons, those excluded by
/// the analysis, and suspected ones.
pub(super) fn add_left_out(page: &mut Page, analysis: &Analysis) {
    page.section("Models left out");
    let rejected = rejected_table(analysis);
    if rejected.rows.is_empty() {
        page.paragraph("No model is rejected.");
    } else {
        page.paragraph(&format!(
            "Only the analyst can reject a model. A discontinuity ratio above {SUGGESTION_RATIO} \
            makes a model suspect."
        ));
    }
    page.table(&rejected);
    let mut lines = Vec::new();
    for condition in analysis.study.dataset.conditions() {
        lines.extend(left_out_lines(analysis, condition));
    }
    page.list(lines);
}

fn rejected_table(analysis: &Analysis) -> Table {
    let columns = [
        "condition",
        "bundle",
        "model",
        "discontinuity ratio",
        "analyst's reason",
    ];
    let mut table = Table::new("Rejected models", columns);
    for condition in analysis.study.dataset.conditions() {
        for kind in BundleKind::BOTH {
            rejected_rows(analysis, condition, kind, &mut table);
        }
    }
    table
}

/// Adds a row for each rejected model. Of the models rejected without a reason, only the first
/// [`NAMES_SHOWN`] are listed; the others are counted.
fn rejected_rows(analysis: &Analysis, condition: &Condition, kind: BundleKind, table: &mut Table) {
    let study = &analysis.study;
    let result = analysis.condition(condition.id());
    let mut without_reason = 0;
    for model in condition.bundle(kind) {
        let id = ModelId::new(condition.id(), kind, &model.name);
        if !study.is_rejected(&id) {
            continue;
        }
        let reason = study.reason(&id);
        if reason.is_none() {
            without_reason += 1;
            if without_reason > NAMES_SHOWN {
                continue;
            }
        }
        let ratio = match result {
            Some(result) if kind == BundleKind::Physics => result.discontinuity_ratio(&model.name),
            _ => None,
        };
        table.row([
            condition.id().to_string(),
            kind.to_string(),
            model.name.clone(),
            ratio.map_or(MISSING.to_owned(), |ratio| decimals(ratio, 2)),
            reason.unwrap_or(NO_REASON).to_owned(),
        ]);
    }
    if without_reason > NAMES_SHOWN {
        table.row([
            condition.id().to_string(),
            kind.to_string(),
            format!("{} more", without_reason - NAMES_SHOWN),
            MISSING.to_owned(),
            NO_REASON.to_owned(),
        ]);
    }
}

/// Describes the models of a condition that are excluded by the analysis, suspected but kept, or
/// pinned by the analyst.
fn left_out_lines(analysis: &Analysis, condition: &Condition) -> Vec<String> {
    let study = &analysis.study;
    let id = condition.id();
    let Some(result) = analysis.condition(id) else {
        return Vec::new();
    };
    let mut lines = Vec::new();
    let mut set_aside = 0;
    for caution in &result.cautions {
        if let Caution::SetAside { .. } = caution {
            set_aside += 1;
            if set_aside <= NAMES_SHOWN {
                let words = caution_text(caution, |pair| study.dataset.pair_name(pair));
                lines.push(format!("Condition {id}: {words}."));
            }
        }
    }
    if set_aside > NAMES_SHOWN {
        let more = set_aside - NAMES_SHOWN;
        lines.push(format!("Condition {id}: {more} more models are set aside."));
    }
    let rejected = &study.choice(id).physics.rejected;
    let mut kept = result.suggested();
    kept.retain(|name| !rejected.contains(name));
    if !kept.is_empty() {
        lines.push(format!(
            "Condition {id}: suspect because of their discontinuity ratios, but kept: {}.",
            names(&kept)
        ));
    }
    for kind in BundleKind::BOTH {
        if let Some(pinned) = &study.choice(id).bundle(kind).pinned {
            lines.push(format!(
                "Condition {id}: the analyst chose \"{pinned}\" to represent the {kind} models."
            ));
        }
    }
    lines
}
