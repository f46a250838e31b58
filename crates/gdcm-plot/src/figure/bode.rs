//! Responses of one or several conditions on paper: magnitude above phase over frequency (Figures 2
//! and 5), and below them the coherence of the measured ones: where it is low, magnitude and phase
//! are unreliable.

use std::collections::{BTreeMap, BTreeSet};
use std::sync::Arc;

use gdcm_model::dataset::{
    Band as BandOfComparison, BundleKind, ConditionId, Dynamics, ModelId, Pair,
};
use gdcm_model::progress::Unobserved;
use gdcm_model::units::db_to_ratio;
use gdcm_study::jobs::curve_jobs::AcrossJob;
use gdcm_study::jobs::job::Job;
use gdcm_study::stages::condition_curves::{CURVE_POINTS, display_band};
use gdcm_study::{AcrossRole, Analysis};
use gdcm_sysid::identification::TRUSTED_COHERENCE;

use super::axis::{Axis, FrequencyUnit, MagnitudeUnit, PhaseErrorUnit, PhaseUnit, Range};
use super::condition_source::{ConditionSource, CurveId, settings_words};
use super::drawing::{Color, Dash, Hue, Stroke};
use super::error::muad_about;
use super::figure::{Band, Curve, Envelope, Figure, Mark, Note, Panel, Place, Plot, Rule};
use super::responses::{
    AirspeedCache, BodeBand, BodeCurve, Level, Pane, ReferenceKind, ReferenceLine, ResponseCache,
    airspeed_curves, fitted_values, uncertainty_bands,
};
use super::role::Role;

/// Background of the band of comparison.
const BAND: Color = Color::of(Hue::Accent).tint(8);
/// Background of frequencies at which the remaining mismatch would be noticed.
const NOTICED: Color = Color::of(Hue::Warning).tint(20);
/// Background of frequencies above the band if there are leads.
const INVALID: Color = Color::of(Hue::Warning).tint(10);
/// Line of a marked frequency.
const CROSSING: Stroke = Stroke::dashed(Color::of(Hue::Text), 0.8, Dash::Short);
/// Confidence band of an identified model.
const UNCERTAIN: Color = Color::of(Hue::Identified).tint(22);
/// Height of the magnitude panel, relative to 1 for the phase.
const MAGNITUDE_WEIGHT: f64 = 1.35;
/// Margin above and below the curves, as a fraction of their height.
const MARGIN: f64 = 0.04;

/// Options of a Bode plot: contents, units and ranges.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct BodeOptions {
    pub unit: FrequencyUnit,
    pub magnitude: MagnitudeUnit,
    pub phase: PhaseUnit,
    pub phase_error: PhaseErrorUnit,
    /// Roles not shown.
    pub hidden: BTreeSet<Role>,
    /// Models not shown.
    pub hidden_models: BTreeSet<ModelId>,
    /// The only model shown besides the representatives.
    pub isolated: Option<ModelId>,
    /// Whole turns added to phases by hand.
    pub turns: BTreeMap<(ConditionId, Pair, CurveId), i32>,
    /// Whether the envelopes of unnoticeable added dynamics are shown, about the identified
    /// response and among the errors.
    pub shows_muad: bool,
    /// Response whose zeros are shown among the poles.
    pub zeros_of: Option<Pair>,
    /// Marked frequencies \[rad/s\] with their names, at which a bandwidth is read.
    pub crossings: Vec<(&'static str, f64)>,
    /// Shown frequencies \[rad/s\]; fitted to the curves if `None`.
    pub omega: Option<Range>,
    /// Ranges of the upper and the lower panel; fitted to the band if `None`.
    pub values: [Option<Range>; 2],
}

impl BodeOptions {
    /// Returns the frequency axis.
    pub(super) fn frequency_axis(&self) -> Axis {
        Axis::logarithmic(self.unit.axis_label())
            .showing(self.omega.map(|range| self.in_unit(range.min, range.max)))
    }

