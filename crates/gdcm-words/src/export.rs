//! Sentences about an export: what is in each file, and what the files omit or approximate.

use gdcm_method::schedule::DelayScheduling;
use gdcm_model::dataset::{ConditionId, Dataset};
use gdcm_model::number_format::{counted, number, signed, six_digits, telling};
use gdcm_model::units::s_to_ms;
use gdcm_study::results::export_note::{ExportNote, ExportRemedy, FileSummary};
use gdcm_study::results::schedule_losses::DelayedChannel;

use super::coupling_error::coupling_error_text;
use super::lead_price::limit_text;
use super::schedule::delayed_channel_text;

/// Maximum number of conditions that a note lists.
const MOST_LISTED: usize = 6;

/// Describes what a file contains: "5 airspeeds, linear".
pub fn file_summary_text(summary: &FileSummary) -> String {
    match summary {
        FileSummary::Results {
            has_error_bars: true,
        } => "all results, with error bars".to_owned(),
        FileSummary::Results { .. } => "all results, without error bars".to_owned(),
        FileSummary::Rows { rows } => counted(*rows, "row"),
        FileSummary::Function {
            channels,
            has_delays,
            has_leads,
        } => {
            let parts = match (has_delays, has_leads) {
                (_, true) => "gains, delays and leads",
                (true, false) => "gains and delays",
                (false, false) => "gains",
            };
            format!("{parts}, {}", counted(*channels, "channel"))
        }
        FileSummary::Table { airspeeds } => format!("{}, linear", counted(*airspeeds, "airspeed")),
        FileSummary::Models {
            models,
            added_states: 0,
        } => counted(*models, "model"),
        FileSummary::Models {
            models,
            added_states,
        } => format!(
            "{}, up to +{}",
            counted(*models, "model"),
            counted(*added_states, "state")
        ),
        FileSummary::Checksums { files } => format!("SHA-256 of {}", counted(*files, "file")),
        FileSummary::Report {
            conditions,
            figures,
            tables,
        } => format!(
            "{}, {}, {}",
            counted(*conditions, "condition"),
            counted(*figures, "figure"),
            counted(*tables, "table")
        ),
    }
}

/// States in a few words what files omit or approximate: "NX delay of condition 4 not scheduled".
pub fn export_note_title(note: &ExportNote, dataset: &Dataset) -> String {
    match note {
        ExportNote::DelaysNotScheduled { .. } => "Delays: none in the schedule".to_owned(),
        ExportNote::ConstantDelays { .. } => {
            "Delay schedule: constant delay per channel".to_owned()
        }
        ExportNote::SignedDelaysNotScheduled {
            condition,
            channels,
        } => match channels.as_slice() {
            [only] => format!(
                "{} delay of condition {condition} not scheduled",
                only.channel.name_in(dataset)
            ),
            _ => format!(
                "{} delays of condition {condition} not scheduled",
                channels.len()
            ),
        },
        ExportNote::CouplingsLeftOut { .. } => "Couplings: left out".to_owned(),
        ExportNote::GainTableError {
            channel,
            error_percent,
            airspeed_kt,
            ..
        } => format!(
            "Table error {} % on {} near {} kt",
            telling(*error_percent, 1),
            channel.name_in(dataset),
            number(airspeed_kt.round())
        ),
        ExportNote::TimeTableError {
            channel,
            error_ms,
            airspeed_kt,
            ..
        } => format!(
            "Table error {} ms on {} near {} kt",
            telling(*error_ms, 1),
            channel.name_in(dataset),
            number(airspeed_kt.round())
        ),
        ExportNote::LeadsTabulated { points } => {
            format!("Lead filters: table of {points} airspeeds")
        }
        ExportNote::PadeError { error_deg, .. } => {
            format!("Padé phase error {}°", telling(*error_deg, 2))
        }
        ExportNote::TustinError { error_deg, .. } => {
            format!("Sampled leads: phase error {}°", telling(*error_deg, 2))
        }
        ExportNote::NotValidAbove { price } => {
            let words = limit_text(price);
            let inputs = largest(&price.gains_db.inputs);
            let outputs = largest(&price.gains_db.outputs);
            format!(
                "{}: leads add at most {} dB",
                capitalized(&words),
                telling(inputs + outputs, 0)
            )
        }
        ExportNote::ConditionsNotChosen { conditions } => format!(
            "{} of {} left out",
            counted(conditions.len(), "condition"),
            dataset.conditions().len()
        ),
        ExportNote::ConditionsNotScheduled { conditions } => format!(
            "{} not in the fit of the schedule",
            counted(conditions.len(), "condition")
        ),
        ExportNote::ConditionsWithoutResult { conditions } => {
            format!(
                "{} without a result",
                counted(conditions.len(), "condition")
            )
        }
        ExportNote::NoSchedule { .. } => "No schedule".to_owned(),
        ExportNote::NoErrorBars => "No error bars".to_owned(),
        ExportNote::NoPhysicsParameters => "Physics parameters: none".to_owned(),
        ExportNote::NoFlightRecords => "Time histories: no flight records".to_owned(),
        ExportNote::ConditionsNotDrawn { conditions } => {
            format!("{} without figures", counted(conditions.len(), "condition"))
        }
        ExportNote::ReportOfAllConditions => "Report: all conditions".to_owned(),
    }
}

