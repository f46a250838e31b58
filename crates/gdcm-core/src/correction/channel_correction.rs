//! One gain and one delay or lead for each channel (M10, M11, M15), what they make of a response, and a channel as states.

use std::sync::{Arc, OnceLock};

use nalgebra::{DMatrix, DVector, RowDVector};

use super::{Channel, Channels, LeadDesign};
use crate::dataset::Pair;
use crate::response::{GainDelay, LeadFilter, LeadOrder};

/// The correction `M_O H M_I`, each channel `k e^(-tau s)`, eq. (12), or `k L(s)` (M15).
#[derive(Clone, Debug, PartialEq)]
pub struct ChannelCorrection {
    /// Gain of each input channel, m values.
    pub input_gains: Vec<f64>,
    /// Gain of each output channel, p values.
    pub output_gains: Vec<f64>,
    /// Delay of each input channel \[s\], m values.
    pub input_delays_s: Vec<f64>,
    /// Delay of each output channel \[s\], p values.
    pub output_delays_s: Vec<f64>,
    /// Signed delays, of which the delays above are the positive part, and the filters of the negative ones; none where leads are
    /// not asked for (M15).
    pub leads: Option<ChannelLeads>,
}

impl ChannelCorrection {
    /// These gains with these delays \[s\].
    pub fn of_delays(gains: Channels<f64>, delays_s: Channels<f64>) -> Self {
        Self {
            input_gains: gains.inputs,
            output_gains: gains.outputs,
            input_delays_s: delays_s.inputs,
            output_delays_s: delays_s.outputs,
            leads: None,
        }
    }

    /// These gains with signed delays (M15).
    pub fn of_leads(gains: Channels<f64>, leads: ChannelLeads) -> Self {
        let delays_s = leads.delays_s();
        Self { leads: Some(leads), ..Self::of_delays(gains, delays_s) }
    }

    /// Net gain of a response, `k_o k_i` (M11).
    pub fn net_gain(&self, pair: Pair) -> f64 {
        self.output_gains[pair.output] * self.input_gains[pair.input]
    }

    /// Net delay of a response, `tau_o + tau_i` \[s\]; a negative one is a lead (M15).
    pub fn net_delay_s(&self, pair: Pair) -> f64 {
        let [output_s, input_s] = Channel::of(pair).map(|channel| self.delay_s(channel));
        output_s + input_s
    }

    /// Gain of a channel.
    pub fn gain(&self, channel: Channel) -> f64 {
        match channel {
            Channel::Input(input) => self.input_gains[input],
            Channel::Output(output) => self.output_gains[output],
        }
    }

    /// Delay of a channel \[s\]; a negative one is a lead (M15).
    pub fn delay_s(&self, channel: Channel) -> f64 {
        self.leads.as_ref().map_or_else(|| self.pure_delay_s(channel), |leads| leads.taus_s[channel])
    }

    /// Delay of a channel without its lead \[s\].
    pub fn pure_delay_s(&self, channel: Channel) -> f64 {
        match channel {
            Channel::Input(input) => self.input_delays_s[input],
            Channel::Output(output) => self.output_delays_s[output],
        }
    }

    /// Delay of each channel \[s\]; a negative one is a lead (M15).
    pub fn signed_delays_s(&self) -> Channels<f64> {
        self.channels(|channel| self.delay_s(channel))
    }

    /// What `of` says of each channel.
    pub fn channels<T>(&self, of: impl FnMut(Channel) -> T) -> Channels<T> {
        Channels::from_fn(self.input_gains.len(), self.output_gains.len(), of)
    }

    /// The lead filter of a channel, where it has one (M15).
    pub fn lead(&self, channel: Channel) -> Option<LeadFilter> {
        self.leads.as_ref()?.filters()[channel]
    }

    /// The same without its lead filters: its gains and what is positive of its delays.
    pub fn without_leads(self) -> Self {
        Self { leads: None, ..self }
    }

