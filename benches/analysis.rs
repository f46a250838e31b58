//! `cargo bench --bench analysis`: each stage of the example's analysis, and the complete analysis
//! after a change of the study.
//!
//! Targets, for all 11 conditions: 4 ms after a change of alpha; 6 ms after a change of alpha, n or
//! R_max with leads; 10 ms after a model is rejected; 40 ms after a band limit is moved.

use std::hint::black_box;
use std::path::Path;
use std::sync::Arc;
use std::time::Duration;

use criterion::{Criterion, criterion_group, criterion_main};

use gdcm::executor::Pool;
use gdcm_io::{embedded_example, load_dataset};
use gdcm_method::correction::channel_bounds::{delay_upper_s, gain_bounds};
use gdcm_method::correction::delta::{Delta, mismatch_table};
use gdcm_method::fidelity::Discontinuity;
use gdcm_method::fidelity::discontinuity::PerturbedModel;
use gdcm_model::dataset::model::Origin;
use gdcm_model::dataset::{
    Band, BundleKind, Condition, ConditionId, Dataset, Dynamics, Model, ModelId, StateSpace,
};
use gdcm_model::progress::Unobserved;
use gdcm_model::response::{FrequencyGrid, PolarResponse};
use gdcm_study::decisions::setting_table;
use gdcm_study::results::comparison::BundleMetrics;
use gdcm_study::results::required_modes::IdentifiedPoles;
use gdcm_study::stages::compared_model::ComparisonGrid;
use gdcm_study::stages::condition_responses::ConditionResponses;
use gdcm_study::{Edit, Engine, Execution, PhaseCorrection, Study};

#[path = "random_model/mod.rs"]
#[expect(dead_code, reason = "other benches use the rest of it")]
mod random_model;
#[path = "stopwatch/mod.rs"]
mod stopwatch;

use random_model::dense_responses;
use stopwatch::shortest;

/// Returns the dataset to which the targets apply: 11 conditions, each with 19 physics and 3
/// identified models.
fn example() -> Arc<Dataset> {
    let path = concat!(
        env!("CARGO_MANIFEST_DIR"),
        "/tests/data/reference/example-dataset.json.gz"
    );
    load_dataset(Path::new(path))
        .expect("the reference dataset is there")
        .dataset
}

/// Measures each stage in a single condition: 19 physics and 3 identified models, 200 frequencies.
fn stages(criterion: &mut Criterion) {
    let dataset = example();
    let condition = &dataset.conditions()[9];
    let grid = FrequencyGrid::logarithmic(dataset.band(), 200);
    let measuring = dataset.measuring_pairs();
    let sequential = Execution::sequential();
    let responses = ConditionResponses::compute(condition, (dataset.band(), 200), &sequential)
        .expect("nobody stops it");
    let comparison_grid = ComparisonGrid {
        grid: &grid,
        coherence: None,
    };
    let metrics = BundleMetrics::compute(
        condition,
        &responses,
        &measuring,
        comparison_grid,
        &sequential,
    )
    .expect("nobody stops it");
    let mismatch = mismatch_table(
        &PolarResponse::new(&responses.physics[10]),
        &PolarResponse::new(&responses.identified[2]),
        None,
    );
    let models = condition.bundle(BundleKind::Physics);
    let perturbed: Vec<PerturbedModel<'_>> = models
        .iter()
        .map(|model| PerturbedModel {
            name: &model.name,
            perturbation: model.perturbation(),
        })
        .collect();
    let mut group = criterion.benchmark_group("one condition");
    group.bench_function("responses of models not prepared", |bencher| {
        bencher.iter(|| ConditionResponses::compute(condition, (dataset.band(), 200), &sequential));
    });
    group.bench_function("distances and ratios", |bencher| {
        bencher.iter(|| {
            BundleMetrics::compute(
                condition,
                &responses,
                &measuring,
                comparison_grid,
                &sequential,
            )
        });
    });
    group.bench_function("discontinuity ratios", |bencher| {
        bencher.iter(|| Discontinuity::fit(&metrics.physics, &perturbed, &|| false))
    });
    group.bench_function("G and D", |bencher| {
        bencher.iter(|| Delta::new(&mismatch, grid.omega()))
    });
    group.bench_function("bounds", |bencher| {
        bencher.iter(|| {
            (
                gain_bounds(&mismatch, &measuring, 0.05),
                delay_upper_s(&mismatch, &measuring, grid.omega(), 0.05),
            )
        });
    });
    group.finish();
}

