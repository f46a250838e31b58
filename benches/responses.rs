//! `cargo bench --bench responses`: the frequency response of a model on each instruction set,
//! compared with a plain dense LU decomposition at each frequency, and with the peak rate of
//! multiply-adds.
//!
//! The share of the peak rate counts the real fused multiply-adds of one frequency without row
//! interchanges, for n states, m inputs and p outputs with m <= p:
//!
//! ```text
//! n^2 m  (elimination of the state columns)  +  2 n m p  (elimination of the output columns)
//! ```
//!
//! The measured time includes balancing, reduction to Hessenberg form, allocation and storing. If
//! the environment variable `GDCM_EXPORT_RESPONSES` names a folder, models and responses are
//! written there for comparison with other programs.

use std::hint::black_box;
use std::path::Path;
use std::time::Duration;

use criterion::{Criterion, Throughput};
use nalgebra::{Complex, DMatrix};
use pulp::{Arch, Simd, WithSimd};
use serde_json::json;

use gdcm_model::dataset::{Band, StateSpace};
use gdcm_model::response::elimination::evaluate_on;
use gdcm_model::response::{FrequencyGrid, FrequencyResponse, evaluate};

#[path = "random_model/mod.rs"]
mod random_model;
#[path = "stopwatch/mod.rs"]
mod stopwatch;

use random_model::{INPUTS, OUTPUTS, dense_responses, model};
use stopwatch::shortest;

const FREQUENCIES: usize = 500;
const ORDERS: [usize; 3] = [12, 30, 60];

/// Returns the instruction sets of this machine, the widest first.
fn instruction_sets() -> Vec<(&'static str, Arch)> {
    let mut sets = Vec::new();
    #[cfg(target_arch = "x86_64")]
    {
        sets.extend(pulp::x86::V4::try_new().map(|simd| ("AVX-512", Arch::V4(simd))));
        sets.extend(pulp::x86::V3::try_new().map(|simd| ("AVX2", Arch::V3(simd))));
    }
    #[cfg(target_arch = "aarch64")]
    sets.extend(pulp::aarch64::Neon::try_new().map(|simd| ("NEON", Arch::Neon(simd))));
    sets.push(("scalar", Arch::Scalar));
    sets
}

/// Independent chains of multiply-adds, which run at the peak rate; returns the number of
/// operations.
struct MultiplyAdds;

impl WithSimd for MultiplyAdds {
    type Output = f64;

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) -> f64 {
        // Two units with a latency of four or five cycles need up to ten chains; sixteen registers
        // hold twelve.
        const CHAINS: usize = 12;
        const ROUNDS: usize = 10_000;
        let factor = simd.splat_f64s(black_box(0.999));
        let addend = simd.splat_f64s(black_box(0.001));
        let mut sums = [addend; CHAINS];
        for _ in 0..ROUNDS {
            for sum in &mut sums {
                *sum = simd.mul_add_e_f64s(*sum, factor, addend);
            }
        }
        black_box(sums);
        (CHAINS * ROUNDS * S::F64_LANES) as f64
    }
}

/// Returns the multiply-adds of one frequency, by the formula above, with n = `order`.
fn multiply_adds(order: usize) -> usize {
    order * INPUTS * (order + 2 * OUTPUTS)
}

/// Prints a table row for each instruction set.
fn compare(order: usize, omega: &[f64]) {
    let model = model(order);
    let dense = shortest(5, || dense_responses(&model, omega)).as_secs_f64() / FREQUENCIES as f64;
    for (name, arch) in instruction_sets() {
        let seconds =
            shortest(400, || evaluate_on(arch, &model, omega)).as_secs_f64() / FREQUENCIES as f64;
        let peak = arch.dispatch(MultiplyAdds)
            / shortest(400, || arch.dispatch(MultiplyAdds)).as_secs_f64();
        let share = multiply_adds(order) as f64 / seconds / peak;
        let time = seconds * 1e6;
        let ratio = dense / seconds;
        let peak = peak * 1e-9;
        println!(
            "{order:6}  {name:<8} {time:8.3} {:10.2} {ratio:8.1} {peak:12.1} {:7.0} %",
            dense * 1e6,
            share * 100.0
        );
    }
}

/// Prints the speed-up by a second thread on a batch of models.
fn scaling(omega: &[f64]) {
    let models: Vec<StateSpace> = vec![model(30); 64];
    let run = |models: &[StateSpace]| {
        for model in models {
            black_box(evaluate(model, omega));
        }
    };
    let one = shortest(20, || run(&models));
    let two = shortest(20, || {
        let (first, second) = models.split_at(models.len() / 2);
        std::thread::scope(|scope| {
            scope.spawn(|| run(first));
            run(second);
        });
    });
    println!(
        "64 models of 30 states: two threads are {:.2} times as fast as one",
        one.div_duration_f64(two)
    );
}

/// Writes a model and its response to `<order>-states.json`, with indices
/// `[frequency][output][input]`.
fn export(folder: &Path, order: usize, omega: &[f64]) {
    let model = model(order);
    let (name, arch) = instruction_sets()[0];
    let seconds =
        shortest(400, || evaluate_on(arch, &model, omega)).as_secs_f64() / FREQUENCIES as f64;
    let response = evaluate_on(arch, &model, omega);
    let text = json!({
        "a": rows(model.a()), "b": rows(model.b()), "c": rows(model.c()), "d": rows(model.d()),
        "omega": omega, "microseconds": seconds * 1e6, "instruction_set": name,
        "re": by_frequency(&response, |value| value.re), "im": by_frequency(&response, |value| value.im),
    });
    let file = folder.join(format!("{order}-states.json"));
    std::fs::write(&file, text.to_string())
        .unwrap_or_else(|error| panic!("{}: {error}", file.display()));
}

fn rows(matrix: &DMatrix<f64>) -> Vec<Vec<f64>> {
    matrix
        .row_iter()
        .map(|row| row.iter().copied().collect())
        .collect()
}

/// Returns a part of each value, with indices `[frequency][output][input]`.
fn by_frequency(
    response: &FrequencyResponse,
    part: impl Fn(Complex<f64>) -> f64,
) -> Vec<Vec<Vec<f64>>> {
    let mut values = vec![vec![vec![0.0; INPUTS]; OUTPUTS]; FREQUENCIES];
    for (pair, curve) in response.curves().iter() {
        for (k, value) in curve.iter().enumerate() {
            values[k][pair.output][pair.input] = part(*value);
        }
    }
    values
}

fn main() {
    // After a large block was freed, the heap keeps its pages, so that page faults are not
    // measured.
    drop(black_box(vec![1_u8; 8 << 20]));
    let grid = FrequencyGrid::logarithmic(Band::new(0.1, 100.0).expect("a band"), FREQUENCIES);
    let omega = grid.omega();
    let mut criterion = Criterion::default()
        .warm_up_time(Duration::from_millis(500))
        .configure_from_args();
    for order in ORDERS {
        let model = model(order);
        let mut group = criterion.benchmark_group(format!("{order} states, {OUTPUTS} x {INPUTS}"));
        group.throughput(Throughput::Elements(FREQUENCIES as u64));
        group.bench_function("gdcm", |bencher| bencher.iter(|| evaluate(&model, omega)));
        group.finish();
    }
    criterion.final_summary();
    println!("states  set            us   dense LU    ratio  peak GFMA/s  of peak");
    for order in ORDERS {
        compare(order, omega);
    }
    scaling(omega);
    if let Some(folder) = std::env::var_os("GDCM_EXPORT_RESPONSES") {
        for order in ORDERS {
            export(Path::new(&folder), order, omega);
        }
    }
}
