//! Remarks on the results of a condition.

use gdcm_study::decisions::edit_refusal::EditRefusal;
use gdcm_study::results::condition_remarks::condition_remarks;
use gdcm_study::results::remark::Remark;
use gdcm_study::results::remark_kind::RemarkKind;

use super::*;

fn said(analysis: &Analysis, condition: i64) -> Vec<Remark> {
    condition_remarks(
        &analysis.study,
        analysis.condition(ConditionId(condition)).unwrap(),
        analysis.schedule.as_ref().ok(),
    )
}

#[test]
fn a_held_response_that_goes_farther_from_flight_is_named_with_both_costs() {
    let mut study = study_of_example();
    let mut engine = Engine::default();
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
        let said = said(analysis, condition.id().0);
        let farther = said.iter().find_map(|remark| match remark {
            Remark::HeldFarther(responses) => Some(responses.as_slice()),
            _ => None,
        });
        for pair in result.held().marked() {
            let cost = result.cost[pair].unwrap();
            let named = farther
                .unwrap_or_default()
                .iter()
                .find(|response| response.pair == pair);
            assert_eq!(named.is_some(), cost.total() > 0.5, "{pair:?} {cost:?}");
            assert!(named.is_none_or(|response| response.cost == cost));
            worse += usize::from(named.is_some());
        }
    }
    assert_eq!(worse, 2, "LAT → R in conditions 5 and 11");
}

#[test]
fn a_condition_that_is_left_out_of_the_schedule_says_so() {
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
    let says = |condition| said(&analysis, condition).contains(&Remark::LeftOutOfSchedule);
    assert!(says(3) && !says(4));
}

#[test]
fn a_tolerance_decides_whether_a_loop_of_held_gains_agrees() {
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
        "four ratios of the example agree by chance only"
    );
    assert!(
        said(&strict, 1)
            .iter()
            .any(|remark| remark.kind() == RemarkKind::Trouble)
    );
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
    let said = said(&lenient, 1);
    let Remark::GainsMatched { tolerance_db, .. } = said[0] else {
        panic!("{:?}", said[0]);
    };
    assert_eq!(tolerance_db, Some(3.0));
    assert!(said.iter().any(|remark| remark.code() == "loop-agrees"));
}
