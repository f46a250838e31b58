//! The files that an export writes, with the first lines of the selected file, and what the files
//! omit or approximate.

use egui::{Button, Frame, Label, RichText, Role, ScrollArea, Sense, Stroke, Ui, UiBuilder, vec2};

use gdcm_io::export::export_set::{ExportPlan, PlannedFile, PlannedNote};
use gdcm_io::report::Report;
use gdcm_model::number_format::counted;
use gdcm_words::export::{
    export_note_detail, export_note_title, export_remedy_text, file_summary_text,
};

use crate::gui::commands::command::Command;
use crate::gui::commands::output::OutputCommand;
use crate::gui::state::window_state::State;
use crate::gui::widgets::controls::{Asks, named, named_switch};
use crate::gui::widgets::elision::{end_elided, text_width};
use crate::gui::widgets::painted_text::{AT_RIGHT_END, painted_text};
use crate::gui::widgets::palette::{BODY_SIZE, Palette, SMALL_SIZE, body, medium};

/// Row height for a file \[pt\].
const ROW: f32 = 24.0;
/// Maximum height of the file list \[pt\].
const FILES: f32 = 7.0 * ROW;
/// Height of the area with a file's first lines \[pt\].
const FIRST_LINES: f32 = 104.0;

/// Draws the files with their sizes, and the first lines of the selected file.
pub(super) fn files_ui(ui: &mut Ui, state: &mut State, palette: &Palette) {
    let plan = state.forms.export.plan.as_ref().map(|(_, plan)| plan);
    let is_current = state.current_export_plan().is_some();
    let summary = match plan {
        Some(plan) if is_current => total_words(state, plan),
        _ => waiting_words(state),
    };
    heading_ui(ui, "Files to write", &summary, palette);
    let Some(plan) = plan else {
        ui.add_space(ROW);
        return;
    };
    let mut selected = state.forms.export.selected;
    if selected >= plan.file_count() {
        selected = 0;
    }
    let entries = entries(state, plan);
    // While a new dry run is computed, the older one stays, dimmed.
    ui.scope(|ui| {
        if !is_current {
            ui.set_opacity(0.5);
        }
        ScrollArea::vertical()
            .id_salt("exported files")
            .max_height(FILES)
            .show(ui, |ui| {
                ui.spacing_mut().item_spacing.y = 0.0;
                for (index, entry) in entries.iter().enumerate() {
                    if entry_ui(ui, entry, index == selected, palette) {
                        selected = index;
                    }
                }
            });
        ui.add_space(6.0);
        if let Some(entry) = entries.get(selected) {
            first_lines_ui(ui, entry, palette);
        }
    });
    state.forms.export.selected = selected;
}

/// Row of the list of files.
struct Entry<'a> {
    name: &'a str,
    /// Contents of the file, or why it cannot be written.
    words: String,
    /// Size, as far as it is known.
    size: String,
    /// First lines of the file, or the headings of the report.
    first_lines: &'a [String],
    is_fault: bool,
}

impl<'a> Entry<'a> {
    fn of_file(file: &'a PlannedFile) -> Self {
        match &file.contents {
            Ok(contents) => Self {
                name: &file.name,
                words: file_summary_text(&contents.summary),
                size: size_words(contents.bytes.len()),
                first_lines: &contents.head,
                is_fault: false,
            },
            Err(fault) => Self {
                name: &file.name,
                words: fault.to_string(),
                size: String::new(),
                first_lines: &[],
                is_fault: true,
            },
        }
    }

    /// Describes the report: its contents once it is composed, before that the progress.
    fn of_report(name: &'a str, report: Option<&'a Report>, state: &State) -> Self {
        let progress = state.results.background.report_contents;
        let (words, size, first_lines) = match (report, progress) {
            (Some(report), _) => (
                file_summary_text(&report.summary),
                size_words(report.html.len()),
                report.headings.as_slice(),
            ),
            (None, Some(steps)) => {
                let words = format!("computing, {} % …", steps.percent());
                (words, String::new(), [].as_slice())
            }
            (None, None) => {
                let words = "computed when the report is written";
                (words.to_owned(), String::new(), [].as_slice())
            }
        };
        Self {
            name,
            words,
            size,
            first_lines,
            is_fault: false,
        }
    }
}

/// Returns the rows of the files, the report last.
fn entries<'a>(state: &'a State, plan: &'a ExportPlan) -> Vec<Entry<'a>> {
    let mut entries: Vec<Entry<'_>> = plan.files.iter().map(Entry::of_file).collect();
    if let Some(name) = &plan.report {
        entries.push(Entry::of_report(name, composed_report(state), state));
    }
    entries
}

