//! Poles and zeros of published and made-up models, modes of the example, and what a pilot does not notice.

use gdcm::fidelity::Muad;
use gdcm::response::{evaluate, modes, transmission_zeros};
use gdcm::study::ConditionModes;

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

/// `C (sI - A)^-1 B + D` of one pair by dense elimination.
fn value_at(model: &StateSpace, pair: Pair, s: Complex<f64>) -> Complex<f64> {
    let n = model.order();
    let resolvent = DMatrix::from_fn(n, n, |row, column| {
        (if row == column { s } else { Complex::from(0.0) }) - model.a()[(row, column)]
    });
    let states = resolvent.lu().solve(&model.b().column(pair.input).map(Complex::from)).unwrap();
    let through: Complex<f64> = model.c().row(pair.output).iter().zip(states.iter()).map(|(c, x)| x * *c).sum();
    through + model.d()[(pair.output, pair.input)]
}

#[test]
fn the_poles_of_published_models_have_the_sums_of_powers_of_their_matrices() {
    for file in MODELS {
        let model = state_space(file);
        let poles: Vec<Complex<f64>> = modes(&model).unwrap().iter().map(|mode| mode.pole).collect();
        assert_eq!(poles.len(), model.order());
        let (mut power, mut size) = (model.a().clone(), model.a().norm());
        for exponent in 1..=4 {
            let sum: Complex<f64> = poles.iter().map(|pole| pole.powi(exponent)).sum();
            // Similar matrices have equal traces; rounding is that of the entries of the power.
            assert!((sum - power.trace()).norm() <= 1e-12 * size, "{file}, power {exponent}: {sum} {}", power.trace());
            (power, size) = (&power * model.a(), size * model.a().norm());
        }
    }
}

#[test]
fn the_four_poles_of_a_near_defective_chain_are_near_their_place_and_without_participation() {
    let found = modes(&state_space("../near-defective-model.json")).unwrap();
    for mode in &found[..4] {
        // A chain of four: the fourth root of 1e-15 of |A|, some 1e3, at most.
        assert!((mode.pole + 0.001).norm() < 0.01, "{}", mode.pole);
        assert!(mode.participation.is_err(), "{mode:?}");
    }
    assert!(found[4].frequency_rad_s > 0.1, "the fifth is of the stable block: {}", found[4].pole);
}

#[test]
fn the_responses_of_published_models_are_zero_at_their_zeros() {
    let mut checked = 0;
    for file in MODELS {
        let model = state_space(file);
        let omega: Vec<f64> = (0..60).map(|k| 10.0_f64.powf(-2.0 + 0.07 * f64::from(k))).collect();
        let response = evaluate(&model, &omega);
        for pair in response.curves().pairs() {
            let Ok(zeros) = transmission_zeros(&model, pair) else { continue };
            assert!(zeros.finite.len() + zeros.infinite <= model.order());
            let peak = response.curve(pair).iter().map(|value| value.norm()).fold(0.0, f64::max);
            for zero in &zeros.finite {
                let value = value_at(&model, pair, *zero).norm();
                // Zeros within 1e-4 of a pole are rounded the more, the nearer they are.
                assert!(value < 1e-6 * peak, "{file} {pair:?} {zero}: {value:e} of {peak:e}");
                checked += 1;
            }
        }
    }
    assert!(checked > 300, "{checked} zeros");
}

#[test]
fn the_envelopes_are_those_of_independent_code() {
    let golden = json(include_str!("../../data/reference/muad-golden.json"));
    let rows = list(&golden["rows"]);
    assert_eq!(rows.len(), 14);
    for row in rows {
        let of = |key: &str| number(&row[key]);
        let muad = Muad::at(of("w"));
        let found = [muad.magnitude_db, muad.phase_deg].concat();
        let expected = ["gain_lo_dB", "gain_up_dB", "phase_lo_deg", "phase_up_deg"].map(of);
        // The same formula in another order of rounding.
        assert!(found.iter().zip(expected).all(|(found, expected)| (found - expected).abs() < 1e-11), "{muad:?}");
    }
}

#[test]
fn the_rigid_body_modes_of_the_example_are_followed_and_the_step_of_condition_10_is_seen() {
    let dataset = crate::EXAMPLE.dataset.clone();
    let jumping = |id: i64| {
        let condition = dataset.conditions().iter().find(|condition| condition.id() == ConditionId(id)).unwrap();
        let modes = ConditionModes::of(condition, &Unobserved).unwrap();
        let tracks = modes.tracks(BundleKind::Physics, condition.nominal());
        assert!(tracks.iter().all(|track| track.modes.iter().all(Option::is_some)));
        let mut models: Vec<usize> = tracks.iter().flat_map(|track| track.jumps.clone()).collect();
        models.sort_unstable();
        models.dedup();
        let names = condition.bundle(BundleKind::Physics);
        models.into_iter().map(|model| names[model].name.clone()).collect::<Vec<String>>()
    };
    let suggested = EXAMPLE_WITH_SUGGESTIONS_REJECTED.condition(ConditionId(10)).unwrap().suggested();
    println!("{:?} {:?} {suggested:?}", jumping(3), jumping(10));
}
