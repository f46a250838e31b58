//! Interaction with a Bode plot: clicks, dragging, zooming, fitting, chips and menus.

use std::collections::BTreeSet;

use egui::vec2;

use super::*;
use crate::gui::plot::bode_event::{BodeEvent, CurveAction};
use crate::gui::plot::curve_command::CurveCommand;
use crate::gui::widgets::palette::{self, Palette};

/// Test state: a Bode plot, its curves, and the events so far.
pub(super) struct PlotState {
    pub(super) curves: Vec<BodeCurve>,
    pub(super) band: (f64, f64),
    pub(super) view: BodeView,
    pub(super) events: Vec<BodeEvent>,
    pub(super) hidden_roles: BTreeSet<Role>,
}

pub(super) fn harness(curves: Vec<BodeCurve>) -> Harness<'static, PlotState> {
    let state = PlotState {
        curves,
        band: (0.5, 12.0),
        view: BodeView::default(),
        events: Vec::new(),
        hidden_roles: BTreeSet::new(),
    };
    let mut harness = Harness::builder()
        .with_step_dt(0.02)
        .with_size(vec2(900.0, 600.0))
        .with_context_setup(palette::apply)
        .build_ui_state(
            |ui, state: &mut PlotState| {
                let scene = BodeScene {
                    hidden_roles: Some(&state.hidden_roles),
                    ..BodeScene::new("LON → Q", &state.curves, state.band)
                };
                let palette = Palette::from_visuals(ui.visuals());
                for event in bode_ui(ui, &scene, &mut state.view, &palette) {
                    if let BodeEvent::BandDragged { min, max } = event {
                        state.band = (min, max);
                    }
                    state.events.push(event);
                }
            },
            state,
        );
    harness.run();
    harness
}

pub(super) fn three_curves() -> Vec<BodeCurve> {
    vec![
        lag(1, 0.0, 1.0, Role::Nominal),
        lag(2, 3.0, 1.0, Role::Perturbed),
        lag(3, 20.0, 3.0, Role::Corrected),
    ]
}

/// Returns a point on the magnitude of curve `index` at the frequency of sample `k`.
pub(super) fn point_on(harness: &Harness<'_, PlotState>, index: usize, k: usize) -> Pos2 {
    let curve = &harness.state().curves[index];
    harness
        .state()
        .view
        .screen_position(Pane::Magnitude, curve.omega[k], curve.magnitude_db[k])
        .unwrap()
}

/// Returns a position in the magnitude plot that is far from every curve.
pub(super) fn empty_spot(harness: &Harness<'_, PlotState>) -> Pos2 {
    point_on(harness, 2, 60) + vec2(0.0, 40.0)
}

/// Like [`empty_spot`], for a plot with a single curve.
fn empty_spot_of_one(harness: &Harness<'_, PlotState>) -> Pos2 {
    point_on(harness, 0, 60) + vec2(0.0, 40.0)
}

pub(super) fn clicks(harness: &Harness<'_, PlotState>) -> Vec<BodeEvent> {
    let is_click = |event: &&BodeEvent| {
        matches!(
            event,
            BodeEvent::Clicked(_) | BodeEvent::ClickUndone(_) | BodeEvent::Isolated(_)
        )
    };
    harness
        .state()
        .events
        .iter()
        .filter(is_click)
        .cloned()
        .collect()
}

#[test]
fn a_click_names_the_nearest_curve() {
    let mut harness = harness(three_curves());
    for (index, id) in [(0, 1), (1, 2), (2, 3)] {
        let at = point_on(&harness, index, 60) + vec2(0.0, 2.0);
        // Without a pause, clicks close together would count as a double click.
        harness.run_steps(30);
        click(&mut harness, at);
        assert_eq!(
            clicks(&harness).last(),
            Some(&BodeEvent::Clicked(numbered(id)))
        );
    }
}

#[test]
fn a_click_away_from_all_curves_picks_none() {
    let mut harness = harness(three_curves());
    let at = empty_spot(&harness);
    click(&mut harness, at);
    assert_eq!(clicks(&harness), []);
}