    fn in_unit(&self, from: f64, to: f64) -> Range {
        Range::new(self.unit.of_omega(from), self.unit.of_omega(to))
    }

    /// Returns the background of the band of comparison.
    fn band(&self, band: BandOfComparison) -> Band {
        let range = self.in_unit(band.min(), band.max());
        Band {
            range,
            color: BAND,
            key: "band of comparison".to_owned(),
        }
    }

    /// Returns the background of the frequencies above the band, where a model with leads is not
    /// valid.
    fn invalid(&self, band: BandOfComparison, up_to: f64) -> Band {
        let range = self.in_unit(band.max(), up_to);
        Band {
            range,
            color: INVALID,
            key: "not valid with leads".to_owned(),
        }
    }
}

/// Contents of the panels of one response.
pub(super) struct FrequencyPanels<'a> {
    pub(super) curves: &'a [BodeCurve],
    pub(super) references: &'a [ReferenceLine],
    pub(super) bands: &'a [BodeBand],
    /// Marked frequency ranges \[rad/s\].
    pub(super) strips: &'a [(f64, f64)],
    pub(super) options: &'a BodeOptions,
}

impl FrequencyPanels<'_> {
    /// Builds the panel of a pane with this vertical axis.
    pub(super) fn panel(&self, pane: Pane, axis: Axis) -> Panel {
        self.panel_of(pane, axis, |value| value)
    }

    /// Builds the panel of a pane with values transformed by `shown`.
    fn panel_of(&self, pane: Pane, axis: Axis, shown: impl Fn(f64) -> f64) -> Panel {
        let mut visible: Vec<&BodeCurve> =
            self.curves.iter().filter(|curve| !curve.hidden).collect();
        visible.sort_by_key(|curve| curve.role.layer(curve.rejected));
        // The curves of a plot mostly share their frequencies; the curves of the figure then share
        // them too.
        let mut last: Option<[Arc<[f64]>; 2]> = None;
        let mut in_unit = |omega: &Arc<[f64]>| match &last {
            Some([of, frequency]) if Arc::ptr_eq(of, omega) => Arc::clone(frequency),
            _ => {
                let frequency: Arc<[f64]> = omega
                    .iter()
                    .map(|omega| self.options.unit.of_omega(*omega))
                    .collect();
                last = Some([Arc::clone(omega), Arc::clone(&frequency)]);
                frequency
            }
        };
        let curves: Vec<Curve> = visible
            .iter()
            .map(|curve| {
                let values: Arc<[f64]> = curve
                    .values(pane)
                    .iter()
                    .map(|value| shown(*value))
                    .collect();
                let key = match curve.role {
                    Role::OfAirspeed(_) => curve.label.as_str(),
                    role => role.key(curve.rejected),
                };
                Curve::new(
                    &curve.label,
                    curve.role.stroke(curve.rejected),
                    in_unit(&curve.omega),
                    values,
                )
                .key(key)
            })
            .collect();
        let omega = self.curves.first().map_or(&[][..], |curve| &curve.omega);
        let references = self.references.iter().filter(|line| line.pane == pane);
        let references: Vec<Mark> = references
            .map(|line| reference_mark(line, omega, self.options.unit, &shown))
            .collect();
        let strips = self.strips.iter().map(|&(from, to)| Band {
            range: self.options.in_unit(from, to),
            color: NOTICED,
            key: "what is left would be noticed".to_owned(),
        });
        let bands = self
            .bands
            .iter()
            .map(|band| self.envelope(band, pane, &shown));
        let panel = Panel::new(self.options.frequency_axis(), axis)
            .with_all(strips)
            .with_all(bands);
        panel.with_all(curves).with_all(references)
    }

    fn envelope(&self, band: &BodeBand, pane: Pane, shown: &impl Fn(f64) -> f64) -> Envelope {
        let values = match pane {
            Pane::Magnitude => &band.magnitude_db,
            Pane::Phase => &band.phase_deg,
        };
        let frequencies = band
            .omega
            .iter()
            .map(|omega| self.options.unit.of_omega(*omega));
        let points = frequencies
            .zip(values)
            .map(|(x, [low, high])| [x, shown(*low), shown(*high)]);
        Envelope {
            name: "band of 95 %".to_owned(),
            color: UNCERTAIN,
            edge: None,
            points: points.collect(),
        }
    }
}

