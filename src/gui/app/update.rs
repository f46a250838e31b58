//! Carries out commands; no other code changes the displayed state.

use std::fmt::Display as InWords;

use egui::ViewportCommand;

use gdcm_io::Existing;
use gdcm_model::dataset::ConditionId;
use gdcm_model::message_text::{sanitized, shortened_message};
use gdcm_study::decisions::history::History;
use gdcm_study::{Edit, Study};

use super::GdcmApp;
use super::files::{DialogPurpose, PendingAction};
use crate::gui::commands::command::{Command, FormKind};
use crate::gui::plot::{FigureView, Pane};
use crate::gui::state::curve_display::CurveCommand;
use crate::gui::state::display::{Arrangement, Display};
use crate::gui::state::focus::leave_region;
use crate::gui::state::window_state::{Notice, NoticeKind, State};
use crate::gui::views::records::{RecordsBefore, RecordsState};
use crate::gui::views::{PairSet, View};
use crate::gui::widgets::controls::focus_field;
use crate::gui::widgets::tables::table_of;

/// Target of the focus.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum NextFocus {
    /// The field with this name.
    Field(&'static str),
    /// The next or the previous region of the window.
    Region { forward: bool },
}

impl GdcmApp {
    /// Saves the study to a file, like the form once a path is typed.
    pub fn save_study_as(&mut self, path: std::path::PathBuf) {
        self.save_as(path, Existing::Keep);
    }

    /// Carries out one command, like a click or a key.
    pub fn dispatch(&mut self, command: Command) {
        self.carry_out_one(command);
        self.ctx.request_repaint();
    }

    /// Carries out the commands of one frame.
    pub(super) fn carry_out(&mut self, commands: Vec<Command>) {
        let display = &mut self.state.display;
        let pointed = (
            display.hovered.take(),
            display.hovered_condition.take(),
            display.told.take(),
        );
        let before = (pointed, display.curves.cursor.take());
        for command in commands {
            self.carry_out_one(command);
        }
        let display = &self.state.display;
        let ((hovered, condition, told), cursor) = &before;
        let is_pointed = (&display.hovered, &display.hovered_condition, &display.told)
            == (hovered, condition, told);
        if !is_pointed || display.curves.cursor != *cursor {
            self.ctx.request_repaint();
        }
    }

