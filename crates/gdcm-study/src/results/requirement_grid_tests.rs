//! Tests of the grid of requirements: known values, reasons why values are missing, and counts.

use std::collections::BTreeMap;

use gdcm_method::requirements::NamedBy;
use gdcm_method::requirements::mode_comparison::ModeValues;
use gdcm_method::requirements::{ModeName, ModeVerdict, ToleranceTable};
use gdcm_model::dataset::ConditionId;

use super::grid_cell::{CellVerdict, NotDetermined, RoleCell};
use super::grid_requirement::{Requirement, RequirementGroup};
use super::grid_source::GridSource;
use super::required_bandwidth::{BandwidthFinding, NoBandwidth};
use super::required_modes::{ModeFinding, ModeNumbers};
use super::required_summary::SummaryFinding;
use super::requirement_grid::{GridCount, RequirementGrid};
use super::requirement_role::RequirementRole;
use super::requirements::Requirements;
use super::time_histories::TimeHistories;
use crate::decisions::requirement_settings::RequirementSettings;
use crate::execution::Execution;
use crate::jobs::couplings_tests::EXAMPLE;
use crate::results::required_modes::IdentifiedPoles;
use crate::results::requirements::requirements_of;
use crate::results::time_histories::{HistoryFinding, ToleranceFinding};

const CONDITION: ConditionId = ConditionId(3);

/// A bandwidth \[rad/s\] and a phase delay \[s\] of the example's roll response.
fn bandwidth(role: RequirementRole, omega: Option<f64>, delay_s: f64) -> BandwidthFinding {
    let dataset = &EXAMPLE.analysis.study.dataset;
    BandwidthFinding {
        condition: CONDITION,
        pair: dataset.find_pair("P", "LAT").unwrap(),
        output: "P".to_owned(),
        role,
        omega_bw_rad_s: omega,
        phase_delay_s: Some(delay_s),
        ..BandwidthFinding::default()
    }
}

fn summary(role: RequirementRole, mean_j: f64, share: f64) -> SummaryFinding {
    SummaryFinding {
        condition: CONDITION,
        airspeed_kt: 45.0,
        role,
        model: String::new(),
        mean_j_on_axis: Some(mean_j),
        mean_j_all: Some(mean_j),
        muad_share_on_axis: Some(share),
        muad_share_all: Some(share),
        absent: BTreeMap::new(),
    }
}

/// A mode with this natural frequency and the damping ratio 0.6.
fn numbers(modulus_rad_s: f64) -> ModeNumbers {
    ModeNumbers {
        model: String::new(),
        pole_real_rad_s: -0.6 * modulus_rad_s,
        pole_imaginary_rad_s: 0.8 * modulus_rad_s,
        values: ModeValues {
            period_s: None,
            time_to_half_s: None,
            damping_ratio: Some(0.6),
        },
        absent: BTreeMap::new(),
    }
}

/// A mode whose identified natural frequency is 2 rad/s; `physics` is that of the physics model.
fn mode(name: ModeName, verdict: ModeVerdict, physics: Option<f64>) -> ModeFinding {
    ModeFinding {
        condition: CONDITION,
        airspeed_kt: 45.0,
        number: 1,
        name: Some(name),
        named_by: NamedBy::States,
        verdict,
        identified: numbers(2.0),
        identified_deviation: None,
        physics: physics.map(numbers),
        // No couplings: the corrected model has the physics model's modes, because gains and delays
        // move no pole.
        corrected_verdict: None,
        corrected: None,
        tolerance: None,
    }
}

/// Findings for [`CONDITION`]; the mean J and the shares apply to on-axis and to all responses
/// alike.
fn known_requirements() -> Requirements {
    use RequirementRole::{Corrected, Identified, Physics};
    Requirements {
        bandwidth: vec![
            bandwidth(Physics, Some(2.5), 0.16),
            bandwidth(Corrected, Some(2.1), 0.10),
            bandwidth(Identified, Some(2.0), 0.13),
        ],
        modes: vec![
            mode(ModeName::DutchRoll, ModeVerdict::Outside, Some(1.8)),
            mode(ModeName::ShortPeriod, ModeVerdict::NoTolerance, Some(2.2)),
            mode(ModeName::Phugoid, ModeVerdict::NotPaired, None),
        ],
        summary: vec![summary(Physics, 60.0, 0.5), summary(Corrected, 6.0, 0.95)],
        ..Requirements::default()
    }
}

