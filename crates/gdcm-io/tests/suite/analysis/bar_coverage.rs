//! Coverage of error bars in synthetic studies with known net gains (M13), and the tables in
//! `docs/uncertainty.md`.
//!
//! Each study has many conditions with diagonal models, so that every net gain is the G of a single
//! response. `ln G` of a physics model and of an identified model is drawn from a normal
//! distribution with a given standard deviation. The program then chooses representatives,
//! substitutes models and computes bars as for any other dataset.
//!
//! This command prints the tables and compares them with the page:
//!
//! ```text
//! cargo test -p gdcm-io --test suite bar_coverage::tables -- --ignored --nocapture
//! ```

use std::ops::RangeInclusive;

use serde_json::{Value, json};

use gdcm_method::uncertainty::{Bar, Scalar, student_quantile};
use gdcm_model::dataset::{BundleKind, ConditionId, Pair};
use gdcm_study::Analysis;
use gdcm_study::decisions::setting_table;
use gdcm_study::results::uncertainty::Uncertainty;

use super::uncertainty::{normal, set, study_of, uncertainty_of};
use crate::evidence;

/// Confidence level of all bars in these tests.
const LEVEL: f64 = 0.9;
/// `ln` of every true net gain.
const TRUTH: f64 = 0.2;
/// Standard deviation of the error of a single identified model, in `ln G`.
const MODEL_ERROR: f64 = 0.02;
/// Random seed of every population.
const SEED: u64 = 88_172_645_463_325_252;
/// Number of net gains per population in the tests that always run.
const FEW: usize = 800;
/// Number of net gains per population in the tables.
const MANY: usize = 8000;

/// Trim at which the synthetic aircraft was flown.
#[derive(Clone, Copy)]
enum FlownTrim {
    /// Drawn from the same distribution as the trims of the physics models.
    LikeTheBundle,
    /// The nominal trim, although the trims of the physics models vary.
    Nominal,
}

/// Distribution of the models of a synthetic study.
#[derive(Clone, Copy)]
struct Population {
    /// Number of identified models of each condition.
    identified_models: usize,
    /// Share of the variance of an identified model's error that all models of its condition have
    /// in common.
    shared: f64,
    /// Number of on-axis responses of each condition; their errors are independent.
    responses: usize,
    /// Standard deviation of `ln G` over trims, in units of [`MODEL_ERROR`]; at 0, the bundle has a
    /// single physics model.
    trim: f64,
    flown: FlownTrim,
    /// Maximum degrees of freedom that a condition borrows from the other conditions.
    prior_degrees: f64,
}

/// Three independent identified models, one physics model, the default settings.
const THREE_INDEPENDENT: Population = Population {
    identified_models: 3,
    shared: 0.0,
    responses: 4,
    trim: 0.0,
    flown: FlownTrim::LikeTheBundle,
    prior_degrees: 4.0,
};

/// `ln` of the gain factors of the models of one condition, relative to the nominal physics model:
/// a row for each model, a column for each response.
struct ConditionDraw {
    physics: Vec<Vec<f64>>,
    identified: Vec<Vec<f64>>,
    /// `ln` of the factor of the flown trim, for each response.
    flown: Vec<f64>,
}

/// Counts and sums over the bars of a population, for comparison with the errors of its net gains.
#[derive(Default)]
struct Coverage {
    net_gains: usize,
    /// Number of bars that contain the true net gain.
    covered: usize,
    /// Number of bars that would contain the true net gain if the variance of the identification
    /// part, the only part, were halved.
    covered_if_halved: usize,
    error_squares: f64,
    /// Sum of the squared errors due to the identified representative alone.
    identification_error_squares: f64,
    identification_squares: f64,
    half_widths: f64,
    /// Sum of Student's quantiles of the identification parts.
    quantiles: f64,
}

