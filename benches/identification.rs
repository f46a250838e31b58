//! `cargo bench --bench identification`: models of the example's eleven conditions from their
//! flight records, stage by stage, then from long and from many simulated records, compared with
//! the normal matrix of a step as a plain product.
//!
//! Targets on two cores: for 9 records of 60 s at 50 Hz, 4 inputs and 6 outputs, 0.4 s to the first
//! model, 1.3 s in total, 12 s for all eleven conditions; two records of 10 minutes at 250 Hz, 5 s;
//! 96 records of 66 s at 50 Hz, 4 inputs and 6 outputs, 20 s.

use std::path::Path;
use std::sync::Mutex;
use std::time::Instant;

use nalgebra::{DMatrix, DVector};

use gdcm::executor::Pool;
use gdcm_io::import::record_files::read_records;
use gdcm_io::{FolderProgress, embedded_example};
use gdcm_model::dataset::{ConditionId, StateSpace};
use gdcm_model::progress::{Progress, Unobserved};
use gdcm_model::simulation::{FirstOrderHold, FlightRecord};
use gdcm_study::jobs::identification_jobs::IdentificationRequest;
use gdcm_sysid::identification::identify::identify;
use gdcm_sysid::identification::{Options, Preparation};
use gdcm_sysid::records::{LaidOutRecord, RecordChannels, TimeSettings};

/// Ignores the progress of reading.
struct Silent;

impl FolderProgress for Silent {
    fn reading(&self, _: usize, _: usize, _: &str) {}
}

/// Records when each step of an identification begins \[ms\].
struct Stages {
    start: Instant,
    steps: Mutex<Vec<(f64, String)>>,
    first_model: Mutex<Option<f64>>,
}

impl Stages {
    fn new() -> Self {
        Self {
            start: Instant::now(),
            steps: Mutex::default(),
            first_model: Mutex::default(),
        }
    }

    fn now_ms(&self) -> f64 {
        1e3 * self.start.elapsed().as_secs_f64()
    }

    fn first_model_ms(&self) -> f64 {
        let first_model = self.first_model.lock().expect("nothing panics");
        first_model.unwrap_or(f64::NAN)
    }

    /// Prints the duration of each step of an identification that ended at `end_ms`.
    fn print(&self, end_ms: f64) {
        let steps = self.steps.lock().expect("nothing panics");
        for (number, (start_ms, step)) in steps.iter().enumerate() {
            let next_ms = steps.get(number + 1).map_or(end_ms, |next| next.0);
            println!("    {:6.1} ms  {step}", next_ms - start_ms);
        }
    }
}

impl Progress for Stages {
    fn cancelled(&self) -> bool {
        false
    }

    fn advanced(&self, _done: usize, _total: usize) {}

    fn step(&self, name: &str) {
        self.steps
            .lock()
            .expect("nothing panics")
            .push((self.now_ms(), name.to_owned()));
    }

    fn first_model(&self, _model: &StateSpace) {
        *self.first_model.lock().expect("nothing panics") = Some(self.now_ms());
    }
}

fn main() {
    let dataset = embedded_example()
        .expect("the embedded example is a dataset")
        .dataset;
    let channels = RecordChannels::of_dataset(&dataset).of_named_records();
    let archive = Path::new(env!("CARGO_MANIFEST_DIR")).join("assets/example-records.zip");
    let tables = read_records(&[archive], &Silent)
        .expect("the archive is there")
        .tables;
    let records: Vec<LaidOutRecord> = tables
        .into_iter()
        .map(|table| LaidOutRecord::proposed(table, &channels, &TimeSettings::default()).0)
        .collect();
    let (inputs, outputs) = dataset.input_and_output_names();
    let preparation = Preparation::new(&borrowed(&inputs), &borrowed(&outputs));
    let band = dataset.band();
    let mut all_ms = 0.0;
    let mut worst_ratio = 0.0f64;
    for condition in dataset.conditions() {
        let condition_records = records
            .iter()
            .filter(|record| record.guess.condition_of(&dataset) == Some(condition.id()));
        let request = IdentificationRequest::from_used(
            condition_records,
            preparation.clone(),
            [band.min(), band.max()],
        );
        let request = request.expect("every condition has records");
        let stages = Stages::new();
        let found = request
            .identify(&Pool, &stages)
            .expect("the example's flights are good");
        let ms = stages.now_ms();
        all_ms += ms;
        let ratio = found.held_out_cost.unwrap_or(f64::NAN) / found.cost;
        worst_ratio = worst_ratio.max(ratio);
        println!(
            "condition {:2}: order {:2}, J/dof {:.3}, held-out cost {ratio:.2} times as large; \
             first model {:4.0} ms, total {ms:4.0} ms",
            condition.id(),
            found.refined.order().unwrap_or_default(),
            found.cost,
            stages.first_model_ms(),
        );
        if condition.id() == ConditionId(10) {
            stages.print(ms);
        }
    }
    println!(
        "all {} conditions {:.1} s; worst held-out ratio {worst_ratio:.2}",
        dataset.conditions().len(),
        1e-3 * all_ms
    );
    let plain_ms = plain_normal_matrix();
    for case in SIMULATED {
        case.identify(plain_ms);
    }
}

fn borrowed(names: &[String]) -> Vec<&str> {
    names.iter().map(String::as_str).collect()
}

