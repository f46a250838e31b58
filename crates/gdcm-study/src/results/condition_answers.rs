//! Time responses of the models of one condition for plots (M17.2): to the inputs of a flight
//! record, with the tolerance corridors about flight, and to a test input, with no record to
//! compare with.

use std::sync::Arc;

use nalgebra::DMatrix;

use gdcm_method::requirements::tolerance::ChannelTolerance;
use gdcm_method::requirements::{RecordCheck, TestInput, Tolerance, ToleranceTable};
use gdcm_model::dataset::ConditionId;
use gdcm_model::executor::{Executor, each};
use gdcm_model::progress::{Cancelled, Progress};
use gdcm_model::simulation::{FlightRecord, Validation, validate};
use gdcm_model::units::telling;
use gdcm_sysid::identification::Preparation;
use gdcm_sysid::spectra::preparation::segments_of;

use super::analysis::Analysis;
use super::requirements::RequirementRole;
use super::table::Table;
use super::time_histories::{Comparer, HistoryRecord, LEAST_PIECE_S, Trend, common_windows};
use super::time_history_tables::percent;
use crate::jobs::job::{Job, Shared};

/// One quantity of a record: measured, and simulated with each model.
#[derive(Clone, Debug, PartialEq)]
pub struct QuantityHistory {
    pub tolerance: Tolerance,
    /// Index of the output that it is computed from.
    pub output: usize,
    /// Unit of the compared quantity.
    pub unit: String,
    /// Whether the output is on-axis to the input that moved most; `None` where that input is
    /// unknown.
    pub on_axis: Option<bool>,
    /// Result of each model, in the same windows for all models.
    pub models: Vec<(RequirementRole, RecordCheck)>,
}

/// One record against the tolerances.
#[derive(Clone, Debug, PartialEq)]
pub struct RecordHistory {
    pub condition: ConditionId,
    pub record: String,
    /// Whether the record was excluded from the identification of the models.
    pub held_out: bool,
    /// The record, in the units of the dataset's channels.
    pub flight: Shared<FlightRecord>,
    /// Each applicable row of the table.
    pub quantities: Vec<QuantityHistory>,
    /// The quantities that are not compared, with reasons in words.
    pub missing: Vec<String>,
}

impl RecordHistory {
    /// Builds the table: share of time inside, largest excess and its time, for each quantity and
    /// model; off-axis, also whether the trend is correct.
    pub fn table(&self) -> Table {
        let columns = [
            "quantity",
            "tolerance",
            "entry",
            "model",
            "inside [%]",
            "largest excess",
            "at [s]",
            "off-axis trend",
            "correlation",
        ];
        let held_out = if self.held_out { ", held out" } else { "" };
        let mut table = Table::new(
            format!("{}{held_out}: within tolerances", self.record),
            columns,
        );
        for of in &self.quantities {
            for (role, check) in &of.models {
                let worst = check.worst();
                let beyond = worst.filter(|worst| worst.largest_excess > 0.0);
                let correlation = check.correlation();
                table.row([
                    of.tolerance.quantity.clone(),
                    of.tolerance.words(),
                    of.tolerance.entry.clone(),
                    role.name().to_owned(),
                    percent(Some(check.share_inside())),
                    beyond.map_or("none".to_owned(), |worst| {
                        format!("{} {}", telling(worst.largest_excess, 2), of.unit)
                    }),
                    beyond.map_or(String::new(), |worst| telling(worst.largest_excess_at_s, 1)),
                    Trend::of(correlation, of.on_axis)
                        .map_or("", Trend::name)
                        .to_owned(),
                    correlation.map_or(String::new(), |of| telling(of, 2).replace('-', "\u{2212}")),
                ]);
            }
        }
        table
    }
}

/// Job that compares a record of a condition with the tolerances of the study, beside the live
/// answer.
#[derive(Clone, Debug, PartialEq)]
pub struct RecordHistoryJob {
    pub analysis: Shared<Analysis>,
    pub condition: ConditionId,
    pub record: HistoryRecord,
    /// Preparation of its channels.
    pub preparation: Preparation,
    pub tolerances: ToleranceTable,
}