/// Returns the report on the displayed analysis, once it is composed.
fn composed_report(state: &State) -> Option<&Report> {
    let analysis = state.results.analysis.as_ref()?;
    let report = state.forms.export.report_of(analysis)?;
    Some(report)
}

/// Returns "4 files, 863 kB"; the size of a report that is still being composed is unknown.
fn total_words(state: &State, plan: &ExportPlan) -> String {
    let count = counted(plan.file_count(), "file");
    match (&plan.report, composed_report(state)) {
        (None, _) => format!("{count}, {}", size_words(plan.size())),
        (Some(_), Some(report)) => {
            format!("{count}, {}", size_words(plan.size() + report.html.len()))
        }
        (Some(_), None) if plan.files.is_empty() => count,
        (Some(_), None) => format!("{count}, {} without the report", size_words(plan.size())),
    }
}

/// Explains why there is no current dry run.
fn waiting_words(state: &State) -> String {
    if let Some(message) = state.incomplete_results() {
        return message.text;
    }
    match state.forms.export.export_set() {
        Ok(_) => "computing …".to_owned(),
        Err(message) => message.text,
    }
}

/// Draws a heading with a remark at the right.
fn heading_ui(ui: &mut Ui, text: &str, remark: &str, palette: &Palette) {
    let (line, _) = ui.allocate_exact_size(vec2(ui.available_width(), 22.0), Sense::hover());
    let heading = painted_text(ui, line, 0.0, text, medium(BODY_SIZE), palette.text);
    let room = line.right() - heading.right() - 16.0;
    let remark = end_elided(ui, remark, room, BODY_SIZE);
    painted_text(ui, line, AT_RIGHT_END, &remark, body(), palette.dim_text);
}

/// Draws the row of a file; returns whether it was clicked.
fn entry_ui(ui: &mut Ui, entry: &Entry<'_>, is_selected: bool, palette: &Palette) -> bool {
    let (row, response) = ui.allocate_exact_size(vec2(ui.available_width(), ROW), Sense::click());
    let fill = if is_selected {
        palette.selected
    } else if response.hovered() {
        palette.raised
    } else {
        palette.panel
    };
    ui.painter().rect_filled(row, 4.0, fill);
    let inner = row.shrink2(vec2(8.0, 0.0));
    let color = if entry.is_fault {
        palette.warning
    } else {
        palette.dim_text
    };
    let name = painted_text(ui, inner, 0.0, entry.name, body(), palette.text);
    let room = inner.right() - name.right() - 20.0 - text_width(ui, &entry.size, body());
    let shown = end_elided(ui, &entry.words, room, BODY_SIZE);
    let rest = inner.with_min_x(name.right() + 10.0);
    painted_text(ui, rest, 0.0, &shown, body(), color);
    painted_text(
        ui,
        inner,
        AT_RIGHT_END,
        &entry.size,
        body(),
        palette.dim_text,
    );
    let label = format!("File {}", entry.name);
    let response = named_switch(response, Role::Button, is_selected, label);
    let is_clicked = response.clicked();
    if shown != entry.words {
        response.on_hover_text(&entry.words);
    }
    is_clicked
}

/// Draws the first lines of a file, or why it cannot be written.
fn first_lines_ui(ui: &mut Ui, entry: &Entry<'_>, palette: &Palette) {
    let frame = Frame::new()
        .fill(palette.background)
        .stroke(Stroke::new(1.0, palette.line))
        .corner_radius(6.0)
        .inner_margin(8.0);
    frame.show(ui, |ui| {
        ui.set_width(ui.available_width());
        ui.set_height(FIRST_LINES - 16.0);
        ScrollArea::both()
            .id_salt(("head", entry.name))
            .auto_shrink(false)
            .show(ui, |ui| {
                ui.spacing_mut().item_spacing.y = 1.0;
                for line in entry.first_lines {
                    let text = RichText::new(line).size(SMALL_SIZE).color(palette.text);
                    ui.add(Label::new(text).extend());
                }
                if entry.is_fault {
                    ui.add(Label::new(palette.small_warning(&entry.words)).wrap());
                }
            });
    });
}

