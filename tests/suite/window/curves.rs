//! Interaction with curves: error plot, menus, boxes, cursors, units.

use gdcm::gui::plot::nearest_curve::PICK_RADIUS;
use gdcm::gui::state::view::View;
use gdcm_plot::figure::ConditionSource;
use gdcm_plot::figure::bode::BodeOptions;

use super::plots::{drag_along, place_on_nominal};
use super::views::show;
use super::*;

/// Returns the curve of a role in the error plot.
fn error(window: &Window, role: CurveRole) -> BodeCurve {
    let mut curves = state(window).display.frequency.drawn_errors.iter();
    curves
        .find(|curve| curve.role == role)
        .expect("an error of this role is drawn")
        .clone()
}

fn middle(values: impl Iterator<Item = f64>) -> f64 {
    let mut values: Vec<f64> = values.collect();
    values.sort_by(f64::total_cmp);
    values[values.len() / 2]
}

#[test]
fn the_plot_of_errors_shows_what_the_fit_sees() {
    let mut window = window();
    choose_condition_10(&mut window);
    click(&mut window, "Reject 3 suggested");
    show(&mut window, View::Error);
    let pair = pair(&window, "Q", "LON");
    let shown = state(&window).shown().unwrap().clone();
    let gain = shown.comparison.delta.gain[pair].unwrap();
    let delay_s = shown.comparison.delta.delay_s[pair].unwrap();
    let before = error(&window, CurveRole::Representative);
    // G and D are medians (M6) on the comparison grid, and the drawing grid has other frequencies;
    // hence the tolerances.
    let ratio_db = middle(before.magnitude_db.iter().copied());
    let phase = before.omega.iter().zip(&before.phase_deg[..]);
    assert!(
        (ratio_db - 20.0 * gain.log10()).abs() < 0.02,
        "{ratio_db} {gain}"
    );
    let delay = middle(phase.map(|(omega, phase)| phase.to_radians() / omega));
    assert!((delay - delay_s).abs() < 5e-4, "{delay} {delay_s}");
    let after = error(&window, CurveRole::Corrected);
    let net_db = 20.0 * shown.correction.net_gain(pair).log10();
    let net_delay_s = shown.correction.net_delay_s(pair);
    for k in [0, before.omega.len() / 2, before.omega.len() - 1] {
        // The tolerance allows a few rounding errors in numbers up to 360.
        assert!((before.magnitude_db[k] - net_db - after.magnitude_db[k]).abs() < 1e-10);
        let taken = (before.omega[k] * net_delay_s).to_degrees();
        assert!((before.phase_deg[k] - taken - after.phase_deg[k]).abs() < 1e-10);
    }
    let zero = error(&window, CurveRole::IdentifiedRepresentative);
    assert!(
        zero.magnitude_db
            .iter()
            .chain(&zero.phase_deg[..])
            .all(|value| *value == 0.0)
    );
    let drawn = &state(&window).display.frequency.drawn_errors;
    assert!(
        drawn.iter().all(|curve| !curve.rejected),
        "of models that are kept"
    );
    let ends = (before.omega[0], before.omega[before.omega.len() - 1]);
    assert!(ends.0 >= 0.5 && ends.1 <= 12.0, "within the band: {ends:?}");
}

#[test]
fn phase_errors_can_be_read_as_delays() {
    let mut window = window();
    show(&mut window, View::Error);
    let degrees = error(&window, CurveRole::Corrected);
    choose_of_curves(&mut window, "Phase errors as delays");
    let delays = error(&window, CurveRole::Corrected);
    for k in [0, 100] {
        let expected = 1e3 * degrees.phase_deg[k].to_radians() / degrees.omega[k];
        assert!((delays.phase_deg[k] - expected).abs() < 1e-9);
    }
    let view = &state(&window).display.frequency.error;
    assert!(
        view.value_range(Pane::Phase)
            .contains(delays.phase_deg[100]),
        "the new numbers are fitted"
    );
}

/// Chooses an entry in the curve menu.
fn choose_of_curves(window: &mut Window, entry: &str) {
    click(window, "View");
    click(window, "Curves");
    click(window, entry);
}

