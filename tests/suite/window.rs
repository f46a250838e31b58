//! The window, driven by accessible labels: no display, no GPU.

use std::path::Path;
use std::process::Command;
use std::time::{Duration, Instant};

use egui::accesskit::Role;
use egui::{Event, Key, Modifiers, PointerButton, Pos2, pos2, vec2};
use egui_kittest::Harness;
use egui_kittest::kittest::{NodeT, Queryable};

use gdcm::app::GdcmApp;
use gdcm::dataset::{BundleKind, ModelId, Pair};
use gdcm::io::{Opened, embedded_example, open_study, read_corrections};
use gdcm::view::explanation::{gain_conflict_marks, remarks, toggle_costs};
use gdcm::view::net_gain_scene::channel_panels;
use gdcm::view::plot::{BodeCurve, Pane, Role as CurveRole};
use gdcm::view::state::{NoticeKind, State};

type Window = Harness<'static, GdcmApp>;

const CONDITION_10: &str = "Condition 10: 60 kt, low altitude, high weight";

/// The window on the example, its first results there.
fn window() -> Window {
    let build = |creation: &mut eframe::CreationContext<'static>| {
        let example = embedded_example().expect("the embedded example is a dataset");
        GdcmApp::new(&creation.egui_ctx, Opened::Dataset(example)).expect("a thread can be started")
    };
    let mut window = Harness::builder().with_size(vec2(1600.0, 1000.0)).build_eframe(build);
    settle(&mut window);
    window
}

/// Draws frames until nothing is being computed or read, and the curves of the condition shown are there.
fn settle(window: &mut Window) {
    // Far above what the slowest machine needs: only a hang gets here.
    let limit = Instant::now() + Duration::from_secs(120);
    loop {
        window.run_steps(2);
        let state = window.state().state();
        let curves = state.results.curves.as_ref().is_some_and(|(condition, _)| *condition == state.display.condition);
        if !state.results.is_waiting() && curves && state.opening.is_none() && !state.display.drawn.is_empty() {
            break;
        }
        assert!(Instant::now() < limit, "the results never came");
        std::thread::sleep(Duration::from_millis(5));
    }
    window.run_steps(2);
}

fn click(window: &mut Window, label: &str) {
    window.get_by_label(label).click();
    settle(window);
}

fn state(window: &Window) -> &State {
    window.state().state()
}

fn pair(window: &Window, output: &str, input: &str) -> Pair {
    state(window).dataset().find_pair(output, input).expect("the example has this response")
}

fn net_gain(window: &Window, output: &str, input: &str) -> f64 {
    let pair = pair(window, output, input);
    state(window).shown().expect("the condition has a result").correction.net_gain(pair).value()
}

fn drawn(window: &Window, role: CurveRole) -> BodeCurve {
    let mut curves = state(window).display.drawn.iter();
    curves.find(|curve| curve.role == role).expect("a curve of this role is drawn").clone()
}

fn choose_condition_10(window: &mut Window) {
    click(window, CONDITION_10);
    click(window, "Response LON → Q");
}

#[test]
fn from_the_example_to_exported_corrections() {
    let mut window = window();
    choose_condition_10(&mut window);
    assert_eq!(drawn(&window, CurveRole::Nominal).label, "nominal");
    let corrected_before = drawn(&window, CurveRole::Corrected);

    click(&mut window, "Reject 3 suggested");
    let representative = &state(&window).shown().unwrap().comparison.physics;
    assert_eq!(state(&window).condition().bundle(BundleKind::Physics)[representative.model].name, "ROLL-5deg");
    assert!(drawn(&window, CurveRole::Nominal).rejected, "the nominal model is one of the outliers");
    let corrected = drawn(&window, CurveRole::Corrected);
    assert_ne!(
        corrected.magnitude_db, corrected_before.magnitude_db,
        "another representative, another corrected curve"
    );

    let on_axis = pair(&window, "Q", "LON");
    let wanted = state(&window).shown().unwrap().comparison.delta.gain[on_axis].unwrap();
    // Held exactly: only the rounding of a product of two gains.
    assert!((net_gain(&window, "Q", "LON") / wanted - 1.0).abs() < 1e-9);
    click(&mut window, "Hold LON → Q");
    assert!(!state(&window).study.settings.constrained[on_axis]);
    assert!((net_gain(&window, "Q", "LON") / wanted - 1.0).abs() > 1e-4, "free, it goes where the others pull it");

    // LAT → P is held and stays; LON → Q is free: hold it again, free PED → R, and let alpha move that one's dots.
    click(&mut window, "Hold LON → Q");
    let (before, _) = channel_panels(state(&window));
    window.get_by_role_and_label(Role::Slider, "α gains slider").set_value_accesskit(12.5);
    settle(&mut window);
    assert_eq!(state(&window).study.settings.alpha_gain, 12.5);
    let (moved, _) = channel_panels(state(&window));
    assert!((before[0].dots[0].gain - moved[0].dots[0].gain).abs() > 1e-4, "the dots of the channel gains moved");

    let folder = tempfile::tempdir().unwrap();
    export_to(&mut window, folder.path());
    let written = read_corrections(&folder.path().join("corrections.json")).unwrap();
    assert_eq!(written.conditions.len(), 11);
    assert_eq!(written.settings.alpha_gain, 12.5);
    let tenth = &written.conditions[9];
    assert_eq!((tenth.id, tenth.physics_representative.as_str()), (10, "ROLL-5deg"));
    let shown = state(&window).shown().unwrap();
    assert_eq!(
        tenth.gains.outputs.get("Q").copied(),
        Some(shown.correction.output_gains[1]),
        "read back to the last digit"
    );
    assert!(folder.path().join("corrections.csv").exists() && folder.path().join("assessment.csv").exists());
}