    fn carry_out_one(&mut self, command: Command) {
        let display = &mut self.state.display;
        match command {
            Command::Edit(edit) => self.decide(&edit),
            Command::EndEdit => self.state.history.seal(),
            Command::Undo => self.take_study(|history, study, records| {
                history.undo(study, |of| records.exchange(of))
            }),
            Command::Forget(edit) => self.take_study(|history, _, _| history.forget(&edit)),
            Command::Redo => self.take_study(|history, study, records| {
                history.redo(study, |of| records.exchange(of))
            }),
            Command::SelectCondition(condition) => select_condition(display, condition),
            Command::FocusPair(pair) if display.pair != pair => {
                display.pair = pair;
                display.curves.crossings.clear();
                display.refit_frequency_plots();
            }
            Command::FocusPair(_) => {}
            Command::Hover(model) => display.hovered = Some(model),
            Command::HoverCondition(condition) => display.hovered_condition = Some(condition),
            Command::Tell(words) => display.told = Some(words),
            Command::Isolate(model) => {
                display.isolated = if display.isolated.as_ref() == Some(&model) {
                    None
                } else {
                    Some(model)
                };
            }
            Command::ShowView(view) => {
                self.state.on_start_page = false;
                self.state.display.arrangement.show(view);
            }
            Command::ShowGroup(group) => display.arrangement.show_group(group),
            Command::ShowBeside(view) => display.arrangement.show_beside(view),
            Command::ShowInDock(view) => display.arrangement.dock_view(view),
            Command::OpenDock(is_open) => display.arrangement.open_dock(is_open),
            Command::ResetLayout => {
                display.arrangement = Arrangement::default();
                display.left_open = None;
                self.ctx.memory_mut(|memory| memory.reset_areas());
            }
            Command::ShowLeft(is_open) => display.left_open = Some(is_open),
            Command::ShowSheet(sheet) => display.sheet = sheet,
            Command::ShowSettings(is_open) => display.settings_open = is_open,
            Command::ShowAdvanced(is_open) => display.advanced_open = is_open,
            Command::ShowIdentified(is_open) => display.identified_open = is_open,
            Command::MapCost(mapped) => display.mapped_cost = mapped,
            Command::ShowNetGains(pairs) => display.net_gain_pairs = pairs,
            Command::PickPair(pair) => {
                display.net_gain_pairs = PairSet::Picked;
                if !display.picked_pairs.remove(&pair) {
                    display.picked_pairs.insert(pair);
                }
            }
            Command::ShowChannels(measure, across) => display.channel_values = (measure, across),
            Command::Explain(asked) => display.asked = asked,
            Command::ShowZeros(shown) => display.show_zeros = shown,
            Command::ShowBars(shown) => display.hide_bars = !shown,
            Command::Overlay(variant) => display.overlaid = variant,
            Command::ShowEvidence(shown) => display.show_evidence = shown,
            Command::ShowAcross(role) => display.across_role = role,
            Command::Assess(figures) => display.assessed = figures,
            Command::ShowRequirements(page) => {
                (display.requirements_page, display.requirements_sorting) =
                    (page, Default::default());
                // Another page has other plots.
                display.figures.remove(&View::Requirements);
            }
            Command::SetFrequencyUnit(unit) => display.unit = unit,
            Command::Curves(command) => show_curves(display, command),
            Command::EndIsolation => {
                display.isolated = None;
                display.curves.selected.clear();
            }
            Command::SetLooks(looks) => display.looks = looks,
            Command::FitPlots => {
                display.fit_frequency_plots();
                display
                    .figures
                    .values_mut()
                    .for_each(FigureView::request_fit);
            }
            Command::SetTheme(theme) => self.ctx.set_theme(theme),
            Command::ShowForm(form) => self.show_form(form),
            Command::StopComputing => self.stop_work(),
            Command::Compute => self.compute_again(),
            Command::CopyTable(kind) => {
                self.ctx.copy_text(table_of(&self.state, kind).text());
                self.done(format!("copied the table of {}", kind.name()));
            }
            Command::AskSaveTable(kind) => {
                self.ask_save_table(kind.name(), table_of(&self.state, kind).into())
            }
            Command::AskSaveShownTable(table) => self.ask_save_table(&table.title, table.clone()),
            Command::SaveTable(table, path) => self.save_table(table, path),
            Command::Assembling(command) => self.assemble(command),
            Command::Records(command) => self.records(command),
            Command::CopyFigure(view) => self.copy_figure(view),
            Command::AskSaveFigure(view, format) => self.ask_save_figure(view, format),
            Command::SaveFigure(view, width, path) => self.save_figure(view, width, path),
            Command::AskReport => self.ask_report(),
            Command::WriteReport(path) => self.write_report(path),
            Command::FocusField(name) => {
                // A collapsed field must be open before it can receive the focus.
                (display.settings_open, display.advanced_open) = (true, true);
                self.focus_next(NextFocus::Field(name));
            }
            Command::LeaveRegion { forward } => self.focus_next(NextFocus::Region { forward }),
            Command::StartTour => self.state.tour = Some(0),
            Command::ShowTourStep(step) => self.state.tour = step,
            Command::AskReason(model) => {
                let reason = self
                    .state
                    .study
                    .reason(&model)
                    .unwrap_or_default()
                    .to_owned();
                self.state.forms.typed.insert(FormKind::Reason, reason);
                self.state.forms.rejected_model = Some(model);
                self.state.forms.shown = Some(FormKind::Reason);
            }
            Command::DecideInForm(edit) => {
                self.state.forms.shown = None;
                self.decide(&edit);
            }
            Command::Refuse(why) => self.notify_error(why),
            Command::DismissNotice => self.state.notice = None,
            Command::ShowTest(shown) => {
                display.shows_test = shown;
                display.figures.remove(&View::Requirements);
            }
            Command::ReadRequirementTable(table, path) => self.read_requirement_table(table, path),
            Command::AskRequirementTable(table) => {
                self.ask_path(DialogPurpose::RequirementTable(table), String::new());
            }
            Command::AskWriteTolerances => self.ask_write_tolerances(),
            Command::WriteTolerances(path) => self.write_tolerances(path),
            Command::AskOpen => self.ask_path(DialogPurpose::Open, String::new()),
            Command::AskSaveStudy => self.ask_path(DialogPurpose::SaveStudy, self.proposed_name()),
            Command::AskExportFolder => self.ask_path(DialogPurpose::ExportFolder, String::new()),
            Command::Open(path) => self.open(path, None),
            Command::OpenStudyOf(study, dataset) => self.open(study, Some(dataset)),
            Command::OpenExample => self.open_example(),
            Command::CloseStudy if self.state.unsaved => self.ask_to_lose(PendingAction::Close),
            Command::CloseStudy => self.close_study(),
            Command::ShowStart(is_shown) => self.state.on_start_page = is_shown,
            Command::BeginWith(what) => display.opens_with = what,
            Command::RestoreRecovery(offer) => self.restore(offer),
            Command::DiscardRecovery(offer) => self.discard(offer),
            Command::Reload => self.reload(),
            Command::KeepOpen => self.keep_open(),
            Command::LookForRecent => self.read_recent(None),
            Command::CloseBar(bar) => self.state.bars.retain(|shown| *shown != bar),
            Command::CopyText(text) => self.ctx.copy_text(text),
            Command::Quit if self.state.unsaved && !self.closing => {
                self.ask_to_lose(PendingAction::Quit)
            }
            Command::Quit => self.quit(),
            Command::SaveStudy => self.save(),
            Command::SaveStudyAs(path) => self.save_as(path, self.existing),
            Command::Export => self.export(),
            Command::ExportAs(format, path) => self.export_as(format, path),
            Command::Overwrite => self.overwrite(),
            Command::SaveAndGoOn => self.save_and_go_on(),
            Command::DiscardAndGoOn => {
                self.state.forms.shown = None;
                self.go_on();
            }
        }
    }

