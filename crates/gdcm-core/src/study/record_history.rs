//! One flight record and what each model of its condition answers to its sticks, with the corridors about flight, to be drawn (M17.2).

use std::sync::Arc;

use crate::dataset::ConditionId;
use crate::executor::Executor;
use crate::identification::{FlightRecord, Preparation, Validation, segments_of, validate};
use crate::requirements::{ChannelTolerance, RecordCheck, Tolerance, ToleranceTable};
use crate::units::telling;

use super::time_histories::{Comparer, LEAST_PIECE_S, common_windows};
use super::time_history_tables::percent;
use super::{Analysis, Cancelled, HistoryRecord, Job, Progress, RequirementRole, Table, Trend};

/// One quantity of a record: flown, and as each model answers.
#[derive(Clone, Debug, PartialEq)]
pub struct QuantityHistory {
    /// The row of the table of tolerances.
    pub tolerance: Tolerance,
    /// Index of the output that it is read from.
    pub output: usize,
    /// Unit of what is compared.
    pub unit: String,
    /// Whether the output is on-axis to the input that moved most; none where that is not known.
    pub on_axis: Option<bool>,
    /// What each model gives, in windows that are the same for all of them.
    pub models: Vec<(RequirementRole, RecordCheck)>,
}

/// One record against the tolerances.
#[derive(Clone, Debug)]
pub struct RecordHistory {
    /// The condition.
    pub condition: ConditionId,
    /// Name of the record.
    pub record: String,
    /// Whether the identified models were kept from it.
    pub held_out: bool,
    /// The record, in the units of the dataset's channels.
    pub flight: Arc<FlightRecord>,
    /// Each row of the table that can be applied.
    pub quantities: Vec<QuantityHistory>,
    /// In words what is not compared, and why.
    pub missing: Vec<String>,
}

impl PartialEq for RecordHistory {
    fn eq(&self, other: &Self) -> bool {
        Arc::ptr_eq(&self.flight, &other.flight)
            && (self.condition, &self.quantities, &self.missing) == (other.condition, &other.quantities, &other.missing)
    }
}

impl RecordHistory {
    /// Share of time inside, the largest excess and when, of each quantity and model; off the axis, whether the trend is correct.
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
        let mut table = Table::new(format!("{}{held_out}: within tolerances", self.record), columns);
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
                    beyond
                        .map_or("none".to_owned(), |worst| format!("{} {}", telling(worst.largest_excess, 2), of.unit)),
                    beyond.map_or(String::new(), |worst| telling(worst.largest_excess_at_s, 1)),
                    Trend::of(correlation, of.on_axis).map_or("", Trend::name).to_owned(),
                    correlation.map_or(String::new(), |of| telling(of, 2).replace('-', "\u{2212}")),
                ]);
            }
        }
        table
    }
}

/// A record of a condition against the tolerances of the study, beside the live answer.
#[derive(Clone, Debug)]
pub struct RecordHistoryJob {
    /// The analysis.
    pub analysis: Arc<Analysis>,
    /// The condition.
    pub condition: ConditionId,
    /// The record.
    pub record: HistoryRecord,
    /// How its channels are prepared.
    pub preparation: Preparation,
    /// The tolerances.
    pub tolerances: ToleranceTable,
}

impl PartialEq for RecordHistoryJob {
    fn eq(&self, other: &Self) -> bool {
        let key = |of: &Self| (of.condition, of.record.clone(), of.preparation.clone(), of.tolerances.clone());
        Arc::ptr_eq(&self.analysis, &other.analysis) && key(self) == key(other)
    }
}

impl RecordHistoryJob {
    fn found(&self, executor: &dyn Executor) -> Result<RecordHistory, String> {
        let result = match self.analysis.conditions.get(&self.condition) {
            Some(Ok(result)) => result,
            Some(Err(failure)) => return Err(failure.to_string()),
            None => return Err("it was not analysed".to_owned()),
        };
        let preparation = Preparation { least_segment_s: LEAST_PIECE_S, ..self.preparation.clone() };
        let segments = segments_of(&self.record.flight, &preparation).map_err(|error| error.to_string())?;
        let (mut missing, mut models) = (Vec::new(), Vec::new());
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
        let (record, held_out) = (self.record.flight.name.clone(), self.record.held_out);
        let flight = Arc::clone(&self.record.flight);
        Ok(RecordHistory { condition: self.condition, record, held_out, flight, quantities, missing })
    }
}

impl Job for RecordHistoryJob {
    /// Who carries out its pieces.
    type Tools = Box<dyn Executor>;
    /// In words why there is none.
    type Output = Result<Arc<RecordHistory>, String>;

    fn run(&self, executor: &mut Self::Tools, progress: &dyn Progress) -> Result<Self::Output, Cancelled> {
        let found = self.found(executor.as_ref()).map(Arc::new);
        if progress.cancelled() { Err(Cancelled) } else { Ok(found) }
    }
}
