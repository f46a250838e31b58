//! Printed summary of the schedule: scheduled net gains and delays, the sources of their scatter,
//! and the assessment in conditions left out of the fit.

use gdcm_method::schedule::{Schedule, ScheduleCaution, ScheduledQuantity};
use gdcm_model::dataset::Pair;
use gdcm_model::message_text::sanitized;
use gdcm_model::units::{number, s_to_ms};
use gdcm_study::results::assessment_table::{AssessedModel, AssessmentChoice};
use gdcm_study::results::uncertainty::Uncertainty;
use gdcm_study::{Analysis, AssessedCorrection, AssessmentTable, Study};
use gdcm_words::Table;
use gdcm_words::assessment::not_assessed_text;
use gdcm_words::schedule::{delayed_channel_text, schedule_caution_text};
use gdcm_words::uncertainty::{
    difference_text, differences_summary, scatter_table, second_variable_text,
};

use super::terminal::keep_coded_caution;
use super::text::{detail, fixed_digits, indented, indented_untitled, line};

/// Returns the responses listed in tables: the responses in the objective (on-axis; all if none is
/// on-axis) and the constrained responses.
pub(super) fn shown_pairs(study: &Study) -> Vec<Pair> {
    let measuring = study.dataset.measuring_pairs();
    let shown = measuring.map(|pair, measures| *measures || study.settings.constrained[pair]);
    shown.marked().collect()
}

/// Returns the default choice for assessing a correction: the nominal models, with the average of J
/// that the study sets.
pub(super) fn nominal_choice(
    analysis: &Analysis,
    correction: AssessedCorrection,
) -> AssessmentChoice {
    AssessmentChoice {
        model: AssessedModel::Nominal,
        correction,
        average: analysis.study.settings.cost_average,
    }
}

/// Returns tables of the scheduled net gains and delays over airspeed, for the responses in
/// [`shown_pairs`].
pub(super) fn schedule_section(analysis: &Analysis) -> String {
    let schedule = match &analysis.schedule {
        Ok(schedule) => schedule,
        Err(error) => return line("Schedule", &error.to_string()),
    };
    let words = format!("{}; net gains:", schedule_words(schedule));
    let mut text = line("Schedule", &words);
    let dataset = &analysis.study.dataset;
    let (inputs, outputs) = dataset.names_of_channels();
    for caution in &schedule.cautions {
        let words = schedule_caution_text(caution, &inputs, &outputs);
        if let ScheduleCaution::CostsMore(cost) = caution {
            keep_coded_caution(Some(caution.code()), &[cost.condition], &words);
        }
        text += &detail("caution", &sanitized(&words));
    }
    for delayed in analysis.unscheduled_delays() {
        text += &detail(
            "left out",
            &sanitized(&delayed_channel_text(&delayed, dataset)),
        );
    }
    text += &schedule_table(analysis, schedule, NetQuantity::Gain);
    if schedule.has_delays() {
        text += &line("", "net delays in ms:");
        text += &schedule_table(analysis, schedule, NetQuantity::Delay);
    }
    text
}

/// Describes the kind, airspeed range and second variable of a schedule.
fn schedule_words(schedule: &Schedule) -> String {
    let quantity = match schedule.settings.quantity {
        ScheduledQuantity::LnGain => "ln k",
        ScheduledQuantity::Gain => "k",
    };
    let mut words = match schedule.degree() {
        Some(degree) => format!("polynomial of degree {degree} in airspeed, fitted to {quantity}"),
        None => format!("lookup table in airspeed, of {quantity}"),
    };
    let range = &schedule.airspeeds;
    words += &format!(", {} to {} kt", number(range.min_kt), number(range.max_kt));
    if let Some(term) = &schedule.second {
        words += &format!(
            "; with {} as second variable, here at the middle of its range, {} {}",
            term.variable,
            number(term.middle()),
            term.variable.unit()
        );
    }
    words
}

/// Quantity tabulated over airspeed.
#[derive(Clone, Copy)]
enum NetQuantity {
    Gain,
    /// Delay \[ms\].
    Delay,
}

/// Returns a table of a scheduled quantity over airspeed.
fn schedule_table(analysis: &Analysis, schedule: &Schedule, quantity: NetQuantity) -> String {
    /// Fractions of the airspeed range at which the table has rows.
    const SHOWN: [f64; 5] = [0.0, 0.25, 0.5, 0.75, 1.0];
    let min = schedule.airspeeds.min_kt;
    let max = schedule.airspeeds.max_kt;
    let airspeeds_kt = SHOWN.map(|fraction| min + fraction * (max - min));
    let mut headings = vec!["response".to_owned()];
    for airspeed_kt in airspeeds_kt {
        headings.push(format!("{} kt", fixed_digits(Some(airspeed_kt), 0)));
    }
    let mut table = Table::new("", headings);
    let corrections = airspeeds_kt.map(|airspeed_kt| schedule.at(airspeed_kt));
    for pair in shown_pairs(&analysis.study) {
        let mut cells = vec![sanitized(&analysis.study.dataset.pair_name(pair))];
        for correction in &corrections {
            cells.push(match quantity {
                NetQuantity::Gain => fixed_digits(Some(correction.net_gain(pair)), 3),
                NetQuantity::Delay => fixed_digits(Some(s_to_ms(correction.net_delay_s(pair))), 1),
            });
        }
        table.row(cells);
    }
    indented(&table, 2)
}

