//! Bars of the window: menus at the top, messages below them, and the computation status at the
//! foot.

use egui::{
    Align, Button, CollapsingHeader, Frame, Key, KeyboardShortcut, Label, Layout, Margin, MenuBar,
    Modifiers, Rect, RichText, Role, Sense, Stroke, StrokeKind, ThemePreference, Ui, pos2, vec2,
};

use gdcm_model::dataset::{BundleKind, Condition};
use gdcm_words::assessment::not_assessed_text;

use crate::gui::commands::command::Command;
use crate::gui::commands::command_table::command_table;
use crate::gui::commands::computing::ComputingCommand;
use crate::gui::commands::entry::Menu;
use crate::gui::commands::file::FileCommand;
use crate::gui::commands::form::FormCommand;
use crate::gui::commands::layout::LayoutCommand;
use crate::gui::commands::output::OutputCommand;
use crate::gui::commands::study::StudyCommand;
use crate::gui::state::forms::FormKind;
use crate::gui::state::notices::{Bar, NoticeKind};
use crate::gui::state::records::RecordsState;
use crate::gui::state::results::{Background, bar_words};
use crate::gui::state::window_state::{RecentFile, State};
use crate::gui::widgets::controls::{
    Asks, button_ui, elided, in_line_ui, named, painted_text, text_width,
};
use crate::gui::widgets::palette::{BODY_SIZE, Palette, SMALL_SIZE, body, medium, small};

/// Draws the menus, the last step, the state of the document, and the search field for commands.
pub fn menu_bar_ui(ui: &mut Ui, state: &State, palette: &Palette, commands: &mut Vec<Command>) {
    let bar = ui.available_rect_before_wrap();
    let left = in_line_ui(ui, bar, false, |ui| {
        let shown = MenuBar::new().ui(ui, |ui| {
            ui.label(RichText::new("gdcm").font(medium(BODY_SIZE)));
            ui.add_space(4.0);
            let file = ui.menu_button("File", |ui| menu_ui(ui, state, Menu::File, commands));
            file.response.asks(FileCommand::LookForRecent, commands);
            for (name, menu) in [
                ("Edit", Menu::Edit),
                ("View", Menu::View),
                ("Help", Menu::Help),
            ] {
                ui.menu_button(name, |ui| menu_ui(ui, state, menu, commands));
            }
            ui.separator();
            history_ui(ui, state, commands);
            ui.cursor().left()
        });
        shown.inner
    });
    let rest = bar.with_min_x(left.inner + 8.0);
    let right = in_line_ui(ui, rest, true, |ui| {
        theme_ui(ui, commands);
        search_ui(ui, palette, commands)
    });
    let room = rest.with_max_x(right.inner - 8.0);
    title_ui(ui, bar, room, state, palette);
    ui.advance_cursor_after_rect(bar);
}

/// Draws the field that opens the command palette; returns its left edge.
fn search_ui(ui: &mut Ui, palette: &Palette, commands: &mut Vec<Command>) -> f32 {
    let (rect, response) = ui.allocate_exact_size(vec2(168.0, 24.0), Sense::click());
    let line = if response.hovered() {
        palette.dim_text
    } else {
        palette.line
    };
    ui.painter().rect(
        rect,
        6.0,
        palette.background,
        Stroke::new(1.0, line),
        StrokeKind::Inside,
    );
    let inner = rect.shrink2(vec2(9.0, 0.0));
    painted_text(ui, inner, 0.0, "Find a command", body(), palette.dim_text);
    let keys = KeyboardShortcut::new(Modifiers::COMMAND, Key::K);
    let keys = ui.ctx().format_shortcut(&keys);
    painted_text(ui, inner, -0.01, &keys, small(), palette.dim_text);
    named(response, Role::Button, "Find a command")
        .asks(FormCommand::ShowForm(Some(FormKind::Palette)), commands);
    rect.left()
}

