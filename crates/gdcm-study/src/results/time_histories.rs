//! Time histories of the models of every condition within tolerances about its flight records
//! (M17.2).
//!
//! ```text
//! 1  a record is prepared as an identification prepares it, pieces of 2 s and more
//! 2  each model answers to the flown sticks, in windows of at most 10 s, each from an estimated state and offsets (M14, 6); the windows of
//!    all models of a condition are the same, so that their manoeuvres begin at the same samples
//! 3  each row of the table of tolerances whose output and unit are there: share inside, largest excess, correlation
//! ```

use std::collections::BTreeMap;
use std::sync::Arc;

use serde::Serialize;

use gdcm_method::requirements::summary::RmsCost;
use gdcm_method::requirements::tolerance::{ChannelTolerance, ToleranceCheck};
use gdcm_method::requirements::{RecordCheck, Tolerance, ToleranceTable};
use gdcm_model::dataset::{Channel, ConditionId, Pair, PairTable, StateSpace};
use gdcm_model::executor::{Executor, Sequential};
use gdcm_model::progress::{Cancelled, Progress};
use gdcm_model::simulation::{
    FlightRecord, Segment, ValidationSettings, ValidationWindow, validate,
};
use gdcm_sysid::identification::Preparation;
use gdcm_sysid::records::LaidOutRecord;
use gdcm_sysid::spectra::preparation::segments_of;

use super::analysis::{Analysis, ConditionAnalysis};
use super::requirements::{MissingFinding, RequirementRole, RoleModelError};
use crate::jobs::job::{Job, Shared};
use crate::stages::engine::Engine;
use crate::stages::execution::Execution;

/// Shortest piece of a record that is compared \[s\]: qualification tests are short steps and
/// doublets.
pub(crate) const LEAST_PIECE_S: f64 = 2.0;
/// Category of the reasons for an absent time history.
const WHAT: &str = "time histories";

/// A flight record for the comparison of models.
#[derive(Clone, Debug, PartialEq)]
pub struct HistoryRecord {
    pub flight: Shared<FlightRecord>,
    /// Whether the record was excluded from the identification of the models.
    pub held_out: bool,
}

/// The flight records of a condition, and their preparation.
#[derive(Clone, Debug, PartialEq)]
pub struct HistoryRecords {
    pub condition: ConditionId,
    pub records: Vec<HistoryRecord>,
    pub preparation: Preparation,
}

impl HistoryRecords {
    /// Collects those of the `records` that are used.
    pub fn of<'r>(
        condition: ConditionId,
        records: impl IntoIterator<Item = &'r LaidOutRecord>,
        preparation: Preparation,
    ) -> Self {
        let used = records.into_iter().filter_map(|record| {
            let flight = Arc::clone(record.used_flight()?);
            Some(HistoryRecord {
                flight: flight.into(),
                held_out: record.guess.held_out,
            })
        });
        Self {
            condition,
            records: used.collect(),
            preparation,
        }
    }

    /// Returns the number of steps of [`time_histories_of`]: one to prepare each record, one for
    /// each model's response to it.
    pub fn steps(records: &[Self]) -> usize {
        (1 + RequirementRole::ALL.len()) * records.iter().map(|of| of.records.len()).sum::<usize>()
    }
}

/// Job that compares records with an analysis.
#[derive(Clone, Debug, PartialEq)]
pub struct TimeHistoriesJob {
    pub analysis: Shared<Analysis>,
    pub records: Vec<HistoryRecords>,
    pub tolerances: ToleranceTable,
}

impl Job for TimeHistoriesJob {
    /// Executor of the pieces.
    type Tools = Box<dyn Executor>;
    type Output = Arc<TimeHistories>;

    fn run(
        &self,
        executor: &mut Self::Tools,
        progress: &dyn Progress,
    ) -> Result<Self::Output, Cancelled> {
        let execution = Execution::new(
            executor.as_ref(),
            progress,
            HistoryRecords::steps(&self.records),
        );
        Ok(Arc::new(time_histories_of(
            &self.analysis,
            &self.records,
            &self.tolerances,
            &execution,
        )?))
    }
}

