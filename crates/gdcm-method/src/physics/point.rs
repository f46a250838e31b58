//! The fit's unknowns in the present pass (M18.2).

use gdcm_model::dataset::Pair;

use crate::correction::Channels;

/// Values for all unknowns.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct FitPoint {
    /// All parameter values, including those set by hand, in plausible standard deviations.
    pub(super) z: Vec<f64>,
    /// `tau`: channel delays, the same in all conditions \[s\].
    pub(super) delays_s: Channels<f64>,
    /// `a`, `b`: channel ln gains in each condition.
    pub(super) ln_gains: Vec<Channels<f64>>,
}

impl FitPoint {
    /// Creates the point with the parameters at `z` and without gains and delays.
    pub(super) fn new(z: Vec<f64>, inputs: usize, outputs: usize, conditions: usize) -> Self {
        let zeros = Channels::from_fn(inputs, outputs, |_| 0.0);
        Self {
            z,
            delays_s: zeros.clone(),
            ln_gains: vec![zeros; conditions],
        }
    }

    /// Returns the channel gains and delays in a condition.
    pub(super) fn channels(&self, condition: usize) -> ChannelPoint<'_> {
        ChannelPoint {
            delays_s: &self.delays_s,
            ln_gains: &self.ln_gains[condition],
        }
    }

    /// Moves towards another point by `share` of the way.
    pub(super) fn move_towards(&mut self, other: &Self, share: f64) {
        for (z, other) in self.z.iter_mut().zip(&other.z) {
            *z += share * (other - *z);
        }
        move_channels(&mut self.delays_s, &other.delays_s, share);
        for (ln_gains, other) in self.ln_gains.iter_mut().zip(&other.ln_gains) {
            move_channels(ln_gains, other, share);
        }
    }
}

fn move_channels(channels: &mut Channels<f64>, other: &Channels<f64>, share: f64) {
    let outputs = channels.outputs.iter_mut().zip(&other.outputs);
    for (value, other) in channels.inputs.iter_mut().zip(&other.inputs).chain(outputs) {
        *value += share * (other - *value);
    }
}

/// Channel gains and delays in a condition.
#[derive(Clone, Copy, Debug)]
pub(super) struct ChannelPoint<'a> {
    delays_s: &'a Channels<f64>,
    ln_gains: &'a Channels<f64>,
}

impl ChannelPoint<'_> {
    /// Returns `tau_o + tau_i` \[s\].
    pub(super) fn delay_s(&self, pair: Pair) -> f64 {
        self.delays_s.outputs[pair.output] + self.delays_s.inputs[pair.input]
    }

    /// Returns `a_oc + b_ic`.
    pub(super) fn ln_gain(&self, pair: Pair) -> f64 {
        self.ln_gains.outputs[pair.output] + self.ln_gains.inputs[pair.input]
    }
}
