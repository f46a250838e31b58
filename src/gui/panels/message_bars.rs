//! Message bars: each states a fact about the program or its files, and offers remedies. They are
//! shown in the place of the toasts, so that they cover no plot and move nothing.

use egui::Ui;

use gdcm_model::number_format::counted;
use gdcm_study::decisions::dataset_differences::{Difference, NotApplied};
use gdcm_words::dataset_differences::dataset_difference_text;

use crate::gui::commands::command::Command;
use crate::gui::commands::computing::ComputingCommand;
use crate::gui::commands::file::FileCommand;
use crate::gui::commands::form::FormCommand;
use crate::gui::commands::output::OutputCommand;
use crate::gui::state::notices::{FaultReport, MessageBar, RecoveryOffer};
use crate::gui::widgets::elision::{elided, end_elided, text_width};
use crate::gui::widgets::palette::{BODY_SIZE, body};

/// Continues the name of a file that has changed.
const CHANGED: &str = " has changed on disk";

/// Button of a message bar.
pub(super) struct BarButton {
    pub(super) text: &'static str,
    /// Accessible name.
    pub(super) name: &'static str,
    pub(super) command: Command,
}

impl BarButton {
    fn new(text: &'static str, command: impl Into<Command>) -> Self {
        Self {
            text,
            name: text,
            command: command.into(),
        }
    }

    fn named(self, name: &'static str) -> Self {
        Self { name, ..self }
    }
}

/// Returns the whole sentence of a message bar.
pub(super) fn bar_sentence(bar: &MessageBar) -> String {
    match bar {
        MessageBar::Fault(report) => fault_sentence(report),
        MessageBar::Recovery(offer) => recovery_sentence(offer),
        MessageBar::Changed { name } => format!("{name}{CHANGED}"),
        MessageBar::Differences { name, differences } => {
            format!("{name}{}", difference_count(differences))
        }
    }
}

/// Returns the sentence, shortened to a line of `room` \[pt\]: if it begins with a file name, this
/// is elided in its middle; other sentences are elided at their end.
pub(super) fn bar_line(ui: &Ui, bar: &MessageBar, room: f32) -> String {
    match bar {
        MessageBar::Fault(_) | MessageBar::Recovery(_) => {
            end_elided(ui, &bar_sentence(bar), room, BODY_SIZE)
        }
        MessageBar::Changed { name } => line_with_name(ui, name, CHANGED, room),
        MessageBar::Differences { name, differences } => {
            line_with_name(ui, name, &difference_count(differences), room)
        }
    }
}

fn line_with_name(ui: &Ui, name: &str, rest: &str, room: f32) -> String {
    let room = room - text_width(ui, rest, body());
    format!("{}{rest}", elided(ui, name, room, BODY_SIZE))
}

/// Continues the name of a reloaded file, for example with " reloaded: 3 differences, 1 decision
/// lost". A decision is lost if it does not apply to the reloaded dataset, unless the study keeps it
/// for another one.
fn difference_count(differences: &[Difference]) -> String {
    let count = counted(differences.len(), "difference");
    let lost = differences
        .iter()
        .filter(|difference| is_lost_decision(difference))
        .count();
    if lost == 0 {
        format!(" reloaded: {count}")
    } else {
        format!(" reloaded: {count}, {} lost", counted(lost, "decision"))
    }
}

fn is_lost_decision(difference: &Difference) -> bool {
    match difference {
        Difference::NotApplied { why, .. } => *why != NotApplied::KeptForAnotherDataset,
        _ => false,
    }
}

/// States the interrupted work, that the decisions are kept, and the details to send.
fn fault_sentence(report: &FaultReport) -> String {
    let FaultReport {
        work,
        dataset,
        version,
        fault,
    } = report;
    format!(
        "A fault in the program ended {work}; your decisions are kept and can be saved: please send this message, the \
         saved study and the dataset {dataset} to the program's authors (gdcm {version}: {fault})."
    )
}

/// Formats, for example, "Unsaved decisions of 14:32 on 21 Nov 2026 for data.json.gz (study
/// mine.gdcm-study.json)".
fn recovery_sentence(offer: &RecoveryOffer) -> String {
    let study = match &offer.study {
        Some(name) => format!(" (study {name})"),
        None => String::new(),
    };
    format!(
        "Unsaved decisions of {} for {}{study}",
        offer.kept_at, offer.dataset
    )
}

/// Returns the details of a message bar, a sentence each, which the list below its line shows; none
/// if the line says everything.
pub(super) fn bar_details(bar: &MessageBar) -> Vec<String> {
    match bar {
        MessageBar::Fault(report) => vec![fault_sentence(report)],
        MessageBar::Differences { differences, .. } => {
            differences.iter().map(dataset_difference_text).collect()
        }
        MessageBar::Recovery(_) | MessageBar::Changed { .. } => Vec::new(),
    }
}

/// Returns the buttons, from left to right.
pub(super) fn bar_buttons(bar: &MessageBar) -> Vec<BarButton> {
    let close = FormCommand::CloseBar(bar.clone());
    match bar {
        MessageBar::Fault(report) => vec![
            BarButton::new("Compute again", ComputingCommand::Compute),
            BarButton::new("Copy", OutputCommand::CopyText(fault_sentence(report)))
                .named("Copy this message"),
            BarButton::new("×", close).named("Close message"),
        ],
        MessageBar::Recovery(offer) => vec![
            BarButton::new("Restore", FileCommand::RestoreRecovery(offer.number)),
            BarButton::new("Discard", FileCommand::DiscardRecovery(offer.number)),
            BarButton::new("Later", close),
        ],
        MessageBar::Changed { .. } => vec![
            BarButton::new("Reload", FileCommand::Reload),
            BarButton::new("Keep", FileCommand::KeepOpen).named("Keep the open dataset"),
        ],
        MessageBar::Differences { .. } => {
            vec![BarButton::new("×", close).named("Close list")]
        }
    }
}
