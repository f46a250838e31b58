//! Interaction with plots by the pointer.

use gdcm::gui::commands::display::DisplayCommand;
use gdcm::gui::state::view::View;
use gdcm_plot::figure::Range;
use gdcm_plot::figure::responses::{
    AirspeedCache, AirspeedCurves, AirspeedResponse, fitted_values,
};
use gdcm_study::AcrossRole;

use super::lists::texts_in;
use super::views::{give, show};
use super::*;

/// Returns the position of a point on the nominal model's curve.
pub(super) fn place_on_nominal(window: &Window) -> Pos2 {
    let nominal = drawn(window, CurveRole::Nominal);
    // At 2 rad/s the nominal model is 3 dB above the other curves, so that the pointer can hit no
    // other.
    let at = nominal.omega.iter().position(|&omega| omega > 2.0).unwrap();
    let view = &state(window).display.frequency.bode;
    view.screen_position(Pane::Magnitude, nominal.omega[at], nominal.magnitude_db[at])
        .unwrap()
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
        assert_eq!(
            state(&window).display.selection.hovered.as_ref(),
            Some(&id),
            "hovering points at the model"
        );
        window.drag_at(place);
        window.run_steps(1);
        window.drop_at(place);
        settle(&mut window);
        assert_eq!(state(&window).study.is_rejected(&id), rejected);
        // Wait, because a second click soon after the first would be a double click, which fits the
        // plot.
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
        // Press and release in the same frame: a frame of the test harness takes nearly as long as
        // the maximum interval of a double click.
        for pressed in [true, false] {
            let button = PointerButton::Primary;
            let modifiers = Modifiers::NONE;
            window.input_mut().events.push(Event::PointerButton {
                pos: place,
                button,
                pressed,
                modifiers,
            });
        }
        window.step();
    }
    settle(&mut window);
    assert_eq!(state(&window).study, start);
    assert_eq!(last_change(&window), None, "nothing to undo");
    assert!(
        state(&window).history.redo_step().is_some(),
        "what could be redone before still can"
    );
}

/// Presses the primary button at `from` and drags to `to` in steps, without releasing the button.
pub(super) fn drag_along(window: &mut Window, from: Pos2, to: Pos2) {
    window.hover_at(from);
    window.run_steps(2);
    window.drag_at(from);
    window.run_steps(1);
    for step in 1..=6 {
        window.hover_at(from + (to - from) * (step as f32 / 6.0));
        // Wait until the results for an earlier step have arrived.
        settle(window);
    }
}

/// Returns the position of a frequency in the magnitude plot, near its lower edge.
fn place_of(window: &Window, omega: f64) -> Pos2 {
    let view = &state(window).display.frequency.bode;
    let frame = *view.transform(Pane::Magnitude).unwrap().frame();
    let place = view.screen_position(Pane::Magnitude, omega, 0.0).unwrap();
    pos2(place.x, frame.bottom() - 12.0)
}

/// Returns the frequency at a position in the magnitude plot.
fn omega_at(window: &Window, place: Pos2) -> f64 {
    let transform = *state(window)
        .display
        .frequency
        .bode
        .transform(Pane::Magnitude)
        .unwrap();
    10f64.powf(transform.value_from_position(place).x)
}

fn band(window: &Window) -> (f64, f64) {
    let band = state(window).study.settings.band;
    (band.min(), band.max())
}