#[test]
fn a_click_with_alt_isolates() {
    let mut harness = harness(three_curves());
    let at = point_on(&harness, 1, 60);
    harness.event(Event::ModifiersChanged(Modifiers::ALT));
    press(&mut harness, at, PointerButton::Primary, Modifiers::ALT);
    assert_eq!(clicks(&harness), [BodeEvent::Isolated(numbered(2))]);
}

#[test]
fn hovering_is_reported_once_when_it_begins_and_once_when_it_ends() {
    let mut harness = harness(three_curves());
    let at = point_on(&harness, 0, 60);
    harness.hover_at(at);
    harness.run();
    let away = empty_spot(&harness);
    harness.hover_at(away);
    harness.run();
    let expected = [
        BodeEvent::Hovered(Some(numbered(1))),
        BodeEvent::Hovered(None),
    ];
    assert_eq!(harness.state().events, expected);
}

#[test]
fn dragging_an_end_of_the_band_moves_it_and_not_the_plot() {
    let mut harness = harness(three_curves());
    let before = harness.state().view.omega_range();
    let at = |harness: &Harness<'_, PlotState>, omega| {
        harness
            .state()
            .view
            .screen_position(Pane::Phase, omega, -45.0)
            .unwrap()
    };
    let path = [at(&harness, 0.5), at(&harness, 0.8), at(&harness, 1.0)];
    drag(&mut harness, &path, PointerButton::Primary);
    let state = harness.state();
    assert!(
        (state.band.0 - 1.0).abs() < 1e-3 && state.band.1 == 12.0,
        "{:?}",
        state.band
    );
    assert_eq!(
        state
            .events
            .iter()
            .filter(|event| **event == BodeEvent::BandReleased)
            .count(),
        1
    );
    assert_eq!(state.view.omega_range(), before);
}

#[test]
fn panning_one_plot_pans_the_frequencies_of_both() {
    let mut harness = harness(three_curves());
    let (before, _) = harness.state().view.omega_range();
    let from = empty_spot(&harness);
    drag(
        &mut harness,
        &[from, from + vec2(50.0, 0.0), from + vec2(100.0, 0.0)],
        PointerButton::Primary,
    );
    let view = &harness.state().view;
    assert!(view.omega_range().0 < 0.9 * before);
    let left = |transform: Option<&egui_plot::PlotTransform>| {
        transform.map(|transform| transform.bounds().min()[0])
    };
    assert_eq!(
        left(view.transform(Pane::Magnitude)),
        left(view.transform(Pane::Phase))
    );
}

#[test]
fn a_box_drawn_with_the_secondary_button_is_zoomed_into() {
    let mut harness = harness(three_curves());
    let at = |harness: &Harness<'_, PlotState>, omega, db| {
        harness
            .state()
            .view
            .screen_position(Pane::Magnitude, omega, db)
            .unwrap()
    };
    let path = [
        at(&harness, 1.0, 5.0),
        at(&harness, 2.0, 0.0),
        at(&harness, 3.0, -5.0),
    ];
    drag(&mut harness, &path, PointerButton::Secondary);
    let view = &harness.state().view;
    let (min, max) = view.omega_range();
    assert!(
        (min - 1.0).abs() < 0.02 && (max - 3.0).abs() < 0.05,
        "{min} {max}"
    );
    assert!((view.value_range(Pane::Magnitude).max - 5.0).abs() < 0.2);
    assert_eq!(clicks(&harness), []);
}

#[test]
fn the_wheel_zooms_about_the_pointer() {
    let mut harness = harness(three_curves());
    let at = point_on(&harness, 1, 60);
    harness.hover_at(at);
    harness.step();
    let before = harness.state().view.omega_range();
    harness.event(wheel(vec2(0.0, 120.0)));
    // Scrolling is smooth and takes some frames.
    harness.run_steps(12);
    let after = harness.state().view.omega_range();
    assert!(
        after.0 > before.0 && after.1 < before.1,
        "{before:?} {after:?}"
    );
    assert!(point_on(&harness, 1, 60).distance(at) < 0.1);
}