impl Engine {
    /// Simulates the models of an analysis with `records` and compares them within the tolerances
    /// of its study; see [`time_histories_of`].
    ///
    /// # Errors
    /// [`Cancelled`] soon after `progress` requests it.
    pub fn time_histories(
        &self,
        analysis: &Analysis,
        records: &[HistoryRecords],
        progress: &dyn Progress,
    ) -> Result<TimeHistories, Cancelled> {
        let execution = Execution::new(self.executor(), progress, HistoryRecords::steps(records));
        time_histories_of(
            analysis,
            records,
            &analysis.study.requirements.tolerances,
            &execution,
        )
    }
}

/// Whether an off-axis output has the same trend as in flight.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Trend {
    /// The correlation of simulated and measured output is positive.
    Correct,
    /// The correlation is not positive.
    Opposite,
}

impl Trend {
    /// Returns the trend of an output off-axis to the input that moved most, from the correlation
    /// of simulated and measured output; `None` on-axis.
    pub(crate) fn of(correlation: Option<f64>, on_axis: Option<bool>) -> Option<Self> {
        let correlation = correlation.filter(|_| on_axis == Some(false))?;
        Some(if correlation > 0.0 {
            Self::Correct
        } else {
            Self::Opposite
        })
    }

    /// Returns the name of the trend.
    pub fn name(self) -> &'static str {
        match self {
            Self::Correct => "correct",
            Self::Opposite => "opposite",
        }
    }
}

/// Result of one model and one record for one row of the table.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct ToleranceFinding {
    /// Name of the compared quantity ("bank angle").
    pub quantity: String,
    /// The output that it is computed from.
    pub output: String,
    /// Whether it is the integral of that output from the start of each window.
    pub integrated: bool,
    /// Unit of the compared quantity.
    pub unit: String,
    /// Share of the samples inside, 0 to 1.
    pub share_inside: f64,
    /// The largest distance beyond the corridor, in `unit`; negative where all samples are inside.
    pub largest_excess: f64,
    /// Time of the largest excess, on the record's clock \[s\].
    pub largest_excess_at_s: f64,
    /// Correlation of simulated and measured signal about their means; `None` where one of them is
    /// constant.
    pub correlation: Option<f64>,
    /// Whether the output is on-axis to the input that moved most; `None` where that input is
    /// unknown.
    pub on_axis: Option<bool>,
    /// For off-axis outputs, the sign of the correlation.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub trend: Option<Trend>,
}

impl ToleranceFinding {
    /// Returns the numbers with their names.
    pub fn quantities(&self) -> [(&'static str, Option<f64>); 4] {
        [
            ("share_inside", Some(self.share_inside)),
            ("largest_excess", Some(self.largest_excess)),
            ("largest_excess_at_s", Some(self.largest_excess_at_s)),
            ("correlation", self.correlation),
        ]
    }
}

/// Result of one model and one record.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct HistoryFinding {
    pub condition: ConditionId,
    /// Its true airspeed \[kt\].
    pub airspeed_kt: f64,
    pub record: String,
    /// Whether the record was excluded from the identification of the models.
    pub held_out: bool,
    pub role: RequirementRole,
    pub model: String,
    /// The input that moved most; `None` where the inputs have different units.
    pub moved_input: Option<String>,
    /// Number of samples compared.
    pub samples: usize,
    /// Number of windows with these samples.
    pub windows: usize,
    /// Length of the longest window \[s\].
    pub window_s: f64,
    /// Weighted rms error (M17.4) \[deg, deg/s, ft/s, ft/s^2\]; `None` where no output has such a
    /// unit.
    pub j_rms: Option<f64>,
    /// Names of the outputs excluded from it: their units are not those of angles, speeds and
    /// accelerations.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub j_rms_left_out: Vec<String>,
    /// Theil's coefficient of each output that varies, by its name: 0 to 1.
    pub theil: BTreeMap<String, f64>,
    /// Each applicable row of the table.
    pub tolerances: Vec<ToleranceFinding>,
}

/// Time histories of the models of every condition that has records, in the format of the export.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct TimeHistories {
    pub tolerance_table: ToleranceTable,
    /// Every record with every model simulated.
    pub records: Vec<HistoryFinding>,
    pub missing: Vec<MissingFinding>,
}

