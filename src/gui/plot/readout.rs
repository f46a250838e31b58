//! Values of curves at the pointer: the curve under it in words, the roles in a strip between the
//! panes.

use egui::{FontId, Rect, Role as WidgetRole, Sense, Stroke, Ui, WidgetInfo, vec2};

use gdcm_model::number_format::decimals;
use gdcm_model::response::wrap;

use super::axes::FrequencyUnit;
use super::bode_view::BodeView;
use super::curve_style::Role;
use super::drawn_curves::{BodeCurve, Pane};
use super::quantity::BodeQuantity;
use crate::gui::widgets::controls::{elided, painted_text, row_text};
use crate::gui::widgets::palette::{BODY_SIZE, Palette, SMALL_SIZE, medium};

/// Formats "nominal · 2.9 dB · −99°" at `omega` \[rad/s\].
pub(super) fn value_text(quantity: BodeQuantity<'_>, curve: &BodeCurve, omega: f64) -> String {
    let value = |pane| match curve.value_at(pane, omega) {
        Some(value) => quantity.unit(pane).readout(value),
        None => "–".to_owned(),
    };
    let branch = match quantity {
        BodeQuantity::Response { .. } => curve
            .value_at(Pane::Phase, omega)
            .and_then(branch_text)
            .unwrap_or_default(),
        BodeQuantity::Error { .. } => String::new(),
    };
    format!(
        "{} · {} · {}{branch}",
        curve.label,
        value(Pane::Magnitude),
        value(Pane::Phase)
    )
}

/// Returns " (−99° less 1 turn)" if a phase \[deg\] lies on another branch than its principal
/// value.
fn branch_text(phase_deg: f64) -> Option<String> {
    let principal = wrap(phase_deg.to_radians()).to_degrees();
    let turns = ((phase_deg - principal) / 360.0).round();
    let word = if turns < 0.0 { "less" } else { "and" };
    let count = turns.abs();
    let noun = if count == 1.0 { "turn" } else { "turns" };
    (count > 0.0).then(|| format!(" ({}° {word} {count} {noun})", decimals(principal, 0)))
}

/// Formats frequency, name and values of the curve under the pointer in a single line.
pub fn pointed_words(
    view: &BodeView,
    curves: &[BodeCurve],
    (quantity, unit): (BodeQuantity<'_>, FrequencyUnit),
) -> Option<String> {
    let curve = curves
        .iter()
        .find(|curve| Some(&curve.id) == view.hovered.as_ref())?;
    let omega = view.pointed_omega?;
    let detail = if curve.detail.is_empty() {
        String::new()
    } else {
        format!(" · {}", curve.detail)
    };
    Some(format!(
        "{} · {}{detail}",
        unit.readout(omega),
        value_text(quantity, curve, omega)
    ))
}

/// Values of a role, or the difference of two roles.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ReadoutCell {
    /// Role; `None` for a difference.
    pub role: Option<Role>,
    /// Heading.
    pub name: String,
    /// Magnitude and phase, each with its unit.
    pub values: [String; 2],
    /// Whether magnitude and phase are worth a warning.
    pub warns: [bool; 2],
}

/// Values of the roles at a frequency.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Readout {
    /// Kind of the frequency: "ω at the pointer".
    pub heading: String,
    /// Formatted frequency: "6.00 rad/s".
    pub frequency: String,
    /// Roles in the order of the chips; the difference last.
    pub cells: Vec<ReadoutCell>,
}

impl Readout {
    /// Returns the values as a sentence.
    fn words(&self) -> String {
        let cells: Vec<String> = self
            .cells
            .iter()
            .map(|cell| format!("{}: {}, {}", cell.name, cell.values[0], cell.values[1]))
            .collect();
        format!("{} {}: {}", self.heading, self.frequency, cells.join("; "))
    }
}

