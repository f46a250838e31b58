//! A frequency response as drawn: magnitude and phase over frequency, with name and role.
//!
//! A *variant* is the study with other decisions, kept under a name and overlaid for comparison;
//! *couplings* are the mixing of inputs and the feedback from outputs by which a physics model is
//! corrected (M16).

use std::sync::Arc;

use gdcm_model::dataset::{ConditionId, ModelId};
use gdcm_study::AcrossRole;

use super::range::Range;
use super::role::Role;

/// Identity of a curve; unique within a response.
#[derive(Clone, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum CurveId {
    Model(ModelId),
    /// Representative physics model with the condition's own correction.
    Corrected,
    /// Representative physics model with the scheduled correction.
    Scheduled,
    /// Representative physics model with the condition's own correction, without its lead filters.
    WithoutLeads,
    /// Representative physics model with couplings alone.
    Coupled,
    /// Representative physics model in a study variant, with the correction from that variant.
    Variant,
    /// A condition's model in a figure across several conditions.
    OfCondition(ConditionId, AcrossRole),
}

/// Upper or lower panel of a Bode plot.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Pane {
    /// Upper panel \[dB\].
    Magnitude,
    /// Lower panel \[deg\].
    Phase,
}

/// A frequency response with its name and role.
///
/// Also used for the error, the deviation from a reference: the phase values are then in the
/// engineer's unit for phase errors (`PhaseErrorUnit`).
#[derive(Clone, Debug)]
pub struct BodeCurve {
    pub id: CurveId,
    /// Name in the status text, in menus and in tables.
    pub label: String,
    /// Further facts about the curve, after its values in the status text and below its name in
    /// menus. May be empty.
    pub detail: String,
    pub role: Role,
    pub rejected: bool,
    /// Whether the curve is emphasised because its model or condition is selected or under the
    /// pointer.
    pub highlighted: bool,
    /// Whether the curve is hidden at the engineer's request; its role remains in the legend.
    pub hidden: bool,
    /// Frequencies \[rad/s\], ascending.
    pub omega: Arc<[f64]>,
    /// Magnitude \[dB\] at each frequency; a value that is not finite leaves a gap.
    pub magnitude_db: Arc<[f64]>,
    /// Phase \[deg\] at each frequency; a value that is not finite leaves a gap.
    pub phase_deg: Arc<[f64]>,
}

impl BodeCurve {
    /// Creates a visible curve without a label, a detail and points.
    pub fn new(id: CurveId, role: Role) -> Self {
        Self {
            id,
            label: String::new(),
            detail: String::new(),
            role,
            rejected: false,
            highlighted: false,
            hidden: false,
            omega: Arc::default(),
            magnitude_db: Arc::default(),
            phase_deg: Arc::default(),
        }
    }

    /// Returns the curve with these points: magnitude \[dB\] and phase \[deg\] at each frequency
    /// \[rad/s\].
    pub fn with(
        self,
        omega: &Arc<[f64]>,
        magnitude_db: &Arc<[f64]>,
        phase_deg: &Arc<[f64]>,
    ) -> Self {
        Self {
            omega: Arc::clone(omega),
            magnitude_db: Arc::clone(magnitude_db),
            phase_deg: Arc::clone(phase_deg),
            ..self
        }
    }

    /// Returns a panel's values, one at each frequency.
    pub fn values(&self, pane: Pane) -> &[f64] {
        self.shared_values(pane)
    }

    /// Returns [`Self::values`] as a shared slice; as long as its address is unchanged, so are the
    /// values.
    pub fn shared_values(&self, pane: Pane) -> &Arc<[f64]> {
        match pane {
            Pane::Magnitude => &self.magnitude_db,
            Pane::Phase => &self.phase_deg,
        }
    }