/// Common data of the comparisons of all records.
pub(crate) struct Comparer<'a> {
    inputs: &'a [Channel],
    outputs: &'a [Channel],
    on_axis: PairTable<bool>,
    /// The applicable rows, each with its tolerance in the unit of the dataset.
    pub(crate) rows: Vec<(&'a Tolerance, ChannelTolerance)>,
}

/// A record prepared for simulation, with its models.
struct PreparedHistory<'a> {
    result: &'a ConditionAnalysis,
    record: &'a HistoryRecord,
    segments: Vec<Segment>,
}

/// Computes time histories of the models of every condition, and compares them within `tolerances`
/// about its `records` (M17.2). The number of steps is [`HistoryRecords::steps`].
///
/// # Errors
/// [`Cancelled`] where `execution` is cancelled.
pub fn time_histories_of(
    analysis: &Analysis,
    records: &[HistoryRecords],
    tolerances: &ToleranceTable,
    execution: &Execution<'_>,
) -> Result<TimeHistories, Cancelled> {
    let mut missing = without_records(analysis, records);
    let comparer = Comparer::of(analysis, tolerances, &mut missing);
    let prepared = prepared(analysis, records, execution, &mut missing)?;
    let models = role_models(analysis, &prepared, &mut missing);
    let answers: Vec<(
        &PreparedHistory<'_>,
        RequirementRole,
        (&StateSpace, ValidationSettings),
    )> = prepared
        .iter()
        .flat_map(|history| {
            let of_condition = || {
                models
                    .get(&history.result.condition.id())
                    .into_iter()
                    .flatten()
            };
            let settings =
                common_windows(of_condition().map(|(_, model)| model), &history.segments);
            of_condition().map(move |(role, model)| (history, *role, (model, settings)))
        })
        .collect();
    let found = execution.each(answers.len(), 1, |index| {
        let (history, role, model) = answers[index];
        comparer.finding(history, role, model)
    })?;
    let mut histories = TimeHistories {
        tolerance_table: tolerances.clone(),
        records: Vec::new(),
        missing,
    };
    for ((history, role, _), found) in answers.into_iter().zip(found) {
        match found {
            Ok(finding) => histories.records.push(finding),
            Err(why) => {
                let why = format!(
                    "{} model, record \"{}\": {why}",
                    role.name(),
                    history.record.flight.name
                );
                histories
                    .missing
                    .push(missing_of(Some(history.result.condition.id()), why));
            }
        }
    }
    Ok(histories)
}

/// Returns the settings for simulating every model of a condition with a record: unfiltered
/// signals, and the same windows.
pub(crate) fn common_windows<'m>(
    models: impl IntoIterator<Item = &'m StateSpace>,
    segments: &[Segment],
) -> ValidationSettings {
    ValidationSettings::unfiltered().common_to(models, segments)
}

fn missing_of(condition: Option<ConditionId>, why: String) -> MissingFinding {
    MissingFinding {
        condition,
        what: WHAT,
        why,
    }
}

/// Returns the conditions without records.
fn without_records(analysis: &Analysis, records: &[HistoryRecords]) -> Vec<MissingFinding> {
    let has_records = |id: ConditionId| {
        records
            .iter()
            .any(|of| of.condition == id && !of.records.is_empty())
    };
    if records.iter().all(|of| of.records.is_empty()) {
        return vec![missing_of(None, "no flight record was given".to_owned())];
    }
    let without = analysis
        .study
        .dataset
        .ids()
        .filter(|id| analysis.condition(*id).is_some() && !has_records(*id));
    without
        .map(|id| missing_of(Some(id), "no flight record of it was given".to_owned()))
        .collect()
}

