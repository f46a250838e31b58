//! How sure the figures are, and how the schedule fares on what it has not seen, for a person to read.

use gdcm_core::message_text::sanitized;
use gdcm_core::study::{
    Analysis, AssessedCorrection, AssessedModel, AssessmentChoice, AssessmentTable, Table, held_out_verdict,
    scatter_table,
};

use super::sections::figure;
use super::summary::LABEL;
use super::text_table::{Side, TextTable, labelled};

/// What the scatter is made of, the differences at equal airspeed, and the second variables; nothing where bars were not computed.
pub(super) fn evidence_section(analysis: &Analysis) -> String {
    let Some(uncertainty) = &analysis.uncertainty else { return String::new() };
    let pair_name = |pair| sanitized(&analysis.study.dataset.pair_name(pair));
    let level = 100.0 * uncertainty.level;
    let mut text = labelled(0, "Scatter", LABEL, "of the on-axis net gains, and what the bundles make of it:");
    let table = Table { title: String::new(), ..scatter_table(&analysis.study.dataset, uncertainty) };
    table.text().lines().for_each(|line| text.push_str(&format!("  {}\n", sanitized(line))));
    let significant = uncertainty.differences.iter().filter(|difference| difference.is_significant(uncertainty.level));
    let words =
        format!("{} (error bars of {level:.0} %, Holm)", uncertainty.differences_in_words().trim_end_matches('.'));
    text.push_str(&labelled(0, "Differences", LABEL, &words));
    for difference in significant {
        let words = format!("{}: {}", pair_name(difference.pair), difference.words(uncertainty.level));
        text.push_str(&labelled(2, "", LABEL - 2, &words));
    }
    if let Some(variable) = analysis.study.settings.schedule.second {
        let tests = uncertainty.second_variables.iter().filter(|test| test.variable == variable);
        if !tests.clone().any(|test| test.needed) {
            let words =
                format!("the schedule is one of airspeed and {variable}, though no response is found to need it");
            text.push_str(&labelled(0, "Caution", LABEL, &words));
        }
    }
    for test in uncertainty.second_variables.iter().filter(|test| test.needed) {
        text.push_str(&labelled(0, "Schedule", LABEL, &format!("{}: {}", pair_name(test.pair), test)));
    }
    text
}

/// How the schedule fares on the conditions that are held out.
pub(super) fn held_out_lines(analysis: &Analysis) -> String {
    let verdict = held_out_verdict(analysis, usual(analysis, AssessedCorrection::Scheduled));
    verdict.map_or_else(String::new, |words| labelled(0, "Held out", LABEL, &words))
}

/// The change of J of each condition's nominal model under the schedule of the others.
pub(super) fn leave_one_out_section(analysis: &Analysis) -> String {
    let [seen, unseen] = [AssessedCorrection::Scheduled, AssessedCorrection::ScheduleOfOthers]
        .map(|correction| AssessmentTable::of(analysis, usual(analysis, correction)));
    let measuring: Vec<_> = analysis.study.dataset.measuring_pairs().marked().collect();
    let text =
        labelled(0, "Left out", LABEL, "change of J of each condition under the schedule of the others, on-axis mean:");
    let mut table = TextTable::new([
        ("condition", Side::Left),
        ("kt", Side::Right),
        ("schedule of all", Side::Right),
        ("of the others", Side::Right),
    ]);
    for condition in &unseen.conditions {
        let id = condition.condition;
        let mean = |table: &AssessmentTable| {
            let changes = measuring.iter().filter_map(|&pair| Some(table.change(id, pair)?.total()));
            let changes: Vec<f64> = changes.collect();
            (!changes.is_empty()).then(|| changes.iter().sum::<f64>() / changes.len() as f64)
        };
        let airspeed = figure(Some(condition.airspeed_kt), 0);
        table.row([id.to_string(), airspeed, figure(mean(&seen), 1), figure(mean(&unseen), 1)]);
    }
    let mut text = text + &table.lines(2);
    for left_out in &unseen.left_out {
        text.push_str(&labelled(
            2,
            "",
            LABEL - 2,
            &format!("condition {}: {}", left_out.condition, sanitized(&left_out.why)),
        ));
    }
    text
}

fn usual(analysis: &Analysis, correction: AssessedCorrection) -> AssessmentChoice {
    let average = analysis.study.settings.cost_average;
    AssessmentChoice { model: AssessedModel::Nominal, correction, average }
}
