//! Mixing and feedback for the reference dataset, from the signed delays (M15.4) to the gains and
//! costs with couplings (M16), against independent numpy code (`tests/data/reference/mixing.json`).

use std::sync::{Arc, LazyLock};

use nalgebra::DMatrix;
use serde_json::Value;

use gdcm_method::correction::{Channels, Pade};
use gdcm_method::couplings::coupling_shares::{cyclic_inputs, feedback_shares, mixing_shares};
use gdcm_method::couplings::fit::CouplingFit;
use gdcm_method::couplings::jackknife::left_out_fits;
use gdcm_method::couplings::problem::{
    CouplingOptions, mean_delays_s, response_deviation, without_delays_and_leads,
};
use gdcm_method::couplings::{
    CouplingBars, CouplingCondition, CouplingKind, CouplingMatrices, CouplingProblem, LoopMargin,
    PoleShift, fit_couplings,
};
use gdcm_method::schedule::CostChange;
use gdcm_model::dataset::model::Origin;
use gdcm_model::dataset::{
    Band, BundleKind, Condition, ConditionId, Dataset, Dynamics, Model, ModelId, Pair, PairTable,
};
use gdcm_model::executor::{Executor, Sequential, Task};
use gdcm_model::progress::Unobserved;
use gdcm_model::response::{FrequencyGrid, FrequencyResponse};

use crate::decisions::edit::Edit;
use crate::decisions::setting_table;
use crate::decisions::settings::{CouplingCorrection, PhaseCorrection};
use crate::decisions::study::Study;
use crate::reference_tests::{list, matrix, number, numbers, reference_dataset, unpacked_dataset};
use crate::results::analysis::{Analysis, ConditionAnalysis};
use crate::results::assessment_table::{
    AssessedCorrection, AssessedModel, AssessmentChoice, AssessmentTable,
};
use crate::stages::engine::Engine;

pub(crate) static REFERENCE: LazyLock<Value> = LazyLock::new(|| {
    serde_json::from_str(include_str!("../../../../tests/data/reference/mixing.json")).unwrap()
});

/// A dataset and its analysis with leads, without rejections.
pub(crate) struct Example {
    pub(crate) dataset: Arc<Dataset>,
    pub(crate) analysis: Analysis,
}

/// The reference dataset, for which `mixing.json` contains the expected values.
pub(crate) static EXAMPLE: LazyLock<Example> =
    LazyLock::new(|| Example::analyzed(reference_dataset()));

/// Fit of mixing and feedback to [`EXAMPLE`].
pub(crate) static FEEDBACK: LazyLock<CouplingFit> =
    LazyLock::new(|| fit(&EXAMPLE.problem(CouplingKind::MixingAndFeedback)));

fn with_leads(dataset: Arc<Dataset>) -> Analysis {
    let mut study = Study::new(dataset);
    study
        .apply(&setting_table::PHASE.to(PhaseCorrection::Lead))
        .unwrap();
    Engine::default().analyze(&study, &Unobserved).unwrap()
}

fn results(analysis: &Analysis) -> impl Iterator<Item = &ConditionAnalysis> {
    analysis
        .conditions
        .values()
        .map(|result| result.as_ref().unwrap())
}

fn representative(result: &ConditionAnalysis, kind: BundleKind) -> &Model {
    let chosen = match kind {
        BundleKind::Physics => result.comparison.physics.model,
        BundleKind::Identified => result.comparison.identified.model,
    };
    &result.condition.bundle(kind)[chosen]
}

impl Example {
    fn analyzed(dataset: Dataset) -> Self {
        let dataset = Arc::new(dataset);
        Self {
            analysis: with_leads(Arc::clone(&dataset)),
            dataset,
        }
    }

    fn mean_delays_s(&self) -> Channels<f64> {
        let delays_s: Vec<_> = results(&self.analysis)
            .map(|result| result.correction.signed_delays_s())
            .collect();
        mean_delays_s(&delays_s).unwrap()
    }