/// Findings for a record: the peak errors in roll rate, relative to the tolerance, for the
/// corrected and the physics model.
fn record_findings(held_out: bool, corrected: f64, physics: f64) -> Vec<HistoryFinding> {
    let roles = [
        (RequirementRole::Corrected, corrected),
        (RequirementRole::Physics, physics),
    ];
    let mut findings = Vec::new();
    for (role, peak_error) in roles {
        findings.push(HistoryFinding {
            condition: CONDITION,
            airspeed_kt: 45.0,
            record: "a".to_owned(),
            held_out,
            role,
            model: String::new(),
            moved_input: None,
            samples: 100,
            windows: 1,
            window_s: 10.0,
            j_rms: None,
            j_rms_left_out: Vec::new(),
            theil: BTreeMap::new(),
            tolerances: vec![ToleranceFinding {
                quantity: "roll rate".to_owned(),
                output: "P".to_owned(),
                integrated: false,
                unit: "deg/s".to_owned(),
                share_inside: 1.0,
                largest_excess: -1.0,
                largest_excess_at_s: 0.0,
                peak_error,
                peak_error_at_s: 0.0,
                correlation: None,
                on_axis: None,
                trend: None,
            }],
        });
    }
    findings
}

fn grid(requirements: &Requirements, records: Vec<HistoryFinding>) -> RequirementGrid {
    grid_with(requirements, records, &RequirementSettings::default())
}

fn grid_with(
    requirements: &Requirements,
    records: Vec<HistoryFinding>,
    settings: &RequirementSettings,
) -> RequirementGrid {
    let histories = TimeHistories {
        tolerance_table: ToleranceTable::default(),
        records,
        missing: Vec::new(),
    };
    RequirementGrid::new(&GridSource {
        requirements,
        histories: Some(&histories),
        dataset: &EXAMPLE.analysis.study.dataset,
        settings,
        role: RequirementRole::Corrected,
    })
}

/// Value of the corrected model.
fn value(grid: &RequirementGrid, requirement: Requirement) -> f64 {
    grid.cell(requirement, CONDITION)
        .unwrap()
        .corrected
        .value
        .unwrap()
}

#[test]
fn known_values_are_judged_and_counted() {
    // Relative differences from the identified model for bandwidth (2.1 / 2.0 - 1) and frequencies
    // (1.8 / 2.0 - 1, 2.2 / 2.0 - 1), differences for phase delay (0.10 - 0.13). Default limits:
    // bandwidth 0.1, phase delay 0.02 s, mean J 10, MUAD share 0.9, peak error 1. The grid takes
    // the verdicts on modes from the findings. Row 0 of the tolerance table is the roll rate.
    let grid = grid(&known_requirements(), record_findings(true, 0.7, 1.2));
    let pair = EXAMPLE
        .analysis
        .study
        .dataset
        .find_pair("P", "LAT")
        .unwrap();
    let cases = [
        (Requirement::Bandwidth(pair), 0.05, "met", "outside"),
        (Requirement::PhaseDelay(pair), -0.03, "outside", "outside"),
        (Requirement::PeakError(0), 0.7, "met", "outside"),
        (
            Requirement::ModeFrequency(ModeName::DutchRoll),
            -0.1,
            "outside",
            "outside",
        ),
        (
            Requirement::ModeFrequency(ModeName::ShortPeriod),
            0.1,
            "no-tolerance",
            "no-tolerance",
        ),
        (Requirement::MeanJOnAxis, 6.0, "met", "outside"),
        (Requirement::MeanJAll, 6.0, "no-tolerance", "no-tolerance"),
        (Requirement::MuadShareOnAxis, 0.95, "met", "outside"),
    ];
    for (requirement, expected, corrected, physics) in cases {
        assert!(
            (value(&grid, requirement) - expected).abs() < 1e-12,
            "{requirement:?}"
        );
        let cell = grid.cell(requirement, CONDITION).unwrap();
        assert_eq!(cell.corrected.verdict.code(), corrected, "{requirement:?}");
        assert_eq!(cell.physics.verdict.code(), physics, "{requirement:?}");
    }
    // Not determined: the unpaired phugoid, and all quantities of the tolerance table except for
    // the roll rate.
    let phugoid = grid
        .cell(Requirement::ModeFrequency(ModeName::Phugoid), CONDITION)
        .unwrap();
    assert_eq!(
        phugoid.corrected.verdict,
        CellVerdict::NotDetermined(NotDetermined::ModeNotPaired)
    );
    // The last test checks the number of rows in time.
    let in_time = grid.group_rows(RequirementGroup::InTime).count();
    assert_eq!(
        grid.count(),
        GridCount {
            met: 4,
            judged: 6,
            physics_met: 0,
            not_determined: 1 + (in_time - 1),
        }
    );
    // The only column is CONDITION: the grid has the conditions with a summary.
    let summary = grid.group_cell(RequirementGroup::Summary, 0);
    assert_eq!((summary.count.met, summary.count.judged), (2, 2));
    assert!(summary.is_physics_outside);
}

/// Formats the boundary of a level: vertical at a bandwidth \[rad/s\], up to a phase delay of
/// `height_s`. The level is met on the boundary and to its right.
fn vertical_boundary(level: u8, omega: f64, height_s: f64) -> String {
    format!(
        r#"{{"name": "{level}", "level": {level}, "axis": "P",
            "points": [[{omega}, 0], [{omega}, {height_s}]]}}"#
    )
}

