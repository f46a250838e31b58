//! Commands about flight records and the models identified from them.
//!
//! A part is a time span of a record, used instead of the whole. M-numbers are sections of
//! docs/identification.md.

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
    /// Reads files, and folders with all their files.
    Add(Vec<PathBuf>),
    /// Chooses files and archives with the desktop's dialog.
    AskFiles,
    /// Chooses a folder with the desktop's dialog.
    AskFolder,
    /// Asks for the path to a file, a folder or an archive.
    AskPath,
    /// Assigns added records without a condition, named by their index among these, to a condition.
    Assign(Vec<usize>, ConditionId),
    /// Removes an added record without a condition, named by its index among these.
    Discard(usize),
    /// Unfolds a section below the records; `None` folds the unfolded one.
    ShowFold(Option<RecordsFold>),
    /// Asks for the channels in a dataset to be made from the added records.
    AskDataset,
    /// Makes a dataset with the requested channels, and opens it.
    MakeDataset,
    /// Displays a record.
    ChooseRecord(usize),
    /// Uses a record (`true`), or leaves it out.
    SetUsed(usize, bool),
    /// Holds a record out from the fit for validation (`true`), or fits it.
    SetHeldOut(usize, bool),
    /// Sets a record's manoeuvre.
    SetKind(usize, RecordKind),
    /// Assigns columns to channels, for this record and, as far as they have the same columns, for
    /// all other records.
    SetLayout(usize, RecordLayout),
    /// Sets the delay in a channel's log \[s\].
    SetDelay(Signal, f64),
    /// Sets remedies for channels in a single record (M14.16).
    SetRemedies(usize, Vec<(Signal, ChannelRemedy)>),
    /// Sets how steps in a staircase signal are interpreted.
    SetHold(Signal, Hold),
    /// Sets the identification band \[rad/s\]; `None` selects the study's band.
    SetBand(Option<[f64; 2]>),
    /// Sets the columns used as recorded references that excited the loop externally (M14.15); an
    /// empty list selects the direct method.
    SetReferences(Vec<String>),
    /// Sets the model orders, past windows and poles that the search tries.
    SetSearch(SearchSpace),
    /// Expands the search settings and focuses the field with this name.
    ShowAdvanced(&'static str),
    /// The field asked for by [`Self::ShowAdvanced`] has the focus.
    AdvancedFocused,
    /// Draws a role's curves over time (`true`), or hides them.
    ShowTimeRole(TimeRole, bool),
    /// Draws these outputs over time below the output in focus.
    ShowOutputs(Vec<usize>),
    /// Confirms the assumed units, in all conditions' records.
    ConfirmUnits,
    /// Shows the first record with assumed units, from any condition, on the Columns page.
    CheckUnits,
    /// Shows a record, from any condition, on the Columns page.
    ShowColumns(RecordPlace),
    /// Adds the part between two times \[s\] as a separate record, used instead of the whole.
    AddPart(usize, [f64; 2]),
    /// Moves the ends \[s\] of the part in this row.
    MovePart(usize, [f64; 2]),
    /// Removes this row, which is a part of a record.
    RemovePart(usize),
    /// Shows an input's spectrogram beside the records over time; `None` hides it.
    ShowSpectrogram(Option<usize>),
    ShowPage(RecordsPage),
    /// Identifies models for the displayed condition.
    Identify,
    /// Identifies models for every condition with used records, the displayed one first. Conditions
    /// with a current fit, or whose identification waits or runs, are left out, unless no others
    /// remain.
    IdentifyAll,
    /// Stops running and waiting identifications.
    StopIdentifying,
    /// Replaces the displayed condition's identified models by those found from its records.
    Adopt(AdoptionChoice),
    /// The same for every condition with a finished fit whose models are not yet in the study.
    AdoptAll(AdoptionChoice),
    /// Restores the models from the dataset's file in the displayed condition.
    RestoreFileModels,
}