/// Measures the analysis of all 11 conditions as requested by the window, on all cores and on one
/// core.
fn live_loop(criterion: &mut Criterion) {
    all_conditions(criterion, "all conditions, all cores", || {
        Engine::with_executor(Box::new(Pool))
    });
    all_conditions(criterion, "all conditions, one core", Engine::default);
}

fn all_conditions(criterion: &mut Criterion, name: &str, engine: impl Fn() -> Engine) {
    let mut group = criterion.benchmark_group(name);
    group.sample_size(20);
    group.bench_function("nothing cached", |bencher| {
        let study = Study::new(example());
        bencher.iter(|| engine().analyze(black_box(&study), &Unobserved));
    });
    for change in CHANGES {
        let mut engine = engine();
        let mut study = Study::new(example());
        let mut turn = 0.0;
        group.bench_function(change.name, |bencher| {
            bencher.iter(|| {
                turn += 1.0;
                (change.carry_out)(&mut study, turn);
                engine.analyze(&study, &Unobserved)
            });
        });
    }
    group.finish();
}

/// A change of a study. Every turn sets another value or toggles a decision, so that no result that
/// depends on it is cached.
struct StudyChange {
    name: &'static str,
    carry_out: fn(&mut Study, f64),
}

const CHANGES: [StudyChange; 7] = [
    StudyChange {
        name: "alpha dragged",
        carry_out: |study, turn| {
            apply(study, setting_table::ALPHA_GAIN.to(1.0 + 1e-6 * turn));
        },
    },
    StudyChange {
        name: "alpha dragged under lead",
        carry_out: |study, turn| {
            apply_under_lead(study, setting_table::ALPHA_GAIN.to(1.0 + 1e-6 * turn));
        },
    },
    StudyChange {
        name: "alpha of the delays dragged under lead",
        carry_out: |study, turn| {
            apply_under_lead(study, setting_table::ALPHA_DELAY.to(1.0 + 1e-6 * turn));
        },
    },
    StudyChange {
        name: "n dragged under lead",
        carry_out: |study, turn| {
            apply_under_lead(study, setting_table::LEAD_POLE.to(3.0 + 1e-6 * turn));
        },
    },
    StudyChange {
        name: "R_max dragged under lead",
        carry_out: |study, turn| {
            apply_under_lead(study, setting_table::LEAD_LIMIT.to(10.0 + 1e-6 * turn));
        },
    },
    StudyChange {
        name: "band edge dragged",
        carry_out: |study, turn| {
            let band = Band::new(0.5, 12.0 + 1e-6 * turn).expect("rising");
            apply(study, setting_table::BAND.to(band));
        },
    },
    StudyChange {
        name: "model rejected",
        carry_out: |study, turn| {
            apply(study, nominal_rejected(turn % 2.0 == 0.0));
        },
    },
];

fn apply(study: &mut Study, edit: Edit) {
    study.apply(&edit).expect("an edit within its range");
}

fn apply_under_lead(study: &mut Study, edit: Edit) {
    apply(study, setting_table::PHASE.to(PhaseCorrection::Lead));
    apply(study, edit);
}

/// Returns the edit that rejects the nominal model of condition 10, or restores it.
fn nominal_rejected(rejected: bool) -> Edit {
    let id = ModelId::new(ConditionId(10), BundleKind::Physics, "nominal");
    if rejected {
        Edit::Reject(id)
    } else {
        Edit::Restore(id)
    }
}

