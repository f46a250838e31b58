//! Remedies for cautions and for failed identifications.
//!
//! A *caution* is a finding of the identification that makes its models doubtful. A *remedy* is a
//! button that removes its cause, or shows the page on which the engineer can remove it.
//! [`caution_remedies`] returns the remedies for each kind of caution, in display order,
//! [`band_remedy`] that for a failed identification.

use egui::Ui;

use gdcm_model::dataset::Pair;
use gdcm_model::dataset::channel::ChannelSide;
use gdcm_model::dataset::condition::ChannelRemedy;
use gdcm_model::simulation::Signal;
use gdcm_model::units::s_to_ms;
use gdcm_sysid::diagnostics::record_fault::{ContradictingRecord, RecordFault};
use gdcm_sysid::identification::{Hold, IdentificationCaution, IdentificationError};
use gdcm_sysid::spectra::record_cautions::RecordCaution;

use super::references::{REFERENCES, possible_references};
use super::search_settings::ORDERS;
use crate::gui::commands::command::Command;
use crate::gui::commands::records::RecordsCommand;
use crate::gui::commands::selection::SelectionCommand;
use crate::gui::state::records::{ConditionRecords, RecordsPage};

/// Number of periods at the lowest frequency that the longest usable segment must contain: slightly
/// more than the five below which the caution appears, so that rounding does not cause it again.
const LEAST_PERIODS: f64 = 5.001;
/// Maximum count of buttons for references.
const MOST_REFERENCES: usize = 3;

/// Button that removes a caution's cause, or shows what is needed for this.
pub(super) struct Remedy {
    /// Button text.
    pub(super) short: String,
    /// Complete description, in menus and as the accessible name.
    pub(super) label: String,
    pub(super) command: Command,
}

impl Remedy {
    fn new(
        short: impl Into<String>,
        label: impl Into<String>,
        command: impl Into<Command>,
    ) -> Self {
        Self {
            short: short.into(),
            label: label.into(),
            command: command.into(),
        }
    }
}

pub(super) fn study_band_remedy() -> Remedy {
    Remedy::new(
        "Study's band",
        "Use the study's band",
        RecordsCommand::SetBand(None),
    )
}

/// Returns a button that changes the band if this lets the failed identification succeed; `band`
/// \[rad/s\] is the current band.
pub(super) fn band_remedy(error: &IdentificationError, band: [f64; 2]) -> Option<Remedy> {
    let [lowest, highest] = band;
    match error {
        IdentificationError::TooShort { enough, .. } if *enough < highest => {
            Some(use_band([*enough, highest]))
        }
        IdentificationError::SampledTooSlowly { limit, .. } if *limit > lowest => {
            Some(use_band([lowest, *limit]))
        }
        _ => None,
    }
}

/// Returns the remedies for a caution; empty if the program has none, for example if only another
/// flight helps.
pub(super) fn caution_remedies(
    ui: &Ui,
    records: &ConditionRecords,
    caution: &IdentificationCaution,
) -> Vec<Remedy> {
    match caution {
        IdentificationCaution::Records(caution) => record_caution_remedies(records, caution),
        IdentificationCaution::UnlikeRecord { name, .. }
        | IdentificationCaution::Inadequate { record: name, .. } => {
            leave_out(records, name).into_iter().collect()
        }
        IdentificationCaution::Contradiction {
            records: contradicting,
            ..
        } => contradiction_remedies(records, contradicting),
        IdentificationCaution::Short {
            lowest, periods, ..
        } => {
            let omega_of_one_period = lowest / periods;
            raise_lowest_frequency(records, omega_of_one_period)
                .into_iter()
                .collect()
        }
        IdentificationCaution::BandNotShown { shown: band, .. }
        | IdentificationCaution::OrderLimit { narrower: band, .. } => vec![use_band(*band)],
        IdentificationCaution::NotSwept { .. } | IdentificationCaution::MovedTogether { .. } => {
            vec![show_inputs()]
        }
        IdentificationCaution::Feedback { .. } => reference_remedies(ui, records),
        IdentificationCaution::LeavesPoints { output, input, .. } => {
            let pair = Pair {
                output: output.index,
                input: input.index,
            };
            let show_pair = SelectionCommand::FocusPair(pair);
            vec![
                Remedy::new("Show", format!("Show {output}/{input}"), show_pair),
                choose_order(),
            ]
        }
        IdentificationCaution::HeldOut {
            records: held_out, ..
        } => {
            let mut remedies = Vec::new();
            for name in held_out {
                remedies.extend(fit_held_out(records, name));
                remedies.extend(leave_out(records, name));
            }
            remedies
        }
        IdentificationCaution::Unstable { .. } => vec![
            Remedy::new(
                "Show poles",
                "Show the poles of the model",
                RecordsCommand::ShowPage(RecordsPage::Order),
            ),
            choose_order(),
        ],
        _ => Vec::new(),
    }
}