/// Prepares every record of a condition with a result; the reasons for the others go to `missing`.
fn prepared<'a>(
    analysis: &'a Analysis,
    records: &'a [HistoryRecords],
    execution: &Execution<'_>,
    missing: &mut Vec<MissingFinding>,
) -> Result<Vec<PreparedHistory<'a>>, Cancelled> {
    let with_result = |of: &'a HistoryRecords| Some((analysis.condition(of.condition)?, of));
    let all: Vec<(&ConditionAnalysis, &HistoryRecords, &HistoryRecord)> = records
        .iter()
        .filter_map(with_result)
        .flat_map(|(result, of)| of.records.iter().map(move |record| (result, of, record)))
        .collect();
    let segments = execution.each(all.len(), 1, |index| {
        let (_, of, record) = all[index];
        let preparation = Preparation {
            least_segment_s: LEAST_PIECE_S,
            ..of.preparation.clone()
        };
        segments_of(&record.flight, &preparation)
    })?;
    let mut prepared = Vec::new();
    for ((result, of, record), segments) in all.into_iter().zip(segments) {
        match segments {
            Ok(segments) => prepared.push(PreparedHistory {
                result,
                record,
                segments,
            }),
            Err(why) => {
                let why = format!("record \"{}\": {why}", record.flight.name);
                missing.push(missing_of(Some(of.condition), why));
            }
        }
    }
    Ok(prepared)
}

