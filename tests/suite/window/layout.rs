//! Layout on small screens, in the rail, in menus and in forms.

use egui::{LayerId, Order};

use gdcm::gui::commands::layout::LayoutCommand;
use gdcm::gui::state::forms::FormKind;
use gdcm::gui::state::sheet::Sheet;

use super::views::{give, show};
use super::*;

/// Opens a window of this size \[pt\] with this number of pixels per point.
pub(super) fn window_of(size: egui::Vec2, pixels_per_point: f32) -> Window {
    let builder = Harness::builder()
        .with_size(size)
        .with_pixels_per_point(pixels_per_point);
    let mut window = builder.build_eframe(warm_example);
    settle(&mut window);
    window
}

pub(super) const SMALL: egui::Vec2 = vec2(1280.0, 720.0);

/// Returns a text in the first line of the evidence for physics parameters: the name of the selected
/// one, or that there is no diagnosis yet.
fn physics_evidence(window: &Window) -> String {
    if let Some(Some(Ok(assessment))) = state(window).physics()
        && let Some(findings) = &assessment.applied.findings
    {
        let selected = state(window).selected_parameter(findings);
        return findings.parameters[selected].name.clone();
    }
    "No diagnosis of physics parameters".to_owned()
}

/// Asserts that verdict, result, matrix, settings line and export are completely visible; in Physics,
/// the evidence instead of result and matrix.
fn assert_answered(window: &Window, view: View) {
    let screen = egui::Rect::from_min_size(Pos2::ZERO, SMALL);
    let is_whole = |label: &str, place: egui::Rect| {
        assert!(
            screen.contains_rect(place) && place.height() > 8.0,
            "{label} at {place} in {view:?}"
        );
    };
    let mut parts = vec!["Gain: ".to_owned(), "Phase: ".to_owned()];
    match view {
        // The fit and the identified responses take the place of result and matrix.
        View::Records => {}
        View::Physics => parts.push(physics_evidence(window)),
        _ => parts.push("global optimum".to_owned()),
    }
    for part in parts {
        let mut found = window
            .query_all_by_label_contains(&part)
            .map(|node| node.rect());
        assert!(
            found.any(|place| screen.contains_rect(place)),
            "{part} in {view:?}"
        );
    }
    // In Physics, the evidence takes the place of result and matrix.
    if view != View::Physics {
        let (inputs, outputs) = state(window).dataset().input_and_output_names();
        for (output, input) in outputs
            .iter()
            .flat_map(|output| inputs.iter().map(move |input| (output, input)))
        {
            let label = format!("Response {input} → {output}");
            is_whole(&label, window.get_by_label(&label).rect());
        }
    }
    for label in ["Settings", "Export corrections…"] {
        is_whole(
            label,
            window.get_by_role_and_label(Role::Button, label).rect(),
        );
    }
}

#[test]
fn the_answer_is_on_a_small_screen_in_every_view() {
    // The second case is a screen of 1920 x 1080 pixels at 150 %.
    for pixels_per_point in [1.0, 1.5] {
        let mut window = window_of(SMALL, pixels_per_point);
        for view in View::ALL {
            give(&mut window, LayoutCommand::ShowView(view));
            window.run_steps(2);
            assert_answered(&window, view);
        }
    }
}

#[test]
fn a_low_window_has_one_output_over_time() {
    for (size, charts) in [(SMALL, 2), (vec2(1600.0, 1000.0), 4)] {
        let mut window = window_of(size, 1.0);
        click(&mut window, CONDITION_10);
        show(&mut window, View::Records);
        wait_until(&mut window, "the records", |window| {
            window
                .query_all_by_label_contains("] at the cursor: ")
                .next()
                .is_some()
        });
        let shown = window.query_all_by_label_contains("] at the cursor: ");
        assert_eq!(shown.count(), charts, "{size}");
    }
}

#[test]
fn a_click_on_a_cell_of_the_map_of_costs_goes_to_its_condition_and_response() {
    let mut window = window();
    click(&mut window, CONDITION_10);
    let cell = "PED → R in condition 3: magnitude J";
    window.get_by_label_contains(cell).click();
    settle(&mut window);
    assert_eq!(state(&window).condition().id(), ConditionId(3));
    assert_eq!(
        state(&window).display.selection.pair,
        pair(&window, "R", "PED")
    );
}

#[test]
fn a_narrow_window_has_a_rail_with_sheets_and_a_key_shows_the_panel() {
    let mut window = window_of(SMALL, 1.0);
    let keep = "Keep physics model nominal";
    assert!(
        window.query_by_label(keep).is_none(),
        "the list has no room"
    );
    click(&mut window, "Open the list: Models");
    assert_eq!(state(&window).display.layout.sheet, Some(Sheet::Models));
    window.get_by_label(keep);
    window.key_press(Key::Escape);
    window.run_steps(3);
    assert_eq!(
        state(&window).display.layout.sheet,
        None,
        "Escape closes it"
    );
    click(&mut window, "Open the list: Identified");
    assert!(
        window
            .query_all_by_label_contains("Keep identified model ")
            .next()
            .is_some()
    );
    // Click beside the sheet.
    window.drag_at(pos2(900.0, 300.0));
    window.run_steps(1);
    window.drop_at(pos2(900.0, 300.0));
    window.run_steps(3);
    assert_eq!(
        state(&window).display.layout.sheet,
        None,
        "and so does a click beside it"
    );
    for is_open in [true, false] {
        window.key_press_modifiers(Modifiers::COMMAND, Key::B);
        window.run_steps(3);
        assert_eq!(window.query_by_label(keep).is_some(), is_open);
        assert_eq!(
            window.query_by_label("Open the list: Models").is_none(),
            is_open
        );
    }
}

