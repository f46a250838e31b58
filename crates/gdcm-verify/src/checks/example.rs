//! The whole method on the reference dataset, against independent code (M3 to M12): a function for
//! each comparison in [`CHECKS`](super::CHECKS).
//!
//! In the reference, G and D are the gain and the delay that would match a single response (M6),
//! `k` and `tau` those of the channels (M8, M9) within their bounds `lb` and `ub` (M7), and J is
//! the cost, the distance between two responses (M4). A result is *matched* if every held response
//! gets its G or D.
//!
//! A model's *score* is its mean distance to the other models of its bundle; the model with the
//! lowest score represents the bundle. Its *discontinuity ratio* is its distance to models at other
//! trims, relative to the distance that the trims explain; a model with a large ratio is a
//! suggested outlier (M5).

use gdcm_model::dataset::{BundleKind, ConditionId, PairTable};
use gdcm_study::ConditionAnalysis;

use crate::check::{CheckFault, Found};
use crate::reference::{EXAMPLE, Reference};
use crate::reference_study::ReferenceStudy;

/// Index of J before the correction in the reference's lists; J after the correction follows.
const BEFORE: usize = 0;
/// Scale for gains, ratios and their logarithms, whose order of magnitude is 1.
const GAIN: f64 = 1.0;
/// Scale for delays \[s\]: a tenth of the smallest delay that matters to an engineer.
const DELAY_S: f64 = 1e-3;
/// Scale for J: a fiftieth of the value at which responses are almost indistinguishable.
const COST: f64 = 1.0;
/// Scale for the objective in eq. (11), a sum of squared delays \[s^2\].
const DELAY_OBJECTIVE: f64 = 1e-4;

/// Runs `compare` on every condition in the reference; a condition without a result disagrees.
fn each_condition(
    study: &mut ReferenceStudy,
    compare: fn(&mut Found, &ConditionAnalysis, &Reference) -> Result<(), CheckFault>,
) -> Result<Found, CheckFault> {
    let analysis = study.analysis()?;
    let mut found = Found::default();
    for expected in EXAMPLE.read()?.list("conditions")? {
        let id = ConditionId(expected.integer("id")?);
        found.instance();
        match analysis.condition(id) {
            Some(result) => compare(&mut found, result, &expected)?,
            None => found.agree(false),
        }
    }
    Ok(found)
}

/// Compares tables entry by entry; missing values disagree.
fn compare_table<T>(
    found: &mut Found,
    own: &PairTable<Option<T>>,
    value: impl Fn(&T) -> f64,
    expected: &PairTable<f64>,
    scale: f64,
) {
    for (pair, own) in own.iter() {
        match own {
            Some(own) => found.scaled(value(own), expected[pair], scale),
            None => found.agree(false),
        }
    }
}

/// Compares representatives, suggested outliers, scores and discontinuity ratios.
pub(super) fn representatives(study: &mut ReferenceStudy) -> Result<Found, CheckFault> {
    each_condition(study, |found, result, expected| {
        let physics = result.representative_name(BundleKind::Physics);
        found.agree(physics == expected.text("physics")?);
        let identified = result.representative_name(BundleKind::Identified);
        found.agree(identified == expected.text("identified")?);
        found.agree(result.suggested() == expected.texts("outliers")?);
        // Rejected models have no score, neither in the program nor in the reference.
        let scores: Vec<f64> = result
            .comparison
            .physics
            .scores
            .iter()
            .copied()
            .flatten()
            .collect();
        found.all_scaled(&scores, &expected.numbers("scores")?, COST);
        let Ok(discontinuity) = &result.bundle_metrics.discontinuity else {
            found.agree(false);
            return Ok(());
        };
        let ratios: Vec<f64> = discontinuity.ratios.iter().copied().flatten().collect();
        found.all_scaled(&ratios, &expected.numbers("discontinuity")?, GAIN);
        Ok(())
    })
}

/// Compares G, D and the bounds.
pub(super) fn deltas(study: &mut ReferenceStudy) -> Result<Found, CheckFault> {
    each_condition(study, |found, result, expected| {
        let delta = &result.comparison.delta;
        compare_table(
            found,
            &delta.gain,
            |gain| *gain,
            &expected.table("G")?,
            GAIN,
        );
        compare_table(
            found,
            &delta.delay_s,
            |delay_s| *delay_s,
            &expected.table("D")?,
            DELAY_S,
        );
        found.scaled(result.gain_bounds().lower, expected.number("lb")?, GAIN);
        found.scaled(result.gain_bounds().upper, expected.number("ub")?, GAIN);
        let upper_s = expected.number("tau_ub")?;
        found.scaled(result.delay_upper_s(), upper_s, DELAY_S);
        Ok(())
    })
}

