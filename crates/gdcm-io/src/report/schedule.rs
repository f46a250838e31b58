//! The channels over the conditions, and the gains scheduled with airspeed.

use gdcm_method::correction::{Channel, ChannelCorrection};
use gdcm_method::schedule::Schedule;
use gdcm_model::dataset::{ConditionId, Pair};
use gdcm_model::number_format::{compact, decimals};
use gdcm_model::units::{number, s_to_ms};
use gdcm_plot::figure::all_channels;
use gdcm_plot::figure::condition_source::quantity_symbol;
use gdcm_plot::figure::gains::{Across, Measure, channels_figure, net_gain_figure};
use gdcm_study::{Analysis, Study};
use gdcm_words::Table;
use gdcm_words::schedule::delayed_channel_text;

use super::page::{PAIRS_DRAWN, Page, names};
use super::study::schedule_words;

/// Channels in one figure, in two rows.
const IN_A_FIGURE: usize = 12;
/// Responses in one figure, in two rows.
const PAIRS_IN_A_FIGURE: usize = 10;
/// Value columns of a table that fits on a page.
const COLUMNS: usize = 10;

/// Adds the section on the schedule.
pub(super) fn add_schedule(page: &mut Page, analysis: &Analysis) {
    page.section("Channels and schedule");
    page.subsection("Channels over the conditions");
    let is_input = |channel: &Channel| matches!(channel, Channel::Input(_));
    let (inputs, outputs): (Vec<_>, Vec<_>) = all_channels(&analysis.study.dataset)
        .into_iter()
        .partition(is_input);
    for (measure, what) in [(Measure::Gain, "Gains"), (Measure::Delay, "Delays")] {
        for (of, channels) in [("inputs", &inputs), ("outputs", &outputs)] {
            let title = format!("{what} of the {of} over conditions");
            add_channels(
                page,
                analysis,
                channels,
                (measure, Across::Conditions),
                &title,
            );
        }
    }
    page.subsection("Schedule over airspeed");
    match &analysis.schedule {
        Ok(schedule) => add_airspeed(page, analysis, schedule, &[inputs, outputs].concat()),
        Err(error) => page.paragraph(&format!("{error}.")),
    }
}

fn add_channels(
    page: &mut Page,
    analysis: &Analysis,
    channels: &[Channel],
    (measure, across): (Measure, Across),
    title: &str,
) {
    for channels in channels.chunks(IN_A_FIGURE) {
        let figure = channels_figure(
            analysis,
            analysis.uncertainty.as_deref(),
            channels,
            (measure, across),
        );
        let caption = "Each condition's optimum, within the bounds it was looked for in; dashed: no correction.";
        page.figure(&figure, title, caption);
    }
}

fn add_airspeed(page: &mut Page, analysis: &Analysis, schedule: &Schedule, channels: &[Channel]) {
    let (inputs, outputs) = analysis.study.dataset.names_of_channels();
    let low = number(schedule.airspeeds.min_kt);
    let high = number(schedule.airspeeds.max_kt);
    let left_out = not_scheduled(analysis);
    page.facts([
        ("Form", schedule_words(&schedule.settings)),
        (
            "Degree used",
            schedule
                .degree()
                .map_or("–".to_owned(), |degree| degree.to_string()),
        ),
        (
            "Airspeeds",
            format!("{low} to {high} kt; outside, the end value holds"),
        ),
        (
            "Conditions left out of it",
            if left_out.is_empty() {
                "none".to_owned()
            } else {
                names(&left_out)
            },
        ),
    ]);
    let price = schedule
        .lead_price()
        .map(|price| format!("Leads: {}.", price.words(&inputs, &outputs)));
    let cautions = schedule
        .cautions
        .iter()
        .map(|of| format!("Caution: {}.", of.words(&inputs, &outputs)));
    let left_out = analysis.unscheduled_delays().into_iter();
    let left_out = left_out.map(|of| {
        let text = delayed_channel_text(&of, &analysis.study.dataset);
        format!("Left out: {text}.")
    });
    page.list(price.into_iter().chain(cautions).chain(left_out));
    add_coefficients(page, schedule, (&inputs, &outputs));
    add_gains(page, analysis, schedule);
    let measures = [(Measure::Gain, "gains")]
        .into_iter()
        .chain(schedule.has_delays().then_some((Measure::Delay, "delays")));
    for (measure, what) in measures {
        let title = format!("Channel {what} over airspeed, and their schedule");
        add_channels(
            page,
            analysis,
            channels,
            (measure, Across::Airspeed),
            &title,
        );
    }
    for pairs in shown_pairs(&analysis.study).chunks(PAIRS_IN_A_FIGURE) {
        let figure = net_gain_figure(analysis, analysis.uncertainty.as_deref(), pairs);
        let caption =
            "Each condition's optimum with its number, and the schedule; dashed: no correction.";
        page.figure(&figure, "Net gains against airspeed", caption);
    }
}

