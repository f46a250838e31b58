//! Status text for the curve under the pointer: its name, and its values at the pointer.

use gdcm_model::number_format::decimals;
use gdcm_model::response::wrap;
use gdcm_plot::figure::axis::FrequencyUnit;

use super::bode_view::BodeView;
use super::drawn_curves::{BodeCurve, Pane};
use super::quantity::BodeQuantity;

/// Formats frequency, name and values for the curve under the pointer in a single line; `None` if
/// no curve is under the pointer.
pub fn pointed_curve_text(
    view: &BodeView,
    curves: &[BodeCurve],
    quantity: BodeQuantity<'_>,
    unit: FrequencyUnit,
) -> Option<String> {
    let curve = curves
        .iter()
        .find(|curve| Some(&curve.id) == view.hovered.as_ref())?;
    let omega = view.pointed_omega?;
    let mut words = format!(
        "{} · {}",
        unit.readout(omega),
        value_text(quantity, curve, omega)
    );
    if !curve.detail.is_empty() {
        words.push_str(" · ");
        words.push_str(&curve.detail);
    }
    Some(words)
}

/// Formats, for example, "nominal · 2.9 dB · −99°" at `omega` \[rad/s\], with the branch of a
/// response's phase ([`branch_text`]).
fn value_text(quantity: BodeQuantity<'_>, curve: &BodeCurve, omega: f64) -> String {
    let mut text = curve.label.clone();
    for pane in [Pane::Magnitude, Pane::Phase] {
        text.push_str(" · ");
        match curve.value_at(pane, omega) {
            Some(value) => text.push_str(&quantity.unit(pane).readout(value)),
            None => text.push('–'),
        }
    }
    if let BodeQuantity::Response { .. } = quantity
        && let Some(phase_deg) = curve.value_at(Pane::Phase, omega)
        && let Some(branch) = branch_text(phase_deg)
    {
        text.push_str(&branch);
    }
    text
}

/// Returns, for example, " (−99° less 1 turn)" if a phase \[deg\] differs from its principal value
/// by whole turns, otherwise `None`.
fn branch_text(phase_deg: f64) -> Option<String> {
    let principal = wrap(phase_deg.to_radians()).to_degrees();
    let turns = ((phase_deg - principal) / 360.0).round();
    let count = turns.abs();
    if count == 0.0 || count.is_nan() {
        return None;
    }
    let sign = if turns < 0.0 { "less" } else { "and" };
    let noun = if count == 1.0 { "turn" } else { "turns" };
    let principal = decimals(principal, 0);
    Some(format!(" ({principal}° {sign} {count} {noun})"))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::gui::plot::curve_style::Role;
    use crate::gui::plot::tests::numbered;

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
        assert_eq!(
            value_text(BodeQuantity::RESPONSE, &curve, 1.0),
            "nominal · 2.9 dB · \u{2212}99°"
        );
        assert_eq!(
            value_text(BodeQuantity::RESPONSE, &curve, 2.0),
            "nominal · 3.0 dB · –"
        );
    }

    #[test]
    fn a_branch_other_than_the_principal_is_reported() {
        assert_eq!(
            branch_text(-459.0).as_deref(),
            Some(" (\u{2212}99° less 1 turn)")
        );
        assert_eq!(branch_text(730.0).as_deref(), Some(" (10° and 2 turns)"));
        assert_eq!(branch_text(-170.0), None);
    }
}