impl RecordHistoryJob {
    fn found(&self, executor: &dyn Executor) -> Result<RecordHistory, String> {
        let result = self.analysis.result(self.condition)?;
        let preparation = Preparation {
            least_segment_s: LEAST_PIECE_S,
            ..self.preparation.clone()
        };
        let segments =
            segments_of(&self.record.flight, &preparation).map_err(|error| error.to_string())?;
        let mut missing = Vec::new();
        let mut models = Vec::new();
        for role in RequirementRole::ALL {
            match self.analysis.role_model(result, role) {
                Ok(model) => models.push((role, model)),
                Err(why) => missing.push(format!("{} model: {why}", role.name())),
            }
        }
        let settings = common_windows(models.iter().map(|(_, model)| model), &segments);
        let mut answers = Vec::new();
        for (role, model) in &models {
            match validate(model, &segments, &settings, executor) {
                Ok(validation) => answers.push((*role, validation)),
                Err(why) => missing.push(format!("{} model: {why}", role.name())),
            }
        }
        let mut not_applied = Vec::new();
        let comparer = Comparer::of(&self.analysis, &self.tolerances, &mut not_applied);
        missing.extend(not_applied.into_iter().map(|of| of.why));
        let moved = comparer.moved_input(&segments);
        let quantity = |(tolerance, of_channel): &(&Tolerance, ChannelTolerance)| {
            let check = |(role, validation): &(RequirementRole, Validation)| {
                let checks = RecordCheck::of_windows(&validation.windows, of_channel).ok()?;
                Some((*role, checks.into_iter().next()?))
            };
            QuantityHistory {
                tolerance: Tolerance::clone(tolerance),
                output: of_channel.output,
                unit: of_channel.unit.clone(),
                on_axis: comparer.is_on_axis(of_channel.output, moved),
                models: answers.iter().filter_map(check).collect(),
            }
        };
        let quantities = comparer.rows.iter().map(quantity).collect();
        let record = self.record.flight.name.clone();
        let held_out = self.record.held_out;
        let flight = self.record.flight.clone();
        Ok(RecordHistory {
            condition: self.condition,
            record,
            held_out,
            flight,
            quantities,
            missing,
        })
    }
}

impl Job for RecordHistoryJob {
    /// Executor of the pieces.
    type Tools = Box<dyn Executor>;
    /// Error: the reason in words.
    type Output = Result<Arc<RecordHistory>, String>;

    fn run(
        &self,
        executor: &mut Self::Tools,
        progress: &dyn Progress,
    ) -> Result<Self::Output, Cancelled> {
        let found = self.found(executor.as_ref()).map(Arc::new);
        if progress.cancelled() {
            Err(Cancelled)
        } else {
            Ok(found)
        }
    }
}

/// Time shown, as a multiple of the duration of the test input.
const SHOWN: f64 = 5.0;
/// Least time shown \[s\].
const LEAST_SHOWN_S: f64 = 10.0;
/// Number of sample times in the time shown.
const STEPS: usize = 1000;

/// Responses of the models of a condition to a test input, starting from rest.
#[derive(Clone, Debug, PartialEq)]
pub struct TestAnswers {
    pub condition: ConditionId,
    pub input: usize,
    /// Shape of the input.
    pub test: TestInput,
    /// Sample time \[s\]; the first sample is at 0 s.
    pub sample_time_s: f64,
    /// The input at every sample, in its unit.
    pub signal: Vec<f64>,
    /// Outputs of each model, samples x outputs, in their units; otherwise the reason in words.
    pub models: Vec<(RequirementRole, Result<DMatrix<f64>, String>)>,
}

impl TestAnswers {
    fn of(job: &TestAnswersJob, executor: &dyn Executor) -> Result<Self, String> {
        let TestAnswersJob {
            analysis,
            condition,
            input,
            test,
        } = job;
        let condition = *condition;
        let input = *input;
        let result = analysis.result(condition)?;
        let sample_time_s = LEAST_SHOWN_S.max(SHOWN * test.duration_s) / STEPS as f64;
        let answer = |role: &RequirementRole| {
            let model = analysis
                .role_model(result, *role)
                .map_err(|error| error.to_string())?;
            test.answer(&model, input, sample_time_s, STEPS + 1)
                .map_err(|error| error.to_string())
        };
        let answers = each(executor, &RequirementRole::ALL, answer);
        let signal = test.signal(sample_time_s, STEPS + 1);
        let models = RequirementRole::ALL.into_iter().zip(answers).collect();
        Ok(Self {
            condition,
            input,
            test: *test,
            sample_time_s,
            signal,
            models,
        })
    }

