//! Differing signs and units of a channel in the two bundles: detection, remark and correction.

use std::collections::BTreeSet;
use std::sync::Arc;

use gdcm_method::correction::Channel;
use gdcm_model::dataset::measured_response::MeasuredResponse;
use gdcm_model::dataset::physics_parameter::{MovedParameters, ParameterChange};
use gdcm_model::dataset::{Condition, Dataset, Model, MovedModel};
use gdcm_study::Execution;
use gdcm_study::decisions::dataset_differences::{Difference, NotApplied};
use gdcm_study::decisions::named_decisions::Decisions;
use gdcm_study::decisions::signs::SignRole;
use gdcm_study::results::condition_remarks::condition_remarks;
use gdcm_study::results::convention_doubt::Convention;
use gdcm_study::results::remark::{Remark, SuggestedSign};
use gdcm_study::stages::convention_check::doubts_of_models;

use super::*;

/// Channels of the example.
const NZ: Channel = Channel::Output(5);
const COL: Channel = Channel::Input(3);

/// Returns a study of the example in which `change` was applied to the models of one bundle.
fn study_with_changed_models(bundle: BundleKind, change: impl Fn(&Model) -> Model) -> Study {
    let before = study_of_example().dataset;
    let conditions = before.conditions().iter().map(|condition| {
        let models = |kind| -> Vec<Model> {
            let models = condition.bundle(kind).iter();
            models
                .map(|model| {
                    if kind == bundle {
                        change(model)
                    } else {
                        model.clone()
                    }
                })
                .collect()
        };
        let physics = models(BundleKind::Physics);
        let identified = models(BundleKind::Identified);
        Condition::new(condition.flight_state().clone(), physics, identified).unwrap()
    });
    Study::new(Arc::new(
        Dataset::new(before.header(), conditions.collect()).unwrap(),
    ))
}

/// Returns a study of the example in which a channel of the models of one bundle is scaled: rows of
/// C and D for an output, columns of B and D for an input.
fn study_with_scaled_channel(bundle: BundleKind, channel: Channel, factor: f64) -> Study {
    study_with_changed_models(bundle, |model| {
        let old = model.state_space().unwrap();
        let mut b = old.b().clone();
        let mut c = old.c().clone();
        let mut d = old.d().clone();
        match channel {
            Channel::Output(output) => {
                for state in 0..c.ncols() {
                    c[(output, state)] *= factor;
                }
                for input in 0..d.ncols() {
                    d[(output, input)] *= factor;
                }
            }
            Channel::Input(input) => {
                for state in 0..b.nrows() {
                    b[(state, input)] *= factor;
                }
                for output in 0..d.nrows() {
                    d[(output, input)] *= factor;
                }
            }
        }
        let dynamics = Dynamics::StateSpace(StateSpace::new(old.a().clone(), b, c, d).unwrap());
        Model {
            dynamics,
            ..model.clone()
        }
    })
}

fn set_sign(study: &mut Study, channel: Channel, role: Option<SignRole>) {
    study.apply(&Edit::SetSign { channel, role }).unwrap();
}

/// Returns the exported corrections without the list of reversed signs.
fn results_without_signs(analysis: &Analysis) -> Value {
    let mut written = corrections(analysis, "", &BTreeSet::new());
    written.as_object_mut().unwrap().remove("signs");
    written
}

