//! Synthetic aircraft, their flights in closed loop through gusts, and synthetic datasets. The
//! tests of the whole program include this file by its path.

use nalgebra::{DMatrix, DVector, dmatrix};
use serde_json::{Value, json};

use gdcm_model::dataset::StateSpace;
use gdcm_model::simulation::FlightRecord;

/// Returns the number of random cases of a test: `few`, or `many` if the environment variable
/// `GDCM_THOROUGH` is set, as in continuous integration.
pub fn tries<N>(few: N, many: N) -> N {
    if std::env::var_os("GDCM_THOROUGH").is_some() {
        many
    } else {
        few
    }
}

/// Disturbances of a flight; by default still air and exact sensors.
#[derive(Clone, Copy, Default)]
pub struct Gusts {
    /// Scale of the effect of gusts on each state.
    pub states: f64,
    /// Standard deviation of the noise of each sensor.
    pub sensors: f64,
}

impl Gusts {
    /// Returns light gusts and accurate sensors.
    pub fn light() -> Self {
        Self {
            states: 0.01,
            sensors: 0.01,
        }
    }
}

/// Simulation of a flight and of its log.
#[derive(Clone)]
pub struct Flight {
    pub aircraft: StateSpace,
    pub gusts: Gusts,
    /// Gain matrix F of the loop: u = sweep - F y.
    pub feedback: DMatrix<f64>,
    /// Length of a record \[s\].
    pub length_s: f64,
    /// Sample time of the log \[s\].
    pub sample_time_s: f64,
}

impl Flight {
    /// Creates flights of 40 s, logged at 25 Hz, with a light feedback.
    pub fn new(aircraft: StateSpace, gusts: Gusts) -> Self {
        Self {
            aircraft,
            gusts,
            feedback: dmatrix![0.2, 0.1; -0.1, 0.3],
            length_s: 40.0,
            sample_time_s: 0.04,
        }
    }

    /// Returns `count` different records of this flight; reproducible for a given seed.
    pub fn records(&self, seed: u64, count: usize) -> Vec<FlightRecord> {
        (0..count).map(|record| self.record(seed, record)).collect()
    }

    /// Simulates a record in steps of a tenth of the sample time. Inputs have a trim of 5, outputs
    /// a trim that differs by output and record.
    fn record(&self, seed: u64, record: usize) -> FlightRecord {
        const STEPS_PER_SAMPLE: usize = 10;
        let step_s = self.sample_time_s / STEPS_PER_SAMPLE as f64;
        let a = self.aircraft.a();
        let b = self.aircraft.b();
        let c = self.aircraft.c();
        let order = a.nrows();
        let inputs = b.ncols();
        let outputs = c.nrows();
        let mut random = Random(
            seed.wrapping_mul(1000)
                .wrapping_add(record as u64 + 1)
                .wrapping_mul(0x9E37_79B9_7F4A_7C15),
        );
        // Closed loop: dx/dt = (A - B K C) x + B sweep + gusts. The sweep is held at its midpoint
        // over each step.
        let closed = a - b * &self.feedback * c;
        let transition = (&closed * step_s).exp();
        // exp([A B; 0 0] dt) = [Phi Gamma; 0 I], with Gamma the effect of an input held for dt.
        let mut augmented = DMatrix::zeros(order + inputs, order + inputs);
        augmented
            .view_mut((0, 0), (order, order))
            .copy_from(&(&closed * step_s));
        augmented
            .view_mut((0, order), (order, inputs))
            .copy_from(&(b * step_s));
        let input_effect = augmented
            .exp()
            .view((0, order), (order, inputs))
            .into_owned();
        let sweep = Sweep::new(inputs, record, &mut random);
        let samples = (self.length_s / self.sample_time_s).round() as usize;
        let trim = DVector::from_fn(outputs, |output, _| 0.5 + output as f64 + record as f64);
        let mut x = DVector::from_fn(order, |_, _| random.normal());
        let mut gust: DVector<f64> = DVector::zeros(order);
        let mut u = DMatrix::zeros(samples, inputs);
        let mut y = DMatrix::zeros(samples, outputs);
        for sample in 0..samples {
            let time = sample as f64 * self.sample_time_s;
            let output = c * &x;
            let input = sweep.command(time) - &self.feedback * &output;
            u.row_mut(sample).tr_copy_from(&input.add_scalar(5.0));
            let noise = DVector::from_fn(outputs, |_, _| self.gusts.sensors * random.normal());
            y.row_mut(sample).tr_copy_from(&(output + &trim + noise));
            for step in 0..STEPS_PER_SAMPLE {
                let middle = time + (step as f64 + 0.5) * step_s;
                // Gusts: white noise through a first-order lag of 1 s.
                for gust in gust.iter_mut() {
                    *gust += step_s * (4.0 * random.normal() / step_s.sqrt() - *gust);
                }
                x = &transition * x
                    + &input_effect * sweep.command(middle)
                    + &gust * (step_s * self.gusts.states);
            }
        }
        FlightRecord {
            name: format!("flight {}", record + 1),
            time_s: (0..samples)
                .map(|sample| sample as f64 * self.sample_time_s)
                .collect(),
            inputs: u,
            outputs: y,
        }
    }
}

