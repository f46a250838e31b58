//! Carries out commands. Views change the state only through commands, except for their own caches,
//! zoom, sorting and typed texts. Each group of commands has its own file.

use gdcm_model::dataset::{ConditionId, ModelId};

use super::GdcmApp;
use crate::gui::commands::command::Command;

/// Elements under the pointer.
struct Pointed {
    model: Option<ModelId>,
    condition: Option<ConditionId>,
    /// Description in the status bar.
    description: Option<String>,
    /// Frequency \[rad/s\].
    cursor: Option<f64>,
}

impl GdcmApp {
    /// Carries out a command as a click or a key would.
    pub fn dispatch(&mut self, command: impl Into<Command>) {
        self.carry_out_command(command.into());
        self.ctx.request_repaint();
    }

    /// Carries out a frame's commands.
    ///
    /// No repaint is requested for a command: it stems from a key, a click or a pointer movement,
    /// after which egui draws another frame by itself. The elements under the pointer may also
    /// change without input, when the content moves under a resting pointer.
    pub(super) fn carry_out(&mut self, commands: Vec<Command>) {
        let before = self.take_pointed();
        for command in commands {
            self.carry_out_command(command);
        }
        if !self.is_same_pointed(&before) {
            self.ctx.request_repaint();
        }
    }

    /// Takes the elements under the pointer; each frame's commands set them again.
    fn take_pointed(&mut self) -> Pointed {
        let display = &mut self.state.display;
        Pointed {
            model: display.selection.hovered.take(),
            condition: display.selection.hovered_condition.take(),
            description: display.selection.pointed_words.take(),
            cursor: display.curves.cursor.take(),
        }
    }

    /// Returns whether the elements under the pointer are the same as `before`.
    fn is_same_pointed(&self, before: &Pointed) -> bool {
        let selection = &self.state.display.selection;
        selection.hovered == before.model
            && selection.hovered_condition == before.condition
            && selection.pointed_words == before.description
            && self.state.display.curves.cursor == before.cursor
    }

    /// Carries out a command without requesting a repaint.
    pub(super) fn carry_out_command(&mut self, command: Command) {
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
            Command::Assembling(command) => self.carry_out_assembling(command),
            Command::Records(command) => self.carry_out_records(command),
        }
    }
}
