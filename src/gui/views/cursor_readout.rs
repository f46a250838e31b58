//! Values on the principal curves at the pointer, at marked frequencies, or where the integrand of
//! J is largest.
//!
//! J is the cost of the difference between two responses over the band (M4: docs/method.md). Its
//! integrand weighs the errors in magnitude and phase at a frequency.

use gdcm_method::fidelity::summand;
use gdcm_model::response::wrap;
use gdcm_plot::figure::axis::FrequencyUnit;

use crate::gui::plot::drawn_curves::PANES;
use crate::gui::plot::quantity::BodeQuantity;
use crate::gui::plot::readout_strip::{Readout, ReadoutCell};
use crate::gui::plot::value_unit::ValueUnit;
use crate::gui::plot::{BodeCurve, Pane, Role};

/// Roles whose values are listed.
const LISTED: [Role; 4] = [
    Role::Nominal,
    Role::IdentifiedRepresentative,
    Role::Corrected,
    Role::Scheduled,
];

/// Magnitude difference \[dB\] from which it is shown as a warning. With this difference and
/// [`WARNING_DEG`] at every frequency, J would be 20 (1.0² + 0.0175 · 10²) = 55, near the 50 up to
/// which a model is nearly indistinguishable from flight (M4).
const WARNING_DB: f64 = 1.0;
/// Phase difference \[deg\] from which it is shown as a warning.
const WARNING_DEG: f64 = 10.0;

/// Plot whose values are listed.
#[derive(Clone, Copy)]
pub(super) struct ReadoutSource<'a> {
    pub(super) curves: &'a [BodeCurve],
    pub(super) quantity: BodeQuantity<'a>,
    pub(super) unit: FrequencyUnit,
    /// Band limits \[rad/s\].
    pub(super) band: (f64, f64),
}

/// Drawn curve with a listed role.
#[derive(Clone, Copy)]
struct ListedCurve<'a> {
    role: Role,
    curve: &'a BodeCurve,
}

/// Corrected minus identified model at a frequency; `None` where a curve has no value.
#[derive(Clone, Copy)]
struct Difference {
    magnitude_db: Option<f64>,
    /// Principal value, because whole turns cannot be determined at a single frequency (M4).
    phase_deg: Option<f64>,
}

impl<'a> ReadoutSource<'a> {
    /// Returns the values at `cursor` \[rad/s\], else at the first mark, else where the integrand
    /// of J is largest within the band. With exactly two marks, returns the changes between them
    /// instead, even with a cursor. `None` without cursor and marks if the error is unknown.
    pub(super) fn readout(&self, cursor: Option<f64>, marks: &[f64]) -> Option<Readout> {
        if let [from, to] = *marks {
            return Some(self.changes(from, to));
        }
        match (cursor, marks.first()) {
            (Some(omega), _) => Some(self.values("ω at the pointer", omega)),
            (None, Some(omega)) => Some(self.values("ω at the mark", *omega)),
            (None, None) => {
                Some(self.values("ω of the largest error", self.omega_of_largest_error()?))
            }
        }
    }