impl Population {
    fn draw(&self, state: &mut u64) -> ConditionDraw {
        let physics_models = if self.trim > 0.0 { 9 } else { 1 };
        let trim = self.trim * MODEL_ERROR;
        let mut physics = vec![vec![0.0; self.responses]];
        for _ in 1..physics_models {
            physics.push(draws(self.responses, trim, state));
        }
        let flown = match self.flown {
            FlownTrim::LikeTheBundle => draws(self.responses, trim, state),
            FlownTrim::Nominal => vec![0.0; self.responses],
        };
        let common = draws(self.responses, MODEL_ERROR * self.shared.sqrt(), state);
        let mut identified = Vec::new();
        for _ in 0..self.identified_models {
            let own = draws(
                self.responses,
                MODEL_ERROR * (1.0 - self.shared).sqrt(),
                state,
            );
            identified.push(
                (0..self.responses)
                    .map(|k| TRUTH + flown[k] + common[k] + own[k])
                    .collect(),
            );
        }
        ConditionDraw {
            physics,
            identified,
            flown,
        }
    }

    /// Returns the coverage over at least `net_gains` net gains; reproducible for a given seed.
    fn coverage(&self, net_gains: usize, seed: u64) -> Coverage {
        let mut state = seed;
        let mut coverage = Coverage::default();
        // Studies of at most a hundred conditions, which pool their identification parts.
        while coverage.net_gains < net_gains {
            let conditions = (net_gains / self.responses).min(100);
            let draws: Vec<ConditionDraw> =
                (0..conditions).map(|_| self.draw(&mut state)).collect();
            let mut study = study_of(&dataset(&draws, self.responses));
            set(&mut study, setting_table::POINTS.to(5));
            set(&mut study, setting_table::POOLING.to(self.prior_degrees));
            let (analysis, found) = uncertainty_of(&study);
            coverage.count(&draws, &analysis, &found);
        }
        coverage
    }
}

/// Returns normal deviates with the standard deviation `deviation`.
fn draws(count: usize, deviation: f64, state: &mut u64) -> Vec<f64> {
    (0..count).map(|_| deviation * normal(state)).collect()
}

fn diagonal(values: &[f64]) -> Vec<Vec<f64>> {
    (0..values.len())
        .map(|row| {
            (0..values.len())
                .map(|k| if k == row { values[row] } else { 0.0 })
                .collect()
        })
        .collect()
}

/// Returns a diagonal model of first-order lags, one for each response, with the gain factors
/// `exp(logarithms)`.
fn model(name: &str, logarithms: &[f64]) -> Value {
    let size = logarithms.len();
    let gains: Vec<f64> = logarithms.iter().map(|logarithm| logarithm.exp()).collect();
    json!({"name": name, "A": diagonal(&vec![-1.0; size]), "B": diagonal(&vec![1.0; size]),
        "C": diagonal(&gains), "D": diagonal(&vec![0.0; size])})
}

fn dataset(draws: &[ConditionDraw], responses: usize) -> Value {
    let mut conditions = Vec::new();
    for (place, draw) in draws.iter().enumerate() {
        let mut physics = Vec::new();
        for (number, logarithms) in draw.physics.iter().enumerate() {
            let mut model = model(&format!("p{number}"), logarithms);
            model["role"] = if number == 0 { "nominal" } else { "perturbed" }.into();
            physics.push(model);
        }
        let identified: Vec<Value> = draw
            .identified
            .iter()
            .enumerate()
            .map(|(number, row)| model(&format!("i{number}"), row))
            .collect();
        conditions.push(
            json!({"id": place, "name": format!("draw {place}"), "airspeed_kt": 40 + 2 * place,
            "physics_models": physics, "identified_models": identified}),
        );
    }
    let mut inputs = Vec::new();
    let mut outputs = Vec::new();
    let mut on_axis = Vec::new();
    for channel in 0..responses {
        inputs.push(json!({"name": format!("U{channel}"), "unit": "%"}));
        outputs.push(json!({"name": format!("Y{channel}"), "unit": "deg/s"}));
        on_axis.push([format!("Y{channel}"), format!("U{channel}")]);
    }
    json!({"format": "gdcm-dataset", "version": 1, "name": "population", "inputs": inputs, "outputs": outputs,
        "on_axis": on_axis, "frequency_band": {"min": 0.5, "max": 12.0, "unit": "rad/s"}, "conditions": conditions})
}