    pub(crate) fn problem(&self, kind: CouplingKind) -> CouplingProblem {
        let settings = &self.analysis.study.settings;
        let grid = FrequencyGrid::logarithmic(settings.band, settings.points);
        let delays_s = self.mean_delays_s();
        let mut conditions = Vec::new();
        for result in results(&self.analysis) {
            let physics = representative(result, BundleKind::Physics);
            let flight = representative(result, BundleKind::Identified);
            let leads = result.correction.leads.as_ref().unwrap();
            conditions.push(CouplingCondition {
                id: result.condition.id(),
                airspeed_kt: result.condition.flight_state().airspeed_kt,
                physics: Arc::new(FrequencyResponse::from_dynamics(&physics.dynamics, &grid)),
                flight: without_delays_and_leads(
                    &FrequencyResponse::from_dynamics(&flight.dynamics, &grid),
                    grid.omega(),
                    &delays_s,
                    Some(&leads.design),
                ),
                usable: result
                    .comparison
                    .representative
                    .mismatch
                    .map(|_, mismatch| mismatch.is_some()),
                deviation: flight
                    .bands
                    .as_ref()
                    .map(|bands| response_deviation(bands, grid.omega())),
                coherence: None,
            });
        }
        CouplingProblem {
            kind,
            omega: grid.omega().into(),
            on_axis: self.dataset.on_axis().clone(),
            conditions,
            options: CouplingOptions::default(),
        }
    }

    /// Returns the dataset of the representatives alone, with the couplings on the physics models.
    fn coupled(&self, matrices: &CouplingMatrices) -> Arc<Dataset> {
        let mut conditions = Vec::new();
        for result in results(&self.analysis) {
            let state = result.condition.flight_state();
            let physics = representative(result, BundleKind::Physics)
                .state_space()
                .unwrap();
            let physics = matrices
                .model(physics, state.airspeed_kt, Pade::new(4).unwrap())
                .unwrap();
            let nominal = Model::new(
                "coupled",
                Origin::Nominal { perturbation: None },
                Dynamics::StateSpace(physics),
            );
            let flight = representative(result, BundleKind::Identified).clone();
            conditions.push(Condition::new(state.clone(), vec![nominal], vec![flight]).unwrap());
        }
        Arc::new(Dataset::new(self.dataset.header(), conditions).unwrap())
    }

    /// Returns the minimum singular value of `I - K H` from `low` to `high` \[rad/s\] over the
    /// physics representatives.
    fn least_margin(&self, matrices: &CouplingMatrices, low: f64, high: f64) -> LoopMargin {
        let grid = FrequencyGrid::logarithmic(Band::beyond(low, high).unwrap(), 60);
        let mut margins = Vec::new();
        for result in results(&self.analysis) {
            let physics = representative(result, BundleKind::Physics);
            let response = FrequencyResponse::from_dynamics(&physics.dynamics, &grid);
            let singular = matrices.least_singular_values(&response);
            margins.push(LoopMargin::find(&singular, grid.omega()).unwrap());
        }
        margins
            .into_iter()
            .min_by(|a, b| a.least.total_cmp(&b.least))
            .unwrap()
    }

    /// Returns the poles of all physics models that become unstable.
    fn newly_unstable(&self, matrices: &CouplingMatrices) -> Vec<PoleShift> {
        let mut unstable = Vec::new();
        for condition in self.dataset.conditions() {
            for model in condition.bundle(BundleKind::Physics) {
                let physics = model.state_space().unwrap();
                let airspeed_kt = condition.flight_state().airspeed_kt;
                let shifts = matrices
                    .pole_shifts(physics, airspeed_kt, Pade::new(4).unwrap())
                    .unwrap();
                unstable.extend(shifts.into_iter().filter(PoleShift::is_newly_unstable));
            }
        }
        unstable
    }
}

pub(crate) fn fit(problem: &CouplingProblem) -> CouplingFit {
    fit_couplings(problem, &Sequential, &Unobserved).unwrap()
}

#[track_caller]
pub(crate) fn assert_close(name: &str, found: &[f64], expected: &[f64], tolerance: f64) {
    assert_eq!(found.len(), expected.len(), "{name}: count");
    for (place, (found, expected)) in found.iter().zip(expected).enumerate() {
        assert!(
            (found - expected).abs() < tolerance,
            "{name}, {place}: found {found}, expected {expected}"
        );
    }
}

