//! The study as a whole: its results, its settings, the sources of its numbers, and the excluded
//! models.

use std::collections::BTreeMap;

use gdcm_method::fidelity::SUGGESTION_RATIO;
use gdcm_method::schedule::{Schedule, ScheduleKind, ScheduleSettings};
use gdcm_model::dataset::model::Provenance;
use gdcm_model::dataset::{BundleKind, Channel, Condition, ModelId, Pair, PairTable};
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

/// Adds a summary of the results.
pub(super) fn add_summary(page: &mut Page, analysis: &Analysis) {
    page.section("Summary");
    let conditions = analysis.study.dataset.conditions();
    let solved = conditions
        .iter()
        .filter(|condition| analysis.condition(condition.id()).is_some())
        .count();
    let rejected: usize = conditions
        .iter()
        .map(|of| analysis.study.rejected_names(of.id()).len())
        .sum();
    let scheduled = analysis.scheduled().len();
    page.paragraph(&format!(
        "{solved} of {} conditions have a result, {scheduled} of them make the schedule; {rejected} models are rejected.",
        conditions.len()
    ));
    page.paragraph(&assessment_sentence(analysis));
    let without = conditions.iter().filter_map(|condition| {
        let failure = analysis.conditions.get(&condition.id())?.as_ref().err()?;
        Some(format!(
            "Condition {} has no result: {}.",
            condition.id(),
            failure_text(failure, &analysis.study.dataset)
        ))
    });
    page.list(without);
    page.table(&condition_table(analysis));
}

/// Describes the value of the schedule for the nominal models in a sentence.
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
    let between = if analysis
        .schedule
        .as_ref()
        .is_ok_and(Schedule::interpolation_fails)
    {
        " Between the conditions' airspeeds the schedule must not be used (see its cautions)."
    } else {
        ""
    };
    format!(
        "J of the nominal models under the schedule, over the {which} of every condition assessed: {found}.{between}"
    )
}

fn condition_table(analysis: &Analysis) -> Table {
    let title = "The conditions: models kept of those there are, held responses matched of those held, and how sure the gains are";
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
        let [gains, delays] = result.map_or(["–".to_owned(), "–".to_owned()], matched);
        let scheduled = result.is_some() && analysis.study.choice(condition.id()).scheduled;
        table.row([
            state.id.to_string(),
            state.name.clone(),
            number(state.airspeed_kt),
            kept(&analysis.study, condition, BundleKind::Physics),
            kept(&analysis.study, condition, BundleKind::Identified),
            gains,
            delays,
            result.map_or("no result", proof_word).to_owned(),
            if scheduled { "yes" } else { "no" }.to_owned(),
        ]);
    }
    table
}

fn kept(study: &Study, condition: &Condition, kind: BundleKind) -> String {
    let models = condition.bundle(kind);
    let rejected = &study.choice(condition.id()).bundle(kind).rejected;
    let kept = models
        .iter()
        .filter(|model| !rejected.contains(&model.name))
        .count();
    format!("{kept} of {}", models.len())
}

/// Returns the numbers of matched gains and delays among the constrained ones.
fn matched(result: &ConditionAnalysis) -> [String; 2] {
    let held = result.held().marked().count();
    let of = |unmatched: usize| format!("{} of {held}", held.saturating_sub(unmatched));
    [
        of(result.gains.unmatched.len()),
        of(result.delays.unmatched.len()),
    ]
}

