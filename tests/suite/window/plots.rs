//! The plots, worked with the pointer.

use super::*;

/// A point of the nominal model's curve.
fn place_on_nominal(window: &Window) -> Pos2 {
    let nominal = drawn(window, CurveRole::Nominal);
    // At 2 rad/s the nominal model stands 3 dB above the bundle: nothing else is near.
    let at = nominal.omega.iter().position(|&omega| omega > 2.0).unwrap();
    let view = &state(window).display.bode;
    view.screen_position(Pane::Magnitude, nominal.omega[at], nominal.magnitude_db[at]).unwrap()
}

#[test]
fn a_click_on_a_curve_rejects_it_and_another_click_restores_it() {
    let mut window = window();
    choose_condition_10(&mut window);
    let place = place_on_nominal(&window);
    let id = ModelId::new(ConditionId(10), BundleKind::Physics, "nominal");
    for rejected in [true, false] {
        window.hover_at(place);
        window.run_steps(2);
        assert_eq!(state(&window).display.hovered.as_ref(), Some(&id), "hovering points at the model");
        window.drag_at(place);
        window.run_steps(1);
        window.drop_at(place);
        settle(&mut window);
        assert_eq!(state(&window).study.is_rejected(&id), rejected);
        // A second click soon after would be a double click, which fits the plot.
        window.run_steps(4);
    }
}

#[test]
fn a_double_click_on_a_curve_leaves_no_decision() {
    let mut window = window();
    choose_condition_10(&mut window);
    let start = state(&window).study.clone();
    click(&mut window, "Keep physics model V+10kt");
    window.key_press_modifiers(Modifiers::COMMAND, Key::Z);
    settle(&mut window);
    let place = place_on_nominal(&window);
    window.hover_at(place);
    window.run_steps(2);
    for _ in 0..2 {
        // Both in one frame: a frame of the harness takes nearly as long as two clicks may be apart.
        for pressed in [true, false] {
            let (button, modifiers) = (PointerButton::Primary, Modifiers::NONE);
            window.input_mut().events.push(Event::PointerButton { pos: place, button, pressed, modifiers });
        }
        window.step();
    }
    settle(&mut window);
    assert_eq!(state(&window).study, start);
    assert_eq!(state(&window).history.undo_label(), None, "nothing to undo");
    assert!(state(&window).history.redo_label().is_some(), "what could be redone before still can");
}

/// Presses the primary button at `from` and drags it to `to`, in steps; it is not let go.
fn drag_along(window: &mut Window, from: Pos2, to: Pos2) {
    window.hover_at(from);
    window.run_steps(2);
    window.drag_at(from);
    window.run_steps(1);
    for step in 1..=6 {
        window.hover_at(from + (to - from) * (step as f32 / 6.0));
        // Long enough for the answer to an earlier step to come.
        settle(window);
    }
}

/// Where a frequency stands in the magnitude plot, near its lower edge.
fn place_of(window: &Window, omega: f64) -> Pos2 {
    let view = &state(window).display.bode;
    let frame = *view.transform(Pane::Magnitude).unwrap().frame();
    let place = view.screen_position(Pane::Magnitude, omega, 0.0).unwrap();
    pos2(place.x, frame.bottom() - 12.0)
}

/// The frequency at a place of the magnitude plot.
fn omega_at(window: &Window, place: Pos2) -> f64 {
    let transform = *state(window).display.bode.transform(Pane::Magnitude).unwrap();
    10f64.powf(transform.value_from_position(place).x)
}

fn band(window: &Window) -> (f64, f64) {
    let band = state(window).study.settings.band;
    (band.min(), band.max())
}

