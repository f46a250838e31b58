//! Responses over frequency, as a plot of magnitude above phase shows them: curves, lines across, and areas around curves.

use std::sync::Arc;

use super::condition_source::CurveId;
use super::drawing::{Color, Dash, Hue, Stroke};
use super::role::Role;

/// Which of the two stacked plots.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Pane {
    /// Magnitude \[dB\], above.
    Magnitude,
    /// Phase \[deg\], below.
    Phase,
}

/// A frequency response with its name and its role.
#[derive(Clone, Debug)]
pub struct BodeCurve {
    /// How events name this curve.
    pub id: CurveId,
    /// The name that hovering shows.
    pub label: String,
    /// A second line for hovering: what the caller wants to say about it, and what a click does. May be empty.
    pub detail: String,
    /// What the curve stands for.
    pub role: Role,
    /// Whether the model is left out.
    pub rejected: bool,
    /// Whether another view points at it.
    pub highlighted: bool,
    /// Whether the engineer does not want to see it; the legend names its role all the same.
    pub hidden: bool,
    /// Frequencies \[rad/s\], ascending.
    pub omega: Arc<[f64]>,
    /// Magnitude \[dB\] at each frequency; a value that is not finite leaves a gap.
    pub magnitude_db: Arc<[f64]>,
    /// Phase \[deg\] at each frequency; a value that is not finite leaves a gap.
    pub phase_deg: Arc<[f64]>,
}

impl BodeCurve {
    /// A curve of this role without words and numbers yet.
    pub fn new(id: CurveId, role: Role) -> Self {
        let (label, detail, none) = (String::new(), String::new(), Arc::<[f64]>::default());
        let (magnitude_db, phase_deg) = (Arc::clone(&none), Arc::clone(&none));
        let (rejected, highlighted, hidden) = (false, false, false);
        Self { id, label, detail, role, rejected, highlighted, hidden, omega: none, magnitude_db, phase_deg }
    }

    /// The same curve of these numbers.
    pub fn with(self, omega: &Arc<[f64]>, magnitude_db: &Arc<[f64]>, phase_deg: &Arc<[f64]>) -> Self {
        let (omega, magnitude_db, phase_deg) = (Arc::clone(omega), Arc::clone(magnitude_db), Arc::clone(phase_deg));
        Self { omega, magnitude_db, phase_deg, ..self }
    }

    /// What a pane shows of this curve.
    pub fn values(&self, pane: Pane) -> &[f64] {
        self.shared_values(pane)
    }

    /// [`Self::values`] with their owner: whoever holds it can tell later whether they are still the same.
    pub fn shared_values(&self, pane: Pane) -> &Arc<[f64]> {
        match pane {
            Pane::Magnitude => &self.magnitude_db,
            Pane::Phase => &self.phase_deg,
        }
    }

    /// The points of a pane in plot coordinates, `[log10 omega, value]`; gaps are points that are not finite.
    pub fn points(&self, pane: Pane) -> impl Iterator<Item = [f64; 2]> + '_ {
        self.omega.iter().zip(self.values(pane)).map(|(omega, value)| [omega.log10(), *value])
    }

    /// [`Self::points`], with logarithms taken once for all the curves on the same frequencies.
    pub fn points_on<'a>(&'a self, axis: &'a mut LogFrequencies, pane: Pane) -> impl Iterator<Item = [f64; 2]> + 'a {
        axis.of(&self.omega).iter().zip(self.values(pane)).map(|(log_omega, value)| [*log_omega, *value])
    }

    /// Those of [`Self::points_on`] from `low` to `high` in `log10 omega`, and one on either side.
    pub fn points_between<'a>(
        &'a self,
        axis: &'a mut LogFrequencies,
        pane: Pane,
        (low, high): (f64, f64),
    ) -> impl Iterator<Item = [f64; 2]> + 'a {
        let log_omega = axis.of(&self.omega);
        let from = log_omega.partition_point(|at| *at < low).saturating_sub(1);
        let count = log_omega[from..].partition_point(|at| *at <= high) + 1;
        let points = log_omega.iter().zip(self.values(pane)).skip(from).take(count);
        points.map(|(log_omega, value)| [*log_omega, *value])
    }

    /// The value at `omega` \[rad/s\], linear in `log10 omega` between points; nothing outside them or beside a gap.
    pub fn value_at(&self, pane: Pane, omega: f64) -> Option<f64> {
        let values = self.values(pane);
        let after = self.omega.partition_point(|at| *at < omega);
        let value = if self.omega.get(after) == Some(&omega) {
            *values.get(after)?
        } else {
            let before = after.checked_sub(1)?;
            let (start, end) = (self.omega.get(before)?, self.omega.get(after)?);
            let fraction = (omega / start).ln() / (end / start).ln();
            let (from, to) = (values.get(before)?, values.get(after)?);
            from + fraction * (to - from)
        };
        value.is_finite().then_some(value)
    }
}

/// The logarithms of the frequencies asked for last: the curves of a scene mostly share theirs.
#[derive(Clone, Debug, Default)]
pub struct LogFrequencies {
    omega: Arc<[f64]>,
    log_omega: Vec<f64>,
}

impl LogFrequencies {
    /// `log10` of each of `omega`.
    fn of(&mut self, omega: &Arc<[f64]>) -> &[f64] {
        if !Arc::ptr_eq(&self.omega, omega) {
            self.omega = Arc::clone(omega);
            self.log_omega = omega.iter().map(|omega| omega.log10()).collect();
        }
        &self.log_omega
    }
}

