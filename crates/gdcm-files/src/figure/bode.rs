//! Responses of one condition: magnitude and phase of every model over frequency (Figures 2 and 5).

use std::collections::{BTreeMap, BTreeSet};
use std::sync::Arc;

use gdcm_core::dataset::{Band as BandOfComparison, ConditionId, ModelId, Pair};
use gdcm_core::response::{FrequencyResponse, ResponseShape, wrapped_deg};
use gdcm_core::study::{AcrossCurves, AcrossJob, AcrossRole, Analysis, CURVE_POINTS, Job, Unobserved, display_band};
use gdcm_core::units::db_to_ratio;

use super::axis::{Axis, Range};
use super::condition_source::{ConditionSource, CurveId, ResponseLine, SourceModel, settings_words};
use super::drawing::{Color, Hue};
use super::figure::{Figure, Panel, Plot};
use super::mark::{Along, Band, Curve, Mark, Note, Place};
use super::request::{FrequencyUnit, MagnitudeUnit, PhaseErrorUnit, PhaseUnit};
use super::role::Role;

/// The ground of the band of comparison.
const BAND: Color = Color::of(Hue::Accent).tint(8);
/// Height that fitting gives to values outside the band on either side, as a part of the height within it.
const OUTSIDE_PART: f64 = 0.4;
/// Height of the magnitude, where that of the phase is 1.
const MAGNITUDE_WEIGHT: f64 = 1.35;

/// What of the responses is shown, and how.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct BodeOptions {
    /// Unit of frequencies.
    pub unit: FrequencyUnit,
    /// How magnitudes are read.
    pub magnitude: MagnitudeUnit,
    /// How phases are drawn.
    pub phase: PhaseUnit,
    /// How differences of phases are drawn.
    pub phase_error: PhaseErrorUnit,
    /// Roles that are left out.
    pub hidden: BTreeSet<Role>,
    /// Models that are left out.
    pub hidden_models: BTreeSet<ModelId>,
    /// The only model shown beside the representatives.
    pub isolated: Option<ModelId>,
    /// Whole turns that phases were moved up by hand.
    pub turns: BTreeMap<(ConditionId, Pair, CurveId), i32>,
    /// Whether what a pilot does not notice is shown among the errors.
    pub shows_muad: bool,
    /// The response whose zeros are shown among the poles, where those of one are.
    pub zeros_of: Option<Pair>,
    /// The frequencies shown \[rad/s\]; those of the curves, where none are given.
    pub omega: Option<Range>,
    /// The values shown in the upper and in the lower panel; those that the band needs, where none are given.
    pub values: [Option<Range>; 2],
}

impl BodeOptions {
    /// Whether a model is shown: a representative always, another one unless some other is isolated.
    pub(super) fn shows_model(&self, model: &SourceModel) -> bool {
        if self.hidden_models.contains(&model.id) {
            return false;
        }
        let represents = matches!(model.role, Role::Representative | Role::IdentifiedRepresentative);
        represents || self.isolated.as_ref().is_none_or(|isolated| *isolated == model.id)
    }

    /// A phase \[deg\] with the turns that it was given by hand.
    pub(super) fn turned(
        &self,
        condition: ConditionId,
        pair: Pair,
        curve: &CurveId,
        phase_deg: &Arc<[f64]>,
    ) -> Arc<[f64]> {
        match self.turns.get(&(condition, pair, curve.clone())) {
            Some(turns) => phase_deg.iter().map(|phase| phase + 360.0 * f64::from(*turns)).collect(),
            None => Arc::clone(phase_deg),
        }
    }

    /// The axis of frequencies.
    pub(super) fn frequency_axis(&self) -> Axis {
        let in_unit = |range: Range| Range::new(self.unit.of_omega(range.min), self.unit.of_omega(range.max));
        Axis::logarithmic(self.unit.axis_label()).showing(self.omega.map(in_unit))
    }

    /// The ground of the band of comparison.
    pub(super) fn band(&self, source: &ConditionSource<'_>) -> Band {
        ground_of(source.study.settings.band, self.unit)
    }
}

/// The ground of a band of comparison.
pub(super) fn ground_of(band: BandOfComparison, unit: FrequencyUnit) -> Band {
    let range = Range::new(unit.of_omega(band.min()), unit.of_omega(band.max()));
    Band { along: Along::X, range, color: BAND, key: Some("band of comparison".to_owned()) }
}

/// The responses `pairs` of one condition: a magnitude above a phase each, of every model and of the corrected ones.
pub fn bode_figure(source: &ConditionSource<'_>, pairs: &[Pair], options: &BodeOptions) -> Figure {
    let names: Vec<String> = pairs.iter().map(|pair| source.dataset().pair_name(*pair)).collect();
    let (title, aspect) = match &names[..] {
        [name] => (format!("{name} · {}", source.condition_words()), 0.72),
        _ => (source.condition_words(), 1.9),
    };
    let plots = pairs.iter().zip(&names).map(|(pair, name)| {
        let title = if names.len() == 1 { "" } else { name };
        plot(source, *pair, title, options)
    });
    Figure::new(title).caption(source.caption()).columns(5).aspect(aspect).shared_x().plots(plots)
}

