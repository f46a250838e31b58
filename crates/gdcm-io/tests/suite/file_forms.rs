//! A small study of five conditions in every supported file format: known gains and delays are
//! recovered, or a question is asked.
//!
//! The identified models are `M_O H M_I` of the physics models, in other units and another channel
//! order, with the sign of NZ reversed. `make_study_forms.m` beside the test data writes the same
//! study with GNU Octave.

use std::f64::consts::{PI, TAU};
use std::fmt::Write as _;
use std::path::Path;
use std::sync::Arc;

use nalgebra::{Complex, DMatrix, dmatrix};
use serde_json::json;

use gdcm_io::formats::npy::write_npz;
use gdcm_io::formats::variables::{
    Array, CellArray, ElementKind, StructArray, TextArray, Value, Variable,
};
use gdcm_io::{FolderProgress, read_models, write_mat};
use gdcm_method::correction::GainBounds;
use gdcm_model::assembly::{Assembly, FileScope, FoundModel, Headings, Rules, UnitRule};
use gdcm_model::dataset::{Band, Dataset, Pair};
use gdcm_model::names::ChannelRule;
use gdcm_model::progress::Unobserved;
use gdcm_model::response::FrequencyGrid;
use gdcm_study::decisions::setting_table;
use gdcm_study::{Engine, Study};

use crate::program_folder;

/// Ignores the progress of reading.
struct Silent;

impl FolderProgress for Silent {
    fn reading(&self, _: usize, _: usize, _: &str) {}
}

const CONDITIONS: usize = 5;
const CHANNELS: usize = 3;
/// Channel names and units in the dataset: inputs, then outputs.
const NAMES: [[&str; CHANNELS]; 2] = [["LON", "LAT", "COL"], ["P", "Q", "NZ"]];
const UNITS: [[&str; CHANNELS]; 2] = [["%", "%", "%"], ["deg/s", "deg/s", "m/s^2"]];
/// Names and units of the same channels in the files of identified models, in the order of the
/// dataset.
const NAMES_OF_FLIGHT: [[&str; CHANNELS]; 2] = [["xb", "LAT", "COL"], ["roll rate", "Q", "-NZ"]];
const UNITS_OF_FLIGHT: [[&str; CHANNELS]; 2] = [["in", "%", "fraction"], ["rad/s", "rad/s", "g"]];
/// Indices of the dataset's channels in the order of the files of identified models.
const ORDER: [[usize; CHANNELS]; 2] = [[2, 1, 0], [2, 1, 0]];
/// Stick travel \[%\] per inch.
const PERCENT_IN_AN_INCH: f64 = 8.0;
/// Known delays \[s\] of inputs and outputs.
const DELAYS_S: [[f64; CHANNELS]; 2] = [[0.01, 0.02, 0.015], [0.005, 0.0, 0.01]];

/// Returns the known gains of inputs and outputs in a condition.
fn gains(condition: usize) -> [[f64; CHANNELS]; 2] {
    let k = condition as f64;
    [
        [1.0 + 0.05 * k, 0.9 + 0.02 * k, 1.1 - 0.03 * k],
        [0.95 + 0.03 * k, 1.05 - 0.02 * k, 1.2 - 0.04 * k],
    ]
}

fn airspeed_kt(condition: usize) -> f64 {
    40.0 + 20.0 * condition as f64
}

/// A model as stored in a file.
struct FileModel {
    condition: usize,
    is_identified: bool,
    matrices: [DMatrix<f64>; 4],
    names: [Vec<String>; 2],
    units: [Vec<String>; 2],
    delays_s: Option<[Vec<f64>; 2]>,
}