    /// Iterates over `[log10 omega, value]`; a non-finite value marks a gap.
    pub fn points(&self, pane: Pane) -> impl Iterator<Item = [f64; 2]> + '_ {
        self.omega
            .iter()
            .zip(self.values(pane))
            .map(|(omega, value)| [omega.log10(), *value])
    }

    /// Iterates over the same points as [`Self::points`]; `axis` caches the logarithms for other
    /// curves with the same frequencies.
    pub fn points_on<'a>(
        &'a self,
        axis: &'a mut LogFrequencies,
        pane: Pane,
    ) -> impl Iterator<Item = [f64; 2]> + 'a {
        axis.logarithms(&self.omega)
            .iter()
            .zip(self.values(pane))
            .map(|(log_omega, value)| [*log_omega, *value])
    }

    /// Returns those points from [`Self::points_on`] that lie in a range of `log10 omega`, and the
    /// nearest point beyond either end.
    pub fn points_between<'a>(
        &'a self,
        axis: &'a mut LogFrequencies,
        pane: Pane,
        range: Range,
    ) -> impl Iterator<Item = [f64; 2]> + 'a {
        let log_omega = axis.logarithms(&self.omega);
        let from = log_omega
            .partition_point(|at| *at < range.min)
            .saturating_sub(1);
        let count = log_omega[from..].partition_point(|at| *at <= range.max) + 1;
        log_omega
            .iter()
            .zip(self.values(pane))
            .skip(from)
            .take(count)
            .map(|(log_omega, value)| [*log_omega, *value])
    }

    /// Returns the value at `omega` \[rad/s\], interpolated linearly in `log10 omega`; `None`
    /// outside the curve's frequencies and next to a gap.
    pub fn value_at(&self, pane: Pane, omega: f64) -> Option<f64> {
        let value = self.interpolated(self.values(pane), omega)?;
        if value.is_finite() { Some(value) } else { None }
    }

    /// Interpolates `values` at `omega` \[rad/s\]; NaN next to a gap, `None` outside the curve's
    /// frequencies.
    fn interpolated(&self, values: &[f64], omega: f64) -> Option<f64> {
        let after = self.omega.partition_point(|at| *at < omega);
        if self.omega.get(after) == Some(&omega) {
            return values.get(after).copied();
        }
        let before = after.checked_sub(1)?;
        let start = self.omega.get(before)?;
        let end = self.omega.get(after)?;
        let fraction = (omega / start).ln() / (end / start).ln();
        let from = values.get(before)?;
        let to = values.get(after)?;
        Some(from + fraction * (to - from))
    }
}

/// Caches the previous curve's frequencies as logarithms; most curves in a plot share their
/// frequencies.
#[derive(Clone, Debug, Default)]
pub struct LogFrequencies {
    omega: Arc<[f64]>,
    log_omega: Vec<f64>,
}

impl LogFrequencies {
    /// Returns `log10` of each frequency, computed only if `omega` is not the previous slice.
    fn logarithms(&mut self, omega: &Arc<[f64]>) -> &[f64] {
        if !Arc::ptr_eq(&self.omega, omega) {
            self.omega = Arc::clone(omega);
            self.log_omega = omega.iter().map(|omega| omega.log10()).collect();
        }
        &self.log_omega
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Returns a curve with these magnitudes at 1, 10, 100, … rad/s.
    fn curve(magnitude_db: &[f64]) -> BodeCurve {
        let omega: Vec<f64> = (0..magnitude_db.len())
            .map(|k| 10f64.powi(k as i32))
            .collect();
        let curve = BodeCurve::new(CurveId::Corrected, Role::Corrected);
        curve.with(&omega.into(), &magnitude_db.into(), &magnitude_db.into())
    }

    #[test]
    fn values_between_points_follow_the_logarithm_of_the_frequency() {
        let curve = curve(&[0.0, -20.0, -40.0]);
        let value = |omega| curve.value_at(Pane::Magnitude, omega);
        assert_eq!(value(10.0), Some(-20.0));
        assert!(value(10f64.sqrt()).is_some_and(|db| (db + 10.0).abs() < 1e-12));
        assert_eq!(value(0.5), None);
        assert_eq!(value(101.0), None);
    }

    #[test]
    fn points_between_two_frequencies_lead_to_both() {
        let curve = curve(&[0.0, 1.0, 2.0, 3.0, 4.0, 5.0]);
        let mut axis = LogFrequencies::default();
        for (low, high, expected) in [
            (1.5, 2.5, vec![1.0, 2.0, 3.0]),
            (2.0, 3.0, vec![1.0, 2.0, 3.0, 4.0]),
            (-9.0, 0.5, vec![0.0, 1.0]),
            (4.5, 9.0, vec![4.0, 5.0]),
            (7.0, 9.0, vec![5.0]),
        ] {
            let points = curve.points_between(&mut axis, Pane::Magnitude, Range::new(low, high));
            let found: Vec<f64> = points.map(|[x, _]| x).collect();
            assert_eq!(found, expected, "{low} {high}");
        }
    }

    #[test]
    fn there_is_no_value_beside_a_gap() {
        let curve = curve(&[0.0, f64::NAN, 3.0]);
        assert_eq!(curve.value_at(Pane::Phase, 10.0), None);
        assert_eq!(curve.value_at(Pane::Phase, 30.0), None);
        assert_eq!(curve.value_at(Pane::Phase, 100.0), Some(3.0));
    }
}
