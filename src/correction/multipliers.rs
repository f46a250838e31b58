//! What each restraint is worth at a minimum.

use nalgebra::{DMatrix, DVector};

use crate::dataset::Pair;

/// A minimum seen from its channels: inputs first, then outputs.
pub(crate) struct Restrained<'a> {
    /// Number of input channels.
    pub(crate) inputs: usize,
    /// Slope of the objective in each channel's value.
    pub(crate) slopes: Vec<f64>,
    /// Whether each channel is on its lower and on its upper bound.
    pub(crate) at_bounds: Vec<(bool, bool)>,
    /// The held entries: sums of an input's and an output's value.
    pub(crate) held: &'a [Pair],
}

/// Change of the least objective with each restraint's value.
pub(crate) struct Multipliers {
    /// By the sum at which each held entry is held.
    pub(crate) held: Vec<f64>,
    /// By the bound that each channel is on; 0 where none acts.
    pub(crate) bounds: Vec<f64>,
}

/// Solves `slopes + sum of multipliers = 0`: what pushes a piece of tied channels against a bound is borne by the channels that
/// are on that bound, in equal parts; the held entries carry the rest, in a loop with the least squares.
pub(crate) fn multipliers(minimum: &Restrained<'_>) -> Multipliers {
    let channels = minimum.slopes.len();
    let sign = |channel: usize| if channel < minimum.inputs { 1.0 } else { -1.0 };
    let mut bounds = vec![0.0; channels];
    for piece in pieces(minimum) {
        let push: f64 = piece.iter().map(|&channel| sign(channel) * minimum.slopes[channel]).sum();
        // The piece would move against the slope: an input on its upper bound stops a rise, an output on its lower one too.
        let stops = |channel: &&usize| {
            let rises = sign(**channel) * push < 0.0;
            if rises { minimum.at_bounds[**channel].1 } else { minimum.at_bounds[**channel].0 }
        };
        let stopping: Vec<usize> = piece.iter().filter(stops).copied().collect();
        for &channel in &stopping {
            bounds[channel] = sign(channel) * push / stopping.len() as f64;
        }
    }
    let left = DVector::from_fn(channels, |channel, _| minimum.slopes[channel] - bounds[channel]);
    let ties = DMatrix::from_fn(channels, minimum.held.len(), |channel, entry| {
        let pair = minimum.held[entry];
        if channel == pair.input || channel == minimum.inputs + pair.output { 1.0 } else { 0.0 }
    });
    let held = if minimum.held.is_empty() {
        Vec::new()
    } else {
        // Singular values of a bipartite graph of at most 20 channels are 0 or well above this.
        let solved = ties.svd(true, true).solve(&left, 1e-9);
        solved.map(|held| held.iter().copied().collect()).unwrap_or_default()
    };
    Multipliers { held, bounds }
}

/// The channels that held entries tie together.
fn pieces(minimum: &Restrained<'_>) -> Vec<Vec<usize>> {
    let channels = minimum.slopes.len();
    let mut piece: Vec<usize> = (0..channels).collect();
    for pair in minimum.held {
        let (kept, merged) = (piece[pair.input], piece[minimum.inputs + pair.output]);
        for piece in &mut piece {
            if *piece == merged {
                *piece = kept;
            }
        }
    }
    let members = |name: usize| (0..channels).filter(|&channel| piece[channel] == name).collect::<Vec<_>>();
    (0..channels).map(members).filter(|piece| !piece.is_empty()).collect()
}
