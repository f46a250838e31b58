//! Values at the pointer in the plots across conditions: spread over the conditions, schedule error
//! in the displayed condition, and the largest schedule error.
//!
//! J is the cost of the difference between two responses over the band (M4: docs/method.md). Its
//! integrand weighs the errors in magnitude and phase at a frequency, so errors are compared by it.

use gdcm_method::fidelity::summand;
use gdcm_model::dataset::ConditionId;
use gdcm_plot::figure::axis::FrequencyUnit;
use gdcm_plot::figure::responses::AirspeedCurves;
use gdcm_study::AcrossRole;

use crate::gui::plot::readout_strip::{Readout, ReadoutCell};
use crate::gui::plot::value_unit::ValueUnit;
use crate::gui::plot::{BodeCurve, CurveId, Pane};

/// Source of the listed values: the curves, the displayed condition, the band and the unit.
pub(super) struct AcrossReadout<'a> {
    pub(super) curves: &'a AirspeedCurves,
    /// Displayed condition.
    pub(super) condition: ConditionId,
    /// Band limits \[rad/s\].
    pub(super) band: (f64, f64),
    pub(super) unit: FrequencyUnit,
}

/// Schedule error in a condition at a frequency.
#[derive(Clone, Copy, Debug, PartialEq)]
struct ScheduleError {
    condition: ConditionId,
    magnitude_db: f64,
    phase_deg: f64,
}

impl ScheduleError {
    /// Returns the integrand in J (M4).
    fn summand(&self) -> f64 {
        summand(self.magnitude_db, self.phase_deg)
    }

    fn values(&self) -> [String; 2] {
        [
            ValueUnit::Decibel.readout(self.magnitude_db),
            ValueUnit::Degree.readout(self.phase_deg),
        ]
    }
}

impl AcrossReadout<'_> {
    /// Returns the values at the pointer's frequency `pointed` \[rad/s\], or without one at the
    /// largest error within the band (mid-band if only responses are drawn). `None` without pointer
    /// and curves.
    pub(super) fn readout(&self, pointed: Option<f64>) -> Option<Readout> {
        let omega = match pointed {
            Some(omega) => omega,
            None => self.omega_of_largest_error()?,
        };
        let largest = largest(self.errors_at(omega));
        let heading = match (pointed, &largest) {
            (Some(_), _) => "ω at the pointer",
            (None, Some(_)) => "ω of the largest error",
            (None, None) => "ω at mid-band",
        };
        let mut largest_name = "largest error".to_owned();
        if let Some(error) = &largest {
            largest_name = format!("largest: condition {}", error.condition);
        }
        Some(Readout {
            heading: heading.to_owned(),
            frequency: self.unit.readout(omega).trim_start_matches("ω ").to_owned(),
            cells: vec![
                ReadoutCell {
                    role: None,
                    name: "spread: identified, scheduled".to_owned(),
                    values: [AcrossRole::Identified, AcrossRole::Scheduled]
                        .map(|role| self.spread_text(role, omega)),
                    warns: [false; 2],
                },
                error_cell(
                    format!("condition {}, schedule − identified", self.condition),
                    self.error_at(self.condition, omega),
                ),
                error_cell(largest_name, largest),
            ],
        })
    }

    /// Formats the difference between a role's largest and smallest magnitude at `omega` over the
    /// conditions; "–" without curves.
    fn spread_text(&self, role: AcrossRole, omega: f64) -> String {
        let mut least = f64::INFINITY;
        let mut most = f64::NEG_INFINITY;
        for curve in &self.curves.responses {
            if matches!(curve.id, CurveId::OfCondition(_, drawn) if drawn == role)
                && let Some(value) = curve.value_at(Pane::Magnitude, omega)
            {
                least = least.min(value);
                most = most.max(value);
            }
        }
        if least > most {
            return "–".to_owned();
        }
        ValueUnit::Decibel.readout(most - least)
    }

    fn error_at(&self, condition: ConditionId, omega: f64) -> Option<ScheduleError> {
        self.errors_at(omega)
            .into_iter()
            .find(|error| error.condition == condition)
    }

    fn errors_at(&self, omega: f64) -> Vec<ScheduleError> {
        let errors = self.curves.errors.iter();
        errors.filter_map(|curve| error_of(curve, omega)).collect()
    }

    /// Returns the frequency \[rad/s\] within the band with the largest integrand of J in any
    /// condition; mid-band if only responses are drawn, `None` without curves.
    fn omega_of_largest_error(&self) -> Option<f64> {
        let (min, max) = self.band;
        let mut found = None;
        let mut greatest = f64::NEG_INFINITY;
        for curve in &self.curves.errors {
            for (index, omega) in curve.omega.iter().enumerate() {
                let error = summand(curve.magnitude_db[index], curve.phase_deg[index]);
                if (min..=max).contains(omega) && error > greatest {
                    greatest = error;
                    found = Some(*omega);
                }
            }
        }
        if found.is_none() && !self.curves.responses.is_empty() {
            return Some((min * max).sqrt());
        }
        found
    }
}

