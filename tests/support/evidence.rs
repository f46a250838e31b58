//! Figures that tests record for `docs/verification.md`, as lines of JSON in the folder that the
//! environment variable `GDCM_EVIDENCE` names. Without the variable nothing is written.
//!
//! Crates include this file in their tests by its path.

use std::path::PathBuf;

use serde_json::{Value, json};

/// Deviations of a test from its expected values.
#[allow(dead_code, reason = "not every crate records deviations")]
pub struct Deviations<'a> {
    /// Stable code of the evidence, a row of `docs/verification.md`.
    pub code: &'a str,
    /// Number of problems, models, records or conditions.
    pub instances: usize,
    /// Number of compared values.
    pub values: usize,
    /// Maximum deviation.
    pub worst: f64,
    /// Maximum permitted deviation.
    pub tolerance: f64,
}

/// Records the deviations of the running test.
#[allow(dead_code, reason = "not every crate records deviations")]
#[track_caller]
pub fn record(found: Deviations<'_>) {
    assert!(found.worst.is_finite(), "{}", found.code);
    write(
        found.code,
        &json!({
            "instances": found.instances,
            "values": found.values,
            "worst": found.worst,
            "tolerance": found.tolerance,
        }),
    );
}

/// Writes the figures of the running test, if they are asked for.
fn write(code: &str, figures: &Value) {
    let Some(folder) = std::env::var_os("GDCM_EVIDENCE") else {
        return;
    };
    let thread = std::thread::current();
    let test = thread.name().expect("the thread of a test has its name");
    let mut line = json!({"code": code, "crate": env!("CARGO_PKG_NAME"), "test": test});
    for (name, figure) in figures.as_object().expect("figures have names") {
        line[name] = figure.clone();
    }
    let folder = PathBuf::from(folder);
    std::fs::create_dir_all(&folder).expect("the folder can be made");
    // One file for each code: tests run at the same time. A test that runs again replaces its line.
    std::fs::write(folder.join(format!("{code}.jsonl")), format!("{line}\n"))
        .expect("the file can be written");
}

/// Share of intervals that contain the true value.
#[allow(dead_code, reason = "not every crate measures a coverage")]
pub struct Coverage<'a> {
    /// Stable code of the evidence, a row of `docs/verification.md`.
    pub code: &'a str,
    /// Number of intervals.
    pub intervals: usize,
    /// Number of intervals that contain the true value.
    pub covered: usize,
    /// Nominal share.
    pub nominal: f64,
    /// Seeds of the generated data.
    pub seeds: &'a str,
}

/// Records the coverage that the running test measured.
#[allow(dead_code, reason = "not every crate measures a coverage")]
pub fn record_coverage(found: Coverage<'_>) {
    write(
        found.code,
        &json!({
            "intervals": found.intervals,
            "covered": found.covered,
            "nominal": found.nominal,
            "seeds": found.seeds,
        }),
    );
}
