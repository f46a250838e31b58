//! Report section on the schedule over airspeed, and appendix on each condition's channel gains and
//! delays.
//!
//! The schedule is a polynomial in airspeed or a table over it, fitted to the *optima*: the gains
//! and delays found for each condition alone. The *price* of leads is the gain that they add above
//! the band, and the frequency above which the model is not valid (M15.6).

use gdcm_method::correction::{Channel, ChannelCorrection};
use gdcm_method::schedule::{Schedule, ScheduleKind, ScheduleSettings};
use gdcm_model::dataset::{ConditionId, Dataset, Pair};
use gdcm_model::number_format::{compact, decimals};
use gdcm_model::units::{number, s_to_ms, six_digits};
use gdcm_plot::figure::caption_words::quantity_symbol;
use gdcm_plot::figure::gains::{Across, GainAxes, Measure, channels_figure, net_gain_figure};
use gdcm_plot::figure::{Figure, all_channels};
use gdcm_study::{Analysis, Study};
use gdcm_words::Table;
use gdcm_words::lead_price::price_text;
use gdcm_words::schedule::{delayed_channel_text, schedule_caution_text};

use super::limits::PAIRS_DRAWN;
use super::page::Page;
use super::wording::{capital, names};

/// Maximum number of channels per figure, in two rows.
const CHANNELS_IN_A_FIGURE: usize = 12;
/// Maximum number of responses per figure, in two rows.
const PAIRS_IN_A_FIGURE: usize = 10;
/// Maximum number of value columns in a table that fits on a page.
const COLUMNS: usize = 10;

/// Adds the section on the schedule; if there is none, only the reason.
pub(super) fn add_schedule(page: &mut Page, analysis: &Analysis) {
    page.section("Schedule over airspeed");
    match &analysis.schedule {
        Ok(schedule) => add_airspeed(page, analysis, schedule),
        Err(error) => page.paragraph(&format!("{}.", capital(&error.to_string()))),
    }
}

/// Adds the appendix on each condition's channel gains and delays.
pub(super) fn add_channels_of_conditions(page: &mut Page, analysis: &Analysis) {
    page.appendix("Gains and delays of the channels, by condition");
    let dataset = &analysis.study.dataset;
    let inputs: Vec<Channel> = (0..dataset.inputs().len()).map(Channel::Input).collect();
    let outputs: Vec<Channel> = (0..dataset.outputs().len()).map(Channel::Output).collect();
    for (measure, quantity) in [(Measure::Gain, "Gains"), (Measure::Delay, "Delays")] {
        for (side, channels) in [("inputs", &inputs), ("outputs", &outputs)] {
            let title = format!("{quantity} of the {side} over conditions");
            let axes = GainAxes {
                measure,
                across: Across::Conditions,
            };
            add_channels(page, analysis, channels, axes, &title);
        }
    }
}

/// Places a figure's plots in at most two rows of at least five columns.
fn in_two_rows(figure: Figure) -> Figure {
    let columns = figure.plots.len().div_ceil(2).max(5);
    figure.columns(columns)
}

/// Adds figures with the gains or delays of the channels.
fn add_channels(
    page: &mut Page,
    analysis: &Analysis,
    channels: &[Channel],
    axes: GainAxes,
    title: &str,
) {
    for channels in channels.chunks(CHANNELS_IN_A_FIGURE) {
        let uncertainty = analysis.uncertainty.as_deref();
        let figure = in_two_rows(channels_figure(analysis, uncertainty, channels, axes));
        let caption = "Optimum of each condition, and the bounds of its search; dashed: no \
            correction.";
        page.figure(&figure, title, caption);
    }
}

