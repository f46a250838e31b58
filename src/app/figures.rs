//! What a view shows, copied and saved as a figure on paper.

use gdcm_core::message_text::sanitized_path;
use std::path::{Path, PathBuf};

use crate::view::arrangement::View;
use crate::view::command::{Command, FormKind};
use crate::view::figures::{figure_name, figure_of};
use gdcm_files::figure::{ColumnWidth, Figure, FigureFormat};
use gdcm_files::{Existing, FileError, OutputSet, csv_text, write_figure};

use super::window::GdcmApp;

impl GdcmApp {
    /// Puts the numbers of a view on the clipboard.
    pub(super) fn copy_figure(&mut self, view: View) {
        if let Some(figure) = self.figure_of(view) {
            self.ctx.copy_text(csv_text(&figure.tables()));
            self.done(format!("copied the numbers of {}", view.name()));
        }
    }

    /// Asks where to save a view; the folder of the last figure is proposed.
    pub(super) fn ask_save_figure(&mut self, view: View, format: FigureFormat) {
        let name = format!("{}.{}", figure_name(&self.state, view), format.extension());
        let form = &mut self.state.forms.figure;
        form.view = Some(view);
        form.path = Path::new(form.path.trim()).with_file_name(name).display().to_string();
        self.state.forms.shown = Some(FormKind::SaveFigure);
    }

    /// Saves a view; asks before it overwrites a file.
    pub(super) fn save_figure(&mut self, (view, width): (View, ColumnWidth), path: PathBuf, existing: Existing) {
        let Some(figure) = self.figure_of(view) else { return };
        let path = self.at_home(path);
        match write_figure(&figure, width, &path, OutputSet::new(existing, self.inputs())) {
            Ok(()) => {
                self.state.forms.shown = None;
                self.done(format!("saved {}", sanitized_path(&path)));
            }
            Err(FileError::Exists { paths }) => {
                self.ask_to_overwrite(&paths, FormKind::SaveFigure, Command::SaveFigure(view, width, path));
            }
            Err(error) => self.notify_error(error.to_string()),
        }
    }

    /// The figure of a view; where there is none yet, that is said.
    fn figure_of(&mut self, view: View) -> Option<Figure> {
        let figure = figure_of(&self.state, view);
        if figure.is_none() {
            self.notify_error(format!(
                "{} has nothing to take away yet: {}",
                view.name(),
                self.state.results.absence()
            ));
        }
        figure
    }
}