    /// What the correction multiplies a response by; `None` where its net gain is not positive (a schedule of `k` itself can give
    /// that).
    pub fn on(&self, pair: Pair) -> Option<GainDelay> {
        let leads = Channel::of(pair).map(|channel| self.lead(channel));
        Some(self.without_leads_on(pair)?.led(leads))
    }

    /// As [`ChannelCorrection::on`], without the lead filters: what is left to do where those have done their part.
    pub fn without_leads_on(&self, pair: Pair) -> Option<GainDelay> {
        let gain = self.net_gain(pair);
        let delay_s = self.output_delays_s[pair.output] + self.input_delays_s[pair.input];
        (gain > 0.0).then(|| GainDelay::new(gain, delay_s))
    }
}

/// One signed delay for each channel: a pure delay where positive, a lead filter where negative (M15.5).
///
/// Filters, and their curves over the band, are computed when they are first asked for, once for all clones.
#[derive(Clone, Debug)]
pub struct ChannelLeads {
    /// Which filter a signed delay has.
    pub design: Arc<LeadDesign>,
    /// Signed delay of each channel \[s\].
    pub taus_s: Channels<f64>,
    filters: Arc<OnceLock<Channels<Option<LeadFilter>>>>,
    curves: Arc<OnceLock<Channels<Option<LeadCurve>>>>,
}

impl PartialEq for ChannelLeads {
    /// What is computed of them follows.
    fn eq(&self, other: &Self) -> bool {
        (&self.taus_s, &self.design) == (&other.taus_s, &other.design)
    }
}

impl ChannelLeads {
    /// Signed delays \[s\] with the filters of `design`.
    pub fn new(design: Arc<LeadDesign>, taus_s: Channels<f64>) -> Self {
        Self { design, taus_s, filters: Arc::default(), curves: Arc::default() }
    }

    /// The lead filter of each channel; none where its signed delay is not negative.
    pub fn filters(&self) -> &Channels<Option<LeadFilter>> {
        self.filters.get_or_init(|| self.taus_s.map(|_, &tau_s| self.design.filter(tau_s)))
    }

    /// The part of each signed delay that is a pure delay \[s\].
    pub fn delays_s(&self) -> Channels<f64> {
        self.taus_s.map(|_, tau_s| tau_s.max(0.0))
    }

    /// What the filters of a response's two channels do to it at each frequency of the design's band; nothing where neither has one.
    pub fn curve(&self, pair: Pair) -> Option<LeadCurve> {
        let of_filter = |filter: LeadFilter| LeadCurve::of(filter, self.design.omega());
        let curves = self.curves.get_or_init(|| self.filters().map(|_, filter| filter.map(of_filter)));
        match (&curves.inputs[pair.input], &curves.outputs[pair.output]) {
            (Some(input), Some(output)) => Some(input.in_series(output)),
            (one, other) => one.as_ref().or(other.as_ref()).cloned(),
        }
    }
}

/// Magnitude \[dB\] and phase \[rad\] of a filter or of two in series.
#[derive(Clone, Debug)]
pub struct LeadCurve {
    /// `20 log10 |L|` at each frequency.
    pub magnitude_db: Vec<f64>,
    /// `arg L` at each frequency, continuous.
    pub phase: Vec<f64>,
}

impl LeadCurve {
    fn of(filter: LeadFilter, omega: &[f64]) -> Self {
        Self {
            magnitude_db: omega.iter().map(|&omega| filter.magnitude_db(omega)).collect(),
            phase: omega.iter().map(|&omega| filter.phase(omega)).collect(),
        }
    }

    fn in_series(&self, other: &Self) -> Self {
        let sum = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a + b).collect();
        Self { magnitude_db: sum(&self.magnitude_db, &other.magnitude_db), phase: sum(&self.phase, &other.phase) }
    }
}

/// A delay or a lead filter of one channel as a state-space model of one input and one output.
#[derive(Clone, Debug, PartialEq)]
pub struct ChannelModel {
    /// System matrix, n x n.
    pub a: DMatrix<f64>,
    /// Input column, n values.
    pub b: DVector<f64>,
    /// Output row, n values.
    pub c: RowDVector<f64>,
    /// Feed-through.
    pub d: f64,
}

