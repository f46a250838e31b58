//! Poles and zeros of published and synthetic models, modes of the example, and envelopes of
//! maximum unnoticeable added dynamics (MUAD).

use gdcm_method::fidelity::Muad;
use gdcm_model::response::zeros::{finite_zeros, transmission_zeros};
use gdcm_model::response::{evaluate, modes};
use gdcm_study::jobs::curve_jobs::ConditionModes;

use super::responses::model_of;
use super::*;

const MODELS: [&str; 5] = [
    "compleib_HE2_AH64_130kt.json",
    "compleib_HE3_Bell205_6out.json",
    "westland_lynx_hover_6out.json",
    "yamaha_R50_hover_mettler.json",
    "../near-defective-model.json",
];

fn state_space(file: &str) -> StateSpace {
    match model_of(file) {
        Dynamics::StateSpace(model) => model,
        Dynamics::Measured(_) => panic!("{file} has matrices"),
    }
}

/// Computes `C (sI - A)^-1 B + D` for one pair by dense elimination.
fn value_at(model: &StateSpace, pair: Pair, s: Complex<f64>) -> Complex<f64> {
    let n = model.order();
    let resolvent = DMatrix::from_fn(n, n, |row, column| {
        (if row == column { s } else { Complex::from(0.0) }) - model.a()[(row, column)]
    });
    let states = resolvent
        .lu()
        .solve(&model.b().column(pair.input).map(Complex::from))
        .unwrap();
    let through: Complex<f64> = model
        .c()
        .row(pair.output)
        .iter()
        .zip(states.iter())
        .map(|(c, x)| x * *c)
        .sum();
    through + model.d()[(pair.output, pair.input)]
}

#[test]
fn power_sums_of_the_poles_equal_the_traces_of_matrix_powers() {
    for file in MODELS {
        let model = state_space(file);
        let poles: Vec<Complex<f64>> = modes(&model)
            .unwrap()
            .iter()
            .map(|mode| mode.pole)
            .collect();
        assert_eq!(poles.len(), model.order());
        let mut power = model.a().clone();
        let mut size = model.a().norm();
        for exponent in 1..=4 {
            let sum: Complex<f64> = poles.iter().map(|pole| pole.powi(exponent)).sum();
            // Similar matrices have equal traces. `size` bounds the entries of the power, and thus
            // its rounding errors.
            assert!(
                (sum - power.trace()).norm() <= 1e-12 * size,
                "{file}, power {exponent}: sum over poles {sum}, trace {}",
                power.trace()
            );
            power = &power * model.a();
            size *= model.a().norm();
        }
    }
}

#[test]
fn poles_of_a_near_defective_chain_are_approximate_and_have_no_participation() {
    let found = modes(&state_space("../near-defective-model.json")).unwrap();
    for mode in &found[..4] {
        // A perturbation of about 1e-15 |A| with |A| up to 1e3 moves the poles of a chain of four
        // by its fourth root, 1e-3.
        assert!((mode.pole + 0.001).norm() < 0.01, "{}", mode.pole);
        assert!(mode.participation.is_err(), "{mode:?}");
    }
    assert!(
        (found[4].pole + 0.001).norm() > 0.03,
        "the fifth pole is not of the chain: {}",
        found[4].pole
    );
}

#[test]
fn the_responses_of_published_models_are_zero_at_their_zeros() {
    let mut checked = 0;
    for file in MODELS {
        let model = state_space(file);
        let omega: Vec<f64> = (0..60)
            .map(|k| 10.0_f64.powf(-2.0 + 0.07 * f64::from(k)))
            .collect();
        let response = evaluate(&model, &omega);
        for pair in response.curves().pairs() {
            let Ok(zeros) = transmission_zeros(&model, pair) else {
                continue;
            };
            assert!(zeros.finite.len() + zeros.infinite <= model.order());
            let peak = response
                .curve(pair)
                .iter()
                .map(|value| value.norm())
                .fold(0.0, f64::max);
            for zero in &zeros.finite {
                let value = value_at(&model, pair, *zero).norm();
                // The closer a zero is to a pole, the larger is its rounding error; zeros within
                // 1e-4 of a pole determine this bound.
                assert!(
                    value < 1e-6 * peak,
                    "{file} {pair:?} {zero}: {value:e} of {peak:e}"
                );
                checked += 1;
            }
        }
    }
    assert!(checked > 300, "{checked} zeros");
}

#[test]
fn muad_envelopes_match_the_reference() {
    let golden = json(include_str!(
        "../../../../../tests/data/reference/muad-golden.json"
    ));
    let rows = list(&golden["rows"]);
    assert_eq!(rows.len(), 14);
    for row in rows {
        let muad = Muad::at(number(&row["w"]));
        let found = [muad.magnitude_db, muad.phase_deg].concat();
        let keys = ["gain_lo_dB", "gain_up_dB", "phase_lo_deg", "phase_up_deg"];
        let expected = keys.map(|key| number(&row[key]));
        // The reference evaluates the same formula in another order.
        assert!(
            found
                .iter()
                .zip(expected)
                .all(|(found, expected)| (found - expected).abs() < 1e-11),
            "{muad:?}"
        );
    }
}

