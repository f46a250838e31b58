//! The numbers of figures, compared with the analysis to the last digit.

use gdcm_core::dataset::BundleKind;
use gdcm_files::figure::Role;

use super::*;

fn csv_rows(figure: &Figure) -> Vec<csv::StringRecord> {
    let bytes = bytes(figure, ColumnWidth::Double, FigureFormat::Csv);
    let mut reader = csv::ReaderBuilder::new().flexible(true).has_headers(false).from_reader(&bytes[..]);
    reader.records().map(Result::unwrap).collect()
}

#[test]
fn net_gains_are_those_of_the_analysis() {
    let example = &*EXAMPLE;
    let pair = example.pair("Q", "LON");
    let rows = csv_rows(&example.figure(FigureKind::NetGain, vec![pair]));
    assert_eq!(rows[0], vec!["series", "label", "Airspeed [kt]", "Net gain [-]"]);
    let mut compared = 0;
    // Other labels are those of brackets.
    for (row, id) in rows.iter().filter_map(|row| Some((row, ConditionId(row[1].parse().ok()?)))) {
        let expected = example.analysis.condition(id).unwrap().correction.net_gain(pair);
        assert_eq!(row[3].parse::<f64>().unwrap(), expected);
        compared += 1;
    }
    assert_eq!(compared, 11);
    let schedule = example.analysis.schedule.as_ref().unwrap();
    for row in rows.iter().filter(|row| &row[0] == "schedule") {
        let airspeed_kt: f64 = row[2].parse().unwrap();
        assert_eq!(row[3].parse::<f64>().unwrap(), schedule.at(airspeed_kt).net_gain(pair));
    }
}

#[test]
fn changes_of_cost_are_those_of_the_analysis() {
    let example = &*EXAMPLE;
    let pair = example.pair("R", "PED");
    let rows = csv_rows(&example.figure(FigureKind::Assessment, vec![pair]));
    assert_eq!(rows[0], vec!["Condition", "ΔJ [-]", "ΔJ magnitude [-]", "ΔJ phase [-]"]);
    assert_eq!(rows.len(), 11, "a heading, and every condition but the one left out");
    for row in &rows[1..] {
        let Ok(changes) = &example.analysis.assessment[&ConditionId(row[0].parse().unwrap())] else {
            panic!("{row:?} was assessed");
        };
        let change = changes[pair].unwrap();
        let numbers = [1, 2, 3].map(|at: usize| row[at].parse::<f64>().unwrap());
        assert_eq!(numbers, [change.total(), change.magnitude(), change.phase()]);
    }
}

#[test]
fn responses_are_those_of_the_models() {
    let example = &*EXAMPLE;
    let pair = example.pair("Q", "LON");
    let tables = example.figure(FigureKind::Bode, vec![pair]).tables();
    assert_eq!((tables[0].title.as_str(), tables[1].title.as_str()), ("Magnitude [dB]", "Phase [deg]"));
    let models = &example.curves.condition.bundle(BundleKind::Physics);
    for (index, model) in models.iter().enumerate() {
        let heading = format!("{} [dB]", model.name);
        let column = tables[0].columns.iter().position(|column| *column == heading).unwrap();
        let response = example.curves.physics[index].curve(pair);
        for (row, value) in tables[0].rows.iter().zip(response) {
            assert_eq!(row[column].parse::<f64>().unwrap(), 20.0 * value.norm().log10());
        }
    }
    // Every model of both bundles, corrected and scheduled, beside the frequency.
    let both = models.len() + example.curves.identified.len();
    assert_eq!(tables[0].columns.len(), 1 + both + 2);
    assert!(tables[0].columns.iter().any(|column| column.ends_with(&format!("{} [dB]", Role::Corrected.name()))));
}

#[test]
fn several_panels_are_several_tables_under_their_titles() {
    let example = &*EXAMPLE;
    let figure = example.figure(FigureKind::Assessment, example.on_axis());
    let text = String::from_utf8(bytes(&figure, ColumnWidth::Double, FigureFormat::Csv)).unwrap();
    assert_eq!(text.matches("\n\n").count(), 4, "five tables");
    assert!(text.starts_with("\"LAT → P, ΔJ [-]\"\n") || text.starts_with("LAT → P"), "{}", &text[..40]);
}