/// Returns the remedies for a caution about the records themselves.
fn record_caution_remedies(records: &ConditionRecords, caution: &RecordCaution) -> Vec<Remedy> {
    match caution {
        RecordCaution::SampleHold { signal, hold_s, .. } => hold_remedies(signal, *hold_s),
        RecordCaution::AtLimit { record, .. }
        | RecordCaution::Stuck { record, .. }
        | RecordCaution::Spike { record, .. } => leave_out(records, record).into_iter().collect(),
        RecordCaution::MovedTogether { .. } => vec![show_inputs()],
        // Both concern the assignment of a column.
        RecordCaution::UnlikelyUnit { .. } | RecordCaution::Copy { .. } => vec![Remedy::new(
            "Check",
            "Set column and factor on page Columns…",
            RecordsCommand::ShowPage(RecordsPage::Columns),
        )],
        _ => Vec::new(),
    }
}

/// Returns a remedy for each possible reason why a signal keeps its value for `hold_s` \[s\]; only
/// an input can be a held command.
fn hold_remedies(signal: &Signal, hold_s: f64) -> Vec<Remedy> {
    let name = &signal.name;
    let mut remedies = Vec::new();
    if signal.role == ChannelSide::Input {
        remedies.push(Remedy::new(
            "Held command",
            format!("Treat {name} as a held command"),
            RecordsCommand::SetHold(signal.clone(), Hold::Command { hold_s }),
        ));
    }
    remedies.push(Remedy::new(
        "Slow sensor",
        format!("Treat {name} as a slow sensor"),
        RecordsCommand::SetHold(signal.clone(), Hold::FreshSamples),
    ));
    remedies.push(Remedy::new(
        "Unchanged",
        format!("Use {name} unchanged"),
        RecordsCommand::SetHold(signal.clone(), Hold::Acts),
    ));
    remedies
}

/// Returns remedies for contradicting records: first repairs for identified faults, then buttons
/// that leave a record out.
fn contradiction_remedies(
    records: &ConditionRecords,
    contradicting: &[ContradictingRecord],
) -> Vec<Remedy> {
    let mut remedies = Vec::new();
    for record in contradicting {
        remedies.extend(repair(records, record));
    }
    for record in contradicting {
        remedies.extend(leave_out(records, &record.name));
    }
    remedies
}

/// Returns a remedy that repairs a record's identified fault (a late channel or a wrong factor), in
/// addition to the corrections that already apply to its channels; `None` without an identified
/// fault.
fn repair(records: &ConditionRecords, contradicting: &ContradictingRecord) -> Option<Remedy> {
    let row = records.row_of_record(contradicting.record)?;
    let fault = contradicting.fault.as_ref()?;
    let mut outputs = Vec::new();
    for (index, channel) in records.outputs.iter().enumerate() {
        outputs.push(Signal {
            role: ChannelSide::Output,
            index,
            name: channel.name.clone(),
        });
    }
    let mut layout = records.rows[row].layout.clone();
    let mut remedies: Vec<(Signal, ChannelRemedy)> = Vec::new();
    for (signal, remedy) in fault.remedies(&outputs) {
        if let Some(column_use) = layout.channel_mut(signal.role, signal.index) {
            remedies.push((signal, column_use.remedy.then(remedy)));
        }
    }
    let label = repair_label(fault, &contradicting.name);
    Some(Remedy::new(
        "Correct",
        label,
        RecordsCommand::SetRemedies(row, remedies),
    ))
}

fn repair_label(fault: &RecordFault, record: &str) -> String {
    match fault {
        RecordFault::OutputsLate(delay_s) => format!(
            "Remove {:.0} ms from the outputs of {record}",
            s_to_ms(*delay_s)
        ),
        RecordFault::Late(signal, delay_s) => {
            format!(
                "Remove {:.0} ms from {signal} of {record}",
                s_to_ms(*delay_s)
            )
        }
        RecordFault::Gain(signal, factor) if *factor < 0.0 => {
            format!("Reverse the sign of {signal} in {record}")
        }
        RecordFault::Gain(signal, factor) => {
            format!("Multiply {signal} of {record} by {factor:.2}")
        }
    }
}

