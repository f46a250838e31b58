//! Decisions in the window, and their results.

use gdcm::gui::commands::layout::LayoutCommand;
use gdcm::gui::panels::verdict::Verdict;
use gdcm_words::derivation::derivation;

use super::views::give;
use super::*;

#[test]
fn from_the_example_to_exported_corrections() {
    fn first(window: &Window) -> f64 {
        channel_plots(state(window)).figure.plots[0].panels[0]
            .dots()
            .next()
            .unwrap()
            .y
    }

    let mut window = window();
    choose_condition_10(&mut window);
    assert_eq!(drawn(&window, CurveRole::Nominal).label, "nominal");
    let corrected_before = drawn(&window, CurveRole::Corrected);

    click(&mut window, "Reject 3 suggested");
    assert_eq!(
        state(&window)
            .shown()
            .unwrap()
            .representative_name(BundleKind::Physics),
        "ROLL-5deg"
    );
    assert!(
        drawn(&window, CurveRole::Nominal).rejected,
        "the nominal model is one of the outliers"
    );
    let corrected = drawn(&window, CurveRole::Corrected);
    assert_ne!(
        corrected.magnitude_db, corrected_before.magnitude_db,
        "another representative, another corrected curve"
    );

    let on_axis = pair(&window, "Q", "LON");
    let wanted = state(&window).shown().unwrap().comparison.delta.gain[on_axis].unwrap();
    // The constraint is exact up to the rounding of a product of two gains.
    assert!((net_gain(&window, "Q", "LON") / wanted - 1.0).abs() < 1e-9);
    click(&mut window, "Hold LON → Q");
    assert!(!state(&window).study.settings.constrained[on_axis]);
    assert!(
        (net_gain(&window, "Q", "LON") / wanted - 1.0).abs() > 1e-4,
        "free, it goes where the others pull it"
    );

    // LAT → P remains constrained. Constrain LON → Q again and release PED → R, so that alpha
    // changes the gains of its channels.
    click(&mut window, "Hold LON → Q");
    let before = first(&window);
    slide(&mut window, "α gains", 12.5);
    settle(&mut window);
    assert_eq!(state(&window).study.settings.alpha_gain, 12.5);
    assert!(
        (before - first(&window)).abs() > 1e-4,
        "the dots of the channel gains moved"
    );

    let folder = tempfile::tempdir().unwrap();
    export_to(&mut window, folder.path());
    let written = crate::read_json(&folder.path().join("corrections.json"));
    assert_eq!(crate::entries(&written["conditions"]).len(), 11);
    assert_eq!(written["settings"]["alpha_gain"], 12.5);
    let tenth = &written["conditions"][9];
    assert_eq!(
        (&tenth["id"], &tenth["physics_representative"]),
        (&10.into(), &"ROLL-5deg".into())
    );
    let shown = state(&window).shown().unwrap();
    assert_eq!(
        tenth["gains"]["outputs"]["Q"], shown.correction.output_gains[1],
        "read back to the last digit"
    );
    assert!(
        folder.path().join("corrections.csv").exists()
            && folder.path().join("assessment.csv").exists()
    );
}

#[test]
fn freeing_an_on_axis_entry_moves_its_net_gain_dots_with_alpha() {
    fn gain(window: &Window) -> f64 {
        net_gain(window, "NY", "PED")
    }

    let mut window = window();
    click(&mut window, "Hold PED → NY");
    let before = gain(&window);
    slide(&mut window, "α gains", 100.0);
    settle(&mut window);
    assert!((gain(&window) - before).abs() > 1e-4, "{before} stayed");
}

#[test]
fn every_choice_can_be_undone_and_done_again() {
    let mut window = window();
    choose_condition_10(&mut window);
    let start = state(&window).study.clone();
    click(&mut window, "Reject 3 suggested");
    click(&mut window, "Hold PED → R");
    slide(&mut window, "α delays", 3.0);
    settle(&mut window);
    let end = state(&window).study.clone();
    for _ in 0..3 {
        window.key_press_modifiers(Modifiers::COMMAND, Key::Z);
        settle(&mut window);
    }
    assert_eq!(state(&window).study, start);
    assert_eq!(last_change(&window), None);
    for _ in 0..3 {
        window.key_press_modifiers(Modifiers::COMMAND | Modifiers::SHIFT, Key::Z);
        settle(&mut window);
    }
    assert_eq!(state(&window).study, end);
}

#[test]
fn at_least_one_model_stays_in_each_bundle() {
    // In this dataset all three identified models fit in the list without scrolling.
    let mut window = window_with(Opened::Dataset(crate::REFERENCE_DATASET.clone()), warm());
    let models: Vec<String> = state(&window)
        .condition()
        .bundle(BundleKind::Identified)
        .iter()
        .map(|model| model.name.clone())
        .collect();
    give(&mut window, LayoutCommand::ShowIdentified(true));
    for model in &models {
        click(&mut window, &format!("Keep identified model {model}"));
    }
    assert_notice(&window, NoticeKind::Trouble, "last-model", &[]);
    assert_eq!(
        state(&window)
            .study
            .choice(ConditionId(1))
            .identified
            .rejected
            .len(),
        models.len() - 1
    );
}