/// Draws the entries of a menu, in groups separated by lines.
fn menu_ui(ui: &mut Ui, state: &State, menu: Menu, commands: &mut Vec<Command>) {
    let entries = command_table(state).into_iter().filter_map(|entry| {
        let (within, group) = entry.menu?;
        (within == menu).then_some((group, entry))
    });
    let mut last = None;
    for (group, entry) in entries {
        if last.replace(group).is_some_and(|last| last != group) {
            ui.separator();
        }
        let is_recent_place =
            entry.command == Command::File(FileCommand::OpenExample) && !state.recent.is_empty();
        if is_recent_place {
            ui.menu_button("Open recent", |ui| recent_menu_ui(ui, state, commands));
        }
        let keys = entry
            .shortcuts
            .first()
            .map(|shortcut| ui.ctx().format_shortcut(shortcut));
        let button = Button::new(entry.name.as_str());
        // Empty text would add a trailing space to the button's name.
        let button = if let Some(keys) = keys {
            button.shortcut_text(keys)
        } else {
            button
        };
        let response = ui.add_enabled(entry.enabled, button);
        if response.on_hover_text(entry.meaning).clicked() {
            commands.push(entry.command);
            ui.close();
        }
    }
    if menu == Menu::View {
        ui.separator();
        ui.menu_button("Curves", |ui| menu_ui(ui, state, Menu::Curves, commands));
    }
}

/// Draws the recent files, newest first; missing files are disabled.
fn recent_menu_ui(ui: &mut Ui, state: &State, commands: &mut Vec<Command>) {
    for RecentFile {
        path,
        name,
        folder,
        missing,
    } in &state.recent
    {
        let button = Button::new(name.as_str()).right_text(if *missing { "missing" } else { "" });
        let response = ui.add_enabled(!missing, button).on_hover_text(folder);
        if response
            .on_disabled_hover_text(format!("It is not in {folder} any more"))
            .clicked()
        {
            commands.push(FileCommand::Open(path.clone()).into());
            ui.close();
        }
    }
}

fn history_ui(ui: &mut Ui, state: &State, commands: &mut Vec<Command>) {
    for (verb, label, hint, command) in [
        (
            "↶ Undo",
            state.history.undo_label(),
            "Take the last decision back (Ctrl+Z)",
            Command::Study(StudyCommand::Undo),
        ),
        (
            "↷ Redo",
            state.history.redo_label(),
            "Bring it back again (Ctrl+Shift+Z)",
            Command::Study(StudyCommand::Redo),
        ),
    ] {
        let text = label.map_or(verb.to_owned(), |label| format!("{verb} {label}"));
        let button = Button::new(text).frame(false);
        ui.add_enabled_ui(label.is_some(), |ui| {
            button_ui(ui, button, hint, command, commands)
        });
    }
}

/// Draws the theme switch, a half-filled disc.
fn theme_ui(ui: &mut Ui, commands: &mut Vec<Command>) {
    let (name, other) = match ui.visuals().dark_mode {
        true => ("Change to the light theme", ThemePreference::Light),
        false => ("Change to the dark theme", ThemePreference::Dark),
    };
    let button = named(ui.add(Button::new("◐").frame(false)), Role::Button, name);
    button
        .on_hover_text(name)
        .asks(LayoutCommand::SetTheme(other), commands);
}

/// Draws dataset and study in the middle of the bar if there is room.
fn title_ui(ui: &mut Ui, bar: Rect, room: Rect, state: &State, palette: &Palette) {
    let study = format!(
        "{}{}",
        state.study_name,
        if state.unsaved { " · edited" } else { "" }
    );
    let of_study = text_width(ui, &study, body());
    let name = elided(
        ui,
        state.dataset().name(),
        room.width() - of_study - 8.0,
        BODY_SIZE,
    );
    let whole = text_width(ui, &name, medium(BODY_SIZE)) + 8.0 + of_study;
    let left = (bar.center().x - 0.5 * whole)
        .min(room.right() - whole)
        .max(room.left());
    if whole > room.width() {
        return;
    }
    let place = Rect::from_min_size(pos2(left, bar.top()), vec2(whole, bar.height()));
    painted_text(ui, place, 0.0, &name, medium(BODY_SIZE), palette.text);
    painted_text(ui, place, -0.01, &study, body(), palette.dim_text);
    let response = ui.interact(place, ui.scope_id().with("document"), Sense::hover());
    let is_saved = if state.unsaved {
        "There are decisions that are not saved"
    } else {
        "Every decision is saved"
    };
    let response = named(
        response,
        Role::Label,
        format!("{}, {study}", state.dataset().name()),
    );
    response.on_hover_text(format!("{}\n{is_saved}", state.dataset().description()));
}

/// Draws every bar, oldest first.
pub fn bars_ui(ui: &mut Ui, bars: &[Bar], palette: &Palette, commands: &mut Vec<Command>) {
    for bar in bars {
        let frame = Frame::new()
            .fill(palette.raised)
            .inner_margin(Margin::symmetric(10, 5));
        frame
            .corner_radius(3.0)
            .show(ui, |ui| bar_ui(ui, bar, palette, commands));
    }
}