#[test]
fn an_output_of_opposite_sign_is_found_and_its_reversal_restores_every_digit() {
    let mut study = study_with_scaled_channel(BundleKind::Identified, NZ, -1.0);
    let mut engine = Engine::default();
    let flipped = analyze(&mut engine, &study);
    let [doubt] = flipped.doubts.as_slice() else {
        panic!("expected one doubt: {:?}", flipped.doubts)
    };
    assert_eq!(
        (doubt.convention, doubt.channel, doubt.channel_to_reverse()),
        (Convention::Sign, NZ, Some(NZ))
    );
    // All responses of NZ, in at least ten of the eleven conditions.
    assert!(
        doubt.all_responses && doubt.conditions.len() >= 10,
        "{doubt:?}"
    );
    // The remark on the sign comes first, before remarks on delays, zeros or modes.
    let remarks = condition_remarks(&study, flipped.condition(ConditionId(1)).unwrap(), None);
    assert_eq!(remarks[0], Remark::ConventionDoubt(doubt.clone()));
    let identified = SuggestedSign {
        channel: NZ,
        role: Some(SignRole::Identified),
    };
    assert_eq!(remarks[0].suggested_sign(), Some(identified));
    let execution = Execution::sequential();
    assert_eq!(
        doubts_of_models(&study, &execution).unwrap()[0].channel,
        NZ,
        "the doubt should be found without an analysis"
    );

    let before = study.clone();
    set_sign(&mut study, NZ, Some(SignRole::Identified));
    let reversed = analyze(&mut engine, &study);
    assert_eq!(reversed.doubts, []);
    let example = analyze(&mut Engine::default(), &study_of_example());
    assert_eq!(
        results_without_signs(&reversed),
        results_without_signs(&example)
    );
    let remarks = condition_remarks(&study, reversed.condition(ConditionId(1)).unwrap(), None);
    let channel_reversed = Remark::ChannelReversed {
        channel: NZ,
        role: SignRole::Identified,
    };
    assert_eq!(remarks[0], channel_reversed);
    let restored = SuggestedSign {
        channel: NZ,
        role: None,
    };
    assert_eq!(remarks[0].suggested_sign(), Some(restored));

    set_sign(&mut study, NZ, None);
    assert_eq!((&study, &study.dataset), (&before, &before.dataset));
    // The example has six outputs, numbered from 0.
    assert!(
        study
            .apply(&Edit::SetSign {
                channel: Channel::Output(6),
                role: None
            })
            .is_err()
    );
}

#[test]
fn the_example_raises_no_doubt_about_signs_or_units() {
    assert_eq!(EXAMPLE_WITH_SUGGESTIONS_REJECTED.doubts, []);
}

#[test]
fn an_input_of_opposite_sign_is_found_and_reversing_the_physics_removes_the_doubt() {
    let mut study = study_with_scaled_channel(BundleKind::Physics, COL, -1.0);
    let mut engine = Engine::default();
    // Few frequencies, to save time.
    study.apply(&setting_table::POINTS.to(40)).unwrap();
    let found: Vec<Channel> = analyze(&mut engine, &study)
        .doubts
        .iter()
        .map(|doubt| doubt.channel)
        .collect();
    assert_eq!(found, [COL]);
    set_sign(&mut study, COL, Some(SignRole::All));
    let [doubt] = &analyze(&mut engine, &study).doubts[..] else {
        panic!("reversing both bundles should leave one doubt")
    };
    assert_eq!(doubt.channel, COL);
    set_sign(&mut study, COL, Some(SignRole::Physics));
    assert_eq!(analyze(&mut engine, &study).doubts, []);
}

#[test]
fn a_differing_unit_is_found_with_its_conversion_factor() {
    for (channel, factor) in [
        // m/s² to g.
        (NZ, 1.0 / 9.806_65),
        (NZ, 0.1),
        // ft/s² to g.
        (NZ, 1.0 / 32.174),
        (NZ, 1e-3),
        // rad/s to deg/s.
        (Channel::Output(0), 180.0 / std::f64::consts::PI),
        // A fraction to percent.
        (COL, 100.0),
    ] {
        let mut study = study_with_scaled_channel(BundleKind::Identified, channel, factor);
        study.apply(&setting_table::POINTS.to(40)).unwrap();
        let doubts = analyze(&mut Engine::default(), &study).doubts;
        let [doubt] = &doubts[..] else {
            panic!("{factor}: {doubts:?}")
        };
        assert_eq!(doubt.channel, channel);
        let Convention::Factor(found) = doubt.convention else {
            panic!("{doubt:?}")
        };
        // The models of the example agree with flight within a few percent.
        assert!(
            (found / factor).ln().abs() < 0.2,
            "found factor {found}, expected {factor}"
        );
        assert_eq!(doubt.channel_to_reverse(), None, "only the unit differs");
    }
}