impl Coverage {
    fn count(&mut self, draws: &[ConditionDraw], analysis: &Analysis, found: &Uncertainty) {
        for (place, draw) in draws.iter().enumerate() {
            let id = ConditionId(place as i64);
            let physics = analysis
                .condition(id)
                .unwrap()
                .representative(BundleKind::Physics)
                .model;
            for (response, flown) in draw.flown.iter().enumerate() {
                let bar = found
                    .bar(id, Scalar::NetGain(Pair::new(response, response)))
                    .unwrap();
                self.count_bar(bar, TRUTH + flown - draw.physics[physics][response]);
            }
        }
    }

    /// Counts a bar with respect to [`TRUTH`]; `without_identification_error` is the value that an
    /// error-free identified model would give.
    fn count_bar(&mut self, bar: &Bar, without_identification_error: f64) {
        let identification = bar.identification.unwrap();
        let half_width = bar.half_width(LEVEL).unwrap();
        let error = bar.value - TRUTH;
        self.net_gains += 1;
        self.covered += usize::from(error.abs() <= half_width);
        self.covered_if_halved += usize::from(error.abs() <= half_width / 2.0_f64.sqrt());
        self.error_squares += error * error;
        self.identification_error_squares += (bar.value - without_identification_error).powi(2);
        self.identification_squares += identification.variance;
        self.half_widths += half_width;
        self.quantiles += student_quantile(LEVEL, identification.degrees_of_freedom);
    }

    fn mean(&self, sum: f64) -> f64 {
        sum / self.net_gains as f64
    }

    fn fraction(&self) -> f64 {
        self.mean(self.covered as f64)
    }

    /// Returns the ratio of the mean half-width to the rms error of the net gains.
    fn width_ratio(&self) -> f64 {
        self.mean(self.half_widths) / self.mean(self.error_squares).sqrt()
    }

    /// Returns the rms error of the identified representative in units of [`MODEL_ERROR`].
    fn representative_error(&self) -> f64 {
        self.mean(self.identification_error_squares).sqrt() / MODEL_ERROR
    }

    /// Returns the rms of `s_id` in units of [`MODEL_ERROR`]. Pooling does not change this rms if
    /// all conditions have the same number of models.
    fn spread(&self) -> f64 {
        self.mean(self.identification_squares).sqrt() / MODEL_ERROR
    }
}

/// Returns the range in which a fraction of [`FEW`] net gains must lie: `expected`, from a longer
/// run, with four standard deviations of the binomial distribution to either side. About one seed
/// in 16 000 would violate it.
fn binomial_range(expected: f64) -> RangeInclusive<f64> {
    let deviation = (expected * (1.0 - expected) / FEW as f64).sqrt();
    expected - 4.0 * deviation..=expected + 4.0 * deviation
}

/// Asserts the coverage and the width ratio of a population as stated in `docs/uncertainty.md`, and
/// returns the coverage.
#[track_caller]
fn assert_coverage(population: Population, fraction: f64, width_ratio: f64) -> Coverage {
    let found = population.coverage(FEW, SEED);
    let range = binomial_range(fraction);
    assert!(
        range.contains(&found.fraction()),
        "{} of {FEW}: not within {range:?}",
        found.covered
    );
    // 0.1 is four standard deviations: the rms of 800 errors has a relative standard deviation of
    // 2.5 %.
    assert!(
        (found.width_ratio() / width_ratio - 1.0).abs() < 0.1,
        "{} instead of {width_ratio}",
        found.width_ratio()
    );
    found
}

/// Records a coverage for `docs/verification.md`.
fn record(code: &str, found: &Coverage) {
    evidence::record_coverage(evidence::Coverage {
        code,
        intervals: found.net_gains,
        covered: found.covered,
        nominal: LEVEL,
        seeds: &SEED.to_string(),
    });
}

#[test]
fn bars_of_three_independent_models_are_wide() {
    let found = assert_coverage(THREE_INDEPENDENT, 0.999, 2.89);
    record("bars-of-independent-models", &found);
    assert_coverage(
        Population {
            trim: 0.5,
            ..THREE_INDEPENDENT
        },
        0.994,
        2.54,
    );
}

