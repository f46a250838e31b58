//! Carries out commands; no other code changes the displayed state.

use std::fmt::Display as InWords;

use gdcm_model::message_text::{sanitized, shortened_message};

use super::GdcmApp;
use crate::gui::commands::command::Command;
use crate::gui::state::notices::{Notice, NoticeKind};

impl GdcmApp {
    /// Carries out one command, like a click or a key.
    pub fn dispatch(&mut self, command: impl Into<Command>) {
        self.carry_out_one(command.into());
        self.ctx.request_repaint();
    }

    /// Carries out the commands of one frame.
    pub(super) fn carry_out(&mut self, commands: Vec<Command>) {
        let display = &mut self.state.display;
        let pointed = (
            display.selection.hovered.take(),
            display.selection.hovered_condition.take(),
            display.selection.told.take(),
        );
        let before = (pointed, display.curves.cursor.take());
        for command in commands {
            self.carry_out_one(command);
        }
        let display = &self.state.display;
        let ((hovered, condition, told), cursor) = &before;
        let is_pointed = (
            &display.selection.hovered,
            &display.selection.hovered_condition,
            &display.selection.told,
        ) == (hovered, condition, told);
        if !is_pointed || display.curves.cursor != *cursor {
            self.ctx.request_repaint();
        }
    }

    pub(super) fn carry_out_one(&mut self, command: Command) {
        match command {
            Command::Study(command) => self.carry_out_study(command),
            Command::Selection(command) => self.carry_out_selection(command),
            Command::Layout(command) => self.carry_out_layout(command),
            Command::Display(command) => self.carry_out_display(command),
            Command::File(command) => self.carry_out_file(command),
            Command::Output(command) => self.carry_out_output(command),
            Command::Form(command) => self.carry_out_form(command),
            Command::Computing(command) => self.carry_out_computing(command),
            Command::Curves(command) => self.carry_out_curve(command),
            Command::Assembling(command) => self.assemble(command),
            Command::Records(command) => self.records(command),
        }
    }

    /// Notifies the engineer of a completed action.
    pub(super) fn done(&mut self, text: String) {
        self.state.notice = Some(Notice {
            kind: NoticeKind::Done,
            text: shortened_message(&sanitized(&text)),
        });
    }

    /// Returns the value of a success; reports an error to the engineer.
    pub(super) fn unless_error<T, E: InWords>(&mut self, made: Result<T, E>) -> Option<T> {
        made.map_err(|error| self.notify_error(error.to_string()))
            .ok()
    }

    /// Notifies the engineer of a failed action.
    pub(super) fn notify_error(&mut self, text: String) {
        self.state.notice = Some(Notice {
            kind: NoticeKind::Trouble,
            text: shortened_message(&sanitized(&text)),
        });
    }
}
