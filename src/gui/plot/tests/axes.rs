//! Interaction with the axes of a Bode plot.

use egui::{Key, vec2};
use egui_kittest::kittest::Queryable;

use gdcm_plot::figure::Range;

use super::super::bode_axis::NOT_INCREASING;
use super::bode::{Model, harness, three_curves};
use super::*;

/// Returns the visible frequencies \[rad/s\], magnitudes and phases.
fn ranges(harness: &Harness<'_, Model>) -> ((f64, f64), Range, Range) {
    let view = &harness.state().view;
    (
        view.omega_range(),
        view.value_range(Pane::Magnitude),
        view.value_range(Pane::Phase),
    )
}

fn middle_of(harness: &Harness<'_, Model>, label: &str) -> Pos2 {
    harness.get_by_label(label).rect().center()
}

const FREQUENCIES: &str = "Frequency axis, phase plot";
const MAGNITUDES: &str = "Value axis, magnitude plot";

#[test]
fn the_wheel_over_an_axis_zooms_that_axis_alone() {
    for (axis, zooms_frequencies) in [(FREQUENCIES, true), (MAGNITUDES, false)] {
        let mut harness = harness(three_curves());
        let before = ranges(&harness);
        let at = middle_of(&harness, axis);
        harness.hover_at(at);
        harness.step();
        harness.event(wheel(vec2(0.0, 120.0)));
        harness.run_steps(12);
        let after = ranges(&harness);
        assert_eq!(
            (after.0 != before.0, after.1 != before.1),
            (zooms_frequencies, !zooms_frequencies),
            "{axis}"
        );
        assert_eq!(after.2, before.2, "{axis}");
    }
}

#[test]
fn dragging_an_axis_pans_that_axis_alone() {
    for (axis, pans_frequencies) in [(FREQUENCIES, true), (MAGNITUDES, false)] {
        let mut harness = harness(three_curves());
        let before = ranges(&harness);
        let at = middle_of(&harness, axis);
        drag(
            &mut harness,
            &[at, at + vec2(30.0, 30.0), at + vec2(60.0, 60.0)],
            PointerButton::Primary,
        );
        let after = ranges(&harness);
        assert_eq!(
            (after.0 != before.0, after.1 != before.1),
            (pans_frequencies, !pans_frequencies),
            "{axis}"
        );
        let same_width = (after.1.width() - before.1.width()).abs() < 1e-9;
        assert!(same_width && after.2 == before.2, "{axis}");
    }
}

fn type_limits(harness: &mut Harness<'_, Model>, axis: &str, limits: [&str; 2]) {
    let at = middle_of(harness, axis);
    click(harness, at);
    click(harness, at);
    harness.run();
    for (field, text) in ["Lower limit", "Upper limit"].into_iter().zip(limits) {
        harness.get_by_label(field).focus();
        harness.run();
        harness.key_press_modifiers(Modifiers::COMMAND, Key::A);
        harness.run();
        harness.get_by_label(field).type_text(text);
        harness.run();
    }
    harness.key_press(Key::Enter);
    harness.run();
}

#[test]
fn limits_can_be_typed_and_invalid_limits_are_refused_with_a_message() {
    let mut harness = harness(three_curves());
    type_limits(&mut harness, FREQUENCIES, ["2", "8"]);
    let (min, max) = ranges(&harness).0;
    // The tolerance allows for rounding errors of a logarithm and its inverse.
    assert!(
        (min - 2.0).abs() < 1e-12 && (max - 8.0).abs() < 1e-12,
        "{min} {max}"
    );
    assert!(
        harness.query_by_label("Lower limit").is_none(),
        "the form is closed"
    );
    harness.run_steps(40);
    type_limits(&mut harness, MAGNITUDES, ["10", "-10"]);
    harness.get_by_label(NOT_INCREASING);
    assert_ne!(ranges(&harness).1, Range::new(-10.0, 10.0));
}

#[test]
fn a_plot_with_the_focus_is_panned_and_zoomed_from_the_keyboard() {
    let mut harness = harness(three_curves());
    let fitted = ranges(&harness);
    harness
        .get_by_label("Magnitude of LON → Q, 3 curves")
        .focus();
    harness.run();
    harness.key_press(Key::ArrowRight);
    harness.run();
    let right = ranges(&harness);
    assert!(right.0.0 > fitted.0.0 && right.1 == fitted.1, "arrows pan");
    harness.key_press(Key::ArrowUp);
    harness.run();
    let up = ranges(&harness);
    assert!(up.1.min > right.1.min && up.0 == right.0);
    harness.key_press_modifiers(Modifiers::SHIFT, Key::Plus);
    harness.run();
    let closer = ranges(&harness);
    assert!(
        closer.0.1 / closer.0.0 < up.0.1 / up.0.0 && closer.1 == up.1,
        "Shift: frequencies only"
    );
    harness.key_press(Key::Minus);
    harness.run();
    assert!(ranges(&harness).1.width() > closer.1.width());
    harness.key_press(Key::Home);
    harness.run();
    assert_eq!(ranges(&harness), fitted);
    harness.key_press(Key::Escape);
    harness.run();
    harness.key_press(Key::ArrowRight);
    harness.run();
    assert_eq!(ranges(&harness), fitted, "Escape leaves the plot");
}
