//! The view of named physics parameters.

use gdcm::gui::commands::layout::LayoutCommand;
use gdcm::gui::commands::selection::SelectionCommand;
use gdcm::gui::commands::study::StudyCommand;
use gdcm::gui::state::view::View;
use gdcm_io::load_dataset;
use gdcm_study::PhysicsCorrection;
use gdcm_study::results::physics_assessment::PhysicsAssessment;

use super::pointing::assert_beside_rows;
use super::views::give;
use super::*;

/// The dataset with known truth: tail lift +11 %, swashplate phase +1.6 deg, inflow mass -12 %.
const DATASET: &str = concat!(
    env!("CARGO_MANIFEST_DIR"),
    "/tests/data/reference/physics-dataset.json.gz"
);

/// Opens the dataset in the view, and waits for the diagnosis.
fn physics_window() -> Window {
    let opened = Opened::Dataset(load_dataset(Path::new(DATASET)).unwrap());
    let mut window = window_with(opened, Setup::default());
    give(&mut window, LayoutCommand::ShowView(View::Physics));
    assessment(&mut window);
    window
}

/// Waits for the diagnosis under the present decisions.
fn assessment(window: &mut Window) -> Arc<PhysicsAssessment> {
    wait_until(window, "the diagnosis", |window| {
        let state = state(window);
        let known = state.results.physics.as_ref();
        known.is_some_and(|(job, _)| job.study.settings == state.study.settings)
            && state.physics().is_some()
    });
    window.run_steps(2);
    let found = state(window).physics().unwrap().as_ref().unwrap();
    Arc::clone(found.as_ref().unwrap())
}

#[test]
fn a_click_selects_a_parameter_whose_evidence_is_shown() {
    let mut window = physics_window();
    let found = assessment(&mut window);
    let findings = found.applied.findings.as_ref().unwrap();
    let mut named: Vec<&str> = Vec::new();
    for diagnosed in findings.named() {
        named.push(&diagnosed.parameter.name);
    }
    named.sort_unstable();
    assert_eq!(
        named,
        ["swashplate_phase", "tail_lift"],
        "as in the reference"
    );
    for name in named {
        window.get_by_label(&format!("Parameter {name}")).click();
        window.run_steps(3);
        let selected = state(&window).display.physics.selected.as_deref();
        assert_eq!(selected, Some(name));
        window.get_by_label(&format!("Plausible change of {name}"));
    }
}

#[test]
fn the_named_parameters_are_used_with_a_click_and_undo_gives_the_models_back() {
    let mut window = physics_window();
    click(&mut window, "Use 2 parameters");
    assert_eq!(
        state(&window).study.settings.physics,
        PhysicsCorrection::Named
    );
    let analysis = state(&window).analysis().unwrap();
    let applied = analysis.applied_physics().unwrap();
    assert_eq!(applied.values.len(), 2);
    give(&mut window, StudyCommand::Undo);
    settle(&mut window);
    assert_eq!(
        state(&window).study.settings.physics,
        PhysicsCorrection::Off
    );
    assert!(
        state(&window)
            .analysis()
            .unwrap()
            .applied_physics()
            .is_none()
    );
}

#[test]
fn a_parameter_that_is_switched_off_takes_no_part_in_the_fit() {
    let mut window = physics_window();
    click(&mut window, "Fit tail_lift");
    let found = assessment(&mut window);
    let findings = found.applied.findings.as_ref().unwrap();
    assert!(
        findings
            .parameters
            .iter()
            .all(|parameter| parameter.name != "tail_lift")
    );
    assert_eq!(findings.off.len(), 1);
    assert!(
        state(&window)
            .study
            .settings
            .physics_parameters
            .off
            .contains("tail_lift")
    );
}

#[test]
fn the_parameter_list_at_the_left_counts_runs_and_shows_a_parameter() {
    let mut window = physics_window();
    let parameters = state(&window).dataset().parameters().to_vec();
    assert!(!parameters.is_empty());
    for parameter in parameters {
        let name = parameter.name;
        window.get_by_label(&format!("Runs of {name}")).click();
        window.run_steps(3);
        let selected = state(&window).display.physics.selected.as_deref();
        assert_eq!(selected, Some(name.as_str()));
    }
}

#[test]
fn responses_before_and_after_are_those_of_the_condition_in_front() {
    let mut window = physics_window();
    let found = assessment(&mut window);
    for (id, effect) in &found.conditions {
        give(&mut window, SelectionCommand::SelectCondition(*id));
        settle(&mut window);
        let most = &effect.responses[0];
        let name = state(&window).dataset().pair_name(most.pair);
        let title = format!("{name}, J {:.1} → {:.1}", most.cost.without, most.cost.with);
        let panels = window.get_all_by_label_contains(&title).count();
        assert!(panels > 0, "no plot {title} in condition {id}");
    }
}

#[test]
fn the_description_of_a_parameter_covers_no_row_of_the_ranking() {
    let mut window = physics_window();
    let found = assessment(&mut window);
    let findings = found.applied.findings.as_ref().unwrap();
    let ranked = findings.ranked();
    let mut rows = Vec::new();
    for index in ranked {
        rows.push(format!("Parameter {}", findings.parameters[index].name));
    }
    assert!(rows.len() > 2, "{rows:?}");
    assert_beside_rows(&mut window, &rows[0].clone(), &rows);
}
