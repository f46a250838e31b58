//! Copies and saves the views' figures and tables.

use std::path::PathBuf;
use std::sync::Arc;

use gdcm_io::csv_text::{csv_text, save_tables};
use gdcm_io::export::figure_file::{figure_format, write_figure};
use gdcm_model::message_text::sanitized_path;
use gdcm_plot::figure::{ColumnWidth, Figure, FigureFormat, FigureKind};
use gdcm_words::Table;

use super::GdcmApp;
use super::results_to_write::{AbsentBars, absent_bars_suffix};
use crate::gui::commands::command::Command;
use crate::gui::commands::output::OutputCommand;
use crate::gui::state::forms::FormKind;
use crate::gui::state::view::View;
use crate::gui::views::figure_button::tables_of_view;
use crate::gui::views::figures::{figure_name, figure_of};
use crate::message::Message;

impl GdcmApp {
    /// Copies the values shown by a view to the clipboard.
    pub(super) fn copy_figure(&mut self, view: View) {
        // Some views save tables of their own instead of the values in their figure.
        let tables = match tables_of_view(&self.state, view) {
            Some(tables) => tables,
            None => match self.figure_of(view) {
                Some(figure) => figure.tables(),
                None => return,
            },
        };
        self.ctx.copy_text(csv_text(&tables));
        let absent = self.absent_bars_of(view);
        let code = match absent {
            None => "numbers-copied",
            Some(AbsentBars::Stopped) => "numbers-copied-without-error-bars",
            Some(AbsentBars::StillComputed) => "numbers-copied-before-error-bars",
        };
        let text = format!(
            "copied the values of {}{}",
            view.name(),
            absent_bars_suffix(absent)
        );
        self.notify_done(Message::new(code, text));
    }

    /// Asks where to save a view; proposes the folder in which the previous figure was saved.
    pub(super) fn ask_save_figure(&mut self, view: View, format: FigureFormat) {
        let name = format!("{}.{}", figure_name(&self.state, view), format.extension());
        self.state.forms.figure = Some(view);
        let path = self.state.forms.typed_in(FormKind::SaveFigure);
        *path = self.files.proposed_path(path, &name);
        self.state.forms.shown = Some(FormKind::SaveFigure);
    }

    /// Saves a view; asks before overwriting.
    pub(super) fn save_figure(&mut self, view: View, width: ColumnWidth, path: PathBuf) {
        let path = self.files.at_home(path);
        let written = match tables_of_view(&self.state, view) {
            Some(tables) if matches!(figure_format(&path), Ok(FigureFormat::Csv)) => {
                save_tables(&tables, &path, self.outputs())
            }
            _ => {
                let Some(figure) = self.figure_of(view) else {
                    return;
                };
                write_figure(&figure, width, &path, self.outputs())
            }
        };
        let text = format!(
            "saved {}{}",
            sanitized_path(&path),
            absent_bars_suffix(self.absent_bars_of(view))
        );
        let message = Message::new("saved", text);
        let again = Command::Output(OutputCommand::SaveFigure(view, width, path.clone()));
        self.notify_file(
            written.map(|()| message),
            &path,
            FormKind::SaveFigure,
            again,
        );
    }

    /// Returns a view's figure; reports an error if the view has none.
    fn figure_of(&mut self, view: View) -> Option<Figure> {
        let figure = figure_of(&self.state, view);
        if figure.is_none() {
            let results = &self.state.results;
            let background = &results.background;
            let is_pending =
                background.stopped || background.curves.is_some() || background.views > 0;
            let why = if self.state.analysis().is_some() && !is_pending {
                "the results contain nothing to plot in this view"
            } else if results.stopped || background.stopped {
                "the computation was stopped; choose Compute to continue"
            } else {
                "the results are still being computed; try again in a moment"
            };
            let text = format!("{} has no figure: {why}", view.name());
            self.notify_error(Message::new("no-figure", text));
        }
        figure
    }

    /// Returns why a view's figure lacks error bars, as [`Self::absent_bars`] does; `None` also for
    /// a figure that never has error bars, and while they are hidden.
    fn absent_bars_of(&self, view: View) -> Option<AbsentBars> {
        let shows_bars = view.figure().is_some_and(FigureKind::takes_bars)
            && !self.state.display.gains.hide_bars;
        self.absent_bars(!shows_bars || self.state.uncertainty().is_some())
    }

    /// Asks where to save a table in its current state.
    pub(super) fn ask_save_table(&mut self, name: &str, table: Arc<Table>) {
        let name: String = name
            .chars()
            .filter(|letter| letter.is_alphanumeric() || *letter == ' ')
            .collect();
        self.state.forms.table = Some(table);
        let name = format!("{}.csv", name.replace(' ', "-"));
        let path = self.state.forms.typed_in(FormKind::SaveTable);
        *path = self.files.proposed_path(path, &name);
        self.state.forms.shown = Some(FormKind::SaveTable);
    }

    /// Saves a table as CSV; asks before overwriting.
    pub(super) fn save_table(&mut self, table: Arc<Table>, path: PathBuf) {
        let path = self.files.at_home(path);
        let written = save_tables(std::slice::from_ref(&*table), &path, self.outputs());
        self.notify_saved(
            written,
            &path,
            FormKind::SaveTable,
            Command::Output(OutputCommand::SaveTable(table, path.clone())),
        );
    }
}
