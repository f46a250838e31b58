//! Panels over frequency, and figures with a plot for each response.
//!
//! MUAD: maximum unnoticeable added dynamics (MIL-STD-1797A), whose envelopes are in `muad.rs`.

use std::sync::Arc;

use gdcm_model::dataset::{Dataset, Pair};

use super::axis::{Axis, FrequencyUnit};
use super::bode_curve::{BodeCurve, Pane};
use super::bode_options::BodeOptions;
use super::condition_source::ConditionSource;
use super::drawing::{Color, Hue};
use super::figure::{Figure, Panel, Plot};
use super::marks::{Curve, Envelope, Mark, Rule, Strip};
use super::reference_line::{Level, ReferenceKind, ReferenceLine};
use super::responses::BodeBand;
use super::role::Role;

/// Background at frequencies where a pilot would notice the remaining mismatch (MUAD).
const NOTICED: Color = Color::new(Hue::Warning).tint(20);
/// Confidence band about an identified model.
const UNCERTAIN: Color = Color::new(Hue::Identified).tint(22);
/// Ratio of frame height to width in a figure with a single plot.
const SINGLE_ASPECT: f64 = 0.72;
/// Ratio of frame height to width in a figure with several plots.
const SHARED_ASPECT: f64 = 1.9;

/// Contents of a response's panels.
pub(super) struct FrequencyPanels<'a> {
    pub(super) curves: &'a [BodeCurve],
    pub(super) references: &'a [ReferenceLine],
    pub(super) uncertainty_bands: &'a [BodeBand],
    /// Frequency ranges in which a pilot would notice the remaining mismatch \[rad/s\].
    pub(super) noticed: &'a [(f64, f64)],
    pub(super) options: &'a BodeOptions,
}

impl FrequencyPanels<'_> {
    /// Builds the magnitude or the phase panel with this vertical axis.
    pub(super) fn panel(&self, pane: Pane, axis: Axis) -> Panel {
        self.converted_panel(pane, axis, |value| value)
    }

    /// Builds a panel; `convert` converts its values to the unit of the vertical axis.
    pub(super) fn converted_panel(&self, pane: Pane, axis: Axis, convert: fn(f64) -> f64) -> Panel {
        let noticed = self.noticed.iter().map(|&(from, to)| Strip {
            range: self.options.in_unit(from, to),
            color: NOTICED,
            key: "noticeable error (outside MUAD)".to_owned(),
        });
        let envelopes = self
            .uncertainty_bands
            .iter()
            .map(|band| self.envelope(band, pane, convert));
        Panel::new(self.options.frequency_axis(), axis)
            .with_all(noticed)
            .with_all(envelopes)
            .with_all(self.visible_curves(pane, convert))
            .with_all(self.reference_marks(pane, convert))
    }

    /// Returns the visible curves in drawing order, the most important curve last.
    fn visible_curves(&self, pane: Pane, convert: fn(f64) -> f64) -> Vec<Curve> {
        let mut visible: Vec<&BodeCurve> =
            self.curves.iter().filter(|curve| !curve.hidden).collect();
        visible.sort_by_key(|curve| curve.role.layer(curve.rejected));
        let mut frequencies = SharedFrequencies::default();
        let mut drawn = Vec::new();
        for curve in visible {
            let x = frequencies.in_unit(&curve.omega, self.options.unit);
            let y: Vec<f64> = curve
                .values(pane)
                .iter()
                .map(|value| convert(*value))
                .collect();
            let key = match curve.role {
                Role::OfAirspeed(..) => airspeed_key(&curve.label),
                role => role.key(curve.rejected),
            };
            let stroke = curve.role.stroke(curve.rejected);
            drawn.push(Curve::new(&curve.label, stroke, x, y).key(key));
        }
        drawn
    }

    /// Returns a panel's reference lines. A line without its own frequencies uses those of the
    /// first curve.
    fn reference_marks(&self, pane: Pane, convert: fn(f64) -> f64) -> Vec<Mark> {
        let omega: &[f64] = match self.curves.first() {
            Some(curve) => &curve.omega,
            None => &[],
        };
        self.references
            .iter()
            .filter(|line| line.pane == pane)
            .map(|line| reference_mark(line, omega, self.options.unit, convert))
            .collect()
    }

    /// Returns the shaded area between the two lines of an uncertainty band.
    fn envelope(&self, band: &BodeBand, pane: Pane, convert: fn(f64) -> f64) -> Envelope {
        let values = match pane {
            Pane::Magnitude => &band.magnitude_db,
            Pane::Phase => &band.phase_deg,
        };
        let mut points = Vec::new();
        for (omega, [low, high]) in band.omega.iter().zip(values) {
            let x = self.options.unit.of_omega(*omega);
            points.push([x, convert(*low), convert(*high)]);
        }
        Envelope {
            name: "95 % band".to_owned(),
            color: UNCERTAIN,
            edge: None,
            points,
        }
    }
}

