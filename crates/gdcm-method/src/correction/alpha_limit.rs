//! Limit `alpha -> 0+` for the regularisation weight: step 4 in `solve` (M8, M9). `alpha` weighs
//! the channels' squared deviations from *neutral*, which is gain 1 or delay 0.
//!
//! A *component* is a group of channels that constrained entries connect; its *scale* is the common
//! shift that the constraints leave free (`components`). A channel's *coordinate* is its gain's
//! logarithm or its delay.
//!
//! With `alpha = 0`, the objective does not depend on a common shift of all scales in a *floating
//! piece*: components that fitted entries connect with one another, but not with the ground
//! ([`Objective::floating_pieces`]). With a positive `alpha`, every component with a regularised
//! channel is connected with the ground.

use gdcm_model::statistics::mean;

use super::branch_and_bound::objective::Objective;
use super::components::{ChannelCoordinates, Components, Placement};
use super::quantity::{GainObjective, Quantity};

/// Takes the limit `alpha -> 0+`: the fit does not determine the common shift of a floating piece's
/// scales, which is therefore set to minimise the regularised deviations from neutral, as far as
/// the box allows.
pub(super) fn take_alpha_limit(
    quantity: Quantity,
    components: &Components,
    objective: &Objective,
    scales: &mut [f64],
) {
    objective.shift_floating_pieces(scales, |piece, scales| {
        let channels = components.channels(scales);
        let nodes = components.nodes();
        let in_piece = ChannelCoordinates {
            inputs: select_piece(piece, nodes.inputs, &channels.inputs),
            outputs: select_piece(piece, nodes.outputs, &channels.outputs),
        };
        least_departure_shift(quantity, &in_piece)
    });
}

/// Selects the values at nodes whose component is in `piece`.
fn select_piece(piece: &[usize], nodes: &[Placement], values: &[f64]) -> Vec<f64> {
    let mut selected = Vec::new();
    for (node, &value) in nodes.iter().zip(values) {
        if piece.contains(&node.component) {
            selected.push(value);
        }
    }
    selected
}

/// Returns the shift for a piece's scales that minimises the regularised deviations from neutral.
/// It raises the piece's input coordinates `x` and lowers its output coordinates `y` by the same
/// amount. The outputs are regularised (the inputs, if the piece has no output); for signed delays,
/// both.
///
/// ```text
/// signed delays               (sum y - sum x) / (count of x and y)
/// no output                   -mean x;  0 without any channel
/// delays, gains in dB         mean y
/// gains compared as ratios    ln(sum k^2 / sum k),  k = e^y
/// ```
fn least_departure_shift(quantity: Quantity, channels: &ChannelCoordinates) -> f64 {
    let ChannelCoordinates { inputs, outputs } = channels;
    if quantity.regularises_inputs() {
        let difference = outputs.iter().sum::<f64>() - inputs.iter().sum::<f64>();
        return difference / (inputs.len() + outputs.len()).max(1) as f64;
    }
    if outputs.is_empty() {
        return if inputs.is_empty() {
            0.0
        } else {
            -mean(inputs)
        };
    }
    if quantity != Quantity::Gain(GainObjective::Ratio) {
        return mean(outputs);
    }
    // sum (k e^-shift - 1)^2 is minimal at e^shift = sum k^2 / sum k.
    let mut sum = 0.0;
    let mut square = 0.0;
    for logarithm in outputs {
        sum += logarithm.exp();
        square += (2.0 * logarithm).exp();
    }
    (square / sum).ln()
}