fn row_by_row(matrix: &DMatrix<f64>) -> Vec<f64> {
    matrix.transpose().as_slice().to_vec()
}

/// Returns the mean of the corrected J as `[on-axis, others]`, over responses and conditions.
pub(crate) fn mean_costs(tables: impl Iterator<Item = PairTable<Option<CostChange>>>) -> [f64; 2] {
    let mut sums = [0.0; 2];
    let mut counts = [0.0; 2];
    for table in tables {
        for (pair, change) in table.iter() {
            let axis = usize::from(!EXAMPLE.dataset.on_axis()[pair]);
            sums[axis] += change.unwrap().corrected.total();
            counts[axis] += 1.0;
        }
    }
    [sums[0] / counts[0], sums[1] / counts[1]]
}

/// Asserts that a fit, and the analysis of the models with its couplings, agree with `mixing.json`.
fn assert_example_agrees(fit: &CouplingFit, name: &str) {
    let reference = &REFERENCE["example"][name];
    let tolerance = &REFERENCE["tolerance"];
    let coefficient = number(&tolerance["coefficients"]);
    let tau_s = number(&tolerance["tau_s"]);
    let delays_s = EXAMPLE.mean_delays_s();
    assert_close(
        "tau_out",
        &delays_s.outputs,
        &numbers(&reference["tau_out_s"]),
        tau_s,
    );
    assert_close(
        "tau_in",
        &delays_s.inputs,
        &numbers(&reference["tau_in_s"]),
        tau_s,
    );
    assert!(fit.residual < 1e-12, "{:e}", fit.residual);
    for (solve, expected) in list(&reference["coefficients"]).iter().enumerate() {
        assert_close(
            &format!("solve {solve}"),
            &fit.coefficients[solve],
            &numbers(expected),
            coefficient,
        );
    }
    let analysis = with_leads(EXAMPLE.coupled(&fit.matrices));
    for expected in list(&reference["conditions"]) {
        let id = ConditionId(expected["id"].as_i64().unwrap());
        let found = analysis.condition(id).unwrap();
        let mixing = fit
            .matrices
            .mixing(found.condition.flight_state().airspeed_kt);
        assert_close(
            "M",
            &row_by_row(&mixing),
            &row_by_row(&matrix(&expected["M"])),
            coefficient,
        );
        let feedback = row_by_row(fit.matrices.feedback());
        assert_close(
            "K",
            &feedback,
            &row_by_row(&matrix(&expected["K"])),
            coefficient,
        );
        let case = format!("condition {id}");
        let signed_s = found.correction.signed_delays_s();
        assert_close(
            &case,
            &signed_s.outputs,
            &numbers(&expected["tau_out_s"]),
            tau_s,
        );
        assert_close(
            &case,
            &signed_s.inputs,
            &numbers(&expected["tau_in_s"]),
            tau_s,
        );
        assert_close(
            &case,
            &found.correction.output_gains,
            &numbers(&expected["k_out"]),
            coefficient,
        );
        assert_close(
            &case,
            &found.correction.input_gains,
            &numbers(&expected["k_in"]),
            coefficient,
        );
    }
    assert_costs_agree(&analysis, name);
}

#[test]
fn the_fit_of_mixing_agrees_with_independent_code() {
    assert_example_agrees(&fit(&EXAMPLE.problem(CouplingKind::Mixing)), "mixing");
}

#[test]
fn the_fit_of_mixing_and_feedback_agrees_with_independent_code() {
    assert_example_agrees(&FEEDBACK, "feedback");
}

