//! What hovering a curve says.

use crate::view::plot::LogAxis;
use egui::{PopupAnchor, Response, RichText, Tooltip, Ui};

use super::bode::BodeScene;
use super::curve::{BodeCurve, Pane};
use super::number::decimals;
use super::quantity::BodeQuantity;
use crate::view::palette::{Palette, SMALL_SIZE};
use gdcm_core::response::wrap;

/// "nominal · 2.9 dB · −99°" at `omega` \[rad/s\].
pub(super) fn value_text(quantity: BodeQuantity<'_>, curve: &BodeCurve, omega: f64) -> String {
    let value = |pane| match curve.value_at(pane, omega) {
        Some(value) => quantity.unit(pane).readout(value),
        None => "–".to_owned(),
    };
    let branch = match quantity {
        BodeQuantity::Response { .. } => curve.value_at(Pane::Phase, omega).and_then(branch_text).unwrap_or_default(),
        BodeQuantity::Error { .. } => String::new(),
    };
    format!("{} · {} · {}{branch}", curve.label, value(Pane::Magnitude), value(Pane::Phase))
}

/// " (−99° less 1 turn)": where a phase \[deg\] lies on another branch than that of its principal value.
fn branch_text(phase_deg: f64) -> Option<String> {
    let principal = wrap(phase_deg.to_radians()).to_degrees();
    let turns = ((phase_deg - principal) / 360.0).round();
    let (word, count) = (if turns < 0.0 { "less" } else { "and" }, turns.abs());
    let noun = if count == 1.0 { "turn" } else { "turns" };
    (count > 0.0).then(|| format!(" ({}° {word} {count} {noun})", decimals(principal, 0)))
}

/// Shows frequency, name and values of `curve` at `omega` \[rad/s\] beside the pointer.
pub(super) fn curve_tooltip_ui(
    plot: &Response,
    scene: &BodeScene<'_>,
    curve: &BodeCurve,
    omega: f64,
    palette: &Palette,
) {
    tooltip_ui(plot, |ui| {
        ui.label(RichText::new(scene.unit.readout(omega)).size(SMALL_SIZE).color(palette.dim_text));
        ui.label(value_text(scene.quantity, curve, omega));
        if !curve.detail.is_empty() {
            ui.label(RichText::new(&curve.detail).size(SMALL_SIZE).color(palette.dim_text));
        }
    });
}

/// Shows `content` beside the pointer, which is over `plot`.
pub(super) fn tooltip_ui(plot: &Response, content: impl FnOnce(&mut Ui)) {
    Tooltip::always_open(plot.ctx.clone(), plot.layer_id, plot.id, PopupAnchor::Pointer).gap(14.0).show(|ui| {
        ui.spacing_mut().item_spacing.y = 2.0;
        content(ui);
    });
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::view::plot::curve::numbered;
    use crate::view::plot::role::Role;

    #[test]
    fn a_readout_names_the_curve_and_its_values() {
        let curve = BodeCurve {
            id: numbered(0),
            label: "nominal".into(),
            detail: String::new(),
            role: Role::Nominal,
            rejected: true,
            highlighted: false,
            hidden: false,
            omega: vec![1.0, 2.0].into(),
            magnitude_db: vec![2.94, 3.0].into(),
            phase_deg: vec![-99.2, f64::NAN].into(),
        };
        assert_eq!(value_text(BodeQuantity::RESPONSE, &curve, 1.0), "nominal · 2.9 dB · \u{2212}99°");
        assert_eq!(value_text(BodeQuantity::RESPONSE, &curve, 2.0), "nominal · 3.0 dB · –");
    }

    #[test]
    fn another_branch_than_the_principal_one_is_told() {
        assert_eq!(branch_text(-459.0).as_deref(), Some(" (\u{2212}99° less 1 turn)"));
        assert_eq!(branch_text(730.0).as_deref(), Some(" (10° and 2 turns)"));
        assert_eq!(branch_text(-170.0), None);
    }
}
