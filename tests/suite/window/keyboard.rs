//! Keyboard operation without a pointer.

use egui::{Color32, Shape};

use gdcm::gui::commands::layout::LayoutCommand;
use gdcm::gui::commands::selection::SelectionCommand;
use gdcm::gui::state::forms::FormKind;
use gdcm::gui::widgets::palette::Palette;
use gdcm_method::correction::GainBounds;

use super::views::give;
use super::*;

fn press(window: &mut Window, modifiers: Modifiers, key: Key) {
    window.key_press_modifiers(modifiers, key);
    window.run_steps(3);
}

/// Returns the label of the focused control; empty without focus.
fn focused(window: &Window) -> String {
    let found = window
        .root()
        .children_recursive()
        .find(|node| node.is_focused() && node.accesskit_node().label().is_some());
    found
        .and_then(|node| node.accesskit_node().label())
        .unwrap_or_default()
}

/// Focuses a number field, types a value and presses Enter.
fn enter(window: &mut Window, field: &str, text: &str) {
    window
        .get_by_role_and_label(Role::SpinButton, field)
        .focus();
    window.run_steps(2);
    window.event(Event::Text(text.to_owned()));
    press(window, Modifiers::NONE, Key::Enter);
    settle(window);
}

#[test]
fn the_space_bar_holds_and_frees_the_chosen_response() {
    let mut window = window();
    let target = pair(&window, "Q", "PED");
    click(&mut window, "Response PED → Q");
    for held in [true, false] {
        window.key_press(Key::Space);
        settle(&mut window);
        assert_eq!(state(&window).study.settings.constrained[target], held);
    }
}

#[test]
fn alt_and_an_arrow_go_through_the_views_of_the_group_and_leave_the_response() {
    fn view(window: &Window) -> gdcm::gui::state::view::View {
        state(window).display.layout.arrangement.view()
    }

    let mut window = window();
    let response = pair(&window, "Q", "PED");
    give(&mut window, SelectionCommand::FocusPair(response));
    let views: Vec<View> = state(&window)
        .display
        .layout
        .arrangement
        .group()
        .views()
        .collect();
    assert_eq!(view(&window), views[0]);
    for (key, expected) in [
        (Key::ArrowRight, views[1]),
        (Key::ArrowRight, views[2]),
        (Key::ArrowLeft, views[1]),
        (Key::ArrowLeft, views[0]),
        (Key::ArrowLeft, views[views.len() - 1]),
    ] {
        press(&mut window, Modifiers::ALT, key);
        assert_eq!(
            (view(&window), state(&window).display.selection.pair),
            (expected, response),
            "{key:?}"
        );
    }
    press(&mut window, Modifiers::NONE, Key::ArrowRight);
    assert_ne!(
        state(&window).display.selection.pair,
        response,
        "without Alt it is the next response"
    );
    assert_eq!(view(&window), views[views.len() - 1]);
}

#[test]
fn a_space_in_a_text_decides_nothing() {
    let mut window = window();
    let before = state(&window).study.clone();
    press(&mut window, Modifiers::COMMAND | Modifiers::SHIFT, Key::O);
    window.event(Event::Text(" ".to_owned()));
    press(&mut window, Modifiers::NONE, Key::Space);
    assert_eq!(
        state(&window).forms.typed[&FormKind::Open],
        " ",
        "it goes to the field"
    );
    press(&mut window, Modifiers::NONE, Key::Escape);
    // The space bar presses the focused list row.
    window.get_by_label_contains("Condition 3: ").focus();
    window.run_steps(2);
    window.key_press(Key::Space);
    settle(&mut window);
    assert_eq!(state(&window).condition().id(), ConditionId(3));
    assert_eq!(state(&window).study, before);
}

#[test]
fn f6_goes_through_the_parts_of_the_window_and_comes_back_to_where_the_focus_was() {
    let mut window = window();
    window.get_by_label_contains("Condition 2: ").click();
    settle(&mut window);
    let starts = [
        "Show nominal",
        "",
        "Use leads",
        "global optimum",
        "Response ",
        "Settings",
        "Export corrections…",
        "Condition 2: ",
        "Keep physics model nominal",
    ];
    for start in starts {
        press(&mut window, Modifiers::NONE, Key::F6);
        let label = focused(&window);
        assert!(label.starts_with(start), "{label} in the place of {start}");
    }
    press(&mut window, Modifiers::NONE, Key::Tab);
    assert_eq!(
        focused(&window),
        "Use physics model nominal as representative"
    );
    press(&mut window, Modifiers::NONE, Key::F6);
    assert_eq!(focused(&window), "Show nominal", "round the end");
    press(&mut window, Modifiers::SHIFT, Key::F6);
    assert_eq!(
        focused(&window),
        "Use physics model nominal as representative",
        "where it was"
    );
    press(&mut window, Modifiers::SHIFT, Key::F6);
    assert!(focused(&window).starts_with("Condition 2: "));
}

