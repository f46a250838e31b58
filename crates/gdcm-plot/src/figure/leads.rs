//! Delays and leads in each channel of one condition, up to ten times the band: the limit of the
//! model's validity, and the cost of leads.

use gdcm_method::correction::lead_price::ABOVE_BAND;
use gdcm_method::correction::{Channel, ChannelCorrection, LeadPrice};
use gdcm_model::dataset::Pair;
use gdcm_model::response::GainDelay;

use super::axis::{Axis, Range};
use super::condition_source::ConditionSource;
use super::drawing::{Color, Dash, Hue, Stroke};
use super::figure::{Band, Curve, Figure, Panel, Plot, Rule};
use super::gains::all_channels;
use super::role::Role;

/// Points of a curve.
const POINTS: usize = 240;
const OTHERS: Stroke = Stroke::solid(Color::of(Hue::Perturbed).tint(60), 0.8);
const OF_OUTPUT: Stroke = Stroke::dashed(Color::of(Hue::Accent), 1.6, Dash::Long);
const OF_INPUT: Stroke = Stroke::dashed(Color::of(Hue::Perturbed), 1.6, Dash::DashDot);
const LIMIT: Stroke = Stroke::solid(Color::of(Hue::Warning), 1.2);

/// Plots gain and phase of the delay or lead of each channel, without the gains k, from the band to
/// ten times its top; the channels of `pairs` and their combined effect on the response are
/// emphasised. One row of two plots for each response.
pub fn leads_figure(source: &ConditionSource<'_>, pairs: &[Pair]) -> Figure {
    let title = format!("Leads · {}", source.condition_words());
    let caption = format!(
        "{} What delay or lead adds to each channel, without the gains k; thin: the other channels.",
        source.caption()
    );
    let figure = Figure::new(title).caption(caption).columns(2).aspect(0.62);
    let Some(analysis) = source.analysis else {
        return figure;
    };
    let rows = pairs
        .iter()
        .flat_map(|&pair| plots(source, &analysis.correction, pair));
    figure.plots(rows)
}

/// Plots gain and phase of one response's channels, with those of the other channels behind them.
fn plots(source: &ConditionSource<'_>, correction: &ChannelCorrection, pair: Pair) -> [Plot; 2] {
    let dataset = source.dataset();
    let band = source.study.settings.band;
    let (inputs, outputs) = dataset.names_of_channels();
    let omega = frequencies(band.min(), ABOVE_BAND * band.max());
    let [output, input] = Channel::of(pair);
    let of = |channels: &[Channel]| {
        let lead = |at: usize| {
            channels
                .get(at)
                .and_then(|channel| correction.lead(*channel))
        };
        let delay_s: f64 = channels
            .iter()
            .map(|channel| correction.pure_delay_s(*channel))
            .sum();
        GainDelay::new(1.0, delay_s).led([lead(0), lead(1)])
    };
    let others = all_channels(dataset)
        .into_iter()
        .filter(|channel| ![output, input].contains(channel));
    let others = others.map(|channel| {
        (
            channel.name(&inputs, &outputs),
            "other channels".to_owned(),
            OTHERS,
            vec![channel],
        )
    });
    let focus = [(input, OF_INPUT), (output, OF_OUTPUT)].map(|(channel, stroke)| {
        let name = channel.name(&inputs, &outputs);
        (name.clone(), name, stroke, vec![channel])
    });
    let name = dataset.pair_name(pair);
    let both = (
        name.clone(),
        format!("{name}, both"),
        Role::Corrected.stroke(false),
        vec![output, input],
    );
    let drawn: Vec<_> = others
        .chain(focus)
        .chain([both])
        .map(|(name, key, stroke, channels)| (name, key, stroke, of(&channels)))
        .collect();
    let price = correction.leads.as_ref().and_then(LeadPrice::of);
    let zeros = vec![0.0; omega.len()];
    let panel = |y: Axis, values: &dyn Fn(GainDelay) -> Vec<f64>| {
        let curves = drawn.iter().map(|(name, key, stroke, dynamics)| {
            Curve::new(name, *stroke, omega.clone(), values(*dynamics)).key(key)
        });
        let panel = Panel::new(Axis::logarithmic("Frequency [rad/s]"), y).with_all(curves);
        price.iter().fold(panel, beyond)
    };
    let gain = panel(
        Axis::linear("Gain [dB]").including(0.0).at_least(3.0),
        &|dynamics| dynamics.magnitudes_db(&zeros, &omega).collect(),
    );
    let phase = panel(
        Axis::degrees("Phase [deg]").including(0.0).at_least(10.0),
        &|dynamics| {
            dynamics
                .phases(&zeros, &omega)
                .map(f64::to_degrees)
                .collect()
        },
    );
    let price = price.as_ref().and_then(|price| price.pair_words(pair));
    let price = price.map(|words| format!(": {words}")).unwrap_or_default();
    [
        Plot::new(format!("{name}, gain of the leads{price}")).panel(gain),
        Plot::new(format!("{name}, phase")).panel(phase),
    ]
}

/// Adds the background of the range beyond the band, with an entry in the legend, and the line at
/// which it begins.
fn beyond(panel: Panel, price: &LeadPrice) -> Panel {
    let range = Range::new(price.limit_rad_s, price.above_rad_s());
    let ground = Band {
        range,
        color: Color::of(Hue::Warning).tint(14),
        key: price.limit_words(),
    };
    panel
        .over(ground)
        .with(Rule::vertical(price.limit_rad_s, LIMIT))
}

/// Returns logarithmically spaced frequencies \[rad/s\] between two limits, both included.
fn frequencies(min: f64, max: f64) -> Vec<f64> {
    let part = |point: usize| point as f64 / (POINTS - 1) as f64;
    (0..POINTS)
        .map(|point| min * (max / min).powf(part(point)))
        .collect()
}
