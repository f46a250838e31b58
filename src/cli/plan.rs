//! `gdcm plan`: confidence intervals predicted after further frequency sweeps.
//!
//! An identification yields the Fisher information of its records, from which the intervals of the
//! responses follow; a further sweep adds to it. A *target* is an interval that the engineer wants
//! in a response at a frequency (M14).

use std::path::Path;

use gdcm_io::files::flight_plan_file::{ConditionPlan, add_flight_plans};
use gdcm_io::output_set::OutputSet;
use gdcm_model::dataset::{Band, Pair};
use gdcm_model::message_text::sanitized_path;
use gdcm_model::number_format::number;
use gdcm_sysid::identification::Identification;
use gdcm_sysid::planning::flight_information::{FlightInformation, StandardSweep};
use gdcm_sysid::planning::flight_plan::{SweepPlan, TABLE_REPEATS};
use gdcm_sysid::planning::flight_planner::FlightPlanner;
use gdcm_sysid::planning::interval_target::{IntervalTarget, TargetPlan};
use gdcm_sysid::planning::planned_sweep::PlannedSweep;
use gdcm_sysid::records::RecordChannels;
use gdcm_words::flight_plan::{PlannedChannels, sweep_plan_table, target_lines};

use super::channel_values::first_duplicate;
use super::condition_messages::{ConditionMessage, shared_messages};
use super::existing;
use super::failure::Failure;
use super::identification_task::{IdentificationTask, planned_channels, prefix};
use super::identify::{IdentificationTasks, identification_tasks};
use super::option_values::PairName;
use super::plan_arguments::PlanArguments;
use super::printed_lines::listed_paths;
use super::progress::ProgressReceiver;
use super::receiving_dataset::ReceivingDataset;
use super::requested_channels::{requested_band, requested_channels};
use super::terminal::{caution_for, print};
use crate::executor::Pool;
use crate::message::Message;

/// Identifies models from flight records and prints a plan for each condition.
///
/// 1. Band and channels, from the options or the dataset; the wanted sweeps and targets, checked
///    before the records are read.
/// 2. The records, as for `gdcm identify`: one task for all, or one for each condition.
/// 3. For each task the identification, and from its information the plan.
/// 4. The file, if requested, and the tables.
///
/// # Errors
/// An option or a file is wrong; the only condition has no identification or no plan, or none has
/// a plan (otherwise a condition without one is a caution); the work was stopped. After all is
/// done: some records were not read.
pub(super) fn plan(arguments: &PlanArguments) -> Result<(), Failure> {
    // Step 1.
    let source = &arguments.source;
    let read = source.records.iter().chain(&source.into);
    let mut outputs = OutputSet::new(existing(arguments.force), read.cloned().collect());
    if let Some(out) = &arguments.out {
        outputs.check(&[out])?;
    }
    let destination = ReceivingDataset::open(source, Path::new(""), None)?;
    let dataset = destination.as_ref().map(|place| place.dataset.as_ref());
    let band = requested_band(source, dataset)?;
    let mut channels = requested_channels(source, dataset, band)?;
    let wanted = WantedFlights::new(arguments, &channels, band)?;
    // Step 2.
    let IdentificationTasks { tasks, unread, .. } =
        identification_tasks(source, destination.as_ref(), &mut channels, band)?;
    // Step 3.
    let plans = condition_plans(&tasks, &wanted)?;
    // Step 4.
    let mut text = String::new();
    for plan in &plans {
        text += &plan_text(plan, &wanted.channels);
    }
    if let Some(out) = &arguments.out {
        add_flight_plans(&plans, &wanted.channels, out, &mut outputs)?;
        outputs.persist()?;
        text += &format!("\n{}: the plan with all numbers\n", sanitized_path(out));
    }
    print(&text)?;
    if unread.is_empty() {
        Ok(())
    } else {
        Err(Failure::Unread {
            paths: listed_paths(&unread),
        })
    }
}