#[test]
fn what_the_keyboard_reaches_is_scrolled_into_view() {
    let mut window = Harness::builder()
        .with_size(vec2(900.0, 560.0))
        .build_eframe(cold_example);
    settle(&mut window);
    window.get_by_label("Response LON → P").focus();
    for _ in 0..40 {
        press(&mut window, Modifiers::NONE, Key::Tab);
    }
    window.run_steps(20);
    let label = focused(&window);
    assert!(label.contains("→ NZ") || label.contains("→ NY"), "{label}");
    let place = window.get_by_label(&label).rect();
    assert!(
        place.min.y > 0.0 && place.max.y < 560.0,
        "{label} at {place}"
    );
}

/// Returns the focus rings drawn in the last frame.
fn rings(window: &Window) -> Vec<egui::Rect> {
    fn is_ring(color: Color32, width: f32) -> bool {
        width == 2.0 && color == Palette::dark().accent
    }

    let shapes = window.output().shapes.iter();
    shapes
        .filter_map(|clipped| match &clipped.shape {
            Shape::Rect(shape) if is_ring(shape.stroke.color, shape.stroke.width) => {
                Some(shape.rect)
            }
            _ => None,
        })
        .collect()
}

#[test]
fn a_ring_surrounds_whatever_has_the_focus() {
    let mut window = window();
    // The matrix also draws a ring around the response in focus.
    let at_rest = rings(&window).len();
    for label in [CONDITION_10, "Keep physics model V+10kt", "Hold PED → R"] {
        window.get_by_label(label).focus();
        window.run_steps(3);
        let rings = rings(&window);
        assert_eq!(rings.len(), at_rest + 1, "{label}");
        let place = window.get_by_label(label).rect();
        assert!(
            rings
                .iter()
                .any(|ring| ring.expand(0.5).contains_rect(place)
                    && place.expand(6.0).contains_rect(*ring))
        );
    }
    press(&mut window, Modifiers::COMMAND | Modifiers::SHIFT, Key::O);
    let place = window.get_by_label("Path to open").rect();
    assert!(
        rings(&window)
            .iter()
            .any(|ring| ring.expand(0.5).contains_rect(place)),
        "in a form too"
    );
}

#[test]
fn a_number_out_of_order_or_out_of_range_is_refused_with_a_word_and_the_old_one_stays() {
    let mut window = window();
    let before = state(&window).study.clone();
    unfold_settings(&mut window, true);
    let cases = [
        (
            "Band from",
            "30",
            "out-of-range",
            &["0.0001", "12 rad/s", "30", "0.50 rad/s"][..],
        ),
        ("Band from", "12", "wrong-band", &["12"]),
        (
            "Band to",
            "0,1",
            "out-of-range",
            &["0.5", "100000 rad/s", "0.1"],
        ),
        ("Lower gain bound", "5", "out-of-range", &["5"]),
        ("Upper gain bound", "0.1", "out-of-range", &["0.1"]),
        (
            "Upper delay bound",
            "-1",
            "out-of-range",
            &["0", "1000000 ms", "-1"],
        ),
        ("α gains", "-1", "out-of-range", &["0", "1000000", "-1"]),
        (
            "Frequencies in the band",
            "1",
            "out-of-range",
            &["2", "5000", "1"],
        ),
        (
            "Frequencies in the band",
            "20.5",
            "not-a-whole-number",
            &["20.5"],
        ),
        ("Bound quantile", "60", "out-of-range", &["0", "50 %", "60"]),
        (
            "Airspeed tolerance",
            "-1",
            "out-of-range",
            &["0", "100 kt", "-1"],
        ),
        ("Band from", "low", "not-a-number", &["\"low\""]),
    ];
    for (field, text, code, names) in cases {
        enter(&mut window, field, text);
        assert_notice(&window, NoticeKind::Trouble, code, names);
        assert_eq!(state(&window).study, before, "{field} {text}");
        assert_eq!(last_change(&window), None, "{field} {text}");
    }
}

#[test]
fn a_digit_switches_a_chip_while_a_plot_has_the_focus() {
    let mut window = window();
    let hidden = |window: &Window| state(window).display.curves.hidden_roles.clone();
    let usual = hidden(&window);
    press(&mut window, Modifiers::NONE, Key::Num1);
    assert_eq!(hidden(&window), usual, "nothing has the focus");
    window.get_by_label_contains("Magnitude of LAT → P").focus();
    window.run_steps(2);
    press(&mut window, Modifiers::NONE, Key::Num1);
    assert_eq!(
        hidden(&window).difference(&usual).collect::<Vec<_>>(),
        [&CurveRole::Nominal]
    );
    press(&mut window, Modifiers::NONE, Key::Num1);
    assert_eq!(hidden(&window), usual);
}