/// Returns the physics model of a condition: a stable synthetic model with four states, whose
/// entries change with the condition.
fn physics_model(condition: usize) -> FileModel {
    let k = condition as f64;
    let a = dmatrix![
        -1.0 - 0.1 * k, 0.2, 0.0, 0.1;
        -0.3, -2.0 - 0.05 * k, 0.4, 0.0;
        0.1, 0.0, -0.8, 0.5;
        0.0, 0.2, -0.6, -1.5
    ];
    let b = dmatrix![
        2.0, 0.3, 0.1;
        0.2, 3.0 + 0.1 * k, 0.0;
        0.1, 0.0, 1.5;
        0.0, 0.4, 0.5
    ];
    let c = dmatrix![
        0.2, 1.0, 0.1, 0.0;
        1.0, 0.1, 0.0, 0.2;
        0.1, 0.0, 1.0, 0.4
    ];
    let d = dmatrix![
        0.0, 0.0, 0.0;
        0.0, 0.0, 0.0;
        0.0, 0.0, 0.2
    ];
    let owned = |names: [&str; CHANNELS]| names.map(str::to_owned).to_vec();
    FileModel {
        condition,
        is_identified: false,
        matrices: [a, b, c, d],
        names: NAMES.map(owned),
        units: UNITS.map(owned),
        delays_s: None,
    }
}

/// Returns the identified model of a condition, without delays if the format cannot store them.
fn identified_model(condition: usize, has_delays: bool) -> FileModel {
    let [input_gains, output_gains] = gains(condition);
    // Units of the dataset per unit of the files; the sign of NZ is reversed.
    let input_factors = [PERCENT_IN_AN_INCH, 1.0, 100.0];
    let output_factors = [180.0 / PI, 180.0 / PI, -9.806_65];
    let [inputs, outputs] = ORDER;
    let physics = physics_model(condition);
    // M_I and M_O with the gains, the conversion of units and the order of channels in the files.
    let input_matrix = DMatrix::from_fn(CHANNELS, CHANNELS, |row, column| {
        if row == inputs[column] {
            input_gains[row] * input_factors[row]
        } else {
            0.0
        }
    });
    let output_matrix = DMatrix::from_fn(CHANNELS, CHANNELS, |row, column| {
        if column == outputs[row] {
            output_gains[column] / output_factors[column]
        } else {
            0.0
        }
    });
    let [a, b, c, d] = physics.matrices;
    let in_order = |texts: [[&str; CHANNELS]; 2]| {
        [0, 1].map(|side| {
            ORDER[side]
                .iter()
                .map(|channel| texts[side][*channel].to_owned())
                .collect()
        })
    };
    let delays = [0, 1].map(|side| {
        ORDER[side]
            .iter()
            .map(|channel| DELAYS_S[side][*channel])
            .collect()
    });
    FileModel {
        condition,
        is_identified: true,
        matrices: [
            a,
            b * &input_matrix,
            &output_matrix * c,
            &output_matrix * d * &input_matrix,
        ],
        names: in_order(NAMES_OF_FLIGHT),
        units: in_order(UNITS_OF_FLIGHT),
        delays_s: has_delays.then_some(delays),
    }
}

/// Returns the physics model and the identified model of every condition.
fn models(has_delays: bool) -> Vec<FileModel> {
    (0..CONDITIONS)
        .flat_map(|condition| {
            [
                physics_model(condition),
                identified_model(condition, has_delays),
            ]
        })
        .collect()
}

impl FileModel {
    fn stem(&self) -> &'static str {
        if self.is_identified {
            "identified"
        } else {
            "nominal"
        }
    }

    /// Returns the frequency response at `omega` \[rad/s\] from the matrices; channels are indexed
    /// as in the file.
    fn response(&self, output: usize, input: usize, omega: f64) -> Complex<f64> {
        let [a, b, c, d] = &self.matrices;
        let s = Complex::new(0.0, omega);
        let complex = |matrix: &DMatrix<f64>| matrix.map(|value| Complex::new(value, 0.0));
        let resolvent = DMatrix::identity(a.nrows(), a.nrows()) * s - complex(a);
        let states = resolvent
            .lu()
            .solve(&complex(b))
            .expect("no pole on the imaginary axis");
        let value = (complex(c) * states)[(output, input)] + d[(output, input)];
        let delay_s = self
            .delays_s
            .as_ref()
            .map_or(0.0, |[inputs, outputs]| inputs[input] + outputs[output]);
        value * Complex::from_polar(1.0, -omega * delay_s)
    }

    /// Returns the model as the fields of a MATLAB struct.
    fn fields(&self) -> Vec<(&'static str, Value)> {
        let mut fields: Vec<(&str, Value)> = ["A", "B", "C", "D"]
            .into_iter()
            .zip(&self.matrices)
            .map(|(name, matrix)| (name, array(matrix)))
            .collect();
        let [inputs, outputs] = &self.names;
        let [input_units, output_units] = &self.units;
        fields.extend([("InputName", cell(inputs)), ("OutputName", cell(outputs))]);
        fields.extend([
            ("InputUnit", cell(input_units)),
            ("OutputUnit", cell(output_units)),
        ]);
        if let Some([inputs, outputs]) = &self.delays_s {
            fields.extend([("InputDelay", row(inputs)), ("OutputDelay", row(outputs))]);
        }
        fields.push(("airspeed_kt", row(&[airspeed_kt(self.condition)])));
        fields
    }
}