fn fill(window: &mut Window, field: &str, path: &Path) {
    window.get_by_label(field).focus();
    window.run_steps(2);
    window.get_by_label(field).type_text(path.to_str().unwrap());
    window.run_steps(2);
}

fn export_to(window: &mut Window, folder: &Path) {
    click(window, "Export corrections…");
    fill(window, "Export folder", folder);
    click(window, "Export");
    let notice = state(window).notice.clone().expect("the export is reported");
    assert_eq!(notice.kind, NoticeKind::Done, "{}", notice.text);
}

#[test]
fn freeing_an_on_axis_entry_moves_its_net_gain_dots_with_alpha() {
    let mut window = window();
    let gain = |window: &Window| net_gain(window, "NY", "PED");
    click(&mut window, "Hold PED → NY");
    let before = gain(&window);
    window.get_by_role_and_label(Role::Slider, "α gains slider").set_value_accesskit(100.0);
    settle(&mut window);
    assert!((gain(&window) - before).abs() > 1e-4, "{before} stayed");
}

#[test]
fn a_long_computation_can_be_stopped_and_taken_up_again() {
    let mut window = window();
    let before = state(&window).results.received;
    // The most points there can be: far more work than the frames until the click give it time for.
    window.get_by_role_and_label(Role::SpinButton, "Frequencies in the band").set_value_accesskit(5000.0);
    window.run_steps(3);
    window.get_by_label("Stop").click();
    window.run_steps(3);
    assert!(state(&window).results.stopped && state(&window).results.received == before);
    window.get_by_label("● stopped: the results are older than the settings");
    assert!(state(&window).analysis().is_some(), "the results there were are still shown");
    click(&mut window, "Compute");
    assert!(!state(&window).results.is_behind());
    assert_eq!(state(&window).analysis().map(|analysis| analysis.omega.len()), Some(5000));
}

#[test]
fn every_choice_can_be_undone_and_done_again() {
    let mut window = window();
    choose_condition_10(&mut window);
    let start = state(&window).study.clone();
    click(&mut window, "Reject 3 suggested");
    click(&mut window, "Hold PED → R");
    window.get_by_role_and_label(Role::Slider, "α delays slider").set_value_accesskit(3.0);
    settle(&mut window);
    let end = state(&window).study.clone();
    for _ in 0..3 {
        window.key_press_modifiers(Modifiers::COMMAND, Key::Z);
        settle(&mut window);
    }
    assert_eq!(state(&window).study, start);
    assert_eq!(state(&window).history.undo_label(), None);
    for _ in 0..3 {
        window.key_press_modifiers(Modifiers::COMMAND | Modifiers::SHIFT, Key::Z);
        settle(&mut window);
    }
    assert_eq!(state(&window).study, end);
}

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
    let id = ModelId { condition: 9, bundle: BundleKind::Physics, model: 0 };
    for rejected in [true, false] {
        window.hover_at(place);
        window.run_steps(2);
        assert_eq!(state(&window).display.hovered, Some(id), "hovering points at the model");
        window.drag_at(place);
        window.run_steps(1);
        window.drop_at(place);
        settle(&mut window);
        assert_eq!(state(&window).study.is_rejected(id), rejected);
        // A second click soon after would be a double click, which fits the plot.
        window.run_steps(4);
    }
}