/// Compares the channels' gains and delays, the minima of their objectives, and whether the held
/// responses are matched.
pub(super) fn corrections(study: &mut ReferenceStudy) -> Result<Found, CheckFault> {
    each_condition(study, |found, result, expected| {
        let own = &result.correction;
        found.all_scaled(&own.input_gains, &expected.numbers("k_in")?, GAIN);
        found.all_scaled(&own.output_gains, &expected.numbers("k_out")?, GAIN);
        found.all_scaled(&own.input_delays_s, &expected.numbers("tau_in")?, DELAY_S);
        found.all_scaled(&own.output_delays_s, &expected.numbers("tau_out")?, DELAY_S);
        let gain_objective = expected.number("gain_objective")?;
        found.scaled(result.gains.objective, gain_objective, GAIN);
        let delay_objective = expected.number("delay_objective")?;
        found.scaled(result.delays.objective, delay_objective, DELAY_OBJECTIVE);
        found.agree(result.gains.matched == expected.flag("gain_matched")?);
        found.agree(result.delays.matched == expected.flag("delay_matched")?);
        Ok(())
    })
}

/// Compares the magnitude and the phase part of J, before and after the correction.
pub(super) fn costs(study: &mut ReferenceStudy) -> Result<Found, CheckFault> {
    each_condition(study, |found, result, expected| {
        for (index, magnitude) in expected.list("J_mag")?.iter().enumerate() {
            compare_costs(found, result, Part::Magnitude, index, magnitude)?;
        }
        for (index, phase) in expected.list("J_phase")?.iter().enumerate() {
            compare_costs(found, result, Part::Phase, index, phase)?;
        }
        Ok(())
    })
}

/// Part of J.
#[derive(Clone, Copy)]
enum Part {
    Magnitude,
    Phase,
}

/// Compares one part of J with the reference for all responses, before the correction if `index` is
/// [`BEFORE`], after it otherwise.
fn compare_costs(
    found: &mut Found,
    result: &ConditionAnalysis,
    part: Part,
    index: usize,
    expected: &Reference,
) -> Result<(), CheckFault> {
    let expected = expected.as_matrix()?;
    for (pair, cost) in result.cost.iter() {
        let Some(change) = cost else {
            found.agree(false);
            continue;
        };
        let cost = match index {
            BEFORE => change.uncorrected,
            _ => change.corrected,
        };
        let own = match part {
            Part::Magnitude => cost.magnitude,
            Part::Phase => cost.phase,
        };
        found.scaled(own, expected[(pair.output, pair.input)], COST);
    }
    Ok(())
}

/// Compares the scheduled gains, and the changes of J that they cause in the nominal model.
pub(super) fn assessment(study: &mut ReferenceStudy) -> Result<Found, CheckFault> {
    let analysis = study.analysis()?;
    let schedule = analysis.schedule.as_ref().map_err(CheckFault::no_result)?;
    let mut found = Found::default();
    for expected in EXAMPLE.read()?.list("assessment")? {
        let id = ConditionId(expected.integer("id")?);
        found.instance();
        let is_left_out = expected.flag("left_out")?;
        let (Some(condition), Some(assessed)) = (
            analysis.study.dataset.condition(id),
            analysis.assessment.get(&id),
        ) else {
            found.agree(false);
            continue;
        };
        found.agree(assessed.is_err() == is_left_out);
        let Ok(changes) = assessed else {
            continue;
        };
        let scheduled = schedule.at(condition.flight_state().airspeed_kt);
        found.all_scaled(&scheduled.input_gains, &expected.numbers("k_in")?, GAIN);
        found.all_scaled(&scheduled.output_gains, &expected.numbers("k_out")?, GAIN);
        let magnitude = expected.table("dJ_mag")?;
        compare_table(
            &mut found,
            changes,
            |change| change.magnitude(),
            &magnitude,
            COST,
        );
        let phase = expected.table("dJ_phase")?;
        compare_table(&mut found, changes, |change| change.phase(), &phase, COST);
    }
    Ok(found)
}