fn bar_ui(ui: &mut Ui, bar: &Bar, palette: &Palette, commands: &mut Vec<Command>) {
    let close = Command::Form(FormCommand::CloseBar(bar.clone()));
    let (sentence, buttons) = match bar {
        Bar::Fault { sentence } => {
            let copy = Command::Output(OutputCommand::CopyText(sentence.clone()));
            let buttons = vec![
                (
                    "Compute again",
                    Command::Computing(ComputingCommand::Compute),
                ),
                ("Copy this message", copy),
                ("Put away", close),
            ];
            (sentence.clone(), buttons)
        }
        Bar::Recovery { offer, sentence } => {
            let restore = Command::File(FileCommand::RestoreRecovery(*offer));
            let discard = Command::File(FileCommand::DiscardRecovery(*offer));
            (
                sentence.clone(),
                vec![("Restore", restore), ("Discard", discard), ("Later", close)],
            )
        }
        Bar::Changed { name } => {
            let buttons = vec![
                ("Reload", Command::File(FileCommand::Reload)),
                ("Keep what is open", Command::File(FileCommand::KeepOpen)),
            ];
            (format!("{name} has changed on disk."), buttons)
        }
        Bar::Differences { name, sentences } => {
            let number = counted(sentences.len(), "difference");
            (
                format!("{name} was reloaded: {number}."),
                vec![("Put the list away", close)],
            )
        }
    };
    row_ui(ui, &sentence, buttons, palette, commands);
    if let Bar::Differences { sentences, .. } = bar {
        list_ui(ui, sentences);
    }
}