/// The identified models of the embedded example come from this program. The limits are close to
/// the results with other identified models of the same helicopter: minimum singular values of 0.87
/// in the band and 0.96 above, and two additional slow divergences.
#[test]
fn couplings_of_the_embedded_example_are_found_in_its_models() {
    let example = Example::analyzed(unpacked_dataset(include_bytes!(
        "../../../../assets/example-dataset.json.gz"
    )));
    let fit = fit(&example.problem(CouplingKind::MixingAndFeedback));
    let mixing = fit
        .matrices
        .normalised_mixing(fit.matrices.airspeeds().mean_kt);
    let (inputs, _) = example.dataset.input_and_output_names();
    let index = |name: &str| inputs.iter().position(|input| input == name).unwrap();
    // True values of the simulated aircraft: from LON to LAT, a swashplate phase of 1.8 degrees
    // plus a coupling; 0.03 for the other two entries.
    for (from, to, expected) in [
        ("LON", "LAT", 0.047),
        ("COL", "LAT", 0.027),
        ("PED", "LON", 0.026),
    ] {
        let found = mixing[(index(to), index(from))];
        assert!((found - expected).abs() < 0.01, "{from} to {to}: {found}");
    }
    let low = example.dataset.band().min();
    let high = example.dataset.band().max();
    let in_band = example.least_margin(&fit.matrices, low, high);
    let above = example.least_margin(&fit.matrices, high, 10.0 * high);
    assert!(
        in_band.least > 0.84 && above.least > 0.95,
        "{in_band:?} {above:?}"
    );
    assert!(!in_band.is_close_to_ringing() && !above.is_close_to_ringing());
    let unstable = example.newly_unstable(&fit.matrices);
    assert!(
        unstable.len() == 2 && unstable.iter().all(|shift| shift.after.norm() < 0.008),
        "{unstable:?}"
    );
    let [before, after] = [
        &example.analysis,
        &with_leads(example.coupled(&fit.matrices)),
    ]
    .map(|analysis| mean_costs(results(analysis).map(|result| (*result.cost).clone())));
    assert!(
        after[0] < before[0] && after[1] < 0.5 * before[1],
        "{before:?} {after:?}"
    );
}

#[test]
fn error_bars_separate_the_largest_mixing_entry_from_zero() {
    let problem = EXAMPLE.problem(CouplingKind::MixingAndFeedback);
    let fits = left_out_fits(&problem, &Sequential, &Unobserved).unwrap();
    assert_eq!(fits.len(), 11, "one for each condition");
    let airspeed_kt = FEEDBACK.matrices.airspeeds().mean_kt;
    let bars = CouplingBars::from_fits(&fits, airspeed_kt, 0.9).unwrap();
    let mixing = FEEDBACK.matrices.normalised_mixing(airspeed_kt);
    let (inputs, _) = EXAMPLE.dataset.input_and_output_names();
    let index = |name: &str| inputs.iter().position(|input| input == name).unwrap();
    let lon_to_lat = (index("LAT"), index("LON"));
    assert!(mixing[lon_to_lat].abs() > bars.mixing[lon_to_lat]);
    let cyclic = cyclic_inputs(EXAMPLE.dataset.on_axis(), |output| {
        EXAMPLE.dataset.outputs()[output].unit.contains("deg/s")
    });
    assert_eq!(cyclic, Some([index("LON"), index("LAT")]));
    let shares = mixing_shares(&FEEDBACK.matrices.normalised_mixing(airspeed_kt), cyclic);
    let swashplate = shares
        .iter()
        .find(|share| (share.to, share.from) == lon_to_lat)
        .unwrap();
    assert!(
        (swashplate.swashplate_phase_deg.unwrap().to_radians().tan() - swashplate.share).abs()
            < 1e-15
    );
    // An entry of K for each response, the largest share of the stick first.
    let feedback = feedback_shares(&problem, &FEEDBACK.matrices);
    assert_eq!(feedback.len(), 24);
    assert!(
        feedback
            .windows(2)
            .all(|neighbours| neighbours[0].share >= neighbours[1].share)
    );
}

/// Executor that runs the pieces of work in reverse order.
struct Backwards;

impl Executor for Backwards {
    fn carry_out(&self, tasks: Vec<Task<'_>>) {
        for task in tasks.into_iter().rev() {
            task();
        }
    }
}

#[test]
fn a_fit_does_not_depend_on_the_order_of_its_tasks() {
    let found = fit_couplings(
        &EXAMPLE.problem(CouplingKind::MixingAndFeedback),
        &Backwards,
        &Unobserved,
    )
    .unwrap();
    assert_eq!(found, *FEEDBACK);
}

