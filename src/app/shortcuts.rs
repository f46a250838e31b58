//! Keys that work wherever the focus is, except while text is typed.

use egui::{Context, Key, KeyboardShortcut, Modifiers};

use crate::dataset::Pair;
use crate::study::Edit;
use crate::view::command::{Command, FormKind};
use crate::view::state::State;

const CTRL: Modifiers = Modifiers::COMMAND;
const CTRL_SHIFT: Modifiers = Modifiers { shift: true, ..Modifiers::COMMAND };

/// The commands of the keys pressed since the last frame.
pub fn pressed(ctx: &Context, state: &State) -> Vec<Command> {
    let mut commands = Vec::new();
    let table = [
        (CTRL_SHIFT, Key::Z, Command::Redo),
        (CTRL, Key::Y, Command::Redo),
        (CTRL, Key::Z, Command::Undo),
        (CTRL_SHIFT, Key::O, Command::ShowForm(Some(FormKind::Open))),
        (CTRL, Key::O, Command::AskOpen),
        (CTRL_SHIFT, Key::S, Command::AskSaveStudy),
        (CTRL, Key::S, Command::SaveStudy),
        (CTRL, Key::E, Command::ShowForm(Some(FormKind::Export))),
        (CTRL, Key::Q, Command::Quit),
        (Modifiers::NONE, Key::F1, Command::ShowForm(Some(FormKind::Shortcuts))),
    ];
    for (modifiers, key, command) in table {
        let shortcut = KeyboardShortcut::new(modifiers, key);
        if ctx.input_mut(|input| input.consume_shortcut(&shortcut)) {
            commands.push(command);
        }
    }
    if ctx.input_mut(|input| input.consume_key(CTRL, Key::R)) {
        commands.extend(reject_suggested(state));
    }
    if !ctx.egui_wants_keyboard_input() && state.forms.shown.is_none() {
        commands.extend(navigation(ctx, state));
    }
    commands
}

fn reject_suggested(state: &State) -> Option<Command> {
    let condition = state.condition().id();
    let rejected = &state.study.choice(condition).physics.rejected;
    let suggested = state.shown()?.suggested();
    let models: Vec<String> = suggested.into_iter().filter(|model| !rejected.contains(model)).collect();
    (!models.is_empty()).then(|| Edit::RejectAll { condition, models }.into())
}

/// Arrows go through conditions and responses; F fits. Only while nothing else has the keyboard.
fn navigation(ctx: &Context, state: &State) -> Vec<Command> {
    let mut commands = Vec::new();
    let pressed = |key| ctx.input_mut(|input| input.consume_key(Modifiers::NONE, key));
    if ctx.memory(|memory| memory.focused().is_some()) {
        return commands;
    }
    let conditions = state.dataset().conditions();
    let at = conditions.iter().position(|condition| condition.id() == state.condition().id()).unwrap_or(0);
    if pressed(Key::ArrowDown) && at + 1 < conditions.len() {
        commands.push(Command::SelectCondition(conditions[at + 1].id()));
    }
    if pressed(Key::ArrowUp) && at > 0 {
        commands.push(Command::SelectCondition(conditions[at - 1].id()));
    }
    let (inputs, outputs) = (state.dataset().inputs().len(), state.dataset().outputs().len());
    let place = state.display.pair.output * inputs + state.display.pair.input;
    if pressed(Key::ArrowRight) && place + 1 < inputs * outputs {
        commands.push(Command::FocusPair(Pair::new((place + 1) / inputs, (place + 1) % inputs)));
    }
    if pressed(Key::ArrowLeft) && place > 0 {
        commands.push(Command::FocusPair(Pair::new((place - 1) / inputs, (place - 1) % inputs)));
    }
    if pressed(Key::F) {
        commands.push(Command::FitPlots);
    }
    let display = &state.display;
    if (display.isolated.is_some() || !display.curves.selected.is_empty()) && pressed(Key::Escape) {
        commands.push(Command::EndIsolation);
    }
    commands
}
