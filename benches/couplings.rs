//! `cargo bench --bench couplings`: the joint fit of mixing and feedback, the results that depend
//! on it, and the assessment of its benefit.
//!
//! Targets on two cores, for 6 x 4 responses at 200 frequencies in 11 conditions: 60 ms for a fit
//! with five solves; at most 5 ms more for the dependent results; after a change of alpha, the same
//! time as without couplings.

use std::hint::black_box;
use std::path::Path;
use std::sync::Arc;

use criterion::{Criterion, criterion_group, criterion_main};
use nalgebra::{Complex, DMatrix};

use gdcm::executor::Pool;
use gdcm_io::load_dataset;
use gdcm_method::couplings::{CouplingCondition, CouplingProblem, Unknown, fit_couplings};
use gdcm_model::dataset::{BundleKind, ConditionId, Dataset, ModelId, Pair};
use gdcm_model::executor::Sequential;
use gdcm_model::progress::Unobserved;
use gdcm_model::response::FrequencyResponse;
use gdcm_study::decisions::setting_table;
use gdcm_study::{CouplingCorrection, Edit, Engine, PhaseCorrection, Study};

#[path = "stopwatch/mod.rs"]
mod stopwatch;

use stopwatch::shortest;

/// Returns the dataset to which the targets apply: 11 conditions, 6 outputs, 4 inputs.
fn example() -> Arc<Dataset> {
    let path = concat!(
        env!("CARGO_MANIFEST_DIR"),
        "/tests/data/reference/example-dataset.json.gz"
    );
    load_dataset(Path::new(path))
        .expect("the reference dataset is there")
        .dataset
}

/// Returns a study of the example with leads, mixing and feedback.
fn study() -> Study {
    let mut study = Study::new(example());
    study
        .apply(&setting_table::PHASE.to(PhaseCorrection::Lead))
        .expect("a choice");
    study
        .apply(&setting_table::COUPLINGS.to(CouplingCorrection::MixingAndFeedback))
        .expect("a choice");
    study
}

/// Returns the joint fit that the analysis of the study solves.
fn problem() -> CouplingProblem {
    let analysis = Engine::default()
        .analyze(&study(), &Unobserved)
        .expect("nobody stops it");
    analysis
        .fitted_couplings()
        .expect("the example can be fitted")
        .problem
        .clone()
}

fn live_loop(criterion: &mut Criterion) {
    let problem = problem();
    let mut group = criterion.benchmark_group("couplings");
    group.sample_size(20);
    group.bench_function("fit, one core", |bencher| {
        bencher.iter(|| fit_couplings(black_box(&problem), &Sequential, &Unobserved));
    });
    group.bench_function("fit, all cores", |bencher| {
        bencher.iter(|| fit_couplings(black_box(&problem), &Pool, &Unobserved));
    });
    let mut turn = 0.0;
    let mut measure = |name: &str, change: &dyn Fn(&mut Study, f64)| {
        let mut engine = Engine::with_executor(Box::new(Pool));
        let mut study = study();
        group.bench_function(name, |bencher| {
            bencher.iter(|| {
                turn += 1.0;
                change(&mut study, turn);
                engine.analyze(&study, &Unobserved)
            });
        });
    };
    measure("alpha dragged", &|study, turn| {
        study
            .apply(&setting_table::ALPHA_GAIN.to(1.0 + 1e-6 * turn))
            .expect("within its range");
    });
    // The representative is rejected, because the fit depends on it.
    let analysis = Engine::default()
        .analyze(&study(), &Unobserved)
        .expect("nobody stops it");
    let representative = analysis
        .condition(ConditionId(10))
        .expect("it has a result")
        .representative_name(BundleKind::Physics);
    let reject_or_restore = |study: &mut Study, turn: f64| {
        let id = ModelId::new(ConditionId(10), BundleKind::Physics, representative);
        let edit = if turn % 2.0 == 0.0 {
            Edit::Reject(id)
        } else {
            Edit::Restore(id)
        };
        study.apply(&edit).expect("others are kept");
    };
    measure("model rejected, fitted again", &reject_or_restore);
    measure("model rejected, without couplings", &|study, turn| {
        study
            .apply(&setting_table::COUPLINGS.to(CouplingCorrection::None))
            .expect("a choice");
        reject_or_restore(study, turn);
    });
    group.sample_size(10);
    group.bench_function(
        "assessment of their benefit, nothing cached, all cores",
        |bencher| {
            let study = study();
            let engine = || Engine::with_executor(Box::new(Pool));
            bencher
                .iter(|| engine().assess_couplings(&study, study.settings.couplings, &Unobserved));
        },
    );
    group.finish();
}