#[test]
fn measured_responses_are_reversed_and_keep_their_coherence() {
    let grid = FrequencyGrid::logarithmic(study_of_example().dataset.band(), 60);
    let study = study_with_changed_models(BundleKind::Identified, |model| {
        let response = FrequencyResponse::from_dynamics(&model.dynamics, &grid);
        let part = |real_or_imaginary: fn(&Complex<f64>) -> f64| {
            PairTable::from_fn(6, 4, |pair| {
                let values = response.curve(pair).iter().map(real_or_imaginary);
                values.collect::<Vec<f64>>()
            })
        };
        let coherence = PairTable::filled(6, 4, vec![0.9; grid.len()]);
        let re = part(|value| value.re);
        let im = part(|value| value.im);
        let measured =
            MeasuredResponse::new(grid.omega().to_vec(), &re, &im, Some(coherence)).unwrap();
        Model {
            dynamics: Dynamics::Measured(measured),
            ..model.clone()
        }
    });
    let mut reversed = study.clone();
    set_sign(&mut reversed, NZ, Some(SignRole::Identified));
    let response = |study: &Study| match &study.dataset.conditions()[0]
        .bundle(BundleKind::Identified)[0]
        .dynamics
    {
        Dynamics::Measured(response) => response.clone(),
        Dynamics::StateSpace(_) => panic!("the model should be a measured response"),
    };
    let plain = response(&study);
    let opposite = response(&reversed);
    assert_eq!(plain.coherence(), opposite.coherence());
    for (pair, values) in plain.values().iter() {
        let sign = if pair.output == 5 { -1.0 } else { 1.0 };
        assert!(
            values
                .iter()
                .zip(&opposite.values()[pair])
                .all(|(plain, opposite)| sign * plain == *opposite),
            "{pair:?}"
        );
    }
    let doubts = analyze(&mut Engine::default(), &reversed).doubts;
    assert_eq!(
        doubts.iter().map(|doubt| doubt.channel).collect::<Vec<_>>(),
        [NZ]
    );
}

#[test]
fn decisions_carry_signs_by_the_names_of_channels() {
    let mut study = study_of_example();
    set_sign(&mut study, NZ, Some(SignRole::All));
    let decisions = Decisions::from_study(&study);
    assert_eq!(decisions.signs[0].channel, "NZ");
    let (again, not_applied) = decisions.applied_to(study_of_example().dataset);
    assert!(again == study && not_applied.is_empty(), "{not_applied:?}");
    let mut unknown = decisions;
    unknown.signs[0].channel = "AZ".to_owned();
    let (_, not_applied) = unknown.applied_to(study_of_example().dataset);
    let [Difference::NotApplied { why, .. }] = not_applied.as_slice() else {
        panic!("{not_applied:?}")
    };
    assert_eq!((why, why.code()), (&NotApplied::NoChannel, "no-channel"));
}

#[test]
fn a_sign_of_the_physics_models_is_reversed_in_their_runs_too() {
    let example = study_of_example().dataset;
    let condition = &example.conditions()[0];
    let run = MovedModel {
        model: Model {
            name: "Ixx +5 %".to_owned(),
            ..condition.bundle(BundleKind::Physics)[1].clone()
        },
        moved: MovedParameters::Run(ParameterChange {
            name: "Ixx".to_owned(),
            delta: 5.0,
            unit: "%".to_owned(),
        }),
    };
    let condition = condition.as_ref().clone();
    let condition = condition.with_moved_models(vec![run.clone()]).unwrap();
    let dataset = example.with_condition(condition).unwrap();
    for (role, factor) in [(SignRole::Physics, -1.0), (SignRole::Identified, 1.0)] {
        let mut study = Study::new(Arc::new(dataset.clone()));
        set_sign(&mut study, NZ, Some(role));
        let [reversed] = study.dataset.conditions()[0].moved_models() else {
            panic!("expected one run")
        };
        assert_eq!(reversed.moved, run.moved);
        let row_of_nz =
            |moved: &MovedModel| moved.model.state_space().unwrap().c().row(5).into_owned();
        assert_eq!(row_of_nz(reversed), row_of_nz(&run) * factor);
    }
}
