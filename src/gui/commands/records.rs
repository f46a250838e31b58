//! Commands about flight records and the models identified from them.

use std::path::PathBuf;

use gdcm_model::dataset::ConditionId;
use gdcm_model::dataset::condition::{ChannelRemedy, RecordKind};
use gdcm_model::simulation::Signal;
use gdcm_study::decisions::adopted_models::AdoptionChoice;
use gdcm_sysid::identification::{Hold, SearchSpace};
use gdcm_sysid::records::RecordLayout;

use crate::gui::state::column_groups::RecordPlace;
use crate::gui::state::records::{RecordsFold, RecordsPage, TimeRole};

/// A command in the Records view, in which a row index names a record or part in the displayed
/// condition, unless stated otherwise.
#[derive(Clone, Debug, PartialEq)]
pub enum RecordsCommand {
    /// Read files, and folders with all their files.
    Add(Vec<PathBuf>),
    /// Choose files and archives with the desktop's dialog.
    AskFiles,
    /// Choose a folder with the desktop's dialog.
    AskFolder,
    /// Type the path to a file, a folder or an archive.
    AskPath,
    /// Assign added records without a condition, named by their index among these, to a condition.
    Assign(Vec<usize>, ConditionId),
    /// Remove an added record without a condition, named by its index among these.
    Discard(usize),
    /// Unfold a section below the records; `None` folds the unfolded one.
    ShowFold(Option<RecordsFold>),
    /// Ask for the channels in a dataset to be made from the added records.
    AskDataset,
    /// Make a dataset with the requested channels, and open it.
    MakeDataset,
    Choose(usize),
    /// Use a record (`true`), or leave it out.
    SetUsed(usize, bool),
    /// Hold a record out from the fit for validation (`true`), or fit it.
    SetHeldOut(usize, bool),
    /// Set a record's manoeuvre.
    SetKind(usize, RecordKind),
    /// Assign columns to channels, for this record and, as far as they have the same columns, for
    /// all other records.
    SetLayout(usize, RecordLayout),
    /// Set the delay in a channel's log \[s\].
    SetDelay(Signal, f64),
    /// Set remedies for channels in a single record (M14.16).
    SetRemedies(usize, Vec<(Signal, ChannelRemedy)>),
    /// Set how steps in a staircase signal are interpreted.
    SetHold(Signal, Hold),
    /// Set the identification band \[rad/s\]; `None` selects the study's band.
    SetBand(Option<[f64; 2]>),
    /// Identify with these columns as recorded references that excited the loop externally
    /// (M14.15); an empty list selects the direct method.
    SetReferences(Vec<String>),
    /// Set the model orders, past windows and poles that the search tries.
    SetSearch(SearchSpace),
    /// Expand the search settings and focus the field with this name.
    ShowAdvanced(&'static str),
    /// The field asked for by [`Self::ShowAdvanced`] has the focus.
    AdvancedFocused,
    /// Draw a role's curves over time (`true`), or hide them.
    ShowTimeRole(TimeRole, bool),
    /// Draw these outputs over time below the output in focus.
    ShowOutputs(Vec<usize>),
    /// Confirm the assumed units, in all conditions' records.
    ConfirmUnits,
    /// Show the first record with assumed units, from any condition, on the Columns page.
    CheckUnits,
    /// Show a record, from any condition, on the Columns page.
    ShowColumns(RecordPlace),
    /// Add the part between two times \[s\] as a separate record, used instead of the whole.
    AddPart(usize, [f64; 2]),
    /// Move the ends \[s\] of the part in this row.
    MovePart(usize, [f64; 2]),
    /// Remove this row, which is a part of a record.
    RemovePart(usize),
    /// Show an input's spectrogram beside the records over time; `None` hides it.
    ShowSpectrogram(Option<usize>),
    Show(RecordsPage),
    /// Identify models for the displayed condition.
    Identify,
    /// Identify models for every condition with used records, the displayed one first. Conditions
    /// with a current fit, or whose identification waits or runs, are left out, unless no others
    /// remain.
    IdentifyAll,
    /// Stop the identification.
    Stop,
    /// Put the identified models into the displayed condition.
    Take(AdoptionChoice),
    /// Put the models from each finished fit that is not yet in the study into the fit's condition.
    TakeAll(AdoptionChoice),
    /// Restore the models from the dataset's file in the displayed condition.
    Return,
}