#[test]
fn a_click_in_the_plot_of_errors_rejects_a_model_and_its_zoom_is_that_of_the_bode_plot() {
    let mut window = window();
    choose_condition_10(&mut window);
    show(&mut window, View::Error);
    let nominal = error(&window, CurveRole::Nominal);
    // Here the discontinuity of the nominal model separates it from the other models.
    let at = nominal.omega.iter().position(|&omega| omega > 2.0).unwrap();
    let view = &state(&window).display.frequency.error;
    let place = view
        .screen_position(Pane::Magnitude, nominal.omega[at], nominal.magnitude_db[at])
        .unwrap();
    window.hover_at(place);
    window.run_steps(2);
    let id = state(&window)
        .display
        .selection
        .hovered
        .clone()
        .expect("a model is pointed at");
    assert!(
        state(&window).display.curves.cursor.is_some(),
        "and a frequency"
    );
    window.drag_at(place);
    window.run_steps(1);
    window.drop_at(place);
    settle(&mut window);
    assert!(state(&window).study.is_rejected(&id));
    window.hover_at(place);
    window.event(Event::MouseWheel {
        unit: egui::MouseWheelUnit::Line,
        delta: vec2(0.0, 8.0),
        phase: egui::TouchPhase::Move,
        modifiers: Modifiers::NONE,
        source: egui::MouseWheelSource::Wheel,
    });
    window.run_steps(24);
    let zoomed = state(&window).display.frequency.error.omega_range();
    assert!(zoomed.0 > 0.5 && zoomed.1 < 12.0, "{zoomed:?}");
    click(&mut window, "Bode");
    assert_eq!(state(&window).display.frequency.bode.omega_range(), zoomed);
}

/// Clicks a place once, long enough after the previous click to avoid a double click.
fn click_once(window: &mut Window, place: Pos2) {
    window.hover_at(place);
    window.run_steps(4);
    window.drag_at(place);
    window.run_steps(1);
    window.drop_at(place);
    settle(window);
}

#[test]
fn a_click_on_a_reference_line_of_the_errors_rejects_nothing() {
    let mut window = window();
    choose_condition_10(&mut window);
    show(&mut window, View::Error);
    settle(&mut window);
    let before = state(&window).study.clone();
    let panes = [Pane::Magnitude, Pane::Phase];
    let omegas = [0.8, 1.5, 3.0, 7.0];
    // The zero line is the identified model, with which the others are compared.
    for (pane, omega) in panes
        .into_iter()
        .flat_map(|pane| omegas.map(|omega| (pane, omega)))
    {
        let place = state(&window)
            .display
            .frequency
            .error
            .screen_position(pane, omega, 0.0)
            .unwrap();
        click_once(&mut window, place);
        assert_eq!(
            state(&window).study,
            before,
            "zero at {omega} rad/s, {pane:?}"
        );
    }
    let zero = error(&window, CurveRole::IdentifiedRepresentative);
    assert!(!zero.detail.contains("click"), "{}", zero.detail);
    // Reference lines: G, D, quantiles and bounds.
    let pair = state(&window).display.selection.pair;
    let source = ConditionSource {
        study: &state(&window).study,
        analysis: state(&window).shown(),
        schedule: None,
        curves: state(&window).responses().unwrap(),
        variant: None,
    };
    let rules = source.error_references(
        pair,
        &BodeOptions::default(),
        &state(&window).display.frequency.drawn_errors,
    );
    let mut near_curves = 0;
    for rule in &rules {
        for omega in omegas {
            let view = &state(&window).display.frequency.error;
            let place = view
                .screen_position(rule.pane, omega, rule.level.at(omega))
                .unwrap();
            if !view
                .transform(rule.pane)
                .unwrap()
                .frame()
                .shrink(2.0)
                .contains(place)
            {
                continue;
            }
            let is_near = |curve: &BodeCurve| {
                let value = curve.value_at(rule.pane, omega);
                let at = value.and_then(|value| view.screen_position(rule.pane, omega, value));
                at.is_some_and(|at| at.distance(place) < PICK_RADIUS)
            };
            near_curves += usize::from(
                state(&window)
                    .display
                    .frequency
                    .drawn_errors
                    .iter()
                    .any(is_near),
            );
            click_once(&mut window, place);
            assert_eq!(
                state(&window).study,
                before,
                "{} at {omega} rad/s",
                rule.label
            );
        }
    }
    assert!(
        near_curves > 2,
        "curves are within reach of the pointer there: {near_curves} of {} lines",
        rules.len()
    );
}

