//! Error bars (M13: `docs/error-bars.md`).
//!
//! In the reference, q is a result for a response: the logarithm of its net gain, or its delay in
//! s. Its standard deviations are `u_phys`, from substituting the other physics models (other
//! trims), and `u_id`, from substituting the other identified models.

use gdcm_method::uncertainty::{Bar, Scalar, VarianceComponent, student_quantile};
use gdcm_model::dataset::{ConditionId, Pair};
use gdcm_model::progress::Unobserved;

use crate::check::{CheckFault, Found};
use crate::reference::{Reference, UNCERTAINTY};
use crate::reference_study::ReferenceStudy;

/// Confidence level in the reference file.
const LEVEL: f64 = 0.9;

/// Compares the error bars for net gains and delays with the reference.
pub(super) fn bars_of_the_example(study: &mut ReferenceStudy) -> Result<Found, CheckFault> {
    let analysis = study.analysis()?;
    let uncertainty = study
        .engine()
        .uncertainty(&analysis, &Unobserved)
        .map_err(CheckFault::no_result)?;
    let case = UNCERTAINTY
        .read()?
        .member("cases")?
        .member("F_example_dataset")?;
    let mut found = Found::default();
    for (name, scalar) in [
        ("net_gain_bars", Scalar::NetGain as fn(Pair) -> Scalar),
        ("delay_bars", Scalar::Delay),
    ] {
        for entry in case.list(name)? {
            let names = entry.texts("pair")?;
            let [output, input] = names.as_slice() else {
                return Err(CheckFault::no_result("a pair has two names"));
            };
            let Some(pair) = analysis.study.dataset.find_pair(output, input) else {
                return Err(CheckFault::no_result(format!(
                    "no response {output}/{input}"
                )));
            };
            for expected in entry.list("bars")? {
                let id = ConditionId(expected.integer("condition")?);
                found.instance();
                match uncertainty.bar(id, scalar(pair)) {
                    Some(bar) => compare_bar(&mut found, bar, &expected)?,
                    None => found.agree(false),
                }
            }
        }
    }
    Ok(found)
}

fn compare_bar(found: &mut Found, bar: &Bar, expected: &Reference) -> Result<(), CheckFault> {
    found.deviation(bar.value - expected.number("q")?);
    found.deviation(deviation_of(bar.trim) - expected.number("u_phys")?);
    found.deviation(deviation_of(bar.identification) - expected.number("u_id")?);
    let half_width = bar.half_width(LEVEL).unwrap_or(0.0);
    found.deviation(half_width - expected.number("half_width")?);
    Ok(())
}

/// Returns a variance component's standard deviation; 0 if the bar lacks the component.
fn deviation_of(part: Option<VarianceComponent>) -> f64 {
    match part {
        Some(part) => part.variance.sqrt(),
        None => 0.0,
    }
}

/// Each row: degrees of freedom, t at 90 %, t at 95 % (two-sided).
const STUDENT: [[f64; 3]; 6] = [
    [1.0, 6.314, 12.706],
    [3.0, 2.353, 3.182],
    [5.0, 2.015, 2.571],
    [10.0, 1.812, 2.228],
    [30.0, 1.697, 2.042],
    [120.0, 1.658, 1.980],
];

/// Compares Student's quantiles with a printed table.
pub(super) fn student_quantiles(_: &mut ReferenceStudy) -> Result<Found, CheckFault> {
    let mut found = Found::default();
    for [degrees, at_90, at_95] in STUDENT {
        found.instance();
        found.deviation(student_quantile(0.90, degrees) - at_90);
        found.deviation(student_quantile(0.95, degrees) - at_95);
    }
    Ok(found)
}
