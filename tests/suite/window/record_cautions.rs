//! Cautions about identified models in the Records view: marks beside the affected items, and
//! buttons with remedies.

use std::fs;

use serde_json::{Value, json};

use gdcm::gui::state::records::ConditionRecords;

use super::records::late_dataset;
use super::views::show;
use super::*;

const OF: ConditionId = ConditionId(7);

/// Opens a dataset with four flights. The last flight is held out, and its outputs are scaled by
/// 1.6; the band extends far beyond the sweeps.
fn doubtful() -> (Window, tempfile::TempDir) {
    fn larger(line: &str) -> String {
        let cells = line
            .split(',')
            .enumerate()
            .map(|(at, cell)| match cell.parse::<f64>() {
                Ok(value) if at > 2 => (1.6 * value).to_string(),
                _ => cell.to_owned(),
            });
        cells.collect::<Vec<_>>().join(",") + "\n"
    }

    fn records(window: &Window) -> usize {
        state(window)
            .records
            .conditions
            .get(&OF)
            .map_or(0, |of| of.rows.len())
    }

    let folder = tempfile::tempdir().unwrap();
    let path = late_dataset(folder.path());
    let last = folder.path().join("flight_3.csv");
    fs::write(
        &last,
        fs::read_to_string(&last)
            .unwrap()
            .lines()
            .map(larger)
            .collect::<String>(),
    )
    .unwrap();
    let mut dataset: Value = serde_json::from_str(&fs::read_to_string(&path).unwrap()).unwrap();
    dataset["conditions"][0]["records"][3]["held_out"] = json!(true);
    fs::write(&path, dataset.to_string()).unwrap();
    let mut window = window();
    open_by_path(&mut window, &path);
    show(&mut window, View::Records);
    wait_until(&mut window, "the records", |window| records(window) == 4);
    window.get_by_label("Identify").click();
    wait_until(&mut window, "the models", |window| {
        state(window).records.conditions[&OF].latest.is_some()
    });
    settle(&mut window);
    (window, folder)
}

/// Clicks a button that may be outside the visible part of the record list.
fn press(window: &mut Window, label: &str) {
    window.get_by_label(label).click_accesskit();
    window.run_steps(3);
}

fn records(window: &Window) -> &ConditionRecords {
    &state(window).records.conditions[&OF]
}

#[test]
fn cautions_stand_as_marks_at_their_places_and_their_buttons_act() {
    let (mut window, _folder) = doubtful();
    let codes: Vec<&str> = records(&window)
        .cautions()
        .map(|(_, note)| note.code)
        .collect();
    assert!(
        codes.contains(&"held-out") && codes.contains(&"band-narrowed"),
        "{codes:?}"
    );
    // Only the record that the models do not predict is marked.
    window.get_by_label("Cautions of flight 3");
    assert!(window.query_by_label("Cautions of flight 1").is_none());
    // The band extends beyond the sweeps, so the response has a caution.
    window.get_by_label_contains("⚠ no coherent response");
    press(&mut window, "Fit flight 3 too");
    assert!(
        records(&window).rows.iter().all(|row| !row.guess.held_out)
            && records(&window).changed_since_fit
    );
    assert!(
        window.query_by_label("Cautions of flight 3").is_none(),
        "what was said is out of date"
    );
    press(&mut window, "Alternatives to: Fit flight 3 too");
    press(&mut window, "Leave flight 3 out");
    assert!(!records(&window).rows[3].used);
}