/// Draws a reference line: a rule if it is level and has a label, otherwise a curve over its own
/// frequencies or these \[rad/s\].
fn reference_mark(
    line: &ReferenceLine,
    omega: &[f64],
    unit: FrequencyUnit,
    shown: &impl Fn(f64) -> f64,
) -> Mark {
    let stroke = line.kind.line().printed();
    let points: Vec<[f64; 2]> = match &line.level {
        Level::Constant(value)
            if matches!(line.kind, ReferenceKind::Delta | ReferenceKind::Bound) =>
        {
            return Rule::horizontal(shown(*value), stroke)
                .label(&line.label)
                .into();
        }
        Level::Sampled(points) => points.clone(),
        level => omega
            .iter()
            .map(|omega| [*omega, level.at(*omega)])
            .collect(),
    };
    let points = points
        .iter()
        .map(|[omega, value]| [unit.of_omega(*omega), shown(*value)]);
    Curve::through(&line.label, stroke, points)
        .key(line.kind.key())
        .into()
}

/// Builds a figure with the plots of `pairs` side by side; a single pair gives the figure its
/// title.
pub(super) fn figure_of_pairs(
    source: &ConditionSource<'_>,
    pairs: &[Pair],
    what: &str,
    plot: impl Fn(Pair) -> Plot,
) -> Figure {
    let words = source.condition_words();
    let title = match (pairs, what) {
        ([pair], "") => format!("{} · {words}", source.dataset().pair_name(*pair)),
        ([pair], _) => format!("{what} of {} · {words}", source.dataset().pair_name(*pair)),
        (_, "") => words,
        _ => format!("{what} · {words}"),
    };
    side_by_side(source.dataset(), pairs, plot, title).caption(source.caption())
}

fn side_by_side(
    dataset: &gdcm_model::dataset::Dataset,
    pairs: &[Pair],
    plot: impl Fn(Pair) -> Plot,
    title: String,
) -> Figure {
    let is_one = pairs.len() == 1;
    let titled = |pair: &Pair| {
        let title = if is_one {
            String::new()
        } else {
            dataset.pair_name(*pair)
        };
        Plot {
            title,
            ..plot(*pair)
        }
    };
    let aspect = if is_one { 0.72 } else { 1.9 };
    Figure::new(title)
        .columns(5)
        .aspect(aspect)
        .shared_x()
        .plots(pairs.iter().map(titled))
}

/// Plots the responses `pairs` of one condition, magnitude above phase, of every model and of the
/// corrected ones.
pub fn bode_figure(source: &ConditionSource<'_>, pairs: &[Pair], options: &BodeOptions) -> Figure {
    figure_of_pairs(source, pairs, "", |pair| {
        let curves = source.response_curves(pair, options, &mut ResponseCache::default());
        let bands = uncertainty_bands(source.dataset(), pair, &curves);
        let ratio_unit = ConditionSource::ratio_unit(source.dataset(), pair);
        let unnoticed = muad_about(&curves, options);
        let plot = plot(
            (&curves, &bands, &unnoticed),
            source.study.settings.band,
            options,
            &ratio_unit,
        );
        let coherence = coherence_panel(source, pair, options);
        coherence.into_iter().fold(plot, |plot, panel| {
            plot.panel(panel.over(options.band(source.study.settings.band)))
        })
    })
}

