//! Residuals of the Karush-Kuhn-Tucker conditions at a solution, computed independently of the
//! solver.

use gdcm_method::correction::{Bounds, GainObjective, Problem, Quantity, Solution};
use gdcm_model::dataset::Pair;

/// Gradient and active constraints of a minimisation at a point. Channels: inputs, then outputs.
struct Point {
    inputs: usize,
    gradient: Vec<f64>,
    /// Whether each channel is at its lower bound and at its upper bound.
    bounds: Vec<(bool, bool)>,
    held: Vec<Pair>,
    /// Sum of the magnitudes of the terms in each channel's gradient.
    sizes: Vec<f64>,
}

/// Returns the residual of the gains in logarithms, relative to the magnitude of the gradient's
/// terms.
pub fn gain_residual(problem: &Problem, solution: &Solution) -> f64 {
    let inputs = problem.delta.inputs();
    let outputs = problem.delta.outputs();
    let mut gradient = vec![0.0; inputs + outputs];
    let mut sizes = vec![1e-300; inputs + outputs];
    let mut add = |channels: &[usize], delta: f64, gain: f64, weight: f64| {
        // Derivatives of (gain - delta)^2, or of (20 log10 gain/delta)^2, by the natural logarithm
        // of the gain.
        let decibel = 2.0 * weight * (20.0 / std::f64::consts::LN_10).powi(2);
        let (slope, size) = match problem.quantity {
            Quantity::Gain(GainObjective::Ratio) => (
                2.0 * weight * gain * (gain - delta),
                2.0 * weight * gain * (gain + delta),
            ),
            _ => (decibel * (gain / delta).ln(), decibel),
        };
        for &channel in channels {
            gradient[channel] += slope;
            sizes[channel] += size;
        }
    };
    for (pair, delta) in problem.delta.iter() {
        if let (Some(delta), true) = (delta, problem.fitted[pair]) {
            let gain = solution.inputs[pair.input] * solution.outputs[pair.output];
            add(&[pair.input, inputs + pair.output], *delta, gain, 1.0);
        }
    }
    for (output, gain) in solution.outputs.iter().enumerate() {
        add(&[inputs + output], 1.0, *gain, problem.alpha);
    }
    let Bounds { lower, upper } = problem.bounds;
    let mut bounds = Vec::new();
    for gain in solution.inputs.iter().chain(&solution.outputs) {
        let at_lower = *gain <= lower * (1.0 + 1e-12);
        let at_upper = *gain >= upper * (1.0 - 1e-12);
        bounds.push((at_lower, at_upper));
    }
    residual(&Point {
        inputs,
        gradient,
        bounds,
        held: problem.constrained.marked().collect(),
        sizes,
    })
}

/// Returns the residual of the delays, relative to the magnitude of the gradient's terms.
pub fn delay_residual(problem: &Problem, solution: &Solution) -> f64 {
    let inputs = problem.delta.inputs();
    let outputs = problem.delta.outputs();
    let mut gradient = vec![0.0; inputs + outputs];
    let mut sizes = vec![1e-300; inputs + outputs];
    for (pair, delta) in problem.delta.iter() {
        if let (Some(delta), true) = (delta, problem.fitted[pair]) {
            let sum = solution.inputs[pair.input] + solution.outputs[pair.output];
            for channel in [pair.input, inputs + pair.output] {
                gradient[channel] += 2.0 * (sum - delta);
                sizes[channel] += 2.0 * (sum + delta.abs());
            }
        }
    }
    for (output, delay) in solution.outputs.iter().enumerate() {
        gradient[inputs + output] += 2.0 * problem.alpha * delay;
        // Typical delays of 0.1 s.
        sizes[inputs + output] += 0.2 * problem.alpha;
    }
    let mut bounds = Vec::new();
    for delay in solution.inputs.iter().chain(&solution.outputs) {
        bounds.push((*delay == 0.0, *delay == problem.bounds.upper));
    }
    residual(&Point {
        inputs,
        gradient,
        bounds,
        held: problem.constrained.marked().collect(),
        sizes,
    })
}

/// Returns the largest remaining slope in a feasible direction, relative to the magnitude of its
/// terms. Held entries tie channels together: such a group can only move as a whole (inputs up and
/// outputs down by the same amount), and not beyond a bound of any of its channels.
fn residual(point: &Point) -> f64 {
    let channels = point.gradient.len();
    // Group of each channel, named after one of its channels.
    let mut group: Vec<usize> = (0..channels).collect();
    for pair in &point.held {
        let kept = group[pair.input];
        let merged = group[point.inputs + pair.output];
        for group in &mut group {
            if *group == merged {
                *group = kept;
            }
        }
    }
    let mut worst = 0.0_f64;
    for name in 0..channels {
        let members = (0..channels).filter(|&channel| group[channel] == name);
        let mut slope = 0.0;
        let mut size = 1e-300;
        let mut may_rise = true;
        let mut may_fall = true;
        for channel in members {
            let (at_lower, at_upper) = point.bounds[channel];
            let is_input = channel < point.inputs;
            slope += if is_input {
                point.gradient[channel]
            } else {
                -point.gradient[channel]
            };
            size += point.sizes[channel];
            may_rise &= !(if is_input { at_upper } else { at_lower });
            may_fall &= !(if is_input { at_lower } else { at_upper });
        }
        if (slope < 0.0 && may_rise) || (slope > 0.0 && may_fall) {
            worst = worst.max(slope.abs() / size);
        }
    }
    worst
}
