//! Frequency responses on the instruction sets of this machine, compared with 50-digit arithmetic,
//! with dense LU decomposition, and bit by bit with each other.

use proptest::prelude::*;
use pulp::Arch;

use gdcm_model::dataset::Band;
use gdcm_model::response::elimination::evaluate_on;

use super::responses::{GOLDEN, dynamics_of};
use super::*;

type Values = PairTable<Vec<Complex<f64>>>;

fn grid(low: f64, high: f64, points: usize) -> FrequencyGrid {
    FrequencyGrid::logarithmic(Band::beyond(low, high).unwrap(), points)
}

fn response(model: &StateSpace, grid: &FrequencyGrid) -> Values {
    let response = FrequencyResponse::from_dynamics(&Dynamics::StateSpace(model.clone()), grid);
    response.curves().clone()
}

/// Returns a matrix with entries from a sine: irregular, and the same on every machine.
fn sine_matrix(rows: usize, columns: usize, seed: f64) -> DMatrix<f64> {
    DMatrix::from_fn(rows, columns, |row, column| {
        (seed + 7.3 * row as f64 + 2.9 * (column * column) as f64).sin()
    })
}

/// Returns a model with entries from [`sine_matrix`]; the diagonal of A is shifted by -2.
fn sine_model(order: usize, outputs: usize, inputs: usize) -> StateSpace {
    let a = sine_matrix(order, order, 0.3) - DMatrix::identity(order, order) * 2.0;
    let b = sine_matrix(order, inputs, 1.1);
    let c = sine_matrix(outputs, order, 2.3);
    let d = sine_matrix(outputs, inputs, 3.7);
    StateSpace::new(a, b, c, d).unwrap()
}

/// Computes `C (j omega I - A)^-1 B + D` by LU decomposition of the whole matrix.
fn dense_response(model: &StateSpace, omega: f64) -> DMatrix<Complex<f64>> {
    let complex = |matrix: &DMatrix<f64>| matrix.map(|entry| Complex::new(entry, 0.0));
    let n = model.order();
    let shifted = DMatrix::identity(n, n) * Complex::new(0.0, omega) - complex(model.a());
    let states = shifted.lu().solve(&complex(model.b())).unwrap();
    complex(model.c()) * states + complex(model.d())
}

/// Returns the largest difference from dense LU decomposition, relative to the largest value.
fn difference_from_dense(model: &StateSpace, grid: &FrequencyGrid) -> f64 {
    let found = response(model, grid);
    let mut difference = 0.0_f64;
    let mut largest = 0.0_f64;
    for (k, omega) in grid.omega().iter().enumerate() {
        let expected = dense_response(model, *omega);
        for (pair, values) in found.iter() {
            let expected = expected[(pair.output, pair.input)];
            assert!(values[k].is_finite(), "{omega} rad/s");
            largest = largest.max(expected.norm());
            difference = difference.max((values[k] - expected).norm());
        }
    }
    difference / largest
}

/// Returns the instruction sets that this machine supports.
fn instruction_sets() -> Vec<Arch> {
    let mut sets = vec![Arch::Scalar];
    #[cfg(target_arch = "x86_64")]
    {
        sets.extend(pulp::x86::V3::try_new().map(Arch::V3));
        sets.extend(pulp::x86::V4::try_new().map(Arch::V4));
    }
    #[cfg(target_arch = "aarch64")]
    sets.extend(pulp::aarch64::Neon::try_new().map(Arch::Neon));
    sets
}

/// Frequencies of a reference case, and its values in 50-digit arithmetic.
struct Golden {
    omega: Vec<f64>,
    values: Vec<DMatrix<Complex<f64>>>,
}

impl Golden {
    fn from_case(case: &Value) -> Self {
        let complex = |value: &Value| {
            let parts = numbers(value);
            Complex::new(parts[0], parts[1])
        };
        let matrix = |value: &Value| {
            let rows = list(value).len();
            let columns = list(&value[0]).len();
            DMatrix::from_fn(rows, columns, |row, column| complex(&value[row][column]))
        };
        let values = list(&case["H_re_im"]).iter().map(matrix).collect();
        Self {
            omega: numbers(&case["omega_rad_s"]),
            values,
        }
    }

