//! Loads the reference instances in `tests/data/reference`.

use serde_json::Value;

use gdcm_method::correction::{Bounds, Problem};
use gdcm_model::dataset::{Pair, PairTable};

/// An instance of equation (7) with its minimum, certified by an independent interval branch and
/// bound to a relative gap of 1e-8.
pub struct GainInstance {
    pub id: u64,
    /// How the instance was generated: `base` (realistic gains), `wide`, `infeasible`,
    /// `cycle_consistent`, `cycle_inconsistent` or `edge` (a single feasible point).
    pub kind: String,
    pub problem: Problem,
    pub objective: f64,
    /// Whether all held entries can be matched.
    pub matched: bool,
    /// Maximum deviation of a held entry, in natural logarithms; 0 if all are matched.
    pub residual: f64,
    pub inputs: Vec<f64>,
    pub outputs: Vec<f64>,
    /// Whether several combinations of gains have the same objective, so that only their products
    /// can be compared.
    pub has_free_scale: bool,
}

/// Returns a list of numbers; empty for any other value.
pub fn numbers(value: &Value) -> Vec<f64> {
    value
        .as_array()
        .into_iter()
        .flatten()
        .filter_map(Value::as_f64)
        .collect()
}

/// Converts rows of numbers (outputs x inputs) to a table.
pub fn table<T>(rows: &Value, entry: impl Fn(f64) -> T) -> PairTable<T> {
    let rows: Vec<Vec<f64>> = rows.as_array().into_iter().flatten().map(numbers).collect();
    PairTable::from_fn(rows.len(), rows[0].len(), |pair: Pair| {
        entry(rows[pair.output][pair.input])
    })
}

pub fn gain_instances() -> Vec<GainInstance> {
    let file: Value = serde_json::from_str(include_str!(
        "../../../../../tests/data/reference/gain-instances.json"
    ))
    .unwrap();
    file["instances"]
        .as_array()
        .unwrap()
        .iter()
        .map(gain_instance)
        .collect()
}

fn gain_instance(instance: &Value) -> GainInstance {
    // If the held entries cannot be matched, stage 1 finds the closest targets that can be, and
    // stage 2 the minimum for these targets.
    let matched = instance["two_stage"].is_null();
    let answer = if matched {
        instance
    } else {
        &instance["two_stage"]
    };
    let bounds = Bounds {
        lower: instance["lb"].as_f64().unwrap(),
        upper: instance["ub"].as_f64().unwrap(),
    };
    let constrained = table(&instance["on_axis"], |mark| mark != 0.0);
    let alpha = instance["alpha"].as_f64().unwrap();
    let problem = Problem {
        alpha,
        ..Problem::gains(table(&instance["G"], Some), constrained, bounds)
    };
    GainInstance {
        id: instance["id"].as_u64().unwrap(),
        kind: instance["kind"].as_str().unwrap().to_owned(),
        problem,
        objective: answer["objective"].as_f64().unwrap(),
        matched,
        residual: answer["residual_ln"].as_f64().unwrap_or(0.0),
        inputs: numbers(&answer["k_in"]),
        outputs: numbers(&answer["k_out"]),
        has_free_scale: instance["nonunique_scale"].as_bool().unwrap_or(false),
    }
}

/// An instance of equation (11) with its minimum.
pub struct DelayInstance {
    pub id: u64,
    pub problem: Problem,
    pub objective: f64,
    pub matched: bool,
    pub inputs: Vec<f64>,
    pub outputs: Vec<f64>,
}

/// The five on-axis entries of Table 2, (output, input).
pub const ON_AXIS: [(usize, usize); 5] = [(0, 1), (1, 0), (2, 2), (4, 2), (5, 3)];

/// Marks the entries of Table 2 among 6 outputs and 4 inputs.
pub fn on_axis() -> PairTable<bool> {
    PairTable::from_fn(6, 4, |pair| ON_AXIS.contains(&(pair.output, pair.input)))
}

pub fn delay_instances() -> Vec<DelayInstance> {
    let file: Value = serde_json::from_str(include_str!(
        "../../../../../tests/data/reference/delay-instances.json"
    ))
    .unwrap();
    file["instances"]
        .as_array()
        .unwrap()
        .iter()
        .map(delay_instance)
        .collect()
}

fn delay_instance(instance: &Value) -> DelayInstance {
    let problem = Problem::delays(
        table(&instance["D"], Some),
        on_axis(),
        instance["ub"].as_f64().unwrap(),
    );
    let problem = Problem {
        alpha: instance["alpha"].as_f64().unwrap(),
        ..problem
    };
    DelayInstance {
        id: instance["id"].as_u64().unwrap(),
        problem,
        objective: instance["objective"].as_f64().unwrap(),
        matched: instance["matched"].as_bool().unwrap(),
        inputs: numbers(&instance["tau_in"]),
        outputs: numbers(&instance["tau_out"]),
    }
}

/// Gain and delay problems of an example condition, with their minimum objectives.
pub struct ExampleCondition {
    pub id: u64,
    pub gains: Problem,
    pub gain_objective: f64,
    pub delays: Problem,
    pub delay_objective: f64,
}

pub fn example_conditions() -> Vec<ExampleCondition> {
    let file: Value = serde_json::from_str(include_str!(
        "../../../../../tests/data/reference/example-analysis.json"
    ))
    .unwrap();
    file["conditions"]
        .as_array()
        .unwrap()
        .iter()
        .map(example_condition)
        .collect()
}

fn example_condition(condition: &Value) -> ExampleCondition {
    let number = |name: &str| condition[name].as_f64().unwrap();
    let bounds = Bounds {
        lower: number("lb"),
        upper: number("ub"),
    };
    ExampleCondition {
        id: condition["id"].as_u64().unwrap(),
        gains: Problem::gains(table(&condition["G"], Some), on_axis(), bounds),
        gain_objective: number("gain_objective"),
        delays: Problem::delays(table(&condition["D"], Some), on_axis(), number("tau_ub")),
        delay_objective: number("delay_objective"),
    }
}
