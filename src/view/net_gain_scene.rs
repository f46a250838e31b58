//! Gains against airspeed, made of what was computed.

use std::collections::BTreeSet;

use crate::correction::ChannelCorrection;
use crate::dataset::FlightState;
use crate::schedule::Schedule;
use crate::study::Analysis;

use super::plot::{Dot, DotShape, GainPanel};
use super::state::State;

/// Samples of a schedule between its ends.
const SAMPLES: usize = 120;

/// One panel for each held response: the net gain of each condition's optimum, and the schedule.
pub fn net_gain_panels(state: &State) -> Vec<GainPanel> {
    let Some(analysis) = state.analysis() else {
        return Vec::new();
    };
    state
        .study
        .settings
        .constrained
        .marked()
        .map(|pair| {
            panel(state, analysis, state.dataset().pair_name(pair), |correction| correction.net_gain(pair).value())
        })
        .collect()
}

/// One panel for each input and one for each output: the channel's gain in each condition's optimum, and the schedule.
pub fn channel_panels(state: &State) -> (Vec<GainPanel>, Vec<GainPanel>) {
    let Some(analysis) = state.analysis() else {
        return (Vec::new(), Vec::new());
    };
    let inputs = state.dataset().inputs().iter().enumerate().map(|(index, channel)| {
        panel(state, analysis, channel.name.clone(), move |correction| correction.input_gains[index])
    });
    let outputs = state.dataset().outputs().iter().enumerate().map(|(index, channel)| {
        panel(state, analysis, channel.name.clone(), move |correction| correction.output_gains[index])
    });
    (inputs.collect(), outputs.collect())
}

fn panel(
    state: &State,
    analysis: &Analysis,
    title: String,
    gain: impl Fn(&ChannelCorrection) -> f64 + Copy,
) -> GainPanel {
    let classes = Classes::of(state);
    let dots = state.dataset().conditions().iter().filter_map(|condition| {
        let id = condition.id();
        let result = analysis.condition(id)?;
        let flight_state = condition.flight_state();
        Some(Dot {
            condition: id,
            label: id.to_string(),
            airspeed_kt: flight_state.airspeed_kt,
            gain: gain(&result.correction),
            shape: if classes.is_first_altitude(flight_state) { DotShape::Circle } else { DotShape::Diamond },
            filled: classes.is_first_weight(flight_state),
            selected: id == state.condition().id(),
            chosen: analysis.study.choice(id).scheduled,
            detail: flight_state.name.clone(),
        })
    });
    let schedule = analysis.schedule.as_ref().map(|schedule| samples(schedule, gain)).unwrap_or_default();
    GainPanel { title, dots: dots.collect(), schedule }
}

fn samples(schedule: &Schedule, gain: impl Fn(&ChannelCorrection) -> f64) -> Vec<[f64; 2]> {
    let (from, to) = (schedule.airspeeds.min_kt, schedule.airspeeds.max_kt);
    let airspeed = |sample: usize| from + (to - from) * sample as f64 / SAMPLES as f64;
    (0..=SAMPLES).map(|sample| [airspeed(sample), gain(&schedule.at(airspeed(sample)))]).collect()
}

/// The altitude class drawn as circles and the weight class drawn filled: "low", or the first of the names.
struct Classes {
    altitude: Option<String>,
    weight: Option<String>,
}

impl Classes {
    fn of(state: &State) -> Self {
        let names = |class: fn(&FlightState) -> &Option<String>| -> BTreeSet<String> {
            let states = state.dataset().conditions().iter().map(|condition| condition.flight_state());
            states.filter_map(|state| class(state).clone()).collect()
        };
        let first = |names: BTreeSet<String>| {
            let low = names.iter().find(|name| ["low", "light"].contains(&name.as_str())).cloned();
            low.or_else(|| names.into_iter().next())
        };
        Self { altitude: first(names(|state| &state.altitude)), weight: first(names(|state| &state.weight)) }
    }

    fn is_first_altitude(&self, state: &FlightState) -> bool {
        state.altitude == self.altitude
    }

    fn is_first_weight(&self, state: &FlightState) -> bool {
        state.weight == self.weight
    }
}

/// What shapes and fills of the dots mean; empty where the dataset has no classes.
pub fn dot_key(state: &State) -> String {
    let classes = Classes::of(state);
    let mut words = Vec::new();
    if let Some(altitude) = classes.altitude {
        words.push(format!("● {altitude} altitude, ◆ other"));
    }
    if let Some(weight) = classes.weight {
        words.push(format!("filled: {weight} weight"));
    }
    words.join(" · ")
}
