//! Assembling a dataset from models in the window, through its controls.

use gdcm::gui::commands::assembling::AssemblingCommand;
use gdcm::gui::state::assembling::AssemblyState;
use gdcm::gui::state::assembly_columns::COLUMNS;

use super::views::give;
use super::*;

pub(super) fn bench(window: &Window) -> &AssemblyState {
    state(window)
        .assembling
        .as_ref()
        .expect("models are being imported")
}

/// Replaces the text in a field, which keeps the focus.
pub(super) fn fill_in(window: &mut Window, field: &str, text: &str) {
    window.get_by_label(field).focus();
    window.run_steps(2);
    window.key_press_modifiers(Modifiers::COMMAND, Key::A);
    window.get_by_label(field).type_text(text);
    window.run_steps(2);
}

/// Replaces the text in a field and presses Enter, which submits a form.
pub(super) fn type_into(window: &mut Window, field: &str, text: &str) {
    fill_in(window, field, text);
    window.key_press(Key::Enter);
    window.run_steps(3);
}

fn wait_for_models(window: &mut Window) {
    wait_until(window, "the models", |window| {
        bench(window).reading.is_none()
    });
}

#[test]
fn a_folder_is_put_together_by_its_labels_and_opened() {
    let folder = tempfile::tempdir().unwrap();
    crate::assembling::small_folder(folder.path());
    let mut window = window();
    give(&mut window, AssemblingCommand::Open);
    type_into(
        &mut window,
        "Folder or file of models",
        folder.path().to_str().unwrap(),
    );
    wait_for_models(&mut window);
    assert_eq!(bench(&window).assembly().parts().len(), 3);
    assert!(window.query_by_label_contains("to complete").is_some());
    assert!(
        window.query_by_label_contains("not read: ").is_some(),
        "the broken file is named"
    );

    type_into(&mut window, "Name of input 1", "LON");
    type_into(&mut window, "Unit of input 1", "%");
    type_into(&mut window, "Unit in files of input 1", "%");
    type_into(&mut window, "Name of output 1", "Q");
    type_into(&mut window, "Unit of output 1", "deg/s");
    type_into(&mut window, "Unit in files of output 1", "deg/s");
    type_into(&mut window, "Factor of LON from in", "8,0");
    assert!(
        bench(&window).assembly().problems().is_empty(),
        "{:?}",
        bench(&window).assembly().problem_lines()
    );

    let made = folder.path().join("made.json.gz");
    type_into(
        &mut window,
        "Path of the dataset to make",
        made.to_str().unwrap(),
    );
    window.get_by_label("Make dataset").click();
    wait_until(&mut window, "the dataset", |window| {
        state(window).assembling.is_none() && state(window).dataset().conditions().len() == 1
    });
    assert!(made.exists() && folder.path().join("made.gdcm-rules.json").exists());
    assert_eq!(state(&window).dataset().inputs()[0].name, "LON");
}

#[test]
fn what_is_said_of_a_model_is_filled_down_undone_and_shown() {
    fn altitudes(window: &Window) -> Vec<String> {
        bench(window)
            .assembly()
            .parts()
            .iter()
            .map(|part| COLUMNS[4].text(part))
            .collect()
    }

    let folder = tempfile::tempdir().unwrap();
    crate::assembling::small_folder(folder.path());
    let mut window = window();
    give(
        &mut window,
        AssemblingCommand::Add(vec![folder.path().to_owned()]),
    );
    wait_for_models(&mut window);
    window.run_steps(2);
    window
        .get_by_label_contains("Model c1_60kt/V+5kt.mat")
        .click();
    window.run_steps(2);
    type_into(&mut window, "Model altitude", "high");
    let before = altitudes(&window);
    assert_eq!(before.iter().filter(|cell| *cell == "high").count(), 1);
    let first = bench(&window).order()[0];
    let selected = bench(&window).selected;
    if first != selected {
        give(&mut window, AssemblingCommand::Select(first));
        type_into(&mut window, "Model altitude", "high");
    }
    window.get_by_label("Fill down altitude").click();
    window.run_steps(3);
    assert!(
        altitudes(&window).iter().all(|cell| cell == "high"),
        "{:?}",
        altitudes(&window)
    );
    click(&mut window, "Undo change");
    assert!(!altitudes(&window).iter().all(|cell| cell == "high"));
    click(&mut window, "Cancel import");
    assert!(state(&window).assembling.is_none());
}

