//! Interaction with the axes of a Bode plot.

use egui::{Key, vec2};
use egui_kittest::kittest::Queryable;

use gdcm_plot::figure::Range;

use super::super::bode_axis::NOT_INCREASING;
use super::bode::{PlotState, harness, three_curves};
use super::*;

/// Visible ranges of a Bode plot.
#[derive(Clone, Copy, Debug, PartialEq)]
struct VisibleRanges {
    /// Frequencies \[rad/s\].
    omega: (f64, f64),
    magnitudes: Range,
    phases: Range,
}

fn ranges(harness: &Harness<'_, PlotState>) -> VisibleRanges {
    let view = &harness.state().view;
    VisibleRanges {
        omega: view.omega_range(),
        magnitudes: view.value_range(Pane::Magnitude),
        phases: view.value_range(Pane::Phase),
    }
}

fn middle_of(harness: &Harness<'_, PlotState>, label: &str) -> Pos2 {
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
            [
                after.omega != before.omega,
                after.magnitudes != before.magnitudes
            ],
            [zooms_frequencies, !zooms_frequencies],
            "{axis}"
        );
        assert_eq!(after.phases, before.phases, "{axis}");
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
            [
                after.omega != before.omega,
                after.magnitudes != before.magnitudes
            ],
            [pans_frequencies, !pans_frequencies],
            "{axis}"
        );
        let widened = after.magnitudes.width() - before.magnitudes.width();
        assert!(
            widened.abs() < 1e-9 && after.phases == before.phases,
            "{axis}"
        );
    }
}

fn type_limits(harness: &mut Harness<'_, PlotState>, axis: &str, limits: [&str; 2]) {
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
    let (min, max) = ranges(&harness).omega;
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
    assert_ne!(ranges(&harness).magnitudes, Range::new(-10.0, 10.0));
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
    assert!(
        right.omega.0 > fitted.omega.0 && right.magnitudes == fitted.magnitudes,
        "arrows pan"
    );
    harness.key_press(Key::ArrowUp);
    harness.run();
    let up = ranges(&harness);
    assert!(up.magnitudes.min > right.magnitudes.min && up.omega == right.omega);
    harness.key_press_modifiers(Modifiers::SHIFT, Key::Plus);
    harness.run();
    let closer = ranges(&harness);
    assert!(
        closer.omega.1 / closer.omega.0 < up.omega.1 / up.omega.0
            && closer.magnitudes == up.magnitudes,
        "Shift: frequencies only"
    );
    harness.key_press(Key::Minus);
    harness.run();
    assert!(ranges(&harness).magnitudes.width() > closer.magnitudes.width());
    harness.key_press(Key::Home);
    harness.run();
    assert_eq!(ranges(&harness), fitted);
    harness.key_press(Key::Escape);
    harness.run();
    harness.key_press(Key::ArrowRight);
    harness.run();
    assert_eq!(ranges(&harness), fitted, "Escape leaves the plot");
}
