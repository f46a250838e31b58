//! Signed delays of the channels, with the filters of those below zero (M15).

use std::sync::{Arc, OnceLock};

use crate::dataset::Pair;
use crate::response::LeadFilter;

use super::channel::Channel;
use super::lead_design::LeadDesign;

/// One signed delay for each channel: a pure delay where positive, a lead filter where negative (M15.5).
///
/// Filters, and their curves over the band, are computed when they are first asked for, once for all clones.
#[derive(Clone, Debug)]
pub struct ChannelLeads {
    design: Arc<LeadDesign>,
    inputs_s: Vec<f64>,
    outputs_s: Vec<f64>,
    filters: Arc<OnceLock<[Vec<Option<LeadFilter>>; 2]>>,
    curves: Arc<OnceLock<LeadCurves>>,
}

impl PartialEq for ChannelLeads {
    /// What is computed of them follows.
    fn eq(&self, other: &Self) -> bool {
        (&self.inputs_s, &self.outputs_s, &self.design) == (&other.inputs_s, &other.outputs_s, &other.design)
    }
}

impl ChannelLeads {
    /// Signed delays \[s\] of m inputs and p outputs, with the filters of `design`.
    pub fn new(design: Arc<LeadDesign>, inputs_s: Vec<f64>, outputs_s: Vec<f64>) -> Self {
        Self { design, inputs_s, outputs_s, filters: Arc::default(), curves: Arc::default() }
    }

    /// Which filter a signed delay has.
    pub fn design(&self) -> &Arc<LeadDesign> {
        &self.design
    }

    /// Signed delay of each input \[s\], m values.
    pub fn inputs_s(&self) -> &[f64] {
        &self.inputs_s
    }

    /// Signed delay of each output \[s\], p values.
    pub fn outputs_s(&self) -> &[f64] {
        &self.outputs_s
    }

    /// Signed delay of a channel \[s\].
    pub fn tau_s(&self, channel: Channel) -> f64 {
        match channel {
            Channel::Input(input) => self.inputs_s[input],
            Channel::Output(output) => self.outputs_s[output],
        }
    }

    /// The lead filters of every input and of every output; none where the signed delay is not negative.
    pub fn filters(&self) -> &[Vec<Option<LeadFilter>>; 2] {
        self.filters.get_or_init(|| {
            let of = |taus_s: &Vec<f64>| taus_s.iter().map(|&tau_s| self.design.filter(tau_s)).collect();
            [&self.inputs_s, &self.outputs_s].map(of)
        })
    }

    /// The lead filter of a channel; none where its signed delay is not negative.
    pub fn filter(&self, channel: Channel) -> Option<LeadFilter> {
        match (channel, self.filters()) {
            (Channel::Input(input), [inputs, _]) => inputs[input],
            (Channel::Output(output), [_, outputs]) => outputs[output],
        }
    }

    /// The part of each signed delay that is a pure delay \[s\]: of the inputs, of the outputs.
    pub fn delays_s(&self) -> [Vec<f64>; 2] {
        [&self.inputs_s, &self.outputs_s].map(|taus_s| taus_s.iter().map(|tau_s| tau_s.max(0.0)).collect())
    }

    /// What the filters are at each frequency of the design's band.
    pub fn curves(&self) -> &LeadCurves {
        self.curves.get_or_init(|| {
            let curve = |filter: &Option<LeadFilter>| filter.map(|filter| LeadCurve::of(filter, self.design.omega()));
            let [inputs, outputs] =
                self.filters().each_ref().map(|filters| filters.iter().map(curve).collect::<Vec<_>>());
            LeadCurves { inputs, outputs }
        })
    }
}

/// Magnitude and phase of every channel's lead filter at the frequencies of a band.
#[derive(Clone, Debug)]
pub struct LeadCurves {
    inputs: Vec<Option<LeadCurve>>,
    outputs: Vec<Option<LeadCurve>>,
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

impl LeadCurves {
    /// What the filters of a response's two channels do to it; nothing where neither has one.
    pub fn on(&self, pair: Pair) -> Option<LeadCurve> {
        match (&self.inputs[pair.input], &self.outputs[pair.output]) {
            (Some(input), Some(output)) => Some(input.in_series(output)),
            (one, other) => one.as_ref().or(other.as_ref()).cloned(),
        }
    }
}
