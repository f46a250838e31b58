use egui::vec2;

use super::*;
use crate::view::palette::{self, Palette};

struct Model {
    curves: Vec<BodeCurve>,
    band: (f64, f64),
    view: BodeView,
    events: Vec<BodeEvent>,
}

fn harness(curves: Vec<BodeCurve>) -> Harness<'static, Model> {
    let model = Model { curves, band: (0.5, 12.0), view: BodeView::default(), events: Vec::new() };
    let mut harness = Harness::builder()
        .with_step_dt(0.02)
        .with_size(vec2(900.0, 600.0))
        .with_context_setup(palette::apply)
        .build_ui_state(
            |ui, model: &mut Model| {
                let scene = BodeScene {
                    pair_title: "LON → Q",
                    curves: &model.curves,
                    band: model.band,
                    unit: FrequencyUnit::RadPerSecond,
                    stale: false,
                    message: None,
                };
                let palette = Palette::of(ui.visuals());
                for event in bode_ui(ui, &scene, &mut model.view, &palette) {
                    if let BodeEvent::BandDragged { min, max } = event {
                        model.band = (min, max);
                    }
                    model.events.push(event);
                }
            },
            model,
        );
    harness.run();
    harness
}

fn three_curves() -> Vec<BodeCurve> {
    vec![lag(1, 0.0, 1.0, Role::Nominal), lag(2, 3.0, 1.0, Role::Perturbed), lag(3, 20.0, 3.0, Role::Corrected)]
}

/// A point on the magnitude of curve `index` at the frequency of sample `k`.
fn point_on(harness: &Harness<'_, Model>, index: usize, k: usize) -> Pos2 {
    let curve = &harness.state().curves[index];
    harness.state().view.screen_position(Pane::Magnitude, curve.omega[k], curve.magnitude_db[k]).unwrap()
}

/// A place in the magnitude plot that is far from every curve.
fn empty_spot(harness: &Harness<'_, Model>) -> Pos2 {
    point_on(harness, 2, 60) + vec2(0.0, 40.0)
}

fn clicks(harness: &Harness<'_, Model>) -> Vec<BodeEvent> {
    let is_click =
        |event: &&BodeEvent| matches!(event, BodeEvent::Clicked(_) | BodeEvent::TakenBack(_) | BodeEvent::Isolated(_));
    harness.state().events.iter().filter(is_click).cloned().collect()
}

#[test]
fn a_click_names_the_nearest_curve() {
    let mut harness = harness(three_curves());
    for (index, id) in [(0, 1), (1, 2), (2, 3)] {
        let at = point_on(&harness, index, 60) + vec2(0.0, 2.0);
        // Clicks in one place within the time of a double click would be one.
        harness.run_steps(30);
        click(&mut harness, at);
        assert_eq!(clicks(&harness).last(), Some(&BodeEvent::Clicked(numbered(id))));
    }
}

#[test]
fn a_click_away_from_all_curves_means_none() {
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
fn hovering_is_told_once_when_it_begins_and_once_when_it_ends() {
    let mut harness = harness(three_curves());
    let at = point_on(&harness, 0, 60);
    harness.hover_at(at);
    harness.run();
    let away = empty_spot(&harness);
    harness.hover_at(away);
    harness.run();
    let expected = [BodeEvent::Hovered(Some(numbered(1))), BodeEvent::Hovered(None)];
    assert_eq!(harness.state().events, expected);
}

#[test]
fn dragging_an_end_of_the_band_moves_it_and_not_the_plot() {
    let mut harness = harness(three_curves());
    let before = harness.state().view.omega_range();
    let at =
        |harness: &Harness<'_, Model>, omega| harness.state().view.screen_position(Pane::Phase, omega, -45.0).unwrap();
    let path = [at(&harness, 0.5), at(&harness, 0.8), at(&harness, 1.0)];
    drag(&mut harness, &path, PointerButton::Primary);
    let model = harness.state();
    assert!((model.band.0 - 1.0).abs() < 1e-3 && model.band.1 == 12.0, "{:?}", model.band);
    assert_eq!(model.events.iter().filter(|event| **event == BodeEvent::BandReleased).count(), 1);
    assert_eq!(model.view.omega_range(), before);
}

#[test]
fn panning_one_plot_pans_the_frequencies_of_both() {
    let mut harness = harness(three_curves());
    let (before, _) = harness.state().view.omega_range();
    let from = empty_spot(&harness);
    drag(&mut harness, &[from, from + vec2(50.0, 0.0), from + vec2(100.0, 0.0)], PointerButton::Primary);
    let view = &harness.state().view;
    assert!(view.omega_range().0 < 0.9 * before);
    let left = |transform: Option<&egui_plot::PlotTransform>| transform.map(|transform| transform.bounds().min()[0]);
    assert_eq!(left(view.magnitude_transform()), left(view.phase_transform()));
}

#[test]
fn a_box_drawn_with_the_secondary_button_is_zoomed_into() {
    let mut harness = harness(three_curves());
    let at = |harness: &Harness<'_, Model>, omega, db| {
        harness.state().view.screen_position(Pane::Magnitude, omega, db).unwrap()
    };
    let path = [at(&harness, 1.0, 5.0), at(&harness, 2.0, 0.0), at(&harness, 3.0, -5.0)];
    drag(&mut harness, &path, PointerButton::Secondary);
    let view = &harness.state().view;
    let (min, max) = view.omega_range();
    assert!((min - 1.0).abs() < 0.02 && (max - 3.0).abs() < 0.05, "{min} {max}");
    assert!((view.value_range(Pane::Magnitude).max - 5.0).abs() < 0.2);
    assert_eq!(clicks(&harness), []);
}

