//! `cargo bench --bench identification`: models of the example's eleven conditions from their
//! flight records, stage by stage, compared with the normal matrix of the refinement as a plain
//! product.
//!
//! Targets on two cores, for 9 records of 60 s at 50 Hz, 4 inputs and 6 outputs: 0.4 s to the first
//! model, 1 s in total, 12 s for all eleven conditions.

use std::path::Path;
use std::sync::Mutex;
use std::time::Instant;

use nalgebra::DMatrix;

use gdcm::executor::Pool;
use gdcm_io::import::record_files::read_records;
use gdcm_io::{FolderProgress, embedded_example};
use gdcm_model::dataset::{ConditionId, StateSpace};
use gdcm_model::progress::Progress;
use gdcm_study::jobs::identification_jobs::IdentificationRequest;
use gdcm_sysid::identification::Preparation;
use gdcm_sysid::records::{LaidOutRecord, RecordChannels, TimeWish};

struct Silent;

impl FolderProgress for Silent {
    fn reading(&self, _: usize, _: usize, _: &str) {}
}

/// Records the start time of each step.
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
}

impl Progress for Stages {
    fn cancelled(&self) -> bool {
        false
    }

    fn advanced(&self, _done: usize, _total: usize) {}

    fn step(&self, what: &str) {
        self.steps
            .lock()
            .expect("nothing panics")
            .push((self.now_ms(), what.to_owned()));
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
        .map(|table| LaidOutRecord::proposed(table, &channels, &TimeWish::default()).0)
        .collect();
    let (inputs, outputs) = dataset.names_of_channels();
    let preparation = Preparation::of(&borrowed(&inputs), &borrowed(&outputs));
    let band = dataset.band();
    let mut all_ms = 0.0;
    let mut worst = 0.0f64;
    for condition in dataset.conditions() {
        let own = records
            .iter()
            .filter(|record| record.guess.condition_of(&dataset) == Some(condition.id()));
        let request =
            IdentificationRequest::from_used(own, preparation.clone(), [band.min(), band.max()]);
        let request = request.expect("every condition has records");
        let stages = Stages::new();
        let found = request
            .identify(&Pool, &stages)
            .expect("the example's flights are good");
        let ms = stages.now_ms();
        all_ms += ms;
        let ratio = found.held_out_cost.unwrap_or(f64::NAN) / found.cost;
        worst = worst.max(ratio);
        println!(
            "condition {:2}: order {:2}, J/dof {:.3}, held-out cost {ratio:.2} times as large; first model {:4.0} ms, total {ms:4.0} ms",
            condition.id(),
            found.refined.order().unwrap_or_default(),
            found.cost,
            stages
                .first_model
                .lock()
                .expect("nothing panics")
                .unwrap_or(f64::NAN),
        );
        if condition.id() == ConditionId(10) {
            let steps = stages.steps.lock().expect("nothing panics");
            for (at, next) in steps
                .iter()
                .zip(steps.iter().skip(1).map(|next| next.0).chain([ms]))
            {
                println!("    {:6.1} ms  {}", next - at.0, at.1);
            }
        }
    }
    println!(
        "all {} conditions {:.1} s; worst held-out ratio {worst:.2}",
        dataset.conditions().len(),
        1e-3 * all_ms
    );
    plain_normal_matrix();
}

fn borrowed(names: &[String]) -> Vec<&str> {
    names.iter().map(String::as_str).collect()
}

/// Prints the time to compute the normal matrix of a Gauss-Newton step from a stored Jacobian: 8
/// records of 150 spectral lines, 6 outputs, real and imaginary parts, 200 parameters. A refinement
/// takes about 30 steps.
fn plain_normal_matrix() {
    let jacobian = DMatrix::from_fn(8 * 150 * 6 * 2, 200, |row, column| {
        ((row * 31 + column * 17) % 101) as f64 / 101.0
    });
    let shortest = (0..5).map(|_| {
        let start = Instant::now();
        std::hint::black_box(jacobian.tr_mul(&jacobian));
        1e3 * start.elapsed().as_secs_f64()
    });
    println!(
        "plain normal matrix of one step: {:.1} ms",
        shortest.fold(f64::INFINITY, f64::min)
    );
}