#[test]
fn phases_are_wrapped_and_a_curve_is_moved_by_a_turn_on_wish() {
    let mut window = window();
    choose_condition_10(&mut window);
    let before = drawn(&window, CurveRole::Nominal);
    choose_from_menu_of_nominal(&mut window, "Phase +360°");
    let moved = drawn(&window, CurveRole::Nominal);
    assert_eq!(moved.phase_deg[200], before.phase_deg[200] + 360.0);
    assert!(moved.detail.contains("phase +360°"), "{}", moved.detail);
    assert_eq!(last_change(&window), None, "it changes no decision");
    choose_of_curves(&mut window, "Phases wrapped");
    for curve in &state(&window).display.frequency.drawn {
        assert!(
            curve
                .phase_deg
                .iter()
                .filter(|phase| phase.is_finite())
                .all(|phase| phase.abs() <= 180.0)
        );
    }
}

/// Chooses an entry in the context menu of the nominal curve.
fn choose_from_menu_of_nominal(window: &mut Window, entry: &str) {
    let place = place_on_nominal(window);
    window.hover_at(place);
    window.run_steps(2);
    for pressed in [true, false] {
        let button = PointerButton::Secondary;
        let modifiers = Modifiers::NONE;
        window.event(Event::PointerButton {
            pos: place,
            button,
            pressed,
            modifiers,
        });
        window.run_steps(1);
    }
    window.run_steps(2);
    click(window, entry);
}

#[test]
fn a_curve_can_be_hidden_isolated_and_taken_away_from_its_menu() {
    let mut window = window();
    choose_condition_10(&mut window);
    let id = ModelId::new(ConditionId(10), BundleKind::Physics, "nominal");
    choose_from_menu_of_nominal(&mut window, "Hide curve");
    assert!(drawn(&window, CurveRole::Nominal).hidden);
    assert!(!state(&window).study.is_rejected(&id));
    click(&mut window, "1 model hidden ×");
    assert!(!drawn(&window, CurveRole::Nominal).hidden);
    choose_from_menu_of_nominal(&mut window, "Isolate model");
    assert_eq!(
        state(&window).display.selection.isolated.as_ref(),
        Some(&id)
    );
    window.key_press(Key::Escape);
    settle(&mut window);
    assert_eq!(
        state(&window).display.selection.isolated,
        None,
        "Escape ends it"
    );
    choose_from_menu_of_nominal(&mut window, "Isolate model");
    click(&mut window, "Only nominal ×");
    assert_eq!(
        state(&window).display.selection.isolated,
        None,
        "and so does the chip that says so"
    );
    choose_from_menu_of_nominal(&mut window, "Copy values");
    choose_from_menu_of_nominal(&mut window, "Reject model");
    assert!(state(&window).study.is_rejected(&id));
}

#[test]
fn what_a_box_was_drawn_over_is_rejected_and_restored_in_one_step() {
    let mut window = window();
    choose_condition_10(&mut window);
    let place = place_on_nominal(&window);
    let start = state(&window).study.clone();
    window.event(Event::ModifiersChanged(Modifiers::SHIFT));
    drag_along(&mut window, place - vec2(8.0, 8.0), place + vec2(8.0, 8.0));
    window.drop_at(place + vec2(8.0, 8.0));
    window.event(Event::ModifiersChanged(Modifiers::NONE));
    settle(&mut window);
    let selected = state(&window).display.curves.selected.clone();
    assert!(
        selected.contains(&ModelId::new(
            ConditionId(10),
            BundleKind::Physics,
            "nominal"
        )),
        "{selected:?}"
    );
    let one = selected.len() == 1;
    let count = selected.len();
    let models = if one {
        "1 model".to_owned()
    } else {
        format!("{count} models")
    };
    click(&mut window, &format!("Reject {models}"));
    assert!(
        selected
            .iter()
            .all(|id| state(&window).study.is_rejected(id))
    );
    click(&mut window, &format!("Restore {models}"));
    assert_eq!(state(&window).study, start);
    for _ in 0..2 {
        window.key_press_modifiers(Modifiers::COMMAND, Key::Z);
        settle(&mut window);
    }
    assert_eq!(last_change(&window), None, "two steps");
    click(&mut window, "Select none ×");
    assert!(state(&window).display.curves.selected.is_empty());
}

