//! G as the mean of its logarithm over all pairs of kept models.

use std::collections::BTreeSet;

use gdcm_method::correction::delta::GainSource;
use gdcm_model::dataset::{Dataset, ModelId};
use gdcm_study::PhaseCorrection;

use super::*;

const CONDITION: ConditionId = ConditionId(10);

fn set(study: &mut Study, edit: Edit) {
    study.apply(&edit).unwrap();
}

/// Returns `|H|` of every kept model of a bundle at each frequency.
fn magnitudes(
    dataset: &Dataset,
    kind: BundleKind,
    grid: &FrequencyGrid,
    rejected: &BTreeSet<&str>,
) -> Vec<Magnitudes> {
    let mut magnitudes = Vec::new();
    for model in dataset.condition(CONDITION).unwrap().bundle(kind) {
        if !rejected.contains(model.name.as_str()) {
            let response = FrequencyResponse::from_dynamics(&model.dynamics, grid);
            magnitudes.push(response.curves().map(|_, curve| {
                curve
                    .iter()
                    .map(|value: &Complex<f64>| value.re.hypot(value.im))
                    .collect()
            }));
        }
    }
    magnitudes
}

/// `|H|` of each response at each frequency.
type Magnitudes = PairTable<Vec<f64>>;

/// Returns the median of an even number of values: the mean of the middle two.
fn plain_median(mut values: Vec<f64>) -> f64 {
    values.sort_by(f64::total_cmp);
    0.5 * (values[values.len() / 2 - 1] + values[values.len() / 2])
}

#[test]
fn g_from_the_mean_averages_ln_g_over_all_pairs_of_kept_models() {
    let mut study = study_of_example();
    let rejected: BTreeSet<&str> = BTreeSet::from(["nominal", "ROLL+5deg"]);
    let models = rejected
        .iter()
        .map(|name| ModelId::new(CONDITION, BundleKind::Physics, *name))
        .collect();
    study.apply(&Edit::RejectEach(models)).unwrap();
    let of_representatives = analyze(&mut Engine::default(), &study);
    set(
        &mut study,
        setting_table::GAIN_SOURCE.to(GainSource::MeanOfPairs),
    );
    let analysis = analyze(&mut Engine::default(), &study);
    let grid = FrequencyGrid::logarithmic(study.settings.band, study.settings.points);
    assert!(
        study.settings.points.is_multiple_of(2),
        "the plain median expects an even count"
    );
    let [physics, identified] =
        BundleKind::BOTH.map(|kind| magnitudes(&study.dataset, kind, &grid, &rejected));
    let found = &analysis.condition(CONDITION).unwrap().comparison.delta.gain;
    let mut largest_difference = 0.0_f64;
    for pair in found.pairs() {
        let Some(gain) = found[pair] else { continue };
        let mut ln_gains = Vec::new();
        for simulated in &physics {
            for flight in &identified {
                let ratios = flight[pair]
                    .iter()
                    .zip(&simulated[pair])
                    .map(|(flight, simulated)| flight / simulated)
                    .collect();
                ln_gains.push(plain_median(ratios).ln());
            }
        }
        let mean = (ln_gains.iter().sum::<f64>() / ln_gains.len() as f64).exp();
        // The ratios in the program have been converted to decibels and back: some rounding errors.
        assert!(
            (gain / mean - 1.0).abs() < 1e-12,
            "{}: {gain} instead of {mean}",
            study.dataset.pair_name(pair)
        );
        let representatives = of_representatives
            .condition(CONDITION)
            .unwrap()
            .comparison
            .delta
            .gain[pair]
            .unwrap();
        largest_difference = largest_difference.max((gain / representatives - 1.0).abs());
    }
    assert!(
        largest_difference > 0.005,
        "G differs from that of the representatives by {largest_difference} at most"
    );
}

#[test]
fn with_leads_the_gain_source_has_no_effect_and_the_settings_report_it() {
    let mut study = study_of_example();
    set(&mut study, setting_table::PHASE.to(PhaseCorrection::Lead));
    let of_representatives = analyze(&mut Engine::default(), &study);
    assert!(!study.settings.is_gain_source_idle());
    set(
        &mut study,
        setting_table::GAIN_SOURCE.to(GainSource::MeanOfPairs),
    );
    let of_mean = analyze(&mut Engine::default(), &study);
    for (id, result) in &of_mean.conditions {
        let with = result.as_ref().unwrap();
        let without = of_representatives.condition(*id).unwrap();
        assert_eq!(with.correction, without.correction, "condition {id}");
    }
    assert!(study.settings.is_gain_source_idle());
    set(&mut study, setting_table::PHASE.to(PhaseCorrection::Delay));
    assert!(!study.settings.is_gain_source_idle());
}