fn array(matrix: &DMatrix<f64>) -> Value {
    Value::Array(Array::matrix(
        matrix.nrows(),
        matrix.ncols(),
        matrix.as_slice().to_vec(),
    ))
}

fn row(values: &[f64]) -> Value {
    Value::Array(Array::matrix(1, values.len(), values.to_vec()))
}

fn text(text: &str) -> Value {
    Value::Text(TextArray {
        shape: vec![1, 1],
        texts: vec![text.to_owned()],
    })
}

fn cell(texts: &[String]) -> Value {
    Value::Cell(CellArray {
        shape: vec![texts.len(), 1],
        values: texts.iter().map(|entry| text(entry)).collect(),
    })
}

/// Returns a struct array, one element for each list of fields; all lists have the same names.
fn struct_array(elements: Vec<Vec<(&'static str, Value)>>) -> Value {
    let mut fields: Vec<(String, Vec<Value>)> = Vec::new();
    let count = elements.len();
    for element in elements {
        for (name, value) in element {
            match fields.iter_mut().find(|(known, _)| known == name) {
                Some((_, values)) => values.push(value),
                None => fields.push((name.to_owned(), vec![value])),
            }
        }
    }
    Value::Struct(StructArray {
        shape: vec![1, count],
        fields,
    })
}

fn variable(name: &str, value: Value) -> Variable {
    Variable {
        name: name.to_owned(),
        value,
    }
}

fn condition_folder(root: &Path, condition: usize) -> std::path::PathBuf {
    let folder = root.join(format!(
        "c{}_{:03.0}kt",
        condition + 1,
        airspeed_kt(condition)
    ));
    std::fs::create_dir_all(&folder).unwrap();
    folder
}

/// Stacks a matrix of several models; the model index is the last, or the first as in NumPy.
fn stacked(models: &[&FileModel], matrix: usize, pages_first: bool) -> Value {
    let first = &models[0].matrices[matrix];
    let (rows, columns) = first.shape();
    let mut values = Vec::new();
    if pages_first {
        for column in 0..columns {
            for row in 0..rows {
                values.extend(
                    models
                        .iter()
                        .map(|model| model.matrices[matrix][(row, column)]),
                );
            }
        }
        let shape = vec![models.len(), rows, columns];
        return Value::Array(Array {
            shape,
            kind: ElementKind::Float,
            re: values,
            im: None,
        });
    }
    for model in models {
        values.extend_from_slice(model.matrices[matrix].as_slice());
    }
    Value::Array(Array {
        shape: vec![rows, columns, models.len()],
        kind: ElementKind::Float,
        re: values,
        im: None,
    })
}

/// Returns the models of one role (identified or physics) in their order.
fn models_of_role(models: &[FileModel], is_identified: bool) -> Vec<&FileModel> {
    models
        .iter()
        .filter(|model| model.is_identified == is_identified)
        .collect()
}

// Writers of the file formats; each writes the study into a folder.

/// Writes a MATLAB file for each model.
fn mat_per_model(root: &Path) {
    for model in models(true) {
        let sys = struct_array(vec![model.fields()]);
        let path = condition_folder(root, model.condition).join(format!("{}.mat", model.stem()));
        std::fs::write(path, write_mat(&[variable("sys", sys)]).unwrap()).unwrap();
    }
}

/// Writes the models of a role as a struct array in a MATLAB file.
fn mat_struct_array(root: &Path) {
    for is_identified in [false, true] {
        let all = models(true);
        let models = models_of_role(&all, is_identified);
        let elements = models.iter().map(|model| model.fields()).collect();
        let path = root.join(format!("{}.mat", models[0].stem()));
        std::fs::write(
            path,
            write_mat(&[variable("models", struct_array(elements))]).unwrap(),
        )
        .unwrap();
    }
}

/// Writes one struct with a field for each condition, which contains a field for each model.
fn mat_one_struct(root: &Path) {
    let mut conditions = Vec::new();
    for (condition, name) in ["c1", "c2", "c3", "c4", "c5"].into_iter().enumerate() {
        let nominal = struct_array(vec![physics_model(condition).fields()]);
        let identified = struct_array(vec![identified_model(condition, true).fields()]);
        conditions.push((
            name,
            struct_array(vec![vec![("nominal", nominal), ("identified", identified)]]),
        ));
    }
    let study = struct_array(vec![conditions]);
    std::fs::write(
        root.join("study.mat"),
        write_mat(&[variable("study", study)]).unwrap(),
    )
    .unwrap();
}

/// Returns the stacked matrices of several models, and their common variables once.
fn stack(models: &[&FileModel], pages_first: bool) -> Vec<Variable> {
    let mut variables: Vec<Variable> = (0..4)
        .map(|matrix| {
            variable(
                ["A", "B", "C", "D"][matrix],
                stacked(models, matrix, pages_first),
            )
        })
        .collect();
    let texts = |texts: &[String]| {
        Value::Text(TextArray {
            shape: vec![1, texts.len()],
            texts: texts.to_vec(),
        })
    };
    let [inputs, outputs] = &models[0].names;
    let [input_units, output_units] = &models[0].units;
    let lists = [("input_names", inputs), ("output_names", outputs)];
    let units = [("input_units", input_units), ("output_units", output_units)];
    for (name, list) in lists.into_iter().chain(units) {
        variables.push(variable(
            name,
            if pages_first { texts(list) } else { cell(list) },
        ));
    }
    if let Some([inputs, outputs]) = &models[0].delays_s {
        variables.extend([
            variable("input_delays_s", row(inputs)),
            variable("output_delays_s", row(outputs)),
        ]);
    }
    let airspeeds: Vec<f64> = models
        .iter()
        .map(|model| airspeed_kt(model.condition))
        .collect();
    variables.push(variable("airspeed_kt", row(&airspeeds)));
    variables
}

/// Writes the models of a role as stacked matrices in a MATLAB file.
fn mat_stack(root: &Path) {
    for is_identified in [false, true] {
        let all = models(true);
        let models = models_of_role(&all, is_identified);
        let path = root.join(format!("{}.mat", models[0].stem()));
        std::fs::write(path, write_mat(&stack(&models, false)).unwrap()).unwrap();
    }
}

/// Writes the models of a role as stacked matrices in a NumPy archive.
fn npz_stack(root: &Path) {
    for is_identified in [false, true] {
        let all = models(true);
        let models = models_of_role(&all, is_identified);
        let path = root.join(format!("{}.npz", models[0].stem()));
        std::fs::write(path, write_npz(&stack(&models, true)).unwrap()).unwrap();
    }
}

/// Copies the study that GNU Octave has written in a format.
fn octave(form: &str, root: &Path) {
    let folder = program_folder().join("tests/data/forms").join(form);
    for entry in std::fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        std::fs::copy(&path, root.join(path.file_name().unwrap())).unwrap();
    }
}