#[test]
fn a_dragged_end_of_the_band_stays_under_the_pointer_and_the_view_stands_still() {
    let mut window = window();
    choose_condition_10(&mut window);
    let view = state(&window).display.bode.omega_range();
    for (end, by) in [(0.5, 54.0), (12.0, -80.0)] {
        let from = place_of(&window, end);
        let to = from + vec2(by, 0.0);
        let expected = omega_at(&window, to);
        drag_along(&mut window, from, to);
        window.drop_at(to);
        settle(&mut window);
        let found = if by > 0.0 { band(&window).0 } else { band(&window).1 };
        // A hundredth of a point on the screen.
        assert!((found / expected - 1.0).abs() < 1e-4, "{end} dragged to {expected}: {found}");
        assert_eq!(state(&window).display.bode.omega_range(), view);
    }
    window.key_press_modifiers(Modifiers::COMMAND, Key::Z);
    settle(&mut window);
    assert_eq!(band(&window).1, 12.0, "a drag is one decision");
}

#[test]
fn a_zoom_outlives_whatever_is_computed_and_whatever_is_shown() {
    let mut window = window();
    choose_condition_10(&mut window);
    let area = *state(&window).display.bode.transform(Pane::Magnitude).unwrap().frame();
    let (from, to) = (area.lerp_inside(vec2(0.3, 0.3)), area.lerp_inside(vec2(0.7, 0.8)));
    window.hover_at(from);
    window.run_steps(2);
    let button = |pressed| {
        let (pos, modifiers) = (if pressed { from } else { to }, Modifiers::NONE);
        Event::PointerButton { pos, button: PointerButton::Secondary, pressed, modifiers }
    };
    window.event(button(true));
    window.run_steps(1);
    for at in [from.lerp(to, 0.5), to] {
        window.hover_at(at);
        window.run_steps(1);
    }
    window.event(button(false));
    settle(&mut window);
    let ranges = |window: &Window| {
        let view = &state(window).display.bode;
        (view.omega_range(), view.value_range(Pane::Magnitude), view.value_range(Pane::Phase))
    };
    let zoomed = ranges(&window);
    assert!(zoomed.0.0 > 0.5 && zoomed.0.1 < 12.0, "{zoomed:?}");
    click(&mut window, "Keep physics model V+10kt");
    assert_eq!(ranges(&window), zoomed, "after another analysis");
    window.key_press(Key::ArrowUp);
    settle(&mut window);
    assert_ne!(state(&window).condition().id(), ConditionId(10));
    assert_eq!((ranges(&window).0, ranges(&window).1), (zoomed.0, zoomed.1), "in another condition");
    assert_ne!(ranges(&window).2, zoomed.2, "phases, which nobody zoomed, are fitted");
    click(&mut window, "Response LAT → P");
    assert_eq!((ranges(&window).0, ranges(&window).1), (zoomed.0, zoomed.1), "of another response");
    window.key_press(Key::F);
    settle(&mut window);
    assert!(ranges(&window).0.0 < 0.5 && ranges(&window).0.1 > 12.0, "until everything is fitted");
}

#[test]
fn a_click_on_a_net_gain_dot_goes_to_its_condition() {
    let mut window = window();
    let place = state(&window).display.net_gain.screen_position(0, ConditionId(3)).expect("condition 3 has a dot");
    window.hover_at(place);
    window.run_steps(2);
    window.drag_at(place);
    window.run_steps(1);
    window.drop_at(place);
    settle(&mut window);
    assert_eq!(state(&window).condition().id(), ConditionId(3));
}

#[test]
fn an_idle_window_draws_no_frames() {
    let mut window = window();
    wait_for_toggles(&mut window);
    for tab in ["Bode", "Overview", "Channels", "Assessment"] {
        click(&mut window, tab);
        let frames = window.run();
        assert!(frames < 60, "{tab} settled after {frames} frames");
        assert_asks_for_no_frame(&mut window, tab);
    }
    click(&mut window, "Bode");
    // A pointer that rests on a curve: its name is shown, and stays.
    let nominal = drawn(&window, CurveRole::Nominal);
    let view = &state(&window).display.bode;
    let place = view.screen_position(Pane::Magnitude, nominal.omega[200], nominal.magnitude_db[200]).unwrap();
    window.hover_at(place);
    window.run();
    assert!(state(&window).display.hovered.is_some());
    assert_asks_for_no_frame(&mut window, "Bode with the pointer on a curve");
}

