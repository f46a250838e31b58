//! `gdcm verify`: comparison with independent figures on this machine.

use std::env::consts::{ARCH, OS};

use gdcm_io::software::software;
use gdcm_model::number_format::counted;
use gdcm_verify::{CheckResult, Verification};

use super::failure::Failure;
use super::printed_lines::{detail, line};
use super::progress::TerminalProgress;
use super::terminal::{keep_checks, print};

/// Runs all comparisons and prints them; fails unless all pass.
pub(super) fn verify() -> Result<(), Failure> {
    let progress = TerminalProgress::new("comparing");
    let verification = Verification::new(&progress)?;
    drop(progress);
    let mut text = line("Program", &software());
    text += &line("Machine", &machine_words());
    for result in &verification.results {
        text.push('\n');
        text += &result_section(result);
    }
    let count = verification.results.len();
    let passed = verification.passed();
    text.push('\n');
    text += &line(
        "Verified",
        &format!("{passed} of {} passed", counted(count, "comparison")),
    );
    keep_checks(&verification.results);
    print(&text)?;
    if passed < count {
        return Err(Failure::Deviating {
            failed: count - passed,
            count,
        });
    }
    Ok(())
}

/// Describes the machine: "x86_64 linux, 2 cores, AVX2 and FMA".
fn machine_words() -> String {
    let cores = match std::thread::available_parallelism() {
        Ok(cores) => counted(cores.get(), "core"),
        Err(_) => "unknown number of cores".to_owned(),
    };
    format!("{ARCH} {OS}, {cores}, {}", instruction_words())
}

/// Names the processor's widest vector instructions, on which the rounding of results depends.
#[cfg(target_arch = "x86_64")]
fn instruction_words() -> &'static str {
    if std::arch::is_x86_feature_detected!("avx512f") {
        "AVX-512"
    } else if std::arch::is_x86_feature_detected!("avx2")
        && std::arch::is_x86_feature_detected!("fma")
    {
        "AVX2 and FMA"
    } else {
        "SSE2"
    }
}

#[cfg(not(target_arch = "x86_64"))]
fn instruction_words() -> &'static str {
    "vector instructions of the architecture"
}

/// Describes a comparison with its outcome.
fn result_section(result: &CheckResult) -> String {
    let check = result.check;
    let verdict = if result.passed() { "pass" } else { "FAIL" };
    let mut text = line(verdict, &format!("{} ({})", check.code, check.sections));
    text += &detail("compared", check.what);
    text += &detail("expected", &format!("by {}", check.source));
    match &result.outcome {
        Ok(found) => {
            let worst = format!(
                "{}, {}: worst deviation {:.1e}, {}",
                counted(found.instances, "instance"),
                counted(found.values, "value"),
                found.worst,
                check.measure
            );
            text += &detail("found", &worst);
        }
        Err(fault) => text += &detail("found", &fault.to_string()),
    }
    let limit = format!("{:.0e}: {}", check.tolerance, check.reason);
    text + &detail("tolerance", &limit)
}