/// Writes one matrix per file, without names, units and delays.
fn text_matrices(root: &Path) {
    for model in models(false) {
        for (letter, matrix) in ["A", "B", "C", "D"].into_iter().zip(&model.matrices) {
            let mut lines = String::new();
            for row in matrix.row_iter() {
                let cells: Vec<String> = row.iter().map(|value| format!("{value:?}")).collect();
                writeln!(lines, "{}", cells.join(",")).unwrap();
            }
            let name = format!("{}_{letter}.csv", model.stem());
            std::fs::write(condition_folder(root, model.condition).join(name), lines).unwrap();
        }
    }
}

/// Writes a JSON file for each model; channels are names, or objects with name and unit.
fn json_models(root: &Path, names_are_objects: bool) {
    for model in models(true) {
        let rows = |matrix: &DMatrix<f64>| -> Vec<Vec<f64>> {
            matrix
                .row_iter()
                .map(|row| row.iter().copied().collect())
                .collect()
        };
        let [a, b, c, d] = &model.matrices;
        let mut file = json!({"A": rows(a), "B": rows(b), "C": rows(c), "D": rows(d)});
        for (side, units_key) in [("inputs", "input_units"), ("outputs", "output_units")] {
            let side_index = usize::from(side == "outputs");
            let names = &model.names[side_index];
            let units = &model.units[side_index];
            if names_are_objects {
                let objects = names
                    .iter()
                    .zip(units)
                    .map(|(name, unit)| json!({"name": name, "unit": unit}));
                file[side] = objects.collect();
            } else {
                file[side] = json!(names);
                file[units_key] = json!(units);
            }
        }
        if let Some([inputs, outputs]) = &model.delays_s {
            file["input_delays_s"] = json!(inputs);
            file["output_delays_s"] = json!(outputs);
        }
        let path = condition_folder(root, model.condition).join(format!("{}.json", model.stem()));
        std::fs::write(path, file.to_string()).unwrap();
    }
}

