//! Files of other programs, imported through the controls: the program finds missing units and
//! inverted signs.

use gdcm::gui::commands::assembling::AssemblingCommand;
use gdcm::gui::commands::file::FileCommand;
use gdcm::gui::commands::layout::LayoutCommand;
use gdcm::gui::commands::records::RecordsCommand;
use gdcm::gui::state::records::RecordsPage;
use gdcm_sysid::records::layout_problem::LayoutCaution;

use super::assembling::{bench, type_into};
use super::views::{give, show};
use super::*;

#[test]
fn a_foreign_tree_with_a_turned_channel_and_inches_is_carried_to_corrected_models() {
    /// Returns the names of the channels that may have the opposite sign.
    fn doubted(window: &Window) -> Vec<String> {
        let analysis = state(window).analysis().expect("there is a result");
        analysis
            .doubts
            .iter()
            .filter_map(|doubt| Some(doubt.channel_to_reverse()?.name_in(state(window).dataset())))
            .collect()
    }

    fn cost(window: &Window) -> f64 {
        let pair = pair(window, "NZ", "COL");
        state(window)
            .shown()
            .and_then(|shown| shown.cost[pair])
            .expect("it has a J")
            .uncorrected
            .total()
    }

    let folder = tempfile::tempdir().unwrap();
    let root = folder.path().join("models");
    crate::assembling::foreign_tree(&root);
    let mut window = window();
    give(&mut window, AssemblingCommand::Open);
    type_into(
        &mut window,
        "Folder or file of models",
        root.to_str().unwrap(),
    );
    wait_until(&mut window, "the models", |window| {
        bench(window).reading.is_none()
    });
    type_into(&mut window, "Unit of input 1", "%");
    // The stick travel per inch is unknown and must be entered.
    assert!(window.query_by_label_contains("to complete").is_some());
    type_into(
        &mut window,
        "Factor of xb from in",
        &crate::assembling::PERCENT_IN_AN_INCH.to_string(),
    );
    assert!(
        bench(&window).assembly().problems().is_empty(),
        "{:?}",
        bench(&window).assembly().problem_lines()
    );
    type_into(
        &mut window,
        "Path of the dataset to make",
        folder.path().join("made.json.gz").to_str().unwrap(),
    );
    window.get_by_label("Make dataset").click();
    wait_until(&mut window, "the dataset", |window| {
        state(window).assembling.is_none() && state(window).dataset().conditions().len() == 2
    });
    settle(&mut window);

    // The program finds the inverted sign, reports it before all other cautions, and inverts it by
    // a button.
    assert_eq!(doubted(&window), ["NZ"]);
    let before = cost(&window);
    click(&mut window, "Reverse sign of NZ");
    assert_eq!(doubted(&window), Vec::<String>::new());
    // A phase difference of 180 degrees alone gives a J of 20 * 0.0175 * 180^2.
    assert!(
        before > 5_000.0 && cost(&window) < 0.1 * before,
        "{before} and {}",
        cost(&window)
    );

    // Exports corrected models for the other program.
    let path = folder.path().join("corrected_models.mat");
    open_export(&mut window, folder.path(), "corrected_", &["state-space"]);
    press_export(&mut window);
    assert_notice(&window, NoticeKind::Done, "exported", &["1 file"]);
    let models = crate::exports::models(&path);
    let conditions: Vec<Option<i64>> = models.iter().map(|model| model.facts.condition).collect();
    assert_eq!(conditions, [Some(1), Some(3)]);
    for model in &models {
        assert!(model.draft.matrices.iter().all(Option::is_some));
    }
}