/// Adds the section on the settings: constrained and ignored responses, then every setting that has
/// an effect.
pub(super) fn add_settings(page: &mut Page, study: &Study) {
    page.section("Settings");
    let settings = &study.settings;
    let dataset = &study.dataset;
    let pairs = |marked: &PairTable<bool>| {
        let found: Vec<String> = marked
            .marked()
            .map(|pair: Pair| dataset.pair_name(pair))
            .collect();
        if found.is_empty() {
            "none".to_owned()
        } else {
            names(&found)
        }
    };
    page.facts([
        ("On-axis responses", pairs(dataset.on_axis())),
        ("Held exactly", pairs(&settings.constrained)),
        ("Ignored in the objective", pairs(&settings.ignored)),
    ]);
    let in_effect = SETTINGS
        .into_iter()
        .filter(|setting| (setting.control.applies)(study));
    let words = in_effect.map(|row| {
        let words = if *row == setting::GAIN_SOURCE {
            settings.gain_source_words()
        } else {
            row.words(settings)
        };
        (capital(row.name), words)
    });
    let words: Vec<(String, String)> = words.collect();
    page.facts(
        words
            .iter()
            .map(|(name, words)| (name.as_str(), words.clone())),
    );
}

/// Describes the form of a schedule.
pub(super) fn schedule_words(settings: &ScheduleSettings) -> String {
    let kind = match settings.kind {
        ScheduleKind::Polynomial { degree } => format!("polynomial of degree {degree} in airspeed"),
        ScheduleKind::Table => "table over airspeed, linear between its points".to_owned(),
    };
    let of = quantity_symbol(settings.quantity);
    let delays = if settings.delays {
        "delays are scheduled too"
    } else {
        "delays are not scheduled"
    };
    let second = settings
        .second
        .map_or_else(String::new, |variable| format!(" and {variable}"));
    format!(
        "{kind}{second}, of {of}; airspeeds within {} kt are one; {delays}",
        six_digits(settings.airspeed_tolerance_kt)
    )
}

/// Adds the section on the files of the study.
pub(super) fn add_files(page: &mut Page, study: &Study, source: &ReportSource) {
    page.section("Provenance");
    let channels = |all: &[Channel]| {
        let all: Vec<String> = all
            .iter()
            .map(|channel| format!("{} [{}]", channel.name, channel.unit))
            .collect();
        all.join(", ")
    };
    let dataset = &study.dataset;
    page.facts([
        ("Dataset", dataset.name().to_owned()),
        ("Its file", source.dataset.clone()),
        ("SHA-256 of that file", source.sha256.clone()),
        (
            "Study",
            source
                .study
                .clone()
                .unwrap_or_else(|| "not saved in a file".to_owned()),
        ),
        ("Program", PROGRAM.to_owned()),
        ("Inputs", channels(dataset.inputs())),
        ("Outputs", channels(dataset.outputs())),
    ]);
    dataset
        .description()
        .lines()
        .filter(|line| !line.trim().is_empty())
        .for_each(|line| page.paragraph(line));
    page.list(
        source
            .cautions
            .iter()
            .map(|caution| format!("Caution about the file: {caution}.")),
    );
}

/// Adds the section on the source files of the models, if any is known.
pub(super) fn add_models(page: &mut Page, study: &Study) {
    let mut models: BTreeMap<[String; 5], Vec<String>> = BTreeMap::new();
    let mut unknown = 0;
    for condition in study.dataset.conditions() {
        for model in BundleKind::BOTH
            .into_iter()
            .flat_map(|kind| condition.bundle(kind))
        {
            match &model.source {
                Some(source) => {
                    models
                        .entry(source_cells(source))
                        .or_default()
                        .push(format!("{}: {}", condition.id(), model.name));
                }
                None => unknown += 1,
            }
        }
    }
    page.section("Sources of the models");
    if models.is_empty() {
        page.paragraph("The dataset does not say which files its models were made from.");
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
    let mut table = Table::new("The files that the models were made from", columns);
    for (cells, of) in models {
        table.row(cells.into_iter().chain([names(&of)]));
    }
    page.table(&table);
    if unknown > 0 {
        page.paragraph(&format!("Of {unknown} models the dataset does not say."));
    }
}

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
    let records = Some(format!("records {}", records.join(", "))).filter(|_| !records.is_empty());
    let variable = variable.clone().or(records);
    [file, sha256, &variable, made, note].map(|part| part.clone().unwrap_or_default())
}