/// Height of the strip \[pt\].
pub(super) const STRIP_HEIGHT: f32 = 40.0;
/// Least width of a cell \[pt\].
const LEAST_CELL: f32 = 96.0;

/// Draws a read-out between the panes, its cells side by side; without enough room, the first roles
/// are omitted first.
pub(super) fn readout_strip_ui(ui: &Ui, strip: Rect, readout: &Readout, palette: &Palette) {
    ui.painter().rect_filled(strip, 6.0, palette.raised);
    let most = ((strip.width() / LEAST_CELL) as usize).saturating_sub(1);
    let left_out = readout.cells.len().saturating_sub(most);
    let cells = &readout.cells[left_out..];
    // Frequency and difference have longer names than the roles.
    let weight = |place: usize| {
        if place == 0 || place == cells.len() {
            1.25
        } else {
            1.0
        }
    };
    let upto = |place: usize| {
        (0..place).map(weight).sum::<f32>() / (0..=cells.len()).map(weight).sum::<f32>()
    };
    let column = |place: usize| {
        let [left, right] =
            [place, place + 1].map(|place| strip.left() + upto(place) * strip.width());
        strip
            .with_min_x(left)
            .with_max_x(right)
            .shrink2(vec2(8.0, 3.0))
    };
    let lines = |rect: Rect| {
        [
            rect.with_max_y(rect.center().y),
            rect.with_min_y(rect.center().y),
        ]
    };
    let [upper, lower] = lines(column(0));
    let heading = elided(ui, &readout.heading, upper.width(), SMALL_SIZE);
    row_text(ui, upper, 0.0, &heading, SMALL_SIZE, palette.dim_text);
    painted_text(
        ui,
        lower,
        0.0,
        &readout.frequency,
        medium(BODY_SIZE),
        palette.text,
    );
    for (place, cell) in cells.iter().enumerate() {
        let [upper, lower] = lines(column(place + 1));
        let left = column(place + 1).left() - 8.0;
        ui.painter().vline(
            left,
            strip.shrink(8.0).y_range(),
            Stroke::new(1.0, palette.line),
        );
        let mut from = 0.0;
        if let Some(role) = cell.role {
            let mut shapes = Vec::new();
            let [start, end] = [upper.left_center(), upper.left_center() + vec2(14.0, 0.0)];
            palette
                .role_style(role, false)
                .in_miniature()
                .add_shapes(vec![start, end], &mut shapes);
            ui.painter().extend(shapes);
            from = 20.0;
        }
        // "nominal" if there is no room for "nominal, rejected".
        let shown = elided(ui, &cell.name, upper.width() - from, SMALL_SIZE);
        let name = match cell.name.split_once(", ") {
            Some((first, _)) if shown != cell.name => {
                elided(ui, first, upper.width() - from, SMALL_SIZE)
            }
            _ => shown,
        };
        row_text(ui, upper, from, &name, SMALL_SIZE, palette.dim_text);
        let color = |warns| if warns { palette.warning } else { palette.text };
        let font = if cell.role.is_none() {
            medium(BODY_SIZE)
        } else {
            FontId::proportional(BODY_SIZE)
        };
        painted_text(
            ui,
            lower,
            0.0,
            &cell.values[0],
            font.clone(),
            color(cell.warns[0]),
        );
        painted_text(
            ui,
            lower,
            -0.01,
            &cell.values[1],
            font,
            color(cell.warns[1]),
        );
    }
    let response = ui.interact(strip, ui.scope_id().with("read-out"), Sense::hover());
    response.widget_info(|| WidgetInfo::labeled(WidgetRole::Label, true, readout.words()));
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
    fn another_branch_than_the_principal_one_is_told() {
        assert_eq!(
            branch_text(-459.0).as_deref(),
            Some(" (\u{2212}99° less 1 turn)")
        );
        assert_eq!(branch_text(730.0).as_deref(), Some(" (10° and 2 turns)"));
        assert_eq!(branch_text(-170.0), None);
    }
}