/// Returns the conditions with a result that are excluded from the schedule by hand.
fn not_scheduled(analysis: &Analysis) -> Vec<String> {
    let scheduled: Vec<ConditionId> = analysis.scheduled();
    let all = analysis
        .study
        .dataset
        .conditions()
        .iter()
        .map(|condition| condition.id());
    all.filter(|id| !scheduled.contains(id))
        .map(|id| id.to_string())
        .collect()
}

/// Returns the responses that measure a model, and the constrained ones.
fn shown_pairs(study: &Study) -> Vec<Pair> {
    let measuring = study.dataset.measuring_pairs();
    let shown = measuring.map(|pair, measures| *measures || study.settings.constrained[pair]);
    shown.marked().take(PAIRS_DRAWN).collect()
}

fn add_coefficients(
    page: &mut Page,
    schedule: &Schedule,
    (inputs, outputs): (&[String], &[String]),
) {
    let found = schedule.coefficients(inputs, outputs);
    let of = quantity_symbol(schedule.settings.quantity);
    let title = if found.scale.is_empty() {
        format!("The schedule: {of} at each airspeed, linear between")
    } else {
        format!(
            "The schedule: coefficients of {of} in the scaled airspeed, {}",
            found.scale
        )
    };
    let columns = std::iter::once("channel".to_owned()).chain(found.columns.iter().cloned());
    let mut table = Table::new(title, columns);
    for row in &found.rows {
        let values = row.figures.iter().map(|value| compact(*value));
        table.row(std::iter::once(row.name.clone()).chain(values));
    }
    page.wide_table(&table, COLUMNS);
}

/// Adds the scheduled gains, net gains and, if scheduled, delays at the airspeeds of the
/// conditions.
fn add_gains(page: &mut Page, analysis: &Analysis, schedule: &Schedule) {
    let dataset = &analysis.study.dataset;
    let (inputs, outputs) = dataset.names_of_channels();
    let channels = all_channels(dataset);
    let pairs = shown_pairs(&analysis.study);
    let named = |symbol: &str| -> Vec<String> {
        channels
            .iter()
            .map(|channel| format!("{symbol}_{}", channel.name(&inputs, &outputs)))
            .collect()
    };
    add_over_airspeed(
        page,
        schedule,
        "Scheduled gains of the channels",
        &named("k"),
        |correction| {
            channels
                .iter()
                .map(|channel| decimals(correction.gain(*channel), 4))
                .collect()
        },
    );
    let names: Vec<String> = pairs.iter().map(|pair| dataset.pair_name(*pair)).collect();
    add_over_airspeed(
        page,
        schedule,
        "Scheduled net gains",
        &names,
        |correction| {
            pairs
                .iter()
                .map(|pair| decimals(correction.net_gain(*pair), 4))
                .collect()
        },
    );
    if schedule.has_delays() {
        add_over_airspeed(
            page,
            schedule,
            "Scheduled delays of the channels [ms]",
            &named("τ"),
            |correction| {
                channels
                    .iter()
                    .map(|channel| decimals(s_to_ms(correction.delay_s(*channel)), 2))
                    .collect()
            },
        );
    }
}

/// Adds tables with a row for each airspeed, as many as needed for all columns to fit.
fn add_over_airspeed(
    page: &mut Page,
    schedule: &Schedule,
    title: &str,
    names: &[String],
    cells: impl Fn(&ChannelCorrection) -> Vec<String>,
) {
    let mut table = Table::new(
        title,
        std::iter::once("V [kt]").chain(names.iter().map(String::as_str)),
    );
    for airspeed_kt in schedule.airspeeds.clusters_kt() {
        table
            .row(std::iter::once(decimals(airspeed_kt, 1)).chain(cells(&schedule.at(airspeed_kt))));
    }
    page.wide_table(&table, COLUMNS);
}