/// Explains a note: numbers, and the setting from which it follows; may be empty.
pub fn export_note_detail(
    note: &ExportNote,
    dataset: &Dataset,
    scheduling: DelayScheduling,
) -> String {
    match note {
        ExportNote::DelaysNotScheduled { channels } => {
            let setting = match scheduling {
                DelayScheduling::Never => "the schedule of delays is off",
                _ => "no held response needs a delay",
            };
            format!("{}; {setting}", delayed_channels_text(channels, dataset))
        }
        ExportNote::ConstantDelays { .. } => {
            "the degree of the delays over airspeed is 0".to_owned()
        }
        ExportNote::SignedDelaysNotScheduled {
            condition,
            channels,
        } => match channels.first() {
            Some(apart) => format!(
                "{} {} ms in condition {condition}, {} ms in the others",
                apart.channel.name_in(dataset),
                signed(s_to_ms(apart.tau_s), 0),
                signed(s_to_ms(apart.elsewhere_s), 0)
            ),
            None => String::new(),
        },
        ExportNote::CouplingsLeftOut { why } => coupling_error_text(why, dataset),
        ExportNote::GainTableError { .. } | ExportNote::TimeTableError { .. } => {
            "exported functions are exact".to_owned()
        }
        ExportNote::LeadsTabulated { .. } => "linear between the airspeeds".to_owned(),
        ExportNote::PadeError {
            order,
            band_top_rad_s,
            ..
        } => format!("at {} rad/s, order {order}", number(*band_top_rad_s)),
        ExportNote::TustinError { band_top_rad_s, .. } => {
            format!("at {} rad/s, by Tustin's rule", number(*band_top_rad_s))
        }
        ExportNote::NotValidAbove { price } => {
            format!("at {} rad/s", number(price.above_rad_s()))
        }
        ExportNote::ConditionsNotChosen { conditions }
        | ExportNote::ConditionsNotScheduled { conditions }
        | ExportNote::ConditionsWithoutResult { conditions }
        | ExportNote::ConditionsNotDrawn { conditions } => listed(conditions),
        ExportNote::NoSchedule { why } => why.to_string(),
        ExportNote::NoErrorBars => "still being computed, or stopped (choose Compute)".to_owned(),
        ExportNote::NoPhysicsParameters => "the table has only its headings".to_owned(),
        ExportNote::NoFlightRecords => "add records in the view Records".to_owned(),
        ExportNote::ReportOfAllConditions => {
            "including conditions left out of the export".to_owned()
        }
    }
}

/// Labels a remedy's button: "Add 75 kt".
pub fn export_remedy_text(remedy: ExportRemedy) -> String {
    match remedy {
        ExportRemedy::ScheduleDelays | ExportRemedy::SignedDelaysOverAirspeed => {
            "Turn on".to_owned()
        }
        ExportRemedy::AddBreakpoint { airspeed_kt } => {
            format!("Add {} kt", six_digits(airspeed_kt))
        }
        ExportRemedy::UsePadeOrder { order } => format!("Use order {order}"),
        ExportRemedy::IncludeAllConditions => "Include all".to_owned(),
    }
}

/// Describes the first delayed channel, and counts the others; empty for no channels.
fn delayed_channels_text(channels: &[DelayedChannel], dataset: &Dataset) -> String {
    match channels {
        [] => String::new(),
        [only] => delayed_channel_text(only, dataset),
        [first, others @ ..] => format!(
            "{}; {} more",
            delayed_channel_text(first, dataset),
            others.len()
        ),
    }
}

/// Lists conditions: "3, 5, 6"; if there are many, the first ones and the count of the others.
fn listed(conditions: &[ConditionId]) -> String {
    let shown: Vec<String> = conditions
        .iter()
        .take(MOST_LISTED)
        .map(ToString::to_string)
        .collect();
    let list = shown.join(", ");
    match conditions.len().saturating_sub(MOST_LISTED) {
        0 => list,
        more => format!("{list} and {more} more"),
    }
}

/// Returns the largest gain \[dB\], and at least 0.
fn largest(gains_db: &[f64]) -> f64 {
    gains_db.iter().copied().fold(0.0, f64::max)
}

/// Returns a sentence with a capital letter at its beginning.
fn capitalized(text: &str) -> String {
    let mut letters = text.chars();
    match letters.next() {
        Some(first) => first.to_uppercase().chain(letters).collect(),
        None => String::new(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn many_conditions_are_listed_in_part() {
        let ids: Vec<ConditionId> = (1..=9).map(ConditionId).collect();
        assert_eq!(listed(&ids[..3]), "1, 2, 3");
        assert_eq!(listed(&ids), "1, 2, 3, 4, 5, 6 and 3 more");
    }

    #[test]
    fn a_summary_counts_what_is_in_the_file() {
        let models = FileSummary::Models {
            models: 11,
            added_states: 20,
        };
        assert_eq!(file_summary_text(&models), "11 models, up to +20 states");
        let table = FileSummary::Table { airspeeds: 1 };
        assert_eq!(file_summary_text(&table), "1 airspeed, linear");
    }
}