/// Prints the speed-up over plain methods that are measured in the same run, each by the minimum
/// time of a few repetitions.
fn ratios(_: &mut Criterion) {
    let dataset = example();
    let condition = &dataset.conditions()[9];
    let grid = FrequencyGrid::logarithmic(dataset.band(), 200);
    let sequential = Execution::sequential();
    let fast = shortest(20, || {
        ConditionResponses::compute(condition, (dataset.band(), 200), &sequential)
    });
    let models = [BundleKind::Physics, BundleKind::Identified]
        .map(|kind| condition.bundle(kind))
        .concat();
    let plain = shortest(3, || {
        for model in &models {
            if let Dynamics::StateSpace(model) = &model.dynamics {
                black_box(dense_responses(model, grid.omega()));
            }
        }
    });
    println!(
        "responses of one condition: a dense LU at each frequency takes {:.0} times as long",
        plain.div_duration_f64(fast)
    );
    let study = Study::new(Arc::clone(&dataset));
    let uncached = shortest(5, || Engine::default().analyze(&study, &Unobserved));
    let on_all_cores = shortest(5, || {
        Engine::with_executor(Box::new(Pool)).analyze(&study, &Unobserved)
    });
    println!(
        "without cached results: one core takes {:.2} times as long as all cores",
        uncached.div_duration_f64(on_all_cores)
    );
    let mut engine = Engine::default();
    let mut dragged = study.clone();
    let mut alpha = 1.0;
    let drag = shortest(50, || {
        alpha += 1e-6;
        dragged
            .apply(&setting_table::ALPHA_GAIN.to(alpha))
            .expect("within its range");
        engine.analyze(&dragged, &Unobserved)
    });
    println!(
        "alpha dragged: without cached results the analysis would take {:.0} times as long",
        uncached.div_duration_f64(drag)
    );
}

/// Number of physics models in the study of [`large_study`].
const MODELS: usize = 200;

/// Returns a study of the first condition of `example` with [`MODELS`] physics models: the nominal
/// model with its input matrix scaled, which for model 7 is by `scale`.
fn large_study(example: &Dataset, scale: f64) -> Study {
    let first = &example.conditions()[0];
    let base = first.bundle(BundleKind::Physics)[0]
        .state_space()
        .expect("the physics models of the example have matrices");
    let mut physics = Vec::new();
    for index in 0..MODELS {
        let factor = if index == 7 {
            scale
        } else {
            1.0 + 1e-4 * index as f64
        };
        let a = base.a().clone();
        let b = factor * base.b();
        let c = base.c().clone();
        let d = base.d().clone();
        let dynamics = Dynamics::StateSpace(StateSpace::new(a, b, c, d).expect("the shapes agree"));
        let perturbation = None;
        let origin = if index == 0 {
            Origin::Nominal { perturbation }
        } else {
            Origin::Perturbed { perturbation }
        };
        physics.push(Model::new(format!("model {index}"), origin, dynamics));
    }
    let identified = first.bundle(BundleKind::Identified).to_vec();
    let condition = Condition::new(first.flight_state().clone(), physics, identified);
    let dataset = Dataset::new(example.header(), vec![condition.expect("names differ")]);
    Study::new(Arc::new(dataset.expect("the shapes agree")))
}

/// Measures the analysis after one of two hundred models is replaced by another model of the same
/// name: only its response, and what depends on it, is computed again.
fn replaced_model(_: &mut Criterion) {
    let example = example();
    let first = &example.conditions()[0];
    let before = large_study(&example, 1.0);
    let uncached = shortest(5, || Engine::default().analyze(&before, &Unobserved));
    let mut engine = Engine::default();
    let curves = |engine: &mut Engine, study: &Study| {
        engine.curves(
            &study.dataset,
            first.id(),
            (study.settings.band, 500),
            &Unobserved,
        )
    };
    let drawn_uncached = shortest(5, || curves(&mut Engine::default(), &before));
    // Fill the caches of the engine.
    let _ = engine.analyze(&before, &Unobserved);
    let _ = curves(&mut engine, &before);
    let mut scale = 1.0;
    let mut replaced = Duration::MAX;
    let mut drawn = Duration::MAX;
    for _ in 0..20 {
        scale += 1e-6;
        let after = large_study(&example, scale);
        drawn = drawn.min(shortest(1, || curves(&mut engine, &after)));
        replaced = replaced.min(shortest(1, || engine.analyze(&after, &Unobserved)));
    }
    println!(
        "one of {MODELS} models replaced, one core: analysis {replaced:.2?} (without cached results \
         {:.1} times as long); curves for drawing, with the hashes of all models, {drawn:.2?} \
         (without cached results {:.1} times as long)",
        uncached.div_duration_f64(replaced),
        drawn_uncached.div_duration_f64(drawn)
    );
}