/// Draws what the files omit or approximate, with remedies if there are any.
pub(super) fn notes_ui(ui: &mut Ui, state: &State, palette: &Palette, commands: &mut Vec<Command>) {
    let Some((_, plan)) = &state.forms.export.plan else {
        return;
    };
    let remark = plan.notes.len().to_string();
    heading_ui(ui, "Not included, or approximate", &remark, palette);
    ScrollArea::vertical()
        .id_salt("omitted or approximate")
        .auto_shrink(false)
        .show(ui, |ui| {
            ui.spacing_mut().item_spacing.y = 2.0;
            if state.current_export_plan().is_none() {
                ui.set_opacity(0.5);
            }
            let is_complete = plan.report.is_none() || composed_report(state).is_some();
            if plan.notes.is_empty() && is_complete {
                ui.label(palette.dim("Everything is included exactly"));
            }
            for (index, planned) in plan.notes.iter().enumerate() {
                if index > 0 {
                    ui.separator();
                }
                note_ui(ui, planned, plan, state, palette, commands);
            }
        });
}

/// Draws a note: its statement and remedy, the files concerned, and the reason.
fn note_ui(
    ui: &mut Ui,
    planned: &PlannedNote,
    plan: &ExportPlan,
    state: &State,
    palette: &Palette,
    commands: &mut Vec<Command>,
) {
    let dataset = state.dataset();
    let width = ui.available_width();
    let (line, _) = ui.allocate_exact_size(vec2(width, 20.0), Sense::hover());
    painted_text(ui, line, 0.0, "⚠", body(), palette.warning);
    let words = line.with_min_x(line.left() + 20.0);
    let title = export_note_title(&planned.note, dataset);
    let mut room = words.width();
    if let Some(remedy) = planned.note.remedy() {
        let text = export_remedy_text(remedy);
        let button_width = text_width(ui, &text, body()) + 10.0;
        room -= button_width + 8.0;
        let place = words.with_min_x(words.right() - button_width);
        let button = Button::new(RichText::new(text).color(palette.accent)).frame(false);
        let mut place_ui = ui.new_child(UiBuilder::new().max_rect(place));
        place_ui
            .add(button)
            .asks(OutputCommand::ApplyExportRemedy(remedy), commands);
    }
    let shown = end_elided(ui, &title, room, BODY_SIZE);
    painted_text(ui, words, 0.0, &shown, body(), palette.text);
    let label = ui.interact(
        words.with_max_x(words.left() + room),
        ui.scope_id().with(("note", planned.note.code(), &title)),
        Sense::hover(),
    );
    named(label, Role::Label, title);
    let scheduling = state.study.settings.schedule_delays;
    let detail = export_note_detail(&planned.note, dataset, scheduling);
    let names = file_words(planned, plan);
    let text = if detail.is_empty() {
        names
    } else {
        format!("{names}; {detail}")
    };
    ui.horizontal_top(|ui| {
        ui.add_space(20.0);
        let text = RichText::new(text).color(palette.dim_text);
        ui.add(Label::new(text).wrap());
    });
}

/// Lists the files to which a note refers: "every file", or extensions where these identify a file,
/// else names.
fn file_words(planned: &PlannedNote, plan: &ExportPlan) -> String {
    if planned.files.len() == plan.file_count() && plan.file_count() > 1 {
        return "every file".to_owned();
    }
    let names: Vec<String> = planned
        .files
        .iter()
        .filter_map(|&index| short_name(plan, index))
        .collect();
    names.join(", ")
}

/// Returns ".m" if only this file has the extension, else the file name.
fn short_name(plan: &ExportPlan, index: usize) -> Option<String> {
    let name = plan.file_name(index)?;
    let Some((_, extension)) = name.rsplit_once('.') else {
        return Some(name.to_owned());
    };
    let ending = format!(".{extension}");
    let mut count = 0;
    for other in 0..plan.file_count() {
        if plan
            .file_name(other)
            .is_some_and(|other| other.ends_with(&ending))
        {
            count += 1;
        }
    }
    if count == 1 {
        Some(ending)
    } else {
        Some(name.to_owned())
    }
}

/// Formats a size in bytes, such as "863 kB".
fn size_words(bytes: usize) -> String {
    let kilobytes = bytes as f64 / 1e3;
    if bytes < 1000 {
        format!("{bytes} B")
    } else if kilobytes < 9.95 {
        format!("{kilobytes:.1} kB")
    } else if kilobytes < 999.5 {
        format!("{kilobytes:.0} kB")
    } else {
        format!("{:.1} MB", 1e-3 * kilobytes)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sizes_have_three_digits_at_most() {
        let sizes = [999, 5_200, 42_000, 862_900, 1_234_567];
        let words = sizes.map(size_words);
        assert_eq!(words, ["999 B", "5.2 kB", "42 kB", "863 kB", "1.2 MB"]);
    }
}