/// How a figure depends on the frequency.
#[derive(Clone, Debug, PartialEq)]
pub enum Level {
    /// It is this everywhere.
    Constant(f64),
    /// It is this times omega \[rad/s\]: what a delay takes from the phase.
    PerOmega(f64),
    /// It is what it is at each of these frequencies: omega \[rad/s\], rising, and value.
    Sampled(Vec<[f64; 2]>),
}

impl Level {
    /// Points of a line that is no straight one.
    const POINTS: usize = 80;

    /// The value at omega \[rad/s\]; of a sampled one that of the sample, and not a number elsewhere.
    pub fn at(&self, omega: f64) -> f64 {
        match self {
            Self::Constant(value) => *value,
            Self::PerOmega(slope) => slope * omega,
            Self::Sampled(points) => points.iter().find(|[at, _]| *at == omega).map_or(f64::NAN, |[_, value]| *value),
        }
    }

    /// The points of the line between two frequencies: `log10 omega` and value.
    pub fn points(&self, from: f64, to: f64) -> Vec<[f64; 2]> {
        let log_omega = (0..=Self::POINTS).map(|point| from + (to - from) * point as f64 / Self::POINTS as f64);
        match self {
            Self::Constant(value) => vec![[from, *value], [to, *value]],
            Self::PerOmega(slope) => log_omega.map(|x| [x, slope * 10f64.powf(x)]).collect(),
            Self::Sampled(points) => points.iter().map(|[omega, value]| [omega.log10(), *value]).collect(),
        }
    }
}

/// What a rule stands for; what comes first gets its label first.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum ReferenceKind {
    /// What the fit asks for: G, D.
    Delta,
    /// A bound of the channels: LB, UB.
    Bound,
    /// A quantile over the band.
    Quantile,
    /// What a pilot does not notice.
    Envelope,
}

impl ReferenceKind {
    /// How it is drawn in the window.
    pub fn line(self) -> Stroke {
        match self {
            Self::Delta => Stroke::dashed(Color::INK, 0.9, Dash::Dotted),
            Self::Bound => Stroke::dashed(Color::of(Hue::Warning), 1.0, Dash::DashDot),
            Self::Quantile => Stroke::dashed(Color::DIM, 0.9, Dash::Short),
            Self::Envelope => Stroke::solid(Color::of(Hue::Good), 1.0),
        }
    }

    /// Its entry in the legend of a figure, where it has no label of its own there.
    pub fn key(self) -> &'static str {
        match self {
            Self::Delta => "delta gain, delta delay",
            Self::Bound => "bounds",
            Self::Quantile => "quantiles",
            Self::Envelope => "unnoticed within, MUAD",
        }
    }
}

/// A labelled line across a pane that curves are read against.
#[derive(Clone, Debug, PartialEq)]
pub struct ReferenceLine {
    /// The pane it lies in.
    pub pane: Pane,
    /// What it stands for.
    pub kind: ReferenceKind,
    /// What stands on it: "G 0.83 (−1.7 dB)".
    pub label: String,
    /// What is said of it besides where there is room: ", median over the band". May be empty.
    pub note: String,
    /// Where it lies.
    pub level: Level,
}

/// How far a response may lie from its curve.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct BodeBand {
    /// Frequencies \[rad/s\], ascending.
    pub omega: Vec<f64>,
    /// Lower and upper magnitude \[dB\].
    pub magnitude_db: Vec<[f64; 2]>,
    /// Lower and upper phase \[deg\].
    pub phase_deg: Vec<[f64; 2]>,
}

#[cfg(test)]
mod tests {
    use super::*;

    fn curve(magnitude_db: &[f64]) -> BodeCurve {
        let omega: Vec<f64> = (0..magnitude_db.len()).map(|k| 10f64.powi(k as i32)).collect();
        let curve = BodeCurve::new(CurveId::Corrected, Role::Corrected);
        curve.with(&omega.into(), &magnitude_db.into(), &magnitude_db.into())
    }

    #[test]
    fn a_delay_takes_phase_in_proportion_to_frequency() {
        assert_eq!(Level::Constant(3.0).points(0.0, 1.0), [[0.0, 3.0], [1.0, 3.0]]);
        let points = Level::PerOmega(-2.0).points(0.0, 1.0);
        assert_eq!((points.first(), points.last()), (Some(&[0.0, -2.0]), Some(&[1.0, -20.0])));
        assert_eq!(Level::Sampled(vec![[100.0, 5.0]]).points(0.0, 1.0), [[2.0, 5.0]]);
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
        let mut between = |low, high| -> Vec<f64> {
            curve.points_between(&mut axis, Pane::Magnitude, (low, high)).map(|[x, _]| x).collect()
        };
        assert_eq!(between(1.5, 2.5), [1.0, 2.0, 3.0]);
        assert_eq!(between(2.0, 3.0), [1.0, 2.0, 3.0, 4.0]);
        assert_eq!(between(-9.0, 0.5), [0.0, 1.0]);
        assert_eq!(between(4.5, 9.0), [4.0, 5.0]);
        assert_eq!(between(7.0, 9.0), [5.0]);
    }

    #[test]
    fn there_is_no_value_beside_a_gap() {
        let curve = curve(&[0.0, f64::NAN, 3.0]);
        assert_eq!(curve.value_at(Pane::Phase, 10.0), None);
        assert_eq!(curve.value_at(Pane::Phase, 30.0), None);
        assert_eq!(curve.value_at(Pane::Phase, 100.0), Some(3.0));
    }
}