fn plot(
    (curves, bands, references): (&[BodeCurve], &[BodeBand], &[ReferenceLine]),
    band: BandOfComparison,
    options: &BodeOptions,
    ratio_unit: &str,
) -> Plot {
    let visible: Vec<BodeCurve> = curves
        .iter()
        .filter(|curve| !curve.hidden)
        .cloned()
        .collect();
    // The cost of leads is drawn up to the last frequency of the curves without them (M15.6).
    let without_leads = visible
        .iter()
        .find(|curve| curve.role == Role::WithoutLeads);
    let invalid = without_leads.and_then(|curve| curve.omega.last().copied());
    let needed = |pane, least| {
        fitted_values(&visible, pane, (band.min(), invalid.unwrap_or(band.max())))
            .map(|range| range.with_margin(MARGIN, least))
    };
    let magnitude_db = options.values[0].or_else(|| needed(Pane::Magnitude, 4.0));
    let phase_deg = options.values[1].or_else(|| needed(Pane::Phase, 20.0));
    let panels = FrequencyPanels {
        curves,
        references,
        bands,
        strips: &[],
        options,
    };
    let magnitude = match options.magnitude {
        MagnitudeUnit::Decibel => panels.panel(
            Pane::Magnitude,
            Axis::linear("Magnitude [dB]").showing(magnitude_db),
        ),
        MagnitudeUnit::Ratio => {
            let ratio = magnitude_db.map(|db| Range::new(db_to_ratio(db.min), db_to_ratio(db.max)));
            let axis = Axis::logarithmic(format!("Magnitude [{ratio_unit}]")).showing(ratio);
            panels.panel_of(Pane::Magnitude, axis, db_to_ratio)
        }
    };
    let phase = panels.panel(Pane::Phase, Axis::degrees("Phase [deg]").showing(phase_deg));
    let on_ground = |panel: Panel| match invalid {
        Some(up_to) => panel
            .over(options.invalid(band, up_to))
            .over(options.band(band)),
        None => panel.over(options.band(band)),
    };
    let marked = |panel: Panel, is_named: bool| {
        let rules = options.crossings.iter().map(|(name, omega)| {
            let rule = Rule::vertical(options.unit.of_omega(*omega), CROSSING);
            if is_named { rule.label(*name) } else { rule }
        });
        panel.with_all(rules)
    };
    let magnitude = marked(magnitude, true);
    let phase = marked(phase, false);
    Plot::default()
        .panel(on_ground(magnitude).weight(MAGNITUDE_WEIGHT))
        .panel(on_ground(phase))
}

/// Plots the responses `pairs` of one model of every condition, magnitude above phase, from blue
/// for the slowest condition to amber for the fastest. `None` if no condition has such a model.
pub fn airspeeds_figure(
    analysis: &Analysis,
    pairs: &[Pair],
    role: AcrossRole,
    options: &BodeOptions,
) -> Option<Figure> {
    let dataset = &analysis.study.dataset;
    let settings = &analysis.study.settings;
    let job = AcrossJob::of(
        dataset,
        Some(analysis),
        role,
        (display_band(settings.band), CURVE_POINTS),
    );
    let curves = job
        .run(&mut (), &Unobserved)
        .ok()
        .filter(|curves| !curves.responses.is_empty())?;
    let curves = Arc::new(curves);
    let title = match pairs {
        [pair] => format!(
            "{} · every condition, {}",
            dataset.pair_name(*pair),
            role.name()
        ),
        _ => format!("Every condition, {}", role.name()),
    };
    let options = BodeOptions {
        unit: options.unit,
        omega: options.omega,
        values: options.values,
        ..BodeOptions::default()
    };
    let of_pair = |pair| {
        let made_of = (&**dataset, Some(analysis));
        let drawn = airspeed_curves(made_of, role, pair, &curves, &mut AirspeedCache::default());
        plot((&drawn, &[], &[]), settings.band, &options, "")
    };
    Some(side_by_side(dataset, pairs, of_pair, title).caption(settings_words(dataset, settings)))
}

