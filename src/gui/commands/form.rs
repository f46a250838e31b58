//! Commands about forms and messages.

use gdcm_model::dataset::ModelId;
use gdcm_study::Edit;

use crate::gui::state::forms::FormKind;
use crate::gui::state::notices::MessageBar;
use crate::message::Message;

/// Shows, answers or closes a form or a message.
#[derive(Clone, Debug, PartialEq)]
pub enum FormCommand {
    /// Shows a form, or closes the open form.
    ShowForm(Option<FormKind>),
    /// Overwrites the files listed in the form.
    Overwrite,
    /// Saves the study, then continues with the action that would lose unsaved decisions.
    SaveAndGoOn,
    /// Continues with the action that loses unsaved decisions.
    DiscardAndGoOn,
    /// Closes a message bar.
    CloseBar(MessageBar),
    /// Takes the decision requested by a form, and closes the form.
    DecideInForm(Edit),
    /// Asks for the reason for which a model is rejected.
    AskReason(ModelId),
    /// Shows why a typed or dragged value is refused.
    Refuse(Message),
    /// Removes the toast with this number.
    DismissToast(u64),
    /// Opens or closes the toast list.
    ListToasts(bool),
    /// Pauses the toasts' timers in this frame, because the pointer is on a message.
    HoldToasts,
}