/// Commands of a record: a multisine of 40 lines with random phases for each input, from 0.25 to
/// 8.05 rad/s in steps of 0.2 rad/s. Lines of different inputs and records are 0.01 rad/s apart.
struct Sweep {
    inputs: usize,
    record: usize,
    /// Phases \[rad\], line by line.
    phases: Vec<f64>,
}

impl Sweep {
    const LINES: usize = 40;

    fn new(inputs: usize, record: usize, random: &mut Random) -> Self {
        Self {
            inputs,
            record,
            phases: (0..Self::LINES * inputs)
                .map(|_| std::f64::consts::TAU * random.uniform())
                .collect(),
        }
    }

    /// Returns the commands of all inputs at a time \[s\].
    fn command(&self, time_s: f64) -> DVector<f64> {
        DVector::from_fn(self.inputs, |input, _| self.channel(input, time_s))
    }

    fn channel(&self, input: usize, time_s: f64) -> f64 {
        // One input per record has a large sweep, the others a small one.
        let is_main = input == self.record % self.inputs;
        let size = if is_main { 1.0 } else { 0.3 };
        let offset = 0.01 * (input + self.inputs * self.record) as f64;
        let lines = (0..Self::LINES).map(|line| {
            let omega = 0.25 + 0.2 * line as f64 + offset;
            let phase = self.phases[line * self.inputs + input];
            (omega * time_s + phase).sin() / (1.0 + 0.2 * omega)
        });
        0.3 * size * lines.sum::<f64>()
    }
}

/// Pseudo-random numbers (xorshift).
struct Random(u64);

impl Random {
    fn uniform(&mut self) -> f64 {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 7;
        self.0 ^= self.0 << 17;
        (self.0 >> 11) as f64 / (1_u64 << 53) as f64
    }

    /// Returns an approximately normal deviate with unit variance: the sum of twelve uniform
    /// deviates minus 6.
    fn normal(&mut self) -> f64 {
        (0..12).map(|_| self.uniform()).sum::<f64>() - 6.0
    }
}

/// Returns a stable aircraft with two inputs and two outputs.
pub fn stable_aircraft() -> StateSpace {
    StateSpace::new(
        dmatrix![
            -0.4, 2.1, 0.0, 0.0;
            -2.1, -0.4, 0.0, 0.3;
            0.0, 0.0, -1.5, 0.8;
            0.2, 0.0, -1.1, -0.6
        ],
        dmatrix![
            1.0, 0.2;
            0.0, 0.6;
            0.5, -1.0;
            -0.3, 0.8
        ],
        dmatrix![
            0.6, 1.0, 0.3, 0.0;
            0.2, 0.5, -0.8, 1.0
        ],
        DMatrix::zeros(2, 2),
    )
    .expect("the shapes of the matrices agree")
}

/// Returns a dataset of two lags (poles -1 and -3 rad/s) with one physics and one identified model,
/// whose output matrices C are given.
pub fn two_lags(physics: [[f64; 2]; 2], identified: [[f64; 2]; 2]) -> Value {
    let mut nominal = lag_model(physics);
    nominal["role"] = json!("nominal");
    json!({"format": "gdcm-dataset", "version": 1, "name": "two lags",
        "inputs": [{"name": "I0", "unit": "%"}, {"name": "I1", "unit": "%"}],
        "outputs": [{"name": "O0", "unit": "deg/s"}, {"name": "O1", "unit": "deg/s"}],
        "on_axis": [["O0", "I0"], ["O1", "I1"]],
        "frequency_band": {"min": 0.5, "max": 12.0, "unit": "rad/s"},
        "conditions": [{"id": 1, "name": "hover", "airspeed_kt": 0.0, "physics_models": [nominal],
            "identified_models": [lag_model(identified)]}]})
}

fn lag_model(c: [[f64; 2]; 2]) -> Value {
    json!({"name": "model", "A": [[-1.0, 0.0], [0.0, -3.0]], "B": [[1.0, 0.0], [0.0, 1.0]],
        "C": c, "D": [[0.0, 0.0], [0.0, 0.0]]})
}