#[test]
fn a_pinned_model_represents_its_bundle() {
    fn representative(window: &Window) -> String {
        state(window)
            .shown()
            .unwrap()
            .representative_name(BundleKind::Physics)
            .to_owned()
    }

    let mut window = window();
    click(&mut window, "Use physics model V+10kt as representative");
    assert_eq!(representative(&window), "V+10kt");
    click(&mut window, "Use physics model V+10kt as representative");
    assert_eq!(representative(&window), "nominal", "the medoid again");
}

#[test]
fn the_badge_says_proven_and_every_cell_says_what_holding_or_freeing_it_costs() {
    let mut window = window();
    window.get_by_label("global optimum ✓");
    wait_for_toggles(&mut window);
    for (output, input, is_held) in [("Q", "LON", true), ("Q", "PED", false)] {
        let pair = pair(&window, output, input);
        assert_eq!(state(&window).study.settings.constrained[pair], is_held);
        let (gain, _) = state(&window).toggles().unwrap().of_pair(pair);
        assert!(gain.is_some(), "{output}/{input}");
        let name = state(&window).dataset().pair_name(pair);
        let costs = toggle_cost_texts(state(&window), pair);
        assert!(costs.iter().any(|cost| cost.contains(&name)), "{costs:?}");
    }
}

#[test]
fn held_gains_out_of_reach_are_explained_and_the_explanation_is_exported() {
    let mut window = window();
    unfold_settings(&mut window, true);
    window
        .get_by_label("Upper gain bound")
        .set_value_accesskit(1.0);
    settle(&mut window);
    unfold_settings(&mut window, false);
    let gain = &Verdict::new(state(&window)).rows[0];
    assert_eq!(gain.message.code, "stops-at-bound");
    window.get_by_label_contains(&gain.message.text);
    let shown = state(&window).shown().unwrap();
    assert!(remark_codes(&window).contains(&"gains-missed"));
    let marked = MatrixMarks::new(shown).pairs;
    assert!(marked.contains(&pair(&window, "Q", "LON")));

    let folder = tempfile::tempdir().unwrap();
    export_to(&mut window, folder.path());
    let written = crate::read_json(&folder.path().join("corrections.json"));
    let solution = &written["conditions"][0]["gain_solution"];
    assert_eq!(
        (&solution["matched"], &solution["proven"]),
        (&false.into(), &true.into())
    );
    let mut conflicts = crate::entries(&solution["explanation"]["conflicts"]).iter();
    let conflict =
        conflicts.find(|conflict| conflict["entries"] == serde_json::json!([["Q", "LON"]]));
    let upper = conflict
        .and_then(|conflict| conflict["upper"].as_f64())
        .expect("the bound that would do is written");
    // k_Q k_LON = G needs a bound of at least its square root, rounded up to three digits.
    let gain =
        state(&window).shown().unwrap().comparison.delta.gain[pair(&window, "Q", "LON")].unwrap();
    assert_eq!(upper, (100.0 * gain.sqrt()).ceil() / 100.0);
}

#[test]
fn the_matrix_can_be_worked_from_the_keyboard() {
    let mut window = window();
    let target = pair(&window, "Q", "PED");
    window.get_by_label("Response PED → Q").focus();
    window.run_steps(2);
    window.key_press(Key::Space);
    settle(&mut window);
    assert!(state(&window).study.settings.constrained[target]);
}

#[test]
fn control_and_r_reject_the_suggested_outliers() {
    let mut window = window();
    choose_condition_10(&mut window);
    let suggested = state(&window).shown().unwrap().suggested();
    assert_eq!(suggested.len(), 3);
    window.key_press_modifiers(Modifiers::COMMAND, Key::R);
    settle(&mut window);
    let rejected = &state(&window)
        .study
        .choice(ConditionId(10))
        .physics
        .rejected;
    assert_eq!(*rejected, suggested.into_iter().collect());
}

#[test]
fn a_rejection_keeps_the_reason_given_for_it_and_undo_takes_both_back() {
    let mut window = window();
    let before = state(&window).study.clone();
    let model = ModelId::new(ConditionId(1), BundleKind::Physics, "V+10kt");
    window
        .get_by_label("physics model V+10kt")
        .click_secondary();
    window.run_steps(2);
    window.get_by_label("Reject with a reason…").click();
    window.run_steps(3);
    window.event(Event::Text("trim not converged".to_owned()));
    window.run_steps(2);
    window.key_press(Key::Enter);
    settle(&mut window);
    assert!(state(&window).study.is_rejected(&model));
    assert_eq!(
        state(&window).study.reason(&model),
        Some("trim not converged")
    );
    assert_eq!(state(&window).forms.shown, None);
    window.key_press_modifiers(Modifiers::COMMAND, Key::Z);
    settle(&mut window);
    assert_eq!(state(&window).study, before);
}

#[test]
fn how_a_figure_of_a_cell_was_computed_is_told_with_its_numbers() {
    let mut window = window();
    window.get_by_label("Response LON → Q").click_secondary();
    window.run_steps(2);
    window
        .get_by_label_contains("How was this computed?")
        .click();
    window.run_steps(3);
    window.get_by_role_and_label(Role::Button, "G").click();
    window.run_steps(3);
    let gain =
        state(&window).shown().unwrap().comparison.delta.gain[pair(&window, "Q", "LON")].unwrap();
    let asked = state(&window)
        .display
        .selection
        .explained
        .clone()
        .expect("the figure is explained");
    let told = derivation(state(&window).analysis().unwrap(), &asked).unwrap();
    assert_eq!(told.value, gain);
    window.get_by_label(&told.equation);
}