#[test]
fn a_dragged_end_of_the_band_stays_under_the_pointer_and_the_view_follows_when_it_is_let_go() {
    let mut window = window();
    choose_condition_10(&mut window);
    for (end, by) in [(0.5, 54.0), (12.0, -80.0)] {
        let from = place_of(&window, end);
        let to = from + vec2(by, 0.0);
        let expected = omega_at(&window, to);
        let view = state(&window).display.frequency.bode.omega_range();
        drag_along(&mut window, from, to);
        assert_eq!(
            state(&window).display.frequency.bode.omega_range(),
            view,
            "nothing moves under the pointer"
        );
        window.drop_at(to);
        settle(&mut window);
        let found = if by > 0.0 {
            band(&window).0
        } else {
            band(&window).1
        };
        // A dragged limit has the three digits that it displays.
        let displayed: f64 = format!("{expected:.2e}").parse().unwrap();
        assert_eq!(found, displayed, "{end} dragged to {expected}");
        // The axis shows the range of the curves: 1.7 times the band at either end.
        let (first, last) = state(&window).display.frequency.bode.omega_range();
        let (min, max) = band(&window);
        assert!(
            (first * 1.7 / min - 1.0).abs() < 1e-6 && (last / 1.7 / max - 1.0).abs() < 1e-6,
            "{first} to {last}"
        );
    }
    window.key_press_modifiers(Modifiers::COMMAND, Key::Z);
    settle(&mut window);
    assert_eq!(band(&window).1, 12.0, "a drag is one decision");
}

#[test]
fn a_zoom_outlives_whatever_is_computed_and_whatever_is_shown() {
    fn ranges(
        window: &Window,
    ) -> (
        (f64, f64),
        gdcm_plot::figure::Range,
        gdcm_plot::figure::Range,
    ) {
        let view = &state(window).display.frequency.bode;
        (
            view.omega_range(),
            view.value_range(Pane::Magnitude),
            view.value_range(Pane::Phase),
        )
    }

    let mut window = window();
    choose_condition_10(&mut window);
    let area = *state(&window)
        .display
        .frequency
        .bode
        .transform(Pane::Magnitude)
        .unwrap()
        .frame();
    let from = area.lerp_inside(vec2(0.3, 0.3));
    let to = area.lerp_inside(vec2(0.7, 0.8));
    window.hover_at(from);
    window.run_steps(2);
    let button = |pressed| {
        let pos = if pressed { from } else { to };
        let modifiers = Modifiers::NONE;
        Event::PointerButton {
            pos,
            button: PointerButton::Secondary,
            pressed,
            modifiers,
        }
    };
    window.event(button(true));
    window.run_steps(1);
    for at in [from.lerp(to, 0.5), to] {
        window.hover_at(at);
        window.run_steps(1);
    }
    window.event(button(false));
    settle(&mut window);
    let zoomed = ranges(&window);
    assert!(zoomed.0.0 > 0.5 && zoomed.0.1 < 12.0, "{zoomed:?}");
    click(&mut window, "Keep physics model V+10kt");
    assert_eq!(ranges(&window), zoomed, "after another analysis");
    window.key_press(Key::ArrowUp);
    settle(&mut window);
    assert_ne!(state(&window).condition().id(), ConditionId(10));
    assert_eq!(
        (ranges(&window).0, ranges(&window).1),
        (zoomed.0, zoomed.1),
        "in another condition"
    );
    assert_ne!(
        ranges(&window).2,
        zoomed.2,
        "phases, which nobody zoomed, are fitted"
    );
    click(&mut window, "Response LAT → P");
    assert_eq!(
        (ranges(&window).0, ranges(&window).1),
        (zoomed.0, zoomed.1),
        "of another response"
    );
    window.key_press(Key::F);
    settle(&mut window);
    assert!(
        ranges(&window).0.0 < 0.5 && ranges(&window).0.1 > 12.0,
        "until everything is fitted"
    );
}

#[test]
fn a_click_on_a_net_gain_dot_goes_to_its_condition() {
    let mut window = window();
    let place = state(&window).display.figures[&View::NetGain]
        .screen_position(0, &MarkId::Condition(ConditionId(3)))
        .expect("condition 3 has a dot");
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
    for view in [View::Bode, View::Overview, View::Channels, View::Assessment] {
        show(&mut window, view);
        let tab = view.name();
        wait_for_background(&mut window);
        let frames = window.run();
        assert!(frames < 60, "{tab} settled after {frames} frames");
        assert_asks_for_no_frame(&mut window, tab);
    }
    show(&mut window, View::Bode);
    // While the pointer rests on a curve, its name remains visible.
    let nominal = drawn(&window, CurveRole::Nominal);
    let view = &state(&window).display.frequency.bode;
    let place = view
        .screen_position(
            Pane::Magnitude,
            nominal.omega[200],
            nominal.magnitude_db[200],
        )
        .unwrap();
    window.hover_at(place);
    window.run();
    assert!(state(&window).display.selection.hovered.is_some());
    assert_asks_for_no_frame(&mut window, "Bode with the pointer on a curve");
}

