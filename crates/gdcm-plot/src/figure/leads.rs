//! Each channel's delay and lead in a condition, up to ten times the band's upper end, with the
//! model's validity limit and the leads' price, the gain that they add above the band.

use gdcm_method::correction::lead_price::ABOVE_BAND;
use gdcm_method::correction::{Channel, ChannelCorrection, LeadPrice};
use gdcm_model::dataset::Pair;
use gdcm_model::response::GainDelay;
use gdcm_words::lead_price::{limit_text, pair_price_text};

use super::axis::{Axis, Range};
use super::condition_source::ConditionSource;
use super::drawing::{Color, Dash, Hue, Stroke};
use super::figure::{Figure, Panel, Plot};
use super::gains::all_channels;
use super::marks::{Curve, Rule, Strip};
use super::role::Role;

/// Number of points in each curve.
const POINTS: usize = 240;
/// Channels other than the response's input and output.
const OTHERS: Stroke = Stroke::solid(Color::new(Hue::Perturbed).tint(60), 0.8);
/// Output channel of the response.
const OUTPUT: Stroke = Stroke::dashed(Color::new(Hue::Accent), 1.6, Dash::Long);
/// Input channel of the response.
const INPUT: Stroke = Stroke::dashed(Color::new(Hue::Perturbed), 1.6, Dash::DashDot);
/// Line at the validity limit, the frequency above which a model with leads is invalid (M15.6).
const LIMIT: Stroke = Stroke::solid(Color::new(Hue::Warning), 1.2);
/// Background above the validity limit.
const BEYOND: Color = Color::new(Hue::Warning).tint(14);

/// Plots gain and phase of the delay or lead in each channel, without the channel gains k, up to
/// ten times the band's upper end: two plots in a row for each of `pairs`. The pair's two channels,
/// and their product, are emphasised.
pub fn leads_figure(source: &ConditionSource<'_>, pairs: &[Pair]) -> Figure {
    let title = format!("Leads · {}", source.condition_words());
    let caption = format!(
        "{} Effect of delay or lead in each channel, without the gains k; thin lines: other \
        channels.",
        source.caption()
    );
    let mut figure = Figure::new(title).caption(caption).columns(2).aspect(0.62);
    if let Some(analysis) = source.analysis {
        for &pair in pairs {
            let curves = PairLeads::new(source, &analysis.correction, pair);
            figure = figure.plots(curves.plots());
        }
    }
    figure
}

/// Delay or lead in a channel, or in two channels in series, as drawn.
struct LeadCurve {
    name: String,
    /// Text in the legend.
    key: String,
    stroke: Stroke,
    dynamics: GainDelay,
}

/// Delays and leads for a response.
struct PairLeads {
    pair: Pair,
    pair_name: String,
    /// Frequencies \[rad/s\].
    omega: Vec<f64>,
    /// Curves for the other channels, for input and output, and for both in series.
    curves: Vec<LeadCurve>,
    /// Gain that the leads add above the band; `None` without leads.
    price: Option<LeadPrice>,
}

impl PairLeads {
    fn new(source: &ConditionSource<'_>, correction: &ChannelCorrection, pair: Pair) -> Self {
        let dataset = source.dataset();
        let band = source.study.settings.band;
        let (inputs, outputs) = dataset.input_and_output_names();
        let pair_name = dataset.pair_name(pair);
        let [output, input] = Channel::of_pair(pair);
        let mut curves = Vec::new();
        for channel in all_channels(dataset) {
            if ![output, input].contains(&channel) {
                curves.push(LeadCurve {
                    name: channel.name(&inputs, &outputs),
                    key: "other channels".to_owned(),
                    stroke: OTHERS,
                    dynamics: dynamics(correction, &[channel]),
                });
            }
        }
        for (channel, stroke) in [(input, INPUT), (output, OUTPUT)] {
            let name = channel.name(&inputs, &outputs);
            curves.push(LeadCurve {
                key: name.clone(),
                name,
                stroke,
                dynamics: dynamics(correction, &[channel]),
            });
        }
        curves.push(LeadCurve {
            name: pair_name.clone(),
            key: format!("{pair_name}, both channels"),
            stroke: Role::Corrected.stroke(false),
            dynamics: dynamics(correction, &[output, input]),
        });
        Self {
            pair,
            pair_name,
            omega: frequencies(band.min(), ABOVE_BAND * band.max()),
            curves,
            price: correction.leads.as_ref().and_then(LeadPrice::new),
        }
    }

    /// Plots each curve's gain and phase.
    fn plots(&self) -> [Plot; 2] {
        let zeros = vec![0.0; self.omega.len()];
        let gain_axis = Axis::linear("Gain [dB]").including(0.0).at_least(3.0);
        let gain = self.panel(gain_axis, |dynamics| {
            dynamics.magnitudes_db(&zeros, &self.omega).collect()
        });
        let phase_axis = Axis::degrees("Phase [deg]").including(0.0).at_least(10.0);
        let phase = self.panel(phase_axis, |dynamics| {
            dynamics
                .phases(&zeros, &self.omega)
                .map(f64::to_degrees)
                .collect()
        });
        let name = &self.pair_name;
        [
            Plot::new(format!("{name}, gain of the leads{}", self.price_words())).panel(gain),
            Plot::new(format!("{name}, phase")).panel(phase),
        ]
    }

    /// Returns `: ` and the leads' price in the response; empty without leads, or if the price
    /// rounds to 0.
    fn price_words(&self) -> String {
        let price = self.price.as_ref();
        match price.and_then(|price| pair_price_text(price, self.pair)) {
            Some(words) => format!(": {words}"),
            None => String::new(),
        }
    }

    /// Builds a panel with a curve for each delay or lead; `values` computes the drawn values.
    fn panel(&self, y: Axis, values: impl Fn(GainDelay) -> Vec<f64>) -> Panel {
        let mut panel = Panel::new(Axis::logarithmic("Frequency [rad/s]"), y);
        for curve in &self.curves {
            let values = values(curve.dynamics);
            let drawn = Curve::new(&curve.name, curve.stroke, self.omega.clone(), values);
            panel = panel.with(drawn.key(&curve.key));
        }
        match &self.price {
            Some(price) => with_limit(panel, price),
            None => panel,
        }
    }
}

/// Returns the delay and the leads in one channel, or in two channels in series.
fn dynamics(correction: &ChannelCorrection, channels: &[Channel]) -> GainDelay {
    let delay_s: f64 = channels
        .iter()
        .map(|channel| correction.pure_delay_s(*channel))
        .sum();
    let first = channels.first();
    let second = channels.get(1);
    GainDelay::new(1.0, delay_s).with_leads([
        first.and_then(|channel| correction.lead(*channel)),
        second.and_then(|channel| correction.lead(*channel)),
    ])
}

/// Returns the panel with a shaded background above the validity limit, which has an entry in the
/// legend, and a line at the limit.
fn with_limit(panel: Panel, price: &LeadPrice) -> Panel {
    let beyond = Strip {
        range: Range::new(price.limit_rad_s, price.above_rad_s()),
        color: BEYOND,
        key: limit_text(price),
    };
    panel
        .with_ground(beyond)
        .with(Rule::vertical(price.limit_rad_s, LIMIT))
}

/// Returns logarithmically spaced frequencies \[rad/s\] from `min` to `max`, both included.
fn frequencies(min: f64, max: f64) -> Vec<f64> {
    let mut omega = Vec::new();
    for point in 0..POINTS {
        let part = point as f64 / (POINTS - 1) as f64;
        omega.push(min * (max / min).powf(part));
    }
    omega
}