/// Returns the frequencies of the analysis, and one beyond each end of the band, so that no
/// response has to be interpolated.
fn frequencies() -> Vec<f64> {
    let points = Study::new(Arc::clone(&crate::EXAMPLE.dataset))
        .settings
        .points;
    let grid = FrequencyGrid::logarithmic(Band::new(0.5, 12.0).unwrap(), points);
    [&[0.3], grid.omega(), &[15.0]].concat()
}

/// Writes the physics models as MATLAB files, and each identified model with `write`.
fn physics_beside(root: &Path, write: impl Fn(&Path, &FileModel)) {
    for condition in 0..CONDITIONS {
        let folder = condition_folder(root, condition);
        let sys = struct_array(vec![physics_model(condition).fields()]);
        std::fs::write(
            folder.join("nominal.mat"),
            write_mat(&[variable("sys", sys)]).unwrap(),
        )
        .unwrap();
        write(&folder, &identified_model(condition, true));
    }
}

/// Names of the flight channels in column headings and file names, in the order of the files.
const SHORT_NAMES: [[&str; CHANNELS]; 2] = [
    ["theta0", "lat_cyclic", "delta_lon"],
    ["nz", "pitch_rate", "p"],
];

/// Writes each identified model as a text table with two columns for each response.
fn frf_wide(root: &Path) {
    physics_beside(root, |folder, model| {
        let mut heading = "f [Hz]".to_owned();
        for output in SHORT_NAMES[1] {
            for input in SHORT_NAMES[0] {
                write!(
                    heading,
                    ",mag {output}/{input} [dB],phase {output}/{input} [deg]"
                )
                .unwrap();
            }
        }
        let mut table = format!("{heading}\n");
        for omega in frequencies() {
            write!(table, "{:?}", omega / TAU).unwrap();
            for output in 0..CHANNELS {
                for input in 0..CHANNELS {
                    let value = model.response(output, input, omega);
                    write!(
                        table,
                        ",{:?},{:?}",
                        20.0 * value.norm().log10(),
                        value.arg().to_degrees()
                    )
                    .unwrap();
                }
            }
            table.push('\n');
        }
        std::fs::write(folder.join("flight.csv"), table).unwrap();
    });
}

/// Returns a file name such as "frf_q_delta_lon_run2.csv".
fn name_of_response(output: &str, input: &str) -> String {
    format!("frf_{output}_{input}_run2.csv")
}