fn plot(source: &ConditionSource<'_>, pair: Pair, title: &str, options: &BodeOptions) -> Plot {
    let mut lines = source.lines(pair, options);
    if options.phase == PhaseUnit::Wrapped {
        lines.iter_mut().for_each(|line| line.shape.phase_deg = wrapped_deg(&line.shape.phase_deg).into());
    }
    let magnitudes = |line: &ResponseLine| Arc::clone(&line.shape.magnitude_db);
    let phases = |line: &ResponseLine| Arc::clone(&line.shape.phase_deg);
    let needed = |least: f64, of: &dyn Fn(&ResponseLine) -> Arc<[f64]>| {
        needed_range(source, lines.iter().map(of)).map(|range| range.with_margin(0.04, least))
    };
    let magnitude_db = options.values[0].or_else(|| needed(4.0, &magnitudes));
    let phase_deg = options.values[1].or_else(|| needed(20.0, &phases));
    let magnitude = match options.magnitude {
        MagnitudeUnit::Decibel => Axis::linear("Magnitude [dB]").showing(magnitude_db),
        MagnitudeUnit::Ratio => {
            lines.iter_mut().for_each(|line| {
                line.shape.magnitude_db = line.shape.magnitude_db.iter().map(|db| db_to_ratio(*db)).collect();
            });
            let ratio = magnitude_db.map(|db| Range::new(db_to_ratio(db.min), db_to_ratio(db.max)));
            Axis::logarithmic(format!("Magnitude [{}]", source.ratio_unit(pair))).showing(ratio)
        }
    };
    let panel = |axis: Axis, of: fn(&ResponseLine) -> &Arc<[f64]>| {
        let curves = response_curves(source, &lines, options.unit, of);
        Panel::new(options.frequency_axis(), axis).with(options.band(source)).with_all(curves)
    };
    let phase = Axis::degrees("Phase [deg]").showing(phase_deg);
    Plot::new(title)
        .panel(panel(magnitude, |line| &line.shape.magnitude_db).weight(MAGNITUDE_WEIGHT))
        .panel(panel(phase, |line| &line.shape.phase_deg))
}

/// The lines as marks; their frequencies are shared.
pub(super) fn response_curves(
    source: &ConditionSource<'_>,
    lines: &[ResponseLine],
    unit: FrequencyUnit,
    of: fn(&ResponseLine) -> &Arc<[f64]>,
) -> Vec<Mark> {
    let frequency: Arc<[f64]> = source.omega().iter().map(|omega| unit.of_omega(*omega)).collect();
    let curve = |line: &ResponseLine| {
        let stroke = line.role.stroke(line.rejected);
        let key = line.role.key(line.rejected);
        Curve::new(&line.name, stroke, Arc::clone(&frequency), Arc::clone(of(line))).key(key).into()
    };
    lines.iter().map(curve).collect()
}

/// The values to show: all within the band, and outside it as far as they leave room for those within.
fn needed_range(source: &ConditionSource<'_>, values: impl Iterator<Item = Arc<[f64]>>) -> Option<Range> {
    let band = source.study.settings.band;
    let omega = source.omega();
    let (mut all, mut within) = (Vec::new(), Vec::new());
    for values in values {
        for (omega, value) in omega.iter().zip(values.iter()) {
            all.push(*value);
            if (band.min()..=band.max()).contains(omega) {
                within.push(*value);
            }
        }
    }
    let all = Range::of(all)?;
    let Some(within) = Range::of(within) else { return Some(all) };
    let room = within.with_margin(OUTSIDE_PART, 0.0);
    Some(Range::new(all.min.max(room.min), all.max.min(room.max)))
}

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

/// The magnitude of every response of one condition, outputs down, inputs across, with J before and after the correction.
pub fn overview_figure(source: &ConditionSource<'_>, options: &BodeOptions) -> Figure {
    let dataset = source.dataset();
    let plots = dataset.on_axis().pairs().map(|pair| {
        let lines = source.lines(pair, options);
        let curves = response_curves(source, &lines, options.unit, |line| &line.shape.magnitude_db);
        let panel = Panel::new(options.frequency_axis(), Axis::linear("Magnitude [dB]").at_least(4.0));
        let panel = panel.with(options.band(source)).with_all(curves);
        let note = source.analysis.cost[pair].map(|cost| {
            let text = format!("J {:.0} → {:.0}", cost.uncorrected.total(), cost.corrected.total());
            Note { at: Place::LowerLeft, text }
        });
        let held = if source.analysis.held()[pair] { " *" } else { "" };
        Plot::new(format!("{}{held}", dataset.pair_name(pair))).panel(panel.with_all(note))
    });
    let figure =
        Figure::new(source.condition_words()).caption(format!("{} * held exactly.", source.caption())).plots(plots);
    figure.columns(dataset.inputs().len()).dense().shared_x().aspect(0.55)
}