/// Adds the results that depend on airspeed: facts, remarks, coefficients, gains and figures.
fn add_airspeed(page: &mut Page, analysis: &Analysis, schedule: &Schedule) {
    let channels = all_channels(&analysis.study.dataset);
    add_schedule_facts(page, analysis, schedule);
    add_schedule_remarks(page, analysis, schedule);
    add_coefficients(page, analysis, schedule);
    add_gains(page, analysis, schedule);
    let mut measures = vec![(Measure::Gain, "gains")];
    if schedule.has_delays() {
        measures.push((Measure::Delay, "delays"));
    }
    for (measure, quantity) in measures {
        let title = format!("Channel {quantity} over airspeed, and their schedule");
        let axes = GainAxes {
            measure,
            across: Across::Airspeed,
        };
        add_channels(page, analysis, &channels, axes, &title);
    }
    for pairs in shown_pairs(&analysis.study).chunks(PAIRS_IN_A_FIGURE) {
        let uncertainty = analysis.uncertainty.as_deref();
        let figure = in_two_rows(net_gain_figure(analysis, uncertainty, pairs));
        let caption =
            "Optimum of each condition, with its id, and the schedule; dashed: no correction.";
        page.figure(&figure, "Net gains against airspeed", caption);
    }
}

/// Adds the schedule's form, degree and airspeeds, and the conditions that it omits.
fn add_schedule_facts(page: &mut Page, analysis: &Analysis, schedule: &Schedule) {
    let low = number(schedule.airspeeds.min_kt);
    let high = number(schedule.airspeeds.max_kt);
    let degree = match schedule.degree() {
        Some(degree) => degree.to_string(),
        None => "–".to_owned(),
    };
    let not_scheduled = not_scheduled(analysis);
    let left_out = if not_scheduled.is_empty() {
        "none".to_owned()
    } else {
        names(&not_scheduled)
    };
    page.facts([
        ("Form", schedule_words(&schedule.settings)),
        ("Degree used", degree),
        (
            "Airspeeds",
            format!("{low} to {high} kt; outside this range, the end value applies"),
        ),
        ("Conditions left out", left_out),
    ]);
}

/// Describes a schedule's kind, degree, variables, quantity and airspeed tolerance, and whether
/// delays are scheduled.
fn schedule_words(settings: &ScheduleSettings) -> String {
    let kind = match settings.kind {
        ScheduleKind::Polynomial { degree } => format!("polynomial of degree {degree} in airspeed"),
        ScheduleKind::Table => "table over airspeed".to_owned(),
    };
    let quantity = quantity_symbol(settings.quantity);
    let delays = if settings.delays {
        "delays are scheduled too"
    } else {
        "delays are not scheduled"
    };
    let second = match settings.second {
        Some(variable) => format!(", plus a term linear in {variable}"),
        None => String::new(),
    };
    format!(
        "{quantity} as a {kind}{second}; airspeeds within {} kt count as equal; {delays}",
        six_digits(settings.airspeed_tolerance_kt)
    )
}

/// Adds the price of leads, cautions about the schedule, and the delays that the schedule omits.
fn add_schedule_remarks(page: &mut Page, analysis: &Analysis, schedule: &Schedule) {
    let dataset = &analysis.study.dataset;
    let (inputs, outputs) = dataset.input_and_output_names();
    let mut lines = Vec::new();
    if let Some(price) = schedule.lead_price() {
        lines.push(format!("Leads: {}.", price_text(&price, &inputs, &outputs)));
    }
    for caution in &schedule.cautions {
        let text = schedule_caution_text(caution, &inputs, &outputs);
        lines.push(format!("Caution: {text}."));
    }
    for delayed in analysis.unscheduled_delays() {
        lines.push(format!(
            "Not scheduled: {}.",
            delayed_channel_text(&delayed, dataset)
        ));
    }
    page.list(lines);
}

/// Returns the condition ids that the schedule omits.
fn not_scheduled(analysis: &Analysis) -> Vec<String> {
    let scheduled: Vec<ConditionId> = analysis.scheduled();
    let mut names = Vec::new();
    for condition in analysis.study.dataset.conditions() {
        if !scheduled.contains(&condition.id()) {
            names.push(condition.id().to_string());
        }
    }
    names
}