/// Returns the study of the reference dataset with leads and these couplings.
fn study(couplings: CouplingCorrection) -> Study {
    let mut study = EXAMPLE.analysis.study.clone();
    study
        .apply(&setting_table::COUPLINGS.to(couplings))
        .unwrap();
    study
}

fn analyze(engine: &mut Engine, study: &Study) -> Analysis {
    engine.analyze(study, &Unobserved).unwrap()
}

/// An engine that has analysed the example with mixing and feedback, and its analysis.
pub(crate) static COUPLED: LazyLock<(Engine, Analysis)> = LazyLock::new(|| {
    let mut engine = Engine::default();
    let analysis = analyze(&mut engine, &study(CouplingCorrection::MixingAndFeedback));
    (engine, analysis)
});

/// Returns a copy of the engine of [`COUPLED`], for each test to change.
pub(crate) fn engine() -> Engine {
    COUPLED.0.fork(Box::new(gdcm_model::executor::Sequential))
}

/// Returns the mean J as `[on-axis, others]`, under each condition's own correction and under the
/// schedule.
pub(crate) fn own_and_scheduled(analysis: &Analysis) -> [[f64; 2]; 2] {
    let own = mean_costs(results(analysis).map(|result| (*result.cost).clone()));
    let choice = AssessmentChoice {
        model: AssessedModel::Representative,
        correction: AssessedCorrection::Scheduled,
        average: analysis.study.settings.cost_average,
    };
    let table = AssessmentTable::assess(analysis, choice);
    let change = |id: ConditionId| PairTable::from_fn(6, 4, |pair| table.change(id, pair));
    [
        own,
        mean_costs(analysis.conditions.keys().map(|&id| change(id))),
    ]
}

/// Asserts that the mean costs of an analysis agree with `mixing.json`.
fn assert_costs_agree(analysis: &Analysis, name: &str) {
    let mean_cost = &REFERENCE["example"][name]["mean_J"];
    let tolerance = number(&REFERENCE["tolerance"]["mean_J"]);
    let [own, scheduled] = own_and_scheduled(analysis);
    assert_close("own J", &own, &numbers(&mean_cost["own"]), tolerance);
    assert_close(
        "scheduled J",
        &scheduled,
        &numbers(&mean_cost["scheduled"]),
        tolerance,
    );
}

#[test]
fn the_engine_with_mixing_and_feedback_agrees_with_independent_code() {
    let analysis = &COUPLED.1;
    assert_eq!(analysis.fitted_couplings().unwrap().fit, *FEEDBACK);
    assert_costs_agree(analysis, "feedback");
    for (id, result) in &analysis.conditions {
        let result = result.as_ref().unwrap();
        let before = EXAMPLE.analysis.condition(*id).unwrap();
        for kind in BundleKind::BOTH {
            assert_eq!(
                result.representative_name(kind),
                before.representative_name(kind),
                "representatives are chosen before couplings are applied"
            );
        }
        assert_eq!(result.suggested(), before.suggested());
        assert_eq!(result.before_couplings(), &*before.comparison);
        assert_eq!(result.doubts, before.doubts);
    }
}

#[test]
fn the_engine_with_mixing_agrees_with_independent_code() {
    let analysis = analyze(&mut engine(), &study(CouplingCorrection::Mixing));
    assert_eq!(
        analysis.fitted_couplings().unwrap().fit,
        fit(&EXAMPLE.problem(CouplingKind::Mixing))
    );
    assert_costs_agree(&analysis, "mixing");
}

#[test]
fn couplings_that_are_switched_off_leave_no_trace_in_the_results() {
    let found = analyze(&mut engine(), &study(CouplingCorrection::None));
    assert!(found.couplings.is_none());
    assert_eq!(found, EXAMPLE.analysis);
    let coupled = analyze(&mut engine(), &study(CouplingCorrection::MixingAndFeedback));
    assert_eq!(
        coupled, COUPLED.1,
        "an analysis without couplings in between changes nothing"
    );
}