/// Draws a few frames without input, which must not request further frames.
fn assert_asks_for_no_frame(window: &mut Window, what: &str) {
    for _ in 0..5 {
        window.run_steps(1);
        let delays: Vec<Duration> = window
            .output()
            .viewport_output
            .values()
            .map(|output| output.repaint_delay)
            .collect();
        assert_eq!(
            delays,
            [Duration::MAX],
            "{what}: {:?}",
            window.ctx.repaint_causes()
        );
    }
}

#[test]
fn what_is_out_of_sight_is_not_tessellated() {
    let mut window = window();
    for view in [View::Overview, View::Channels, View::Assessment, View::Bode] {
        show(&mut window, view);
        assert_little_is_hidden(&window, view.name());
    }
    let nominal = drawn(&window, CurveRole::Nominal);
    let view = &state(&window).display.frequency.bode;
    let place = view
        .screen_position(
            Pane::Magnitude,
            nominal.omega[200],
            nominal.magnitude_db[200],
        )
        .unwrap();
    window.hover_at(place);
    for _ in 0..50 {
        window.event(egui::Event::MouseWheel {
            unit: egui::MouseWheelUnit::Line,
            delta: vec2(0.0, 1.0),
            phase: egui::TouchPhase::Move,
            modifiers: Modifiers::NONE,
            source: egui::MouseWheelSource::Wheel,
        });
        window.run_steps(4);
    }
    let (min, max) = state(&window).display.frequency.bode.omega_range();
    assert!(max / min < 1.2, "the wheel zoomed in: {min} to {max} rad/s");
    assert_little_is_hidden(&window, "Bode zoomed in");
}

/// Asserts that few triangles lie outside the visible area. Shapes are tessellated as a whole, so
/// dashes and letters at an edge have a few triangles beyond it.
fn assert_little_is_hidden(window: &Window, what: &str) {
    let (hidden, all) = hidden_triangles(window);
    assert!(
        all > 10_000 && hidden < all / 100,
        "{what}: {hidden} of {all} triangles"
    );
}