#[test]
fn a_notch_of_the_wheel_zooms_by_a_tenth_and_stops_a_decade_beyond_the_data() {
    let mut harness = harness(three_curves());
    harness.hover_at(point_on(&harness, 1, 60));
    harness.step();
    let decades = |harness: &Harness<'_, PlotState>| {
        let (min, max) = harness.state().view.omega_range();
        (max / min).log10()
    };
    let before = decades(&harness);
    let notch = |lines: f32| Event::MouseWheel {
        unit: egui::MouseWheelUnit::Line,
        delta: vec2(0.0, lines),
        phase: egui::TouchPhase::Move,
        modifiers: Modifiers::NONE,
        source: egui::MouseWheelSource::Wheel,
    };
    harness.event(notch(1.0));
    harness.run_steps(30);
    // The tolerance of 1e-3 is needed because egui accumulates smooth scrolling in single
    // precision.
    assert!(
        (before / decades(&harness) - 1.1).abs() < 1e-3,
        "{before} {}",
        decades(&harness)
    );
    for _ in 0..40 {
        harness.event(notch(-5.0));
        harness.run_steps(10);
    }
    assert!(
        decades(&harness) <= before + 2.0 + 1e-6,
        "{before} {}",
        decades(&harness)
    );
}

#[test]
fn new_data_keep_the_zoom_and_a_double_click_fits_them() {
    let mut harness = harness(three_curves());
    let fitted = harness.state().view.omega_range();
    let from = empty_spot(&harness);
    drag(
        &mut harness,
        &[from, from + vec2(80.0, 30.0)],
        PointerButton::Primary,
    );
    let panned = harness.state().view.omega_range();
    assert_ne!(panned, fitted);
    harness
        .state_mut()
        .curves
        .push(lag(4, -30.0, 1.0, Role::Perturbed));
    harness.run();
    assert_eq!(harness.state().view.omega_range(), panned);
    let empty = empty_spot(&harness);
    click(&mut harness, empty);
    click(&mut harness, empty);
    harness.run();
    let view = &harness.state().view;
    assert_eq!(view.omega_range(), fitted);
    assert!(
        view.value_range(Pane::Magnitude).min < -56.0,
        "the new curve is in view"
    );
}

#[test]
fn a_double_click_on_a_curve_takes_its_first_click_back_and_leaves_the_view() {
    let mut harness = harness(three_curves());
    let from = empty_spot(&harness);
    drag(
        &mut harness,
        &[from, from + vec2(40.0, 0.0)],
        PointerButton::Primary,
    );
    let panned = harness.state().view.omega_range();
    let at = point_on(&harness, 1, 60);
    click(&mut harness, at);
    click(&mut harness, at);
    assert_eq!(
        clicks(&harness),
        [
            BodeEvent::Clicked(numbered(2)),
            BodeEvent::ClickUndone(numbered(2))
        ]
    );
    harness.run();
    assert_eq!(harness.state().view.omega_range(), panned);
}

#[test]
fn values_are_fitted_to_other_curves_until_the_engineer_zooms_them() {
    let mut harness = harness(three_curves());
    let heights =
        |harness: &Harness<'_, PlotState>| harness.state().view.value_range(Pane::Magnitude);
    let first = heights(&harness);
    let other = |harness: &mut Harness<'_, PlotState>, gain_db| {
        harness.state_mut().curves = vec![lag(5, gain_db, 1.0, Role::Nominal)];
        harness.state_mut().view.request_refit();
        harness.run();
    };
    other(&mut harness, 40.0);
    let fitted = heights(&harness);
    assert!(fitted.min > first.min + 20.0, "{first:?} {fitted:?}");
    let from = empty_spot_of_one(&harness);
    drag(
        &mut harness,
        &[from, from + vec2(0.0, 30.0)],
        PointerButton::Primary,
    );
    let panned = heights(&harness);
    assert_ne!(panned, fitted);
    other(&mut harness, 0.0);
    assert_eq!(heights(&harness), panned, "zoomed by hand");
    harness.state_mut().view.request_fit();
    harness.run();
    assert!(heights(&harness).max < 5.0, "a full fit overrides the zoom");
}

#[test]
fn a_sideways_wheel_leaves_the_values_to_be_fitted() {
    let mut harness = harness(three_curves());
    let at = empty_spot(&harness);
    harness.hover_at(at);
    harness.step();
    let before = harness.state().view.omega_range();
    harness.event(wheel(vec2(120.0, 0.0)));
    harness.run_steps(12);
    assert!(harness.state().view.omega_range().1 < before.1);
    let heights = harness.state().view.value_range(Pane::Magnitude);
    harness.state_mut().curves = vec![lag(5, 40.0, 1.0, Role::Nominal)];
    harness.state_mut().view.request_refit();
    harness.run();
    assert!(harness.state().view.value_range(Pane::Magnitude).min > heights.min + 20.0);
}