/// Prints and returns the time to compute the normal matrix of a Gauss-Newton step from a stored
/// Jacobian: 8 records of 150 spectral lines, 6 outputs, real and imaginary parts, 200 parameters.
fn plain_normal_matrix() -> f64 {
    let jacobian = DMatrix::from_fn(8 * 150 * 6 * 2, 200, |row, column| {
        ((row * 31 + column * 17) % 101) as f64 / 101.0
    });
    let runs = (0..5).map(|_| {
        let start = Instant::now();
        std::hint::black_box(jacobian.tr_mul(&jacobian));
        1e3 * start.elapsed().as_secs_f64()
    });
    let shortest_ms = runs.fold(f64::INFINITY, f64::min);
    println!("plain normal matrix of one step: {shortest_ms:.1} ms");
    shortest_ms
}

/// Simulated sweeps of a known aircraft.
struct SimulatedFlight {
    name: &'static str,
    inputs: usize,
    outputs: usize,
    records: usize,
    seconds: f64,
    rate_hz: f64,
}

const SIMULATED: [SimulatedFlight; 2] = [
    SimulatedFlight {
        name: "two records of 10 minutes at 250 Hz, 2 x 2",
        inputs: 2,
        outputs: 2,
        records: 2,
        seconds: 600.0,
        rate_hz: 250.0,
    },
    SimulatedFlight {
        name: "96 records of 66 s at 50 Hz, 4 x 6",
        inputs: 4,
        outputs: 6,
        records: 96,
        seconds: 66.0,
        rate_hz: 50.0,
    },
];

impl SimulatedFlight {
    /// Simulates the records and prints the time of their identification, also as a multiple of
    /// `plain_ms`.
    fn identify(&self, plain_ms: f64) {
        let records = self.fly();
        let names = ["u0", "u1", "u2", "u3", "y0", "y1", "y2", "y3", "y4", "y5"];
        let preparation = Preparation::new(&names[..self.inputs], &names[4..4 + self.outputs]);
        let options = Options::new([0.5, 12.0], preparation);
        let start = Instant::now();
        let found = identify(&records, &options, &Pool, &Unobserved)
            .expect("the simulated flights are good");
        let ms = 1e3 * start.elapsed().as_secs_f64();
        println!(
            "{}: order {}, J/dof {:.3}, {:.1} s, {:.0} times the plain normal matrix",
            self.name,
            found.refined.order().unwrap_or_default(),
            found.cost,
            1e-3 * ms,
            ms / plain_ms
        );
    }

    /// Simulates sweeps of the inputs in turn. All inputs have additional noise of up to a tenth of
    /// the sweep, the outputs of up to a fiftieth of their rms.
    fn fly(&self) -> Vec<FlightRecord> {
        let mut random = UniformNoise(1);
        let model = self.aircraft(&mut random);
        let step_s = 1.0 / self.rate_hz;
        let plant = FirstOrderHold::new(&model, step_s).expect("the step is positive");
        let samples = (self.seconds * self.rate_hz) as usize;
        let mut records = Vec::with_capacity(self.records);
        for number in 0..self.records {
            let swept = number % self.inputs;
            let mut inputs = DMatrix::zeros(samples, self.inputs);
            for k in 0..samples {
                // A logarithmic sweep from 0.08 to 2.4 Hz, a ratio of 30.
                let ln_ratio = 30f64.ln();
                let share = k as f64 / samples as f64;
                let turns = 0.08 * self.seconds / ln_ratio * ((ln_ratio * share).exp() - 1.0);
                inputs[(k, swept)] = (std::f64::consts::TAU * turns).sin();
                for input in 0..self.inputs {
                    inputs[(k, input)] += 0.1 * random.next();
                }
            }
            let mut outputs = plant.simulate(&DVector::zeros(model.order()), &inputs);
            for mut column in outputs.column_iter_mut() {
                let noise = 0.02 * (column.norm_squared() / samples as f64).sqrt();
                column.apply(|y| *y += noise * random.next());
            }
            records.push(FlightRecord {
                name: format!("sweep {number}"),
                time_s: (0..samples).map(|k| step_s * k as f64).collect(),
                inputs,
                outputs,
            });
        }
        records
    }

    /// Returns a stable aircraft with seven modes of damping ratio 0.5 from 0.8 to 15 rad/s.
    fn aircraft(&self, random: &mut UniformNoise) -> StateSpace {
        let mut a = DMatrix::zeros(14, 14);
        for (mode, omega) in [0.8, 1.5, 2.5, 4.0, 6.0, 9.0, 15.0].into_iter().enumerate() {
            let row = 2 * mode;
            a[(row, row + 1)] = omega;
            a[(row + 1, row)] = -omega;
            a[(row + 1, row + 1)] = -omega;
        }
        let b = DMatrix::from_fn(14, self.inputs, |_, _| random.next());
        let c = DMatrix::from_fn(self.outputs, 14, |_, _| random.next());
        let d = DMatrix::zeros(self.outputs, self.inputs);
        StateSpace::new(a, b, c, d).expect("the matrices fit together")
    }
}

/// Pseudorandom numbers between -1 and 1 (Lehmer's generator).
struct UniformNoise(u64);

impl UniformNoise {
    fn next(&mut self) -> f64 {
        self.0 = self.0 * 48_271 % 2_147_483_647;
        self.0 as f64 / 1_073_741_823.5 - 1.0
    }
}