/// Returns the number of triangles outside their clip rectangles in the last frame, and the number
/// of all triangles.
fn hidden_triangles(window: &Window) -> (usize, usize) {
    let output = window.output();
    let mut hidden = 0;
    let mut all = 0;
    for primitive in window
        .ctx
        .tessellate(output.shapes.clone(), output.pixels_per_point)
    {
        let egui::epaint::Primitive::Mesh(mesh) = &primitive.primitive else {
            continue;
        };
        for corners in mesh.indices.chunks_exact(3) {
            let positions = corners
                .iter()
                .map(|&corner| mesh.vertices[corner as usize].pos);
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
    let requested = state(&window).results.requested;
    let analysis = state(&window).results.analysis.clone();
    for step in 0..40 {
        // Moves diagonally across lists, plots, matrix and settings.
        window.hover_at(pos2(40.0 * step as f32, 25.0 * step as f32));
        window.run_steps(1);
    }
    assert_eq!(state(&window).results.requested, requested);
    let same = state(&window)
        .results
        .analysis
        .as_ref()
        .zip(analysis.as_ref())
        .map(|(a, b)| std::sync::Arc::ptr_eq(a, b));
    assert_eq!(same, Some(true));
}

/// Returns the curves of the Airspeeds view.
pub(super) fn across_curves(window: &Window) -> AirspeedCurves {
    let state = state(window);
    let display = &state.display.frequency.across_display;
    let response = AirspeedResponse {
        dataset: state.dataset(),
        analysis: state.analysis(),
        roles: &display.roles,
        conditions: &display.conditions.of_study(&state.study),
        pair: state.display.selection.pair,
        band: state.study.settings.band,
        responses: state.across().expect("the responses are there"),
    };
    response.curves(&mut AirspeedCache::default())
}

/// Returns the value ranges to which the Airspeeds view should be fitted, from the curves within
/// the band: magnitude and phase.
fn across_values(window: &Window) -> [Range; 2] {
    let drawn = across_curves(window).responses;
    let band = state(window).study.settings.band;
    let band = Range::new(band.min(), band.max());
    [Pane::Magnitude, Pane::Phase].map(|pane| fitted_values(&drawn, pane, band).expect("curves"))
}

/// Height of a fitted axis relative to its curves: margins, round ends, and at least five labels.
const MOST_HEIGHT: f64 = 1.75;

/// Returns whether the Airspeeds view shows these ranges with at most a small margin.
fn across_is_fitted(window: &Window) -> bool {
    let view = &state(window).display.frequency.across;
    let values = across_values(window);
    [Pane::Magnitude, Pane::Phase]
        .into_iter()
        .zip(values)
        .all(|(pane, values)| {
            let shown = view.value_range(pane);
            shown.min <= values.min
                && shown.max >= values.max
                && shown.width() <= MOST_HEIGHT * values.width().max(20.0)
        })
}

/// Turns the mouse wheel over the magnitude plot of the Airspeeds view.
fn zoom_across(window: &mut Window) {
    let frame = *state(window)
        .display
        .frequency
        .across
        .transform(Pane::Magnitude)
        .expect("it is drawn")
        .frame();
    window.hover_at(frame.center());
    window.event(Event::MouseWheel {
        unit: egui::MouseWheelUnit::Line,
        delta: vec2(0.0, 8.0),
        phase: egui::TouchPhase::Move,
        modifiers: Modifiers::NONE,
        source: egui::MouseWheelSource::Wheel,
    });
    window.run_steps(24);
    assert!(!across_is_fitted(window), "the wheel looks closer");
}

#[test]
fn airspeeds_is_fitted_to_another_response_and_by_f_and_by_fit() {
    let mut window = window();
    show(&mut window, View::Across);
    wait_until(&mut window, "the responses", |window| {
        state(window).across().is_some()
    });
    window.run_steps(2);
    assert!(across_is_fitted(&window));
    let before = state(&window)
        .display
        .frequency
        .across
        .value_range(Pane::Magnitude);
    for (output, input) in [("NX", "PED"), ("NZ", "LAT"), ("P", "LAT")] {
        click(&mut window, &format!("Response {input} → {output}"));
        let across = &state(&window).display.frequency.across;
        let shown = [Pane::Magnitude, Pane::Phase].map(|pane| across.value_range(pane));
        assert!(
            across_is_fitted(&window),
            "{input} → {output}: {shown:?} for {:?}",
            across_values(&window)
        );
    }
    click(&mut window, "Response PED → NX");
    assert_ne!(
        state(&window)
            .display
            .frequency
            .across
            .value_range(Pane::Magnitude),
        before,
        "they are far apart"
    );
    give(
        &mut window,
        DisplayCommand::ShowAcrossAlone(AcrossRole::Nominal),
    );
    settle(&mut window);
    wait_for_background(&mut window);
    window.run_steps(2);
    assert!(
        across_is_fitted(&window),
        "the nominal models, as soon as they are there"
    );
    zoom_across(&mut window);
    window.key_press(Key::F);
    window.run_steps(3);
    assert!(across_is_fitted(&window), "F");
    zoom_across(&mut window);
    click(&mut window, "Fit");
    assert!(across_is_fitted(&window), "Fit");
}

#[test]
fn the_names_of_airspeeds_stand_in_the_margin_inside_the_window() {
    let mut window = window();
    show(&mut window, View::Across);
    wait_until(&mut window, "the responses", |window| {
        state(window).across().is_some()
    });
    click(&mut window, "Response LON → Q");
    window.run_steps(2);
    let frame = *state(&window)
        .display
        .frequency
        .across
        .transform(Pane::Magnitude)
        .unwrap()
        .frame();
    let margin = frame
        .with_min_x(frame.right())
        .with_max_x(frame.right() + 76.0);
    let names = texts_in(&window, margin);
    let texts: Vec<&str> = names.iter().map(|(text, _)| text.as_str()).collect();
    // The example has conditions at five airspeeds.
    for name in [
        "45 kt × 2",
        "60 kt × 2",
        "90 kt × 2",
        "120 kt × 3",
        "140 kt × 2",
    ] {
        assert!(texts.contains(&name), "{name} in {texts:?}");
    }
    for (text, place) in &names {
        assert!(
            margin.expand(1.0).contains_rect(*place),
            "{text} at {place} in {margin}"
        );
    }
}

#[test]
fn the_error_of_the_schedule_lies_beside_the_responses_and_is_fitted() {
    let mut window = window();
    show(&mut window, View::Across);
    wait_until(&mut window, "the responses", |window| {
        state(window).across().is_some()
    });
    click(&mut window, "Response LON → Q");
    window.run_steps(2);
    let curves = across_curves(&window);
    assert_eq!(curves.errors.len(), 11);
    let optima = curves.optima.expect("every condition has an optimum");
    assert_eq!(optima.omega.len(), curves.errors[0].omega.len());
    let frequency = &state(&window).display.frequency;
    let responses = *frequency.across.transform(Pane::Magnitude).unwrap().frame();
    let errors = *frequency
        .across_error
        .transform(Pane::Magnitude)
        .unwrap()
        .frame();
    assert!(responses.right() < errors.left());
    assert!((responses.top() - errors.top()).abs() < 0.5, "one row");
    let band = state(&window).study.settings.band;
    let band = Range::new(band.min(), band.max());
    let values = fitted_values(&curves.errors, Pane::Magnitude, band).unwrap();
    let shown = frequency.across_error.value_range(Pane::Magnitude);
    assert!(shown.min <= values.min && shown.max >= values.max);
    assert!(shown.width() <= 1.2 * values.width().max(1.0));
}

#[test]
fn the_small_plots_of_an_output_share_their_magnitudes_and_all_share_their_frequencies() {
    let mut window = window();
    choose_condition_10(&mut window);
    show(&mut window, View::Overview);
    window.run_steps(2);
    let view = &state(&window).display.frequency.overview;
    let [frequencies, _] = view
        .ranges_in(pair(&window, "P", "LAT"), Pane::Magnitude)
        .expect("the cell is drawn");
    let mut rows = Vec::new();
    for output in ["P", "Q", "R"] {
        let mut row: Option<Range> = None;
        for input in ["LAT", "LON", "PED", "COL"] {
            let at = pair(&window, output, input);
            let [across, values] = view.ranges_in(at, Pane::Magnitude).unwrap();
            assert_eq!(across, frequencies, "{input} → {output}");
            assert_eq!(*row.get_or_insert(values), values, "{input} → {output}");
        }
        rows.extend(row);
    }
    assert!(
        rows[0] != rows[1] || rows[1] != rows[2],
        "other outputs have ranges of their own"
    );
}

#[test]
fn the_pointer_in_a_small_plot_marks_its_frequency_in_every_plot() {
    let mut window = window();
    show(&mut window, View::Overview);
    window.run_steps(2);
    let at = pair(&window, "Q", "LON");
    let view = &state(&window).display.frequency.overview;
    let place = view.position_in(at, 0.5, 0.0).expect("the cell is drawn");
    let middle = view.screen_position(at).unwrap();
    window.hover_at(pos2(place.x, middle.y));
    window.run_steps(2);
    let omega = state(&window).display.curves.cursor.expect("a frequency");
    // Tolerance: a hundredth of a point on the screen.
    assert!((omega.log10() - 0.5).abs() < 1e-3, "{omega}");
}