/// Identifies the models of each task, and plans its flights. A condition without models or without
/// a plan is a caution, unless it is the only one.
///
/// # Errors
/// No condition has a plan, an option does not suit the records, or the work was stopped.
fn condition_plans(
    tasks: &[IdentificationTask],
    wanted: &WantedFlights<'_>,
) -> Result<Vec<ConditionPlan>, Failure> {
    let mut plans = Vec::with_capacity(tasks.len());
    let mut cautions: Vec<ConditionMessage> = Vec::new();
    for task in tasks {
        let plan = task
            .run(ProgressReceiver::Terminal)
            .and_then(|found| wanted.plan(task, &found));
        match plan {
            Ok(plan) => plans.push(plan),
            Err(failure @ (Failure::NoModels { .. } | Failure::NoPlan { .. }))
                if tasks.len() > 1 =>
            {
                cautions.push(ConditionMessage::new(
                    task.condition,
                    failure.code(),
                    failure.to_string(),
                ));
            }
            Err(failure) => return Err(failure),
        }
    }
    for shared in shared_messages(cautions) {
        let Message { code, text } = &shared.message;
        caution_for(code, &shared.conditions, text);
    }
    if plans.is_empty() {
        return Err(Failure::NoPlan {
            reason: format!("all {} conditions failed", tasks.len()),
        });
    }
    Ok(plans)
}

/// The sweeps and targets that the options ask for.
struct WantedFlights<'a> {
    arguments: &'a PlanArguments,
    channels: PlannedChannels,
    /// Amplitude for the sweeps on each input, if it is given.
    amplitudes: Vec<Option<f64>>,
    targets: Vec<IntervalTarget>,
}

impl<'a> WantedFlights<'a> {
    /// Checks the options against the channels.
    fn new(
        arguments: &'a PlanArguments,
        channels: &RecordChannels,
        band: Band,
    ) -> Result<Self, Failure> {
        let mut channels = channels.clone();
        // The references are the last inputs; the model does not contain them, and no sweep of
        // them is planned.
        let references = arguments.source.references().len();
        channels.inputs.truncate(channels.inputs.len() - references);
        let channels = planned_channels(&channels);
        let mut amplitudes = vec![None; channels.inputs.len()];
        if let Some(channel) = first_duplicate(&arguments.amplitude) {
            return Err(Failure::given_twice("--amplitude", channel));
        }
        for amplitude in &arguments.amplitude {
            let input = input_index(&channels, &amplitude.channel)
                .ok_or_else(|| unknown_input(&amplitude.channel, &channels))?;
            amplitudes[input] = Some(amplitude.value);
        }
        if let Some(&[first, last]) = arguments.sweep_band.as_deref()
            && !(first.is_finite() && last.is_finite() && 0.0 < first && first < last)
        {
            let reason = format!(
                "expected two increasing positive frequencies in rad/s, found {first} and {last}"
            );
            return Err(Failure::option("--sweep-band", reason));
        }
        let mut targets = Vec::with_capacity(arguments.target.len());
        for target in &arguments.target {
            if !(band.min()..=band.max()).contains(&target.omega) {
                let reason = format!(
                    "{} rad/s is outside the band, {} to {} rad/s",
                    number(target.omega),
                    number(band.min()),
                    number(band.max())
                );
                return Err(Failure::option("--target", reason));
            }
            targets.push(IntervalTarget {
                pair: pair_of(&channels, &target.pair)?,
                omega: target.omega,
                half_db: target.half_db,
            });
        }
        Ok(Self {
            arguments,
            channels,
            amplitudes,
            targets,
        })
    }

    /// Predicts the intervals in a condition after the wanted sweeps, and the ways to reach the
    /// targets.
    fn plan(
        &self,
        task: &IdentificationTask,
        found: &Identification,
    ) -> Result<ConditionPlan, Failure> {
        let information = found.information.as_ref().ok_or_else(no_information)?;
        let planner = FlightPlanner::new(information, &Pool).ok_or_else(no_information)?;
        let mut sweeps: Vec<SweepPlan> = Vec::new();
        for input in 0..information.inputs() {
            let sweep = self.sweep(information, input).ok_or_else(no_information)?;
            let plan = planner.sweep_plan(sweep, &TABLE_REPEATS, planner.middle_omega());
            sweeps.push(plan.ok_or_else(|| self.no_plan())?);
        }
        let mut targets: Vec<TargetPlan> = Vec::new();
        for target in &self.targets {
            let sweep = self
                .sweep(information, target.pair.input)
                .ok_or_else(no_information)?;
            let plan = planner.target_plan(*target, sweep, self.arguments.repeats);
            targets.push(plan.ok_or_else(|| self.no_plan())?);
        }
        Ok(ConditionPlan {
            condition: task.condition,
            sweeps,
            targets,
        })
    }

