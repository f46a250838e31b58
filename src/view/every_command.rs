//! Every command that the palette finds.

use gdcm_core::dataset::{BundleKind, ModelId};
use gdcm_core::study::Edit;

use super::command::{Command, FormKind};
use super::command_table::{Entry, command_table, hold_entry};
use super::state::State;
use super::views::PairSet;

/// Those of the table, and one for each condition, response, model and recent file.
pub fn every_command(state: &State) -> Vec<Entry> {
    let mut entries = command_table(state);
    entries.retain(|entry| entry.command != Command::ShowForm(Some(FormKind::Palette)));
    entries.extend(PairSet::ALL.map(|set| {
        Entry::new(format!("Net gains of the responses {}", set.name()), set.purpose(), Command::ShowNetGains(set))
    }));
    entries.extend(state.dataset().conditions().iter().map(|condition| {
        let (id, flight_state) = (condition.id(), condition.flight_state());
        let name = format!("Condition {id} · {}", flight_state.name);
        Entry::new(name, "Show this condition", Command::SelectCondition(id))
    }));
    for pair in state.dataset().on_axis().pairs() {
        let name = state.dataset().pair_name(pair);
        entries.push(Entry::new(format!("Show {name}"), "In the plots of one response", Command::FocusPair(pair)));
        if pair != state.display.pair {
            entries.push(hold_entry(state, pair));
        }
    }
    entries.extend(model_entries(state));
    entries.extend(state.recent.iter().map(|file| {
        let name = format!("Open recent {} in {}", file.name, file.folder);
        Entry::new(name, "Opened or saved of late", Command::Open(file.path.clone())).enabled(!file.missing)
    }));
    entries
}

/// What can be done with each model of the condition shown.
fn model_entries(state: &State) -> Vec<Entry> {
    let condition = state.condition();
    let choice = state.study.choice(condition.id());
    let mut entries = Vec::new();
    for bundle in [BundleKind::Physics, BundleKind::Identified] {
        for model in condition.bundle(bundle) {
            let id = ModelId::new(condition.id(), bundle, &model.name);
            let name = &model.name;
            if choice.bundle(bundle).rejected.contains(name) {
                let restore = Edit::Restore(id).into();
                entries.push(Entry::new(format!("Restore {bundle} model {name}"), "Put it back", restore));
                let ask = Command::AskReason(ModelId::new(condition.id(), bundle, name));
                let text = format!("Say why {bundle} model {name} is rejected…");
                entries.push(Entry::new(text, "In words, kept in the study", ask));
                continue;
            }
            let reject = Edit::Reject(id.clone()).into();
            entries.push(Entry::new(format!("Reject {bundle} model {name}"), "Take it out of its bundle", reject));
            let ask = Command::AskReason(id.clone());
            let text = format!("Reject {bundle} model {name} with a reason…");
            entries.push(Entry::new(text, "In words, kept in the study", ask));
            let (text, edit) = if choice.bundle(bundle).pinned.as_ref() == Some(name) {
                ("Unpin", Edit::Unpin { condition: condition.id(), bundle })
            } else {
                ("Pin", Edit::Pin(id))
            };
            let meaning = "Whether it represents its bundle whatever the medoid is";
            entries.push(Entry::new(format!("{text} {bundle} model {name}"), meaning, edit.into()));
        }
    }
    entries
}