#[test]
fn bars_hold_their_level_where_models_share_half_of_their_error() {
    let found = assert_coverage(
        Population {
            shared: 0.5,
            ..THREE_INDEPENDENT
        },
        0.932,
        1.84,
    );
    record("bars-of-shared-errors", &found);
}

#[test]
fn bars_hold_their_level_where_the_trim_makes_most_of_the_error() {
    let found = assert_coverage(
        Population {
            trim: 4.0,
            ..THREE_INDEPENDENT
        },
        0.902,
        1.78,
    );
    record("bars-of-trim", &found);
}

fn shared_error_line(population: Population) -> String {
    let found = population.coverage(MANY, SEED);
    let models = population.identified_models;
    let [shared, width, covered, halved] = [
        100.0 * population.shared,
        found.width_ratio(),
        100.0 * found.fraction(),
        100.0 * found.mean(found.covered_if_halved as f64),
    ];
    format!("| {models} | {shared:.0} % | {width:.2} | {covered:.1} % | {halved:.1} % |")
}

/// Returns the rows of the tables in `docs/uncertainty.md`, a line of Markdown for each population.
fn measured_lines() -> Vec<String> {
    let mut lines = Vec::new();
    for identified_models in [2, 3, 5, 10] {
        for responses in [1, 4] {
            let found = Population {
                identified_models,
                responses,
                ..THREE_INDEPENDENT
            }
            .coverage(MANY, SEED);
            let [error, spread, quantile] = [
                found.representative_error(),
                found.spread(),
                found.mean(found.quantiles),
            ];
            let [width, covered] = [found.width_ratio(), 100.0 * found.fraction()];
            lines.push(format!(
                "| {identified_models} | {responses} | {error:.2} | {spread:.2} | {quantile:.2} | {width:.2} | {covered:.1} % |"
            ));
        }
    }
    for shared in [0.0, 0.25, 0.5, 0.75] {
        lines.push(shared_error_line(Population {
            shared,
            ..THREE_INDEPENDENT
        }));
    }
    for identified_models in [2, 5, 10] {
        lines.push(shared_error_line(Population {
            identified_models,
            shared: 0.5,
            ..THREE_INDEPENDENT
        }));
    }
    for prior_degrees in [0.0, 4.0, 100.0] {
        let found = Population {
            prior_degrees,
            ..THREE_INDEPENDENT
        }
        .coverage(MANY, SEED);
        let [quantile, width, covered] = [
            found.mean(found.quantiles),
            found.width_ratio(),
            100.0 * found.fraction(),
        ];
        lines.push(format!(
            "| {prior_degrees} | {quantile:.2} | {width:.2} | {covered:.1} % |"
        ));
    }
    for trim in [0.5, 1.0, 1.5, 2.0, 4.0] {
        let found = Population {
            trim,
            ..THREE_INDEPENDENT
        }
        .coverage(MANY, SEED);
        let at_nominal = Population {
            trim,
            flown: FlownTrim::Nominal,
            ..THREE_INDEPENDENT
        }
        .coverage(MANY, SEED);
        let [width, covered, nominal] = [
            found.width_ratio(),
            100.0 * found.fraction(),
            100.0 * at_nominal.fraction(),
        ];
        lines.push(format!(
            "| {trim:.1} | {width:.2} | {covered:.1} % | {nominal:.1} % |"
        ));
    }
    lines
}

#[test]
#[ignore = "the tables of docs/uncertainty.md take a minute"]
fn tables() {
    let page =
        std::fs::read_to_string(crate::program_folder().join("docs/uncertainty.md")).unwrap();
    let lines = measured_lines();
    for line in &lines {
        println!("{line}");
    }
    let missing: Vec<&String> = lines
        .iter()
        .filter(|line| !page.contains(line.as_str()))
        .collect();
    assert!(
        missing.is_empty(),
        "not in docs/uncertainty.md: {missing:#?}"
    );
}