impl ChannelModel {
    /// No delay: `y = u`, without states.
    pub fn none() -> Self {
        Self { a: DMatrix::zeros(0, 0), b: DVector::zeros(0), c: RowDVector::zeros(0), d: 1.0 }
    }

    /// `z^-count`, exactly: `count` states, each of which holds the one before it for one sample.
    pub fn samples(count: usize) -> Self {
        if count == 0 {
            return Self::none();
        }
        let one_at = |at: usize| move |index: usize| if index == at { 1.0 } else { 0.0 };
        Self {
            a: DMatrix::from_fn(count, count, |row, column| if row == column + 1 { 1.0 } else { 0.0 }),
            b: DVector::from_fn(count, |row, _| one_at(0)(row)),
            c: RowDVector::from_fn(count, |_, column| one_at(count - 1)(column)),
            d: 0.0,
        }
    }

    /// A lead filter in continuous time, exactly (M15.3): with `w1 = 1 / a`, `w2 = 1 / b` of second order `A = [0 1; -w2^2 -sqrt(2)
    /// w2]`, `B = [0; 1]`, `C = [R (w1^2 - w2^2)  R sqrt(2) (w1 - w2)]`, `D = R`, of first order `A = -w2`, `B = 1`, `C = R (w1 -
    /// w2)`, `D = R`.
    pub fn lead(filter: LeadFilter) -> Self {
        const ROOT: f64 = std::f64::consts::SQRT_2;
        let (w1, w2, r) = (filter.zero_rad_s(), filter.lag_rad_s(), filter.gain_at_infinity());
        match filter.order() {
            LeadOrder::First => Self {
                a: DMatrix::from_element(1, 1, -w2),
                b: DVector::from_element(1, 1.0),
                c: RowDVector::from_element(1, r * (w1 - w2)),
                d: r,
            },
            LeadOrder::Second => Self {
                a: DMatrix::from_row_slice(2, 2, &[0.0, 1.0, -w2 * w2, -ROOT * w2]),
                b: DVector::from_column_slice(&[0.0, 1.0]),
                c: RowDVector::from_row_slice(&[r * (w1 * w1 - w2 * w2), r * ROOT * (w1 - w2)]),
                d: r,
            },
        }
    }

    /// The lead filter in discrete time of this sample time \[s\], by Tustin's rule `s = 2 (z - 1) / (T (z + 1))`: with `M = (I - A
    /// T/2)^-1` it is `M (I + A T/2)`, `T M B`, `C M`, `D + C M B T/2`. None where `T` puts a pole of the filter on that of the rule.
    pub fn sampled_lead(filter: LeadFilter, sample_time_s: f64) -> Option<Self> {
        let Self { a, b, c, d } = Self::lead(filter);
        let (one, half) = (DMatrix::identity(a.nrows(), a.nrows()), 0.5 * sample_time_s * &a);
        let inverse = (&one - &half).try_inverse()?;
        let direct = (&c * &inverse * &b).sum() * 0.5 * sample_time_s;
        Some(Self { a: &inverse * (&one + &half), b: sample_time_s * &inverse * b, c: &c * inverse, d: d + direct })
    }

    /// Number of states.
    pub fn order(&self) -> usize {
        self.b.len()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn samples_come_out_as_many_steps_later() {
        for count in 0..4 {
            let model = ChannelModel::samples(count);
            assert_eq!(model.order(), count);
            let mut x = DVector::zeros(count);
            let mut out = Vec::new();
            for u in [1.0, 2.0, 3.0, 4.0, 5.0] {
                out.push((&model.c * &x).sum() + model.d * u);
                x = &model.a * &x + &model.b * u;
            }
            let delayed: Vec<f64> = [0.0, 0.0, 0.0, 1.0, 2.0, 3.0, 4.0, 5.0][3 - count..][..5].to_vec();
            assert_eq!(out, delayed, "{count} samples");
        }
    }
}