#[test]
fn the_axis_follows_the_frequencies_of_the_curves_unless_the_engineer_zoomed() {
    let mut harness = harness(three_curves());
    let omega: Arc<[f64]> = (0..120)
        .map(|k| 3.0 * (200.0f64 / 3.0).powf(f64::from(k) / 119.0))
        .collect();
    let others = BodeCurve {
        omega,
        ..lag(1, 0.0, 1.0, Role::Nominal)
    };
    harness.state_mut().curves = vec![others];
    harness.run();
    let followed = harness.state().view.omega_range();
    assert!(
        (followed.0 - 3.0).abs() < 1e-9 && (followed.1 - 200.0).abs() < 1e-9,
        "{followed:?}"
    );
    let from = empty_spot_of_one(&harness);
    drag(
        &mut harness,
        &[from, from + vec2(30.0, 0.0)],
        PointerButton::Primary,
    );
    let panned = harness.state().view.omega_range();
    harness.state_mut().curves = three_curves();
    harness.run();
    assert_eq!(harness.state().view.omega_range(), panned);
}

#[test]
fn values_that_are_not_finite_leave_gaps_and_nothing_panics() {
    let mut curves = three_curves();
    curves[0].magnitude_db = curves[0]
        .magnitude_db
        .iter()
        .enumerate()
        .map(|(k, db)| if k % 7 == 0 { f64::NAN } else { *db })
        .collect();
    curves[1].magnitude_db = vec![f64::NEG_INFINITY; 120].into();
    curves[2].phase_deg = vec![f64::NAN; 120].into();
    curves.push(BodeCurve {
        omega: vec![0.0, -1.0].into(),
        ..lag(4, 0.0, 1.0, Role::Identified)
    });
    let mut harness = harness(curves);
    let at = point_on(&harness, 0, 59);
    click(&mut harness, at);
    assert_eq!(clicks(&harness), [BodeEvent::Clicked(numbered(1))]);
}

#[test]
fn without_curves_there_is_a_message() {
    use egui_kittest::kittest::Queryable;
    let harness = harness(Vec::new());
    harness.get_by_label("Nothing to draw");
}

#[test]
fn every_size_can_be_drawn() {
    let mut harness = harness(three_curves());
    for size in [
        vec2(40.0, 40.0),
        vec2(150.0, 140.0),
        vec2(320.0, 200.0),
        vec2(2000.0, 150.0),
        vec2(160.0, 1200.0),
    ] {
        harness.set_size(size);
        harness.run();
    }
}

#[test]
fn a_chip_with_alt_shows_its_role_alone_and_with_shift_in_front() {
    use egui_kittest::kittest::Queryable;
    let mut harness = harness(three_curves());
    let chip = harness.get_by_label("Show nominal").rect().center();
    for (modifiers, event) in [
        (
            Modifiers::ALT,
            BodeEvent::Display(CurveCommand::ShowRoleAlone(Role::Nominal)),
        ),
        (
            Modifiers::SHIFT,
            BodeEvent::Display(CurveCommand::RaiseRole(Role::Nominal)),
        ),
    ] {
        harness.event(Event::ModifiersChanged(modifiers));
        press(&mut harness, chip, PointerButton::Primary, modifiers);
        harness.run();
        harness.event(Event::ModifiersChanged(Modifiers::NONE));
        assert_eq!(harness.state().events.last(), Some(&event));
    }
}

#[test]
fn every_role_has_a_switch_and_a_hidden_curve_is_neither_drawn_nor_picked() {
    use egui_kittest::kittest::Queryable;
    let mut harness = harness(three_curves());
    harness.get_by_label("Show perturbed").click();
    harness.run();
    assert_eq!(
        harness.state().events,
        [BodeEvent::Display(CurveCommand::ToggleRole(
            Role::Perturbed
        ))]
    );
    let at = point_on(&harness, 1, 60);
    harness.state_mut().hidden_roles.insert(Role::Perturbed);
    harness.state_mut().curves[1].hidden = true;
    harness.run();
    click(&mut harness, at);
    assert_eq!(clicks(&harness), [], "nothing else is near");
    harness.get_by_label("Show perturbed");
}

