//! Plain method for comparison, without a proof: projected gradient for the channel gains or
//! delays, with a penalty on the errors of constrained entries.

use gdcm_method::correction::Problem;

/// Maximum number of steps.
const STEPS: usize = 400;

/// Penalty weight of the constrained entries.
const PENALTY: f64 = 100.0;

/// Returns the objective of the gains found by a projected gradient with a penalty on constrained
/// entries.
pub fn projected_gradient(problem: &Problem) -> f64 {
    let outputs = problem.delta.outputs();
    let inputs = problem.delta.inputs();
    let evaluate = |point: &[f64], gradient: &mut [f64]| {
        gradient.fill(0.0);
        let mut value = 0.0;
        for (pair, delta) in problem.delta.iter() {
            let Some(delta) = delta else { continue };
            let weight = f64::from(u8::from(problem.fitted[pair]))
                + PENALTY * f64::from(u8::from(problem.constrained[pair]));
            let input = point[pair.input];
            let output = point[inputs + pair.output];
            let error = input * output - delta;
            value += weight * error * error;
            gradient[pair.input] += 2.0 * weight * error * output;
            gradient[inputs + pair.output] += 2.0 * weight * error * input;
        }
        for output in inputs..inputs + outputs {
            value += problem.alpha * (point[output] - 1.0).powi(2);
            gradient[output] += 2.0 * problem.alpha * (point[output] - 1.0);
        }
        value
    };
    let point = descend(
        vec![1.0; inputs + outputs],
        (problem.bounds.lower, problem.bounds.upper),
        evaluate,
    );
    problem.objective_at(&point[..inputs], &point[inputs..])
}

/// Returns the objective of the delays found by a projected gradient with a penalty on constrained
/// entries; the delays are scaled to units of 0.1 s.
pub fn delay_gradient(problem: &Problem) -> f64 {
    let outputs = problem.delta.outputs();
    let inputs = problem.delta.inputs();
    let evaluate = |point: &[f64], gradient: &mut [f64]| {
        gradient.fill(0.0);
        let mut value = 0.0;
        for (pair, delta) in problem.delta.iter() {
            let Some(delta) = delta else { continue };
            let weight = f64::from(u8::from(problem.fitted[pair]))
                + PENALTY * f64::from(u8::from(problem.constrained[pair]));
            let error = point[pair.input] + point[inputs + pair.output] - 10.0 * delta;
            value += weight * error * error;
            gradient[pair.input] += 2.0 * weight * error;
            gradient[inputs + pair.output] += 2.0 * weight * error;
        }
        for output in inputs..inputs + outputs {
            value += problem.alpha * point[output].powi(2);
            gradient[output] += 2.0 * problem.alpha * point[output];
        }
        value
    };
    let point = descend(
        vec![0.0; inputs + outputs],
        (0.0, 10.0 * problem.bounds.upper),
        evaluate,
    );
    problem.objective_at(&point[..inputs], &point[inputs..])
}

/// Descends from `point` within `lower` and `upper`; `evaluate` returns the value at a point, and
/// writes its gradient. Steps grow by half after a success, and shrink to 0.4 after a failure.
fn descend(
    mut point: Vec<f64>,
    (lower, upper): (f64, f64),
    evaluate: impl Fn(&[f64], &mut [f64]) -> f64,
) -> Vec<f64> {
    let mut gradient = vec![0.0; point.len()];
    let mut next_gradient = gradient.clone();
    let mut value = evaluate(&point, &mut gradient);
    let mut stride = 1e-2;
    for _ in 0..STEPS {
        let next: Vec<f64> = point
            .iter()
            .zip(&gradient)
            .map(|(at, slope)| (at - stride * slope).clamp(lower, upper))
            .collect();
        let reached = evaluate(&next, &mut next_gradient);
        if reached < value {
            let done = value - reached <= 1e-10 * value;
            point = next;
            value = reached;
            std::mem::swap(&mut gradient, &mut next_gradient);
            stride *= 1.5;
            if done {
                break;
            }
        } else {
            stride *= 0.4;
        }
    }
    point
}