    /// Returns the largest error at `count` frequencies, relative to the largest value; the
    /// frequencies of the case are repeated if `count` is larger.
    fn error(&self, arch: Arch, model: &StateSpace, count: usize) -> f64 {
        let omega: Vec<f64> = self.omega.iter().copied().cycle().take(count).collect();
        let largest = self
            .values
            .iter()
            .flatten()
            .map(|value| value.norm())
            .fold(0.0, f64::max);
        let mut worst = 0.0_f64;
        for (pair, found) in evaluate_on(arch, model, &omega).curves().iter() {
            assert_eq!(found.len(), count);
            for (found, expected) in found.iter().zip(self.values.iter().cycle()) {
                assert!(found.is_finite());
                worst = worst.max((found - expected[(pair.output, pair.input)]).norm());
            }
        }
        worst / largest
    }
}

#[test]
fn every_instruction_set_agrees_with_50_digit_arithmetic_at_every_remainder_length() {
    let golden = json(GOLDEN);
    let mut models = 0;
    for case in list(&golden["cases"]) {
        let Dynamics::StateSpace(model) = dynamics_of(case) else {
            continue;
        };
        models += 1;
        let name = &case["model"];
        let golden = Golden::from_case(case);
        for arch in instruction_sets() {
            // Every remainder modulo 8, the number of frequencies in a group, and all frequencies
            // of the case.
            for count in (0..=17).chain([golden.omega.len()]) {
                let error = golden.error(arch, &model, count);
                // Limit from the specification. The near-defective model comes close to it: its
                // fourfold pole at -0.001 rad/s magnifies the rounding of the system matrix about
                // 1e7 times. The errors of the other models are about 1e-13.
                assert!(
                    error <= 1e-9,
                    "{name}, {count} frequencies, {arch:?}: {error:.1e}"
                );
            }
        }
    }
    assert_eq!(
        models, 8,
        "expected four models of the literature, the near-defective one and three of the example"
    );
}

#[test]
fn every_shape_agrees_with_dense_lu() {
    for order in [1, 2, 3, 4, 12, 30, 60] {
        for (outputs, inputs) in [(1, 1), (6, 4), (4, 6), (2, 5), (9, 7)] {
            // From far below the poles to far above them.
            let difference =
                difference_from_dense(&sine_model(order, outputs, inputs), &grid(1e-2, 1e3, 43));
            // The rounding error is at most 3e-11: 2^18, the pivot threshold times the order, times
            // the unit roundoff 1.1e-16. Nearby poles amplify it.
            assert!(
                difference < 1e-10,
                "{order} states, {outputs} x {inputs}: {difference:.1e}"
            );
        }
    }
}

/// Special structure of the system matrix of a random model.
#[derive(Clone, Copy, Debug)]
enum Structure {
    Full,
    Sparse,
    /// State units that differ by factors of up to 1e24.
    Units,
    /// Hessenberg, with subdiagonal entries down to 1e-20.
    WeakChain,
    /// Two uncoupled subsystems.
    TwoParts,
}

prop_compose! {
    // Models of 1 to 24 states, 1 to 6 inputs and 1 to 8 outputs with entries from -1.5 to 1.5 before
    // the special structure; the diagonal of A is shifted by -2.
    fn random_model()(
        n in 1..25usize, m in 1..7usize, p in 1..9usize,
        structure in prop_oneof![
            Just(Structure::Full),
            Just(Structure::Sparse),
            Just(Structure::Units),
            Just(Structure::WeakChain),
            Just(Structure::TwoParts),
        ]
    )(
        numbers in prop::collection::vec(-1.5..1.5f64, (n + p) * (n + m)),
        sizes in prop::collection::vec(0.0..1.0f64, n * n),
        n in Just(n), m in Just(m), p in Just(p), structure in Just(structure)
    ) -> StateSpace {
        // [A B; C D]
        let all = DMatrix::from_vec(n + p, n + m, numbers);
        let a = DMatrix::from_fn(n, n, |row, column| {
            let entry = all[(row, column)];
            let size = sizes[row * n + column];
            match structure {
                _ if row == column => entry - 2.0,
                Structure::Full => entry,
                Structure::Sparse if size < 0.8 => 0.0,
                Structure::Sparse => entry,
                Structure::Units => entry * 10_f64.powf(24.0 * (sizes[row] - sizes[column])),
                Structure::WeakChain if row > column + 1 => 0.0,
                Structure::WeakChain if row > column => entry * 10_f64.powf(-20.0 * size),
                Structure::WeakChain => entry,
                Structure::TwoParts if (row < n / 2) == (column < n / 2) => entry,
                Structure::TwoParts => 0.0,
            }
        });
        let b = all.view((0, n), (n, m));
        let c = all.view((n, 0), (p, n));
        let d = all.view((n, n), (p, m));
        StateSpace::new(a, b.into_owned(), c.into_owned(), d.into_owned()).unwrap()
    }
}

