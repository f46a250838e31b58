//! The numbers in figures agree with the analysis to the last digit.

use gdcm_model::dataset::BundleKind;
use gdcm_plot::figure::Role;

use super::*;

/// A row of a figure's CSV file.
#[derive(serde::Deserialize)]
struct CsvRow {
    figure: String,
    panel: String,
    curve: String,
    label: String,
    x_quantity: String,
    x: String,
    y_quantity: String,
    y: Option<f64>,
}

/// Returns the rows of a figure's CSV file; panics if a row lacks one of the expected columns.
fn csv_rows(figure: &Figure) -> Vec<CsvRow> {
    let bytes = bytes(figure, ColumnWidth::Double, FigureFormat::Csv);
    let mut reader = csv::Reader::from_reader(&bytes[..]);
    reader.deserialize().map(Result::unwrap).collect()
}

#[test]
fn exported_net_gains_equal_those_of_the_analysis() {
    let example = &*EXAMPLE;
    let pair = example.pair("Q", "LON");
    let rows = csv_rows(&example.figure(FigureKind::NetGain, vec![pair]));
    let quantities = [rows[0].x_quantity.as_str(), rows[0].y_quantity.as_str()];
    assert_eq!(quantities, ["Airspeed [kt]", "Net gain [-]"]);
    let mut compared = 0;
    // Labels that are no condition ids belong to brackets.
    for (row, id) in rows
        .iter()
        .filter_map(|row| Some((row, ConditionId(row.label.parse().ok()?))))
    {
        let expected = example
            .analysis
            .condition(id)
            .unwrap()
            .correction
            .net_gain(pair);
        assert_eq!(row.y, Some(expected));
        compared += 1;
    }
    assert_eq!(
        compared, 11,
        "every condition of the example should have a net gain"
    );
    let schedule = example.analysis.schedule.as_ref().unwrap();
    for row in rows.iter().filter(|row| row.curve == "schedule") {
        let airspeed_kt: f64 = row.x.parse().unwrap();
        assert_eq!(row.y, Some(schedule.at(airspeed_kt).net_gain(pair)));
    }
}

#[test]
fn exported_changes_of_cost_equal_those_of_the_analysis() {
    let example = &*EXAMPLE;
    let pair = example.pair("R", "PED");
    let rows = csv_rows(&example.figure(FigureKind::Assessment, vec![pair]));
    assert_eq!(
        rows.len(),
        3 * 10,
        "expected three parts for each of the ten assessed conditions"
    );
    for row in &rows {
        assert_eq!(row.x_quantity, "Condition");
        let Ok(changes) = &example.analysis.assessment[&ConditionId(row.x.parse().unwrap())] else {
            panic!("condition {} should be assessed", row.x);
        };
        let change = changes[pair].unwrap();
        let expected = match row.curve.as_str() {
            "ΔJ" => change.total(),
            "ΔJ magnitude" => change.magnitude(),
            "ΔJ phase" => change.phase(),
            other => panic!("unexpected curve {other}"),
        };
        assert_eq!(row.y, Some(expected));
    }
}

#[test]
fn exported_magnitudes_equal_those_of_the_models() {
    let example = &*EXAMPLE;
    let pair = example.pair("Q", "LON");
    let tables = example.figure(FigureKind::Bode, vec![pair]).tables();
    assert_eq!(
        (tables[0].title.as_str(), tables[1].title.as_str()),
        ("Magnitude [dB]", "Phase [deg]")
    );
    let models = &example.curves.condition.bundle(BundleKind::Physics);
    for (index, model) in models.iter().enumerate() {
        let heading = format!("{} [dB]", model.name);
        let column = tables[0]
            .columns
            .iter()
            .position(|column| *column == heading)
            .unwrap();
        let response = example.curves.physics[index].curve(pair);
        for (row, value) in tables[0].rows.iter().zip(response) {
            assert_eq!(
                row[column].parse::<f64>().unwrap(),
                20.0 * value.norm().log10()
            );
        }
    }
    // Columns: the frequency, every model of both bundles, the corrected model and the scheduled
    // one.
    let models_of_both_bundles = models.len() + example.curves.identified.len();
    assert_eq!(tables[0].columns.len(), 1 + models_of_both_bundles + 2);
    assert!(
        tables[0]
            .columns
            .iter()
            .any(|column| column.ends_with(&format!("{} [dB]", Role::Corrected.name())))
    );
}

#[test]
fn a_csv_file_of_several_panels_names_the_panel_in_each_row() {
    let example = &*EXAMPLE;
    let figure = example.figure(FigureKind::Assessment, example.on_axis());
    let rows = csv_rows(&figure);
    let panels: std::collections::BTreeSet<&str> =
        rows.iter().map(|row| row.panel.as_str()).collect();
    // Five on-axis responses, three parts of the cost, ten assessed conditions.
    assert_eq!((rows.len(), panels.len()), (5 * 3 * 10, 5), "{panels:?}");
    assert!(panels.contains("LAT → P, ΔJ [-]"), "{panels:?}");
    assert!(
        rows.iter()
            .all(|row| row.figure == figure.title && row.y_quantity == "ΔJ [-]")
    );
    // Tables for display are separate for each panel.
    assert_eq!(figure.tables().len(), 5);
}