#[test]
fn the_menu_of_the_schedule_stands_in_the_order_of_its_settings() {
    let mut window = window();
    show(&mut window, View::NetGain);
    let button = window.get_by_label("Form of the schedule").rect();
    click(&mut window, "Form of the schedule");
    let labels = [
        "Schedule",
        "Scheduled quantity",
        "Second variable of the schedule",
    ];
    let places = labels.map(|label| window.get_by_role_and_label(Role::ComboBox, label).rect());
    assert!(
        places
            .windows(2)
            .all(|pair| pair[0].bottom() <= pair[1].top()),
        "{places:?}"
    );
    assert!(
        places[0].top() - button.bottom() < 40.0,
        "it begins at its button: {button} {places:?}"
    );
}

/// Returns the rectangle of a form.
fn form(window: &Window, kind: FormKind) -> egui::Rect {
    assert_eq!(state(window).forms.shown, Some(kind));
    let id = egui::Id::unique(("form", kind, false));
    let layer = LayerId::new(Order::Foreground, id);
    window
        .ctx
        .memory(|memory| memory.area_rect(layer.id))
        .expect("the form is drawn")
}

#[test]
fn the_palette_and_the_page_of_keys_keep_sizes_of_their_own() {
    fn press(window: &mut Window, modifiers: Modifiers, key: Key) {
        window.key_press_modifiers(modifiers, key);
        window.run_steps(4);
    }

    let mut window = window();
    press(&mut window, Modifiers::NONE, Key::F1);
    let keys = form(&window, FormKind::Shortcuts);
    press(&mut window, Modifiers::NONE, Key::Escape);
    press(&mut window, Modifiers::COMMAND, Key::K);
    let palette = form(&window, FormKind::Palette);
    assert!(
        palette.height() > 200.0 && keys.height() > 500.0,
        "{palette} {keys}"
    );
    window.event(Event::Text("zzz".to_owned()));
    window.run_steps(4);
    assert_eq!(
        form(&window, FormKind::Palette).size(),
        palette.size(),
        "with nothing found"
    );
    press(&mut window, Modifiers::NONE, Key::Escape);
    press(&mut window, Modifiers::NONE, Key::F1);
    assert_eq!(
        form(&window, FormKind::Shortcuts).size(),
        keys.size(),
        "after the palette"
    );
    press(&mut window, Modifiers::NONE, Key::Escape);
    press(&mut window, Modifiers::COMMAND, Key::K);
    assert_eq!(
        form(&window, FormKind::Palette).size(),
        palette.size(),
        "after the page of keys"
    );
}

#[test]
fn the_poles_have_a_legend_above_their_plots() {
    let mut window = window();
    choose_condition_10(&mut window);
    show(&mut window, View::Poles);
    wait_until(&mut window, "the modes", |window| {
        state(window).modes().is_some()
    });
    window.run_steps(2);
    let top = state(&window).display.figures[&View::Poles]
        .transform(0)
        .unwrap()
        .frame()
        .top();
    for name in [
        "nominal",
        "perturbed",
        "representative",
        "other identified",
        "identified",
    ] {
        let place = window
            .query_all_by_label(name)
            .map(|node| node.rect())
            .find(|place| place.bottom() <= top);
        assert!(place.is_some(), "{name} over the plots");
    }
}

#[test]
fn the_net_gains_are_not_cut_beside_the_settings_on_a_small_screen() {
    let mut window = window_of(SMALL, 1.0);
    give(&mut window, LayoutCommand::ShowSettings(true));
    window.run_steps(3);
    let edge = 1280.0 - 320.0;
    let figure = &state(&window).display.figures[&View::NetGain];
    for place in 0..5 {
        let frame = *figure.transform(place).expect("the plot is drawn").frame();
        assert!(frame.right() <= edge, "plot {place} at {frame}");
    }
}

#[test]
fn a_wide_error_bar_does_not_touch_the_delay_beside_it() {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/data/small-dataset.json");
    let opened = load_any(&path, &Default::default()).unwrap();
    let mut window = window_with(opened, Setup::default());
    wait_for_bars(&mut window);
    window.run_steps(2);
    let mut widest = 0;
    for channel in ["LON", "LAT", "P", "Q"] {
        let name = format!("Gain of {channel}: ");
        let gain = window.get_by_label_contains(&name);
        let label = gain.accesskit_node().label().unwrap_or_default();
        let Some((_, half)) = label.split_once(" ±") else {
            continue;
        };
        let half = half.trim_end_matches(" %");
        widest = widest.max(half.len());
        let name = format!("Delay of {channel}: ");
        let delay = window.get_by_label_contains(&name);
        let font = gdcm::gui::widgets::palette::small();
        let width = window.ctx.fonts_mut(|fonts| {
            let text = format!("±{half}");
            let color = egui::Color32::PLACEHOLDER;
            fonts.layout_no_wrap(text, font, color).size().x
        });
        // The areas of the buttons exceed their texts by 3 and 4 points.
        let end = gain.rect().right() + width;
        assert!(end <= delay.rect().left() + 4.0, "{label} ends at {end}");
    }
    assert!(widest > 2, "the dataset has an error bar above 100 %");
}