    fn curve(&self, role: Role) -> Option<&'a BodeCurve> {
        self.curves
            .iter()
            .find(|curve| !curve.hidden && curve.role == role)
    }

    fn listed_curves(&self) -> Vec<ListedCurve<'a>> {
        let mut listed = Vec::new();
        for role in LISTED {
            if let Some(curve) = self.curve(role) {
                listed.push(ListedCurve { role, curve });
            }
        }
        listed
    }

    /// Lists how the values change between two frequencies \[rad/s\].
    fn changes(&self, from: f64, to: f64) -> Readout {
        let mut cells = Vec::new();
        for ListedCurve { role, curve } in self.listed_curves() {
            cells.push(ReadoutCell {
                role: Some(role),
                name: format!("Δ {}", role.name()),
                values: PANES.map(|pane| {
                    difference_text(self.quantity, pane, change(curve, pane, from, to))
                }),
                warns: [false; 2],
            });
        }
        Readout {
            heading: "change between marks".to_owned(),
            frequency: format!(
                "{} → {}",
                self.frequency_text(from),
                self.frequency_text(to)
            ),
            cells,
        }
    }

    /// Lists the values at a frequency \[rad/s\], and for responses also the difference between
    /// corrected and identified model.
    fn values(&self, heading: &str, omega: f64) -> Readout {
        let mut cells = Vec::new();
        for ListedCurve { role, curve } in self.listed_curves() {
            cells.push(ReadoutCell {
                role: Some(role),
                name: if curve.rejected {
                    format!("{}, rejected", role.name())
                } else {
                    role.name().to_owned()
                },
                values: PANES.map(|pane| self.value_text(curve, pane, omega)),
                warns: [false; 2],
            });
        }
        if let BodeQuantity::Response { .. } = self.quantity
            && let Some(difference) = self.difference(omega)
        {
            cells.push(self.difference_cell(difference));
        }
        Readout {
            heading: heading.to_owned(),
            frequency: self.frequency_text(omega),
            cells,
        }
    }

    /// Formats a frequency \[rad/s\] without its symbol, which is in the heading.
    fn frequency_text(&self, omega: f64) -> String {
        self.unit.readout(omega).trim_start_matches("ω ").to_owned()
    }

    fn value_text(&self, curve: &BodeCurve, pane: Pane, omega: f64) -> String {
        match curve.value_at(pane, omega) {
            Some(value) => self.quantity.unit(pane).readout(value),
            None => "–".to_owned(),
        }
    }

    /// Returns the difference between corrected and identified model; `None` unless both are drawn.
    fn difference(&self, omega: f64) -> Option<Difference> {
        let corrected = self.curve(Role::Corrected)?;
        let identified = self.curve(Role::IdentifiedRepresentative)?;
        let [magnitude_db, phase_deg] = PANES
            .map(|pane| Some(corrected.value_at(pane, omega)? - identified.value_at(pane, omega)?));
        Some(Difference {
            magnitude_db,
            phase_deg: phase_deg.map(principal_deg),
        })
    }

    fn difference_cell(&self, difference: Difference) -> ReadoutCell {
        let Difference {
            magnitude_db,
            phase_deg,
        } = difference;
        ReadoutCell {
            role: None,
            name: "corrected − identified".to_owned(),
            values: [
                difference_text(self.quantity, Pane::Magnitude, magnitude_db),
                difference_text(self.quantity, Pane::Phase, phase_deg),
            ],
            warns: [
                magnitude_db.is_some_and(|value| value.abs() >= WARNING_DB),
                phase_deg.is_some_and(|value| value.abs() >= WARNING_DEG),
            ],
        }
    }

    /// Returns the frequency \[rad/s\] within the band at which the integrand of J is largest (M4).
    fn omega_of_largest_error(&self) -> Option<f64> {
        let (min, max) = self.band;
        let mut largest: Option<ErrorAt> = None;
        for &omega in self.curve(Role::Corrected)?.omega.iter() {
            if !(min..=max).contains(&omega) {
                continue;
            }
            let difference = self.difference(omega)?;
            let (Some(db), Some(deg)) = (difference.magnitude_db, difference.phase_deg) else {
                continue;
            };
            let error = summand(db, deg);
            // `is_ge`: among equal values, the highest frequency is chosen.
            if largest.is_none_or(|largest| error.total_cmp(&largest.error).is_ge()) {
                largest = Some(ErrorAt { omega, error });
            }
        }
        Some(largest?.omega)
    }
}

/// Integrand of J at a frequency \[rad/s\].
#[derive(Clone, Copy)]
struct ErrorAt {
    omega: f64,
    error: f64,
}

fn principal_deg(phase_deg: f64) -> f64 {
    wrap(phase_deg.to_radians()).to_degrees()
}

fn change(curve: &BodeCurve, pane: Pane, from: f64, to: f64) -> Option<f64> {
    Some(curve.value_at(pane, to)? - curve.value_at(pane, from)?)
}