/// Measures the error bars of all conditions, which require an analysis for each substituted model.
/// Target: 150 ms on two cores after a rejection, with 20 substitutions per condition; the embedded
/// example needs about 29, because its identified bundles have 11 or 12 models.
fn bars(criterion: &mut Criterion) {
    measure_bars(criterion, "error bars of all conditions", example());
    let embedded = embedded_example()
        .expect("the embedded example is a dataset")
        .dataset;
    measure_bars(criterion, "error bars of the embedded example", embedded);
}

fn measure_bars(criterion: &mut Criterion, name: &str, dataset: Arc<Dataset>) {
    let mut group = criterion.benchmark_group(name);
    group.sample_size(10);
    let mut study = Study::new(dataset);
    let mut engine = Engine::with_executor(Box::new(Pool));
    group.bench_function("all substitutions, responses cached", |bencher| {
        let mut turn = 0.0;
        bencher.iter(|| {
            turn += 1.0;
            // All substitutions depend on alpha, but no response does.
            apply(&mut study, setting_table::ALPHA_GAIN.to(1.0 + 1e-6 * turn));
            let analysis = engine
                .analyze(&study, &Unobserved)
                .expect("nobody stops it");
            engine.uncertainty(&analysis, &Unobserved)
        });
    });
    group.bench_function("after a rejection", |bencher| {
        let mut turn = 0;
        bencher.iter(|| {
            turn += 1;
            apply(&mut study, nominal_rejected(turn % 2 == 0));
            let analysis = engine
                .analyze(&study, &Unobserved)
                .expect("nobody stops it");
            engine.uncertainty(&analysis, &Unobserved)
        });
    });
    group.finish();
}

/// Measures the requirements of all conditions without records, with and without intervals: 11
/// conditions, each with 19 physics and 11 or 12 identified models. Target: 50 ms on two cores, in
/// addition to the analysis.
fn requirements(criterion: &mut Criterion) {
    let mut study = Study::new(
        embedded_example()
            .expect("the embedded example is a dataset")
            .dataset,
    );
    study
        .apply(&setting_table::PHASE.to(PhaseCorrection::Lead))
        .expect("a choice");
    let mut engine = Engine::with_executor(Box::new(Pool));
    let mut analysis = engine
        .analyze(&study, &Unobserved)
        .expect("nobody stops it");
    let mut group = criterion.benchmark_group("requirements of the embedded example");
    group.sample_size(10);
    group.bench_function("without intervals", |bencher| {
        bencher.iter(|| engine.requirements(&analysis, &IdentifiedPoles::default(), &Unobserved))
    });
    analysis.uncertainty = Some(Arc::new(
        engine
            .uncertainty(&analysis, &Unobserved)
            .expect("nobody stops it"),
    ));
    group.bench_function("with intervals", |bencher| {
        bencher.iter(|| engine.requirements(&analysis, &IdentifiedPoles::default(), &Unobserved))
    });
    group.bench_function("the analysis itself, nothing cached", |bencher| {
        bencher.iter(|| Engine::with_executor(Box::new(Pool)).analyze(&study, &Unobserved));
    });
    group.finish();
}

criterion_group!(
    benches,
    stages,
    live_loop,
    ratios,
    replaced_model,
    bars,
    requirements
);
criterion_main!(benches);