/// Draws a few frames without input, none of which may ask for another one.
fn assert_asks_for_no_frame(window: &mut Window, what: &str) {
    for _ in 0..5 {
        window.run_steps(1);
        let delays: Vec<Duration> =
            window.output().viewport_output.values().map(|output| output.repaint_delay).collect();
        assert_eq!(delays, [Duration::MAX], "{what}: {:?}", window.ctx.repaint_causes());
    }
}

#[test]
fn what_is_out_of_sight_is_not_tessellated() {
    let mut window = window();
    for tab in ["Overview", "Channels", "Assessment", "Bode"] {
        click(&mut window, tab);
        assert_little_is_hidden(&window, tab);
    }
    let nominal = drawn(&window, CurveRole::Nominal);
    let view = &state(&window).display.bode;
    let place = view.screen_position(Pane::Magnitude, nominal.omega[200], nominal.magnitude_db[200]).unwrap();
    window.hover_at(place);
    for _ in 0..20 {
        window.event(egui::Event::MouseWheel {
            unit: egui::MouseWheelUnit::Line,
            delta: vec2(0.0, 1.0),
            phase: egui::TouchPhase::Move,
            modifiers: Modifiers::NONE,
            source: egui::MouseWheelSource::Wheel,
        });
        window.run_steps(4);
    }
    let (min, max) = state(&window).display.bode.omega_range();
    assert!(max / min < 1.2, "the wheel zoomed in: {min} to {max} rad/s");
    assert_little_is_hidden(&window, "Bode zoomed in");
}

/// Every shape in view is tessellated as a whole: dashes and letters at an edge have a few triangles beyond it.
fn assert_little_is_hidden(window: &Window, what: &str) {
    let (hidden, all) = hidden_triangles(window);
    assert!(all > 10_000 && hidden < all / 100, "{what}: {hidden} of {all} triangles");
}

/// How many triangles of the frame drawn last lie outside what they are clipped to, and how many there are.
fn hidden_triangles(window: &Window) -> (usize, usize) {
    let output = window.output();
    let (mut hidden, mut all) = (0, 0);
    for primitive in window.ctx.tessellate(output.shapes.clone(), output.pixels_per_point) {
        let egui::epaint::Primitive::Mesh(mesh) = &primitive.primitive else { continue };
        for corners in mesh.indices.chunks_exact(3) {
            let positions = corners.iter().map(|&corner| mesh.vertices[corner as usize].pos);
            let bounds = egui::Rect::from_points(&positions.collect::<Vec<_>>());
            hidden += usize::from(!bounds.intersects(primitive.clip_rect));
            all += 1;
        }
    }
    (hidden, all)
}

#[test]
fn pointing_at_plots_starts_no_analysis() {
    let mut window = window();
    let (requested, analysis) = (state(&window).results.requested, state(&window).results.analysis.clone());
    for step in 0..40 {
        // From corner to corner, across lists, plots, matrix and settings.
        window.hover_at(pos2(40.0 * step as f32, 25.0 * step as f32));
        window.run_steps(1);
    }
    assert_eq!(state(&window).results.requested, requested);
    let same =
        state(&window).results.analysis.as_ref().zip(analysis.as_ref()).map(|(a, b)| std::sync::Arc::ptr_eq(a, b));
    assert_eq!(same, Some(true));
}

