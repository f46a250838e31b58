//! Message bars below the menu: each states a fact about the program or its files, and offers what
//! can be done.

use egui::{
    Align, Button, CollapsingHeader, Frame, Label, Layout, Margin, RichText, ScrollArea, Ui,
};

use gdcm_model::number_format::counted;
use gdcm_words::dataset_differences::dataset_difference_text;

use crate::gui::commands::command::Command;
use crate::gui::commands::computing::ComputingCommand;
use crate::gui::commands::file::FileCommand;
use crate::gui::commands::form::FormCommand;
use crate::gui::commands::output::OutputCommand;
use crate::gui::state::notices::{FaultReport, MessageBar, RecoveryOffer};
use crate::gui::widgets::controls::button_ui;
use crate::gui::widgets::palette::{Palette, SMALL_SIZE};

/// Draws every message bar, oldest first.
pub fn message_bars_ui(
    ui: &mut Ui,
    bars: &[MessageBar],
    palette: &Palette,
    commands: &mut Vec<Command>,
) {
    for bar in bars {
        let frame = Frame::new()
            .fill(palette.raised)
            .inner_margin(Margin::symmetric(10, 5));
        frame
            .corner_radius(3.0)
            .show(ui, |ui| bar_ui(ui, bar, palette, commands));
    }
}

fn bar_ui(ui: &mut Ui, bar: &MessageBar, palette: &Palette, commands: &mut Vec<Command>) {
    row_ui(ui, &bar_sentence(bar), bar_buttons(bar), palette, commands);
    if let MessageBar::Differences { differences, .. } = bar {
        let sentences: Vec<String> = differences.iter().map(dataset_difference_text).collect();
        list_ui(ui, &sentences);
    }
}

fn bar_sentence(bar: &MessageBar) -> String {
    match bar {
        MessageBar::Fault(report) => fault_sentence(report),
        MessageBar::Recovery(offer) => recovery_sentence(offer),
        MessageBar::Changed { name } => format!("{name} has changed on disk."),
        MessageBar::Differences { name, differences } => {
            let number = counted(differences.len(), "difference");
            format!("{name} was reloaded: {number}.")
        }
    }
}

/// States which work was interrupted, that the decisions are kept, and which details to send.
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

/// Formats "Decisions of 14:32 on 21 Nov 2026 for data.json.gz (study mine.gdcm-study.json) were
/// not saved."
fn recovery_sentence(offer: &RecoveryOffer) -> String {
    let study = match &offer.study {
        Some(name) => format!(" (study {name})"),
        None => String::new(),
    };
    format!(
        "Decisions of {} for {}{study} were not saved.",
        offer.kept_at, offer.dataset
    )
}

fn bar_buttons(bar: &MessageBar) -> Vec<(&'static str, Command)> {
    let close = Command::Form(FormCommand::CloseBar(bar.clone()));
    match bar {
        MessageBar::Fault(report) => vec![
            (
                "Compute again",
                Command::Computing(ComputingCommand::Compute),
            ),
            (
                "Copy this message",
                Command::Output(OutputCommand::CopyText(fault_sentence(report))),
            ),
            ("Close message", close),
        ],
        MessageBar::Recovery(offer) => vec![
            (
                "Restore",
                Command::File(FileCommand::RestoreRecovery(offer.number)),
            ),
            (
                "Discard",
                Command::File(FileCommand::DiscardRecovery(offer.number)),
            ),
            ("Later", close),
        ],
        MessageBar::Changed { .. } => vec![
            ("Reload", Command::File(FileCommand::Reload)),
            (
                "Keep the open dataset",
                Command::File(FileCommand::KeepOpen),
            ),
        ],
        MessageBar::Differences { .. } => vec![("Close list", close)],
    }
}

/// Draws a wrapping sentence with its buttons beside it.
fn row_ui(
    ui: &mut Ui,
    sentence: &str,
    buttons: Vec<(&str, Command)>,
    palette: &Palette,
    commands: &mut Vec<Command>,
) {
    ui.with_layout(Layout::right_to_left(Align::Min), |ui| {
        for (text, command) in buttons.into_iter().rev() {
            button_ui(ui, Button::new(text).small(), "", command, commands);
        }
        ui.with_layout(Layout::left_to_right(Align::Min), |ui| {
            ui.label(palette.small_warning("●"));
            ui.add(Label::new(sentence).wrap());
        });
    });
}

/// Draws the first few sentences and folds the others, so that the plots keep their space.
fn list_ui(ui: &mut Ui, sentences: &[String]) {
    const SHOWN: usize = 4;
    let (first, rest) = sentences.split_at(sentences.len().min(SHOWN));
    for sentence in first {
        sentence_ui(ui, sentence);
    }
    if rest.is_empty() {
        return;
    }
    let header = RichText::new(format!("{} more", rest.len())).size(SMALL_SIZE);
    CollapsingHeader::new(header)
        .id_salt("differences")
        .show(ui, |ui| {
            ScrollArea::vertical().max_height(160.0).show(ui, |ui| {
                for sentence in rest {
                    sentence_ui(ui, sentence);
                }
            });
        });
}

fn sentence_ui(ui: &mut Ui, sentence: &str) {
    ui.label(RichText::new(format!("    {sentence}")).size(SMALL_SIZE));
}