proptest! {
    #[test]
    fn models_of_any_structure_agree_with_dense_lu(
        model in random_model(), points in 2..40usize, low in -3.0..1.0f64, decades in 0.1..5.0f64
    ) {
        let grid = grid(10_f64.powf(low), 10_f64.powf(low + decades), points);
        let difference = difference_from_dense(&model, &grid);
        // Limit from the specification; the difference was below 1e-10 for 20 000 such models.
        prop_assert!(difference < 1e-9, "{difference:.1e}");
    }
}

#[test]
fn every_number_of_frequencies_agrees_with_dense_lu() {
    let model = sine_model(10, 6, 4);
    for points in 2..=35 {
        let difference = difference_from_dense(&model, &grid(0.1, 100.0, points));
        // Rounding error, as in `every_shape_agrees_with_dense_lu`.
        assert!(difference < 1e-10, "{points} frequencies: {difference:.1e}");
    }
}

#[test]
fn other_frequencies_of_the_grid_change_a_value_by_rounding_only() {
    let model = sine_model(21, 6, 4);
    let whole = grid(0.01, 1000.0, 53);
    let values = response(&model, &whole);
    let largest = values
        .iter()
        .flat_map(|(_, values)| values)
        .map(|value| value.norm())
        .fold(0.0, f64::max);
    for (k, omega) in whole.omega().iter().enumerate() {
        for (pair, alone) in response(&model, &grid(*omega, 2.0 * omega, 2)).iter() {
            let difference = (alone[0] - values[pair][k]).norm() / largest;
            // The pivots are chosen for a whole group of frequencies, so the two results may use
            // different pivots; the rounding error of either is at most 3e-11.
            assert!(
                difference < 6e-11,
                "{omega} rad/s, {pair:?}: {difference:.1e}"
            );
        }
    }
}

#[test]
fn concurrent_evaluations_give_the_same_bits() {
    let model = sine_model(30, 6, 4);
    let grid = grid(0.1, 100.0, 101);
    let expected = response(&model, &grid);
    std::thread::scope(|scope| {
        let threads: Vec<_> = (0..4)
            .map(|_| scope.spawn(|| response(&model, &grid)))
            .collect();
        for thread in threads {
            assert_eq!(thread.join().unwrap(), expected);
        }
    });
}

#[test]
fn a_static_gain_has_the_same_value_at_every_frequency() {
    let d = sine_matrix(2, 3, 0.0);
    let gain = StateSpace::new(
        DMatrix::zeros(0, 0),
        DMatrix::zeros(0, 3),
        DMatrix::zeros(2, 0),
        d.clone(),
    )
    .unwrap();
    for (pair, values) in response(&gain, &grid(0.1, 10.0, 9)).iter() {
        assert_eq!(
            values,
            &vec![Complex::new(d[(pair.output, pair.input)], 0.0); 9]
        );
    }
}

/// Zeros and finite numbers of any magnitude.
fn any_magnitude() -> impl Strategy<Value = f64> {
    prop_oneof![
        1 => Just(0.0),
        9 => (-300.0..300.0_f64, any::<bool>()).prop_map(|(size, negative)| {
            if negative { -10_f64.powf(size) } else { 10_f64.powf(size) }
        }),
    ]
}

/// Largest magnitude of an entry that the program accepts in computations.
const LARGEST_ENTRY: f64 = 1e75;

