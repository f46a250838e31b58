//! What the fit sees of a response: how far it is from its reference, frequency by frequency (M6).

use std::sync::Arc;

use gdcm_core::dataset::{BundleKind, Pair};
use gdcm_core::fidelity::{CountedFrequencies, Mismatch, Muad};
use gdcm_core::response::{GainDelay, PolarCurve, quantile};
use gdcm_core::units::{ratio_to_db, s_to_ms};

use super::axis::{Axis, Range};
use super::bode::BodeOptions;
use super::condition_source::ConditionSource;
use super::drawing::{Color, Dash, Hue, Stroke};
use super::figure::{Figure, Panel, Plot};
use super::mark::{Curve, Mark, Rule};
use super::request::PhaseErrorUnit;
use super::role::Role;
use super::ticks::decimals;

const DELTA: Stroke = Stroke::dashed(Color::INK, 0.7, Dash::Dotted);
const BOUND: Stroke = Stroke::dashed(Color::of(Hue::Warning), 0.7, Dash::DashDot);
const QUANTILE: Stroke = Stroke::dashed(Color::DIM, 0.5, Dash::Short);
const MUAD: Stroke = Stroke::solid(Color::of(Hue::Good), 0.55);

impl PhaseErrorUnit {
    /// A difference of phases \[rad\] at `omega` as it is drawn.
    fn of(self, phase: f64, omega: f64) -> f64 {
        match self {
            Self::Degree => phase.to_degrees(),
            Self::Millisecond => s_to_ms(phase / omega),
        }
    }

    /// The delay \[s\] that a difference of phases as drawn is at `omega`.
    fn delay_s(self, drawn: f64, omega: f64) -> f64 {
        match self {
            Self::Degree => drawn.to_radians() / omega,
            Self::Millisecond => 1e-3 * drawn,
        }
    }

    fn axis(self) -> Axis {
        match self {
            Self::Degree => Axis::degrees("Δφ [deg]").including(0.0).at_least(5.0),
            Self::Millisecond => Axis::linear("Δφ/ω [ms]").including(0.0).at_least(5.0),
        }
    }
}

/// One model's error over the band.
struct ErrorLine {
    name: String,
    role: Role,
    /// `20 log10 |H_ref| / |H_sim|`.
    ratio_db: Arc<[f64]>,
    /// `Delta phi(H_sim, H_ref)`, or that over the frequency.
    phase: Arc<[f64]>,
}

/// What the fit sees of `pairs`: the error of every kept physics model, and of the representative before and after its
/// correction, with G, D and the bounds.
pub fn error_figure(source: &ConditionSource<'_>, pairs: &[Pair], options: &BodeOptions) -> Figure {
    let names: Vec<String> = pairs.iter().map(|pair| source.dataset().pair_name(*pair)).collect();
    let (title, aspect) = match &names[..] {
        [name] => (format!("Error of {name} · {}", source.condition_words()), 0.72),
        _ => (format!("Error · {}", source.condition_words()), 1.9),
    };
    let plots = pairs.iter().zip(&names).map(|(pair, name)| {
        let title = if names.len() == 1 { "" } else { name };
        plot(source, *pair, title, options)
    });
    Figure::new(title).caption(source.caption()).columns(5).aspect(aspect).shared_x().plots(plots)
}

