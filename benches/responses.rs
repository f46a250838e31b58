//! The frequency response of a model beside a plain one: a dense complex LU decomposition at each frequency.

use std::hint::black_box;
use std::time::{Duration, Instant};

use criterion::{Criterion, Throughput};
use gdcm::dataset::{Band, Dynamics, StateSpace};
use gdcm::response::{FrequencyGrid, FrequencyResponse};
use nalgebra::{Complex, DMatrix};

const OUTPUTS: usize = 6;
const INPUTS: usize = 4;
const FREQUENCIES: usize = 500;

/// A stable model without structure: a random matrix whose eigenvalues fill a disc of radius 8 rad/s about -9 rad/s.
fn model(order: usize) -> StateSpace {
    let mut state = 88_172_645_463_325_252_u64;
    let mut uniform = || {
        state ^= state << 13;
        state ^= state >> 7;
        state ^= state << 17;
        (state >> 11) as f64 / (1_u64 << 53) as f64 * 2.0 - 1.0
    };
    // The sum of three such numbers has variance 1.
    let mut matrix = |rows, columns| DMatrix::from_fn(rows, columns, |_, _| uniform() + uniform() + uniform());
    let a = matrix(order, order) * (8.0 / (order as f64).sqrt()) - DMatrix::identity(order, order) * 9.0;
    let (b, c, d) = (matrix(order, INPUTS), matrix(OUTPUTS, order), matrix(OUTPUTS, INPUTS));
    StateSpace::new(a, b, c, d).expect("the shapes agree")
}

fn plain(model: &StateSpace, grid: &FrequencyGrid) -> Vec<DMatrix<Complex<f64>>> {
    let [a, b, c, d] = [model.a(), model.b(), model.c(), model.d()].map(|matrix| matrix.map(Complex::from));
    let identity = DMatrix::<Complex<f64>>::identity(a.nrows(), a.nrows());
    let at = |omega: &f64| {
        let states = (&identity * Complex::new(0.0, *omega) - &a).lu().solve(&b);
        &c * states.expect("no pole on the imaginary axis") + &d
    };
    grid.omega().iter().map(at).collect()
}

/// The shortest of a few runs: what the machine does when nothing disturbs it.
fn shortest<T>(runs: usize, mut run: impl FnMut() -> T) -> Duration {
    let time = |_| {
        let start = Instant::now();
        black_box(run());
        start.elapsed()
    };
    (0..runs).map(time).min().unwrap_or_default()
}

fn responses(criterion: &mut Criterion) {
    let grid = FrequencyGrid::logarithmic(Band::new(0.1, 100.0).expect("a band"), FREQUENCIES);
    for order in [12, 30, 60] {
        let model = model(order);
        let dynamics = Dynamics::StateSpace(model.clone());
        let mut group = criterion.benchmark_group(format!("{order} states, {OUTPUTS} x {INPUTS}"));
        group.throughput(Throughput::Elements(FREQUENCIES as u64));
        group.bench_function("gdcm", |bencher| bencher.iter(|| FrequencyResponse::of(&dynamics, &grid)));
        group.sample_size(10);
        group.bench_function("dense LU", |bencher| bencher.iter(|| plain(&model, &grid)));
        group.finish();
        let fast = shortest(200, || FrequencyResponse::of(&dynamics, &grid));
        let slow = shortest(5, || plain(&model, &grid));
        let each = |time: Duration| time.as_secs_f64() * 1e6 / FREQUENCIES as f64;
        println!(
            "{order} states: {:.3} us a frequency, dense LU {:.2} us, ratio {:.1}",
            each(fast),
            each(slow),
            each(slow) / each(fast)
        );
    }
}

fn main() {
    let mut criterion = Criterion::default().configure_from_args();
    responses(&mut criterion);
    criterion.final_summary();
}