/// Formats a difference between two values; for ratios the difference is in decibels.
fn difference_text(quantity: BodeQuantity<'_>, pane: Pane, difference: Option<f64>) -> String {
    let unit = match quantity.unit(pane) {
        ValueUnit::Ratio => ValueUnit::Decibel,
        unit => unit,
    };
    match difference {
        Some(difference) => unit.readout(difference),
        None => "–".to_owned(),
    }
}

#[cfg(test)]
mod tests {
    use gdcm_model::dataset::{BundleKind, ConditionId, ModelId};

    use super::*;
    use crate::gui::plot::CurveId;

    fn flat(name: &str, role: Role, magnitude_db: f64, phase_deg: f64) -> BodeCurve {
        BodeCurve {
            id: CurveId::Model(ModelId::new(ConditionId(1), BundleKind::Physics, name)),
            label: name.to_owned(),
            detail: String::new(),
            role,
            rejected: false,
            highlighted: false,
            hidden: false,
            omega: vec![1.0, 4.0].into(),
            magnitude_db: vec![magnitude_db; 2].into(),
            phase_deg: vec![phase_deg, phase_deg - 90.0].into(),
        }
    }

    fn curves() -> Vec<BodeCurve> {
        vec![
            flat("a", Role::Perturbed, -3.0, 0.0),
            flat("b", Role::Perturbed, -1.0, 0.0),
            flat("n", Role::Nominal, 2.0, 400.0),
            flat("i", Role::IdentifiedRepresentative, 1.0, 10.0),
            flat("c", Role::Corrected, 2.5, 400.0),
        ]
    }

    fn source(curves: &[BodeCurve]) -> ReadoutSource<'_> {
        ReadoutSource {
            curves,
            quantity: BodeQuantity::RESPONSE,
            unit: FrequencyUnit::RadPerSecond,
            band: (0.5, 12.0),
        }
    }

    fn values(readout: &Readout, name: &str) -> [String; 2] {
        readout
            .cells
            .iter()
            .find(|cell| cell.name == name)
            .unwrap()
            .values
            .clone()
    }

    #[test]
    fn values_and_the_remaining_difference_are_listed_at_the_pointer() {
        let readout = source(&curves()).readout(Some(1.0), &[]).unwrap();
        assert_eq!(readout.heading, "ω at the pointer");
        assert_eq!(readout.frequency, "1.00 rad/s");
        assert_eq!(values(&readout, "nominal"), ["2.0 dB", "400°"]);
        assert_eq!(values(&readout, "identified"), ["1.0 dB", "10°"]);
        // 400° is one turn plus 40°, so 30° ahead of 10°.
        assert_eq!(
            values(&readout, "corrected − identified"),
            ["1.5 dB", "30°"]
        );
        assert_eq!(readout.cells.last().unwrap().warns, [true, true]);
    }

    #[test]
    fn changes_are_listed_between_two_marks() {
        let readout = source(&curves()).readout(None, &[1.0, 4.0]).unwrap();
        assert_eq!(values(&readout, "Δ nominal"), ["0.0 dB", "\u{2212}90°"]);
        assert_eq!(readout.frequency, "1.00 rad/s → 4.00 rad/s");
    }

    #[test]
    fn the_largest_error_in_the_band_is_listed_without_a_pointer() {
        let mut curves = curves();
        let corrected = curves
            .iter_mut()
            .find(|curve| curve.role == Role::Corrected)
            .unwrap();
        corrected.magnitude_db = vec![1.0, 9.0].into();
        let readout = source(&curves).readout(None, &[]).unwrap();
        assert_eq!(readout.heading, "ω of the largest error");
        assert_eq!(readout.frequency, "4.00 rad/s");
        let above = ReadoutSource {
            band: (5.0, 12.0),
            ..source(&curves)
        };
        assert_eq!(
            above.readout(None, &[]),
            None,
            "the curves end below this band"
        );
    }
}
