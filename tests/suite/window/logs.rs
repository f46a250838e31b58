//! Logs of autopilots in the window: channels are proposed, and a dataset is made from them without
//! typing.

use gdcm::gui::commands::records::RecordsCommand;
use gdcm::gui::state::records::DatasetForm;

use super::records::rows_shown;
use super::views::{give, show};
use super::*;

/// Opens a log and the form for the channels of a new dataset.
fn asked(log: &str, bytes: &[u8]) -> (Window, tempfile::TempDir) {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join(log), bytes).unwrap();
    let mut window = window();
    show(&mut window, View::Records);
    give(
        &mut window,
        RecordsCommand::Add(vec![folder.path().join(log)]),
    );
    wait_until(&mut window, "the records", |window| rows_shown(window) > 0);
    give(&mut window, RecordsCommand::AskDataset);
    (window, folder)
}

fn wanted(window: &Window) -> &DatasetForm {
    &state(window).records.dataset_form
}

/// Makes the proposed dataset, and returns the notes of its record.
fn made(window: &mut Window, name: &str) -> Vec<String> {
    click(window, "Make the dataset");
    wait_until(window, "the dataset", |window| {
        assert_eq!(wanted(window).problems, []);
        state(window).dataset().name() == name
    });
    show(window, View::Records);
    wait_until(window, "its record", |window| rows_shown(window) == 1);
    let row = &state(window).records.conditions[&ConditionId(1)].rows[0];
    assert!(
        row.problems.is_empty() && row.flight.is_some(),
        "{:?}",
        row.problems
    );
    row.table.notes.clone()
}

#[test]
fn a_log_of_px4_proposes_its_setpoints_and_rates() {
    fn has(list: &str, names: &[&str]) -> bool {
        names
            .iter()
            .all(|name| list.split(", ").any(|of| of == *name))
    }

    let (mut window, _folder) = asked(
        "quadrotor.ulg",
        include_bytes!("../../data/logs/quadrotor.ulg"),
    );
    let DatasetForm {
        inputs, outputs, ..
    } = wanted(&window);
    assert!(
        has(inputs, &["LAT", "LON", "PED"]) && has(outputs, &["P", "Q", "R", "NX", "NY", "NZ"]),
        "{inputs}; {outputs}"
    );
    let notes = made(&mut window, "quadrotor");
    assert!(notes.iter().any(|note| note.contains("PX4")), "{notes:?}");
    let units: Vec<&str> = state(&window)
        .dataset()
        .outputs()
        .iter()
        .map(|channel| channel.unit.as_str())
        .collect();
    assert!(
        units.contains(&"rad/s") && units.contains(&"m/s^2"),
        "{units:?}"
    );
}

#[test]
fn a_log_of_ardupilot_proposes_outputs_of_its_controller_and_rates_of_its_identification_mode() {
    let mut text =
        "FMT, 128, 89, FMT, BBnNZ, Type,Length,Name,Format,Columns\nFMT, 140, 27, RATE, Qffff, TimeUS,R,ROut,P,POut\n\
                    FMT, 141, 27, SIDD, Qffff, TimeUS,Time,Targ,Gx,Gy\n"
            .to_owned();
    for k in 0..4000 {
        let stamp = 1_000_000 + 2500 * k;
        let at = 0.0025 * f64::from(k);
        let stick = (2.0 * at).sin();
        let rate = (2.0 * at).cos();
        text += &format!("RATE, {stamp}, {rate}, {stick}, {stick}, {rate}\n");
        text += &format!(
            "SIDD, {}, {at}, {stick}, {rate}, {}\n",
            stamp + 300,
            rate + stick
        );
    }
    let (mut window, _folder) = asked("00000042.log", text.as_bytes());
    let DatasetForm {
        inputs,
        outputs,
        columns,
        ..
    } = wanted(&window);
    assert_eq!(
        (inputs.as_str(), outputs.as_str()),
        ("LAT, LON", "P, Q"),
        "{columns:?}"
    );
    let notes = made(&mut window, "00000042");
    assert!(
        notes.iter().any(|note| note.contains("P = SIDD.Gx")),
        "{notes:?}"
    );
    // The signal added by the identification mode is an external reference of the loop.
    let row = &state(&window).records.conditions[&ConditionId(1)].rows[0];
    assert!(
        row.possible_references().contains(&("SIDD.Targ", true)),
        "{:?}",
        row.possible_references()
    );
}

#[test]
fn a_log_of_betaflight_proposes_sums_of_its_controller_and_its_gyroscope() {
    fn sorted(list: &str) -> Vec<String> {
        let mut names: Vec<String> = list.split(", ").map(str::to_owned).collect();
        names.sort();
        names
    }

    let (mut window, _folder) = asked(
        "two-flights.bbl",
        include_bytes!("../../data/logs/two-flights.bbl"),
    );
    let DatasetForm {
        inputs, outputs, ..
    } = wanted(&window);
    assert_eq!(
        (sorted(inputs), sorted(outputs)),
        (sorted("LAT, LON, PED, COL"), sorted("P, Q, R"))
    );
    let notes = made(&mut window, "two-flights");
    assert!(
        notes.iter().any(|note| note.contains("axisSum")),
        "{notes:?}"
    );
}
