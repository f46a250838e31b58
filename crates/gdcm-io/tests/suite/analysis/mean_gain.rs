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
    let models = dataset.condition(CONDITION).unwrap().bundle(kind).iter();
    let kept = models.filter(|model| !rejected.contains(model.name.as_str()));
    let of_model = |dynamics| {
        FrequencyResponse::from_dynamics(dynamics, grid)
            .curves()
            .map(|_, curve| {
                curve
                    .iter()
                    .map(|value: &Complex<f64>| value.re.hypot(value.im))
                    .collect()
            })
    };
    kept.map(|model| of_model(&model.dynamics)).collect()
}

type Magnitudes = PairTable<Vec<f64>>;

/// Returns the median; for an even count, the mean of the middle two values.
fn plain_median(mut values: Vec<f64>) -> f64 {
    values.sort_by(f64::total_cmp);
    0.5 * (values[values.len() / 2 - 1] + values[values.len() / 2])
}

#[test]
fn g_from_the_mean_is_the_mean_of_ln_g_of_every_pair_of_kept_models() {
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
        "as the plain median takes them"
    );
    let [physics, identified] =
        BundleKind::BOTH.map(|kind| magnitudes(&study.dataset, kind, &grid, &rejected));
    let found = &analysis.condition(CONDITION).unwrap().comparison.delta.gain;
    let mut moved = 0.0_f64;
    for pair in found.pairs() {
        let Some(gain) = found[pair] else { continue };
        let ln_gain = |simulated: &Magnitudes, flight: &Magnitudes| {
            plain_median(
                flight[pair]
                    .iter()
                    .zip(&simulated[pair])
                    .map(|(flight, of)| flight / of)
                    .collect(),
            )
            .ln()
        };
        let all: Vec<f64> = physics
            .iter()
            .flat_map(|of| identified.iter().map(move |flight| ln_gain(of, flight)))
            .collect();
        let mean = (all.iter().sum::<f64>() / all.len() as f64).exp();
        // The ratios in the program have been converted to decibels and back: some rounding errors.
        assert!(
            (gain / mean - 1.0).abs() < 1e-12,
            "{}: {gain} {mean}",
            study.dataset.pair_name(pair)
        );
        let representatives = of_representatives
            .condition(CONDITION)
            .unwrap()
            .comparison
            .delta
            .gain[pair]
            .unwrap();
        moved = moved.max((gain / representatives - 1.0).abs());
    }
    assert!(
        moved > 0.005,
        "it is another figure than that of the representatives: {moved}"
    );
}

#[test]
fn with_leads_g_from_the_mean_changes_nothing_and_the_settings_say_so() {
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
