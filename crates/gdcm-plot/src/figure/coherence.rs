//! Coherence of measured responses, in a panel below a Bode plot: at low coherence, magnitude and
//! phase are unreliable.

use gdcm_model::dataset::{BundleKind, Dynamics, Pair};
use gdcm_sysid::identification::TRUSTED_COHERENCE;

use super::axis::{Axis, Range};
use super::bode_options::BodeOptions;
use super::condition_source::{ConditionSource, SourceModel};
use super::drawing::{Color, Dash, Stroke};
use super::figure::Panel;
use super::marks::{Curve, Rule};
use super::role::Role;

/// Height of the coherence panel; the phase panel has height 1.
const WEIGHT: f64 = 0.45;
/// Line at the minimum coherence at which a frequency is used in the fit.
const TRUSTED: Stroke = Stroke::dashed(Color::DIM, 0.8, Dash::Short);

/// A measured response's coherence.
#[derive(Clone, Debug, PartialEq)]
pub struct CoherenceCurve {
    pub label: String,
    pub role: Role,
    pub rejected: bool,
    /// `[omega, coherence]`: frequency \[rad/s\] and coherence from 0 to 1.
    pub points: Vec<[f64; 2]>,
}

impl ConditionSource<'_> {
    /// Returns a response's coherence from every visible identified model that was measured with
    /// coherence; the representative comes last.
    pub fn coherence_curves(&self, pair: Pair, options: &BodeOptions) -> Vec<CoherenceCurve> {
        let mut curves: Vec<CoherenceCurve> = self
            .models(BundleKind::Identified, options)
            .into_iter()
            .filter(|model| !model.hidden)
            .filter_map(|model| self.coherence_curve(model, pair))
            .collect();
        curves.sort_by_key(|curve| curve.role.layer(curve.rejected));
        curves
    }

    /// Returns a response's coherence from an identified model; `None` if the model has no measured
    /// coherence.
    fn coherence_curve(&self, model: SourceModel, pair: Pair) -> Option<CoherenceCurve> {
        let identified = self.curves.condition.bundle(BundleKind::Identified);
        let Dynamics::Measured(response) = &identified[model.index].dynamics else {
            return None;
        };
        let coherence = response.coherence()?.get(pair)?;
        let points = response
            .omega()
            .iter()
            .zip(coherence)
            .map(|(omega, value)| [*omega, *value])
            .collect();
        Some(CoherenceCurve {
            label: model.id.name,
            role: model.role,
            rejected: model.rejected,
            points,
        })
    }

    /// Returns the minimum coherence at which a frequency is used in the fit (M4a): the value from
    /// the settings; if the settings ignore coherence, the default.
    pub fn least_coherence(&self) -> f64 {
        self.study
            .settings
            .coherence_threshold
            .unwrap_or(TRUSTED_COHERENCE)
    }
}

/// Builds the coherence panel below a Bode plot; `None` if no visible identified model has a
/// measured coherence of the response.
pub(super) fn coherence_panel(
    source: &ConditionSource<'_>,
    pair: Pair,
    options: &BodeOptions,
) -> Option<Panel> {
    let coherence = source.coherence_curves(pair, options);
    if coherence.is_empty() {
        return None;
    }
    let axis = Axis::linear("Coherence").showing(Some(Range::new(0.0, 1.05)));
    let trusted = Rule::horizontal(source.least_coherence(), TRUSTED);
    let mut panel = Panel::new(options.frequency_axis(), axis).with(trusted);
    for curve in coherence {
        let points = curve
            .points
            .iter()
            .map(|[omega, value]| [options.unit.of_omega(*omega), *value]);
        let name = format!("coherence of {}", curve.label);
        let stroke = curve.role.stroke(curve.rejected);
        panel = panel.with(Curve::through(name, stroke, points));
    }
    Some(panel.weight(WEIGHT))
}