#[test]
fn the_values_of_every_role_at_the_cursor_are_listed_and_two_marks_show_what_changes() {
    let mut window = window();
    choose_condition_10(&mut window);
    let frame = *state(&window)
        .display
        .frequency
        .bode
        .transform(Pane::Phase)
        .unwrap()
        .frame();
    for part in [0.4, 0.6] {
        let at = frame.lerp_inside(vec2(part, 0.98));
        window.hover_at(at);
        window.run_steps(3);
        assert!(
            window.query_by_label_contains("; corrected: ").is_some(),
            "listed at the cursor"
        );
        for pressed in [true, false] {
            let button = PointerButton::Secondary;
            let modifiers = Modifiers::NONE;
            window.event(Event::PointerButton {
                pos: at,
                button,
                pressed,
                modifiers,
            });
            window.run_steps(1);
        }
        window.run_steps(2);
        click(&mut window, "Mark frequency");
    }
    assert_eq!(state(&window).display.curves.pinned.len(), 2);
    window.run_steps(2);
    assert!(
        window.query_by_label_contains("Δ corrected: ").is_some(),
        "the changes between the marks"
    );
    window.hover_at(frame.lerp_inside(vec2(0.5, 0.98)));
    window.run_steps(2);
    let middle = state(&window)
        .display
        .curves
        .cursor
        .expect("the pointer is in the plot");
    window.key_press(Key::M);
    window.run_steps(2);
    let pinned = state(&window).display.curves.pinned.clone();
    assert!(
        pinned.len() == 2 && (pinned[1] / middle - 1.0).abs() < 1e-9,
        "{pinned:?} {middle}"
    );
    choose_of_curves(&mut window, "Hide the values at the cursor");
    assert!(window.query_by_label_contains("Δ corrected: ").is_none());
}

#[test]
fn magnitudes_are_read_as_ratios_in_the_units_of_the_channels() {
    let mut window = window();
    let before = drawn(&window, CurveRole::Nominal).magnitude_db;
    choose_of_curves(&mut window, "Magnitudes as ratios");
    assert_eq!(
        drawn(&window, CurveRole::Nominal).magnitude_db,
        before,
        "drawn where they were"
    );
    assert_eq!(
        state(&window).display.curves.magnitude,
        gdcm::gui::plot::quantity::MagnitudeUnit::Ratio
    );
}

#[test]
fn hidden_roles_are_switched_in_the_legend_and_stay_hidden_in_other_conditions() {
    let mut window = window();
    click(&mut window, "Show perturbed");
    assert!(drawn(&window, CurveRole::Perturbed).hidden);
    click(&mut window, CONDITION_10);
    assert!(drawn(&window, CurveRole::Perturbed).hidden);
    click(&mut window, "Show perturbed");
    assert!(!drawn(&window, CurveRole::Perturbed).hidden);
}

#[test]
fn a_model_is_rejected_for_a_reason_in_words() {
    let mut window = window();
    choose_condition_10(&mut window);
    let place = place_on_nominal(&window);
    window.hover_at(place);
    window.run_steps(2);
    for pressed in [true, false] {
        let button = PointerButton::Secondary;
        let modifiers = Modifiers::NONE;
        window.event(Event::PointerButton {
            pos: place,
            button,
            pressed,
            modifiers,
        });
        window.run_steps(1);
    }
    window.run_steps(2);
    window.get_by_label("Rejection reason").focus();
    window.run_steps(2);
    window
        .get_by_label("Rejection reason")
        .type_text("a step near this trim");
    window.run_steps(2);
    click(&mut window, "Reject with reason");
    let id = ModelId::new(ConditionId(10), BundleKind::Physics, "nominal");
    assert!(state(&window).study.is_rejected(&id));
    let reasons = &state(&window).study.choice(ConditionId(10)).physics.reasons;
    assert_eq!(
        reasons.get("nominal").map(String::as_str),
        Some("a step near this trim")
    );
}
