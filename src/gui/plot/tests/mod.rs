//! Interaction of the plots with the mouse, without a display.

mod axes;
mod bode;
mod charts;
mod gains;
mod tables;

use std::sync::Arc;

use egui::{Event, Modifiers, PointerButton, Pos2, Vec2};
use egui_kittest::Harness;

use gdcm_model::dataset::{BundleKind, ConditionId, ModelId};

use super::*;

/// Returns the id of a physics model that is named after this number.
pub(super) fn numbered(number: u64) -> CurveId {
    CurveId::Model(ModelId::new(
        ConditionId(1),
        BundleKind::Physics,
        number.to_string(),
    ))
}

/// Returns a curve with the same `values` in both panes, at frequencies an octave apart.
pub(super) fn sample_curve(id: u64, values: &[f64]) -> BodeCurve {
    let curve = BodeCurve::new(numbered(id), Role::Perturbed);
    curve.with(&vec![1.0, 2.0, 4.0].into(), &values.into(), &values.into())
}

fn send_button<State>(
    harness: &mut Harness<'_, State>,
    pos: Pos2,
    button: PointerButton,
    pressed: bool,
    modifiers: Modifiers,
) {
    harness.event(Event::PointerButton {
        pos,
        button,
        pressed,
        modifiers,
    });
    harness.step();
}

fn press<State>(
    harness: &mut Harness<'_, State>,
    at: Pos2,
    button: PointerButton,
    modifiers: Modifiers,
) {
    harness.hover_at(at);
    harness.step();
    send_button(harness, at, button, true, modifiers);
    send_button(harness, at, button, false, modifiers);
    harness.step();
}

fn click<State>(harness: &mut Harness<'_, State>, at: Pos2) {
    press(harness, at, PointerButton::Primary, Modifiers::NONE);
}

fn double_click<State>(harness: &mut Harness<'_, State>, at: Pos2) {
    for pressed in [true, false, true, false] {
        send_button(
            harness,
            at,
            PointerButton::Primary,
            pressed,
            Modifiers::NONE,
        );
    }
}

/// Returns the event of a wheel turn by `delta` \[pt\].
fn wheel(delta: Vec2) -> Event {
    Event::MouseWheel {
        unit: egui::MouseWheelUnit::Point,
        delta,
        phase: egui::TouchPhase::Move,
        modifiers: Modifiers::NONE,
        source: egui::MouseWheelSource::Wheel,
    }
}

fn drag<State>(harness: &mut Harness<'_, State>, path: &[Pos2], button: PointerButton) {
    let (Some(first), Some(last)) = (path.first(), path.last()) else {
        return;
    };
    harness.hover_at(*first);
    harness.step();
    send_button(harness, *first, button, true, Modifiers::NONE);
    for at in path {
        harness.hover_at(*at);
        harness.step();
    }
    send_button(harness, *last, button, false, Modifiers::NONE);
    harness.step();
}

/// Returns a first-order lag with this gain \[dB\] and corner frequency \[rad/s\] at 120
/// frequencies from 0.3 to 20 rad/s.
fn lag(id: u64, gain_db: f64, corner: f64, role: Role) -> BodeCurve {
    let omega: Arc<[f64]> = (0..120)
        .map(|k| 0.3 * (20.0f64 / 0.3).powf(f64::from(k) / 119.0))
        .collect();
    let magnitude_db = omega
        .iter()
        .map(|w| gain_db - 10.0 * (1.0 + (w / corner).powi(2)).log10())
        .collect();
    let phase_deg = omega
        .iter()
        .map(|w| -(w / corner).atan().to_degrees())
        .collect();
    BodeCurve {
        id: numbered(id),
        label: format!("model {id}"),
        detail: "click to reject".to_owned(),
        role,
        rejected: false,
        highlighted: false,
        hidden: false,
        omega,
        magnitude_db,
        phase_deg,
    }
}