#[test]
fn a_number_typed_in_its_unit_is_taken_once_it_is_complete() {
    let mut window = window();
    unfold_settings(&mut window, true);
    window
        .get_by_role_and_label(Role::SpinButton, "Band to")
        .focus();
    window.run_steps(2);
    for text in ["3", "0"] {
        window.event(Event::Text(text.to_owned()));
        window.run_steps(2);
        assert_eq!(
            state(&window).study.settings.band.max(),
            12.0,
            "not while it is typed"
        );
    }
    press(&mut window, Modifiers::NONE, Key::Enter);
    assert_eq!(state(&window).study.settings.band.max(), 30.0);
    enter(&mut window, "Upper delay bound", "80 ms");
    assert_eq!(state(&window).study.settings.delay_upper_s, Some(0.08));
    window
        .get_by_role_and_label(Role::SpinButton, "Band to")
        .focus();
    window.run_steps(2);
    window.event(Event::Text("4".to_owned()));
    press(&mut window, Modifiers::NONE, Key::Escape);
    window.run_steps(4);
    assert_eq!(
        state(&window).study.settings.band.max(),
        30.0,
        "Escape leaves the old one"
    );
}

#[test]
fn what_is_typed_in_one_frame_goes_to_the_fields_meant() {
    fn text(text: &str) -> egui::Event {
        Event::Text(text.to_owned())
    }

    fn bounds() -> Option<gdcm_method::correction::Bounds> {
        Some(GainBounds {
            lower: 0.7,
            upper: 1.4,
        })
    }

    let mut window = window();
    unfold_settings(&mut window, true);
    window
        .get_by_role_and_label(Role::SpinButton, "Lower gain bound")
        .focus();
    window.run_steps(2);
    let key = |key, modifiers| Event::Key {
        key,
        physical_key: None,
        pressed: true,
        repeat: false,
        modifiers,
    };
    let tab = || key(Key::Tab, Modifiers::NONE);
    window.input_mut().events.extend([
        text("0"),
        text(".7"),
        tab(),
        text("1.4"),
        tab(),
        key(Key::Tab, Modifiers::SHIFT),
    ]);
    window.step();
    window.run_steps(12);
    assert_eq!(focused(&window), "Upper gain bound", "back with Shift");
    assert_eq!(state(&window).study.settings.gain_bounds, bounds());
    let back = key(Key::Tab, Modifiers::SHIFT);
    window.input_mut().events.extend([
        text("1.5"),
        back,
        text("0.6"),
        key(Key::Enter, Modifiers::NONE),
    ]);
    window.step();
    window.run_steps(12);
    assert_eq!(
        state(&window).study.settings.gain_bounds,
        Some(GainBounds {
            lower: 0.6,
            upper: 1.5
        })
    );
}

#[test]
fn going_through_every_field_with_tab_decides_nothing() {
    let mut window = window();
    let before = state(&window).study.clone();
    unfold_settings(&mut window, true);
    window
        .get_by_role_and_label(Role::Slider, "α gains slider")
        .focus();
    window.run_steps(2);
    for _ in 0..20 {
        press(&mut window, Modifiers::NONE, Key::Tab);
    }
    settle(&mut window);
    assert_eq!(state(&window).study, before);
    assert!(!state(&window).unsaved);
}

#[test]
fn the_keys_of_the_palette_begin_a_new_search_and_find_what_the_verdict_offers() {
    use gdcm::gui::commands::command_table::every_command;
    use gdcm_study::PhaseCorrection;

    let mut window = window();
    let commands = every_command(state(&window));
    let enabled = |name: &str| {
        let mut found = commands.iter().filter(|entry| entry.name == name);
        found.next().map(|entry| entry.enabled)
    };
    assert_eq!(enabled("Use leads"), Some(true));
    assert_eq!(
        enabled("Copy the values of Leads"),
        Some(false),
        "there are none"
    );
    window.key_press_modifiers(Modifiers::COMMAND, Key::K);
    window.run_steps(3);
    window.event(Event::Text("undo".to_owned()));
    window.run_steps(2);
    assert_eq!(state(&window).forms.palette.query, "undo");
    window.key_press_modifiers(Modifiers::COMMAND, Key::K);
    window.run_steps(3);
    assert_eq!(state(&window).forms.palette.query, "");
    window.event(Event::Text("use leads".to_owned()));
    window.run_steps(2);
    window.key_press(Key::Enter);
    settle(&mut window);
    let settings = &state(&window).study.settings;
    assert_eq!(settings.phase, PhaseCorrection::Lead);
}

#[test]
fn a_variant_is_kept_with_the_keyboard_alone() {
    let mut window = window();
    give(&mut window, LayoutCommand::NameVariant);
    window.run_steps(4);
    window.event(Event::Text("first try".to_owned()));
    window.run_steps(2);
    window.key_press(Key::Enter);
    settle(&mut window);
    let names: Vec<&str> = state(&window)
        .study
        .variants
        .iter()
        .map(|variant| variant.name.as_str())
        .collect();
    assert_eq!(names, ["first try"]);
}