#[test]
fn a_change_of_the_gain_weight_keeps_the_fit() {
    let mut study = study(CouplingCorrection::MixingAndFeedback);
    study.apply(&setting_table::ALPHA_GAIN.to(0.2)).unwrap();
    study.apply(&setting_table::AGREEMENT.to(0.1)).unwrap();
    let analysis = analyze(&mut engine(), &study);
    assert!(Arc::ptr_eq(
        analysis.fitted_couplings().unwrap(),
        COUPLED.1.fitted_couplings().unwrap()
    ));
    let id = *analysis.conditions.keys().next().unwrap();
    assert_ne!(
        analysis.condition(id).unwrap().gains,
        COUPLED.1.condition(id).unwrap().gains
    );
    study.settings.points = 150;
    assert_ne!(
        analyze(&mut engine(), &study).fitted_couplings(),
        COUPLED.1.fitted_couplings(),
        "other frequencies need another fit"
    );
}

#[test]
fn a_held_out_condition_does_not_enter_the_fit() {
    let mut study = study(CouplingCorrection::MixingAndFeedback);
    let held_out = ConditionId(3);
    study
        .apply(&Edit::SetHeldOut {
            condition: held_out,
            held_out: true,
        })
        .unwrap();
    let mut engine = engine();
    let analysis = analyze(&mut engine, &study);
    let couplings = analysis.fitted_couplings().unwrap();
    assert!(!couplings.is_fitted_to(held_out) && couplings.problem.conditions.len() == 10);
    assert_ne!(couplings.fit, *FEEDBACK);
    let result = analysis.condition(held_out).unwrap();
    assert_ne!(
        &*result.comparison,
        result.before_couplings(),
        "the couplings are applied to the held-out condition as well"
    );
    // If another identified model of the held-out condition represents its bundle, the fit does not
    // change.
    let representative = result.representative_name(BundleKind::Identified);
    let identified = result.condition.bundle(BundleKind::Identified);
    let other = identified
        .iter()
        .rfind(|model| model.name != representative)
        .unwrap();
    study
        .apply(&Edit::Pin(ModelId::new(
            held_out,
            BundleKind::Identified,
            &other.name,
        )))
        .unwrap();
    let pinned = analyze(&mut engine, &study);
    assert!(Arc::ptr_eq(pinned.fitted_couplings().unwrap(), couplings));
    assert_ne!(
        pinned.condition(held_out).unwrap().comparison,
        result.comparison
    );
}

#[test]
fn couplings_that_cannot_be_fitted_are_refused_and_leave_the_results_unchanged() {
    // All conditions are held out.
    let mut study = study(CouplingCorrection::MixingAndFeedback);
    for &condition in EXAMPLE.analysis.conditions.keys() {
        study
            .apply(&Edit::SetHeldOut {
                condition,
                held_out: true,
            })
            .unwrap();
    }
    let analysis = analyze(&mut engine(), &study);
    let refusal = analysis.couplings.as_ref().unwrap().as_ref().unwrap_err();
    assert_eq!(refusal.code(), "nothing-to-fit", "{refusal}");
    let result = analysis.condition(ConditionId(1)).unwrap();
    assert_eq!(
        result.comparison,
        EXAMPLE
            .analysis
            .condition(ConditionId(1))
            .unwrap()
            .comparison
    );
    assert!(result.coupled.is_none());
}

#[test]
fn error_bars_of_gains_include_the_couplings_of_the_representatives() {
    let mut engine = engine();
    let id = ConditionId(1);
    let pair = EXAMPLE.dataset.on_axis().marked().next().unwrap();
    let bar = |engine: &mut Engine, analysis: &Analysis| {
        let uncertainty = engine.uncertainty(analysis, &Unobserved).unwrap();
        *uncertainty
            .bar(id, gdcm_method::uncertainty::Scalar::Gain(pair))
            .unwrap()
    };
    let with = bar(&mut engine, &COUPLED.1);
    let without = bar(&mut engine, &EXAMPLE.analysis);
    let gain =
        |analysis: &Analysis, pair: Pair| analysis.condition(id).unwrap().delta_gain(pair).unwrap();
    assert!((with.value - gain(&COUPLED.1, pair).ln()).abs() < 1e-12);
    assert!((without.value - gain(&EXAMPLE.analysis, pair).ln()).abs() < 1e-12);
    assert_ne!(with, without);
    assert_eq!(bar(&mut engine, &COUPLED.1), with);
}