#[test]
fn a_double_click_on_a_curve_fits_the_plot_and_leaves_no_decision() {
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

#[test]
fn a_click_on_a_net_gain_dot_goes_to_its_condition() {
    let mut window = window();
    let place = state(&window).display.net_gain.screen_position(0, 2).expect("condition 3 has a dot");
    window.hover_at(place);
    window.run_steps(2);
    window.drag_at(place);
    window.run_steps(1);
    window.drop_at(place);
    settle(&mut window);
    assert_eq!(state(&window).condition().id(), 3);
}

#[test]
fn at_least_one_model_stays_in_each_bundle() {
    let mut window = window();
    let models: Vec<String> =
        state(&window).condition().bundle(BundleKind::Identified).iter().map(|model| model.name.clone()).collect();
    for model in &models {
        click(&mut window, &format!("Keep identified model {model}"));
    }
    let notice = state(&window).notice.clone().expect("the refusal is shown");
    assert_eq!(notice.kind, NoticeKind::Trouble);
    assert!(notice.text.contains("at least one must stay"), "{}", notice.text);
    assert_eq!(state(&window).study.choices[0].identified.rejected.len(), models.len() - 1);
}

#[test]
fn a_pinned_model_represents_its_bundle() {
    let mut window = window();
    click(&mut window, "Pin physics model V+10kt");
    let representative = state(&window).shown().unwrap().comparison.physics.model;
    assert_eq!(state(&window).condition().bundle(BundleKind::Physics)[representative].name, "V+10kt");
    click(&mut window, "Pin physics model V+10kt");
    assert_eq!(state(&window).shown().unwrap().comparison.physics.model, 0, "the medoid again");
}

#[test]
fn a_file_that_cannot_be_read_leaves_what_is_open_and_says_what_is_wrong() {
    let mut window = window();
    choose_condition_10(&mut window);
    click(&mut window, "Reject 3 suggested");
    // Nothing that is not saved is lost without a question.
    let before = state(&window).study.clone();
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("broken.json");
    std::fs::write(&path, "{\"format\": \"gdcm-dataset\", ").unwrap();
    open_by_path(&mut window, &path);
    click(&mut window, "Lose them");
    let notice = state(&window).notice.clone().expect("the trouble is shown");
    assert_eq!(notice.kind, NoticeKind::Trouble);
    assert!(notice.text.contains("broken.json"), "{}", notice.text);
    assert_eq!(state(&window).study, before);
}

fn open_by_path(window: &mut Window, path: &Path) {
    window.key_press_modifiers(Modifiers::COMMAND | Modifiers::SHIFT, Key::O);
    window.run_steps(2);
    fill(window, "Path to open", path);
    click(window, "Open file");
}

#[derive(Debug)]
struct Dropped(std::path::PathBuf);

impl egui::DroppedFile for Dropped {
    fn path(&self) -> &Path {
        &self.0
    }

    fn bytes(&self) -> Result<Vec<u8>, String> {
        std::fs::read(&self.0).map_err(|error| error.to_string())
    }
}

#[test]
fn a_dataset_dropped_on_the_window_is_opened() {
    let mut window = window();
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/data/small-dataset.json");
    window.input_mut().dropped_files.push(std::sync::Arc::new(Dropped(path)));
    window.run_steps(1);
    settle(&mut window);
    assert_eq!(state(&window).dataset().conditions().len(), 2);
    assert_eq!(state(&window).notice.as_ref().map(|notice| notice.kind), Some(NoticeKind::Done));
}

#[test]
fn a_study_is_saved_and_opens_with_the_same_result() {
    let mut window = window();
    choose_condition_10(&mut window);
    click(&mut window, "Reject 3 suggested");
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("mine.gdcm-study.json");
    window.state_mut().save_study_as(path.clone());
    settle(&mut window);
    assert!(!state(&window).unsaved);
    let (study, _) = open_study(&path).unwrap();
    assert_eq!(study.choices, state(&window).study.choices);
    let gain = net_gain(&window, "Q", "LON");
    window.key_press_modifiers(Modifiers::COMMAND, Key::Z);
    settle(&mut window);
    assert!(state(&window).unsaved);
    open_by_path(&mut window, &path);
    click(&mut window, "Lose them");
    click(&mut window, CONDITION_10);
    assert_eq!(net_gain(&window, "Q", "LON"), gain, "to the last digit");
}

#[test]
fn the_badge_says_proven_and_every_cell_says_what_holding_or_freeing_it_costs() {
    let mut window = window();
    window.get_by_label("proven");
    wait_for_toggles(&mut window);
    for (output, input, word) in [("Q", "LON", "holding LON → Q costs"), ("Q", "PED", "holding PED → Q would")] {
        let costs = toggle_costs(state(&window), pair(&window, output, input));
        assert!(costs.iter().any(|cost| cost.contains(word)), "{costs:?}");
    }
}

fn wait_for_toggles(window: &mut Window) {
    let limit = Instant::now() + Duration::from_secs(120);
    while state(window).results.toggles.is_none() {
        window.run_steps(1);
        assert!(Instant::now() < limit, "the costs never came");
        std::thread::sleep(Duration::from_millis(5));
    }
}

#[test]
fn held_gains_out_of_reach_are_explained_and_the_explanation_is_exported() {
    let mut window = window();
    window.get_by_label("Upper gain bound").set_value_accesskit(1.0);
    settle(&mut window);
    window.get_by_label("not matched");
    let shown = state(&window).shown().unwrap();
    let texts: Vec<String> = remarks(state(&window), shown).into_iter().map(|remark| remark.text).collect();
    assert!(texts.iter().any(|text| text.contains("LON → Q cannot be held")), "{texts:?}");
    let (marked, _) = gain_conflict_marks(shown);
    assert!(marked.contains(&pair(&window, "Q", "LON")));

    let folder = tempfile::tempdir().unwrap();
    export_to(&mut window, folder.path());
    let written = read_corrections(&folder.path().join("corrections.json")).unwrap();
    let solution = &written.conditions[0].gain_solution;
    assert!(!solution.matched && solution.proven);
    let conflict = solution.explanation.conflicts.iter().find(|c| c.entries == [("Q".to_owned(), "LON".to_owned())]);
    let upper = conflict.and_then(|conflict| conflict.upper).expect("the bound that would do is written");
    // k_Q k_LON = 1.15 needs a bound of at least its square root, 1.0723, rounded up to three digits.
    assert_eq!(upper, 1.08);
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

#[test]
fn control_and_r_reject_the_suggested_outliers() {
    let mut window = window();
    choose_condition_10(&mut window);
    let suggested = state(&window).shown().unwrap().suggested();
    assert_eq!(suggested.len(), 3);
    window.key_press_modifiers(Modifiers::COMMAND, Key::R);
    settle(&mut window);
    let rejected = &state(&window).study.choices[9].physics.rejected;
    assert_eq!(rejected.iter().copied().collect::<Vec<_>>(), suggested);
}

#[test]
fn a_dataset_opened_again_is_analysed_again() {
    let mut window = window();
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/data/small-dataset.json");
    for _ in 0..2 {
        open_by_path(&mut window, &path);
        assert!(state(&window).analysis().is_some());
    }
}

#[test]
fn every_control_has_a_label_of_its_own() {
    let window = window();
    let mut labels: Vec<(Role, String)> = Vec::new();
    let controls = [Role::Button, Role::CheckBox, Role::Slider, Role::SpinButton, Role::ComboBox, Role::TextInput];
    for node in window.root().children_recursive() {
        let role = node.accesskit_node().role();
        if controls.contains(&role) {
            let label = node.accesskit_node().label().unwrap_or_default();
            assert!(!label.is_empty(), "a control without a label: {role:?}");
            labels.push((role, label));
        }
    }
    assert!(labels.len() > 80, "the controls were found: {}", labels.len());
    labels.sort_by(|a, b| a.1.cmp(&b.1));
    let twice: Vec<_> = labels.windows(2).filter(|pair| pair[0] == pair[1]).map(|pair| &pair[0]).collect();
    assert!(twice.is_empty(), "{twice:?}");
}

#[test]
#[cfg(target_os = "linux")]
fn without_a_display_one_line_names_the_headless_command() {
    let output = Command::new(env!("CARGO_BIN_EXE_gdcm"))
        .env_remove("DISPLAY")
        .env_remove("WAYLAND_DISPLAY")
        .env_remove("WAYLAND_SOCKET")
        .output()
        .unwrap();
    let words = String::from_utf8_lossy(&output.stderr);
    assert_eq!(output.status.code(), Some(1));
    assert_eq!(words.trim_end().lines().count(), 1, "{words}");
    assert!(words.contains("no display") && words.contains("gdcm analyze"), "{words}");
}