/// Plots the magnitude of every response of one condition, outputs down, inputs across, with J
/// before and after the correction.
pub fn overview_figure(source: &ConditionSource<'_>, options: &BodeOptions) -> Figure {
    let dataset = source.dataset();
    let plots = dataset.on_axis().pairs().map(|pair| {
        let curves = source.response_curves(pair, options, &mut ResponseCache::default());
        let panels = FrequencyPanels {
            curves: &curves,
            references: &[],
            bands: &[],
            strips: &[],
            options,
        };
        let panel = panels.panel(
            Pane::Magnitude,
            Axis::linear("Magnitude [dB]").at_least(4.0),
        );
        let cost = source.analysis.and_then(|analysis| analysis.cost[pair]);
        let note = cost.map(|cost| {
            let text = format!(
                "J {:.0} → {:.0}",
                cost.uncorrected.total(),
                cost.corrected.total()
            );
            Note {
                at: Place::LowerLeft,
                text,
            }
        });
        let is_held = source
            .analysis
            .is_some_and(|analysis| analysis.held()[pair]);
        let held = if is_held { " *" } else { "" };
        let panel = panel
            .over(options.band(source.study.settings.band))
            .with_all(note);
        Plot::new(format!("{}{held}", dataset.pair_name(pair))).panel(panel)
    });
    let figure = Figure::new(source.condition_words())
        .caption(format!("{} * held exactly.", source.caption()))
        .plots(plots);
    figure
        .columns(dataset.inputs().len())
        .dense()
        .shared_x()
        .aspect(0.55)
}

/// Height of the strip, relative to 1 for the phase.
const WEIGHT: f64 = 0.45;
/// Line of the least trusted coherence.
const TRUSTED: Stroke = Stroke::dashed(Color::DIM, 0.8, Dash::Short);

/// Coherence of one measured response.
#[derive(Clone, Debug, PartialEq)]
pub struct CoherenceCurve {
    pub label: String,
    /// Determines the line style.
    pub role: Role,
    pub rejected: bool,
    /// Frequencies \[rad/s\] and coherence (0 to 1).
    pub points: Vec<[f64; 2]>,
}

impl ConditionSource<'_> {
    /// Returns the coherence of a response for every visible identified model measured with it; the
    /// representative comes last.
    pub fn coherence_curves(&self, pair: Pair, options: &BodeOptions) -> Vec<CoherenceCurve> {
        let bundle = self.curves.condition.bundle(BundleKind::Identified);
        let models = self
            .models(BundleKind::Identified, options)
            .into_iter()
            .filter(|model| !model.hidden);
        let curve = |model: super::condition_source::SourceModel| {
            let Dynamics::Measured(response) = &bundle[model.index].dynamics else {
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
        };
        let mut curves: Vec<CoherenceCurve> = models.filter_map(curve).collect();
        curves.sort_by_key(|curve| curve.role.layer(curve.rejected));
        curves
    }

    /// Returns the least coherence at which a frequency counts: from the settings, otherwise the
    /// default.
    pub fn least_coherence(&self) -> f64 {
        self.study
            .settings
            .coherence_threshold
            .unwrap_or(TRUSTED_COHERENCE)
    }
}

/// Builds the strip below a Bode plot; `None` if no response was measured with coherence.
pub(super) fn coherence_panel(
    source: &ConditionSource<'_>,
    pair: Pair,
    options: &BodeOptions,
) -> Option<Panel> {
    let curves = source.coherence_curves(pair, options);
    if curves.is_empty() {
        return None;
    }
    let curves = curves.into_iter().map(|curve| {
        let points = curve
            .points
            .iter()
            .map(|[omega, value]| [options.unit.of_omega(*omega), *value]);
        Curve::through(
            format!("coherence of {}", curve.label),
            curve.role.stroke(curve.rejected),
            points,
        )
    });
    let axis = Axis::linear("Coherence").showing(Some(Range::new(0.0, 1.05)));
    let trusted = Rule::horizontal(source.least_coherence(), TRUSTED);
    Some(
        Panel::new(options.frequency_axis(), axis)
            .with(trusted)
            .with_all(curves)
            .weight(WEIGHT),
    )
}
