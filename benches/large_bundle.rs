//! `cargo bench --bench large_bundle`: a bundle of 1000 models with 60 states, at 500 frequencies;
//! more than ten times the size of the bundles in the paper.
//!
//! Targets: 1 s for the responses on two cores, 1 GB of memory.

use std::collections::BTreeMap;
use std::sync::Arc;

use criterion::Criterion;
use nalgebra::DMatrix;

use gdcm::executor::Pool;
use gdcm_model::dataset::condition::FlightState;
use gdcm_model::dataset::model::Origin;
use gdcm_model::dataset::{
    Band, Condition, ConditionId, Dynamics, Model, Pair, PairTable, StateSpace,
};
use gdcm_model::executor::{Executor, Sequential};
use gdcm_model::progress::Unobserved;
use gdcm_model::response::FrequencyGrid;
use gdcm_study::Execution;
use gdcm_study::results::comparison::BundleMetrics;
use gdcm_study::stages::compared_model::ComparisonGrid;
use gdcm_study::stages::condition_responses::ConditionResponses;

#[path = "random_model/mod.rs"]
mod random_model;
#[path = "stopwatch/mod.rs"]
mod stopwatch;

use random_model::{INPUTS, OUTPUTS, dense_responses, model};
use stopwatch::shortest;

const MODELS: usize = 1000;
const STATES: usize = 60;
const FREQUENCIES: usize = 500;

/// Returns a condition with a nominal model and its neighbours, whose system matrices change
/// linearly with two trim coordinates.
fn condition() -> Condition {
    let base = model(STATES);
    let change = |seed: f64| {
        DMatrix::from_fn(STATES, STATES, |i, j| {
            0.05 * (seed + 7.3 * i as f64 + j as f64).sin()
        })
    };
    let by_roll = change(0.1);
    let by_airspeed = change(0.7);
    let physics = (0..MODELS).map(|index| {
        let roll = (index as f64).sin();
        let airspeed = (index as f64 * 1.7).cos();
        let offset = if index == 0 { 0.0 } else { 1.0 };
        let a = base.a() + offset * (&by_roll * roll + &by_airspeed * airspeed);
        let b = base.b().clone();
        let c = base.c().clone();
        let d = base.d().clone();
        let perturbation = BTreeMap::from([
            ("roll_deg".to_owned(), offset * roll),
            ("airspeed_kt".to_owned(), offset * airspeed),
        ]);
        let origin = if index == 0 {
            Origin::Nominal {
                perturbation: Some(perturbation),
            }
        } else {
            Origin::Perturbed {
                perturbation: Some(perturbation),
            }
        };
        let dynamics = Dynamics::StateSpace(StateSpace::new(a, b, c, d).expect("the shapes agree"));
        Model::new(format!("model {index}"), origin, dynamics)
    });
    let origin = Origin::Identified {
        method: None,
        order: None,
    };
    let identified = Model::new("flight", origin, Dynamics::StateSpace(base.clone()));
    let flight_state = FlightState {
        id: ConditionId(1),
        name: "a large bundle".to_owned(),
        airspeed_kt: 60.0,
        altitude: None,
        altitude_ft: None,
        weight: None,
        mass_kg: None,
    };
    Condition::new(flight_state, physics.collect(), vec![identified])
        .expect("one nominal model, all names different")
}

/// Returns the peak resident memory of the process \[MB\]; `None` on systems without
/// `/proc/self/status`.
fn peak_memory_mb() -> Option<f64> {
    let status = std::fs::read_to_string("/proc/self/status").ok()?;
    let line = status.lines().find(|line| line.starts_with("VmHWM"))?;
    Some(line.split_whitespace().nth(1)?.parse::<f64>().ok()? / 1024.0)
}

fn main() {
    let condition = Arc::new(condition());
    let band = Band::new(0.1, 100.0).expect("a band");
    let grid = FrequencyGrid::logarithmic(band, FREQUENCIES);
    let mut measuring = PairTable::filled(OUTPUTS, INPUTS, false);
    for channel in 0..INPUTS {
        measuring[Pair::new(channel, channel)] = true;
    }
    let responses = |executor: &dyn Executor| {
        let execution = Execution::new(executor, &Unobserved, MODELS);
        ConditionResponses::compute(&condition, (band, FREQUENCIES), &execution)
            .expect("nobody stops it")
    };
    let mut criterion = Criterion::default().sample_size(10).configure_from_args();
    let mut group = criterion.benchmark_group(format!(
        "{MODELS} models, {STATES} states, {FREQUENCIES} frequencies"
    ));
    group.bench_function("responses, all cores", |bencher| {
        bencher.iter(|| responses(&Pool))
    });
    group.bench_function("responses, one core", |bencher| {
        bencher.iter(|| responses(&Sequential))
    });
    let all = responses(&Pool);
    group.bench_function("distances and ratios, all cores", |bencher| {
        let execution = Execution::new(&Pool, &Unobserved, 2 * MODELS);
        let comparison_grid = ComparisonGrid {
            grid: &grid,
            coherence: None,
        };
        bencher.iter(|| {
            BundleMetrics::compute(&condition, &all, &measuring, comparison_grid, &execution)
        });
    });
    group.finish();
    criterion.final_summary();
    let all_cores = shortest(3, || responses(&Pool));
    let one_core = shortest(3, || responses(&Sequential));
    let dense = shortest(3, || dense_responses(&model(STATES), grid.omega())) * MODELS as u32;
    println!(
        "responses: {all_cores:.2?} on all cores, {one_core:.2?} on one; a dense LU for each would \
         take {dense:.1?} on one"
    );
    println!(
        "dense LU takes {:.0} times as long as one core, {:.0} times as long as all cores",
        dense.as_secs_f64() / one_core.as_secs_f64(),
        dense.as_secs_f64() / all_cores.as_secs_f64()
    );
    if let Some(memory) = peak_memory_mb() {
        println!("peak memory: {memory:.0} MB, including two sets of responses and the models");
    }
}