/// Returns the names of the models of an example condition at which the track of some mode is
/// discontinuous.
fn models_with_mode_jumps(id: i64) -> Vec<String> {
    let dataset = &crate::REFERENCE_DATASET.dataset;
    let modes =
        ConditionModes::compute(dataset.condition(ConditionId(id)).unwrap(), &Unobserved).unwrap();
    let names = modes.condition.bundle(BundleKind::Physics);
    let suggested = EXAMPLE_WITH_SUGGESTIONS_REJECTED
        .condition(ConditionId(id))
        .unwrap()
        .suggested();
    let reference = (0..names.len())
        .find(|&model| !suggested.contains(&names[model].name))
        .unwrap();
    let tracks = modes.tracks(BundleKind::Physics, reference);
    assert!(
        tracks
            .iter()
            .all(|track| track.modes.iter().all(Option::is_some)),
        "all models have 39 states"
    );
    let mut models: Vec<usize> = tracks.into_iter().flat_map(|track| track.jumps).collect();
    models.sort_unstable();
    models.dedup();
    models
        .into_iter()
        .map(|model| names[model].name.clone())
        .collect()
}

#[test]
fn mode_tracks_are_discontinuous_exactly_at_the_suggested_outliers() {
    let suggested = EXAMPLE_WITH_SUGGESTIONS_REJECTED
        .condition(ConditionId(10))
        .unwrap()
        .suggested();
    assert_eq!(suggested.len(), 3);
    assert_eq!(models_with_mode_jumps(10), suggested);
    for smooth in [1, 3] {
        assert_eq!(
            models_with_mode_jumps(smooth),
            [""; 0],
            "condition {smooth}"
        );
    }
}

#[test]
fn actuators_and_sensors_do_not_participate_in_slow_modes() {
    let condition = crate::REFERENCE_DATASET.dataset.conditions()[0].clone();
    let nominal = &condition.bundle(BundleKind::Physics)[condition.nominal()];
    assert_eq!(
        (
            nominal.states.len(),
            nominal.state_name(4).as_str(),
            nominal.state_name(39).as_str()
        ),
        (39, "q", "state 40")
    );
    let modes = ConditionModes::compute(&condition, &Unobserved).unwrap();
    let of_nominal = modes.physics[condition.nominal()].as_ref().unwrap();
    let mut slow = 0;
    for mode in of_nominal {
        let shares = match &mode.participation {
            Ok(shares) => shares,
            // Participation is undefined for equal poles, which identical sensors have.
            Err(_) => {
                let near = of_nominal
                    .iter()
                    .filter(|other| (other.pole - mode.pole).norm() < 1e-3 * mode.frequency_rad_s);
                assert!(near.count() > 1, "{}", mode.pole);
                continue;
            }
        };
        assert!((shares.iter().map(|(_, share)| share).sum::<f64>() - 1.0).abs() < 1e-12);
        if mode.frequency_rad_s < 5.0 {
            slow += 1;
            // Actuators and sensors do not participate in slow modes: nothing acts on actuators,
            // and sensors act on nothing.
            for (state, share) in shares
                .iter()
                .map(|&(state, share)| (nominal.state_name(state), share))
            {
                let is_attached = state.starts_with("act_") || state.starts_with("sens_");
                assert!(
                    !is_attached || share < 1e-6,
                    "{state} {share} in {}",
                    mode.pole
                );
            }
        }
    }
    assert!(slow >= 6, "{slow} rigid-body modes");
}

#[test]
fn responses_of_every_model_of_a_condition_are_small_at_their_zeros() {
    let condition = crate::REFERENCE_DATASET.dataset.conditions()[0].clone();
    let pair = crate::REFERENCE_DATASET
        .dataset
        .find_pair("Q", "LON")
        .unwrap();
    for kind in BundleKind::BOTH {
        for model in condition.bundle(kind) {
            let Dynamics::StateSpace(space) = &model.dynamics else {
                continue;
            };
            let zeros = finite_zeros(&model.dynamics, pair);
            assert!(!zeros.is_empty(), "{}", model.name);
            for zero in &zeros {
                let beside = value_at(
                    space,
                    pair,
                    zero + Complex::new(0.01 * (1.0 + zero.norm()), 0.0),
                );
                assert!(
                    value_at(space, pair, *zero).norm() < 1e-3 * beside.norm(),
                    "{} {zero}",
                    model.name
                );
            }
        }
    }
}