fn plot(source: &ConditionSource<'_>, pair: Pair, title: &str, options: &BodeOptions) -> Plot {
    let omega = omega_in_band(source);
    let mut lines: Vec<ErrorLine> =
        errors(source, pair, &omega, options).into_iter().filter(|line| !options.hidden.contains(&line.role)).collect();
    lines.sort_by_key(|line| line.role.layer(false));
    let frequency: Arc<[f64]> = omega.iter().map(|omega| options.unit.of_omega(*omega)).collect();
    let curves = |of: fn(&ErrorLine) -> &Arc<[f64]>| -> Vec<Mark> {
        let curve = |line: &ErrorLine| {
            let values = Arc::clone(of(line));
            Curve::new(&line.name, line.role.stroke(false), Arc::clone(&frequency), values)
                .key(line.role.key(false))
                .into()
        };
        lines.iter().map(curve).collect()
    };
    let axis = || options.frequency_axis();
    let bounds = source.analysis.gain_bounds();
    let gain = source.analysis.wanted_gain(pair).map(|gain| {
        let label = format!("G {} ({} dB)", decimals(gain, 3), decimals(ratio_to_db(gain), 1));
        Rule::horizontal(ratio_to_db(gain), DELTA).label(label)
    });
    let bounds = [("LB", bounds.lower), ("UB", bounds.upper)].map(|(name, bound)| {
        Rule::horizontal(ratio_to_db(bound), BOUND).label(format!("{name} {}", decimals(bound, 3)))
    });
    let delay = source.analysis.wanted_delay_s(pair).map(|delay_s| {
        let values: Arc<[f64]> = omega.iter().map(|&at| options.phase_error.of(delay_s * at, at)).collect();
        let name = format!("D {} ms", decimals(s_to_ms(delay_s), 1));
        Curve::new(name.clone(), DELTA, Arc::clone(&frequency), values).key("delta gain, delta delay")
    });
    let mut references = quantile_lines(&lines, &omega, source.study.settings.quantile, options.phase_error);
    if options.shows_muad {
        references.extend(muad_lines(&omega, options.phase_error));
    }
    let ratio = Axis::linear("|ident.| / |model| [dB]").including(0.0).at_least(1.0);
    let ratio = ratio.showing(options.values[0]);
    let phase = options.phase_error.axis().showing(options.values[1]);
    Plot::new(title)
        .panel(
            Panel::new(axis(), ratio)
                .with_all(curves(|line| &line.ratio_db))
                .with_all(gain)
                .with_all(bounds)
                .with_all(references.iter().map(|reference| reference.mark(&frequency, |line| &line.ratio_db))),
        )
        .panel(
            Panel::new(axis(), phase)
                .with_all(curves(|line| &line.phase))
                .with_all(delay)
                .with_all(references.iter().map(|reference| reference.mark(&frequency, |line| &line.phase))),
        )
}

/// A line that errors are read against: a quantile, or the limit of what a pilot does not notice.
struct ReferenceLine {
    key: &'static str,
    stroke: Stroke,
    line: ErrorLine,
}

impl ReferenceLine {
    fn new(key: &'static str, name: String, stroke: Stroke, ratio_db: Arc<[f64]>, phase: Arc<[f64]>) -> Self {
        Self { key, stroke, line: ErrorLine { name, role: Role::IdentifiedRepresentative, ratio_db, phase } }
    }

    fn mark(&self, frequency: &Arc<[f64]>, of: fn(&ErrorLine) -> &Arc<[f64]>) -> Curve {
        Curve::new(&self.line.name, self.stroke, Arc::clone(frequency), Arc::clone(of(&self.line))).key(self.key)
    }
}

/// The quantiles of the representative's own error (M7 pools those of all on-axis responses).
fn quantile_lines(lines: &[ErrorLine], omega: &[f64], q: f64, unit: PhaseErrorUnit) -> Vec<ReferenceLine> {
    let represents = |line: &&ErrorLine| line.role == Role::Representative;
    // The nominal model keeps its role where it represents its bundle.
    let own = lines.iter().find(represents).or(lines.iter().find(|line| line.role == Role::Nominal));
    let Some(own) = own else { return Vec::new() };
    // There is no error at frequencies that do not count.
    let mut ratios_db: Vec<f64> = own.ratio_db.iter().copied().filter(|ratio| ratio.is_finite()).collect();
    let delays_s = own.phase.iter().zip(omega).map(|(phase, at)| unit.delay_s(*phase, *at));
    let mut delays_s: Vec<f64> = delays_s.filter(|delay| delay.is_finite()).collect();
    let line = |q: f64| {
        let ratio_db = quantile(&mut ratios_db, q);
        let delay_s = quantile(&mut delays_s, q);
        let phase = omega.iter().map(|at| unit.of(delay_s * at, *at)).collect();
        let ratio_db = vec![ratio_db; omega.len()].into();
        ReferenceLine::new("quantiles", format!("{:.0} % quantile", 100.0 * q), QUANTILE, ratio_db, phase)
    };
    [q, 1.0 - q].map(line).into()
}