    /// Returns the times of the samples \[s\].
    pub fn time_s(&self) -> Vec<f64> {
        (0..self.signal.len())
            .map(|n| n as f64 * self.sample_time_s)
            .collect()
    }
}

/// Job that simulates the models of a condition with the study's test input, beside the live
/// answer.
#[derive(Clone, Debug, PartialEq)]
pub struct TestAnswersJob {
    pub analysis: Shared<Analysis>,
    pub condition: ConditionId,
    pub input: usize,
    /// Shape of the input.
    pub test: TestInput,
}

impl Job for TestAnswersJob {
    /// Executor of the pieces.
    type Tools = Box<dyn Executor>;
    /// Error: the reason in words.
    type Output = Result<Arc<TestAnswers>, String>;

    fn run(
        &self,
        executor: &mut Self::Tools,
        progress: &dyn Progress,
    ) -> Result<Self::Output, Cancelled> {
        let found = TestAnswers::of(self, executor.as_ref()).map(Arc::new);
        if progress.cancelled() {
            Err(Cancelled)
        } else {
            Ok(found)
        }
    }
}

#[cfg(test)]
mod tests {
    use gdcm_method::correction::Pade;
    use gdcm_method::requirements::TestInputShape;
    use gdcm_model::dataset::BundleKind;
    use gdcm_model::progress::Unobserved;

    use super::*;
    use crate::results::couplings_tests::EXAMPLE;

    fn answers(test: TestInput) -> TestAnswers {
        let analysis = EXAMPLE.analysis.clone();
        let condition = *analysis.conditions.keys().next().unwrap();
        let job = TestAnswersJob {
            analysis: Arc::new(analysis).into(),
            condition,
            input: 1,
            test,
        };
        let executor: Box<dyn Executor> = Box::new(gdcm_model::executor::Sequential);
        TestAnswers::clone(&job.run(&mut { executor }, &Unobserved).unwrap().unwrap())
    }

    #[test]
    fn every_model_answers_in_proportion_to_the_size_of_the_test() {
        let test = TestInput {
            shape: TestInputShape::Doublet,
            size: 1.0,
            duration_s: 1.0,
        };
        let one = answers(test);
        let three = answers(TestInput { size: 3.0, ..test });
        for ((role, small), (_, large)) in one.models.iter().zip(&three.models) {
            let small = small.as_ref().unwrap();
            let large = large.as_ref().unwrap();
            // Linear models; rounding of a thousand steps.
            assert!(
                (3.0 * small - large).amax() <= 1e-9 * large.amax(),
                "{role:?}"
            );
            assert!(small.amax() > 0.0, "{role:?}");
        }
    }

    #[test]
    fn the_corrected_model_answers_as_that_which_is_exported() {
        let test = TestInput {
            shape: TestInputShape::Step,
            size: 2.0,
            duration_s: 3.0,
        };
        let found = answers(test);
        let result = EXAMPLE.analysis.conditions[&found.condition]
            .as_ref()
            .unwrap();
        let physics = result.condition.model(
            BundleKind::Physics,
            result.representative_name(BundleKind::Physics),
        );
        let physics = physics.unwrap().state_space().unwrap();
        let exported = result
            .corrected_model(physics, &result.correction, Pade::default())
            .unwrap()
            .model;
        let expected = test
            .answer(&exported, 1, found.sample_time_s, found.signal.len())
            .unwrap();
        let of = |role| {
            found
                .models
                .iter()
                .find(|of| of.0 == role)
                .unwrap()
                .1
                .as_ref()
                .unwrap()
        };
        assert_eq!(*of(RequirementRole::Corrected), expected);
        assert_ne!(*of(RequirementRole::Physics), expected);
    }
}