/// Returns the legend text for a curve labelled "condition 3 · 45 kt, scheduled": without the
/// condition, so that conditions at the same airspeed share an entry.
fn airspeed_key(label: &str) -> &str {
    match label.split_once(" · ") {
        Some((_, key)) => key,
        None => label,
    }
}

/// Caches the previous curve's frequencies in the displayed unit; curves that share their
/// frequencies also share the converted values.
#[derive(Default)]
struct SharedFrequencies {
    omega: Arc<[f64]>,
    converted: Arc<[f64]>,
}

impl SharedFrequencies {
    /// Converts frequencies \[rad/s\] to `unit`, which must be the same in every call.
    fn in_unit(&mut self, omega: &Arc<[f64]>, unit: FrequencyUnit) -> Arc<[f64]> {
        if !Arc::ptr_eq(&self.omega, omega) {
            self.omega = Arc::clone(omega);
            self.converted = omega.iter().map(|omega| unit.of_omega(*omega)).collect();
        }
        Arc::clone(&self.converted)
    }
}

/// Draws a reference line: a labelled straight line for a constant target or bound, otherwise a
/// curve over its own frequencies or over `omega` \[rad/s\].
fn reference_mark(
    line: &ReferenceLine,
    omega: &[f64],
    unit: FrequencyUnit,
    convert: fn(f64) -> f64,
) -> Mark {
    let stroke = line.kind.line().printed();
    if let Level::Constant(value) = line.level
        && matches!(line.kind, ReferenceKind::Delta | ReferenceKind::Bound)
    {
        return Rule::horizontal(convert(value), stroke)
            .label(&line.label)
            .into();
    }
    let points: Vec<[f64; 2]> = match &line.level {
        Level::Sampled(points) => points.clone(),
        level => omega
            .iter()
            .map(|omega| [*omega, level.at(*omega)])
            .collect(),
    };
    let points = points
        .iter()
        .map(|[omega, value]| [unit.of_omega(*omega), convert(*value)]);
    Curve::through(&line.label, stroke, points)
        .key(line.kind.key())
        .into()
}

/// Builds a condition's figure with a plot for each pair, side by side. The title consists of
/// `subject` (if any), the pair (if there is only one), and the condition.
pub(super) fn figure_of_pairs(
    source: &ConditionSource<'_>,
    pairs: &[Pair],
    subject: Option<&str>,
    plot: impl Fn(Pair) -> Plot,
) -> Figure {
    let condition = source.condition_words();
    let single_name = match pairs {
        [pair] => Some(source.dataset().pair_name(*pair)),
        _ => None,
    };
    let title = match (subject, single_name) {
        (None, None) => condition,
        (None, Some(name)) => format!("{name} · {condition}"),
        (Some(subject), None) => format!("{subject} · {condition}"),
        (Some(subject), Some(name)) => format!("{subject} of {name} · {condition}"),
    };
    side_by_side(source.dataset(), pairs, title, plot).caption(source.caption())
}

/// Builds a figure with a plot for each pair, side by side. A single plot has no title and a lower
/// height.
pub(super) fn side_by_side(
    dataset: &Dataset,
    pairs: &[Pair],
    title: String,
    plot: impl Fn(Pair) -> Plot,
) -> Figure {
    let is_single = pairs.len() == 1;
    let mut plots = Vec::new();
    for &pair in pairs {
        let mut plot = plot(pair);
        plot.title = if is_single {
            String::new()
        } else {
            dataset.pair_name(pair)
        };
        plots.push(plot);
    }
    let aspect = if is_single {
        SINGLE_ASPECT
    } else {
        SHARED_ASPECT
    };
    Figure::new(title)
        .columns(5)
        .aspect(aspect)
        .shared_x()
        .plots(plots)
}