/// The curve of a role in the plot of errors.
fn error(window: &Window, role: CurveRole) -> BodeCurve {
    let mut curves = state(window).display.drawn_errors.iter();
    curves.find(|curve| curve.role == role).expect("an error of this role is drawn").clone()
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
    click(&mut window, "Error");
    let pair = pair(&window, "Q", "LON");
    let shown = state(&window).shown().unwrap().clone();
    let (gain, delay_s) = (shown.comparison.delta.gain[pair].unwrap(), shown.comparison.delta.delay_s[pair].unwrap());
    let before = error(&window, CurveRole::Representative);
    // The medians of M6 on the grid for drawing: it has other points than that of the comparison.
    let (ratio_db, phase) =
        (middle(before.magnitude_db.iter().copied()), before.omega.iter().zip(&before.phase_deg[..]));
    assert!((ratio_db - 20.0 * gain.log10()).abs() < 0.02, "{ratio_db} {gain}");
    let delay = middle(phase.map(|(omega, phase)| phase.to_radians() / omega));
    assert!((delay - delay_s).abs() < 5e-4, "{delay} {delay_s}");
    let after = error(&window, CurveRole::Corrected);
    let (net_db, net_delay_s) =
        (20.0 * shown.correction.net_gain(pair).value().log10(), shown.correction.net_delay(pair).value_s());
    for k in [0, before.omega.len() / 2, before.omega.len() - 1] {
        // A handful of roundings of numbers up to 360.
        assert!((before.magnitude_db[k] - net_db - after.magnitude_db[k]).abs() < 1e-10);
        let taken = (before.omega[k] * net_delay_s).to_degrees();
        assert!((before.phase_deg[k] - taken - after.phase_deg[k]).abs() < 1e-10);
    }
    let zero = error(&window, CurveRole::IdentifiedRepresentative);
    assert!(zero.magnitude_db.iter().chain(&zero.phase_deg[..]).all(|value| *value == 0.0));
    let drawn = &state(&window).display.drawn_errors;
    assert!(drawn.iter().all(|curve| !curve.rejected), "of models that are kept");
    let ends = (before.omega[0], before.omega[before.omega.len() - 1]);
    assert!(ends.0 >= 0.5 && ends.1 <= 12.0, "within the band: {ends:?}");
}

#[test]
fn phase_errors_can_be_read_as_delays() {
    let mut window = window();
    click(&mut window, "Error");
    let degrees = error(&window, CurveRole::Representative);
    choose_units(&mut window, "Phase errors as delays");
    let delays = error(&window, CurveRole::Representative);
    for k in [0, 100] {
        let expected = 1e3 * degrees.phase_deg[k].to_radians() / degrees.omega[k];
        assert!((delays.phase_deg[k] - expected).abs() < 1e-9);
    }
    let view = &state(&window).display.error;
    assert!(view.value_range(Pane::Phase).contains(delays.phase_deg[100]), "the new numbers are fitted");
}

/// Chooses an entry of the menu of units.
fn choose_units(window: &mut Window, entry: &str) {
    click(window, "View");
    click(window, "Units of curves");
    click(window, entry);
}

#[test]
fn a_click_in_the_plot_of_errors_rejects_a_model_and_its_zoom_is_that_of_the_bode_plot() {
    let mut window = window();
    choose_condition_10(&mut window);
    click(&mut window, "Error");
    let nominal = error(&window, CurveRole::Nominal);
    // Where the step of the physics model takes it farthest from the others.
    let at = nominal.omega.iter().position(|&omega| omega > 2.0).unwrap();
    let view = &state(&window).display.error;
    let place = view.screen_position(Pane::Magnitude, nominal.omega[at], nominal.magnitude_db[at]).unwrap();
    window.hover_at(place);
    window.run_steps(2);
    let id = state(&window).display.hovered.clone().expect("a model is pointed at");
    assert!(state(&window).display.curves.cursor.is_some(), "and a frequency");
    window.drag_at(place);
    window.run_steps(1);
    window.drop_at(place);
    settle(&mut window);
    assert!(state(&window).study.is_rejected(&id));
    window.hover_at(place);
    window.event(Event::MouseWheel {
        unit: egui::MouseWheelUnit::Line,
        delta: vec2(0.0, 3.0),
        phase: egui::TouchPhase::Move,
        modifiers: Modifiers::NONE,
        source: egui::MouseWheelSource::Wheel,
    });
    window.run_steps(12);
    let zoomed = state(&window).display.error.omega_range();
    assert!(zoomed.0 > 0.5 && zoomed.1 < 12.0, "{zoomed:?}");
    click(&mut window, "Bode");
    assert_eq!(state(&window).display.bode.omega_range(), zoomed);
}