proptest! {
    #[test]
    fn entries_beyond_the_limit_give_no_response_and_no_entry_takes_long(
        (n, m, p) in (1..9usize, 1..5usize, 1..5usize),
        numbers in prop::collection::vec(any_magnitude(), 12 * 12), clamped in any::<bool>(),
    ) {
        let begun = std::time::Instant::now();
        let entry = |row: usize, column: usize| {
            let number: f64 = numbers[12 * row + column];
            if clamped { number.clamp(-LARGEST_ENTRY, LARGEST_ENTRY) } else { number }
        };
        let part = |row: usize, column: usize, rows, columns| {
            DMatrix::from_fn(rows, columns, |r, c| entry(row + r, column + c))
        };
        let parts = [part(0, 0, n, n), part(0, n, n, m), part(n, 0, p, n), part(n, n, p, m)];
        let mut entries = parts.iter().flat_map(|part| part.iter());
        let computable = entries.all(|entry| entry.abs() <= LARGEST_ENTRY);
        let [a, b, c, d] = parts;
        let dynamics = Dynamics::StateSpace(StateSpace::new(a, b, c, d).unwrap());
        let response = FrequencyResponse::from_dynamics(&dynamics, &grid(0.5, 12.0, 20));
        let not_finite = response.not_finite();
        prop_assert!(
            computable || not_finite.len() == p * m,
            "an entry is too large, yet a response is finite"
        );
        // A generous limit: the computation takes about a thousandth of this time.
        prop_assert!(begun.elapsed().as_secs_f64() < 5.0);
    }

    #[test]
    fn a_first_order_lag_of_any_magnitude_is_accurate_or_not_finite(
        a in any_magnitude(), b in any_magnitude(), c in any_magnitude(), d in any_magnitude(),
    ) {
        let scalar = |entry: f64| {
            DMatrix::from_element(1, 1, entry.clamp(-LARGEST_ENTRY, LARGEST_ENTRY))
        };
        let lag = StateSpace::new(scalar(a), scalar(b), scalar(c), scalar(d)).unwrap();
        let grid = grid(0.5, 12.0, 9);
        for (omega, value) in grid.omega().iter().zip(&response(&lag, &grid)[Pair::new(0, 0)]) {
            let through = lag.c()[0] * lag.b()[0] / Complex::new(-lag.a()[0], *omega);
            let largest = through.norm().max(lag.d()[0].abs());
            // Rounding of a few operations; below the smallest normal number, the error is
            // absolute.
            let error = (value - (through + lag.d()[0])).norm();
            prop_assert!(
                !value.is_finite() || error <= 1e-14 * largest + 1e-300,
                "{value} for {through} + {}", lag.d()[0]
            );
        }
    }

    #[test]
    fn scaling_time_states_inputs_and_outputs_by_powers_of_two_only_scales_the_response(
        model in random_model(),
        (time, input, output) in (-430..150i32, -240..240i32, -240..240i32),
        units in prop::collection::vec(-10..10i32, 25),
    ) {
        let two_to = |power: i32| 2_f64.powi(power);
        let n = model.order();
        let a = DMatrix::from_fn(n, n, |row, column| {
            // Scale in two steps: a single power of two could underflow (below 2^-1022).
            model.a()[(row, column)] * two_to(time) * two_to(units[row] - units[column])
        });
        let b = DMatrix::from_fn(n, model.inputs(), |row, column| {
            model.b()[(row, column)] * two_to(input) * two_to(units[row])
        });
        let c = DMatrix::from_fn(model.outputs(), n, |row, column| {
            model.c()[(row, column)] * two_to(output) * two_to(-units[column])
        });
        let no_feedthrough = model.d() * 0.0;
        let is_accepted =
            |part: &DMatrix<f64>| part.iter().all(|entry| entry.abs() <= LARGEST_ENTRY);
        prop_assume!(is_accepted(&a) && is_accepted(&b) && is_accepted(&c));
        let plain = StateSpace::new(
            model.a().clone(),
            model.b().clone(),
            model.c().clone(),
            no_feedthrough.clone(),
        )
        .unwrap();
        let scaled = StateSpace::new(a, b, c, no_feedthrough).unwrap();
        for omega in [0.5, 3.0] {
            let expected = dense_response(&plain, omega);
            let largest = expected.iter().map(|value| value.norm()).fold(0.0, f64::max);
            let scaled_omega = omega * two_to(time);
            let found = response(&scaled, &grid(scaled_omega, 2.0 * scaled_omega, 2));
            for (pair, values) in found.iter() {
                // Scale back in two steps, to avoid underflow as above.
                let power = input + output - time;
                let half = power / 2;
                let value = values[0] * two_to(-half) * two_to(half - power);
                let error = (value - expected[(pair.output, pair.input)]).norm();
                // The rounding error is at most 3e-11 of the balanced A, but nearby poles amplify
                // it: the maximum in 4000 cases was 1.4e-9. A value lost by underflow or overflow
                // would be an error of 1.
                prop_assert!(error <= 1e-6 * largest, "{pair:?}: {error:.1e} of {largest:.1e}");
            }
        }
    }
}