    /// Returns the failure for sweeps about which nothing can be predicted: if the options give
    /// their length or band, they have no spectral line in the band; sweeps as flown always have
    /// some, so that information is missing.
    fn no_plan(&self) -> Failure {
        if self.arguments.length.is_some() {
            let reason =
                "the planned sweeps have no spectral line in the band; give a longer sweep";
            Failure::option("--length", reason)
        } else if self.arguments.sweep_band.is_some() {
            let reason = "the planned sweeps have no spectral line in the band; give a wider band of \
                the sweeps";
            Failure::option("--sweep-band", reason)
        } else {
            no_information()
        }
    }

    /// Returns a sweep on an input: as flown, except where the options give a value.
    fn sweep(&self, information: &FlightInformation, input: usize) -> Option<StandardSweep> {
        let mut standard = information.standard_sweep(input)?;
        if let Some(length_s) = self.arguments.length {
            standard.sweep = information.with_length(&standard.sweep, length_s);
        }
        if let Some(&[first, last]) = self.arguments.sweep_band.as_deref() {
            standard.sweep = PlannedSweep {
                band: [first, last],
                ..standard.sweep
            };
        }
        if let Some(amplitude) = self.amplitudes.get(input).copied().flatten() {
            standard.sweep.amplitude = amplitude;
            // Reports mark only the amplitude as assumed.
            standard.is_assumed = false;
        }
        Some(standard)
    }
}

/// Returns the failure for records whose information cannot be computed.
fn no_information() -> Failure {
    Failure::NoPlan {
        reason: "the Fisher information of the records cannot be computed".to_owned(),
    }
}

/// Returns tables of the planned sweeps, and the ways to reach each target, for a condition.
fn plan_text(plan: &ConditionPlan, channels: &PlannedChannels) -> String {
    let mut text = String::new();
    for sweep in &plan.sweeps {
        text += &prefix(plan.condition);
        text += &sweep_plan_table(sweep, channels).text();
        text.push('\n');
    }
    for target in &plan.targets {
        let lines = target_lines(target, channels);
        text += &prefix(plan.condition);
        text += &lines.join("\n  ");
        text.push('\n');
    }
    text
}

fn input_index(channels: &PlannedChannels, name: &str) -> Option<usize> {
    channels.inputs.iter().position(|input| input.name == name)
}

fn unknown_input(name: &str, channels: &PlannedChannels) -> Failure {
    let names: Vec<&str> = channels
        .inputs
        .iter()
        .map(|input| input.name.as_str())
        .collect();
    let reason = format!(
        "there is no input {name}; the inputs are {}",
        names.join(", ")
    );
    Failure::coded_option("--amplitude", "unknown-channel", reason)
}

/// Returns the response that a target concerns.
fn pair_of(channels: &PlannedChannels, name: &PairName) -> Result<Pair, Failure> {
    let output = channels
        .outputs
        .iter()
        .position(|output| *output == name.output);
    match (output, input_index(channels, &name.input)) {
        (Some(output), Some(input)) => Ok(Pair { output, input }),
        _ => {
            let inputs: Vec<&str> = channels
                .inputs
                .iter()
                .map(|input| input.name.as_str())
                .collect();
            let reason = format!(
                "there is no response {}/{}; outputs are {}; inputs are {}",
                name.output,
                name.input,
                channels.outputs.join(", "),
                inputs.join(", ")
            );
            Err(Failure::coded_option(
                "--target",
                "unknown-response",
                reason,
            ))
        }
    }
}
