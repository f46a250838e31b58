//! One response in every condition, coloured by airspeed.

use std::sync::Arc;

use gdcm_core::dataset::{ModelId, Pair};
use gdcm_core::response::{FrequencyResponse, ResponseShape};
use gdcm_core::study::{AcrossCurves, AcrossJob, AcrossRole, Analysis, CURVE_POINTS, Job, Unobserved, display_band};

use super::axis::Axis;
use super::bode::{BodeOptions, ground_of};
use super::condition_source::settings_words;
use super::figure::Figure;
use super::mark::{Curve, Mark};
use super::panel::{Panel, Plot};
use super::role::Role;

/// The responses `pairs` of one model of every condition: a magnitude above a phase each, from blue for the slowest condition to
/// amber for the fastest. None where no condition has such a model.
pub fn airspeeds_figure(
    analysis: &Analysis,
    pairs: &[Pair],
    role: AcrossRole,
    options: &BodeOptions,
) -> Option<Figure> {
    let (dataset, settings) = (&analysis.study.dataset, &analysis.study.settings);
    let job = AcrossJob::of(dataset, Some(analysis), role, (display_band(settings.band), CURVE_POINTS));
    let curves = job.run(&mut (), &Unobserved).ok().filter(|curves| !curves.responses.is_empty())?;
    let names: Vec<String> = pairs.iter().map(|pair| dataset.pair_name(*pair)).collect();
    let (title, aspect) = match &names[..] {
        [name] => (format!("{name} · every condition, {}", role.name()), 0.72),
        _ => (format!("Every condition, {}", role.name()), 1.9),
    };
    let plots = pairs.iter().zip(&names).map(|(pair, name)| {
        let source = AirspeedSource { analysis, curves: &curves, role, pair: *pair, options };
        source.plot(if names.len() == 1 { "" } else { name })
    });
    let figure = Figure::new(title).caption(settings_words(dataset, settings)).columns(5).aspect(aspect);
    Some(figure.shared_x().plots(plots))
}

/// What the curves of one response are made of.
struct AirspeedSource<'a> {
    analysis: &'a Analysis,
    curves: &'a AcrossCurves,
    role: AcrossRole,
    pair: Pair,
    options: &'a BodeOptions,
}

impl AirspeedSource<'_> {
    fn plot(&self, title: &str) -> Plot {
        let mut lines: Vec<(ModelId, ResponseShape)> = Vec::new();
        for (id, response) in &self.curves.responses {
            let first = lines.first().map(|(_, shape)| shape.clone());
            lines.extend(self.shape(id, response, first.as_ref()).map(|shape| (id.clone(), shape)));
        }
        let frequency: Arc<[f64]> =
            self.curves.grid.omega().iter().map(|omega| self.options.unit.of_omega(*omega)).collect();
        let marks = |of: fn(&ResponseShape) -> &Arc<[f64]>| -> Vec<Mark> {
            lines.iter().map(|(id, shape)| self.curve(id, &frequency, of(shape)).into()).collect()
        };
        let panel = |axis: Axis, curves: Vec<Mark>| {
            let ground = ground_of(self.analysis.study.settings.band, self.options.unit);
            Panel::new(self.options.frequency_axis(), axis).with(ground).with_all(curves)
        };
        let magnitude = Axis::linear("Magnitude [dB]").showing(self.options.values[0]);
        let phase = Axis::degrees("Phase [deg]").showing(self.options.values[1]);
        let upper = panel(magnitude, marks(|shape| &shape.magnitude_db));
        Plot::new(title).panel(upper.weight(1.35)).panel(panel(phase, marks(|shape| &shape.phase_deg)))
    }

    /// The response as it is drawn, its phase laid on that of the first; none where it has no correction.
    fn shape(
        &self,
        id: &ModelId,
        response: &FrequencyResponse,
        first: Option<&ResponseShape>,
    ) -> Option<ResponseShape> {
        let correction = self.role.correction(id.condition, self.pair, Some(self.analysis))?;
        let shape = ResponseShape::of(&response.curve(self.pair)).corrected(self.curves.grid.omega(), correction);
        Some(match first {
            Some(first) => shape.laid_on(first),
            None => shape,
        })
    }

    fn curve(&self, id: &ModelId, frequency: &Arc<[f64]>, values: &Arc<[f64]>) -> Curve {
        let dataset = &self.analysis.study.dataset;
        let airspeed_kt = dataset.condition(id.condition).map_or(f64::NAN, |of| of.flight_state().airspeed_kt);
        let (least, most) = dataset.airspeed_range_kt();
        let name = format!("{}: {airspeed_kt:.0} kt", id.condition);
        let stroke = Role::of_airspeed(airspeed_kt, (least, most)).stroke(false);
        Curve::new(name.clone(), stroke, Arc::clone(frequency), Arc::clone(values)).key(name)
    }
}