/// Writes a file for each response, with the name that `name` returns.
fn frf_per_response(root: &Path, name: impl Fn(&str, &str) -> String) {
    physics_beside(root, |folder, model| {
        for (output, output_name) in SHORT_NAMES[1].into_iter().enumerate() {
            for (input, input_name) in SHORT_NAMES[0].into_iter().enumerate() {
                let mut table = "omega [rad/s],re,im\n".to_owned();
                for omega in frequencies() {
                    let value = model.response(output, input, omega);
                    writeln!(table, "{omega:?},{:?},{:?}", value.re, value.im).unwrap();
                }
                std::fs::write(folder.join(name(output_name, input_name)), table).unwrap();
            }
        }
    });
}

/// Writes each identified model as an array of responses in a NumPy archive.
fn frd_npz(root: &Path, names: impl Fn(&FileModel) -> [Vec<String>; 2]) {
    physics_beside(root, |folder, model| {
        let omega = frequencies();
        let mut re = Vec::new();
        let mut im = Vec::new();
        for frequency in &omega {
            for input in 0..CHANNELS {
                for output in 0..CHANNELS {
                    let value = model.response(output, input, *frequency);
                    re.push(value.re);
                    im.push(value.im);
                }
            }
        }
        let shape = vec![CHANNELS, CHANNELS, omega.len()];
        let response = Value::Array(Array {
            shape,
            kind: ElementKind::Float,
            re,
            im: Some(im),
        });
        let texts = |texts: &[String]| {
            Value::Text(TextArray {
                shape: vec![1, texts.len()],
                texts: texts.to_vec(),
            })
        };
        let [inputs, outputs] = names(model);
        let [input_units, output_units] = &model.units;
        let variables = [
            variable("frdata", response),
            variable("omega", row(&omega)),
            variable("input_labels", texts(&inputs)),
            variable("output_labels", texts(&outputs)),
            variable("input_units", texts(input_units)),
            variable("output_units", texts(output_units)),
        ];
        std::fs::write(folder.join("flight.npz"), write_npz(&variables).unwrap()).unwrap();
    });
}

/// Returns rules with the channels, their units, and the conversion factor for the stick travel in
/// inches.
fn rules(_: &[FoundModel]) -> Rules {
    let channels = |side: usize| {
        let rule = |channel: usize| ChannelRule {
            unit: UNITS[side][channel].to_owned(),
            ..ChannelRule::named(NAMES[side][channel])
        };
        (0..CHANNELS).map(rule).collect()
    };
    let pair = |output: &str, input: &str| (output.to_owned(), input.to_owned());
    Rules {
        name: "forms".to_owned(),
        inputs: channels(0),
        outputs: channels(1),
        on_axis: vec![pair("P", "LAT"), pair("Q", "LON"), pair("NZ", "COL")],
        band: (0.5, 12.0),
        units: vec![UnitRule {
            channel: "LON".into(),
            from: "in".into(),
            factor: PERCENT_IN_AN_INCH,
        }],
        ..Rules::default()
    }
}

/// Returns rules that also state units, factor and sign for identified files that lack them.
fn rules_of_role(found: &[FoundModel]) -> Rules {
    let mut rules = Rules {
        units: Vec::new(),
        ..rules(found)
    };
    let flight_rules = rules.declarations_mut(FileScope::Identified);
    for (channel, unit) in [
        ("LAT", "%"),
        ("COL", "fraction"),
        ("P", "rad/s"),
        ("Q", "rad/s"),
        ("NZ", "g"),
    ] {
        flight_rules
            .units
            .insert(channel.to_owned(), unit.to_owned());
    }
    flight_rules
        .factors
        .insert("LON".to_owned(), PERCENT_IN_AN_INCH);
    flight_rules.signs.insert("NZ".to_owned(), -1.0);
    rules
}