const NO_REASON: &str = "no reason was given";

/// Adds the models without influence: rejected ones with the analyst's reasons, those set aside,
/// and the suspected ones.
pub(super) fn add_left_out(page: &mut Page, analysis: &Analysis) {
    page.section("Models left out");
    let rejected = rejected_table(analysis);
    if rejected.rows.is_empty() {
        page.paragraph("No model is rejected.");
    } else {
        page.paragraph(&format!(
            "Only the analyst rejects a model. A discontinuity ratio above {SUGGESTION_RATIO} makes it suspect."
        ));
    }
    page.table(&rejected);
    let lines: Vec<String> = analysis
        .study
        .dataset
        .conditions()
        .iter()
        .flat_map(|of| left_out_lines(analysis, of))
        .collect();
    page.list(lines);
}

fn rejected_table(analysis: &Analysis) -> Table {
    let columns = [
        "condition",
        "bundle",
        "model",
        "discontinuity ratio",
        "reason of the analyst",
    ];
    let mut table = Table::new("Rejected models", columns);
    for condition in analysis.study.dataset.conditions() {
        for kind in BundleKind::BOTH {
            rejected_rows(analysis, condition, kind, &mut table);
        }
    }
    table
}

/// Adds a row for each rejected model; among many without a reason, the last are only counted.
fn rejected_rows(analysis: &Analysis, condition: &Condition, kind: BundleKind, table: &mut Table) {
    let study = &analysis.study;
    let id = |name: &str| ModelId::new(condition.id(), kind, name);
    let result = analysis.condition(condition.id());
    let rejected = condition
        .bundle(kind)
        .iter()
        .filter(|model| study.is_rejected(&id(&model.name)));
    let mut bare = 0;
    let mut more = 0;
    for model in rejected {
        let reason = study.reason(&id(&model.name));
        bare += usize::from(reason.is_none());
        if reason.is_none() && bare > NAMES_SHOWN {
            more += 1;
            continue;
        }
        let ratio = result.filter(|_| kind == BundleKind::Physics);
        let ratio = ratio.and_then(|result| result.discontinuity_ratio(&model.name));
        let ratio = ratio.map_or("–".to_owned(), |ratio| decimals(ratio, 2));
        let reason = reason.unwrap_or(NO_REASON).to_owned();
        table.row([
            condition.id().to_string(),
            kind.to_string(),
            model.name.clone(),
            ratio,
            reason,
        ]);
    }
    if more > 0 {
        let model = format!("{more} more");
        table.row([
            condition.id().to_string(),
            kind.to_string(),
            model,
            "–".to_owned(),
            NO_REASON.to_owned(),
        ]);
    }
}

/// Describes the models of a condition that are set aside, those suspected but kept, and the pinned
/// ones.
fn left_out_lines(analysis: &Analysis, condition: &Condition) -> Vec<String> {
    let study = &analysis.study;
    let id = condition.id();
    let Some(result) = analysis.condition(id) else {
        return Vec::new();
    };
    let aside = result
        .cautions
        .iter()
        .filter(|caution| matches!(caution, Caution::SetAside { .. }));
    let aside: Vec<String> = aside
        .map(|caution| caution_text(caution, |pair| study.dataset.pair_name(pair)))
        .collect();
    let more = aside.len().saturating_sub(NAMES_SHOWN);
    let mut lines: Vec<String> = aside
        .into_iter()
        .take(NAMES_SHOWN)
        .map(|words| format!("Condition {id}: {words}."))
        .collect();
    if more > 0 {
        lines.push(format!("Condition {id}: {more} more models are set aside."));
    }
    let rejected = &study.choice(id).physics.rejected;
    let kept: Vec<String> = result
        .suggested()
        .into_iter()
        .filter(|name| !rejected.contains(name))
        .collect();
    if !kept.is_empty() {
        lines.push(format!(
            "Condition {id}: suspected by their discontinuity ratios, and kept: {}.",
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