#[test]
fn channels_taken_by_position_and_what_is_not_used_are_said() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("nominal.json");
    let text =
        r#"{"A": [[-1]], "B": [[1]], "C": [[1]], "D": [[0]], "airspeed_kt": 60, "torque": 7}"#;
    std::fs::write(&path, text).unwrap();
    let mut window = window();
    give(&mut window, AssemblingCommand::Add(vec![path]));
    wait_for_models(&mut window);
    window.run_steps(2);
    let assembly = bench(&window).assembly();
    let cautions = assembly.cautions();
    let codes: Vec<&str> = cautions.iter().map(|caution| caution.code()).collect();
    assert_eq!(codes, ["channels-by-position"]);
    let words = assembly.caution_words(&cautions[0]);
    window.get_by_label_contains(&words);
    window.get_by_label_contains("torque");
}

#[test]
fn the_columns_of_a_table_are_corrected_before_they_are_taken() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("flight.txt");
    std::fs::write(&path, "1 0 -90\n2 -6 -100\n4 -12 -120\n").unwrap();
    let mut window = window();
    give(&mut window, AssemblingCommand::Add(vec![path]));
    wait_for_models(&mut window);
    window.run_steps(2);
    for (column, heading) in [
        (1, "f [Hz]"),
        (2, "mag Q/LON [dB]"),
        (3, "phase Q/LON [deg]"),
    ] {
        type_into(
            &mut window,
            &format!("Heading of column {column} of flight.txt"),
            heading,
        );
        wait_for_models(&mut window);
    }
    let parts = bench(&window).assembly().parts();
    let response = parts[0].found.response().expect("a measured response");
    assert!(
        (response.omega[0] - std::f64::consts::TAU).abs() < 1e-12,
        "1 Hz is 2 pi rad/s"
    );
    assert_eq!(parts[0].found.inputs[0].name.as_deref(), Some("LON"));
    click(&mut window, "Undo change");
    wait_for_models(&mut window);
    assert_eq!(
        bench(&window).tables["flight.txt"][2],
        "",
        "the file is read again as before"
    );
}

#[test]
fn a_unit_that_a_table_does_not_say_is_asked_for_with_a_button() {
    let folder = tempfile::tempdir().unwrap();
    for (name, first) in [("Q_LON.csv", 8.0), ("P_LAT.csv", 4.0)] {
        let text = format!("Freq (rad/s),Mag,Phase (deg)\n1,{first},-90\n2,6,-100\n4,2,-120\n");
        std::fs::write(folder.path().join(name), text).unwrap();
    }
    let mut window = window();
    give(
        &mut window,
        AssemblingCommand::Add(vec![folder.path().to_owned()]),
    );
    wait_for_models(&mut window);
    window.run_steps(2);
    assert!(
        bench(&window).assembly().parts().is_empty(),
        "dB or not: nothing is chosen"
    );
    let asked = bench(&window).tables.keys().next().unwrap().clone();
    click(&mut window, &format!("Column 2 of {asked} is in dB"));
    wait_for_models(&mut window);
    let bench = bench(&window);
    let parts = bench.assembly().parts();
    assert_eq!(
        parts.len(),
        2,
        "the same is said of the table with the same headings: {:?}",
        bench.tables
    );
    let sizes = parts
        .iter()
        .map(|part| part.found.response().unwrap())
        .map(|of| of.re.values[0].hypot(of.im.values[0]));
    let mut sizes: Vec<f64> = sizes.map(|size| 20.0 * size.log10()).collect();
    sizes.sort_by(f64::total_cmp);
    assert!(
        (sizes[0] - 4.0).abs() < 1e-9 && (sizes[1] - 8.0).abs() < 1e-9,
        "{sizes:?}"
    );
}

#[test]
fn an_import_opens_in_its_path_field_and_lists_nothing() {
    let mut window = few_window();
    give(&mut window, AssemblingCommand::Open);
    window.run_steps(2);
    let field = window.get_by_label("Folder or file of models");
    assert!(field.is_focused());
    assert!(window.query_by_label_contains("to complete").is_none());
    assert!(window.query_by_label_contains("included").is_none());
    assert!(bench(&window).had_focus);
}