/// Returns the on-axis responses (all if none is on-axis) and the constrained responses, at most
/// [`PAIRS_DRAWN`].
fn shown_pairs(study: &Study) -> Vec<Pair> {
    let measuring = study.dataset.measuring_pairs();
    let shown = measuring.map(|pair, measures| *measures || study.settings.constrained[pair]);
    shown.marked().take(PAIRS_DRAWN).collect()
}

fn add_coefficients(page: &mut Page, analysis: &Analysis, schedule: &Schedule) {
    let (inputs, outputs) = analysis.study.dataset.input_and_output_names();
    let coefficients = schedule.coefficients(&inputs, &outputs);
    let quantity = quantity_symbol(schedule.settings.quantity);
    let title = if coefficients.scale.is_empty() {
        format!("Schedule: {quantity} at each airspeed, linear in between")
    } else {
        format!(
            "Schedule: coefficients of {quantity} in the scaled airspeed, {}",
            coefficients.scale
        )
    };
    let mut columns = vec!["channel".to_owned()];
    columns.extend(coefficients.columns.iter().cloned());
    let mut table = Table::new(title, columns);
    for row in &coefficients.rows {
        let mut cells = vec![row.name.clone()];
        cells.extend(row.values.iter().map(|value| compact(*value)));
        table.row(cells);
    }
    page.wide_table(&table, COLUMNS);
}

/// Adds the scheduled gains, net gains and, if scheduled, delays at each distinct scheduled
/// airspeed.
fn add_gains(page: &mut Page, analysis: &Analysis, schedule: &Schedule) {
    let dataset = &analysis.study.dataset;
    let channels = all_channels(dataset);
    let pairs = shown_pairs(&analysis.study);
    let gains = channels.iter().map(|&channel| AirspeedColumn {
        name: format!("k_{}", channel_name(dataset, channel)),
        cell: Box::new(move |correction| decimals(correction.gain(channel), 4)),
    });
    add_over_airspeed(
        page,
        schedule,
        "Scheduled gains of the channels",
        gains.collect(),
    );
    let net_gains = pairs.iter().map(|&pair| AirspeedColumn {
        name: dataset.pair_name(pair),
        cell: Box::new(move |correction| decimals(correction.net_gain(pair), 4)),
    });
    add_over_airspeed(page, schedule, "Scheduled net gains", net_gains.collect());
    if schedule.has_delays() {
        let delays = channels.iter().map(|&channel| AirspeedColumn {
            name: format!("τ_{}", channel_name(dataset, channel)),
            cell: Box::new(move |correction| decimals(s_to_ms(correction.delay_s(channel)), 2)),
        });
        add_over_airspeed(
            page,
            schedule,
            "Scheduled delays of the channels [ms]",
            delays.collect(),
        );
    }
}

fn channel_name(dataset: &Dataset, channel: Channel) -> String {
    let (inputs, outputs) = dataset.input_and_output_names();
    channel.name(&inputs, &outputs)
}

/// Table column over airspeed: its name and the function that formats a cell.
struct AirspeedColumn {
    name: String,
    cell: Box<dyn Fn(&ChannelCorrection) -> String>,
}

/// Adds a table with a row for each airspeed, in parts that each fit on a page.
fn add_over_airspeed(
    page: &mut Page,
    schedule: &Schedule,
    title: &str,
    columns: Vec<AirspeedColumn>,
) {
    let mut heading = vec!["V [kt]".to_owned()];
    heading.extend(columns.iter().map(|column| column.name.clone()));
    let mut table = Table::new(title, heading);
    for airspeed_kt in schedule.airspeeds.clusters_kt() {
        let correction = schedule.at(airspeed_kt);
        let mut cells = vec![decimals(airspeed_kt, 1)];
        cells.extend(columns.iter().map(|column| (column.cell)(&correction)));
        table.row(cells);
    }
    page.wide_table(&table, COLUMNS);
}
