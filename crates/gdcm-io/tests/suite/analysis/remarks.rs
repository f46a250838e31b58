//! Remarks on the results of a condition.

use gdcm_study::decisions::edit_refusal::EditRefusal;
use gdcm_study::results::condition_remarks::condition_remarks;
use gdcm_study::results::remark::Remark;
use gdcm_study::results::remark_kind::RemarkKind;

use super::*;

/// Returns the remarks on the condition with the number `condition`.
fn remarks_on(analysis: &Analysis, condition: i64) -> Vec<Remark> {
    condition_remarks(
        &analysis.study,
        analysis.condition(ConditionId(condition)).unwrap(),
        analysis.schedule.as_ref().ok(),
    )
}

#[test]
fn a_remark_names_held_responses_that_the_correction_moves_farther_from_flight() {
    let mut study = study_of_example();
    let mut engine = Engine::default();
    // Few frequencies, to save time; likewise below.
    study.apply(&setting_table::POINTS.to(40)).unwrap();
    let held = [("NY", "LAT"), ("P", "PED"), ("R", "LAT")]
        .map(|(output, input)| study.dataset.find_pair(output, input));
    for pair in study.dataset.on_axis().pairs() {
        study
            .apply(&Edit::Hold(pair, held.contains(&Some(pair))))
            .unwrap();
    }
    let analysis = &analyze(&mut engine, &study);
    let mut worse = 0;
    for condition in analysis.study.dataset.conditions() {
        let result = analysis.condition(condition.id()).unwrap();
        let remarks = remarks_on(analysis, condition.id().0);
        let farther = remarks.iter().find_map(|remark| match remark {
            Remark::HeldFarther(responses) => Some(responses.as_slice()),
            _ => None,
        });
        for pair in result.held().marked() {
            let cost = result.cost[pair].unwrap();
            let named = farther
                .unwrap_or_default()
                .iter()
                .find(|response| response.pair == pair);
            // An increase of J by up to 0.5 is negligible: no remark.
            assert_eq!(named.is_some(), cost.total() > 0.5, "{pair:?} {cost:?}");
            assert!(named.is_none_or(|response| response.cost == cost));
            worse += usize::from(named.is_some());
        }
    }
    assert_eq!(worse, 2, "expected LAT → R in conditions 5 and 11");
}

#[test]
fn a_condition_left_out_of_the_schedule_has_a_remark() {
    let mut study = study_of_example();
    let mut engine = Engine::default();
    study.apply(&setting_table::POINTS.to(40)).unwrap();
    study
        .apply(&Edit::SetScheduled {
            condition: ConditionId(3),
            scheduled: false,
        })
        .unwrap();
    let analysis = analyze(&mut engine, &study);
    assert!(remarks_on(&analysis, 3).contains(&Remark::LeftOutOfSchedule));
    assert!(!remarks_on(&analysis, 4).contains(&Remark::LeftOutOfSchedule));
}

#[test]
fn the_agreement_tolerance_decides_whether_a_loop_of_held_gains_agrees() {
    let mut study = study_of_example();
    let mut engine = Engine::default();
    study.apply(&setting_table::POINTS.to(40)).unwrap();
    // LON and COL to Q and NZ form a loop of four held responses.
    for (output, input) in [("Q", "LON"), ("Q", "COL"), ("NZ", "LON"), ("NZ", "COL")] {
        let pair = study.dataset.find_pair(output, input).unwrap();
        study.apply(&Edit::Hold(pair, true)).unwrap();
    }
    let strict = analyze(&mut engine, &study);
    let loops = strict
        .condition(ConditionId(1))
        .unwrap()
        .gains
        .conflicts
        .clone();
    assert!(
        !loops.is_empty(),
        "the gains of the loop should conflict at the default tolerance"
    );
    assert!(
        remarks_on(&strict, 1)
            .iter()
            .any(|remark| remark.kind() == RemarkKind::Trouble)
    );
    // The greatest permitted tolerance is 3 dB.
    assert!(matches!(
        study.apply(&setting_table::AGREEMENT.to(3.1)),
        Err(EditRefusal::OutOfRange { found: 3.1, .. })
    ));
    study.apply(&setting_table::AGREEMENT.to(3.0)).unwrap();
    let lenient = analyze(&mut engine, &study);
    let result = lenient.condition(ConditionId(1)).unwrap();
    assert!(
        result.gains.matched && !result.gains.agreeing.is_empty(),
        "{:?}",
        result.gains.conflicts
    );
    let remarks = remarks_on(&lenient, 1);
    let Remark::GainsMatched { tolerance_db, .. } = remarks[0] else {
        panic!("the first remark should be GainsMatched: {:?}", remarks[0]);
    };
    assert_eq!(tolerance_db, Some(3.0));
    assert!(remarks.iter().any(|remark| remark.code() == "loop-agrees"));
}