/// Returns the sources of the scatter, the differences at equal airspeed, and the need for a second
/// variable. Empty if the error bars were not computed.
pub(super) fn evidence_section(analysis: &Analysis) -> String {
    let Some(uncertainty) = &analysis.uncertainty else {
        return String::new();
    };
    let mut text = line(
        "Scatter",
        "of the on-axis net gains, and the part explained by trim and identification uncertainty:",
    );
    text += &indented_untitled(scatter_table(&analysis.study.dataset, uncertainty));
    text += &difference_lines(&analysis.study, uncertainty);
    text + &second_variable_lines(&analysis.study, uncertainty)
}

/// Returns the significant differences between conditions at equal airspeed.
fn difference_lines(study: &Study, uncertainty: &Uncertainty) -> String {
    let level = uncertainty.level;
    let words = format!(
        "{} (error bars of {:.0} %, Holm)",
        differences_summary(uncertainty).trim_end_matches('.'),
        100.0 * level
    );
    let mut text = line("Differences", &words);
    for difference in &uncertainty.differences {
        if difference.is_significant(level) {
            let pair = sanitized(&study.dataset.pair_name(difference.pair));
            text += &detail(
                "",
                &format!("{pair}: {}", difference_text(difference, level)),
            );
        }
    }
    text
}

/// Returns the responses that need a second variable, and a caution if the schedule has a variable
/// that no response needs.
fn second_variable_lines(study: &Study, uncertainty: &Uncertainty) -> String {
    let needed: Vec<_> = uncertainty
        .second_variables
        .iter()
        .filter(|test| test.needed)
        .collect();
    let mut text = String::new();
    if let Some(variable) = study.settings.schedule.second
        && needed.iter().all(|test| test.variable != variable)
    {
        let words = format!(
            "the schedule depends on airspeed and {variable}, although no response needs \
            {variable}"
        );
        text += &line("Caution", &words);
    }
    for test in needed {
        let pair = sanitized(&study.dataset.pair_name(test.pair));
        text += &line(
            "Schedule",
            &format!("{pair}: {}", second_variable_text(test)),
        );
    }
    text
}

/// Returns the change in J of each condition's nominal model when the schedule is fitted to the
/// other conditions only.
pub(super) fn leave_one_out_section(analysis: &Analysis) -> String {
    let seen = assessment(analysis, AssessedCorrection::Scheduled);
    let unseen = assessment(analysis, AssessedCorrection::ScheduleOfOthers);
    let mut text = line(
        "Left out",
        "change of J in each condition with a schedule fitted to the others, on-axis mean:",
    );
    let mut table = Table::new("", ["condition", "kt", "schedule of all", "of the others"]);
    for condition in &unseen.conditions {
        let id = condition.condition;
        let mean_change = |table: &AssessmentTable| {
            let mut changes: Vec<f64> = Vec::new();
            for pair in analysis.study.dataset.measuring_pairs().marked() {
                changes.extend(table.change(id, pair).map(|change| change.total()));
            }
            mean(&changes)
        };
        table.row([
            id.to_string(),
            fixed_digits(Some(condition.airspeed_kt), 0),
            fixed_digits(mean_change(&seen), 1),
            fixed_digits(mean_change(&unseen), 1),
        ]);
    }
    text += &indented(&table, 2);
    for left_out in &unseen.left_out {
        let why = sanitized(&not_assessed_text(&left_out.why, &analysis.study.dataset));
        text += &detail("", &format!("condition {}: {why}", left_out.condition));
    }
    if analysis.fitted_couplings().is_some() {
        let words = "these couplings are fitted to all conditions; for J with couplings fitted \
            without each condition, see Couplings";
        text += &detail("", words);
    }
    text
}

fn assessment(analysis: &Analysis, correction: AssessedCorrection) -> AssessmentTable {
    AssessmentTable::assess(analysis, nominal_choice(analysis, correction))
}

fn mean(values: &[f64]) -> Option<f64> {
    if values.is_empty() {
        None
    } else {
        Some(values.iter().sum::<f64>() / values.len() as f64)
    }
}