/// Returns rules that also state the units in the physics files and the channel order of the
/// identified files.
fn rules_of_matrices(found: &[FoundModel]) -> Rules {
    let mut rules = rules_of_role(found);
    for channel in rules.inputs.iter_mut().chain(&mut rules.outputs) {
        channel.unit_in_files = Some(channel.unit.clone());
    }
    let in_order = |side: usize| {
        Some(
            ORDER[side]
                .iter()
                .map(|channel| NAMES[side][*channel].to_owned())
                .collect(),
        )
    };
    for model in found
        .iter()
        .filter(|model| model.file().ends_with("identified"))
    {
        let row = rules.rows.entry(model.key()).or_default();
        row.inputs = in_order(0);
        row.outputs = in_order(1);
    }
    rules
}

/// Expected outcome for a file format.
enum Outcome {
    /// The known gains are recovered, and the known delays if the format can store them.
    Known { has_delays: bool },
    /// A question with this code is asked, and no dataset is created.
    Asked(&'static str),
}

struct Form {
    name: &'static str,
    write: fn(&Path),
    rules: fn(&[FoundModel]) -> Rules,
    outcome: Outcome,
}

/// Asserts that each response differs from the physics model by the known gain and delay.
fn assert_known(name: &str, dataset: Dataset, has_delays: bool) {
    assert_eq!(dataset.conditions().len(), CONDITIONS, "{name}");
    for (place, condition) in dataset.conditions().iter().enumerate() {
        let state = condition.flight_state();
        assert_eq!(state.airspeed_kt, airspeed_kt(place), "{name}");
    }
    let mut study = Study::new(Arc::new(dataset));
    // Bounds that contain the known gains and delays, and no penalty that would move the optimum.
    for edit in [
        setting_table::GAIN_BOUNDS.to(Some(GainBounds {
            lower: 0.3,
            upper: 3.0,
        })),
        setting_table::DELAY_UPPER.to(Some(0.1)),
        setting_table::ALPHA_GAIN.to(0.0),
        setting_table::ALPHA_DELAY.to(0.0),
    ] {
        study.apply(&edit).unwrap();
    }
    let analysis = Engine::default().analyze(&study, &Unobserved).unwrap();
    for (place, condition) in study.dataset.conditions().iter().enumerate() {
        let result = analysis
            .condition(condition.id())
            .unwrap_or_else(|| panic!("{name}: condition {place} has no result"));
        let [input_gains, output_gains] = gains(place);
        for output in 0..CHANNELS {
            for input in 0..CHANNELS {
                let pair = Pair::new(output, input);
                let gain = input_gains[input] * output_gains[output];
                let delay_s = if has_delays {
                    DELAYS_S[0][input] + DELAYS_S[1][output]
                } else {
                    0.0
                };
                let delta = &result.comparison.delta;
                let context = format!("{name}, condition {place}, {pair:?}");
                let found_gain = delta.gain[pair].unwrap();
                assert!(
                    (found_gain / gain - 1.0).abs() < 1e-6,
                    "{context}: delta gain {found_gain}, not {gain}"
                );
                let found_delay_s = delta.delay_s[pair].unwrap();
                assert!(
                    (found_delay_s - delay_s).abs() < 1e-6,
                    "{context}: delta delay {found_delay_s} s, not {delay_s} s"
                );
                if study.dataset.header().on_axis[pair] {
                    let net_gain = result.correction.net_gain(pair);
                    assert!(
                        (net_gain / gain - 1.0).abs() < 1e-6,
                        "{context}: net gain {net_gain}, not {gain}"
                    );
                    let net_delay_s = result.correction.net_delay_s(pair);
                    assert!(
                        (net_delay_s - delay_s).abs() < 1e-6,
                        "{context}: net delay {net_delay_s} s, not {delay_s} s"
                    );
                }
            }
        }
    }
}

#[test]
fn every_file_format_gives_the_known_gains_and_delays_or_asks_a_question() {
    const KNOWN: Outcome = Outcome::Known { has_delays: true };
    let forms = [
        Form {
            name: ".mat per model",
            write: mat_per_model,
            rules,
            outcome: KNOWN,
        },
        Form {
            name: "struct array",
            write: mat_struct_array,
            rules,
            outcome: KNOWN,
        },
        Form {
            name: "one struct",
            write: mat_one_struct,
            rules,
            outcome: KNOWN,
        },
        Form {
            name: "stacked arrays",
            write: mat_stack,
            rules,
            outcome: KNOWN,
        },
        Form {
            name: "npz stack",
            write: npz_stack,
            rules,
            outcome: KNOWN,
        },
        Form {
            name: "Octave -binary",
            write: |root| octave("binary", root),
            rules,
            outcome: KNOWN,
        },
        Form {
            name: "Octave -text",
            write: |root| octave("text", root),
            rules,
            outcome: KNOWN,
        },
        Form {
            name: "Octave -hdf5",
            write: |root| octave("hdf5", root),
            rules,
            outcome: KNOWN,
        },
        Form {
            name: "Octave -v7",
            write: |root| octave("v7", root),
            rules,
            outcome: KNOWN,
        },
        Form {
            name: "text matrices",
            write: text_matrices,
            rules: rules_of_matrices,
            outcome: Outcome::Known { has_delays: false },
        },
        Form {
            name: "JSON, names",
            write: |root| json_models(root, false),
            rules,
            outcome: KNOWN,
        },
        Form {
            name: "JSON, objects",
            write: |root| json_models(root, true),
            rules,
            outcome: KNOWN,
        },
        Form {
            name: "FRF table, wide",
            write: frf_wide,
            rules: rules_of_role,
            outcome: KNOWN,
        },
        Form {
            name: "FRF table per response",
            write: |root| frf_per_response(root, name_of_response),
            rules: rules_of_role,
            outcome: KNOWN,
        },
        Form {
            name: "FRD npz",
            write: |root| frd_npz(root, |model| model.names.clone()),
            rules,
            outcome: KNOWN,
        },
        // Information that neither the files nor the rules contain is asked for.
        Form {
            name: "text matrices without units",
            write: text_matrices,
            rules,
            outcome: Outcome::Asked("unit-of-file"),
        },
        Form {
            name: "FRD npz whose labels match nothing",
            write: |root| {
                frd_npz(root, |_| {
                    ["u", "y"].map(|letter| {
                        (1..=CHANNELS)
                            .map(|number| format!("{letter}{number}"))
                            .collect()
                    })
                })
            },
            rules,
            outcome: Outcome::Asked("response-unmatched"),
        },
        Form {
            name: "FRF tables of unknown names",
            write: |root| {
                frf_per_response(root, |output, input| {
                    format!("{}{}.csv", output.len(), input.len())
                })
            },
            rules: rules_of_role,
            outcome: Outcome::Asked("response-unmatched"),
        },
        Form {
            name: "FRF tables of derivatives",
            write: |root| {
                frf_per_response(root, |output, input| {
                    format!("frf_{output}_dot_{input}.csv")
                })
            },
            rules: rules_of_role,
            outcome: Outcome::Asked("response-name"),
        },
    ];
    for Form {
        name,
        write,
        rules,
        outcome,
    } in forms
    {
        let folder = tempfile::tempdir().unwrap();
        write(folder.path());
        let found = read_models(&[folder.path().to_owned()], &Headings::new(), &Silent).unwrap();
        assert!(found.faults.is_empty(), "{name}: {:?}", found.faults);
        let rules = rules(&found.models);
        let assembly = Assembly::new(found.models, rules);
        match outcome {
            Outcome::Known { has_delays } => {
                assert!(
                    assembly.problems().is_empty(),
                    "{name}: {:#?}",
                    assembly.problem_lines()
                );
                assert_known(name, assembly.dataset("").unwrap(), has_delays);
            }
            Outcome::Asked(code) => {
                let codes: Vec<&str> = assembly
                    .problems()
                    .iter()
                    .map(|problem| problem.kind.code())
                    .collect();
                assert!(
                    codes.contains(&code),
                    "{name}: {:#?}",
                    assembly.problem_lines()
                );
                assert!(assembly.dataset("").is_none(), "{name}");
            }
        }
    }
}