#[test]
fn a_box_drawn_with_shift_names_the_curves_it_touches_and_does_not_pan() {
    let mut harness = harness(three_curves());
    let before = harness.state().view.omega_range();
    let from = point_on(&harness, 0, 60) + vec2(-20.0, 30.0);
    let to = point_on(&harness, 1, 60) + vec2(20.0, -20.0);
    harness.event(Event::ModifiersChanged(Modifiers::SHIFT));
    drag(
        &mut harness,
        &[from, from.lerp(to, 0.5), to],
        PointerButton::Primary,
    );
    harness.event(Event::ModifiersChanged(Modifiers::NONE));
    harness.run();
    assert!(
        harness
            .state()
            .events
            .contains(&BodeEvent::Boxed(vec![numbered(1), numbered(2)]))
    );
    assert_eq!(harness.state().view.omega_range(), before);
}

#[test]
fn a_secondary_click_on_a_curve_opens_its_menu() {
    use egui_kittest::kittest::Queryable;
    let mut harness = harness(three_curves());
    let at = point_on(&harness, 1, 60);
    press(&mut harness, at, PointerButton::Secondary, Modifiers::NONE);
    harness.run();
    harness.get_by_label("Reject model").click();
    harness.run();
    let chosen = BodeEvent::ActionChosen(numbered(2), CurveAction::RejectOrRestore);
    assert!(
        harness.state().events.contains(&chosen),
        "{:?}",
        harness.state().events
    );
    assert_eq!(clicks(&harness), []);
}

#[test]
fn a_secondary_click_on_the_ground_marks_the_frequency_there() {
    use egui_kittest::kittest::Queryable;
    let mut harness = harness(three_curves());
    let at = empty_spot(&harness);
    let omega = harness.state().curves[2].omega[60];
    press(&mut harness, at, PointerButton::Secondary, Modifiers::NONE);
    harness.run();
    harness.get_by_label("Mark frequency").click();
    harness.run();
    let marked = harness.state().events.iter().find_map(|event| match event {
        BodeEvent::Display(CurveCommand::PinCursor(omega)) => Some(*omega),
        _ => None,
    });
    assert!(
        marked.is_some_and(|marked| (marked / omega - 1.0).abs() < 1e-3),
        "{marked:?} {omega}"
    );
}

/// Counts the long lines in the last frame: curves drawn as lines instead of an image.
fn long_lines(harness: &Harness<'_, PlotState>) -> usize {
    let is_long =
        |shape: &egui::Shape| matches!(shape, egui::Shape::Path(path) if path.points.len() > 10);
    harness
        .output()
        .shapes
        .iter()
        .filter(|clipped| is_long(&clipped.shape))
        .count()
}

#[test]
fn many_static_curves_are_an_image_and_the_pointed_curve_is_a_line_on_top() {
    let mut curves = three_curves();
    curves.extend((0..300u32).map(|k| {
        lag(
            u64::from(k) + 10,
            -3.0 - 0.01 * f64::from(k),
            1.0,
            Role::Perturbed,
        )
    }));
    let mut harness = harness(curves);
    // Only the corrected curve is drawn with long lines, in both panes; the dashes and dots of the
    // nominal model are short.
    assert_eq!(long_lines(&harness), 2);
    let at = point_on(&harness, 1, 60);
    harness.hover_at(at);
    harness.run();
    assert_eq!(harness.state().view.hovered.as_ref(), Some(&numbered(2)));
    assert_eq!(long_lines(&harness), 4, "and the pointed curve");
    click(&mut harness, at);
    assert_eq!(clicks(&harness), [BodeEvent::Clicked(numbered(2))]);
    harness.event(wheel(vec2(0.0, 40.0)));
    harness.step();
    assert!(
        long_lines(&harness) > 300,
        "moving curves are drawn as lines"
    );
    // The zoom is animated.
    harness.run_steps(20);
    assert!(long_lines(&harness) < 5);
}
