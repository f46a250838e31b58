//! Files with planned flights, `gdcm-plan` 1, written by `gdcm plan --out`.
//!
//! A plan predicts the 95 % intervals of a model's responses after further frequency sweeps (M14).
//! A *target* is an interval's wanted half-width; its *ways* are more, longer, stronger or
//! narrower-band sweeps, and a *need* is the least amount of these that reaches it. `limit` is the
//! interval after infinitely many flights.

use std::path::Path;

use serde_json::{Value, json};

use gdcm_model::dataset::{ConditionId, Pair};
use gdcm_sysid::planning::flight_information::StandardSweep;
use gdcm_sysid::planning::flight_plan::SweepPlan;
use gdcm_sysid::planning::flight_planner::ResponseInterval;
use gdcm_sysid::planning::interval_target::{Need, TargetPlan};
use gdcm_words::flight_plan::PlannedChannels;

use crate::file_error::FileError;
use crate::json_writing::write_pretty;
use crate::output_set::OutputSet;
use crate::software::software;

/// Planned sweeps for one condition, and ways to reach the requested half-widths of its responses'
/// intervals.
#[derive(Clone, Debug, PartialEq)]
pub struct ConditionPlan {
    /// Condition in the dataset; `None` without a dataset.
    pub condition: Option<ConditionId>,
    /// One plan per input.
    pub sweeps: Vec<SweepPlan>,
    pub targets: Vec<TargetPlan>,
}

/// Adds a file with condition plans to `outputs`.
pub fn add_flight_plans(
    plans: &[ConditionPlan],
    channels: &PlannedChannels,
    path: &Path,
    outputs: &mut OutputSet,
) -> Result<(), FileError> {
    let object = flight_plans_json(plans, channels);
    outputs.add(path, |file| write_pretty(&object, file))
}

fn flight_plans_json(plans: &[ConditionPlan], channels: &PlannedChannels) -> Value {
    let mut conditions = Vec::with_capacity(plans.len());
    for plan in plans {
        let sweeps: Vec<Value> = plan
            .sweeps
            .iter()
            .map(|sweep| sweep_plan_json(sweep, channels))
            .collect();
        let targets: Vec<Value> = plan
            .targets
            .iter()
            .map(|target| target_json(target, channels))
            .collect();
        conditions.push(json!({
            "condition": plan.condition.map(|id| id.0),
            "sweeps": sweeps,
            "targets": targets,
        }));
    }
    json!({
        "format": "gdcm-plan",
        "version": 1,
        "software": software(),
        "plans": conditions,
    })
}

fn sweep_plan_json(plan: &SweepPlan, channels: &PlannedChannels) -> Value {
    let mut responses = Vec::with_capacity(plan.responses.len());
    for response in &plan.responses {
        let mut after = Vec::with_capacity(response.after.len());
        for (repeats, interval) in plan.repeats.iter().zip(&response.after) {
            let mut value = interval_json(interval);
            value["repeats"] = json!(repeats);
            after.push(value);
        }
        responses.push(json!({
            "pair": pair_json(response.pair, channels),
            "omega_rad_s": response.omega,
            "now": interval_json(&response.now),
            "after": after,
        }));
    }
    json!({
        "sweep": sweep_json(&plan.sweep, channels),
        "responses": responses,
    })
}

fn target_json(plan: &TargetPlan, channels: &PlannedChannels) -> Value {
    let ways = plan.ways.as_ref().map(|ways| {
        json!({
            "repeats": need_json(&ways.repeats),
            "length_s": need_json(&ways.length_s),
            "amplitude": need_json(&ways.amplitude),
            "narrow_band_rad_s": ways.narrow_band,
            "narrow_repeats": need_json(&ways.narrow_repeats),
        })
    });
    json!({
        "pair": pair_json(plan.target.pair, channels),
        "omega_rad_s": plan.target.omega,
        "half_width_db": plan.target.half_db,
        "sweep": sweep_json(&plan.sweep, channels),
        "now": interval_json(&plan.now),
        "limit": interval_json(&plan.limit),
        "ways": ways,
    })
}

fn need_json<T: serde::Serialize>(need: &Need<T>) -> Value {
    match need {
        Need::Least { amount, half_db } => {
            json!({ "reached": true, "amount": amount, "half_width_db": half_db })
        }
        Need::NotWithin { most, half_db } => {
            json!({ "reached": false, "amount": most, "half_width_db": half_db })
        }
    }
}

fn sweep_json(standard: &StandardSweep, channels: &PlannedChannels) -> Value {
    let sweep = &standard.sweep;
    let input = channels.inputs.get(sweep.input);
    json!({
        "input": input.map(|input| input.name.as_str()),
        "unit": input.map(|input| input.unit.as_str()),
        "amplitude": sweep.amplitude,
        "amplitude_is_assumed": standard.is_assumed,
        "length_s": sweep.length_s,
        "band_rad_s": sweep.band,
    })
}

fn interval_json(interval: &ResponseInterval) -> Value {
    json!({ "half_width_db": interval.half_db, "half_width_deg": interval.half_deg })
}

/// Returns the output and input names.
fn pair_json(pair: Pair, channels: &PlannedChannels) -> Value {
    json!([
        channels.outputs.get(pair.output),
        channels.inputs.get(pair.input).map(|input| &input.name),
    ])
}
