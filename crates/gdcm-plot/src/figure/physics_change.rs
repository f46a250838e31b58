//! Effect of the physics parameters in a condition: the most improved responses without their
//! differences in gain and delay (G and D, M6), and the poles (M18.5).

use std::sync::Arc;

use gdcm_method::couplings::PoleShift;
use gdcm_model::dataset::{ConditionId, Dataset};
use gdcm_model::number_format::decimals;
use gdcm_study::results::physics_assessment::{ConditionPhysics, PhysicsAssessment};
use gdcm_study::results::response_shapes::ResponseShapes;

use super::axis::{Axis, FrequencyUnit, Range};
use super::couplings::AXIS;
use super::drawing::{Color, Dash, Hue, Stroke};
use super::figure::{Figure, Panel, Plot};
use super::marks::{Curve, Rule};
use super::pole_shift::{PoleShiftNames, pole_shift_marks};

/// Identified representative.
const IDENTIFIED: Stroke = Stroke::solid(Color::new(Hue::Identified), 2.4);
/// Physics representative with unchanged parameters.
const BEFORE: Stroke = Stroke::dashed(Color::new(Hue::Perturbed), 1.2, Dash::Short);
/// Physics representative with changed parameters.
const AFTER: Stroke = Stroke::solid(Color::new(Hue::Perturbed), 1.6);
/// Magnitude up to which poles are displayed, relative to the band's upper end: poles far above the
/// band would squeeze those within it.
const SHOWN_POLES: f64 = 1.5;
/// Minimum range of the magnitude axis \[dB\].
const LEAST_DB: f64 = 4.0;
/// Minimum range of the phase axis \[deg\].
const LEAST_DEG: f64 = 20.0;
/// Margin above and below the curves, relative to their height.
const MARGIN: f64 = 0.06;

/// Plots up to `most` responses in a condition, the most improved first, and its poles; `None` if
/// the condition was not analysed or the parameters do not change its physics models.
pub fn physics_change_figure(
    assessment: &PhysicsAssessment,
    dataset: &Dataset,
    condition: ConditionId,
    most: usize,
    unit: FrequencyUnit,
) -> Option<Figure> {
    let effect = assessment.conditions.get(&condition)?;
    if effect.responses.is_empty() {
        return None;
    }
    let mut figure = Figure::new(format!("Physics parameters in condition {condition}"))
        .caption(
            "Each response is drawn with its own G and D applied (eq. (5), (9)), as these belong to \
            the correction of the channels; J is the error that remains.",
        )
        .columns(most + 1)
        .aspect(1.3);
    let frequencies = assessment
        .omega
        .iter()
        .map(|omega| unit.of_omega(*omega))
        .collect();
    let plots = ResponsePlots {
        dataset,
        frequencies,
        unit,
    };
    for response in effect.responses.iter().take(most) {
        figure = figure.plot(plots.plot(response));
    }
    let most_rad_s = SHOWN_POLES * assessment.band.max();
    Some(figure.plot(pole_plot(effect, most_rad_s)))
}

/// Axis and names common to the response plots.
struct ResponsePlots<'a> {
    dataset: &'a Dataset,
    frequencies: Arc<[f64]>,
    unit: FrequencyUnit,
}

impl ResponsePlots<'_> {
    fn plot(&self, response: &ResponseShapes) -> Plot {
        let name = self.dataset.pair_name(response.pair);
        let before = decimals(response.cost.without, 1);
        let after = decimals(response.cost.with, 1);
        let magnitudes = Traces {
            identified: &response.identified.magnitude_db,
            before: &response.physics.without.magnitude_db,
            after: &response.physics.with.magnitude_db,
        };
        let phases = Traces {
            identified: &response.identified.phase_deg,
            before: &response.physics.without.phase_deg,
            after: &response.physics.with.phase_deg,
        };
        let magnitude = Axis::linear("Magnitude [dB]").showing(magnitudes.range(LEAST_DB));
        let phase = Axis::degrees("Phase [deg]").showing(phases.range(LEAST_DEG));
        Plot::new(format!("{name}, J {before} → {after}"))
            .panel(self.panel(magnitude, &magnitudes))
            .panel(self.panel(phase, &phases))
    }

    fn panel(&self, y: Axis, traces: &Traces<'_>) -> Panel {
        let mut panel = Panel::new(Axis::logarithmic(self.unit.axis_label()), y);
        for (name, stroke, values) in [
            ("identified", IDENTIFIED, traces.identified),
            ("physics", BEFORE, traces.before),
            ("physics, parameters changed", AFTER, traces.after),
        ] {
            let curve = Curve::new(name, stroke, Arc::clone(&self.frequencies), values.to_vec());
            panel = panel.with(curve.key(name));
        }
        panel
    }
}

/// Magnitudes \[dB\] or phases \[deg\] for a response: identified, and physics with unchanged and
/// with changed parameters.
struct Traces<'a> {
    identified: &'a [f64],
    before: &'a [f64],
    after: &'a [f64],
}

impl Traces<'_> {
    /// Returns a range that contains all finite values with a margin and is at least `least` high;
    /// `None` without a finite value.
    fn range(&self, least: f64) -> Option<Range> {
        let values = [self.identified, self.before, self.after].concat();
        let finite = values.into_iter().filter(|value| value.is_finite());
        Some(Range::spanning(finite)?.with_margin(MARGIN, least))
    }
}

/// Plots the physics representative's poles with unchanged and with changed parameters, up to the
/// magnitude `most_rad_s`.
fn pole_plot(effect: &ConditionPhysics, most_rad_s: f64) -> Plot {
    let mut shown: Vec<PoleShift> = Vec::new();
    for shift in effect.poles.iter().flatten() {
        if shift.after.norm() <= most_rad_s {
            shown.push(*shift);
        }
    }
    let names = PoleShiftNames {
        before: "pole, physics",
        after: "pole, parameters changed",
        color: Color::new(Hue::Perturbed),
    };
    let x = Axis::linear("Re λ [rad/s]").including(0.0);
    let y = Axis::linear("Im λ [rad/s]");
    let panel = Panel::new(x, y)
        .with(Rule::vertical(0.0, AXIS))
        .with_all(pole_shift_marks(&shown, &names));
    Plot::new("Poles").panel(panel)
}
