//! Coherence of measured responses, below their Bode plot: where it is low, magnitude and phase above are guesses.

use gdcm_core::dataset::{BundleKind, Dynamics, Pair};
use gdcm_core::identification::TRUSTED_COHERENCE;

use super::axis::{Axis, Range};
use super::bode::BodeOptions;
use super::condition_source::ConditionSource;
use super::drawing::{Color, Dash, Stroke};
use super::figure::Panel;
use super::mark::{Curve, Rule};
use super::role::Role;

/// Height of the strip, where that of the phase is 1.
const WEIGHT: f64 = 0.45;
/// Where coherence is trusted.
const TRUSTED: Stroke = Stroke::dashed(Color::DIM, 0.8, Dash::Short);

/// Coherence of one measured response.
#[derive(Clone, Debug, PartialEq)]
pub struct CoherenceCurve {
    /// The model's name.
    pub label: String,
    /// How its response is drawn.
    pub role: Role,
    /// Whether the model is rejected.
    pub rejected: bool,
    /// Frequencies \[rad/s\] and coherence, 0 to 1.
    pub points: Vec<[f64; 2]>,
}

impl ConditionSource<'_> {
    /// The coherence of a response of every identified model that is shown and was measured with it; the representative last.
    pub fn coherence_curves(&self, pair: Pair, options: &BodeOptions) -> Vec<CoherenceCurve> {
        let bundle = self.curves.condition.bundle(BundleKind::Identified);
        let models = self.models(BundleKind::Identified, options).into_iter().filter(|model| !model.hidden);
        let curve = |model: super::condition_source::SourceModel| {
            let Dynamics::Measured(response) = &bundle[model.index].dynamics else { return None };
            let coherence = response.coherence()?.get(pair)?;
            let points = response.omega().iter().zip(coherence).map(|(omega, value)| [*omega, *value]).collect();
            Some(CoherenceCurve { label: model.id.name, role: model.role, rejected: model.rejected, points })
        };
        let mut curves: Vec<CoherenceCurve> = models.filter_map(curve).collect();
        curves.sort_by_key(|curve| curve.role.layer(curve.rejected));
        curves
    }

    /// From which coherence on a frequency counts: that of the settings, else what is usual.
    pub fn least_coherence(&self) -> f64 {
        self.study.settings.coherence_threshold.unwrap_or(TRUSTED_COHERENCE)
    }
}

/// The strip below a Bode plot; none where nothing was measured with coherence.
pub(super) fn coherence_panel(source: &ConditionSource<'_>, pair: Pair, options: &BodeOptions) -> Option<Panel> {
    let curves = source.coherence_curves(pair, options);
    if curves.is_empty() {
        return None;
    }
    let curves = curves.into_iter().map(|curve| {
        let (x, y): (Vec<f64>, Vec<f64>) =
            curve.points.iter().map(|[omega, value]| (options.unit.of_omega(*omega), *value)).unzip();
        Curve::new(format!("coherence of {}", curve.label), curve.role.stroke(curve.rejected), x, y)
    });
    let axis = Axis::linear("Coherence").showing(Some(Range::new(0.0, 1.05)));
    let trusted = Rule::horizontal(source.least_coherence(), TRUSTED);
    Some(Panel::new(options.frequency_axis(), axis).with(trusted).with_all(curves).weight(WEIGHT))
}