/// Returns the models of each condition that has a record.
fn role_models(
    analysis: &Analysis,
    prepared: &[PreparedHistory<'_>],
    missing: &mut Vec<MissingFinding>,
) -> BTreeMap<ConditionId, Vec<(RequirementRole, StateSpace)>> {
    let mut models = BTreeMap::new();
    for PreparedHistory { result, .. } in prepared {
        let id = result.condition.id();
        models.entry(id).or_insert_with(|| {
            let model = |role| match analysis.role_model(result, role) {
                Ok(model) => Some((role, model)),
                // Reported once, for the schedule.
                Err(RoleModelError::NoSchedule(_)) => None,
                Err(why) => {
                    missing.push(missing_of(
                        Some(id),
                        format!("{} model: {why}", role.name()),
                    ));
                    None
                }
            };
            RequirementRole::ALL.into_iter().filter_map(model).collect()
        });
    }
    models
}

impl<'a> Comparer<'a> {
    pub(crate) fn of(
        analysis: &'a Analysis,
        tolerances: &'a ToleranceTable,
        missing: &mut Vec<MissingFinding>,
    ) -> Self {
        let dataset = &analysis.study.dataset;
        let mut rows = Vec::new();
        for tolerance in tolerances.rows() {
            match tolerance.of_outputs(dataset.outputs()) {
                Ok(of_channel) => rows.push((tolerance, of_channel)),
                Err(why) => missing.push(missing_of(None, why.to_string())),
            }
        }
        let on_axis = dataset.measuring_pairs();
        Self {
            inputs: dataset.inputs(),
            outputs: dataset.outputs(),
            on_axis,
            rows,
        }
    }

    /// Returns the input that varies most over the segments of a record; `None` where the inputs
    /// cannot be compared.
    pub(crate) fn moved_input(&self, segments: &[Segment]) -> Option<usize> {
        let (first, others) = self.inputs.split_first()?;
        if others.iter().any(|input| input.unit != first.unit) {
            return None;
        }
        let variation = |input: usize| -> f64 {
            let squares = segments.iter().map(|segment| {
                let samples = segment.inputs.column(input);
                samples.variance() * samples.len() as f64
            });
            squares.sum()
        };
        (0..self.inputs.len()).max_by(|a, b| variation(*a).total_cmp(&variation(*b)))
    }

    /// Returns whether an output is on-axis to the input that moved most; `None` where that input
    /// is unknown.
    pub(crate) fn is_on_axis(&self, output: usize, moved: Option<usize>) -> Option<bool> {
        moved.map(|input| self.on_axis[Pair::new(output, input)])
    }

    /// Compares the response of a model to a record with the tolerances, or returns the reason in
    /// words why there is none.
    fn finding(
        &self,
        history: &PreparedHistory<'_>,
        role: RequirementRole,
        (model, settings): (&StateSpace, ValidationSettings),
    ) -> Result<HistoryFinding, String> {
        let PreparedHistory {
            result,
            record,
            segments,
        } = history;
        let validation =
            validate(model, segments, &settings, &Sequential).map_err(|error| error.to_string())?;
        let rms = RmsCost::of(&validation.windows, self.outputs);
        let moved = self.moved_input(segments);
        let rows = self
            .rows
            .iter()
            .map(|row| self.against(row, &validation.windows, moved));
        let theil = self.outputs.iter().zip(&validation.theil);
        let theil = theil.filter_map(|(output, theil)| Some((output.name.clone(), (*theil)?)));
        let length_s =
            |window: &ValidationWindow| window.sample_time_s * window.measured.nrows() as f64;
        Ok(HistoryFinding {
            condition: result.condition.id(),
            airspeed_kt: result.condition.flight_state().airspeed_kt,
            record: record.flight.name.clone(),
            held_out: record.held_out,
            role,
            model: result.representative_name(role.bundle()).to_owned(),
            moved_input: moved.map(|input| self.inputs[input].name.clone()),
            samples: validation
                .windows
                .iter()
                .map(|window| window.measured.nrows())
                .sum(),
            windows: validation.windows.len(),
            window_s: validation.windows.iter().map(length_s).fold(0.0, f64::max),
            j_rms: rms.as_ref().map(|cost| cost.value),
            j_rms_left_out: rms
                .into_iter()
                .flat_map(|cost| cost.left_out)
                .map(|at| self.outputs[at].name.clone())
                .collect(),
            theil: theil.collect(),
            tolerances: rows.collect::<Result<_, _>>()?,
        })
    }

    /// Evaluates one row of the table over all windows of a record.
    fn against(
        &self,
        (tolerance, of_channel): &(&Tolerance, ChannelTolerance),
        windows: &[ValidationWindow],
        moved: Option<usize>,
    ) -> Result<ToleranceFinding, String> {
        let checks =
            RecordCheck::of_windows(windows, of_channel).map_err(|error| error.to_string())?;
        let check = checks.first().ok_or("there are no samples to compare")?;
        let worst: &ToleranceCheck = check.worst().ok_or("there are no samples to compare")?;
        let correlation = check.correlation();
        let on_axis = self.is_on_axis(of_channel.output, moved);
        Ok(ToleranceFinding {
            quantity: tolerance.quantity.clone(),
            output: tolerance.channel.clone(),
            integrated: of_channel.integrated,
            unit: of_channel.unit.clone(),
            share_inside: check.share_inside(),
            largest_excess: worst.largest_excess,
            largest_excess_at_s: worst.largest_excess_at_s,
            correlation,
            on_axis,
            trend: Trend::of(correlation, on_axis),
        })
    }
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use nalgebra::{DMatrix, DVector};

    use gdcm_method::requirements::{Tolerance, ToleranceTable};
    use gdcm_model::dataset::{BundleKind, ConditionId, Dynamics, Pair, StateSpace};
    use gdcm_model::executor::Sequential;
    use gdcm_model::progress::Unobserved;
    use gdcm_model::response::{FrequencyGrid, FrequencyResponse};
    use gdcm_model::simulation::{FirstOrderHold, FlightRecord, validate};
    use gdcm_sysid::identification::Preparation;
    use gdcm_sysid::spectra::preparation::segments_of;

    use super::*;
    use crate::results::couplings_tests::{COUPLED, EXAMPLE};

    const CONDITION: ConditionId = ConditionId(3);
    const SAMPLE_TIME_S: f64 = 0.02;

    /// Builds a sweep of the first input alone, `samples` long, with the outputs of a role's model.
    fn flown(analysis: &Analysis, role: RequirementRole, samples: usize) -> FlightRecord {
        let model = analysis
            .role_model(analysis.condition(CONDITION).unwrap(), role)
            .unwrap();
        let time_s: Vec<f64> = (0..samples).map(|n| SAMPLE_TIME_S * n as f64).collect();
        let sweep = |t: f64| 5.0 * (t * (0.5 + 0.05 * t)).sin();
        let inputs = DMatrix::from_fn(samples, model.inputs(), |n, input| {
            if input == 0 { sweep(time_s[n]) } else { 0.0 }
        });
        let held = FirstOrderHold::new(&model, SAMPLE_TIME_S).unwrap();
        let outputs = held.simulate(&DVector::zeros(model.order()), &inputs);
        FlightRecord {
            name: "sweep".into(),
            time_s,
            inputs,
            outputs,
        }
    }

    fn records(analysis: &Analysis, flight: FlightRecord) -> Vec<HistoryRecords> {
        let (inputs, outputs) = analysis.study.dataset.names_of_channels();
        let [inputs, outputs]: [Vec<&str>; 2] =
            [&inputs, &outputs].map(|of| of.iter().map(String::as_str).collect());
        let record = HistoryRecord {
            flight: Arc::new(flight).into(),
            held_out: true,
        };
        let preparation = Preparation {
            keep_frozen: true,
            ..Preparation::of(&inputs, &outputs)
        };
        vec![HistoryRecords {
            condition: CONDITION,
            records: vec![record],
            preparation,
        }]
    }

    fn histories(
        analysis: &Analysis,
        flight: FlightRecord,
        table: &ToleranceTable,
    ) -> TimeHistories {
        time_histories_of(
            analysis,
            &records(analysis, flight),
            table,
            &Execution::sequential(),
        )
        .unwrap()
    }

    #[test]
    fn the_model_that_flew_is_inside_and_the_physics_model_is_not() {
        let analysis = &EXAMPLE.analysis;
        let flight = flown(analysis, RequirementRole::Identified, 1500);
        let found = histories(analysis, flight, &ToleranceTable::default());
        assert_eq!(found.records.len(), 4, "{:?}", found.missing);
        let of_role = |role| found.of_role(CONDITION, role).next().unwrap();
        let identified = of_role(RequirementRole::Identified);
        assert_eq!(
            (identified.samples, identified.moved_input.as_deref()),
            (1500, Some("LON"))
        );
        for of in &identified.tolerances {
            assert!(of.share_inside == 1.0 && of.largest_excess < 0.0, "{of:?}");
            let trend = (of.on_axis == Some(false)).then_some(Trend::Correct);
            assert!(
                of.trend == trend && of.correlation.unwrap() > 0.999_999,
                "{of:?}"
            );
        }
        // The model reproduces its own record, except for the least-squares fit of the initial
        // state.
        assert!(
            identified.j_rms.unwrap() < 1e-6 && identified.theil["Q"] < 1e-7,
            "{identified:?}"
        );
        let [physics, corrected] =
            [RequirementRole::Physics, RequirementRole::Corrected].map(of_role);
        assert!(
            physics
                .tolerances
                .iter()
                .any(|of| of.share_inside < 1.0 && of.largest_excess > 0.0)
        );
        assert!(
            corrected.j_rms.unwrap() < physics.j_rms.unwrap(),
            "a correction brings the model nearer to flight"
        );
        let pitch = identified
            .tolerances
            .iter()
            .find(|of| of.quantity == "pitch rate")
            .unwrap();
        assert_eq!((pitch.on_axis, pitch.trend), (Some(true), None));
    }

    #[test]
    fn shares_of_a_condition_are_those_of_its_records_by_their_samples() {
        let analysis = &EXAMPLE.analysis;
        let flights =
            [600, 1200].map(|samples| flown(analysis, RequirementRole::Identified, samples));
        let mut given = records(analysis, flights[0].clone());
        given[0].records.push(HistoryRecord {
            flight: Arc::new(flights[1].clone()).into(),
            held_out: false,
        });
        let table = ToleranceTable::default();
        let found = time_histories_of(analysis, &given, &table, &Execution::sequential()).unwrap();
        let role = RequirementRole::Physics;
        let [short, long] =
            [0, 1].map(|n| &found.of_role(CONDITION, role).nth(n).unwrap().tolerances[2]);
        let share = found
            .share_inside(CONDITION, role, &short.quantity)
            .unwrap();
        assert!((share - (short.share_inside + 2.0 * long.share_inside) / 3.0).abs() < 1e-12);
        assert_eq!(found.conditions(), [(CONDITION, 2)]);
        let shown = found.share_table();
        assert_eq!(
            shown.rows[2][..3],
            ["3", "2", "pitch rate"].map(str::to_owned)
        );
        // Rounded down: a share below 1 is never displayed as 100.
        assert_eq!(
            shown.rows[2][3].parse::<f64>().unwrap(),
            (1e3 * share).floor() / 10.0
        );
        assert_eq!(shown.rows[2][6], "100.0");
        let squares = |n: usize| {
            found
                .of_role(CONDITION, role)
                .nth(n)
                .unwrap()
                .j_rms
                .unwrap()
                .powi(2)
        };
        let rms = ((squares(0) + 2.0 * squares(1)) / 3.0).sqrt();
        assert!((found.j_rms(CONDITION, role).unwrap() - rms).abs() < 1e-12);
        assert_eq!(found.cost_table().rows[0][3], format!("{rms:.2}"));
        let of_records = found.record_table(CONDITION);
        let is_left =
            |of: &ToleranceFinding| of.largest_excess > 0.0 || of.trend == Some(Trend::Opposite);
        let first = |n: usize| {
            RequirementRole::ALL.map(|role| found.of_role(CONDITION, role).nth(n).unwrap())
        };
        let rows = found.records[0].tolerances.len();
        let left = |n: usize| {
            (0..rows)
                .filter(|row| first(n).iter().any(|of| is_left(&of.tolerances[*row])))
                .count()
        };
        let named = |name: &str| of_records.rows.iter().filter(|row| row[0] == name).count();
        assert_eq!(
            [named("sweep (held out)"), named("sweep")],
            [left(0), left(1)]
        );
        assert!(of_records.title.contains(&format!(
            "{} of {} rows",
            2 * rows - left(0) - left(1),
            2 * rows
        )));
        let row = of_records
            .rows
            .iter()
            .find(|row| row[0] == "sweep" && row[1] == long.quantity)
            .unwrap();
        assert!(
            long.largest_excess > 0.0
                && row[2].contains(&format!("at {:.1} s", long.largest_excess_at_s)),
            "{row:?}"
        );
        assert_eq!(row[5], "100.0", "the model that flew is always inside");
    }

    #[test]
    fn what_is_not_compared_is_said() {
        let analysis = &EXAMPLE.analysis;
        let words = |found: &TimeHistories| {
            found
                .missing
                .iter()
                .map(|of| of.why.clone())
                .collect::<Vec<_>>()
        };
        let table = ToleranceTable::default();
        let none = time_histories_of(analysis, &[], &table, &Execution::sequential()).unwrap();
        assert_eq!(
            (words(&none), none.records.len()),
            (vec!["no flight record was given".to_owned()], 0)
        );

        let short = flown(analysis, RequirementRole::Identified, 50);
        let found = histories(analysis, short, &table);
        assert!(found.records.is_empty());
        assert!(words(&found).iter().any(
            |why| why.starts_with("record \"sweep\": ") && why.contains("2.0 s are the least")
        ));
        let others = found
            .missing
            .iter()
            .filter(|of| of.why == "no flight record of it was given")
            .count();
        assert_eq!(others, analysis.conditions.len() - 1);

        let row = Tolerance {
            channel: "T".into(),
            quantity: "thrust".into(),
            ..table.rows()[0].clone()
        };
        let other = ToleranceTable::new("mine", vec![row, table.rows()[2].clone()]).unwrap();
        let found = histories(
            analysis,
            flown(analysis, RequirementRole::Identified, 600),
            &other,
        );
        assert!(
            words(&found)
                .contains(&"\"thrust\" is not compared: there is no output \"T\"".to_owned())
        );
        assert!(
            found.records.iter().all(|of| of.tolerances.len() == 1),
            "the rest is compared"
        );
    }

    #[test]
    fn a_record_that_is_not_finite_is_refused_with_its_name() {
        let analysis = &EXAMPLE.analysis;
        let mut flight = flown(analysis, RequirementRole::Identified, 600);
        flight.outputs.column_mut(1).fill(f64::NAN);
        let found = histories(analysis, flight, &ToleranceTable::default());
        assert!(found.records.is_empty());
        assert!(
            found
                .missing
                .iter()
                .any(|of| of.condition == Some(CONDITION) && of.why.contains("\"sweep\""))
        );
    }

    #[test]
    fn a_corrected_model_answers_with_the_couplings_of_the_study() {
        let analysis = &COUPLED.1;
        let result = analysis.condition(CONDITION).unwrap();
        let physics =
            &result.condition.bundle(BundleKind::Physics)[result.comparison.physics.model];
        let grid = FrequencyGrid::logarithmic(analysis.study.settings.band, 20);
        let model = analysis
            .role_model(result, RequirementRole::Corrected)
            .unwrap();
        let answered = FrequencyResponse::of(&Dynamics::StateSpace(model), &grid);
        let plain = FrequencyResponse::of(&physics.dynamics, &grid);
        let coupled = result.coupled_response(&plain);
        let pair = Pair::new(1, 0);
        let correction = result.correction.on(pair).unwrap();
        for (k, omega) in grid.omega().iter().enumerate() {
            let expected = coupled.curve(pair)[k] * correction.at(*omega);
            // Lag error in the band of a Pade approximant for delays of tens of ms.
            assert!(
                (answered.curve(pair)[k] - expected).norm() < 1e-4 * expected.norm(),
                "{omega}"
            );
        }
        let as_it_is = analysis
            .role_model(result, RequirementRole::Physics)
            .unwrap();
        let as_it_is = FrequencyResponse::of(&Dynamics::StateSpace(as_it_is), &grid);
        assert!(
            (as_it_is.curve(pair)[0] - plain.curve(pair)[0]).norm()
                < 1e-12 * plain.curve(pair)[0].norm()
        );
    }

    #[test]
    fn a_job_is_stopped_and_is_known_by_what_it_depends_on() {
        struct Stopped;
        impl Progress for Stopped {
            fn cancelled(&self) -> bool {
                true
            }
            fn advanced(&self, _: usize, _: usize) {}
        }
        let analysis = Arc::new(EXAMPLE.analysis.clone());
        let records = records(
            &analysis,
            flown(&analysis, RequirementRole::Identified, 600),
        );
        let job = TimeHistoriesJob {
            analysis: analysis.into(),
            records,
            tolerances: ToleranceTable::default(),
        };
        let mut executor: Box<dyn gdcm_model::executor::Executor> = Box::new(Sequential);
        assert_eq!(job.run(&mut executor, &Stopped).unwrap_err(), Cancelled);
        assert_eq!(
            job.run(&mut executor, &Unobserved).unwrap().records.len(),
            4
        );
        assert_eq!(job, job.clone());
        let tolerances = ToleranceTable::new("mine", job.tolerances.rows()[..1].to_vec()).unwrap();
        assert_ne!(
            TimeHistoriesJob {
                tolerances,
                ..job.clone()
            },
            job
        );
        assert_ne!(
            TimeHistoriesJob {
                records: Vec::new(),
                ..job.clone()
            },
            job
        );
    }

    #[test]
    fn the_models_of_a_condition_are_compared_in_the_same_windows() {
        let analysis = &EXAMPLE.analysis;
        let flight = flown(analysis, RequirementRole::Identified, 1500);
        let segments =
            segments_of(&flight, &records(analysis, flight.clone())[0].preparation).unwrap();
        let result = analysis.condition(CONDITION).unwrap();
        let slow = analysis
            .role_model(result, RequirementRole::Physics)
            .unwrap();
        // A mode that grows e-fold in 1 s is compared over 3 s.
        let fast = StateSpace::new(
            slow.a()
                + DMatrix::from_diagonal_element(slow.order(), slow.order(), 1.0 - fastest(&slow)),
            slow.b().clone(),
            slow.c().clone(),
            slow.d().clone(),
        )
        .unwrap();
        let alone = common_windows([&slow], &segments);
        let both = common_windows([&slow, &fast], &segments);
        assert!(
            alone.longest_window_s > 3.5 && (both.longest_window_s - 3.0).abs() < 1e-6,
            "{alone:?} {both:?}"
        );
        let windows = |model: &StateSpace| -> Vec<(f64, usize)> {
            let found = validate(model, &segments, &both, &Sequential).unwrap();
            found
                .windows
                .iter()
                .map(|window| (window.start_s, window.measured.nrows()))
                .collect()
        };
        assert_eq!(windows(&slow), windows(&fast));
        // A model that diverges too fast to be compared at all does not shorten the windows of
        // others.
        let hopeless = StateSpace::new(
            slow.a() + DMatrix::from_diagonal_element(slow.order(), slow.order(), 100.0),
            slow.b().clone(),
            slow.c().clone(),
            slow.d().clone(),
        )
        .unwrap();
        assert_eq!(common_windows([&slow, &hopeless], &segments), alone);
    }

    /// Returns the greatest real part of the poles \[rad/s\].
    fn fastest(model: &StateSpace) -> f64 {
        model
            .a()
            .complex_eigenvalues()
            .iter()
            .map(|pole| pole.re)
            .fold(f64::NEG_INFINITY, f64::max)
    }
}