#[test]
fn the_wheel_zooms_about_the_pointer() {
    let mut harness = harness(three_curves());
    let at = point_on(&harness, 1, 60);
    harness.hover_at(at);
    harness.step();
    let wheel = Event::MouseWheel {
        unit: egui::MouseWheelUnit::Point,
        delta: vec2(0.0, 120.0),
        phase: egui::TouchPhase::Move,
        modifiers: Modifiers::NONE,
        source: egui::MouseWheelSource::Wheel,
    };
    let before = harness.state().view.omega_range();
    harness.event(wheel);
    // Scrolling is smooth: it takes some frames.
    harness.run_steps(12);
    let after = harness.state().view.omega_range();
    assert!(after.0 > before.0 && after.1 < before.1, "{before:?} {after:?}");
    assert!(point_on(&harness, 1, 60).distance(at) < 0.1);
}

#[test]
fn new_data_keep_the_zoom_and_a_double_click_fits_them() {
    let mut harness = harness(three_curves());
    let fitted = harness.state().view.omega_range();
    let from = empty_spot(&harness);
    drag(&mut harness, &[from, from + vec2(80.0, 30.0)], PointerButton::Primary);
    let panned = harness.state().view.omega_range();
    assert_ne!(panned, fitted);
    harness.state_mut().curves.push(lag(4, -30.0, 1.0, Role::Perturbed));
    harness.run();
    assert_eq!(harness.state().view.omega_range(), panned);
    let empty = empty_spot(&harness);
    click(&mut harness, empty);
    click(&mut harness, empty);
    harness.run();
    let view = &harness.state().view;
    assert_eq!(view.omega_range(), fitted);
    assert!(view.value_range(Pane::Magnitude).min < -56.0, "the new curve is in view");
}

#[test]
fn a_double_click_on_a_curve_fits_and_takes_its_first_click_back() {
    let mut harness = harness(three_curves());
    let fitted = harness.state().view.omega_range();
    let from = empty_spot(&harness);
    drag(&mut harness, &[from, from + vec2(40.0, 0.0)], PointerButton::Primary);
    let at = point_on(&harness, 1, 60);
    click(&mut harness, at);
    click(&mut harness, at);
    assert_eq!(clicks(&harness), [BodeEvent::Clicked(numbered(2)), BodeEvent::TakenBack(numbered(2))]);
    assert_eq!(harness.state().view.omega_range(), fitted);
}

#[test]
fn values_that_are_not_finite_leave_gaps_and_nothing_panics() {
    let mut curves = three_curves();
    curves[0].magnitude_db =
        curves[0].magnitude_db.iter().enumerate().map(|(k, db)| if k % 7 == 0 { f64::NAN } else { *db }).collect();
    curves[1].magnitude_db = vec![f64::NEG_INFINITY; 120].into();
    curves[2].phase_deg = vec![f64::NAN; 120].into();
    curves.push(BodeCurve { omega: vec![0.0, -1.0].into(), ..lag(4, 0.0, 1.0, Role::Identified) });
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
    for size in [vec2(40.0, 40.0), vec2(150.0, 140.0), vec2(320.0, 200.0), vec2(2000.0, 150.0), vec2(160.0, 1200.0)] {
        harness.set_size(size);
        harness.run();
    }
}

#[test]
fn the_legend_folds_at_a_click_without_rejecting_a_curve() {
    use egui_kittest::kittest::Queryable;
    let mut harness = harness(three_curves());
    let legend = harness.get_by_label("Legend: nominal, perturbed, corrected").rect();
    click(&mut harness, legend.center());
    let folded = harness.get_by_label("Legend: nominal, perturbed, corrected").rect();
    assert!(folded.height() < 0.6 * legend.height());
    assert_eq!(harness.state().events, []);
}