/// Returns a remedy that removes a delay \[s\] from a channel in all records, in addition to the
/// delay that the identification already removed.
pub(super) fn remove_common_delay(
    records: &ConditionRecords,
    signal: &Signal,
    delay_s: f64,
) -> Remedy {
    // The delay that remains adds to the one that the latest identification has removed.
    let removed_s = match &records.latest {
        Some(latest) => match latest.job.request.options.preparation.channel(signal) {
            Some(channel) => channel.delay_s,
            None => 0.0,
        },
        None => 0.0,
    };
    let delay_s = removed_s + delay_s;
    Remedy::new(
        "Remove",
        format!("Remove {:.0} ms from {}", s_to_ms(delay_s), signal.name),
        RecordsCommand::SetDelay(signal.clone(), delay_s),
    )
}

fn use_band(band: [f64; 2]) -> Remedy {
    Remedy::new(
        format!("{:.2} to {:.1} rad/s", band[0], band[1]),
        format!("Identify from {:.2} to {:.1} rad/s", band[0], band[1]),
        RecordsCommand::SetBand(Some(band)),
    )
}

/// Returns a remedy that raises the lower band edge so that the longest usable segment contains
/// [`LEAST_PERIODS`] periods; at `omega_of_one_period` \[rad/s\], this segment contains a single
/// period. `None` if the raised edge would reach the upper one.
fn raise_lowest_frequency(records: &ConditionRecords, omega_of_one_period: f64) -> Option<Remedy> {
    let latest = records.latest.as_ref()?;
    let [_, highest] = latest.job.request.options.band;
    let lowest = LEAST_PERIODS * omega_of_one_period;
    if lowest < highest {
        Some(Remedy {
            short: format!("Start at {lowest:.2} rad/s"),
            ..use_band([lowest, highest])
        })
    } else {
        None
    }
}

/// Returns a remedy that leaves a record out; `None` if it is not in use, or if no other record
/// remains for the fit.
fn leave_out(records: &ConditionRecords, name: &str) -> Option<Remedy> {
    let index = used_row(records, name)?;
    let another_is_fitted = records
        .used_rows()
        .any(|(other, row)| other != index && !row.guess.held_out);
    if another_is_fitted {
        Some(Remedy::new(
            "Leave out",
            format!("Leave {name} out"),
            RecordsCommand::SetUsed(index, false),
        ))
    } else {
        None
    }
}

/// Returns a remedy that includes a held-out record in the fit; `None` if the record is not in use.
fn fit_held_out(records: &ConditionRecords, name: &str) -> Option<Remedy> {
    let index = used_row(records, name)?;
    Some(Remedy::new(
        "Fit it too",
        format!("Fit {name} too"),
        RecordsCommand::SetHeldOut(index, false),
    ))
}

fn used_row(records: &ConditionRecords, name: &str) -> Option<usize> {
    let (index, _) = records
        .used_rows()
        .find(|(_, row)| row.table.name == name)?;
    Some(index)
}

fn show_inputs() -> Remedy {
    Remedy::new(
        "Inputs",
        "Show the inputs",
        RecordsCommand::ShowPage(RecordsPage::Inputs),
    )
}

fn choose_order() -> Remedy {
    Remedy::new(
        "Set order…",
        "Set an order…",
        RecordsCommand::ShowAdvanced(ORDERS),
    )
}

/// Returns remedies that select a reference, for at most [`MOST_REFERENCES`] columns whose names
/// suggest one, and a remedy that lists all possible columns. Empty if there are none.
fn reference_remedies(ui: &Ui, records: &ConditionRecords) -> Vec<Remedy> {
    let possible = possible_references(ui, records);
    let mut remedies = Vec::new();
    for reference in possible
        .iter()
        .filter(|reference| reference.is_suggested)
        .take(MOST_REFERENCES)
    {
        let column = &reference.column;
        remedies.push(Remedy::new(
            "Use reference",
            format!("Use {column} as reference"),
            RecordsCommand::SetReferences(vec![column.clone()]),
        ));
    }
    if !possible.is_empty() {
        remedies.push(Remedy::new(
            "Choose…",
            "Choose a reference…",
            RecordsCommand::ShowAdvanced(REFERENCES),
        ));
    }
    remedies
}