#[test]
fn phases_are_wrapped_and_a_curve_is_moved_by_a_turn_on_wish() {
    let mut window = window();
    choose_condition_10(&mut window);
    let before = drawn(&window, CurveRole::Nominal);
    choose_from_menu_of_nominal(&mut window, "One turn up");
    let moved = drawn(&window, CurveRole::Nominal);
    assert_eq!(moved.phase_deg[200], before.phase_deg[200] + 360.0);
    assert!(moved.detail.contains("moved up by 1 turn"), "{}", moved.detail);
    assert_eq!(state(&window).history.undo_label(), None, "it changes no decision");
    choose_units(&mut window, "Phases wrapped");
    for curve in &state(&window).display.drawn {
        assert!(curve.phase_deg.iter().filter(|phase| phase.is_finite()).all(|phase| phase.abs() <= 180.0));
    }
}

/// Chooses an entry of the menu that a secondary click on the nominal curve opens.
fn choose_from_menu_of_nominal(window: &mut Window, entry: &str) {
    let place = place_on_nominal(window);
    window.hover_at(place);
    window.run_steps(2);
    for pressed in [true, false] {
        let (button, modifiers) = (PointerButton::Secondary, Modifiers::NONE);
        window.event(Event::PointerButton { pos: place, button, pressed, modifiers });
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
    assert_eq!(state(&window).display.isolated.as_ref(), Some(&id));
    window.key_press(Key::Escape);
    settle(&mut window);
    assert_eq!(state(&window).display.isolated, None, "Escape ends it");
    choose_from_menu_of_nominal(&mut window, "Isolate model");
    click(&mut window, "Only nominal ×");
    assert_eq!(state(&window).display.isolated, None, "and so does the chip that says so");
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
    assert!(selected.contains(&ModelId::new(ConditionId(10), BundleKind::Physics, "nominal")), "{selected:?}");
    let (one, count) = (selected.len() == 1, selected.len());
    let models = if one { "1 model".to_owned() } else { format!("{count} models") };
    click(&mut window, &format!("Reject {models}"));
    assert!(selected.iter().all(|id| state(&window).study.is_rejected(id)));
    click(&mut window, &format!("Restore {models}"));
    assert_eq!(state(&window).study, start);
    for _ in 0..2 {
        window.key_press_modifiers(Modifiers::COMMAND, Key::Z);
        settle(&mut window);
    }
    assert_eq!(state(&window).history.undo_label(), None, "two steps");
    click(&mut window, "Select none ×");
    assert!(state(&window).display.curves.selected.is_empty());
}

#[test]
fn the_values_of_every_role_at_the_cursor_are_listed_and_two_marks_show_what_changes() {
    let mut window = window();
    choose_condition_10(&mut window);
    let frame = *state(&window).display.bode.transform(Pane::Phase).unwrap().frame();
    for part in [0.4, 0.6] {
        let at = frame.lerp_inside(vec2(part, 0.98));
        window.hover_at(at);
        window.run_steps(3);
        assert!(window.query_by_label_contains("corrected: dB").is_some(), "listed at the cursor");
        for pressed in [true, false] {
            let (button, modifiers) = (PointerButton::Secondary, Modifiers::NONE);
            window.event(Event::PointerButton { pos: at, button, pressed, modifiers });
            window.run_steps(1);
        }
        window.run_steps(2);
        click(&mut window, "Mark frequency");
    }
    assert_eq!(state(&window).display.curves.pinned.len(), 2);
    window.run_steps(2);
    assert!(window.query_by_label_contains("corrected: Δ dB").is_some(), "the changes between the marks");
    choose_units(&mut window, "List no values");
    assert!(window.query_by_label_contains("corrected: Δ dB").is_none());
}

#[test]
fn magnitudes_are_read_as_ratios_in_the_units_of_the_channels() {
    let mut window = window();
    let before = drawn(&window, CurveRole::Nominal).magnitude_db;
    choose_units(&mut window, "Magnitudes as ratios");
    assert_eq!(drawn(&window, CurveRole::Nominal).magnitude_db, before, "drawn where they were");
    assert_eq!(state(&window).display.curves.magnitude, gdcm::view::plot::MagnitudeUnit::Ratio);
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