#[test]
fn a_unit_that_neither_a_record_nor_its_samples_say_is_assumed_and_chosen_in_the_page_of_columns() {
    fn row(k: u32) -> String {
        let at = f64::from(k);
        // A rate of 40 cannot be in rad/s; 0.4 can be in rad/s or deg/s.
        let rate = 40.0 * (0.2 * at).sin();
        let slow = 0.4 * (0.2 * at).cos();
        format!(
            "{:.2},{},{},{rate},{slow}\n",
            0.02 * at,
            50.0 + at.sin(),
            50.0 + at.cos()
        )
    }

    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("flight.csv");
    std::fs::write(
        &path,
        "time_s,LON,LAT,P,Q\n".to_owned() + &(0..80).map(row).collect::<String>(),
    )
    .unwrap();
    let dataset = folder.path().join("small.json");
    std::fs::write(&dataset, crate::commands::SMALL).unwrap();
    let mut window = window();
    open_by_path(&mut window, &dataset);
    show_records(&mut window);
    give(&mut window, RecordsCommand::Add(vec![path]));
    // Its name gives no condition: it waits in the list until one is chosen.
    wait_until(&mut window, "the record without a condition", |window| {
        state(window).records.unassigned.len() == 1
    });
    let id = state(&window).condition().id();
    give(&mut window, RecordsCommand::Assign(vec![0], id));
    let row = |window: &Window| {
        state(window)
            .records
            .conditions
            .get(&id)
            .and_then(|of| of.rows.first().cloned())
    };
    let asked = row(&window).expect("the record of the condition");
    assert!(
        matches!(
            asked.cautions.as_slice(),
            [LayoutCaution::UnitAssumed { channel, .. }] if channel == "Q"
        ),
        "{:?}",
        asked.cautions
    );
    assert!(asked.flight.is_some(), "the unit of the dataset is assumed");
    give(&mut window, RecordsCommand::ShowPage(RecordsPage::Columns));
    window.run_steps(2);
    window.get_by_label("Unit of the column of Q").click();
    window.run_steps(3);
    window.get_by_role_and_label(Role::Button, "rad/s").click();
    window.run_steps(3);
    let said = row(&window).unwrap();
    assert!(said.cautions.is_empty(), "{:?}", said.cautions);
    assert_eq!(
        said.layout
            .outputs
            .iter()
            .map(|used| used.unwrap().factor)
            .collect::<Vec<_>>(),
        [1.0, 180.0 / std::f64::consts::PI]
    );
}

fn show_records(window: &mut Window) {
    window.state_mut().dispatch(LayoutCommand::ShowStart(false));
    show(window, View::Records);
}

#[test]
fn reading_is_told_beside_stop_which_ends_it_and_leaves_what_was_open() {
    fn row(k: u32) -> String {
        format!("{:.3},{k},1,2,3,4,5,6,7,8,9\n", 0.02 * f64::from(k))
    }

    fn rows(window: &Window) -> usize {
        state(window)
            .records
            .conditions
            .values()
            .map(|of| of.rows.len())
            .sum()
    }

    let folder = tempfile::tempdir().unwrap();
    let text = "time_s,LON,LAT,PED,COL,P,Q,R,NX,NY,NZ\n".to_owned()
        + &(0..400_000).map(row).collect::<String>();
    let path = folder.path().join("long.csv");
    std::fs::write(&path, text).unwrap();
    let mut window = window();
    show_records(&mut window);
    wait_until(&mut window, "the records looked for", |window| {
        let records = &state(window).records;
        let conditions = state(window).dataset().conditions().len();
        records.reading.is_none() && records.conditions.len() == conditions
    });
    let before = rows(&window);
    let progress = format!("reading {} …", path.display());
    window.state_mut().dispatch(RecordsCommand::Add(vec![path]));
    window.step();
    // The page, which has no record to show, says so too; its words have no Stop beside them.
    let progress = window.get_by_label(&progress).rect();
    let stop = window.get_by_label("Stop");
    assert!(stop.rect().y_range().contains(progress.center().y));
    stop.click();
    window.run_steps(2);
    assert!(state(&window).records.reading.is_none());
    assert_notice(&window, NoticeKind::Done, "reading-stopped", &["long.csv"]);

    // Stop also cancels the opening of a dataset.
    let name = state(&window).dataset().name().to_owned();
    let large = folder.path().join("large.json");
    let blanks = " ".repeat(60 << 20);
    std::fs::write(&large, format!("{blanks}{}", crate::commands::SMALL)).unwrap();
    window.state_mut().dispatch(FileCommand::Open(large));
    window.step();
    assert!(state(&window).opening.is_some());
    window.get_by_label("Stop").click();
    window.run_steps(2);
    assert!(state(&window).opening.is_none());
    std::thread::sleep(Duration::from_millis(400));
    settle(&mut window);
    assert_eq!(
        (state(&window).dataset().name(), rows(&window)),
        (name.as_str(), before),
        "late answers count no more"
    );
}
