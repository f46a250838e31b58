//! `cargo bench --bench optimiser`: time for the gains with their optimality proof and for the
//! delays, compared with plain methods for the same problems in the same run.

use std::hint::black_box;
use std::time::Duration;

use criterion::{BenchmarkId, Criterion, criterion_group, criterion_main};

use gdcm_method::correction::solve::solve;
use gdcm_method::correction::{Problem, ProofBudget, Solution};

#[path = "../crates/gdcm-io/tests/suite/optimiser/instances.rs"]
// The tests use other parts of this module.
#[allow(dead_code)]
mod instances;
mod plain;

/// Returns the solution with its optimality proof; `None` if the problem has none.
fn solved(problem: &Problem) -> Option<Solution> {
    solve(problem, ProofBudget::default(), &|| false).ok()
}

/// Measures each realistic ("base") and each wide problem of `gain-instances.json`, beside a plain
/// method.
fn gains(criterion: &mut Criterion) {
    for kind in ["base", "wide"] {
        let mut group = criterion.benchmark_group(format!("gains/{kind}"));
        for instance in instances::gain_instances()
            .iter()
            .filter(|instance| instance.kind == kind)
        {
            group.bench_with_input(
                BenchmarkId::new("with proof", instance.id),
                &instance.problem,
                |bencher, problem| {
                    bencher.iter(|| solved(black_box(problem)));
                },
            );
        }
        for instance in instances::gain_instances()
            .iter()
            .filter(|instance| instance.kind == kind)
        {
            group.bench_with_input(
                BenchmarkId::new("plain, no proof", instance.id),
                &instance.problem,
                |bencher, problem| {
                    bencher.iter(|| plain::projected_gradient(black_box(problem)));
                },
            );
        }
        group.finish();
    }
}

fn delays(criterion: &mut Criterion) {
    let instances = instances::delay_instances();
    let mut group = criterion.benchmark_group("delays");
    for (name, matched) in [("one stage", true), ("two stages", false)] {
        let problems: Vec<_> = instances
            .iter()
            .filter(|instance| instance.matched == matched)
            .collect();
        group.bench_function(format!("{name}, {} problems", problems.len()), |bencher| {
            bencher.iter(|| {
                problems
                    .iter()
                    .map(|instance| solved(black_box(&instance.problem)))
                    .filter(Option::is_some)
                    .count()
            });
        });
    }
    group.bench_function(
        format!("plain projected gradient, {} problems", instances.len()),
        |bencher| {
            bencher.iter(|| {
                instances
                    .iter()
                    .map(|instance| plain::delay_gradient(black_box(&instance.problem)))
                    .sum::<f64>()
            });
        },
    );
    group.finish();
}

fn example(criterion: &mut Criterion) {
    let conditions = instances::example_conditions();
    criterion.bench_function(
        "example/all conditions, gains with proof and delays",
        |bencher| {
            bencher.iter(|| {
                conditions
                    .iter()
                    .map(|condition| {
                        let gains = solved(black_box(&condition.gains));
                        let delays = solved(black_box(&condition.delays));
                        usize::from(gains.is_some() && delays.is_some())
                    })
                    .sum::<usize>()
            });
        },
    );
}

criterion_group! {
    name = benches;
    config = Criterion::default()
        .warm_up_time(Duration::from_millis(100))
        .measurement_time(Duration::from_millis(400))
        .sample_size(20)
        .without_plots();
    targets = gains, delays, example
}
criterion_main!(benches);
