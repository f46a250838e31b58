//! Commands from forms and messages.

use super::GdcmApp;
use crate::gui::commands::form::FormCommand;
use crate::gui::state::forms::{FormKind, PaletteForm};

impl GdcmApp {
    pub(super) fn carry_out_form(&mut self, command: FormCommand) {
        match command {
            FormCommand::ShowForm(form) => self.show_form(form),
            FormCommand::AskReason(model) => {
                let reason = self.state.study.reason(&model).unwrap_or_default();
                let reason = reason.to_owned();
                self.state.forms.typed.insert(FormKind::Reason, reason);
                self.state.forms.rejected_model = Some(model);
                self.state.forms.shown = Some(FormKind::Reason);
            }
            FormCommand::DecideInForm(edit) => {
                self.state.forms.shown = None;
                self.decide(&edit);
            }
            FormCommand::Refuse(why) => self.notify_error(why),
            FormCommand::DismissToast(number) => self.state.notices.dismiss(number),
            FormCommand::ListToasts(is_open) => self.state.notices.is_list_open = is_open,
            FormCommand::HoldToasts => self.state.notices.is_held = true,
            FormCommand::CloseBar(bar) => self.state.notices.close_bars(|shown| *shown == bar),
            FormCommand::Overwrite => self.overwrite(),
            FormCommand::SaveAndGoOn => self.save_and_go_on(),
            FormCommand::DiscardAndGoOn => {
                self.state.forms.shown = None;
                self.go_on();
            }
        }
    }

    fn show_form(&mut self, form: Option<FormKind>) {
        match form {
            Some(FormKind::Export) => self.open_export_form(),
            // Free the memory: the dry run holds the bytes of all files.
            _ => self.state.forms.export.drop_contents(),
        }
        // Pressing the palette's shortcut while it is open begins a new search.
        if form == Some(FormKind::Palette) {
            self.state.forms.palette = PaletteForm::default();
        }
        // Keep the postponed action if it is to continue after this form, which asks for a path to
        // save to.
        if !(self.postponed.goes_on_once_saved && form == Some(FormKind::Save)) {
            self.postponed.forget_losing();
        }
        self.postponed.overwriting = None;
        self.state.forms.existing.clear();
        self.state.forms.shown = form;
    }
}
