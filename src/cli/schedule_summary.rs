//! Schedule summary, as printed: scheduled net gains and delays over airspeed.
//!
//! The schedule gives the channels' gains and delays as a function of airspeed (M11); a net gain or
//! net delay is the product or sum of a response's two channels.

use gdcm_method::schedule::{Schedule, ScheduledQuantity};
use gdcm_model::dataset::{ConditionId, Pair};
use gdcm_model::message_text::sanitized;
use gdcm_model::units::{number, s_to_ms};
use gdcm_study::{Analysis, Study};
use gdcm_words::Table;
use gdcm_words::schedule::{delayed_channel_text, schedule_caution_text};

use super::printed_lines::{detail, fixed_digits, indented, line};
use super::terminal::keep_caution;

/// Returns the responses listed in tables: the on-axis responses (all if none is on-axis) and the
/// constrained responses.
pub(super) fn shown_pairs(study: &Study) -> Vec<Pair> {
    let measuring = study.dataset.measuring_pairs();
    let shown = measuring.map(|pair, measures| *measures || study.settings.constrained[pair]);
    shown.marked().collect()
}

/// Returns the schedule's kind, its cautions, the delays that it omits, and tables with the
/// scheduled net gains and, if there are any, net delays over airspeed, for the responses in
/// [`shown_pairs`]. Without a schedule, the reason. Also keeps the cautions for the JSON object.
pub(super) fn schedule_section(analysis: &Analysis) -> String {
    let schedule = match &analysis.schedule {
        Ok(schedule) => schedule,
        Err(error) => return line("Schedule", &error.to_string()),
    };
    let words = format!("{}; net gains:", schedule_words(schedule));
    let mut text = line("Schedule", &words);
    let dataset = &analysis.study.dataset;
    let (inputs, outputs) = dataset.input_and_output_names();
    for caution in &schedule.cautions {
        let words = schedule_caution_text(caution, &inputs, &outputs);
        let conditions: Vec<ConditionId> = caution.condition().into_iter().collect();
        keep_caution(caution.code(), &conditions, &words);
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

/// Describes a schedule's kind, airspeed range and second variable.
fn schedule_words(schedule: &Schedule) -> String {
    let quantity = match schedule.settings.quantity {
        ScheduledQuantity::LnGain => "ln k",
        ScheduledQuantity::Gain => "k",
    };
    let mut words = match schedule.degree() {
        Some(degree) => format!("polynomial of degree {degree} in airspeed, fitted to {quantity}"),
        None => format!("lookup table of {quantity} over airspeed"),
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

/// Returns a table with a scheduled quantity over airspeed.
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
