//! The bars below the menu: what has to be told until it is dealt with.

use egui::{Align, Button, CollapsingHeader, Frame, Layout, Margin, RichText, Ui};

use super::command::Command;
use super::palette::{Palette, SMALL_SIZE};

/// Something that has happened to the program or to its files.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Bar {
    /// Computing panicked.
    Fault {
        /// What happened, what is kept, and what to send to whom.
        sentence: String,
    },
    /// Decisions of a window that ended without saving them.
    Recovery {
        /// Number of the offer.
        offer: usize,
        /// Whose, and of when.
        sentence: String,
    },
    /// The dataset's file is not what it was when it was opened.
    Changed {
        /// Name of the file.
        name: String,
    },
    /// The dataset was read again, and is not what it was.
    Differences {
        /// Name of the file.
        name: String,
        /// What is different, and which decisions no longer apply.
        sentences: Vec<String>,
    },
}

/// Every bar, the oldest first.
pub fn bars_ui(ui: &mut Ui, bars: &[Bar], palette: &Palette, commands: &mut Vec<Command>) {
    for bar in bars {
        let frame = Frame::new().fill(palette.raised).inner_margin(Margin::symmetric(10, 5));
        frame.corner_radius(3.0).show(ui, |ui| bar_ui(ui, bar, palette, commands));
    }
}

fn bar_ui(ui: &mut Ui, bar: &Bar, palette: &Palette, commands: &mut Vec<Command>) {
    let close = || Command::CloseBar(bar.clone());
    match bar {
        Bar::Fault { sentence } => {
            let copy = Command::CopyText(sentence.clone());
            let buttons = [("Compute again", Command::Compute), ("Copy this message", copy), ("Put away", close())];
            row_ui(ui, sentence, buttons, palette, commands);
        }
        Bar::Recovery { offer, sentence } => {
            let buttons = [
                ("Restore", Command::RestoreRecovery(*offer)),
                ("Discard", Command::DiscardRecovery(*offer)),
                ("Later", close()),
            ];
            row_ui(ui, sentence, buttons, palette, commands);
        }
        Bar::Changed { name } => {
            let buttons = [("Reload", Command::Reload), ("Keep what is open", Command::KeepOpen)];
            row_ui(ui, &format!("{name} has changed on disk."), buttons, palette, commands);
        }
        Bar::Differences { name, sentences } => {
            let count = sentences.len();
            let number = if count == 1 { "1 difference".to_owned() } else { format!("{count} differences") };
            let buttons = [("Put the list away", close())];
            row_ui(ui, &format!("{name} was reloaded: {number}."), buttons, palette, commands);
            list_ui(ui, sentences);
        }
    }
}

/// A sentence that wraps, beside its buttons.
fn row_ui<const N: usize>(
    ui: &mut Ui,
    sentence: &str,
    buttons: [(&str, Command); N],
    palette: &Palette,
    commands: &mut Vec<Command>,
) {
    ui.with_layout(Layout::right_to_left(Align::Min), |ui| {
        for (text, command) in buttons.into_iter().rev() {
            if ui.add(Button::new(text).small()).clicked() {
                commands.push(command);
            }
        }
        ui.with_layout(Layout::left_to_right(Align::Min), |ui| {
            ui.label(RichText::new("●").size(SMALL_SIZE).color(palette.warning));
            ui.add(egui::Label::new(RichText::new(sentence)).wrap());
        });
    });
}

/// A few are shown, more are folded: the plots keep their room.
fn list_ui(ui: &mut Ui, sentences: &[String]) {
    const SHOWN: usize = 4;
    let (first, rest) = sentences.split_at(sentences.len().min(SHOWN));
    let sentence_ui =
        |ui: &mut Ui, sentence: &String| ui.label(RichText::new(format!("    {sentence}")).size(SMALL_SIZE));
    first.iter().for_each(|sentence| drop(sentence_ui(ui, sentence)));
    if !rest.is_empty() {
        let header = RichText::new(format!("{} more", rest.len())).size(SMALL_SIZE);
        CollapsingHeader::new(header).id_salt("differences").show(ui, |ui| {
            egui::ScrollArea::vertical().max_height(160.0).show(ui, |ui| {
                rest.iter().for_each(|sentence| drop(sentence_ui(ui, sentence)));
            });
        });
    }
}