/// Compares the joint fit with a fit that stores every row of the least-squares problem.
fn ratios(_: &mut Criterion) {
    let problem = problem();
    let unknowns = fit_couplings(&problem, &Sequential, &Unobserved)
        .expect("the example can be fitted")
        .unknowns;
    let fit = shortest(10, || fit_couplings(&problem, &Sequential, &Unobserved));
    let plain = shortest(2, || {
        for _ in 0..problem.options.passes {
            black_box(plain_solve(&problem, &unknowns));
        }
    });
    let rows =
        problem.conditions.len() * problem.omega.len() * problem.outputs() * problem.inputs() * 2;
    let products = (problem.options.passes * rows * unknowns.len() * unknowns.len()) as f64;
    println!(
        "joint fit of {} unknowns, one core: {fit:.2?}; a plain assembly of its {rows} rows takes \
         {:.1} times as long ({:.1} G multiply-adds, more than the block structure of the fit \
         requires)",
        unknowns.len(),
        plain.div_duration_f64(fit),
        products / 1e9
    );
}

/// Solves the dense least-squares problem once: product of the rows of each condition with their
/// transpose, Cholesky decomposition.
fn plain_solve(problem: &CouplingProblem, unknowns: &[Unknown]) -> Option<DMatrix<f64>> {
    let count = unknowns.len();
    let mut normal = DMatrix::zeros(count, count);
    let mut right = DMatrix::zeros(count, 1);
    for condition in &problem.conditions {
        let (rows, wanted) = plain_rows(problem, condition, unknowns);
        normal += rows.tr_mul(&rows);
        right += rows.tr_mul(&wanted);
    }
    for place in 0..count {
        normal[(place, place)] *= 1.0 + problem.options.ridge;
    }
    Some(normal.cholesky()?.solve(&right))
}

/// Returns the weighted rows of a condition and their right-hand side: real and imaginary part of
/// each response at each frequency.
fn plain_rows(
    problem: &CouplingProblem,
    condition: &CouplingCondition,
    unknowns: &[Unknown],
) -> (DMatrix<f64>, DMatrix<f64>) {
    let outputs = problem.outputs();
    let inputs = problem.inputs();
    let matrix_at = |response: &FrequencyResponse, k: usize| -> DMatrix<Complex<f64>> {
        DMatrix::from_fn(outputs, inputs, |output, input| {
            response.curve(Pair::new(output, input))[k]
        })
    };
    let points = problem.omega.len();
    let mut rows = DMatrix::zeros(points * outputs * inputs * 2, unknowns.len());
    let mut wanted = DMatrix::zeros(rows.nrows(), 1);
    for k in 0..points {
        let physics = matrix_at(&condition.physics, k);
        let flight = matrix_at(&condition.flight, k);
        for (place, (output, input)) in (0..outputs)
            .flat_map(|output| (0..inputs).map(move |input| (output, input)))
            .enumerate()
        {
            let row = 2 * (k * outputs * inputs + place);
            let weight = 1.0 / flight[(output, input)].norm();
            for (column, unknown) in unknowns.iter().enumerate() {
                let entry = match *unknown {
                    Unknown::Mixing { to, from, .. } if from == input => physics[(output, to)],
                    Unknown::Mixing { .. } => continue,
                    Unknown::Feedback {
                        input: to,
                        output: from,
                    } => physics[(output, to)] * flight[(from, input)],
                };
                rows[(row, column)] = weight * entry.re;
                rows[(row + 1, column)] = weight * entry.im;
            }
            wanted[row] = weight * flight[(output, input)].re;
            wanted[row + 1] = weight * flight[(output, input)].im;
        }
    }
    (rows, wanted)
}

criterion_group!(benches, live_loop, ratios);
criterion_main!(benches);