    pub(super) fn decide(&mut self, edit: &Edit) {
        let before = self.state.study.clone();
        match self.state.study.apply(edit) {
            Ok(()) if self.state.study == before => {}
            Ok(()) => {
                self.state.history.record(before, edit);
                self.study_changed();
            }
            Err(refusal) => self.notify_error(refusal.to_string()),
        }
    }

    /// Restores another state of the study, and of the records beside it, from its history, if
    /// there is one.
    fn take_study(
        &mut self,
        find: impl FnOnce(&mut History<RecordsBefore>, &Study, &mut RecordsState) -> Option<Study>,
    ) {
        let State {
            history,
            study,
            records,
            ..
        } = &mut self.state;
        if let Some(study) = find(history, study, records) {
            self.state.study = study;
            self.study_changed();
        }
    }

    /// Updates whether the study is saved.
    pub(super) fn study_changed(&mut self) {
        self.state.notice = None;
        self.state
            .display
            .once_held
            .extend(self.state.study.settings.constrained.marked());
        self.state.unsaved = self.saved.study.as_ref() != Some(&self.state.study);
        self.follow_dataset();
        self.keep_unsaved();
    }

    /// Moves the focus before the next frame is drawn, so that the widget knows it is newly
    /// focused.
    fn focus_next(&mut self, next: NextFocus) {
        self.next_focus = Some(next);
        self.ctx.request_repaint();
    }

    /// Gives the focus to the requested target once no form is open in front of it.
    pub(super) fn move_focus(&mut self) {
        if self.state.forms.shown.is_some()
            || self.ctx.memory(|memory| memory.top_modal_layer().is_some())
        {
            return;
        }
        match self.next_focus.take() {
            Some(NextFocus::Field(name)) => focus_field(&self.ctx, name),
            Some(NextFocus::Region { forward }) => leave_region(&self.ctx, forward),
            None => {}
        }
    }

    fn show_form(&mut self, form: Option<FormKind>) {
        match form {
            Some(FormKind::Export) => {
                let all = self
                    .state
                    .study
                    .dataset
                    .conditions()
                    .iter()
                    .map(|condition| condition.id());
                self.state.forms.exported = all.collect();
            }
            Some(FormKind::ExportAs) => self.propose_export_name(),
            _ => {}
        }
        // A form that asks for a save path continues with the action that waits for it.
        if !(self.goes_on_once_saved && form == Some(FormKind::Save)) {
            self.postponed = None;
            self.goes_on_once_saved = false;
        }
        self.overwriting = None;
        self.state.forms.existing.clear();
        self.state.forms.shown = form;
    }

    /// Carries out the command whose overwriting was confirmed.
    fn overwrite(&mut self) {
        self.state.forms.existing.clear();
        if let Some(command) = self.overwriting.take() {
            self.existing = Existing::Replace;
            self.carry_out_one(command);
            self.existing = Existing::Keep;
        }
    }

    pub(super) fn quit(&mut self) {
        self.closing = true;
        // The decisions are saved, or the engineer has agreed to lose them.
        self.autosave.clear();
        self.ctx.send_viewport_cmd(ViewportCommand::Close);
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

fn select_condition(display: &mut Display, condition: ConditionId) {
    if display.condition != condition {
        display.condition = condition;
        display.isolated = None;
        display.curves.selected.clear();
        display.curves.crossings.clear();
        display.refit_frequency_plots();
    }
}

/// Applies a command about curves. A change of unit refits the value axis.
fn show_curves(display: &mut Display, command: CurveCommand) {
    match command {
        CurveCommand::DrawPhaseErrors(_) => display.error.release_values(Pane::Phase),
        CurveCommand::DrawPhases(_) => display.bode.release_values(Pane::Phase),
        _ => {}
    }
    display.curves.carry_out(command);
}