/// Returns settings with the boundaries of levels 1 and 2 at these bandwidths \[rad/s\].
fn levels(first: f64, second: f64, height_s: f64) -> RequirementSettings {
    let text = format!(
        "[{}, {}]",
        vertical_boundary(1, first, height_s),
        vertical_boundary(2, second, height_s)
    );
    RequirementSettings {
        levels: serde_json::from_str(&text).unwrap(),
        ..RequirementSettings::default()
    }
}

#[test]
fn the_level_of_a_model_is_compared_with_that_of_the_identified_model() {
    let requirements = known_requirements();
    let level = Requirement::Level(requirements.bandwidth[0].pair);
    assert!(grid(&requirements, Vec::new()).row(level).is_none());
    // Bandwidth and phase delay: physics (2.5 rad/s, 0.16 s), corrected (2.1, 0.10), identified
    // (2.0, 0.13).
    // A level is a requirement: the model must have the level of the identified model.
    for (settings, corrected, physics) in [
        (levels(2.2, 1.0, 0.3), (2.0, "met"), (1.0, "outside")),
        (levels(2.05, 1.0, 0.3), (1.0, "outside"), (1.0, "outside")),
        (levels(2.0, 1.0, 0.3), (1.0, "met"), (1.0, "met")),
        (levels(4.0, 3.0, 0.3), (3.0, "met"), (3.0, "met")),
    ] {
        let grid = grid_with(&requirements, Vec::new(), &settings);
        let cell = grid.cell(level, CONDITION).unwrap();
        let found = |cell: &RoleCell| (cell.value.unwrap(), cell.verdict.code());
        assert_eq!(found(&cell.corrected), corrected);
        assert_eq!(found(&cell.physics), physics);
    }
    // The physics model lies above boundaries that end at 0.15 s.
    let low = grid_with(&requirements, Vec::new(), &levels(2.0, 1.0, 0.15));
    let cell = low.cell(level, CONDITION).unwrap();
    assert_eq!(
        cell.physics.verdict,
        CellVerdict::NotDetermined(NotDetermined::AboveBoundaries(RequirementRole::Physics))
    );
    assert_eq!(cell.physics.value, None);
    let bandwidth = low.group_rows(RequirementGroup::Bandwidth).count();
    assert_eq!(bandwidth, 3, "bandwidth, phase delay, level");
}

#[test]
fn the_worst_held_out_record_counts_and_other_records_do_not() {
    let peak = Requirement::PeakError(0);
    let mut records = record_findings(true, 0.7, 0.5);
    records.extend(record_findings(true, 0.9, 0.4));
    records.extend(record_findings(false, 5.0, 5.0));
    assert!((value(&grid(&known_requirements(), records), peak) - 0.9).abs() < 1e-12);
    let grid = grid(&known_requirements(), record_findings(false, 0.7, 0.5));
    assert_eq!(
        grid.cell(peak, CONDITION).unwrap().corrected.verdict,
        CellVerdict::NotDetermined(NotDetermined::NoHeldOutRecord)
    );
}

#[test]
fn a_missing_bandwidth_names_the_model_that_lacks_it() {
    let mut requirements = known_requirements();
    requirements.bandwidth[2].omega_bw_rad_s = None;
    requirements.bandwidth[2]
        .absent
        .insert("omega_bw_rad_s", NoBandwidth::NetGainNotPositive);
    let pair = requirements.bandwidth[0].pair;
    let grid = grid(&requirements, Vec::new());
    let cell = grid.cell(Requirement::Bandwidth(pair), CONDITION).unwrap();
    assert_eq!(
        cell.corrected.verdict,
        CellVerdict::NotDetermined(NotDetermined::Bandwidth {
            role: RequirementRole::Identified,
            why: NoBandwidth::NetGainNotPositive
        })
    );
}

#[test]
fn the_grid_has_a_row_for_each_quantity_and_a_cell_for_each_condition() {
    let analysis = &EXAMPLE.analysis;
    let requirements = requirements_of(
        analysis,
        &IdentifiedPoles::default(),
        &Execution::sequential(),
    )
    .unwrap();
    let grid = grid(&requirements, Vec::new());
    assert_eq!(grid.conditions.len(), analysis.conditions.len());
    for row in &grid.rows {
        assert_eq!(row.cells.len(), grid.conditions.len());
    }
    // The two short-term rows of the table repeat pitch attitude and pitch rate.
    let table = ToleranceTable::default().rows().len();
    let in_time = grid.group_rows(RequirementGroup::InTime).count();
    assert_eq!(in_time, table - 2);
    let count = grid.count();
    assert!(count.met <= count.judged && count.judged > 0);
}