/// Returns a curve's error at a frequency \[rad/s\].
fn error_of(curve: &BodeCurve, omega: f64) -> Option<ScheduleError> {
    let CurveId::OfCondition(condition, _) = curve.id else {
        return None;
    };
    Some(ScheduleError {
        condition,
        magnitude_db: curve.value_at(Pane::Magnitude, omega)?,
        phase_deg: curve.value_at(Pane::Phase, omega)?,
    })
}

/// Returns the error with the greatest integrand of J; `None` without errors.
fn largest(errors: Vec<ScheduleError>) -> Option<ScheduleError> {
    errors
        .into_iter()
        .max_by(|a, b| a.summand().total_cmp(&b.summand()))
}

fn error_cell(name: String, error: Option<ScheduleError>) -> ReadoutCell {
    ReadoutCell {
        role: None,
        name,
        values: match error {
            Some(error) => error.values(),
            None => ["–".to_owned(), "–".to_owned()],
        },
        warns: [false; 2],
    }
}

#[cfg(test)]
mod tests {
    use gdcm_plot::figure::Role;
    use gdcm_plot::figure::role::AirspeedLine;

    use super::*;

    fn curve(condition: i64, role: AcrossRole, magnitude_db: [f64; 2]) -> BodeCurve {
        let id = CurveId::OfCondition(ConditionId(condition), role);
        let line = Role::OfAirspeed(0, AirspeedLine::Identified);
        let phase_deg = vec![0.0, -4.0].into();
        BodeCurve::new(id, line).with(&vec![1.0, 4.0].into(), &magnitude_db.into(), &phase_deg)
    }

    fn curves() -> AirspeedCurves {
        AirspeedCurves {
            responses: vec![
                curve(1, AcrossRole::Identified, [0.0, -6.0]),
                curve(2, AcrossRole::Identified, [3.0, -9.0]),
                curve(1, AcrossRole::Scheduled, [1.0, -6.0]),
                curve(2, AcrossRole::Scheduled, [1.5, -6.5]),
            ],
            errors: vec![
                curve(1, AcrossRole::Scheduled, [1.0, 0.0]),
                curve(2, AcrossRole::Scheduled, [-1.5, 2.5]),
            ],
            optima: None,
        }
    }

    fn source(curves: &AirspeedCurves) -> AcrossReadout<'_> {
        AcrossReadout {
            curves,
            condition: ConditionId(1),
            band: (0.5, 12.0),
            unit: FrequencyUnit::RadPerSecond,
        }
    }

    #[test]
    fn spread_and_errors_are_listed_at_the_pointer() {
        let curves = curves();
        let readout = source(&curves).readout(Some(1.0)).unwrap();
        let values: Vec<[String; 2]> = readout
            .cells
            .iter()
            .map(|cell| cell.values.clone())
            .collect();
        assert_eq!(values[0], ["3.0 dB", "0.5 dB"]);
        assert_eq!(values[1], ["1.0 dB", "0°"]);
        assert_eq!(values[2], ["\u{2212}1.5 dB", "0°"]);
    }

    #[test]
    fn without_a_pointer_the_largest_error_in_the_band_is_listed() {
        let curves = curves();
        assert_eq!(source(&curves).omega_of_largest_error(), Some(4.0));
        let below = AcrossReadout {
            band: (0.5, 2.0),
            ..source(&curves)
        };
        assert_eq!(below.omega_of_largest_error(), Some(1.0));
    }
}