/// The envelopes of unnoticeable added dynamics (MIL-STD-1797A); those of the magnitude stand mirrored, for its inverse is drawn.
fn muad_lines(omega: &[f64], unit: PhaseErrorUnit) -> [ReferenceLine; 2] {
    [(0, "lower"), (1, "upper")].map(|(end, word)| {
        let ratio_db = omega.iter().map(|at| -Muad::at(*at).magnitude_db[end]).collect();
        let phase = omega.iter().map(|at| unit.of(Muad::at(*at).phase_deg[end].to_radians(), *at)).collect();
        ReferenceLine::new("unnoticed within, MUAD", format!("{word} limit, MUAD"), MUAD, ratio_db, phase)
    })
}

fn omega_in_band(source: &ConditionSource<'_>) -> Vec<f64> {
    let band = source.study.settings.band;
    let range = Range::new(band.min(), band.max());
    source.curves.grid.omega().iter().copied().filter(|omega| range.contains(*omega)).collect()
}

/// The reference as the line at zero, every kept physics model, and the corrected ones.
fn errors(source: &ConditionSource<'_>, pair: Pair, omega: &[f64], options: &BodeOptions) -> Vec<ErrorLine> {
    let all = source.curves.grid.omega();
    let from = all.partition_point(|at| omega.first().is_some_and(|first| at < first));
    let polar = |kind, index: usize| {
        PolarCurve::of(source.curves.bundle(kind)[index].curve(pair).get(from..from + omega.len())?)
    };
    let Some(reference) = polar(BundleKind::Identified, source.reference()) else {
        return Vec::new();
    };
    // Of a reference measured with coherence the errors at frequencies that do not count are gaps (M4a).
    let flight = &source.curves.condition.bundle(BundleKind::Identified)[source.reference()].dynamics;
    let counted = CountedFrequencies::of_model(flight, omega, source.study.settings.coherence_threshold);
    let line = |name: String, role: Role, model: usize, correction: GainDelay| {
        let mismatch = Mismatch::new(&polar(BundleKind::Physics, model)?, &reference);
        let mismatch = mismatch.counting(counted.as_ref().map(|counted| &counted[pair]))?;
        // On the branch of the model as it is (M6b), which a correction leaves it on.
        let phase = mismatch.on_grid(mismatch.phase_difference(omega), omega.len());
        let mismatch_db = mismatch.on_grid(mismatch.magnitude_db.clone(), omega.len());
        Some(ErrorLine {
            name,
            role,
            ratio_db: correction.magnitudes_db(&mismatch_db, omega).map(|db| -db).collect(),
            phase: correction
                .phases(&phase, omega)
                .zip(omega)
                .map(|(by, at)| options.phase_error.of(by, *at))
                .collect(),
        })
    };
    let zero: Arc<[f64]> = vec![0.0; omega.len()].into();
    let name = source.analysis.representative_name(BundleKind::Identified).to_owned();
    let role = Role::IdentifiedRepresentative;
    let mut lines = vec![ErrorLine { name, role, ratio_db: Arc::clone(&zero), phase: zero }];
    let kept =
        source.models(BundleKind::Physics).into_iter().filter(|model| !model.rejected && options.shows_model(model));
    lines.extend(kept.filter_map(|of| line(of.id.name, of.role, of.index, GainDelay::NONE)));
    let corrected = source.corrected_models(pair).into_iter();
    lines.extend(corrected.filter_map(|of| line(of.name, of.role, of.model, of.correction)));
    lines
}