/// "1 difference", "3 differences".
fn counted(count: usize, what: &str) -> String {
    format!("{count} {what}{}", if count == 1 { "" } else { "s" })
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

/// Draws the first few sentences and folds the others, which leaves the plots their space.
fn list_ui(ui: &mut Ui, sentences: &[String]) {
    const SHOWN: usize = 4;
    let (first, rest) = sentences.split_at(sentences.len().min(SHOWN));
    let sentence_ui = |ui: &mut Ui, sentence: &String| {
        ui.label(RichText::new(format!("    {sentence}")).size(SMALL_SIZE))
    };
    first
        .iter()
        .for_each(|sentence| drop(sentence_ui(ui, sentence)));
    if !rest.is_empty() {
        let header = RichText::new(format!("{} more", rest.len())).size(SMALL_SIZE);
        CollapsingHeader::new(header)
            .id_salt("differences")
            .show(ui, |ui| {
                egui::ScrollArea::vertical()
                    .max_height(160.0)
                    .show(ui, |ui| {
                        rest.iter()
                            .for_each(|sentence| drop(sentence_ui(ui, sentence)));
                    });
            });
    }
}

/// Draws the computation status on the left and the message or standing remark on the right.
pub fn status_bar_ui(ui: &mut Ui, state: &State, palette: &Palette, commands: &mut Vec<Command>) {
    ui.horizontal_centered(|ui| {
        computation_ui(ui, state, palette, commands);
        ui.with_layout(Layout::right_to_left(Align::Center), |ui| {
            match (&state.display.selection.told, &state.notice) {
                (Some(told), _) => {
                    drop(ui.add(Label::new(RichText::new(told).size(SMALL_SIZE)).truncate()))
                }
                (None, Some(notice)) => {
                    button_ui(
                        ui,
                        Button::new("Dismiss").small(),
                        "",
                        FormCommand::DismissNotice,
                        commands,
                    );
                    let color = if notice.kind == NoticeKind::Done {
                        palette.text
                    } else {
                        palette.warning
                    };
                    let text = RichText::new(&notice.text).size(SMALL_SIZE).color(color);
                    ui.add(Label::new(text).truncate())
                        .on_hover_text(&notice.text);
                }
                (None, None) => {
                    ui.add(Label::new(palette.small(standing_remark(state))).truncate());
                }
            }
        });
    });
}

fn computation_ui(ui: &mut Ui, state: &State, palette: &Palette, commands: &mut Vec<Command>) {
    let now = ui.input(|input| input.time);
    // Only the dot is green: the text reports that gains and phase are met.
    let (text, color) = match (
        &state.opening,
        state.results.is_stale(now),
        state.results.background.analysis,
    ) {
        (None, ..) if state.results.stopped => {
            (format!("stopped: {}", state.after_stop()), palette.warning)
        }
        (Some(name), ..) => (format!("reading {name} …"), palette.accent),
        (None, true, Some((done, total))) if total > 0 => (
            format!("computing, {} % …", 100 * done / total),
            palette.warning,
        ),
        (None, true, _) => ("computing …".to_owned(), palette.warning),
        (None, false, _) => ("up to date".to_owned(), palette.good),
    };
    ui.label(RichText::new("●").size(SMALL_SIZE).color(color));
    let words = if color == palette.good {
        palette.dim_text
    } else {
        color
    };
    let label = ui.label(RichText::new(text).size(SMALL_SIZE).color(words));
    if state.analysis().is_some() {
        label.on_hover_text(format!(
            "The newest analysis took {:.1} ms",
            state.results.elapsed_ms
        ));
    }
    let is_stopped = state.results.background.stopped;
    let is_told = state.results.is_background_told(now);
    let beside = match (&state.records.reading, is_stopped) {
        (Some(reading), _) => Some(format!("reading {reading} …")),
        (None, true) => Some("the rest was stopped".to_owned()),
        (None, false) => {
            is_told.then(|| background_words(&state.results.background, &state.records))
        }
    };
    if let Some(words) = &beside {
        ui.label(palette.small(words));
    }
    let is_reading = state.opening.is_some() || state.records.reading.is_some();
    if !is_reading && (state.results.stopped || is_stopped) {
        button_ui(
            ui,
            Button::new("Compute").small(),
            "",
            ComputingCommand::Compute,
            commands,
        );
    } else if is_reading || state.results.is_stale(now) || beside.is_some() {
        button_ui(
            ui,
            Button::new("Stop").small(),
            "",
            ComputingCommand::StopComputing,
            commands,
        );
    }
    let count = |condition: &Condition| {
        BundleKind::BOTH
            .map(|kind| condition.bundle(kind).len())
            .iter()
            .sum::<usize>()
    };
    let models: usize = state
        .dataset()
        .conditions()
        .iter()
        .map(|condition| count(condition))
        .sum();
    ui.label(palette.small(format!(
        "{models} responses · {} frequencies",
        state.study.settings.points
    )));
    if !state.file_cautions.is_empty() {
        let label = ui.label(palette.small_warning(counted(state.file_cautions.len(), "caution")));
        label.on_hover_text(state.file_cautions.join("\n"));
    }
}

/// Describes the work in progress besides the live answer, longest first.
fn background_words(background: &Background, records: &RecordsState) -> String {
    if let Some((done, total)) = background.report {
        return format!("writing the report, {} % …", 100 * done / total.max(1));
    }
    if let Some((done, total)) = background.identification {
        let percent = 100 * done / total.max(1);
        return match (records.under_way(), records.running.len()) {
            (Some(job), jobs @ 2..) => {
                format!(
                    "identifying condition {}, {percent} %, {} more after it …",
                    job.condition,
                    jobs - 1
                )
            }
            _ => format!("identifying, {percent} % …"),
        };
    }
    if !background.proofs.is_empty() {
        return format!(
            "proving the gains of {} …",
            counted(background.proofs.len(), "condition")
        );
    }
    match (
        background.curves,
        background.bars,
        background.time_histories,
    ) {
        (Some((_, 0)), ..) => "curves …".to_owned(),
        (Some((done, total)), ..) => format!("curves, {} % …", 100 * done / total),
        (None, Some(progress), _) => bar_words(progress),
        (None, None, Some((done, total))) => format!(
            "answers to flight records, {} % …",
            100 * done / total.max(1)
        ),
        (None, None, None) if let Some((done, total)) = background.couplings => {
            format!(
                "couplings without each condition, {} % …",
                100 * done / total.max(1)
            )
        }
        _ if background.views > 0 => "what the views show …".to_owned(),
        _ => "what holding and releasing would cost …".to_owned(),
    }
}

/// Returns the reason why the displayed condition is left out of the assessment, or a remark on the
/// data.
fn standing_remark(state: &State) -> String {
    let id = state.condition().id();
    match state
        .analysis()
        .and_then(|analysis| analysis.assessment.get(&id))
    {
        Some(Err(why)) => format!(
            "condition {id} is left out of the assessment: {}",
            not_assessed_text(why, state.dataset())
        ),
        _ => state.condition().flight_state().name.clone(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_assessment_of_couplings_tells_how_far_it_is() {
        let background = Background {
            couplings: Some((300, 1000)),
            ..Background::default()
        };
        assert!(background.is_busy());
        let words = background_words(&background, &RecordsState::default());
        assert_eq!(words, "couplings without each condition, 30 % …");
    }
}
